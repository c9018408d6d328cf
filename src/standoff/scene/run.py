"""Running a scene: one cold query, or the tracker over all frames."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

import numpy as np

from standoff.scene.errors import SceneError
from standoff.scene.reader import Array
from standoff.scene.recording import Recording
from standoff.scene.scene import Scene
from standoff.scene.settings import TrackSettings
from standoff.tracking import Proximity, Tracker, distance

Watch = Callable[[Iterable[Proximity], int], Iterable[Proximity]]
"""Passes the answers through, given how many will come, and may look on, as a progress bar does."""


def query(scene: Scene, time: float | None = None) -> tuple[float, Proximity]:
    """Return the pair's certified distance at one instant, without a tracker.

    Parameters
    ----------
    scene : Scene
    time : float, optional
        Scene time [s]; the first frame's if not given.

    Returns
    -------
    (float, Proximity)
        The instant and the answer.

    Raises
    ------
    SceneError
        If a motion is not known then, or the pair cannot be asked for a distance.
    """
    instant = scene.instant(time)
    a, b = scene.pair_bodies
    pose_a, pose_b = (motion.path.pose(instant) for motion in scene.pair_motions)
    try:
        return instant, distance(a, b, pose_a, pose_b)
    except (ValueError, TypeError) as error:
        raise SceneError(str(error), key="pair", file=scene.file) from error


def prepare(scene: Scene, settings: TrackSettings) -> tuple[Tracker, Array]:
    """Return the tracker and the frame times of a run, all checked.

    Raises
    ------
    SceneError
        If the times are not possible or the tracker refuses its settings.
    """
    times = scene.times(settings)
    a, b = scene.pair_bodies
    try:
        tracker = Tracker(
            a,
            b,
            # The longest step: the default gain, and the check of a given one, hold for all.
            dt=float(np.diff(times).max()),
            law=settings.law,
            predictor=settings.predictor,
            integrator=settings.integrator,
            gain=settings.gain,
            tolerance=settings.tolerance,
        )
    except (ValueError, TypeError) as error:
        raise SceneError(str(error), key="track", file=scene.file) from error
    return tracker, times


def record(
    scene: Scene, settings: TrackSettings | None = None, watch: Watch | None = None
) -> Recording:
    """Track the scene's pair over all frames.

    Parameters
    ----------
    scene : Scene
    settings : TrackSettings, optional
        In place of the scene's own.
    watch : callable, optional
        What the answers pass through, one by one as they come.

    Returns
    -------
    Recording

    Raises
    ------
    SceneError
        As `prepare`, or if the pair cannot be tracked, as a planar body out of its plane.
    """
    tracker, times = prepare(scene, settings or scene.settings)
    recording = Recording.empty(times)
    answers: Iterable[Proximity] = _answers(tracker, scene, times)
    for answer in watch(answers, len(times)) if watch is not None else answers:
        recording.append(answer)
    return recording


def _answers(tracker: Tracker, scene: Scene, times: Array) -> Iterator[Proximity]:
    path_a, path_b = (motion.path for motion in scene.pair_motions)
    previous = float(times[0])
    try:
        poses = path_a.pose(previous), path_b.pose(previous)
        state = tracker.start(*poses, path_a.twist(previous), path_b.twist(previous))
        yield state.proximity
        for time in times[1:].tolist():
            poses = path_a.pose(time), path_b.pose(time)
            twists = path_a.twist(time), path_b.twist(time)
            state, answer = tracker.step(state, *poses, *twists, dt=time - previous)
            previous = time
            yield answer
    except (ValueError, TypeError) as error:
        raise SceneError(str(error), key="pair", file=scene.file) from error
