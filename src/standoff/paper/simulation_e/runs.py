"""The pair, its motion, and the runs that both figures show."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

import standoff as so
from standoff.bodies import Body
from standoff.motion import Carried, ConstantTwist, Fixed, Helix, Pose, Twist
from standoff.paper.bodies import lens_of_patches
from standoff.paper.simulation_d.runs import place_on, short
from standoff.tracking import Recording, Tracker, Visit
from standoff.tracking.simulate import track_along
from standoff.tracking.times import even_times

Array = NDArray[np.float64]

STEP = 1e-3
"""Sample time [s]: the paper's 1 kHz."""

DURATION = 2.0
"""Time of the run [s]."""

SEMI_AXES = (0.8, 0.6, 0.7)
"""Body B is the lens stretched by these along x, y and z."""

PATH_A = Fixed(Pose.identity())

PATH_B = Carried(
    Helix(radius=1.7, pitch=-0.2, rate=1.0, centre=(0.0, 0.0, -0.2), phase=-0.5),
    ConstantTwist(Pose.exp((-0.1, 0.0, 0.3)), Twist((0.0, 0.0, 0.0), (-0.3, -0.8, 0.5))),
)
"""B's centre winds about A's axis while B turns [length, rad/s]: chosen so that both bodies pass
from a face over an edge to the next face."""


@dataclass(frozen=True, eq=False)
class Runs:
    """What both figures show.

    Attributes
    ----------
    a, b : Body
    exact : Recording
        With the default law: every frame certified, every switch located within its step.
    paper : Recording
        With the paper's law, Heun, K = 1/STEP.
    """

    a: Body
    b: Body
    exact: Recording
    paper: Recording


@cache
def run() -> Runs:
    """Track the pair with both laws."""
    a = lens_of_patches()
    b = a.transformed(np.diag(SEMI_AXES))
    exact = so.simulate(a, b, PATH_A, PATH_B, DURATION, STEP)
    times = even_times(0.0, DURATION, STEP)
    paper = track_along(Tracker(a, b, STEP, law="paper", integrator="heun"), PATH_A, PATH_B, times)
    return Runs(a, b, exact, paper)


def sequence(visits: Iterable[Visit]) -> tuple[tuple[str, str], ...]:
    """Return the visited modes in order, as the pictures name them: ("F0", "E2") and so on."""
    return tuple((short(visit.feature_a), short(visit.feature_b)) for visit in visits)


def features_of(recording: Recording, body: str) -> tuple[str, ...]:
    """Return the features that one body's witness point goes through, in order."""
    names = [pair["AB".index(body)] for pair in sequence(recording.modes())]
    return tuple(name for k, name in enumerate(names) if k == 0 or name != names[k - 1])


@dataclass(frozen=True)
class FaceParameters:
    """Where one body's witness point lies in the parameters of a face, by frame.

    While it is on an edge these are those of the face that it came from.

    Attributes
    ----------
    face : ndarray of int, shape (n,)
    u, v : ndarray, shape (n,)
    on_edge : ndarray of bool, shape (n,)
    """

    face: NDArray[np.int64]
    u: Array
    v: Array
    on_edge: NDArray[np.bool_]

    @property
    def pieces(self) -> list[slice]:
        """Stretches of frames on one face: between them the parameters jump."""
        cuts = [0, *(np.flatnonzero(np.diff(self.face)) + 1).tolist(), len(self.face)]
        return [slice(first, last) for first, last in pairwise(cuts)]


def face_parameters(recording: Recording, body: str) -> FaceParameters:
    """Return the face parameters of body "A" or "B" in every frame.

    Raises
    ------
    ValueError
        If the run begins on an edge, or comes to a vertex, whose u has no meaning.
    """
    assert recording.pair is not None, "not opened from a file"
    part = recording.pair["AB".index(body)]
    features = recording.feature_a if body == "A" else recording.feature_b
    parameters = recording.parameters_a if body == "A" else recording.parameters_b
    if features[0].kind != "face" or any(feature.kind == "vertex" for feature in features):
        raise ValueError(f"body {body}: the run must begin on a face and come to no vertex")
    face, rows = int(features[0].index), []
    for feature, own in zip(features, parameters, strict=True):
        face = int(feature.index) if feature.kind == "face" else face
        place = place_on(part, face, feature, own)
        assert place is not None, "an edge is entered from one of its faces"
        rows.append((face, place.u, place.v, feature.kind == "edge"))
    columns = list(zip(*rows, strict=True))
    return FaceParameters(*(np.array(column) for column in columns))


def witness_error(runs: Runs) -> Array:
    """Return how far the paper's law's worse witness point is off the exact one [length], (n,)."""
    off_a = np.linalg.norm(runs.paper.point_a - runs.exact.point_a, axis=1)
    off_b = np.linalg.norm(runs.paper.point_b - runs.exact.point_b, axis=1)
    return np.asarray(np.maximum(off_a, off_b))


def rises(runs: Runs) -> Array:
    """Return how much farther apart the paper's law is at each switch than without it [length].

    The frame with the switch is stepped again from the frame before, with the witness points kept
    on their features: saturated as printed, and not switched.
    """
    law = Tracker(runs.a, runs.b, STEP, law="paper", integrator="heun", switching="none")
    recording, found = runs.paper, []
    for event in recording.events:
        before, after = event.frame - 1, event.frame
        places = []
        for features, rows in (
            (recording.feature_a, recording.parameters_a),
            (recording.feature_b, recording.parameters_b),
        ):
            own = rows[before]
            places += [features[before], own[~np.isnan(own)]]
        pose_a, pose_b, *twists = _placed(recording.time[before])
        start = law.start_from(pose_a, pose_b, *places, *twists)
        _, kept = law.step(start, *_placed(recording.time[after]))
        found.append(recording.distance[after] - kept.distance)
    return np.array(found)


def _placed(time: float) -> tuple[Pose, Pose, Twist, Twist]:
    return PATH_A.pose(time), PATH_B.pose(time), PATH_A.twist(time), PATH_B.twist(time)
