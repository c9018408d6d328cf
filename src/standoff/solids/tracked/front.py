"""What is kept of two solids from frame to frame: the front of bounds, and where the witness points
were."""

from __future__ import annotations

import threading
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.kernels.entries.tracked_solids import BOUND, DISTANCE, TOLD_REALS, solid_frames
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids import spatial_progress as C
from standoff.kernels.solids.front_rows import KEY_REALS, N_ROWS, ROW_REALS, STORE_REALS
from standoff.solids.answer import MOST_OPEN
from standoff.solids.spatial.minimum import MOST_LOCAL, Found, Sought, found_of, started
from standoff.solids.spatial.pair import PlacedPair
from standoff.solids.spatial.tolerances import PROOF_ROUNDING

Array = NDArray[np.float64]
MOST_ROWS = 1 << 14
"""Rows that a front may have: more are not cut any further, so that an interval is told."""

OUTSIDE, INSIDE = S.OUTSIDE, S.INSIDE


class Front(NamedTuple):
    """A front between frames; its arrays are not written to.

    Attributes
    ----------
    before : (14,) array
        B's pose in A's frame, the least distance and the proven bound.
    best : array
        What the kernels were asked, and where the witness points were.
    store, keys, rows : arrays
        As ``kernels.solids.front_rows`` lays them out.
    senses : (2,) array of int
        From where each boundary is seen.
    """

    before: Array
    best: Array
    store: Array
    keys: Array
    rows: Array
    senses: NDArray[np.int64]

    @property
    def inside(self) -> Any:
        """Which solid is inside the other: "A", "B" or ""."""
        if self.senses[1] == INSIDE:
            return "A"
        return "B" if self.senses[0] == INSIDE else ""


class Work(NamedTuple):
    """Arrays that frames write to."""

    store: Array
    keys: Array
    rows: Array
    minima: Array
    counts: NDArray[np.int64]


@lru_cache(maxsize=8)
def _room(thread: int) -> Work:
    del thread
    return Work(
        np.zeros(STORE_REALS),
        np.empty(KEY_REALS * MOST_ROWS),
        np.empty(ROW_REALS * MOST_ROWS),
        np.empty(C.MINIMUM_REALS * MOST_LOCAL),
        np.zeros(8, dtype=np.int64),
    )


def front_at(pair: PlacedPair, found: Found, senses: tuple[int, int], sought: Sought) -> Front:
    """A front that is yet to be made, of solids whose nearest points were found."""
    away = float(np.linalg.norm(pair.relative[9:]))
    best, _ = started(sought._replace(listed=MOST_OPEN), pair.size, away)
    best[C.LEAF_A : C.AT + 4] = found.best[1:7]
    before = np.array([*pair.relative, found.upper, found.lower])
    empty = np.empty(0)
    return Front(
        before, best, np.zeros(STORE_REALS), empty, empty, np.array(senses, dtype=np.int64)
    )


class Frames:
    """Frames one after the other from a front on, which stays as it is."""

    def __init__(
        self,
        packed: tuple[Any, Any],
        front: Front,
        tolerance: float,
        deadline: int,
        minima: float = 0.0,
    ) -> None:
        self.packed = packed
        self.asked = np.array([tolerance, PROOF_ROUNDING, minima])
        self.work = _room(threading.get_ident())
        store, keys, rows, _, _ = self.work
        self.before, self.best, self.senses = front.before.copy(), front.best.copy(), front.senses
        self.best[C.BUDGET] = deadline
        store[:] = front.store
        keys[: len(front.keys)] = front.keys
        rows[: len(front.rows)] = front.rows
        if front.best[C.ABOVE] < minima:  # planes' faces may have shut out what is asked now
            store[N_ROWS] = 0.0

    def go(self, poses: Array, told: Array) -> int:
        """Frames with B at poses (n, 12) in A's frame, into the rows of `told`; how many were
        done."""
        store, keys, rows, minima, counts = self.work
        done = int(
            solid_frames(
                self.packed,
                (self.before, poses, self.asked),
                self.senses,
                (self.best, minima),
                (store, keys, rows),
                counts,
                told,
            )
        )
        self.before[:12] = poses[done - 1]
        self.before[12], self.before[13] = told[done - 1, DISTANCE], told[done - 1, BOUND]
        return done

    def kept(self) -> Front:
        """The front after the last frame."""
        store, keys, rows, _, _ = self.work
        n = int(store[N_ROWS])
        made = Front(
            self.before.copy(),
            self.best.copy(),
            store.copy(),
            keys[: KEY_REALS * n].copy(),
            rows[: ROW_REALS * n].copy(),
            self.senses,
        )
        for array in made:
            array.flags.writeable = False
        return made

    def found(self) -> Found:
        """What the last frame found, as a search does."""
        return found_of(self.best, self.work.minima, self.work.counts)


def room_for(n: int) -> Array:
    """What `n` frames tell."""
    return np.zeros((n, TOLD_REALS))
