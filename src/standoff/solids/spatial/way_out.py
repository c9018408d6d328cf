"""A short way by which one of two solids that overlap is proven to be parted from the other."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from standoff.bodies.hulls.fewer_points import directions
from standoff.geometry.validation import Array
from standoff.solids.parting import Gap, drawn_in
from standoff.solids.spatial.pair import PlacedPair
from standoff.solids.spatial.tolerances import PARTED_SPARE, PROOF_ROUNDING

GapOf = Callable[[PlacedPair, float], Gap | None]
"""How far a pair is apart, proven to a tolerance, and the normal there; None where it is not."""
ALL_ROUND = 96
"""Directions that are looked along, beside those of the solids' faces."""
MOST_STARTS = 3
APART = 0.9
"""Cosine of the angle of two ways below which both are tried."""


def short_way(pair: PlacedPair, gap_of: GapOf, known: Array | None = None) -> Array:
    """A world vector: B, moved by it, is proven to be apart from A. It is at most as long as one
    that is `known`.

    There is always one past the boxes of the leaves; from the shortest of these, B is drawn in
    until it touches A.
    """
    ways = _ways(pair)
    spare = 4.0 * PROOF_ROUNDING * (pair.size + float(np.linalg.norm(pair.relative[9:])))
    lengths = pair.a.heights(ways @ pair.ra) + pair.b.heights(-ways @ pair.rb) + spare
    lengths -= ways @ (pair.pb - pair.pa)
    best = lengths.min() * ways[lengths.argmin()] if known is None else known
    tried: list[Array] = []
    for k in np.argsort(lengths, kind="stable"):
        if len(tried) < MOST_STARTS and all(ways[k] @ other < APART for other in tried):
            tried.append(ways[k])
            start = (1.0 + PARTED_SPARE) * lengths[k] * ways[k]
            tolerance = 0.5 * PARTED_SPARE * float(lengths[k])
            way = drawn_in(start, lambda by, to=tolerance: gap_of(pair.moved(by), to))  # type: ignore[misc]
            if way is not None and np.linalg.norm(way) < np.linalg.norm(best):
                best = way
    return np.asarray(best)


def _ways(pair: PlacedPair) -> Array:
    """World unit vectors along which B may leave A."""
    if not (pair.a.has_end and pair.b.has_end):
        return pair.ra[None, :, 2] if pair.b.has_end else -pair.rb[None, :, 2]
    own = np.vstack([pair.a.axes @ pair.ra.T, pair.b.axes @ pair.rb.T])
    return np.vstack([own, -own, directions(ALL_ROUND)])
