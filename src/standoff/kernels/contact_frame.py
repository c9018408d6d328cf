"""A query in contact or penetration: follow the local minimum of s(n), and prove it the least."""

from math import inf, nan

import numpy as np

from standoff.kernels.certificate import certify_along
from standoff.kernels.certified import CERTIFIED, PENETRATING, UNCERTIFIED
from standoff.kernels.compiling import kernel, pointer, shared
from standoff.kernels.depth_search import save, search, witness_points
from standoff.kernels.descent import pair_jets
from standoff.kernels.events import EVALUATIONS, EVENTS, LIMIT
from standoff.kernels.features import pair_slack, pair_span
from standoff.kernels.penetration import (
    begin_along,
    box_depth,
    descend,
    from_last,
    plane_normal,
)
from standoff.kernels.tolerances import ALIGNED, BLUR, DEPTH_PROOF, MAX_RIVALS
from standoff.kernels.vectors import axpy, dot, norm, sub


@shared
def contact_query(pair, R, p, warm, n, everywhere, mode, q, w_ff, tolerance, counts, events):
    """(outcome, d, bound, upper, normal): signed distance of the cores and its bounds.

    `warm` (a float, as is `everywhere`: every literal would compile once more): 1 where n and
    (mode, q) are those of a frame before, 2 where Newton's method may go on from them.
    `everywhere`: 1 to prove the depth the least, and search where it is not. `upper` is at least
    the signed distance.
    """
    n = some_direction(n)
    known, last = warm > 0.0, n
    best_mode, best_q = np.empty(4, dtype=np.int64), np.empty(4)
    least, found, d = -inf, False, nan
    plane, normal = plane_normal(pair, R)
    if plane:
        n = normal
        if not known:
            begin_along(pair, R, n, mode, q)
    if warm > 1.0 and not plane:
        found, n, d = from_last(pair, R, p, mode, q, n, tolerance, counts)
    if (known or plane) and not found:
        found, n, d = descend(pair, R, p, n, d, mode, q, w_ff, tolerance, counts, events)
    best = (pointer(best_mode, 0), pointer(best_q, 0))
    save(mode, q, best[0], best[1])
    if plane:
        least = -d
    elif not found or d <= 0.0:
        # followed alone, the minimum is still asked whether the bodies overlap at all
        proof, rivals = (DEPTH_PROOF, float(MAX_RIVALS)) if everywhere > 0.0 else (1.0, 0.0)
        logged = counts[EVENTS]
        found, d, n, least = search(
            pair, R, p, found, d, n, mode, q, best, w_ff, tolerance, proof, rivals, counts, events
        )
        counts[EVENTS] = logged
        save(best[0], best[1], mode, q)
    best_mode[0], best_q[0] = 0, 0.0  # alive until here, see `pointer`
    if plane:
        n = normal
    elif known and not found and counts[EVALUATIONS] >= counts[LIMIT]:
        n = farther_apart(pair, R, p, mode, q, n, last)
    return conclude(pair, R, p, found, least, n, mode, q, tolerance, counts)


@kernel
def some_direction(n):
    """n, or another where it is the (0, 0, 0) between points that coincide."""
    return n if dot(n, n) > 0.5 else (1.0, 0.0, 0.0)


@kernel
def bound_along(pair, R, p, mode, q, n):
    """What a plane square to n is known to keep the cores apart by, less than 0 in overlap."""
    x_a, x_b = witness_points(pair, R, p, mode, q)
    bound, _ = certify_along(pair, R, p, mode, q, x_a, x_b, n)
    return max(bound, -box_depth(pair, R, p, n) - pair_slack(pair))


@kernel
def farther_apart(pair, R, p, mode, q, n, last):
    """Of two directions the one that is known to keep the cores farther apart."""
    better = bound_along(pair, R, p, mode, q, last) > bound_along(pair, R, p, mode, q, n)
    return last if better else n


@kernel
def conclude(pair, R, p, found, least, n, mode, q, tolerance, counts):
    """What `contact_query` returns, of the witness points found along n.

    `least` bounds every depth from below, -inf where no overlap was shown.
    """
    jet_a, jet_b = pair_jets(pair, R, p, mode, q)
    gap = sub(jet_b[0], jet_a[0])
    d = dot(n, gap)
    bound, blur = certify_along(pair, R, p, mode, q, jet_a[0], jet_b[0], n)
    upper = norm(gap)
    if counts[EVALUATIONS] >= counts[LIMIT]:
        bound = max(bound, -box_depth(pair, R, p, n) - pair_slack(pair))
    span = pair_span(pair, p, abs(d))
    allowed = min(tolerance, BLUR) * span + pair_slack(pair) + min(blur, BLUR * span)
    if d - bound > allowed or norm(axpy(-d, n, gap)) > ALIGNED * span:
        # not at rest: what is achieved is the bound, or the points' own distance
        d = bound if bound <= 0.0 else upper
        found = found and bound <= 0.0 and counts[EVALUATIONS] < counts[LIMIT]
    if least >= 0.0:
        upper = min(upper, -least)
    if upper > 0.0 and d <= 0.0 and counts[EVALUATIONS] >= counts[LIMIT]:
        found = False  # cut off before any overlap was shown
    if d > 0.0 and bound > 0.0:
        # apart: the distance is that of the points, which near contact need not be along n
        d = norm(gap)
        if found and d - bound <= allowed:
            return CERTIFIED, d, bound, d, n
        found = False
    if not found:
        return UNCERTIFIED, d, bound, upper, n
    return PENETRATING, d, bound, max(upper, d), n
