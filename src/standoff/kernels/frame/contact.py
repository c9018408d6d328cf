"""A query in contact or penetration: follow the local minimum of s(n), and prove it least."""

from math import inf, nan
from typing import NamedTuple

import numpy as np

from standoff.kernels.algebra.vectors import axpy, dot, norm, sub
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import pair_slack, pair_span
from standoff.kernels.compiler.decorators import kernel, shared
from standoff.kernels.depth.descent import descend
from standoff.kernels.depth.penetration import (
    begin_along,
    box_depth,
    from_last,
    plane_normal,
)
from standoff.kernels.depth.search import search
from standoff.kernels.pair.certificate import certify_along
from standoff.kernels.pair.certified import CERTIFIED, PENETRATING, UNCERTIFIED
from standoff.kernels.pair.descent import pair_jets
from standoff.kernels.pair.events import EVENTS, exhausted
from standoff.kernels.tolerances import ALIGNED, BLUR, DEPTH_PROOF, MAX_RIVALS
from standoff.kernels.values import Depth, Found

# What a query in contact may begin from: nothing; the direction and place of an earlier frame; the
# same, if near enough for Newton's method.
COLD, WARM, NEAR = np.int64(0), np.int64(1), np.int64(2)


class Asked(NamedTuple):
    """What a query in contact must find out about all depths."""

    everywhere: bool  # prove that none is smaller; otherwise only whether the bodies overlap
    stays: bool  # answer with the local minimum that is followed, even if another one is smaller


LEAST = Asked(True, False)


@shared
def contact_query(pair, pose, place, normal, begin, asked, tolerance, work):
    """The signed distance of the cores and its bounds.

    `begin` is COLD, WARM or NEAR, for the place and the normal. If the search that `asked` requires
    finds a smaller depth, the answer is there, unless it stays.
    """
    last = some_direction(normal)
    plane, square = plane_normal(pair, pose)
    at = Depth(False, nan, square if plane else last, place)
    if plane and begin == COLD:
        at = Depth(False, nan, square, begin_along(pair, pose, square))
    if begin == NEAR and not plane:
        at = from_last(pair, pose, at, tolerance, work)
    if (begin != COLD or plane) and not at.found:
        at = descend(pair, pose, at, tolerance, work)
    least = -inf
    sought = at.distance <= 0.0 if at.found else not asked.stays
    if sought and not plane:
        # if only the minimum is followed, whether the bodies overlap at all must still be shown
        proof, rivals = (DEPTH_PROOF, MAX_RIVALS) if asked.everywhere else (1.0, 0)
        logged = work.counts[EVENTS]
        best, least = search(pair, pose, at, tolerance, proof, rivals, work)
        at = at if asked.stays else best
        work.counts[EVENTS] = logged
    n = at.normal
    if plane:
        n = square
    elif begin != COLD and not at.found and exhausted(work):
        n = farther_apart(pair, pose, at.place, n, last)
    return conclude(pair, pose, Depth(at.found, at.distance, n, at.place), least, tolerance, work)


@kernel
def some_direction(n):
    """n, or another direction if n is (0, 0, 0) because two points coincide."""
    return n if dot(n, n) > 0.5 else (1.0, 0.0, 0.0)


@kernel
def bound_along(pair, pose, place, n):
    """How far a plane perpendicular to n is known to keep the cores apart, negative in overlap."""
    bound, _ = certify_along(pair, pose, place, pair_jets(pair, pose, place), n)
    return max(bound, -box_depth(pair, pose, n) - pair_slack(pair))


@kernel
def farther_apart(pair, pose, place, n, last):
    """The one of two directions along which the cores are known to be farther apart."""
    better = bound_along(pair, pose, place, last) > bound_along(pair, pose, place, n)
    return last if better else n


@kernel
def conclude(pair, pose, at, least, tolerance, work):
    """What `contact_query` returns for a depth.

    `least` is a lower bound of every depth, -inf if no overlap was shown.
    """
    found, _, n, place = at
    jets = pair_jets(pair, pose, place)
    gap = sub(jets[1][0], jets[0][0])
    d = dot(n, gap)
    bound, blur = certify_along(pair, pose, place, jets, n)
    upper = norm(gap)
    if exhausted(work):
        bound = max(bound, -box_depth(pair, pose, n) - pair_slack(pair))
    if bound <= 0.0 and (pair.ints_a[L.UNBOUNDED] or pair.ints_b[L.UNBOUNDED]):
        # no point of a body is lower above a half-space than the lowest one
        upper = min(upper, d)
    span = pair_span(pair, pose.p, abs(d))
    allowed = min(tolerance, BLUR) * span + pair_slack(pair) + min(blur, BLUR * span)
    if d - bound > allowed or norm(axpy(-d, n, gap)) > ALIGNED * span:
        # not at rest: all that is proven is the bound, or the distance between the points; and no
        # overlap but by the search
        shown = bound <= 0.0 and (min(upper, -least) <= 0.0 or not found)
        d = bound if shown else upper
        found = found and shown and not exhausted(work)
    if least >= 0.0:
        upper = min(upper, -least)
    if upper > 0.0 and d <= 0.0 and exhausted(work):
        found = False  # cut off before any overlap was shown
    if d > 0.0 and bound > 0.0:
        # apart: the distance between the points, which near contact need not be along n
        d = norm(gap)
        if found and d - bound <= allowed:
            return Found(CERTIFIED, place, d, bound, d, n)
        found = False
    if not found:
        return Found(UNCERTIFIED, place, d, bound, upper, n)
    return Found(PENETRATING, place, d, bound, max(upper, d), n)
