"""A point tracked along a path: every frame, and the instants of its switches."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from standoff.bodies.body import Body
from standoff.bodies.features import Feature
from standoff.checks.arrays import finite
from standoff.checks.real_numbers import shape_of, shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.motion import PoseLike
from standoff.motion.moving import Moving
from standoff.motion.pose_function import path_of
from standoff.points.answer import Minimum, PointEvent, PointProximity
from standoff.points.state import PointState
from standoff.points.switches import PointWay
from standoff.points.tracker import PointTracker
from standoff.read_only import KeepsReadOnly
from standoff.tracking.inputs import flat_pose, flat_twist
from standoff.typing import Array
from standoff.wording import counted, short_name


class PointVisit(NamedTuple):
    """A stay in one mode: the side and the active feature.

    Attributes
    ----------
    inside : bool
        Whether the point was inside the body.
    feature : Feature
    start, end : float
        Times, s.
    """

    inside: bool
    feature: Feature
    start: float
    end: float


@dataclass(frozen=True, eq=False, repr=False)
class PointRecording(KeepsReadOnly):
    """Answers of a run, by frame; row k of every array belongs to ``time[k]``.

    Attributes
    ----------
    time : ndarray, shape (n,)
        s, on the path's clock.
    point : ndarray, shape (n, 3)
    distance, lower_bound, upper_bound, rate, residual : ndarray, shape (n,)
        As in `PointProximity`.
    witness, normal : ndarray, shape (n, 3)
    inside : ndarray of bool, shape (n,)
    feature : ndarray of Feature, shape (n,)
    parameters : ndarray, shape (n, 3)
        Of the active feature, nan where there is none: t of a curve, u, v and chart of a face.
    curve_parameter, curve_distance, curve_residual : ndarray, shape (n, curves)
        Of a local minimum of the distance to each curve: the nearest of those that are followed on
        it. On the active curve it is the curve's nearest point. Another curve may have a nearer
        minimum that is not followed, because it is not the answer. Distances have no sign. For a
        spatial body there are none.
    answers : tuple of PointProximity
    events : tuple of PointEvent
        In order of time.
    body : Body
    """

    time: Array
    point: Array
    distance: Array
    lower_bound: Array
    upper_bound: Array
    rate: Array
    residual: Array
    witness: Array
    normal: Array
    inside: NDArray[np.bool_]
    feature: NDArray[np.object_]
    parameters: Array
    curve_parameter: Array
    curve_distance: Array
    curve_residual: Array
    answers: tuple[PointProximity, ...]
    events: tuple[PointEvent, ...]
    body: Body = field(repr=False)

    def __len__(self) -> int:
        return len(self.time)

    def __repr__(self) -> str:
        start, end = self.time[[0, -1]] + 0.0
        frames, name = counted(len(self), "frame"), short_name(self.body.name)
        return f"<PointRecording of {frames}: {name}, {start:g} to {end:g} s>"

    def modes(self) -> list[PointVisit]:
        """Return the visited modes in order of time; a stay of no length is left out."""
        first = self.answers[0]
        inside, feature, start = first.inside, first.feature, float(self.time[0])
        visits: list[PointVisit] = []
        for event in self.events:
            if event.time > start:
                visits.append(PointVisit(inside, event.source, start, event.time))
                start = event.time
            inside, feature = inside ^ (event.kind == "crossing"), event.target
        visits.append(PointVisit(inside, feature, start, float(self.time[-1])))
        return visits


def record_point(
    tracker: PointTracker,
    path: Moving | Callable[[float], PoseLike],
    times: ArrayLike,
    start: PointState | None = None,
    *,
    locate: bool = True,
) -> PointRecording:
    """Track a point along a path and record every frame.

    Raises TypeError: not a `PointTracker`, or not a path. Raises ValueError: times that do not
    increase, or what the tracker refuses.

    Parameters
    ----------
    tracker : PointTracker
        Of a planar or a spatial body.
    path : path or function
        A path of ``standoff.motion``, anything with ``pose(t)`` and ``twist(t)``, or a function of
        time that returns a pose; its origin is the point.
    times : array_like, shape (n,)
        Of the frames [s], strictly increasing.
    start : PointState, optional
        Where to begin, such as a wrong start of ``tracker.start_from``; its answer is the first
        frame's. By default ``tracker.start``.
    locate : bool
        Find the instants of the switches within their steps; else they get the times of the frames.

    Returns
    -------
    PointRecording
    """
    if not isinstance(tracker, PointTracker):
        raise StandoffTypeError(
            f"{shown(tracker)} is not a PointTracker: make one with so.PointTracker(body).",
            "tracker",
            tracker,
        )
    clock = _clock(times)
    last = float(clock[-1]) if len(clock) > 1 else math.inf
    moving: Moving = path_of(path, float(clock[0]), last)
    x, v = _placed(moving, float(clock[0]))
    state = tracker.start(x, v) if start is None else start
    states = [state]
    for before, time in pairwise(clock.tolist()):
        way = PointWay(before, time, partial(_placed, moving))
        state = tracker.step_along(state, *way.place(time), way, locate)
        states.append(state)
    return _recording(tracker, clock, states)


def _clock(times: ArrayLike) -> Array:
    """The times as an array; raises ValueError where they do not increase."""
    shape = shape_of(times)
    if shape is None or len(shape) != 1 or not shape[0]:
        raise StandoffError(f"times = {shown(times)}: give a list of one or more.", "times", times)
    clock = finite(times, "times", shape)
    if not (np.diff(clock) > 0.0).all():
        raise StandoffError(
            f"times = {shown(times)}: give them strictly increasing.", "times", times
        )
    return clock


def _placed(path: Moving, time: float) -> tuple[Array, Array]:
    """Place and velocity, (3,), of a path's origin at a time [s]."""
    pose = path.pose(time)
    return flat_pose(pose)[9:].copy(), flat_twist(path.twist(time), pose)[:3].copy()


def _recording(tracker: PointTracker, clock: Array, states: list[PointState]) -> PointRecording:
    answers = tuple(state.proximity for state in states)
    curves = range(tracker.body.n_edges if tracker.body.dimension == 2 else 0)
    nearest = [[answer.of_curve(c) for c in curves] for answer in answers]
    parameters = np.full((len(answers), 3), np.nan)
    for row, answer in zip(parameters, answers, strict=True):
        row[: len(answer.parameters)] = answer.parameters
    features = np.empty(len(answers), dtype=object)
    features[:] = [answer.feature for answer in answers]

    def numbers(name: str) -> Array:
        return np.array([getattr(answer, name) for answer in answers], dtype=np.float64)

    def of_curves(number: Callable[[Minimum], float]) -> Array:
        return np.array([[number(m) for m in row] for row in nearest], dtype=np.float64)

    return PointRecording(
        time=clock,
        point=np.array([state.point for state in states]),
        distance=numbers("distance"),
        lower_bound=numbers("lower_bound"),
        upper_bound=numbers("upper_bound"),
        rate=numbers("rate"),
        residual=numbers("residual"),
        witness=numbers("witness"),
        normal=numbers("normal"),
        inside=np.array([answer.inside for answer in answers]),
        feature=features,
        parameters=parameters,
        curve_parameter=of_curves(lambda m: m.parameters[0]),
        curve_distance=of_curves(lambda m: m.distance),
        curve_residual=of_curves(lambda m: m.residual),
        answers=answers,
        events=tuple(event for answer in answers[1:] for event in answer.events),
        body=tracker.body,
    )
