"""The global start: sampled pairs, descent, certificate, and another start where it fails.

A stationary point on the far side of a body is no minimum; its certificate fails and the next
start is taken. Starts: samples of which either is the nearest to the other, found in turn; the
nearest of all sampled pairs whose normals face each other; the support samples along the direction
found by Gilbert's iteration on the samples; then those along the directions of earlier failures.
"""

from math import inf

import numpy as np

from standoff.kernels.algebra.vectors import add, dot, norm, rotate, rotate_back, scale, sub
from standoff.kernels.body import layout as L
from standoff.kernels.compiler.decorators import kernel, shared, small
from standoff.kernels.pair.certified import UNCERTIFIED, settle_and_weigh
from standoff.kernels.pair.descent import pair_jets
from standoff.kernels.pair.events import RESTARTS, exhausted
from standoff.kernels.tolerances import LEAST_DIVISOR, MIXING
from standoff.kernels.values import NO_CHART, ORIGIN, Found, Place, Side, resting, together

MAX_STARTS = 13
GILBERT_STEPS = 40
ALTERNATIONS = 6  # two or three are the rule
FIRST = np.int64(0)  # the start that is tried first; of the type of a count
NOWHERE = Place(FIRST, FIRST, FIRST, FIRST, 0.0, 0.0, 0.0, 0.0)


@kernel
def sample_point(ints, reals, k):
    o = ints[L.SAMPLE_REALS] + L.SAMPLE_STRIDE * k
    return (reals[o], reals[o + 1], reals[o + 2])


@kernel
def sample_normal(ints, reals, k):
    o = ints[L.SAMPLE_REALS] + L.SAMPLE_STRIDE * k + 3
    return (reals[o], reals[o + 1], reals[o + 2])


@kernel
def at_sample(ints, reals, k):
    """The side of a body's sample."""
    o = ints[L.SAMPLE_REALS] + L.SAMPLE_STRIDE * k + 6
    i = ints[L.SAMPLES] + 2 * k
    return Side(ints[i], ints[i + 1], reals[o], reals[o + 1])


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
def farthest_along(pair, pose, n):
    """(i, j): the samples of A farthest along n, and of B farthest along -n."""
    i = support_sample(pair.ints_a, pair.reals_a, n)
    back = scale(-1.0, rotate_back(pose.R, n))
    return i, support_sample(pair.ints_b, pair.reals_b, back)


@kernel
def at_samples(pair, i, j):
    """The place of a sample of each body."""
    return together(
        at_sample(pair.ints_a, pair.reals_a, i), at_sample(pair.ints_b, pair.reals_b, j)
    )


@kernel
def nearest_facing(pair, pose):
    """(i, j): the nearest sampled pair whose outward normals face each other."""
    ia, ra, ib, rb = pair
    R, p = pose
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


@small
def any_sample(ints, k, chart):
    """What `nearest_of` takes where every sample will do."""
    return True


@small
def on_other_face(ints, k, chart):
    """What it takes where a sample is to lie on a face, and not in a chart that is given."""
    i = ints[L.SAMPLES] + 2 * k
    return ints[i] < ints[L.N_FACES] and ints[i + 1] != chart


@small
def nearest_of(suits, ints, reals, z, normal, chart):
    """The nearest of a body's samples to a point, of those that it faces and that face it; `normal`
    is the outward one at the point, zero where it has none. All in the body's frame.

    `suits` tells of a sample and the chart whether it may be taken; -1 if there is none.
    """
    best, at = inf, -1
    for k in range(ints[L.N_SAMPLES]):
        gap = sub(z, sample_point(ints, reals, k))
        d2 = dot(gap, gap)
        nearer = d2 < best and suits(ints, k, chart)
        if nearer and dot(gap, sample_normal(ints, reals, k)) >= 0.0 and dot(gap, normal) <= 0.0:
            best, at = d2, k
    return at


@small
def first_nearest(suits, ints, reals, z, normal):
    """`nearest_of`, in any chart; the first sample if there is none."""
    return max(nearest_of(suits, ints, reals, z, normal, NO_CHART), 0)


@kernel
def nearest_to(ints, reals, z, normal):
    """`first_nearest` of all samples."""
    return first_nearest(any_sample, ints, reals, z, normal)


@small
def alternating_of(suits, pair, pose):
    """(i, j): samples of which either is the nearest to the other that faces it, from the middle of
    A's box on; of those that `suits` takes. `nearest_facing` compares all with all, and is seldom
    better.
    """
    ia, ra, ib, rb = pair
    R, p = pose
    centre = (ra[L.BOX_CENTRE], ra[L.BOX_CENTRE + 1], ra[L.BOX_CENTRE + 2])
    j = first_nearest(suits, ib, rb, rotate_back(R, sub(centre, p)), ORIGIN)
    i = 0
    for _ in range(ALTERNATIONS):
        y, m = add(rotate(R, sample_point(ib, rb, j)), p), rotate(R, sample_normal(ib, rb, j))
        i = first_nearest(suits, ia, ra, y, m)
        z = rotate_back(R, sub(sample_point(ia, ra, i), p))
        last, j = j, first_nearest(suits, ib, rb, z, rotate_back(R, sample_normal(ia, ra, i)))
        if j == last:
            break
    return i, j


@kernel
def alternating(pair, pose):
    """`alternating_of` all samples."""
    return alternating_of(any_sample, pair, pose)


@kernel
def gilbert(pair, pose):
    """Direction from A to B of nearly least distance between the samples' convex hulls."""
    ia, ra, ib, rb = pair
    R, p = pose
    w = sub(add(rotate(R, sample_point(ib, rb, 0)), p), sample_point(ia, ra, 0))
    for _ in range(GILBERT_STEPS):
        i, j = farthest_along(pair, pose, w)
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
def global_query(pair, pose, first, tolerance, work):
    """A cold query of bodies that are apart; where no start is certified, that of the least gap.

    `tolerance` (relative to the pair's size) is the gap between distance and bound at which a
    start is accepted, `first` the start that is tried first.
    """
    best_gap = inf
    best = Found(UNCERTIFIED, NOWHERE, inf, -inf, inf, ORIGIN)
    direction = ORIGIN
    for attempt in range(first, MAX_STARTS):
        if attempt == 0:
            i, j = alternating(pair, pose)
        elif attempt == 1:
            work.counts[RESTARTS] += 1
            i, j = nearest_facing(pair, pose)
        else:
            work.counts[RESTARTS] += 1
            if attempt == 2:
                direction = gilbert(pair, pose)
            i, j = farthest_along(pair, pose, direction)
        start = at_samples(pair, i, j)
        found = settle_and_weigh(pair, resting(pose), start, 0.0, 0.0, tolerance, work).found
        if found.distance - found.lower < best_gap or found.outcome != UNCERTIFIED:
            best_gap = found.distance - found.lower
            best = found
        if found.outcome != UNCERTIFIED or exhausted(work):
            break
        # aim the next start along this failure's gap, turned a little more each time
        jet_a, jet_b = pair_jets(pair, pose, found.place)
        gap = scale(1.0 / max(found.distance, LEAST_DIVISOR), sub(jet_b[0], jet_a[0]))
        direction = add(gap, scale(MIXING * attempt, direction))
        if norm(direction) == 0.0:
            direction = (1.0, 0.0, 0.0)
    return best
