"""The signed distance in contact and penetration: local minima of s(n) = h_A(n) + h_B(-n).

h are the support functions: B moved by s(n) n just touches A, so the depth is the least s(n), and
the distance of bodies apart is the greatest -s(n). The pair (A, B + T), shifted out by
T = (s(n) + g) n, stands apart, and the ordinary descent with all its switching finds its closest
points x_a, x_b. Their direction n' has s(n') = (s(n) + g) n'.n - d' <= s(n), as d' >= g: a descent
of s over features of both bodies, whose fixed points are the stationary ones. Newton's method on
the contact-regular form ends it.
"""

from math import inf, nan, sqrt

from standoff.kernels import layout as L
from standoff.kernels.certificate import certify_along
from standoff.kernels.certified import UNCERTIFIED, on_feature, weigh
from standoff.kernels.cold_start import begin_at, global_query, support_sample
from standoff.kernels.compiling import kernel, shared
from standoff.kernels.contact import newton
from standoff.kernels.descent import ORIGIN, pair_jets, settle
from standoff.kernels.events import EVALUATIONS, LIMIT, RESTARTS
from standoff.kernels.features import pair_slack, pair_span
from standoff.kernels.tolerances import (
    BLUR,
    CONTACT_RESIDUAL,
    FLAT_RADIUS,
    FOCAL_MARGIN,
    LEAST_GAP,
    LESS_REACH,
    MAX_LEAP,
    MAX_RESTARTS,
    MAX_SHIFTS,
    MOVE_IN,
    NEWTON_TURN,
    NUDGE,
    ROUNDED_RADIUS,
    SADDLE_SHIFTS,
    SHIFTED_GAP,
    START_GAP,
    TOUCHING,
)
from standoff.kernels.vectors import (
    add,
    axpy,
    cross,
    dot,
    norm,
    rotate,
    rotate_back,
    scale,
    sub,
    unit,
)

# What Newton's method ended at.
NOTHING, MINIMUM, SADDLE, CUT_OFF = range(4)

UP = (0.0, 0.0, 1.0)  # outward normal of a half-space, in its frame


@kernel
def contact_scale(pair):
    """The length that shifts and depths are measured by: both sizes and radii."""
    total = pair[1][L.SIZE] + pair[3][L.SIZE] + pair[1][L.RADIUS] + pair[3][L.RADIUS]
    return total if total > 0.0 else 1.0


@kernel
def box_support(reals, n):
    """h(n) of the body's box, n in its frame: at least that of the core."""
    total = 0.0
    for k in range(3):
        total += n[k] * reals[L.BOX_CENTRE + k] + abs(n[k]) * reals[L.BOX_HALF + k]
    return total


@kernel
def box_depth(pair, R, p, n):
    """At least s(n), from the bodies' boxes; n is the normal of a body without one."""
    ia, ra, ib, rb = pair
    total = -dot(n, p)
    if not ia[L.UNBOUNDED]:
        total += box_support(ra, n)
    if not ib[L.UNBOUNDED]:
        total += box_support(rb, scale(-1.0, rotate_back(R, n)))
    return total


@kernel
def plane_normal(pair, R):
    """(is a body a half-space, the only direction from A to B that can part it from the other)."""
    if pair[0][L.UNBOUNDED]:
        return True, UP
    if pair[2][L.UNBOUNDED]:
        return True, scale(-1.0, rotate(R, UP))
    return False, UP


@kernel
def begin_along(pair, R, n, mode, q):
    """Set the witness points to the samples farthest along n and -n."""
    ia, ra, ib, rb = pair
    begin_at(ia, ra, 0, support_sample(ia, ra, n), mode, q)
    begin_at(ib, rb, 1, support_sample(ib, rb, scale(-1.0, rotate_back(R, n))), mode, q)


@kernel
def tangents(n):
    """Two unit vectors square to n and to each other."""
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
    if pair[0][L.DIMENSION] == 2 or pair[2][L.DIMENSION] == 2:
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


@kernel
def newton_start(pair, R, p, n, mode, q, reach):
    """(defined, start): Newton's step of s(n) from n, no farther than `reach`; along directions in
    which s is concave, where the focal depth is passed, as far downhill. (mode, q) are the points
    farthest along n. Not defined where a corner makes s(n) linear.
    """
    jet_a, jet_b = pair_jets(pair, R, p, mode, q)
    between = sub(jet_a[0], jet_b[0])
    s = dot(n, between)
    least, way, most, other = principal_radii(pair, jet_a, jet_b, n, contact_scale(pair))
    # beside a flat direction the lesser radius keeps that one's roundings
    noise = ROUNDED_RADIUS * most if most < inf else 0.0
    if least <= CONTACT_RESIDUAL * contact_scale(pair) + noise:
        return False, n
    g_1, g_2 = dot(way, between), dot(other, between)
    h_1, h_2 = abs(least - s), abs(most - s)
    step_1 = -g_1 / h_1 if abs(g_1) < reach * h_1 else (-reach if g_1 > 0.0 else reach)
    step_2 = -g_2 / h_2 if abs(g_2) < reach * h_2 else (-reach if g_2 > 0.0 else reach)
    return True, unit(axpy(step_1, way, axpy(step_2, other, n)))


@shared
def shifted(pair, R, p, n, d, gap, mode, q, w_ff, counts, events):
    """(apart, n', d'): one step of the descent from the direction n, where the signed distance is
    at least d; mode and q are warm and get the closest points of the pair shifted out to `gap`
    (in contact scales). Not apart, too, where the evaluations ran out on the way.
    """
    gap *= contact_scale(pair)
    shift = scale(max(gap - d, 0.0), n)
    moved = add(p, shift)
    _, _, jet_a, jet_b = settle(
        pair, R, moved, ORIGIN, ORIGIN, mode, q, w_ff, 0.0, 0.0, counts, events
    )
    outcome, _, _, _ = weigh(pair, R, moved, mode, q, jet_a, jet_b, ORIGIN, START_GAP)
    if outcome == UNCERTIFIED and counts[EVALUATIONS] >= counts[LIMIT]:
        return False, n, d  # cut off: the next frame goes on from these points
    if outcome == UNCERTIFIED and counts[RESTARTS] < MAX_RESTARTS:
        # stuck on a far side
        counts[RESTARTS] += 1
        begin_along(pair, R, n, mode, q)
        global_query(pair, R, moved, 0.0, mode, q, w_ff, START_GAP, counts, events)
        jet_a, jet_b = pair_jets(pair, R, moved, mode, q)
    between = sub(jet_b[0], jet_a[0])
    far = norm(between)
    if far <= TOUCHING * pair_span(pair, moved, far) or far == 0.0:
        return False, n, d
    n = scale(1.0 / far, between)
    return True, n, dot(n, sub(between, shift))


@shared
def stationary_along(pair, R, p, mode, q, n, d, tolerance, counts):
    """(kind, n, d, way): Newton's method from a direction, taken where it ends at a certified
    stationary direction no deeper than the start: MINIMUM, or SADDLE, which falls along `way`.
    Else NOTHING, or CUT_OFF where the evaluations ran out on the way; (mode, q) are where it ended.
    """
    span = pair_span(pair, p, abs(d))
    if span == 0.0:
        span = contact_scale(pair)
    fits, error, n_new, d_new = newton(pair, R, p, mode, q, n, d, span, counts)
    plane, normal = plane_normal(pair, R)
    if fits and error <= CONTACT_RESIDUAL and d_new >= d - CONTACT_RESIDUAL * span:
        jet_a, jet_b = pair_jets(pair, R, p, mode, q)
        if plane:  # any other n, be it by roundoff, bounds nothing
            n_new = normal
            d_new = dot(n_new, sub(jet_b[0], jet_a[0]))
        bound, blur = certify_along(pair, R, p, mode, q, jet_a[0], jet_b[0], n_new)
        allowed = min(tolerance, BLUR) * span + pair_slack(pair) + min(blur, BLUR * span)
        if d_new - bound <= allowed and on_feature(pair, mode, q):
            # the focal depth: beyond it a stationary direction is no minimum
            least, way, _, _ = principal_radii(pair, jet_a, jet_b, n_new, span)
            minimal = least >= -d_new * (1.0 - FOCAL_MARGIN) - CONTACT_RESIDUAL * span
            return MINIMUM if minimal else SADDLE, n_new, d_new, way
    cut = fits and counts[EVALUATIONS] >= counts[LIMIT] and on_feature(pair, mode, q)
    return CUT_OFF if cut else NOTHING, n_new, d_new, n


@kernel
def minimum_along(pair, R, p, mode, q, n, d, tolerance, counts):
    """What `stationary_along` finds, MINIMUM or SADDLE; else NOTHING, with n and d as given and
    mode and q as they were.
    """
    old_mode = (mode[0], mode[1], mode[2], mode[3])
    old_q = (q[0], q[1], q[2], q[3])
    kind, n_new, d_new, way = stationary_along(pair, R, p, mode, q, n, d, tolerance, counts)
    if kind in (MINIMUM, SADDLE):
        return kind, n_new, d_new, way
    restore(mode, q, old_mode, old_q)
    return NOTHING, n, d, n


@kernel
def from_last(pair, R, p, mode, q, n, tolerance, counts):
    """(found, n, d): the local minimum of s by Newton's method from the last frame's direction and
    points, which they are near. Not found: d is nan, and n and the points are the last frame's or
    those at which the evaluations ran out.
    """
    old_mode = (mode[0], mode[1], mode[2], mode[3])
    old_q = (q[0], q[1], q[2], q[3])
    least = -box_depth(pair, R, p, n)
    kind, n_new, d_new, _ = stationary_along(pair, R, p, mode, q, n, least, tolerance, counts)
    near = norm(sub(n_new, n)) <= NEWTON_TURN
    if kind == MINIMUM and near:
        return True, n_new, d_new
    if kind == CUT_OFF and near:
        return False, n_new, nan
    restore(mode, q, old_mode, old_q)
    return False, n, nan


@kernel
def restore(mode, q, old_mode, old_q):
    mode[0], mode[1], mode[2], mode[3] = old_mode
    q[0], q[1], q[2], q[3] = old_q


@kernel
def next_start(n, start, n_new, turn, ahead):
    """(start, ahead) of the next step at corners, after one from `start` to n_new; n was the last.

    Steps may shrink by little, so the next one starts ahead, farther each time. A long step back
    had leapt past.
    """
    step = sub(n_new, start)
    if turn == 0.0 or (turn > NEWTON_TURN and dot(step, sub(start, n)) < 0.0):
        return n_new, 0.0
    ahead = min(2.0 * ahead, MAX_LEAP) if ahead > 0.0 else 1.0
    return unit(axpy(min(ahead, NEWTON_TURN / turn), step, n_new)), ahead


@shared
def descend(pair, R, p, n, d, mode, q, w_ff, tolerance, counts, events):
    """(found, n, d) of the local minimum of s reached from the direction n; (mode, q) are warm.

    d is a guess of the signed distance along n, nan for none. Not found: n and d are the last of
    the descent. A saddle is left along its steepest way; where s does not fall there by more than
    roundoff (across a crease, whose radius of curvature is 0 on a line only), it is the minimum.
    """
    if d != d:
        d = -box_depth(pair, R, p, n)
    restarted, falls = False, 0
    before, ahead, gap, reach = -inf, 0.0, SHIFTED_GAP, NEWTON_TURN
    start = n
    last_mode, last_q = (mode[0], mode[1], mode[2], mode[3]), (q[0], q[1], q[2], q[3])
    top_mode, top_q = (mode[0], mode[1], mode[2], mode[3]), (q[0], q[1], q[2], q[3])
    top_n, top = n, -inf
    for k in range(1, MAX_SHIFTS + 1):
        if counts[EVALUATIONS] >= counts[LIMIT]:
            break
        apart, n_new, d_new = shifted(pair, R, p, start, d, gap, mode, q, w_ff, counts, events)
        if not apart and counts[EVALUATIONS] >= counts[LIMIT]:
            return False, n, d
        if ahead > 0.0 and (not apart or d_new < d):
            start, ahead, reach = n, 0.0, reach / LESS_REACH  # leapt too far
            continue
        if not apart:  # the guess was too near
            farther = -box_depth(pair, R, p, start)
            if d <= farther:
                break
            d = farther
            continue
        turn = norm(sub(n_new, start))
        last_mode, last_q = (mode[0], mode[1], mode[2], mode[3]), (q[0], q[1], q[2], q[3])
        if ahead > 0.0:
            reach = min(2.0 * reach, NEWTON_TURN)
        curved, farther_on = newton_start(pair, R, p, n_new, mode, q, reach)
        if curved:
            start, ahead = farther_on, 1.0
        else:
            start, ahead = next_start(n, start, n_new, turn, ahead)
        if k % MOVE_IN == 0:
            # features that meet beside the normal turn it by their offset over the gap
            gap = max(gap / MAX_LEAP, LEAST_GAP)
        n, d = n_new, d_new
        span = pair_span(pair, p, abs(d))
        if top > -inf:
            falls += 1
            if d > top + CONTACT_RESIDUAL * span:
                top, falls = -inf, 0
            elif falls > SADDLE_SHIFTS:
                restore(mode, q, top_mode, top_q)
                return True, top_n, top
        if turn <= NEWTON_TURN:
            kind, n_end, d_end, way = minimum_along(pair, R, p, mode, q, n, d, tolerance, counts)
            if kind == MINIMUM:
                return True, n_end, d_end
            if kind == SADDLE and top == -inf:
                top_mode = (mode[0], mode[1], mode[2], mode[3])
                top_q = (q[0], q[1], q[2], q[3])
                top_n, top = n_end, d_end
                start = unit(axpy(NUDGE, way, n_end))
                d = -box_depth(pair, R, p, start)
                before, ahead = -inf, 0.0
                continue
        if turn <= CONTACT_RESIDUAL or d <= before:
            # at rest, yet not certified: witness points on a far side start from the samples
            if restarted:
                break
            restarted = True
            counts[RESTARTS] += 1
            begin_along(pair, R, n, mode, q)
            start, before, ahead = n, -inf, 0.0
            continue
        before = d
    if top > -inf and not d > top + CONTACT_RESIDUAL * pair_span(pair, p, abs(top)):
        restore(mode, q, top_mode, top_q)
        return True, top_n, top
    restore(mode, q, last_mode, last_q)
    return False, n, d
