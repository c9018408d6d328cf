"""What may be asked of the distance of two solids, in the plane and in space alike."""

from __future__ import annotations

from typing import NamedTuple

DEADLINE = 2_000_000
"""Evaluations of points and bounds, at most: some seconds."""
PATCH_ALONE = (
    "patch={patch}: patches are those of local minima, of solids in space; give `minima` too, up "
    "to which distance."
)
"""Why patches are refused."""


class QueryOptions(NamedTuple):
    """Options of ``so.solids.distance``; lengths, and a number of evaluations."""

    within: float | None = None
    tolerance: float | None = None
    minima: float | None = None
    deadline: int = DEADLINE
    patch: float | None = None


DEFAULT = QueryOptions()
