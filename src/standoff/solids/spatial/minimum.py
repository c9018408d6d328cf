"""One run of the compiled search, and what it found."""

from __future__ import annotations

import threading
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.kernels.entries.solids import boundary_distance, solid_point
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids import spatial_progress as C
from standoff.solids.answer import SolidCounts
from standoff.solids.asked import DEADLINE
from standoff.solids.spatial.tolerances import PROOF_ROUNDING, PROOF_TOLERANCE
from standoff.typing import Array

HEAP = 1 << 16
PAIRS = 1 << 14
IDENTITY = np.array([1.0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0])
# Pairs of points that are kept: ties, or local minima.
MOST_TIES, MOST_LOCAL = 256, 1 << 14
EITHER = S.EITHER


class SearchOptions(NamedTuple):
    """How a search is to go.

    Attributes
    ----------
    tolerance : to what the distance is to be proven, length.
    deadline : evaluations, at most.
    below : distances from here on are not looked for, length.
    above : local minima up to this distance are kept, length; 0: only the nearest pairs.
    on_meeting : whether the search ends where the boundaries are found to meet.
    listed : how many pairs of boxes that stay open are listed.
    patch : how much wider a minimum's patch is, length; minima are told up to `above` less this.
    """

    tolerance: float
    deadline: int = DEADLINE
    below: float = np.inf
    above: float = 0.0
    on_meeting: bool = True
    listed: int = 0
    patch: float = 0.0


@dataclass(frozen=True)
class LeastFound:
    """The least distance of two boundaries, in A's frame.

    Attributes
    ----------
    upper, lower : proven, length.
    tolerance : within which the proof is complete, length.
    met : the boundaries are closer than that.
    minima : rows (distance, leaf_a, leaf_b, four parameters, bound) of nearest pairs.
    best : such a row of the nearest.
    left : rows (leaf_a, leaf_b, both boxes, bound) of pairs of boxes that stayed open, the nearest
        first; a leaf below 0 is a node.
    lost : how many local minima there was no room for.
    counts : boxes, steps of Newton's method, pairs of nodes, pairs of leaves, bisections.
    n_open : pairs of boxes that stayed open.
    """

    upper: float
    lower: float
    tolerance: float
    met: bool
    minima: Array
    best: Array
    left: Array
    lost: int
    counts: tuple[int, ...]
    n_open: int

    @property
    def told(self) -> SolidCounts:
        """The counts as an answer has them."""
        boxes, _, nodes, leaves, cuts = self.counts
        return SolidCounts(evaluations_of(self.counts), nodes, leaves, boxes, cuts)


def evaluations_of(counts: Any) -> int:
    """What a deadline limits, by what a search has counted."""
    return int(counts[C.BOXES] + 2 * counts[C.STEPS] + counts[C.NODE_PAIRS])


@lru_cache(maxsize=8)
def scratch(thread: int) -> tuple[Array, Any, Array]:
    del thread
    return new_scratch()


def new_scratch() -> tuple[Array, Any, Array]:
    """A search's room for one who keeps it."""
    return np.empty(2048 + C.LEFT_REALS * PAIRS), np.empty(2 * HEAP, dtype=np.int64), np.empty(HEAP)


def started(sought: SearchOptions, size: float, away: float) -> tuple[Array, Array]:
    """What a search fills: (best, minima), with what is asked of it in `best`; `away` is how far
    the solids' frames are from each other, length."""
    best = np.zeros(C.BEST_REALS + C.OPEN_REALS * sought.listed)
    best[C.LEAST], best[C.OPEN] = sought.below, np.inf
    best[C.BEYOND] = 0.0 if sought.below == np.inf else np.inf
    best[C.TOLERANCE] = sought.tolerance
    best[C.ROUNDING] = PROOF_ROUNDING * (size + away)
    best[C.SIZE], best[C.BUDGET] = size, sought.deadline
    best[C.ABOVE] = min(sought.above, sought.below)
    best[C.MEETING] = sought.tolerance if sought.on_meeting else -1.0
    best[C.MOST_MINIMA] = MOST_LOCAL if sought.above > 0.0 else MOST_TIES
    best[C.MOST_OPEN] = sought.listed
    return best, np.empty(C.MINIMUM_REALS * int(best[C.MOST_MINIMA]))


def least_distance(
    packed_a: Any, packed_b: Any, pose: Array, senses: tuple[int, int], size: float,
    sought: SearchOptions | None = None,
) -> LeastFound:  # fmt: skip
    """Between two packed solids; `pose` (12,) is B's in A's frame, R by rows and p."""
    asked = SearchOptions(PROOF_TOLERANCE * size) if sought is None else sought
    return found_of(*searched(packed_a, packed_b, pose, senses, size, asked))


def searched(
    packed_a: Any,
    packed_b: Any,
    pose: Array,
    senses: tuple[int, int],
    size: float,
    sought: SearchOptions,
) -> tuple[Array, Array, NDArray[np.int64]]:
    """What the compiled search fills: (best, minima, counts)."""
    best, minima = started(sought, size, float(np.linalg.norm(pose[9:])))
    counts = np.zeros(8, dtype=np.int64)
    boundary_distance(
        (packed_a, packed_b),
        pose,
        np.array(senses, dtype=np.int64),
        best,
        minima,
        scratch(threading.get_ident()),
        counts,
    )
    return best, minima, counts


def nearest_row(best: Array) -> Array:
    """The nearest pair of points as a row of minima has it."""
    return np.array([best[C.LEAST], best[C.LEAF_A], best[C.LEAF_B], *best[C.AT : C.AT + 4], 0.0])


def found_of(best: Array, minima: Array, counts: Any) -> LeastFound:
    """What a search has filled."""
    upper, tolerance = float(best[C.LEAST]), float(best[C.TOLERANCE])
    rows = minima.reshape(-1, C.MINIMUM_REALS)[: int(best[C.N_MINIMA]), : C.POINTS]
    rows = rows[rows[:, 0] <= max(upper + tolerance, best[C.ABOVE])]
    rows = rows[np.argsort(rows[:, 0], kind="stable")]
    met = bool(best[C.MET])
    lower = 0.0 if met else max(0.0, min(upper - tolerance, float(best[C.OPEN])))
    row = nearest_row(best)
    left = best[C.OPEN_ROWS :].reshape(-1, C.OPEN_REALS)[: int(best[C.N_OPEN])]
    left = left[np.argsort(left[:, -1], kind="stable")]
    return LeastFound(
        upper, lower, tolerance, met, rows, row, left, int(best[C.LOST]),
        tuple(int(n) for n in counts[:5]), int(best[C.N_OPEN]),
    )  # fmt: skip


def leaf_jet_of(packed: Any, leaf: int, u: float, v: float) -> Array:
    """(6, 3) point and derivatives of a leaf, own frame."""
    out = np.zeros(18)
    solid_point(packed, IDENTITY, int(leaf), float(u), float(v), out)
    return out.reshape(6, 3)
