"""What is shown at one instant, of a live answer or of a frame of a recording."""

from __future__ import annotations

from typing import NamedTuple

from standoff.bodies.body import Body
from standoff.bodies.features import Feature
from standoff.errors import StandoffError
from standoff.motion import Pose
from standoff.recording import Recording
from standoff.recording.recorded import Paths
from standoff.tracking import Proximity, Status
from standoff.typing import Array


class ShownPair(NamedTuple):
    """Where both bodies are and what is known of their distance there.

    Attributes
    ----------
    poses : (Pose, Pose)
    points : two (3,) arrays
        Witness points, world axes.
    normal : (3,) array
    distance, lower_bound : float
    features : (Feature, Feature)
    status : Status
    """

    poses: tuple[Pose, Pose]
    points: tuple[Array, Array]
    normal: Array
    distance: float
    lower_bound: float
    features: tuple[Feature, Feature]
    status: Status


def of_answer(answer: Proximity, poses: tuple[Pose, Pose]) -> ShownPair:
    """Return what is shown of an answer.

    Parameters
    ----------
    answer : Proximity
    poses : (Pose, Pose)
        That it was asked for.
    """
    return ShownPair(
        poses,
        (answer.point_a, answer.point_b),
        answer.normal,
        answer.distance,
        answer.lower_bound,
        (answer.feature_a, answer.feature_b),
        answer.status,
    )


def of_frame(recording: Recording, frame: int) -> ShownPair:
    """Return what is shown of a frame of a recording that still has its paths."""
    assert recording.paths is not None
    time = float(recording.time[frame])
    pose_a, pose_b = (Pose.of(path.pose(time)) for path in recording.paths)
    return ShownPair(
        (pose_a, pose_b),
        (recording.point_a[frame], recording.point_b[frame]),
        recording.normal[frame],
        float(recording.distance[frame]),
        float(recording.lower_bound[frame]),
        (recording.feature_a[frame], recording.feature_b[frame]),
        recording.status[frame],
    )


def what_moved(recording: Recording) -> tuple[tuple[Body, Body], Paths]:
    """Return the bodies of a run and their paths.

    Raises StandoffError if it was opened from a file or copied: it does not hold them then.
    """
    if recording.pair is None or recording.paths is None:
        raise StandoffError(
            "A recording that was opened from a file, copied or unpickled does not hold what "
            "moved: save the one that so.track returned.",
            "recording",
            recording,
        )
    return recording.pair, recording.paths
