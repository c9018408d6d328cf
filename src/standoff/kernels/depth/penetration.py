"""The signed distance in contact and penetration: local minima of s(n) = h_A(n) + h_B(-n).

h are the support functions: B moved by s(n) n just touches A, so the depth is the least s(n), and
the distance of bodies apart is the greatest -s(n). The pair (A, B + T), shifted out by
T = (s(n) + g) n, stands apart, and the ordinary descent with all its switching finds its closest
points x_a, x_b. Their direction n' has s(n') = (s(n) + g) n'.n - d' <= s(n), as d' >= g: a descent
of s over features of both bodies, whose fixed points are the stationary ones. Newton's method on
the contact-regular form ends it.
"""

from math import inf, nan

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.vectors import (
    add,
    cross,
    dot,
    norm,
    rotate,
    rotate_back,
    scale,
    sub,
    unit,
)
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import chart_jet, chart_normal, pair_slack, pair_span
from standoff.kernels.compiler.decorators import kernel, shared
from standoff.kernels.pair.certificate import certify_along
from standoff.kernels.pair.certified import UNCERTIFIED, on_feature, weigh
from standoff.kernels.pair.cold_start import FIRST, at_samples, farthest_along, global_query
from standoff.kernels.pair.contact_newton import newton
from standoff.kernels.pair.descent import pair_jets, settle
from standoff.kernels.pair.events import RESTARTS, exhausted
from standoff.kernels.tolerances import (
    BLUR,
    CONTACT_RESIDUAL,
    FLAT_RADIUS,
    FOCAL_MARGIN,
    MAX_RESTARTS,
    NEWTON_TURN,
    START_GAP,
    TOUCHING,
)
from standoff.kernels.values import ORIGIN, Depth, Pose, resting

# What Newton's method ended at.
NOTHING, MINIMUM, SADDLE, CUT_OFF = range(4)

UP = (0.0, 0.0, 1.0)  # square to the plane of planar bodies


@kernel
def contact_scale(pair):
    """The length by which shifts and depths are measured: both sizes and radii."""
    ra, rb = pair.reals_a, pair.reals_b
    total = ra[L.SIZE] + rb[L.SIZE] + ra[L.RADIUS] + rb[L.RADIUS]
    return total if total > 0.0 else 1.0


@kernel
def is_planar(pair):
    return pair.ints_a[L.DIMENSION] == 2 or pair.ints_b[L.DIMENSION] == 2


@kernel
def box_support(reals, n):
    """h(n) of the body's box, n in its frame: at least that of the core."""
    total = 0.0
    for k in range(3):
        total += n[k] * reals[L.BOX_CENTRE + k] + abs(n[k]) * reals[L.BOX_HALF + k]
    return total


@kernel
def wall_height(ints, reals, n):
    """h(n) of a half-space along its own normal: its plane's height over its origin."""
    return dot(n, chart_jet(ints, reals, 0, 0.0, 0.0)[0])


@kernel
def box_depth(pair, pose, n):
    """At least s(n), from the bodies' boxes; n is the normal of a body without one."""
    ia, ra, ib, rb = pair
    m = scale(-1.0, rotate_back(pose.R, n))
    above_a = wall_height(ia, ra, n) if ia[L.UNBOUNDED] else box_support(ra, n)
    above_b = wall_height(ib, rb, m) if ib[L.UNBOUNDED] else box_support(rb, m)
    return -dot(n, pose.p) + above_a + above_b


@kernel
def plane_normal(pair, pose):
    """(is a body a half-space, the only direction from A to B that can part it from the other)."""
    ia, ra, ib, rb = pair
    if ia[L.UNBOUNDED]:
        return True, chart_normal(ia, ra, 0, 0.0, 0.0)
    if ib[L.UNBOUNDED]:
        return True, scale(-1.0, rotate(pose.R, chart_normal(ib, rb, 0, 0.0, 0.0)))
    return False, UP


@kernel
def begin_along(pair, pose, n):
    """The place of the samples farthest along n and -n."""
    i, j = farthest_along(pair, pose, n)
    return at_samples(pair, i, j)


@kernel
def tangents(n):
    """Two unit vectors perpendicular to n and to each other."""
    axis = (1.0, 0.0, 0.0) if abs(n[0]) < 0.6 else (0.0, 1.0, 0.0)
    e = unit(cross(n, axis))
    return e, cross(n, e)


@kernel
def radii(jet, n, e_1, e_2, flat):
    """(r_11, r_12, r_22): how fast the support point of a feature moves as its outward normal n
    turns, along e_1 and e_2; at most `flat`. For a face the inverse of the shape operator, 0 for
    a vertex.
    """
    fu, fv = jet[1], jet[2]
    au, av = dot(fu, fu), dot(fv, fv)
    if au == 0.0 and av == 0.0:
        return 0.0, 0.0, 0.0
    if av == 0.0 or au == 0.0:
        t, tt, a = (fu, jet[3], au) if av == 0.0 else (fv, jet[5], av)
        r = a / max(-dot(n, tt), a / flat)
        i, k = dot(e_1, t) / sqrt(a), dot(e_2, t) / sqrt(a)
        return r * i * i, r * i * k, r * k * k
    # whitened by the lengths of the tangents
    su, sv = 1.0 / sqrt(au), 1.0 / sqrt(av)
    b_uu = max(-dot(n, jet[3]) * su * su, 0.0) + 1.0 / flat
    b_uv = -dot(n, jet[4]) * su * sv
    b_vv = max(-dot(n, jet[5]) * sv * sv, 0.0) + 1.0 / flat
    det = max(b_uu * b_vv - b_uv * b_uv, b_uu / flat, b_vv / flat)
    p_1, p_2 = dot(e_1, fu) * su, dot(e_2, fu) * su
    q_1, q_2 = dot(e_1, fv) * sv, dot(e_2, fv) * sv
    r_11 = (p_1 * p_1 * b_vv - 2.0 * p_1 * q_1 * b_uv + q_1 * q_1 * b_uu) / det
    r_12 = (p_1 * p_2 * b_vv - (p_1 * q_2 + p_2 * q_1) * b_uv + q_1 * q_2 * b_uu) / det
    r_22 = (p_2 * p_2 * b_vv - 2.0 * p_2 * q_2 * b_uv + q_2 * q_2 * b_uu) / det
    return r_11, r_12, r_22


@kernel
def principal_radii(pair, jet_a, jet_b, n, span):
    """(least, way, greatest, other way): the eigenvalues and unit vectors of the sum of both radii
    of curvature along n. In the plane the greatest is inf.
    """
    e_1, e_2 = tangents(n)
    flat = FLAT_RADIUS * span
    a_11, a_12, a_22 = radii(jet_a, n, e_1, e_2, flat)
    b_11, b_12, b_22 = radii(jet_b, scale(-1.0, n), e_1, e_2, flat)
    r_11, r_12, r_22 = a_11 + b_11, a_12 + b_12, a_22 + b_22
    if is_planar(pair):
        flat_way = (-n[1], n[0], 0.0)
        i, k = dot(flat_way, e_1), dot(flat_way, e_2)
        return i * i * r_11 + 2.0 * i * k * r_12 + k * k * r_22, flat_way, inf, UP
    mean, half = 0.5 * (r_11 + r_22), 0.5 * (r_11 - r_22)
    root = sqrt(half * half + r_12 * r_12)
    # det / (mean + root): the difference mean - root loses the lesser one's digits
    least = (r_11 * r_22 - r_12 * r_12) / (mean + root) if mean + root > 0.0 else 0.0
    if r_11 <= r_22:
        x, y = half - root, r_12
    else:
        x, y = -r_12, half + root
    length = sqrt(x * x + y * y)
    x, y = (x / length, y / length) if length > 0.0 else (1.0, 0.0)
    way = add(scale(x, e_1), scale(y, e_2))
    other = add(scale(-y, e_1), scale(x, e_2))
    return least, way, mean + root, other


@shared
def shifted(pair, pose, start, gap, work):
    """(apart, depth): one step of the descent from a depth's direction, along which the signed
    distance is at least its own; its place is warm. The pair is shifted out to `gap` (in contact
    scales). Not apart, too, where the evaluations ran out on the way.
    """
    n, d = start.normal, start.distance
    gap *= contact_scale(pair)
    shift = scale(max(gap - d, 0.0), n)
    out = Pose(pose.R, add(pose.p, shift))
    settled = settle(pair, resting(out), start.place, 0.0, 0.0, work)
    place, jets = settled.place, settled.jets
    outcome = weigh(pair, out, place, jets, ORIGIN, START_GAP).outcome
    if outcome == UNCERTIFIED and exhausted(work):
        return False, Depth(False, d, n, place)  # cut off: the next frame goes on from there
    if outcome == UNCERTIFIED and work.counts[RESTARTS] < MAX_RESTARTS:
        # stuck on a far side
        work.counts[RESTARTS] += 1
        place = global_query(pair, out, FIRST, START_GAP, work).place
        jets = pair_jets(pair, out, place)
    between = sub(jets[1][0], jets[0][0])
    far = norm(between)
    if far <= TOUCHING * pair_span(pair, out.p, far) or far == 0.0:
        return False, Depth(False, d, n, place)
    n = scale(1.0 / far, between)
    return True, Depth(False, dot(n, sub(between, shift)), n, place)


@shared
def stationary_along(pair, pose, start, tolerance, work):
    """(kind, depth, way): Newton's method from a depth's direction and place, taken where it ends
    at a certified stationary direction no deeper than the start: MINIMUM, or SADDLE, which falls
    along `way`. Else NOTHING, or CUT_OFF where the evaluations ran out on the way; the depth is
    where it ended.
    """
    d = start.distance
    span = pair_span(pair, pose.p, abs(d))
    if span == 0.0:
        span = contact_scale(pair)
    ended = newton(pair, pose, start.place, start.normal, d, span, work)
    n_new, d_new, place = ended.normal, ended.distance, ended.place
    plane, normal = plane_normal(pair, pose)
    if ended.fits and ended.error <= CONTACT_RESIDUAL and d_new >= d - CONTACT_RESIDUAL * span:
        jet_a, jet_b = pair_jets(pair, pose, place)
        if plane:  # any other n, be it by roundoff, bounds nothing
            n_new = normal
            d_new = dot(n_new, sub(jet_b[0], jet_a[0]))
        lower, blur = certify_along(pair, pose, place, (jet_a, jet_b), n_new)
        allowed = min(tolerance, BLUR) * span + pair_slack(pair) + min(blur, BLUR * span)
        if d_new - lower <= allowed and on_feature(pair, place):
            # the focal depth: beyond it a stationary direction is no minimum
            least, way, _, _ = principal_radii(pair, jet_a, jet_b, n_new, span)
            minimal = least >= -d_new * (1.0 - FOCAL_MARGIN) - CONTACT_RESIDUAL * span
            return MINIMUM if minimal else SADDLE, Depth(minimal, d_new, n_new, place), way
    cut = ended.fits and exhausted(work) and on_feature(pair, place)
    return CUT_OFF if cut else NOTHING, Depth(False, d_new, n_new, place), start.normal


@kernel
def minimum_along(pair, pose, start, tolerance, work):
    """(kind, depth, way): what `stationary_along` finds, MINIMUM or SADDLE; else NOTHING and the
    start.
    """
    kind, ended, way = stationary_along(pair, pose, start, tolerance, work)
    if kind in (MINIMUM, SADDLE):
        return kind, ended, way
    return NOTHING, start, start.normal


@kernel
def from_last(pair, pose, last, tolerance, work):
    """The local minimum of s by Newton's method from the last frame's direction and points, which
    it is near. Not found: the distance is nan, direction and points are the last frame's or those
    at which the evaluations ran out.
    """
    n = last.normal
    start = Depth(False, -box_depth(pair, pose, n), n, last.place)
    kind, ended, _ = stationary_along(pair, pose, start, tolerance, work)
    near = norm(sub(ended.normal, n)) <= NEWTON_TURN
    if kind == MINIMUM and near:
        return ended
    if kind == CUT_OFF and near:
        return Depth(False, nan, ended.normal, ended.place)
    return Depth(False, nan, n, last.place)
