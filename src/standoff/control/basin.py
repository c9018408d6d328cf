"""Basins of attraction: from which starts a law finds the true minimum of a pair at rest."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.geometry.validation import Array
from standoff.kernels import events as N
from standoff.kernels import frame as K
from standoff.kernels import tracker as kernels
from standoff.motion import PoseLike
from standoff.real_numbers import shown
from standoff.tracking import Tracker, distance
from standoff.tracking.choices import whole_number
from standoff.tracking.inputs import flat_pose, place

# A run has found the minimum where its distance and witness points are within this part of the
# pair's size of the true ones: far above roundoff, far below the way to any other stationary point.
FOUND = 1e-6
# A run has settled where the projection of the witness vector on the tangents is below this part
# of its length.
SETTLED = 1e-6

Place = tuple[Any, Any]


class Basin(NamedTuple):
    """What became of each start.

    Attributes
    ----------
    found : (n,) bool array
        It ended at the true minimum.
    elsewhere : (n,) bool array
        It settled at another stationary point of the distance.
    distance : (n,) array
        At the end, length.
    steps : int
        Frames that each start was given.
    """

    found: NDArray[np.bool_]
    elsewhere: NDArray[np.bool_]
    distance: Array
    steps: int

    @property
    def fraction(self) -> float:
        """Share of the starts that found the true minimum."""
        return float(self.found.mean())


def basin(
    tracker: Tracker,
    pose_a: PoseLike,
    pose_b: PoseLike,
    starts: Sequence[tuple[Place, Place]],
    steps: int,
) -> Basin:
    """Run a tracker at rest from many starts and compare with the certified minimum.

    Parameters
    ----------
    tracker : Tracker
        With the paper's law and ``solve="plain"`` it shows the basin of the raw law.
    pose_a, pose_b : Pose or what ``Pose.of`` reads
        World poses; the bodies stay there.
    starts : sequence of pairs of (feature, parameters)
        As ``Tracker.start_from`` takes them, for A and for B.
    steps : int
        Frames of ``tracker.dt`` per start.

    Returns
    -------
    Basin

    Raises
    ------
    TypeError
        No tracker.
    ValueError
        No frames or starts, a start outside its feature, or a pair without a certified distance.
    """
    if not isinstance(tracker, Tracker):
        raise TypeError(f"{shown(tracker)} is not a Tracker: make one by so.Tracker(a, b).")
    steps = whole_number(steps, "steps")
    given: Any = starts
    if not isinstance(given, Sequence) or isinstance(given, str | bytes) or not given:
        raise ValueError(f"starts = {shown(given)} of {steps} steps: give one or more.")
    for k, start in enumerate(given):
        pair = isinstance(start, tuple | list) and len(start) == 2
        if not pair or not all(isinstance(x, tuple | list) and len(x) == 2 for x in start):
            raise ValueError(
                f"starts[{k}] = {shown(start)}: give a pair of (feature, parameters) for A and B."
            )
    true = distance(tracker.a, tracker.b, pose_a, pose_b)
    if not true.certified or true.distance <= 0.0:
        raise ValueError(f"The pair has no certified distance to compare with: {true!r}.")
    frames = _Frames(tracker, flat_pose(pose_a), flat_pose(pose_b), steps)
    last = np.array([frames.after(*start) for start in starts])
    size = max(_size(tracker.a), _size(tracker.b), true.distance)
    off = np.maximum(
        np.linalg.norm(last[:, K.POINT_A : K.POINT_A + 3] - true.point_a, axis=1),
        np.linalg.norm(last[:, K.POINT_B : K.POINT_B + 3] - true.point_b, axis=1),
    )
    reached = last[:, K.DISTANCE]
    found = (off <= FOUND * size) & (np.abs(reached - true.distance) <= FOUND * size)
    settled = last[:, K.RESIDUAL] <= SETTLED * reached
    return Basin(found, settled & ~found, reached, steps)


def _size(body: Body) -> float:
    return body.size if body.bounded else 0.0


class _Frames:
    """A compiled run of frames at rest, its arrays made once.

    Without `Tracker.start_from`, which for each bad start would look whether the bodies overlap.
    """

    def __init__(self, tracker: Tracker, flat_a: Array, flat_b: Array, steps: int) -> None:
        self.tracker = tracker
        self.poses = np.tile(flat_a, (steps, 1)), np.tile(flat_b, (steps, 1))
        self.twists = np.zeros((steps, 6))
        self.times = np.full(steps, tracker.dt)
        self.outs = np.empty((steps, K.N_OUT))
        self.events = np.empty(N.MAX_EVENTS * N.EVENT_COLUMNS)
        self.given = K.START_HERE if tracker.law == "paper" else K.START_DESCEND

    def after(self, place_a: Place, place_b: Place) -> Array:
        """The answer's numbers after all frames from a start."""
        t, still = self.tracker, self.twists[0]
        state = np.zeros(K.N_STATE)
        place(state, 0, t.a, *place_a)
        place(state, 2, t.b, *place_b)
        flat = self.poses[0][0], self.poses[1][0]
        kernels.start(
            t.packed, *flat, still, still, True, t.options, state, self.given, self.outs[0]
        )
        kernels.run(
            t.packed,
            *self.poses,
            self.twists,
            self.twists,
            True,
            self.times,
            t.options,
            state,
            self.outs,
            self.events,
        )
        return np.array(self.outs[-1])
