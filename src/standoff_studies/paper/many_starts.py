"""Many wrong starts of one law along one motion, in compiled loops: which of them arrive."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.kernels.entries import tracker as kernels
from standoff.kernels.entries.preparing import prepare
from standoff.kernels.pair import events as N
from standoff.kernels.state import arrays as K
from standoff.motion import Path
from standoff.tracking import Tracker, TrackerState
from standoff.tracking.inputs import flat_pose, flat_twist
from standoff.tracking.rows import poses_of, twists_of

Array = NDArray[np.float64]


class Motion(NamedTuple):
    """The poses and twists of both bodies at some times, as the kernels read them.

    Attributes
    ----------
    times : ndarray, shape (n,)
        s; the first is that of the start.
    rows : ndarray, shape (n - 1, ...)
        Of the times after the first.
    """

    times: Array
    rows: Array


class Arrivals(NamedTuple):
    """How many of the tried starts have arrived.

    Attributes
    ----------
    arrived, tried : int
    by : str
        The law that they were tried with.
    """

    arrived: int
    tried: int
    by: str


def motion_along(path_a: Path, path_b: Path, times: Array) -> Motion:
    """Return two paths' poses and twists at some times [s]."""
    rows = np.empty((len(times) - 1, K.N_MOTION))
    poses, twists = poses_of(rows), twists_of(rows)
    for k, time in enumerate(times[1:].tolist()):
        for body, path in enumerate((path_a, path_b)):
            pose = path.pose(time)
            poses[body][k], twists[body][k] = flat_pose(pose), flat_twist(path.twist(time), pose)
    return Motion(times, rows)


def distances(tracker: Tracker, state: TrackerState, motion: Motion) -> Array:
    """Return the distance in every frame after a start, shape (n - 1,) [length].

    Nothing but the law moves the witness points: a frame that it refuses is nan, with all after.

    Parameters
    ----------
    tracker : Tracker
        With a law without restarts.
    state : TrackerState
        Of the motion's first time.
    motion : Motion
    """
    prepare(paper=True, planar=tracker.planar, runs=True)
    answers = np.full((len(motion.rows), K.N_OUT), np.nan)
    log = np.empty(N.MAX_EVENTS * N.EVENT_COLUMNS)
    refused, _ = kernels.run(
        tracker.packed,
        motion.rows,
        True,
        np.diff(motion.times),
        tracker.options,
        state.data.copy(),
        answers,
        log,
    )
    found = answers[:, K.DISTANCE].copy()
    if refused >= 0:
        found[refused:] = np.nan
    return found
