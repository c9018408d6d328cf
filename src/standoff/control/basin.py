"""Basins of attraction: from which starts a law finds the true minimum of a pair at rest."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.checks.numbers import whole_number
from standoff.checks.real_numbers import shown
from standoff.control.tolerances import FOUND_MINIMUM, SETTLED_RUN
from standoff.errors import StandoffError, StandoffTypeError
from standoff.motion import PoseLike
from standoff.tracking import Tracker, calls, distance
from standoff.tracking.calls import DESCEND, HERE, FrameInput
from standoff.tracking.inputs import flat_pose
from standoff.tracking.laws import PaperLaw
from standoff.tracking.places import PlaceLike, put
from standoff.tracking.rows import AnswerRows, StateRow
from standoff.typing import Array


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
    repaired : int
        How many of the two poses were given with a rounded rotation, and were replaced by the
        nearest one.
    """

    found: NDArray[np.bool_]
    elsewhere: NDArray[np.bool_]
    distance: Array
    steps: int
    repaired: int

    @property
    def fraction(self) -> float:
        """Share of the starts that found the true minimum."""
        return float(self.found.mean())


def basin(
    tracker: Tracker,
    pose_a: PoseLike,
    pose_b: PoseLike,
    starts: Sequence[tuple[PlaceLike, PlaceLike]],
    steps: int,
) -> Basin:
    """Run a tracker at rest from many starts and compare with the certified minimum.

    Raises TypeError: no tracker. Raises ValueError: no frames or starts, a start outside its
    feature, or a pair without a certified distance.

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
    """
    if not isinstance(tracker, Tracker):
        raise StandoffTypeError(
            f"{shown(tracker)} is not a Tracker: make one with so.Tracker(a, b).",
            "tracker",
            tracker,
        )
    steps = whole_number(steps, "steps")
    _check_starts(starts, steps)
    true = distance(tracker.a, tracker.b, pose_a, pose_b)
    if not true.certified or true.distance <= 0.0:
        raise StandoffError(f"The pair has no certified distance to compare with: {true!r}.")
    frames = AtRest(tracker, flat_pose(pose_a), flat_pose(pose_b), steps)
    last = AnswerRows(np.array([frames.after(*start) for start in starts]))
    size = max(_size(tracker.a), _size(tracker.b), true.distance)
    off = np.maximum(
        np.linalg.norm(last.point_a - true.point_a, axis=1),
        np.linalg.norm(last.point_b - true.point_b, axis=1),
    )
    reached = np.asarray(last.distance)
    near = FOUND_MINIMUM * size
    found = (off <= near) & (np.abs(reached - true.distance) <= near)
    settled = last.residual <= SETTLED_RUN * reached
    return Basin(found, settled & ~found, reached, steps, true.repaired)


def _check_starts(given: Any, steps: int) -> None:
    """Refuse what is not a sequence of pairs of places."""
    if not isinstance(given, Sequence) or isinstance(given, str | bytes) or not given:
        raise StandoffError(
            f"starts = {shown(given)} of {steps} steps: give one or more.", "starts", given
        )
    for k, start in enumerate(given):
        pair = isinstance(start, tuple | list) and len(start) == 2
        if not pair or not all(isinstance(x, tuple | list) and len(x) == 2 for x in start):
            raise StandoffError(
                f"starts[{k}] = {shown(start)}: give a pair of (feature, parameters) for A and B.",
                "starts",
                start,
            )


def _size(body: Body) -> float:
    return body.size if body.bounded else 0.0


class AtRest:
    """A compiled run of frames at rest, its arrays made once.

    Without `Tracker.start_from`, which for each bad start would look whether the bodies overlap.
    """

    def __init__(self, tracker: Tracker, flat_a: Array, flat_b: Array, steps: int) -> None:
        self.tracker = tracker
        self.frame = FrameInput(flat_a, flat_b, has_twist=True)
        self.motions = np.tile(self.frame.row, (steps, 1))
        self.times = np.full(steps, tracker.dt)
        self.given = HERE if isinstance(tracker.law, PaperLaw) else DESCEND

    def after(self, place_a: PlaceLike, place_b: PlaceLike) -> Array:
        """The answer's numbers after all frames from a start."""
        t = self.tracker
        begun = StateRow()
        put(begun, 0, t.a, place_a)
        put(begun, 1, t.b, place_b)
        calls.start(t.table, self.frame, begun, self.given)
        rows = calls.run(t.table, self.motions, True, self.times, begun.data).rows
        return np.asarray(rows[-1])
