"""The greatest value of a potential over a piece of a solid, bounded by Taylor's formula."""

from math import inf

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.vectors import axpy, cross, dot, norm, rotate, sub
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import (
    chart_record,
    feature_jet,
    moved_jet,
)
from standoff.kernels.body.trimming import on_face
from standoff.kernels.compiler.decorators import kernel, reals_on_stack, shared
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.quadratic_max import line_max, quadratic_max, widened
from standoff.kernels.solids.round_axis import (
    arc_at_most,
    arc_offset,
    round_at_most,
)
from standoff.kernels.solids.spatial_heights import height_greatest, wave_rise
from standoff.kernels.solids.spatial_likeness import (
    OVER_SINE,
    differences,
    to_axis,
    to_own,
    turning,
)
from standoff.kernels.solids.spatial_pieces import (
    CUT_BY_TRIM,
    OUTSIDE_TRIM,
    box_between,
    is_bent,
    is_plane_leaf,
    leaf_ints,
    leaf_jet,
    leaf_reals,
    meets,
    part_in_place,
    put_both_halves,
    put_whole,
    reach_of,
    trim_state,
    whole_box,
)
from standoff.kernels.solids.spatial_tolerances import PARAMETER_SPARE
from standoff.kernels.solids.torus_potential import (
    AXIS_OF,
    CENTRE_OF,
    CIRCLE_OF,
    CONE_OF,
    THIRD,
    TORUS_THROUGH,
    form,
    potential_jet,
    serves,
)

# Boxes of one piece and one potential that wait at a time.
MOST_WAITING = 60
# Parts of one trimming curve that are tested along it, and those that wait: a stack has 252 numbers
# of them, 6 of each and of two more.
MOST_PARTS = 200
PARTS_WAITING = 40


@kernel
def pulled_back(phi, sign, jet, reach):
    """(value, (F_u, F_v), (F_uu, F_uv, F_vv), |D²|, |D³|) of F = sign phi(x(u, v))."""
    x, xu, xv, xuu, xuv, xvv = jet
    value, g, H, c1, c2 = potential_jet(phi, x, reach)
    slope = (sign * dot(g, xu), sign * dot(g, xv))
    second = (
        sign * (form(H, xu, xu) + dot(g, xuu)),
        sign * (form(H, xu, xv) + dot(g, xuv)),
        sign * (form(H, xv, xv) + dot(g, xvv)),
    )
    third = THIRD * (c1 * c1 + c2 * c2) + 3.0 * c1 * c2
    return sign * value, slope, second, c1 + c2, third


@kernel
def third_bounds(m, o, derivatives):
    """Bounds of F_uuu, F_uuv, F_uvv and F_vvv from those of the piece, at m[o:], and of the first
    to the third derivative of the potential."""
    d1, d2, d3 = derivatives
    lu, lv = m[o + S.FIRST], m[o + S.FIRST + 1]
    uu, uv, vv = m[o + S.SECOND], m[o + S.SECOND + 1], m[o + S.SECOND + 2]
    t = o + S.THIRDS
    return (
        d3 * lu * lu * lu + 3.0 * d2 * lu * uu + d1 * m[t],
        d3 * lu * lu * lv + d2 * (2.0 * lu * uv + uu * lv) + d1 * m[t + 1],
        d3 * lu * lv * lv + d2 * (2.0 * lv * uv + vv * lu) + d1 * m[t + 2],
        d3 * lv * lv * lv + 3.0 * d2 * lv * vv + d1 * m[t + 3],
    )


@kernel
def is_plane(phi):
    return phi.kind == TORUS_THROUGH and phi.k1 == 0.0 and phi.k2 == 0.0


@kernel
def swing(side, o, n):
    """The amplitude along n of the ellipse of the affine map at reals[o:]."""
    m, R = side.reals, side.pose.R
    p = dot(n, rotate(R, (m[o], m[o + 3], m[o + 6])))
    q = dot(n, rotate(R, (m[o + 1], m[o + 4], m[o + 7])))
    return sqrt(p * p + q * q)


@kernel
def heights_third(phi, side, leaf, box, thirds):
    """Bounds of the third derivatives of the height over a plane: those of an arc, a cylinder or a
    cone are as great as it swings along the normal."""
    r = leaf_ints(side, leaf)
    if side.own[r + S.DIM] == 1:
        o = arc_offset(side, side.own[r + S.FEATURE])
        return (swing(side, o, phi.n), 0.0, 0.0, 0.0) if o >= 0 else thirds
    if side.own[r + S.DIM] == 2:
        c = chart_record(side.ints, side.own[r + S.CHART])
        kind, o = side.ints[c + L.CHART_KIND], side.ints[c + L.CHART_REALS]
        if kind == L.CYLINDER:
            return (swing(side, o, phi.n), 0.0, 0.0, 0.0)
        if kind == L.CONE:
            w = swing(side, o, phi.n)
            return (w * max(abs(box.v0), abs(box.v1)), w, 0.0, 0.0)
    known, _, axis = turning(side, leaf)
    if known:  # about the normal the height is constant along u
        w = OVER_SINE * norm(cross(phi.n, axis))
        return (w * thirds[0], w * thirds[1], w * thirds[2], thirds[3])
    return thirds


@kernel
def lesser(a, b):
    return min(a[0], b[0]), min(a[1], b[1]), min(a[2], b[2]), min(a[3], b[3])


@kernel
def likely_third(phi, side, leaf, x, reach, thirds):
    """The same for a potential that is nearly the leaf's own, or turns about nearly its axis."""
    o, m = leaf_reals(side, leaf), side.numbers
    e, w = to_own(phi, side, leaf, x, reach)
    if e < inf:
        d = differences(phi, x, reach, e, w)
        if d[0] < inf:
            thirds = lesser(thirds, third_bounds(m, o, d))
    known, point, axis = turning(side, leaf)
    if known:
        e, w = to_axis(phi, point, axis, x, reach)
        d = differences(phi, x, reach, e, w)
        if d[0] < inf:
            t = third_bounds(m, o, d)
            along = thirds[3]
            if phi.kind in (AXIS_OF, CONE_OF):
                # the moved one is linear in each half plane from the axis, where v runs
                along = t[3] + m[o + S.THIRDS + 3]
            thirds = lesser(thirds, (t[0], t[1], t[2], along))
    return thirds


@kernel
def greatest(phi, sign, side, leaf, box, u, v):
    """(bound of sign phi over a box, value and slopes at (u, v), how far the slopes may change)."""
    o, m = leaf_reals(side, leaf), side.numbers
    mu, mv = max(box.u1 - u, u - box.u0), max(box.v1 - v, v - box.v0)
    reach = m[o + S.FIRST] * mu + m[o + S.FIRST + 1] * mv
    value, g, H, d2, d3 = pulled_back(phi, sign, leaf_jet(side, leaf, u, v), reach)
    if d2 == inf:
        return value + reach, value, g, (inf, inf)
    thirds = third_bounds(m, o, (1.0, d2, d3))
    if is_plane(phi):
        thirds = heights_third(phi, side, leaf, box, thirds)
    elif phi.kind != TORUS_THROUGH:
        thirds = likely_third(phi, side, leaf, leaf_jet(side, leaf, u, v)[0], reach, thirds)
    w = o + S.SPREAD
    wide = widened(H, thirds, (m[w], m[w + 1], m[w + 2]), mu, mv)
    e = (box.u0 - u, box.u1 - u, box.v0 - v, box.v1 - v)
    bound = value + quadratic_max(g, wide, e)
    du = (abs(H[0]) + m[w]) * mu + (abs(H[1]) + m[w + 1]) * mv
    du += 0.5 * (thirds[0] * mu * mu + 2.0 * thirds[1] * mu * mv + thirds[2] * mv * mv)
    dv = (abs(H[1]) + m[w + 1]) * mu + (abs(H[2]) + m[w + 2]) * mv
    dv += 0.5 * (thirds[1] * mu * mu + 2.0 * thirds[2] * mu * mv + thirds[3] * mv * mv)
    return min(bound, value + reach), value, g, (du, dv)


@kernel
def greatest_along(phi, sign, most, side, piece, ta, tb):
    """(bound of sign phi over a part of a trimming curve, as far as it is more than `most`, value
    in its middle); where the potential does not serve, no bound and no value."""
    own, m = side.own, side.numbers
    o = own[S.R_PIECES] + S.PIECE_REALS * piece
    h, t = 0.5 * (tb - ta), 0.5 * (ta + tb)
    feature = own[own[S.PIECES] + S.PIECE_INTS * piece + 1]
    jet = moved_jet(side.pose, feature_jet(side.ints, side.reals, feature, -1, t, 0.0))
    l1, l2 = m[o + S.P_FIRST], m[o + S.P_FIRST + 1]
    l3, spread = m[o + S.P_FIRST + 2], m[o + S.P_FIRST + 3]
    if not serves(phi, jet[0], l1 * h):
        return inf, -inf
    value, g, H, d2, d3 = pulled_back(phi, sign, jet, l1 * h)
    bound = value + l1 * h
    if d2 < inf:
        third = d3 * l1 * l1 * l1 + 3.0 * d2 * l1 * l2 + l3
        arc = arc_offset(side, feature)
        if arc >= 0 and is_plane(phi):
            third = swing(side, arc, phi.n)
        bound = min(bound, value + line_max(g[0], H[0] + third * h / 3.0 + spread, -h, h))
        if bound > most and arc >= 0 and is_plane(phi):  # a wave in the angle from the middle
            bound = min(bound, value + wave_rise(g[0], H[0], h))
        elif bound > most and arc >= 0 and phi.kind in (AXIS_OF, CONE_OF, CIRCLE_OF):
            bound = most if arc_at_most(phi, sign, most, jet, -h, h) else bound
    return bound, value


@kernel
def lies_in(at, shift, box):
    """Is a point of a trimming curve in a box of the chart's parameters, up to rounding?"""
    u, v = at[0] + shift, at[1]
    spare_u = PARAMETER_SPARE * (abs(at[0]) + abs(shift))
    spare_v = PARAMETER_SPARE * abs(v)
    return box.u0 - spare_u <= u <= box.u1 + spare_u and box.v0 - spare_v <= v <= box.v1 + spare_v


@kernel
def along_trim(phi, sign, most, part, counts):
    """Whether sign phi is at most `most` on all trimming curves in a part's box: 1 proven, -1 a
    point of one has more, 0 not known."""
    side, box = part.side, part.box
    r = leaf_ints(side, part.leaf)
    own, m = side.own, side.numbers
    first = own[S.LISTS] + own[r + S.LIST]
    stack = reals_on_stack(252)
    rounds = 0
    for k in range(own[r + S.N_LIST]):
        piece = own[first + k]
        if not meets(whole_box(side, piece), box):
            continue
        bent = is_bent(side, piece)
        put_whole(side, piece, stack)
        count = 1
        while count > 0:
            count -= 1
            ends, p, q = part_in_place(stack, count)
            ta, tb = ends
            if not bent and not meets(box_between(side, piece, tb - ta, p, q), box):
                continue
            rounds += 1
            counts[0] += 1
            bound, value = greatest_along(phi, sign, most, side, piece, ta, tb)
            if bound <= most:
                continue
            if rounds > MOST_PARTS or count >= PARTS_WAITING:
                return 0
            put_both_halves(side, piece, stack, count, (ends, p, q))
            if value > most:
                o = own[S.R_PIECES] + S.PIECE_REALS * piece
                shift = m[o + S.P_SHIFT]
                if lies_in(part_in_place(stack, count)[2], shift, box):
                    return -1
                # a curve may come into the box at its end alone
                if value - 0.5 * m[o + S.P_FIRST] * (tb - ta) > most and (
                    lies_in(p, shift, box) or lies_in(q, shift, box)
                ):
                    return -1
            count += 2
    return 1


@kernel
def nearest_to_axis(phi, jet):
    """Steps of a plane's parameters, from its jet, to where the axis of a potential meets it, or to
    the foot of its centre; none where the axis is along the plane."""
    _, xu, xv, _, _, _ = jet
    n = cross(xu, xv)
    a = n if phi.kind == CENTRE_OF else phi.n
    steep = dot(n, a)
    off = sub(phi.o, jet[0])
    if steep == 0.0:
        return 0.0, 0.0
    off = axpy(-dot(n, off) / steep, a, off)
    uu, uv, vv = dot(xu, xu), dot(xu, xv), dot(xv, xv)
    det = uu * vv - uv * uv
    pu, pv = dot(off, xu), dot(off, xv)
    return (pu * vv - pv * uv) / det, (pv * uu - pu * uv) / det


@kernel
def greatest_at_rim(phi, sign, most, part):
    """Of a plane's face in a box: does sign phi exceed `most` on its trimming curves there, if it
    does anywhere? A convex function is greatest at an extreme point of the face: on a curve, or at
    a corner of the box that is on the face. Where a concave one exceeds `most` is convex: if that
    holds a point off the face, a line to it from any other leaves the face across a curve."""
    side, leaf, b = part.side, part.leaf, part.box
    if not is_plane_leaf(side, leaf):
        return False
    convex = sign * phi.sign * (phi.k1 if phi.kind == CONE_OF else 1.0) > 0.0
    if is_plane(phi):
        convex = True
    elif phi.kind not in (AXIS_OF, CONE_OF, CENTRE_OF):
        return False
    if convex:
        for k in range(4):
            u = b.u0 if k < 2 else b.u1
            v = b.v0 if k % 2 == 0 else b.v1
            value = sign * potential_jet(phi, leaf_jet(side, leaf, u, v)[0], 0.0)[0]
            if value > most and trim_state(side, leaf, S.Box(u, u, v, v)) != OUTSIDE_TRIM:
                return False
        return True
    u, v = 0.5 * (b.u0 + b.u1), 0.5 * (b.v0 + b.v1)
    du, dv = nearest_to_axis(phi, leaf_jet(side, leaf, u, v))
    u, v = min(max(u + du, b.u0), b.u1), min(max(v + dv, b.v0), b.v1)
    value = sign * potential_jet(phi, leaf_jet(side, leaf, u, v)[0], 0.0)[0]
    return value > most and trim_state(side, leaf, S.Box(u, u, v, v)) == OUTSIDE_TRIM


@kernel
def held_by_trim(phi, sign, most, part, g, change, counts):
    """Whether sign phi is at most `most` on the part of a face in a box, as `along_trim` tells it:
    because it is greatest on the trimming curves, where it is not more, or because it grows along a
    parameter up to the curves or to a side of the box, where it is not more or where no face is;
    where it grows along both, up to the curves or to a corner of the box."""
    side, leaf, box = part.side, part.leaf, part.box
    along_u, along_v = abs(g[0]) > change[0], abs(g[1]) > change[1]
    at_rim = greatest_at_rim(phi, sign, most, part)
    if not (along_u or along_v or at_rim):
        return 0
    told = along_trim(phi, sign, most, part, counts)
    if told <= 0 or at_rim:
        return told
    if along_u and along_v:
        u = box.u1 if g[0] > 0.0 else box.u0
        v = box.v1 if g[1] > 0.0 else box.v0
        if trim_state(side, leaf, S.Box(u, u, v, v)) == OUTSIDE_TRIM:
            return 1
        return 1 if sign * potential_jet(phi, leaf_jet(side, leaf, u, v)[0], 0.0)[0] <= most else 0
    for k in range(2):
        if not (along_u if k == 0 else along_v):
            continue
        if k == 0:
            at = box.u1 if g[0] > 0.0 else box.u0
            exit_ = S.Box(at, at, box.v0, box.v1)
        else:
            at = box.v1 if g[1] > 0.0 else box.v0
            exit_ = S.Box(box.u0, box.u1, at, at)
        if trim_state(side, leaf, exit_) == OUTSIDE_TRIM:
            return 1
        u, v = 0.5 * (exit_.u0 + exit_.u1), 0.5 * (exit_.v0 + exit_.v1)
        if greatest(phi, sign, side, leaf, exit_, u, v)[0] <= most:
            return 1
    return 0


@kernel
def settled(phi, sign, most, part, q, counts):
    """Whether sign phi is at most `most` on a part, as a whole: 1 proven, -1 a point of the solid
    has more, 0 not known."""
    side, leaf, b = part.side, part.leaf, part.box
    u, v = min(max(q[0], b.u0), b.u1), min(max(q[1], b.v0), b.v1)
    if greatest(phi, sign, side, leaf, b, u, v)[0] <= most:
        return 1
    if round_at_most(phi, sign, most, side, leaf, b, u, v):
        return 1
    if is_plane(phi):
        known, height = height_greatest(phi, sign, side, leaf, b)
        if known and height <= most:
            return 1
    cu, cv = 0.5 * (b.u0 + b.u1), 0.5 * (b.v0 + b.v1)
    if round_at_most(phi, sign, most, side, leaf, b, cu, cv):
        return 1
    bound, value, g, change = greatest(phi, sign, side, leaf, b, cu, cv)
    if bound <= most:
        return 1
    if value - reach_of(side, leaf, 0.5 * (b.u1 - b.u0), 0.5 * (b.v1 - b.v0)) > most:
        return -1  # everywhere
    state = trim_state(side, leaf, b)
    if state == OUTSIDE_TRIM:
        return 1
    if state == CUT_BY_TRIM:
        chart = side.own[leaf_ints(side, leaf) + S.CHART]
        if value > most and on_face(side.ints, side.reals, chart, cu, cv):
            return -1
        return held_by_trim(phi, sign, most, part, g, change, counts)
    return -1 if value > most else 0


@shared
def proven(phi, sign, most, part, q, limit, counts):
    """Is sign phi at most `most` all over the solid's piece that is in a part? Its greatest value
    is expected near the parameters q; `limit` boxes are looked at."""
    side, leaf, box = part.side, part.leaf, part.box
    o, m = leaf_reals(side, leaf), side.numbers
    stack = reals_on_stack(248)
    stack[0], stack[1], stack[2], stack[3] = box.u0, box.u1, box.v0, box.v1
    count, rounds, begun = 1, 0, counts[0]
    while count > 0:
        count -= 1
        n = 4 * count
        b = S.Box(stack[n], stack[n + 1], stack[n + 2], stack[n + 3])
        rounds += 1
        counts[0] += 1
        told = settled(phi, sign, most, S.Part(side, leaf, b), q, counts)
        if told > 0:
            continue
        if told < 0 or rounds > limit or count >= MOST_WAITING:
            return False
        if counts[0] - begun > MOST_PARTS + limit:
            return False
        wide_u = m[o + S.FIRST] * (b.u1 - b.u0)
        wide_v = m[o + S.FIRST + 1] * (b.v1 - b.v0)
        for k in range(2):
            n = 4 * (count + k)
            stack[n], stack[n + 1], stack[n + 2], stack[n + 3] = b.u0, b.u1, b.v0, b.v1
            if wide_u >= wide_v:
                stack[n + 1 - k] = 0.5 * (b.u0 + b.u1)
            else:
                stack[n + 3 - k] = 0.5 * (b.v0 + b.v1)
        count += 2
    return True
