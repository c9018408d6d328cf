"""One run of the compiled search, and what it found."""

from __future__ import annotations

import threading
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from standoff.geometry.validation import Array
from standoff.kernels.entries.solids import boundary_distance, solid_point
from standoff.kernels.solids import spatial_closing as C
from standoff.kernels.solids import spatial_layout as S
from standoff.solids.spatial.tolerances import PROOF_ROUNDING, PROOF_TOLERANCE

HEAP = 1 << 16
PAIRS = 1 << 14
IDENTITY = np.array([1.0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0])
# Boxes that potentials are bounded over, at most.
BUDGET = 400_000


@dataclass(frozen=True)
class Found:
    """The least distance of two boundaries, in A's frame.

    Attributes
    ----------
    upper, lower : proven, length.
    tolerance : within which the proof is complete, length.
    met : the boundaries are closer than that.
    minima : rows (distance, leaf_a, leaf_b, four parameters, 0) of nearest pairs.
    best : such a row of the nearest.
    counts : boxes, steps of Newton's method, pairs of nodes, pairs of leaves, bisections.
    """

    upper: float
    lower: float
    tolerance: float
    met: bool
    minima: Array
    best: Array
    counts: tuple[int, ...]


@lru_cache(maxsize=8)
def _scratch(thread: int) -> tuple[Array, Any, Array]:
    del thread
    return np.empty(2048 + 3 * PAIRS), np.empty(2 * HEAP, dtype=np.int64), np.empty(HEAP)


def least_distance(
    packed_a: Any, packed_b: Any, pose: Array, senses: tuple[int, int], size: float,
    budget: int = BUDGET, below: float = np.inf,
) -> Found:  # fmt: skip
    """Between two packed solids; `pose` (12,) is B's in A's frame, R by rows and p.

    `below`: distances from here on are not looked for.
    """
    best = np.zeros(C.BEST_REALS)
    best[C.LEAST], best[C.OPEN] = below, np.inf
    best[C.TOLERANCE] = PROOF_TOLERANCE * size
    best[C.ROUNDING] = PROOF_ROUNDING * (size + float(np.linalg.norm(pose[9:])))
    best[C.SIZE], best[C.BUDGET] = size, budget
    minima = np.zeros(C.MINIMUM_REALS * C.MOST_MINIMA)
    counts = np.zeros(8, dtype=np.int64)
    boundary_distance(
        (packed_a, packed_b),
        pose,
        np.array(senses, dtype=np.int64),
        best,
        minima,
        _scratch(threading.get_ident()),
        counts,
    )
    upper = float(best[C.LEAST])
    rows = minima.reshape(-1, C.MINIMUM_REALS)[: int(best[C.N_MINIMA])]
    rows = rows[rows[:, 0] <= upper + best[C.TOLERANCE]]
    rows = rows[np.argsort(rows[:, 0], kind="stable")]
    met = bool(best[C.MET])
    lower = 0.0 if met else max(0.0, min(upper - best[C.TOLERANCE], float(best[C.OPEN])))
    row = np.array([upper, best[C.LEAF_A], best[C.LEAF_B], *best[C.AT : C.AT + 4], 0.0])
    return Found(
        upper, lower, float(best[C.TOLERANCE]), met, rows, row, tuple(int(n) for n in counts[:5])
    )


def leaf_jet_of(packed: Any, leaf: int, u: float, v: float) -> Array:
    """(6, 3) point and derivatives of a leaf, own frame."""
    out = np.zeros(18)
    solid_point(packed, IDENTITY, int(leaf), float(u), float(v), out)
    return out.reshape(6, 3)


EITHER = S.EITHER
