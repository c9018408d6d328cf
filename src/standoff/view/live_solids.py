"""A pair of solids that a page shows: followed where it is put, or along the scene's motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from standoff.errors import StandoffError
from standoff.motion import Pose
from standoff.solids.answer import SolidProximity
from standoff.solids.spatial.models import as_model
from standoff.solids.tracked.answers import SolidAnswers
from standoff.solids.tracked.tracker import SolidTracker, untracked
from standoff.tracking import Status
from standoff.typing import Array
from standoff.view.minima_asked import MinimaAsked
from standoff.view.tolerances import FRAME_EVALUATIONS, NEAR_MINIMA

Poses = tuple[Pose, Pose]


def tracker_of(a: Any, b: Any, asked: MinimaAsked, dt: float = 1e-3) -> SolidTracker:
    """Return the tracker of a pair that a page shows, at least one of both a solid.

    Raises StandoffError: what has no tracker, as planar solids, or a number that is not positive.
    """
    for name, body in (("A", a), ("B", b)):
        if body.dimension == 2:
            raise StandoffError(
                f"Body {name} is planar, and the live page shows solids in space: so.plot draws "
                "planar ones with an answer.",
                name.lower(),
                body,
            )
    minima = asked.minima
    if minima is None:
        # What has no tracker is refused below, in the tracker's words.
        models = (as_model(body) for body in (a, b))
        minima = NEAR_MINIMA * min(model.size for model in models if not untracked(model))
    return SolidTracker(a, b, dt, minima=minima, patch=asked.patch, deadline=FRAME_EVALUATIONS)


class LiveSolids:
    """Two solids where they are put, and the tracker's answer there.

    Raises ValueError: what ``tracker.start`` refuses.

    Parameters
    ----------
    tracker : SolidTracker
    poses : (Pose, Pose)
        Where they begin.

    Attributes
    ----------
    tracker : SolidTracker
    poses : (Pose, Pose)
    answer : SolidProximity
        At these poses.
    """

    def __init__(self, tracker: SolidTracker, poses: Poses) -> None:
        self.tracker = tracker
        self.restart(poses)

    @property
    def settled(self) -> bool:
        """Has the answer all that is asked? A frame that ran out of evaluations goes on."""
        return self.answer.status is not Status.DEADLINE

    def restart(self, poses: Poses) -> None:
        """Start again at poses: keys of minima count from 0.

        Raises ValueError as of ``tracker.start``; the pair is as it was then.
        """
        # A start in overlap tells the deepest place alone; a frame tells all of them, with keys.
        self._state, self.answer = self.tracker.step(self.tracker.start(*poses), *poses)
        self.poses = poses

    def move(self, poses: Poses) -> SolidProximity:
        """Put the solids at poses, in one frame, and return the answer there.

        Raises ValueError as of ``tracker.step``; the pair is as it was then.
        """
        self._state, self.answer = self.tracker.step(self._state, *poses)
        self.poses = poses
        return self.answer


class SolidPlotPoint(NamedTuple):
    """What the plot shows of a frame.

    Attributes
    ----------
    distance, lower_bound : float
        Length; the bound is that of the nearest minimum where an overlap has none of its own.
    """

    distance: float
    lower_bound: float


def known_of(answer: SolidProximity) -> SolidPlotPoint:
    """Return what the plot shows of an answer."""
    bound = answer.lower_bound
    if not np.isfinite(bound) and answer.minima:
        bound = answer.minima[0].lower_bound
    return SolidPlotPoint(answer.distance, bound)


@dataclass(frozen=True, eq=False)
class SolidCourse:
    """A pair of solids over the frames of a motion.

    Attributes
    ----------
    time : (n,) array [s]
    poses : sequence of (Pose, Pose)
    answers : SolidAnswers
    distance, lower_bound : (n,) arrays
        As in `SolidPlotPoint`.
    """

    time: Array
    poses: Sequence[Poses]
    answers: SolidAnswers
    distance: Array
    lower_bound: Array


def course_of(tracker: SolidTracker, times: Array, poses: Sequence[Poses]) -> SolidCourse:
    """Follow a pair over all frames.

    Raises ValueError: what the tracker refuses.

    Parameters
    ----------
    tracker : SolidTracker
    times : (n,) array [s]
    poses : sequence of (Pose, Pose)
        Of the n frames.
    """
    state = tracker.start(*poses[0])
    a, b = ([each[k].matrix for each in poses] for k in (0, 1))
    _, answers = tracker.run(state, np.array(a), np.array(b))
    bound = answers.lower_bound.copy()
    minima = answers.minima
    first = np.minimum(np.searchsorted(minima.frame, np.arange(len(times))), len(minima.frame) - 1)
    if len(minima.frame):
        told = minima.frame[first] == np.arange(len(times))
        unknown = ~np.isfinite(bound) & told
        bound[unknown] = minima.lower_bound[first[unknown]]
    return SolidCourse(times, poses, answers, answers.distance, bound)
