"""What is kept of two solids from frame to frame: the front of bounds, and where the witness points
were."""

from __future__ import annotations

import threading
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.kernels.entries.tracked_solids import (
    BOUND,
    DISTANCE,
    N_SETS,
    TOLD_REALS,
    number_minima,
    solid_frames,
)
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids import spatial_progress as C
from standoff.kernels.solids.front_branches import BRANCH_REALS, MERGED_REALS, MOST_MERGED
from standoff.kernels.solids.front_frame import FRAMES_AHEAD
from standoff.kernels.solids.front_rows import (
    KEY_REALS,
    N_BRANCHES,
    N_MERGED,
    N_ROWS,
    NEXT_BRANCH,
    ROW_REALS,
    STORE_REALS,
)
from standoff.kernels.solids.minima_sets import SET_BRANCH, SET_REALS
from standoff.kernels.solids.spatial_tolerances import SAME_BASIN
from standoff.solids.answer import MOST_OPEN
from standoff.solids.spatial.minimum import MOST_LOCAL, LeastFound, SearchOptions, found_of, started
from standoff.solids.spatial.pair import PlacedPair
from standoff.solids.spatial.stationary import NONE, Fans
from standoff.solids.spatial.tolerances import PROOF_ROUNDING
from standoff.typing import Array

MOST_ROWS = 1 << 16
"""Rows that a front may have: more are not cut any further, so that an interval is told."""
MOST_BRANCHES = 1 << 8
"""Local minima that are followed from frame to frame; of more the nearest ones."""
MOST_TOLD = 1 << 12
"""Local minima that one call of the kernel tells, of all its frames."""
NO_ROWS = np.empty((0, SET_REALS))

OUTSIDE, INSIDE = S.OUTSIDE, S.INSIDE


class KeptFront(NamedTuple):
    """A front between frames; its arrays are not written to.

    Attributes
    ----------
    before : (14,) array
        B's pose in A's frame, the least distance and the proven bound.
    best : array
        What the kernels were asked, and where the witness points were.
    store, keys, rows : arrays
        As ``kernels.solids.front_rows`` lays them out.
    branches : array
        As ``kernels.solids.front_branches`` does.
    senses : (2,) array of int
        From where each boundary is seen.
    contact : array, optional
        If the solids overlapped in the last frame, what is kept of that (``tracked.contact``): the
        rest is of the last frame in which they were apart.
    """

    before: Array
    best: Array
    store: Array
    keys: Array
    rows: Array
    branches: Array
    senses: NDArray[np.int64]
    contact: Array | None = None

    @property
    def born(self) -> int:
        """How many branches there have been."""
        return int(self.store[NEXT_BRANCH])

    @property
    def inside(self) -> Any:
        """Which solid is inside the other: "A", "B" or ""."""
        if self.senses[1] == INSIDE:
            return "A"
        return "B" if self.senses[0] == INSIDE else ""


class FrontArrays(NamedTuple):
    """Arrays that frames write to."""

    store: Array
    keys: Array
    rows: Array
    branches: Array
    merged: Array
    minima: Array
    counts: NDArray[np.int64]
    sets: Array


class Minima(NamedTuple):
    """What frames are asked of local minima.

    Attributes
    ----------
    above : up to which distance they are kept, length; 0: only the nearest pairs.
    wider : how much of that is for their patches alone, length.
    fans : of both solids, as ``kernels.solids.stationary`` lays them out.
    """

    above: float
    wider: float
    fans: tuple[Fans, Fans]


NO_MINIMA = Minima(0.0, 0.0, (NONE, NONE))


def new_room() -> FrontArrays:
    """Arrays for one who keeps them from frame to frame."""
    return FrontArrays(
        np.zeros(STORE_REALS),
        np.empty(KEY_REALS * MOST_ROWS),
        np.empty(ROW_REALS * MOST_ROWS),
        np.empty(BRANCH_REALS * MOST_BRANCHES),
        np.empty(MERGED_REALS * MOST_MERGED),
        np.empty(C.MINIMUM_REALS * MOST_LOCAL),
        np.zeros(8, dtype=np.int64),
        np.empty(SET_REALS * MOST_TOLD),
    )


@lru_cache(maxsize=8)
def _room(thread: int) -> FrontArrays:
    del thread
    return new_room()


def front_at(
    pair: PlacedPair,
    found: LeastFound,
    senses: tuple[int, int],
    sought: SearchOptions,
    born: int = 0,
) -> KeptFront:
    """A front that is yet to be made, of solids whose nearest points were found. `born`: how many
    branches there were before."""
    away = float(np.linalg.norm(pair.relative[9:]))
    best, _ = started(sought._replace(listed=MOST_OPEN), pair.size, away)
    best[C.LEAF_A : C.AT + 4] = found.best[1:7]
    before = np.array([*pair.relative, found.upper, found.lower])
    empty = np.empty(0)
    store = np.zeros(STORE_REALS)
    store[NEXT_BRANCH] = born
    return KeptFront(before, best, store, empty, empty, empty, np.array(senses, dtype=np.int64))


def front_in_contact(pair: PlacedPair, sought: SearchOptions, born: int) -> KeptFront:
    """A front that is yet to be made, of solids that overlap."""
    row = np.zeros(C.MINIMUM_REALS)
    nowhere = LeastFound(0.0, 0.0, 0.0, True, row[None], row, row[None], 0, (0, 0, 0, 0, 0), 0)
    return front_at(pair, nowhere, (OUTSIDE, OUTSIDE), sought, born)


class FrontFrames:
    """Frames one after the other from a front on, which stays as it is.

    minima : rows of what the last call told of local minima, as ``kernels.solids.minima_sets`` lays
    them out, those of each frame one after the other.
    """

    def __init__(
        self,
        packed: tuple[Any, Any],
        front: KeptFront,
        tolerance: float,
        deadline: int,
        minima: Minima = NO_MINIMA,
        room: FrontArrays | None = None,
    ) -> None:
        self.packed, self.fans, self.done = packed, minima.fans, 1
        self.asked = np.array([tolerance, PROOF_ROUNDING, minima.above, minima.wider])
        self.work = room or _room(threading.get_ident())
        store, keys, rows, branches = self.work[:4]
        self.before, self.best, self.senses = front.before.copy(), front.best.copy(), front.senses
        self.best[C.BUDGET] = deadline
        store[:] = front.store
        keys[: len(front.keys)] = front.keys
        rows[: len(front.rows)] = front.rows
        branches[: len(front.branches)] = front.branches
        store[N_MERGED] = 0.0
        if front.best[C.ABOVE] < minima.above:  # planes' faces may have shut out what is asked now
            store[N_ROWS] = 0.0

    def go(self, poses: Array, told: Array) -> int:
        """Frames with B at poses (n, 12) in A's frame, into the rows of `told`; how many were
        done."""
        done = int(solid_frames(*self.call(poses, told)))
        self.minima = self.told(told[:done])
        self.done = done
        self.went_to(poses[done - 1 : done], told[done - 1])
        return done

    def call(self, poses: Array, told: Array) -> tuple[Any, ...]:
        """What the kernel is called with for frames at poses (n, 12), into the rows of `told`."""
        store, keys, rows, branches, merged, minima, counts, sets = self.work
        return (
            self.packed,
            (self.before, poses, self.asked),
            self.senses,
            (self.best, minima),
            self.fans,
            (store, keys, rows, branches, merged),
            counts,
            (told, sets),
        )

    def went_to(self, pose: Array, row: Array) -> None:
        """The last frame had B at a pose (1, 12), and told a row."""
        before = self.before
        before[:12] = pose[0]
        before[12], before[13] = row[DISTANCE], row[BOUND]

    def not_apart(self) -> None:
        """After the last frame the solids are not known to be apart."""
        self.before[13] = 0.0

    def told(self, told: Array) -> Array:
        """Rows of what the last call told of local minima, of frames with rows `told`."""
        total = int(told[:, N_SETS].sum())
        return self.work.sets.reshape(-1, SET_REALS)[:total].copy() if total else NO_ROWS

    def kept(self) -> KeptFront:
        """The front after the last frame."""
        store, keys, rows, branches = self.work[:4]
        n = int(store[N_ROWS])
        made = KeptFront(
            self.before.copy(),
            self.best.copy(),
            store.copy(),
            keys[: KEY_REALS * n].copy(),
            rows[: ROW_REALS * n].copy(),
            branches[: BRANCH_REALS * int(store[N_BRANCHES])].copy(),
            self.senses,
        )
        for array in made[:-1]:
            array.flags.writeable = False
        return made

    @property
    def born(self) -> int:
        """How many branches there have been."""
        return int(self.work.store[NEXT_BRANCH])

    def merged(self) -> NDArray[np.int64]:
        """Of the last call's frames (frame, key, key of the one whose place it has come to), rows
        (n, 3)."""
        return merged_of(self.work.store, self.work.merged)

    def number(self, rows: Array, sets: Array, motion: float) -> NDArray[np.int64]:
        """The branches of local minima that were told otherwise, after a motion, length: their
        numbers."""
        reach = SAME_BASIN * self.best[C.SIZE] + FRAMES_AHEAD * motion
        return numbers_of(self.work[:5], rows, sets, float(reach), self.done - 1)

    def found(self) -> LeastFound:
        """What the last frame found, as a search does."""
        return found_of(self.best, self.work.minima, self.work.counts)


def moved_by(before: Array, now: Array, size: float) -> float:
    """A bound of how far a point of B, of a size, has moved between two poses (12,), length."""
    turn = float(np.linalg.norm(now[:9] - before[:9]))
    return float(np.linalg.norm(now[9:] - before[9:])) + turn * size


def merged_of(store: Array, merged: Array) -> NDArray[np.int64]:
    """(frame, key, key of the one whose place it has come to) of branches, rows (n, 3)."""
    n = MERGED_REALS * int(store[N_MERGED])
    return merged[:n].reshape(-1, MERGED_REALS).astype(np.int64)


def numbers_of(
    arrays: Any, rows: Array, sets: Array, reach: float, frame: int
) -> NDArray[np.int64]:
    """The numbers of the branches of local minima, which are then those of the next frame."""
    n = min(len(sets), MOST_BRANCHES)
    number_minima(arrays, rows.ravel(), sets.ravel(), n, reach, frame)
    numbers = np.full(len(sets), -1, dtype=np.int64)
    numbers[:n] = sets[:n, SET_BRANCH]
    return numbers


def room_for(n: int) -> Array:
    """What `n` frames tell."""
    return np.zeros((n, TOLD_REALS))
