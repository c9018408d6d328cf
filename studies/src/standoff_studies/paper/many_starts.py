"""Many wrong starts of one law along one motion, in compiled loops: which of them converge."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np

from standoff.bodies import Body
from standoff.kernels.state import arrays as K
from standoff.motion import Path, Pose
from standoff.tracking import Proximity, Tracker, TrackerState, pair_system
from standoff.tracking.frame_buffer import FrameBuffer
from standoff.tracking.inputs import flat_pose, flat_twist
from standoff.tracking.rows import poses_of, twists_of
from standoff.typing import Array

AT_SIDE = 1e-9
"""Parameters nearer to 0 or 1 than this are at a side: the zeroing holds them there exactly."""

LEFT = 1e-3
"""Projection errors above this have not decayed [length²]: those that have are far below it."""

INDEFINITE = (
    "on large parts of the right, facing faces M as printed is indefinite: away from the minimum "
    "ΔR·f_uu has a part along the tangents, which belongs to the parametrisation and not to the "
    "body. The zeroing then holds the witness point at a side or in a corner of the patch"
)
"""Why starts on the right faces do not arrive."""


class Ends(NamedTuple):
    """Where the tried starts ended.

    Attributes
    ----------
    arrived, tried : int
    by : str
        The law with which they were tried.
    placed, pinned : int
        Of those that did not arrive: how many are on the features of the closest points, and how
        many are held at a side of a patch with M indefinite and projection errors left. 0 if this
        was not examined.
    """

    arrived: int
    tried: int
    by: str
    placed: int = 0
    pinned: int = 0

    @property
    def lost(self) -> int:
        """How many did not arrive."""
        return self.tried - self.arrived


def is_pinned(bodies: tuple[Body, Body], poses: tuple[Pose, Pose], answer: Proximity) -> bool:
    """Is a start held at a side of a patch, with M indefinite and projection errors left?

    For bodies of patches with parameters in [0, 1].
    """
    # roundoff may have taken a parameter past an end
    on_a, on_b = (np.clip(at, 0.0, 1.0) for at in (answer.parameters_a, answer.parameters_b))
    places = (answer.feature_a, on_a), (answer.feature_b, on_b)
    parameters = np.array([*on_a, *on_b])
    at_side = bool((np.minimum(parameters, 1.0 - parameters) < AT_SIDE).any())
    system = pair_system(*bodies, *poses, *places)
    indefinite = bool(np.linalg.eigvalsh(system.H).min(initial=np.inf) < 0.0)
    return at_side and indefinite and bool(np.linalg.norm(system.Psi) > LEFT)


def begun(
    tracker: Tracker, paths: tuple[Path, Path], place_a: Any, place_b: Any, time: float = 0.0
) -> TrackerState:
    """Return a law's state at any place on each body, at a time [s]."""
    a, b = paths
    poses, twists = (a.pose(time), b.pose(time)), (a.twist(time), b.twist(time))
    return tracker.start_from(*poses, place_a, place_b, *twists, settle=False)


def motion_along(path_a: Path, path_b: Path, times: Array) -> Array:
    """Return two paths' poses and twists at times [s], except at the first, that of the start.

    One row per time, as the kernels read them.
    """
    rows = np.empty((len(times) - 1, K.N_MOTION))
    poses, twists = poses_of(rows), twists_of(rows)
    for k, time in enumerate(times[1:].tolist()):
        for body, path in enumerate((path_a, path_b)):
            pose = path.pose(time)
            poses[body][k], twists[body][k] = flat_pose(pose), flat_twist(path.twist(time), pose)
    return rows


def stepped(tracker: Tracker, state: TrackerState, rows: Array) -> Iterator[FrameBuffer]:
    """Yield a tracker's buffer after each row of a motion: always the same buffer, overwritten."""
    poses, twists, buffer = poses_of(rows), twists_of(rows), tracker.buffer(state)
    for k in range(len(rows)):
        buffer.pose_a[:], buffer.pose_b[:] = poses[0][k], poses[1][k]
        buffer.twist_a[:], buffer.twist_b[:] = twists[0][k], twists[1][k]
        tracker.step_into(buffer)
        yield buffer


def last_answers(
    tracker: Tracker, states: Iterable[TrackerState], paths: tuple[Path, Path], times: Array
) -> Iterator[Proximity]:
    """Yield the last frame's answer of each start, along two paths.

    Parameters
    ----------
    tracker : Tracker
    states : iterable of TrackerState
        At the first time.
    paths : (Path, Path)
    times : ndarray, shape (n,)
        s
    """
    rows = motion_along(*paths, times)
    for state in states:
        *_, buffer = stepped(tracker, state, rows)
        yield buffer.proximity()
