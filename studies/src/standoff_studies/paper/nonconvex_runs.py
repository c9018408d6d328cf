"""Chains of balls tracked by the printed law, of which only the switching is modified.

A branch is a tracker of the system as printed on two convex lobes. What is modified is which
branches there are, and which of them answers: the one with the least distance.
"""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.kernels.state import arrays as K
from standoff.motion import Path
from standoff.solids import SolidTracker
from standoff.tracking import Tracker, distance
from standoff.tracking.frame_buffer import FrameBuffer
from standoff.tracking.laws import PaperLaw
from standoff.typing import Array
from standoff_studies.paper.many_starts import begun, motion_along
from standoff_studies.paper.nonconvex_scene import (
    BALLS,
    GAIN,
    MOTION,
    PAIRS,
    STEP,
    chain,
    lobes,
    seams,
    truth,
)
from standoff_studies.paper.pair_simulation import REST

PATHS: tuple[Path, Path] = (REST, MOTION)
ROUND = 0
"""The face of a lobe that is outside."""
FAR = 5.0
"""Of the library minima are asked up to this distance, beyond all there are [length]."""

ASKED_EVERY = 5
"""The library is asked at every such frame."""

READINGS = (
    "the nearest at the start",
    "the minima at the start",
    "all pairs of lobes",
    "the same as the second, told of births",
)
"""Which branches run."""


class Run(NamedTuple):
    """What one reading tells, frame by frame; frame 0 is the start.

    Attributes
    ----------
    distance : ndarray, shape (n,)
        Of the branch with the least one [length].
    active : ndarray of int, shape (n,)
        Its pair of lobes, as in `PAIRS`.
    branches : ndarray of int, shape (n,)
        How many run.
    runs : ndarray of int, shape (n,)
        Which pairs of lobes have one: bit k is set for pair k.
    switched : ndarray of bool, shape (n,)
        Has a branch changed its feature in the frame, or ended, or been handed over?
    witness : ndarray, shape (n, 6)
        Both points of the active branch, world.
    handed, merged : int
        How often one was handed over across a reflex edge, and how often it ended there, as the
        other lobes already had a branch.
    trackers : tuple of Tracker
    """

    distance: Array
    active: NDArray[np.int64]
    branches: NDArray[np.int64]
    runs: NDArray[np.int64]
    switched: NDArray[np.bool_]
    witness: Array
    handed: int
    merged: int
    trackers: tuple[Tracker, ...]


@cache
def tracker(pair: int) -> Tracker:
    """Return the printed system's tracker of two lobes."""
    i, j = PAIRS[pair]
    law = PaperLaw.as_printed(gain=GAIN)
    return Tracker(lobes(BALLS[0])[i], lobes(BALLS[1])[j], STEP, law=law)


class Branch:
    """One tracker of the printed system on a pair of lobes, from their nearest points.

    Attributes
    ----------
    pair : int
    outside : bool
        Have both witness points been outside since it began?
    """

    def __init__(self, pair: int, time: float) -> None:
        self.pair, self.outside = pair, False
        self.tracker, places = tracker(pair), nearest_places(pair, time)
        self.buffer: FrameBuffer = self.tracker.buffer(begun(self.tracker, PATHS, *places, time))

    def step(self, row: Array) -> float:
        """The distance after a frame."""
        self.buffer.motion[:] = row
        apart = self.tracker.step_into(self.buffer)
        self.outside |= bool((self.modes() == ROUND).all())
        return float(apart)

    def modes(self) -> Array:
        return np.asarray(self.buffer.out[[K.OUT_MODE, K.OUT_MODE + 2]])

    def beyond(self) -> int | None:
        """The pair of lobes across the reflex edge that a witness point has come to; None while
        both are outside."""
        modes = self.modes()
        if not self.outside or (modes == ROUND).all():
            return None
        side = int(modes[1] != ROUND)
        found, on = self.buffer.proximity(), list(PAIRS[self.pair])
        feature = (found.feature_a, found.feature_b)[side]
        seam = feature.index - (feature.kind == "face")
        on[side] = seams(BALLS[side], on[side])[seam][0]
        return PAIRS.index((on[0], on[1]))


def nearest_places(pair: int, time: float) -> tuple[Any, Any]:
    """Return where a branch begins: the nearest points of two lobes, as a broad phase finds."""
    poses = [path.pose(time) for path in PATHS]
    found = distance(tracker(pair).a, tracker(pair).b, *poses)
    return found.place_a, found.place_b


@cache
def motion() -> Array:
    """Return the poses and twists of all frames but the first."""
    return motion_along(*PATHS, truth().time)


@cache
def run(reading: str, leave_out: int | None = None) -> Run:
    """Track the chains by one of the `READINGS`, without a pair of lobes if one is to be left out.

    If not all pairs have a branch, one that comes to a reflex edge is handed over to the lobe
    beyond, and begins there at the nearest points, so that nothing is lost by a bad start.
    """
    known = truth()
    begins = {
        READINGS[0]: [int(known.apart[0].argmin())],
        READINGS[1]: np.flatnonzero(known.alive[0]).tolist(),
        READINGS[2]: list(range(len(PAIRS))),
        READINGS[3]: np.flatnonzero(known.alive[0]).tolist(),
    }[reading]
    branches = [Branch(pair, 0.0) for pair in begins if pair != leave_out]
    told = [_told(branches, [float(known.apart[0, branch.pair]) for branch in branches], False)]
    handed = merged = 0
    for row, time, alive in zip(motion(), known.time[1:].tolist(), known.alive[1:], strict=True):
        before = [branch.modes().tolist() for branch in branches]
        apart = [branch.step(row) for branch in branches]
        switched = before != [branch.modes().tolist() for branch in branches]
        told.append(_told(branches, apart, switched))
        if reading == READINGS[3]:
            new = {*np.flatnonzero(alive).tolist()} - {branch.pair for branch in branches}
            branches += [Branch(pair, time) for pair in sorted(new)]
        for branch in list(branches) if reading != READINGS[2] else ():
            pair = branch.beyond()
            if pair is None:
                continue
            handed += 1
            branches.remove(branch)
            if any(other.pair == pair for other in branches):
                merged += 1
            else:
                branches.append(Branch(pair, time))
    columns: list[Any] = [np.array(column) for column in zip(*told, strict=True)]
    rest: list[Any] = [handed, merged, tuple(tracker(pair) for pair in range(len(PAIRS)))]
    return Run(*[*columns, *rest])


def _told(branches: list[Branch], apart: list[float], switched: bool) -> tuple[object, ...]:
    """The row of a frame, as `Run` has it."""
    least = int(np.argmin(apart))
    runs = sum(1 << branch.pair for branch in branches)
    points = np.append(branches[least].buffer.point_a, branches[least].buffer.point_b)
    return apart[least], branches[least].pair, len(branches), runs, switched, points


def at_seams(one: Run) -> tuple[int, int, float]:
    """Return of the births of all minima how many no branch sees, how many there are, and how far
    at most the new minimum is from a reflex edge [length].

    A branch sees one if it changes its feature in that frame, or is on that pair of lobes already.
    """
    known = truth()
    frames, pairs = np.nonzero(~known.alive[:-1] & known.alive[1:])
    unseen = [
        not one.switched[k + 1] and not one.runs[k] >> pair & 1
        for k, pair in zip(frames.tolist(), pairs.tolist(), strict=True)
    ]
    return sum(unseen), len(frames), float(known.to_seam[frames + 1, pairs].max())


def jumps(one: Run, least: float) -> tuple[int, int]:
    """Return at how many switches between branches a witness point moves by more than a length, and
    how many switches there are."""
    at = np.flatnonzero(np.diff(one.active[1:])) + 1
    moved = np.abs(one.witness[at + 1] - one.witness[at]).max(axis=1)
    return int((moved > least).sum()), len(at)


class Library(NamedTuple):
    """What the library's tracker of the two solids tells, at every fifth frame.

    Attributes
    ----------
    frames : ndarray of int
        Which of the motion's.
    distance : ndarray
        Length.
    branches : ndarray of int
        How many minima it follows.
    certified : int
        Frames whose distance is proven.
    born : int
        Minima that begin after the first frame.
    evaluations : float
        Of points and bounds in a frame, median.
    """

    frames: NDArray[np.int64]
    distance: Array
    branches: NDArray[np.int64]
    certified: int
    born: int
    evaluations: float

    @property
    def by(self) -> str:
        """The law."""
        return f"the library's tracker of solids, {1e3 * STEP * ASKED_EVERY:g} ms, minima={FAR:g}"


@cache
def library() -> Library:
    """Track the two chains as solids, with all local minima."""
    a, b = (chain(balls) for balls in BALLS)
    solids = SolidTracker(a, b, minima=FAR)
    frames = np.arange(0, len(truth().time), ASKED_EVERY)
    poses = [truth().poses[k] for k in frames]
    state = solids.start(REST.pose(0.0), poses[0])
    _, told = solids.run(state, REST.pose(0.0), poses[1:])
    return Library(
        frames[1:],
        told.distance,
        np.bincount(told.minima.frame, minlength=len(told)),
        int(told.certified.sum()),
        sum(event.kind == "birth" for event in told.events),
        float(np.median(told.evaluations)),
    )
