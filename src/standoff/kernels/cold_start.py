"""The global start: sampled pairs, descent, certificate, and another start where it fails.

A stationary point on the far side of a body is no minimum; its certificate fails and the next
start is taken. Starts: the nearest sampled pair whose normals face each other, then the support
samples along the direction found by Gilbert's iteration on the samples, then those along the
directions of earlier failures.
"""

from math import inf

from standoff.kernels import layout as L
from standoff.kernels.certified import UNCERTIFIED, settle_and_weigh
from standoff.kernels.compiling import kernel, shared
from standoff.kernels.descent import ORIGIN, pair_jets, set_mode
from standoff.kernels.events import EVALUATIONS, LIMIT, RESTARTS
from standoff.kernels.vectors import add, dot, norm, rotate, rotate_back, scale, sub

MAX_STARTS = 12
GILBERT_STEPS = 40
# How strongly a restart's direction is mixed with those before it, a start (dimensionless).
TURN = 0.3


@kernel
def sample_point(ints, reals, k):
    o = ints[L.SAMPLE_REALS] + L.SAMPLE_STRIDE * k
    return (reals[o], reals[o + 1], reals[o + 2])


@kernel
def sample_normal(ints, reals, k):
    o = ints[L.SAMPLE_REALS] + L.SAMPLE_STRIDE * k + 3
    return (reals[o], reals[o + 1], reals[o + 2])


@kernel
def begin_at(ints, reals, body, k, mode, q):
    o = ints[L.SAMPLE_REALS] + L.SAMPLE_STRIDE * k + 6
    i = ints[L.SAMPLES] + 2 * k
    set_mode(mode, q, body, ints[i], ints[i + 1], reals[o], reals[o + 1])


@kernel
def support_sample(ints, reals, n):
    """The sample farthest along n (body frame)."""
    best, at = -inf, 0
    for k in range(ints[L.N_SAMPLES]):
        h = dot(n, sample_point(ints, reals, k))
        if h > best:
            best, at = h, k
    return at


@kernel
def nearest_facing(pair, R, p):
    """(i, j): the nearest sampled pair whose outward normals face each other."""
    ia, ra, ib, rb = pair
    best, at_i, at_j = inf, 0, 0
    for j in range(ib[L.N_SAMPLES]):
        y = add(rotate(R, sample_point(ib, rb, j)), p)
        m = rotate(R, sample_normal(ib, rb, j))
        for i in range(ia[L.N_SAMPLES]):
            gap = sub(y, sample_point(ia, ra, i))
            d2 = dot(gap, gap)
            if d2 < best and dot(gap, m) <= 0.0 and dot(gap, sample_normal(ia, ra, i)) >= 0.0:
                best, at_i, at_j = d2, i, j
    return at_i, at_j


@kernel
def gilbert(pair, R, p):
    """Direction from A to B of nearly least distance between the samples' convex hulls."""
    ia, ra, ib, rb = pair
    w = sub(add(rotate(R, sample_point(ib, rb, 0)), p), sample_point(ia, ra, 0))
    for _ in range(GILBERT_STEPS):
        i = support_sample(ia, ra, w)
        j = support_sample(ib, rb, scale(-1.0, rotate_back(R, w)))
        v = sub(add(rotate(R, sample_point(ib, rb, j)), p), sample_point(ia, ra, i))
        edge = sub(v, w)
        length2 = dot(edge, edge)
        if length2 == 0.0:
            break
        s = -dot(w, edge) / length2
        if s <= 0.0:
            break
        w = add(w, scale(min(s, 1.0), edge))
    return w


@shared
def global_query(pair, R, p, first, mode, q, w_ff, tolerance, counts, events):
    """(outcome, d, bound, normal) of a cold query; (mode, q) are set to its witness points.

    `tolerance` (relative to the pair's size) is the gap between distance and bound at which a
    start is accepted. Without one, the answer is that of the least gap. `first` (a float: every
    literal int would compile once more) is the start that is tried first.
    """
    ia, ra, ib, rb = pair
    best_gap, best_d, best_bound, best_normal = inf, inf, -inf, (0.0, 0.0, 0.0)
    best_mode, best_q = (0, 0, 0, 0), (0.0, 0.0, 0.0, 0.0)
    direction = (0.0, 0.0, 0.0)
    outcome = UNCERTIFIED
    for attempt in range(int(first), MAX_STARTS):
        if attempt == 0:
            i, j = nearest_facing(pair, R, p)
        else:
            counts[RESTARTS] += 1
            if attempt == 1:
                direction = gilbert(pair, R, p)
            i = support_sample(ia, ra, direction)
            j = support_sample(ib, rb, scale(-1.0, rotate_back(R, direction)))
        begin_at(ia, ra, 0, i, mode, q)
        begin_at(ib, rb, 1, j, mode, q)
        _, outcome, d, bound, normal = settle_and_weigh(
            pair, R, p, ORIGIN, ORIGIN, mode, q, w_ff, 0.0, 0.0, tolerance, counts, events
        )
        if d - bound < best_gap or outcome != UNCERTIFIED:
            best_gap, best_d, best_bound, best_normal = d - bound, d, bound, normal
            best_mode = (mode[0], mode[1], mode[2], mode[3])
            best_q = (q[0], q[1], q[2], q[3])
        if outcome != UNCERTIFIED or counts[EVALUATIONS] >= counts[LIMIT]:
            break
        # aim the next start along this failure's gap, turned a little more each time
        jet_a, jet_b = pair_jets(pair, R, p, mode, q)
        gap = scale(1.0 / max(d, 1e-300), sub(jet_b[0], jet_a[0]))
        direction = add(gap, scale(TURN * attempt, direction))
        if norm(direction) == 0.0:
            direction = (1.0, 0.0, 0.0)
    mode[0], mode[1], mode[2], mode[3] = best_mode
    q[0], q[1], q[2], q[3] = best_q
    return outcome, best_d, best_bound, best_normal
