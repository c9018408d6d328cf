"""A local minimum of the signed distance of two boundaries, apart, in contact and in overlap alike.

Newton's method on the contact-regular form y = (q, n, d): n is a normal of both boundaries, and
y - x = d n. Its matrix keeps its rank where the points come together, so that a minimum is the same
smooth function of the pose on both sides of contact. In an overlap d is below 0: B, moved by -d
along n, only touches there.
"""

from standoff.kernels.algebra.symmetric import symmetric_eigen
from standoff.kernels.algebra.vectors import add, cross, dot, norm, rotate, scale, sub, unit
from standoff.kernels.compiler.decorators import (
    kernel,
    reals_on_stack,
    shared,
    stack_matrix,
    stack_reals,
)
from standoff.kernels.pair.contact_newton import (
    contact_scales,
    scaled_jacobian,
    scaled_residual,
    solve_contact,
)
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.hollow import beside_edge, is_hollow
from standoff.kernels.solids.spatial_minimum import jets_at, nearest
from standoff.kernels.solids.spatial_pieces import ZERO, leaf_ints, leaf_jet, outward_normal
from standoff.kernels.solids.spatial_progress import ball_round, middle
from standoff.kernels.solids.spatial_tolerances import (
    CONTACT_ERROR,
    CONTACT_ROUNDED,
    FLAT_VALLEY,
    NEARLY_LEVEL,
    PARALLEL_EDGES,
    ROUGHLY_LEVEL,
    SLOPE_STEP,
    SURE_NORMAL,
)
from standoff.kernels.solids.stationary import bends_up
from standoff.kernels.tolerances import CONTACT_STEPS
from standoff.kernels.values import Pose

# Eigenvalues of the contact-regular matrix of a minimum: so many above 0, and so many below. Those
# of parameters that a feature does not have count above, and those of a fillet of no radius belong
# below: it is bent inwards as much as can be.
ABOVE_ZERO, BELOW_ZERO = 5, 3
# Of the first steps of Newton's method so many may make its error greater, and by how much.
FREE_STEPS, MAY_GROW = 3, 10.0
# Where the matrix is singular, each step makes the error as much less: parallel features have a
# common normal, and others that are straight, as a ruling and a plane, have none.
SHRINKS = 0.3
# Of two edges: steps towards where one is level with the way out of the other, a hollow one.
LEVEL_STEPS = 8


@kernel
def way_out(side, leaf, jet, u):
    """Of a face its outward normal, A's frame; of a hollow edge the sum of both beside it."""
    if side.own[leaf_ints(side, leaf) + S.DIM] == 2:
        return outward_normal(side, leaf, jet)
    if not is_hollow(side, leaf):
        return ZERO
    beside = add(beside_edge(side, leaf, u, 0), beside_edge(side, leaf, u, 1))
    return rotate(side.pose.R, beside)


@kernel
def first_normal(a, leaf_a, ja, b, leaf_b, jb, q, size):
    """A unit normal from A to B of two features at a pair of their points, in A's frame; of two
    edges one of the two; 0 where they have none, as parallel edges that touch. At a hollow edge, of
    another edge that has gone past it, midway between the faces beside it."""
    if a.own[leaf_ints(a, leaf_a) + S.DIM] == 2:
        return outward_normal(a, leaf_a, ja)
    if b.own[leaf_ints(b, leaf_b) + S.DIM] == 2:
        return scale(-1.0, outward_normal(b, leaf_b, jb))
    n = cross(ja[1], jb[1])
    area = norm(n)
    if norm(ja[1]) > 0.0 and norm(jb[1]) > 0.0 and (is_hollow(a, leaf_a) or is_hollow(b, leaf_b)):
        return unit(sub(way_out(a, leaf_a, ja, q[0]), way_out(b, leaf_b, jb, q[2])))
    if area > PARALLEL_EDGES * norm(ja[1]) * norm(jb[1]):
        return scale(1.0 / area, n)
    delta = sub(jb[0], ja[0])
    length = norm(delta)
    return scale(1.0 / length, delta) if length > SURE_NORMAL * size else ZERO


@kernel
def moved_side(side, by):
    """The same solid, moved by a vector of A's frame."""
    pose = Pose(side.pose.R, add(side.pose.p, by))
    return S.Side(side.ints, side.reals, side.own, side.numbers, pose, side.sense)


@kernel
def middles_of(a, b):
    u, v = middle(a.box)
    s, t = middle(b.box)
    return (u, v, s, t)


@kernel
def across_way_out(hollow, edge, s, t):
    """(parameter of a hollow edge, of another edge), both as parts: where the other one is level
    with the way out of the hollow one, at the foot of that point. There it has gone farthest past
    it."""
    h, e = hollow, edge
    step_s, step_t = h.box.u1 - h.box.u0, e.box.u1 - e.box.u0
    low = h.box.u0 - step_s, e.box.u0 - step_t
    high = h.box.u1 + step_s, e.box.u1 + step_t
    small = SLOPE_STEP * step_s
    for _ in range(LEVEL_STEPS):
        x, y = leaf_jet(h.side, h.leaf, s, 0.0), leaf_jet(e.side, e.leaf, t, 0.0)
        way, delta = way_out(h.side, h.leaf, x, s), sub(y[0], x[0])
        ahead = way_out(h.side, h.leaf, leaf_jet(h.side, h.leaf, s + small, 0.0), s + small)
        foot, level = dot(delta, x[1]), dot(way, y[1])
        foot_s, foot_t = dot(delta, x[3]) - dot(x[1], x[1]), dot(y[1], x[1])
        level_s, level_t = dot(sub(ahead, way), y[1]) / small, dot(way, y[3])
        det = foot_s * level_t - foot_t * level_s
        if det == 0.0:
            break
        ds = (foot * level_t - foot_t * level) / det
        dt = (foot_s * level - foot * level_s) / det
        before, s, t = (s, t), s - ds, t - dt
        s, t = min(max(s, low[0]), high[0]), min(max(t, low[1]), high[1])
        # level there, or held at the same ends again
        ds, dt = s - before[0], t - before[1]
        if abs(ds) <= ROUGHLY_LEVEL * step_s and abs(dt) <= ROUGHLY_LEVEL * step_t:
            break
    return s, t


@kernel
def nearest_apart(a, b, away, first, counts):
    """Parameters of the nearest points of two parts, of which B is moved away by a vector."""
    moved = moved_side(b.side, away)
    return nearest(a.side, a.leaf, a.box, moved, b.leaf, b.box, first, counts)[0]


@kernel
def foot_on(box, jet, u, v, x):
    """Parameters within a box near the foot of a point on a surface or curve: of the foot on its
    tangent plane or line at (u, v), where it has a jet."""
    delta, fu, fv = sub(x, jet[0]), jet[1], jet[2]
    gu, gv = dot(delta, fu), dot(delta, fv)
    uu, uv, vv = dot(fu, fu), dot(fu, fv), dot(fv, fv)
    det = uu * vv - uv * uv
    if det > 0.0:
        u, v = u + (gu * vv - gv * uv) / det, v + (gv * uu - gu * uv) / det
    elif uu > 0.0:
        u += gu / uu
    return min(max(u, box.u0), box.u1), min(max(v, box.v0), box.v1)


@kernel
def foot_of_middle(a, b, q, ja, jb):
    """Parameters of the middle of a part, of an edge rather than of a face and else of the smaller
    one, and near its foot on the other part; `q`: both middles, with their jets."""
    u, v, s, t = q
    of_a, of_b = norm(ja[2]) > 0.0, norm(jb[2]) > 0.0
    first = ball_round(a)[1] <= ball_round(b)[1] if of_a == of_b else of_b
    if first:
        s, t = foot_on(b.box, jb, s, t, ja[0])
    else:
        u, v = foot_on(a.box, ja, u, v, jb[0])
    return (u, v, s, t)


@kernel
def start_of(a, b, first, counts):
    """(parameters from which Newton's method may come to a common normal of two parts, the vector
    by which B was moved away for it, whether they are nearest there): along a normal of one, by as
    much as both are long, from `first` on.

    Where one is hollow, as a bore round a pin, they are nearest at their sides wherever both have a
    common normal; it is then looked for from the middle of one, and its foot on the other. The
    middles of both would not do: along a thread a common normal runs far for a small motion, and a
    first step that also has to find the foot leads past it."""
    q = middles_of(a, b)
    ja, jb = jets_at(a.side, a.leaf, b.side, b.leaf, q)
    if norm(ja[1]) > 0.0 and norm(jb[1]) > 0.0:
        if is_hollow(a.side, a.leaf):
            s, t = across_way_out(a, b, q[0], q[2])
            return (s, q[1], t, q[3]), ZERO, False
        if is_hollow(b.side, b.leaf):
            s, t = across_way_out(b, a, q[2], q[0])
            return (t, q[1], s, q[3]), ZERO, False
    n = sub(way_out(a.side, a.leaf, ja, q[0]), way_out(b.side, b.leaf, jb, q[2]))
    length = norm(n)
    far = ball_round(a)[1] + ball_round(b)[1] + norm(sub(jb[0], ja[0]))
    away = scale(far / length, n) if length > 0.0 else ZERO
    moved = moved_side(b.side, away)
    jm = leaf_jet(moved, b.leaf, q[2], q[3])
    if length > 0.0 and not bends_up(ja, jm, FLAT_VALLEY):
        return foot_of_middle(a, b, q, ja, jb), away, False
    return nearest_apart(a, b, away, first, counts), away, True


@shared
def signed_minimum(a, leaf_a, b, leaf_b, q, span, limits, counts):
    """(whether Newton's method came to a common normal, parameters, n, d), from the parameters
    `q` on. `span` makes the form dimensionless, length; it ends where it leaves `limits`, a least
    and a greatest value of each parameter."""
    ja, jb = jets_at(a, leaf_a, b, leaf_b, q)
    n = first_normal(a, leaf_a, ja, b, leaf_b, jb, q, span)
    d = dot(n, sub(jb[0], ja[0]))
    if norm(n) < 0.5:
        return False, q, n, d
    r, y, scales = stack_reals(), stack_reals(), stack_reals()
    contact_scales(ja, jb, span, scales)
    error = scaled_residual(ja, jb, n, d, span, scales, r)
    low, high = limits
    for k in range(CONTACT_STEPS):
        counts[1] += 1
        regular = solve_contact(ja, jb, n, d, span, scales, r, y)
        trial = (
            q[0] - y[0] * scales[0],
            q[1] - y[1] * scales[1],
            q[2] - y[2] * scales[2],
            q[3] - y[3] * scales[3],
        )
        for i in range(4):
            if not low[i] <= trial[i] <= high[i]:
                # of features that are level up to rounding the next one may be anywhere
                return error <= CONTACT_ERROR, q, n, d
        ka, kb = jets_at(a, leaf_a, b, leaf_b, trial)
        new_n = unit(sub(n, (y[4], y[5], y[6])))
        new_d = dot(new_n, sub(kb[0], ka[0]))
        contact_scales(ka, kb, span, scales)
        new_error = scaled_residual(ka, kb, new_n, new_d, span, scales, r)
        most = SHRINKS * error
        if regular:
            # nearly level features begin with next to no error, far from where they are level
            most = MAY_GROW * max(error, NEARLY_LEVEL) if k < FREE_STEPS else error
        if not new_error < most:
            break
        q, n, d, error, ja, jb = trial, new_n, new_d, new_error, ka, kb
        if error <= CONTACT_ROUNDED:
            break
    return error <= CONTACT_ERROR, q, n, d


@kernel
def is_signed_minimum(ja, jb, n, d, span, hollow):
    """Does the signed distance grow in all directions to second order, or stay? Then the
    contact-regular matrix has as many eigenvalues on either side of 0 as at two points apart; these
    numbers do not change with d while it is regular. `hollow`: of how many parameters that a
    feature does not have it is as of a fillet of no radius."""
    J, scales, values = stack_matrix(), stack_reals(), stack_reals()
    contact_scales(ja, jb, span, scales)
    scaled_jacobian(ja, jb, n, d, span, scales, J)
    if not symmetric_eigen(J, values, 8):
        return False
    above, below = 0, 0
    for k in range(8):
        above += 1 if values[k] > FLAT_VALLEY else 0
        below += 1 if values[k] < -FLAT_VALLEY else 0
    return above <= ABOVE_ZERO + hollow and below <= BELOW_ZERO - hollow


@kernel
def limits_of(boxes, spare):
    """The parameters of two boxes, and `spare` widths more on each side."""
    low, high = reals_on_stack(4), reals_on_stack(4)
    for i in range(2):
        box = boxes[i]
        u, v = spare * (box.u1 - box.u0), spare * (box.v1 - box.v0)
        low[2 * i], high[2 * i] = box.u0 - u, box.u1 + u
        low[2 * i + 1], high[2 * i + 1] = box.v0 - v, box.v1 + v
    return (low[0], low[1], low[2], low[3]), (high[0], high[1], high[2], high[3])
