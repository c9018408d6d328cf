"""A short way by which one of two solids that overlap is proven to be parted from the other."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from standoff.bodies.hulls.fewer_points import directions
from standoff.solids.parting import Gap, shortest
from standoff.solids.spatial.pair import PlacedPair
from standoff.solids.spatial.tolerances import PARTED_SPARE, PROOF_ROUNDING
from standoff.typing import Array

GapOf = Callable[[PlacedPair, float], Gap | None]
"""How far a pair is apart, proven to a tolerance, and the normal there; None where it is not."""
ALL_ROUND = 96
"""Directions that are looked along."""


def short_way(pair: PlacedPair, gap_of: GapOf, known: Array | None = None) -> Array:
    """A world vector: B, moved by it, is proven to be apart from A. It is no longer than one that
    is `known`."""
    ways = directions(ALL_ROUND)
    if not (pair.a.has_end and pair.b.has_end):
        ways = pair.ra[None, :, 2] if pair.b.has_end else -pair.rb[None, :, 2]
    spare = 4.0 * PROOF_ROUNDING * (pair.size + float(np.linalg.norm(pair.relative[9:])))
    lengths = pair.a.heights(ways @ pair.ra) + pair.b.heights(-ways @ pair.rb) + spare
    lengths -= ways @ (pair.pb - pair.pa)

    def gap_by(way: Array) -> Gap | None:
        return gap_of(pair.moved(way), 0.5 * PARTED_SPARE * float(np.linalg.norm(way)))

    return shortest(ways, lengths, gap_by, known)
