"""The pair, its motion, and the runs that both figures show."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from standoff.automaton import Visit
from standoff.bodies import Body
from standoff.motion import Carried, ConstantTwist, Fixed, Helix, Pose, Twist
from standoff.recording import RecordedEvent, Recording, track
from standoff.recording.times import even_times
from standoff.recording.track import track_along
from standoff.tracking import Tracker, TrackerState
from standoff.tracking.inputs import flat_pose, flat_twist
from standoff.tracking.laws import PaperLaw
from standoff_studies.paper.bodies import lens_of_patches
from standoff_studies.paper.law_words import law_words
from standoff_studies.paper.many_starts import Ends, is_pinned
from standoff_studies.paper.resets import Move, moves_of
from standoff_studies.paper.simulation_d.runs import place_on, short

Array = NDArray[np.float64]

STEP = 1e-3
"""Sample time [s]: the paper's 1 kHz."""

DURATION = 4.0
"""Time of the run [s]: A's witness point is on its edge for a second of it, as the paper's is from
2.67 to 3.66 s."""

SEMI_AXES = (0.8, 0.6, 0.7)
"""Body B is the lens stretched by these along x, y and z."""

PATH_A = Fixed(Pose.identity())

PATH_B = Carried(
    Helix(radius=1.7, pitch=-0.2, rate=0.5, centre=(0.0, 0.0, -0.2), phase=-0.5),
    ConstantTwist(Pose.exp((-0.1, 0.0, 0.3)), Twist((0.0, 0.0, 0.0), (-0.15, -0.4, 0.25))),
)
"""B's centre winds about A's axis while B turns [length, rad/s]: chosen so that both bodies pass
from a face over an edge to the next face."""

GAIN = 50.0
"""K of the printed system [1/s]: "a very low controller gain"."""

START = ((2, (0.85, 0.39)), (2, (0.56, 0.36)))
"""Face and parameters of A and of B where the printed system is started, one that arrives: the
closest points are on faces 0 and 1."""

ENTERED = 0.005
"""After these seconds the switches of the wrong start to the true features are over: the guards see
the opposing points alone, and a frame passes several [s]."""

CONVERGED = 0.3
"""When the start has converged [s]: exp(-K t) is 3e-7."""

TRIED, PATIENCE, ARRIVED = 30, 0.6, 1e-4
"""Random starts, after which time [s], and to which distance [length], they count as arrived."""


SWITCHED = 0.1
"""When a tried start has come to the features where it stays [s]: 5 / `GAIN`."""


@dataclass(frozen=True, eq=False)
class Runs:
    """What both figures show.

    Attributes
    ----------
    a, b : Body
    exact : Recording
        With the default law: every frame certified, every switch located within its step.
    paper : Recording
        With the system as printed at the low `GAIN`, from `START`.
    """

    a: Body
    b: Body
    exact: Recording
    paper: Recording

    @property
    def by(self) -> str:
        """What statements on `paper` were measured with."""
        return law_words(self.paper, told="wrong start")

    @property
    def own(self) -> str:
        """What statements on `exact` were measured with."""
        return law_words(self.exact)


@cache
def pair() -> tuple[Body, Body]:
    """Return the two lenses of patches."""
    a = lens_of_patches()
    return a, a.transformed(np.diag(SEMI_AXES))


@cache
def exact_run() -> Recording:
    """Track the pair with the library's own law."""
    return track(Tracker(*pair(), STEP), PATH_A, PATH_B, DURATION)


@cache
def run() -> Runs:
    """Track the pair with both laws."""
    (a, b), exact = pair(), exact_run()
    times = even_times(0.0, DURATION, STEP)
    law = printed_tracker(a, b)
    paper = track_along(law, PATH_A, PATH_B, times, state=begin(law, *START))
    return Runs(a, b, exact, paper)


def printed_tracker(a: Body, b: Body) -> Tracker:
    """Return the tracker of the system as printed."""
    return Tracker(a, b, STEP, law=PaperLaw.as_printed(gain=GAIN))


Place = tuple[int, tuple[float, float]]
"""A face, and parameters on it."""


def begin(law: Tracker, place_a: Place, place_b: Place) -> TrackerState:
    """Return the state at parameters of two faces, whatever they are worth."""
    pose_a, pose_b, twist_a, twist_b = _placed(0.0)
    of_a, of_b = ("face", place_a[0]), ("face", place_b[0])
    places = (of_a, place_a[1]), (of_b, place_b[1])
    return law.start_from(pose_a, pose_b, *places, twist_a, twist_b, settle=False)


def tried() -> list[tuple[Place, Place]]:
    """Return the random starts on both bodies that are tried."""
    rng, found = np.random.default_rng(1), []
    for _ in range(TRIED):
        faces, at = rng.integers(3, size=2).tolist(), rng.uniform(0.02, 0.98, (2, 2)).tolist()
        first, second = zip(faces, map(tuple, at), strict=True)
        found.append((first, second))
    return found


@cache
def arrivals() -> Ends:
    """Try random starts on both bodies with the printed system: which are there at `PATIENCE`."""
    runs = run()
    law = printed_tracker(runs.a, runs.b)
    frames = round(PATIENCE / STEP)
    placed = [(PATH_B.pose(k * STEP), PATH_B.twist(k * STEP)) for k in range(1, frames + 1)]
    motion = [(flat_pose(pose), flat_twist(twist, pose)) for pose, twist in placed]
    due = runs.exact.feature_a[frames], runs.exact.feature_b[frames]
    poses = _placed(frames * STEP)[:2]
    arrived = on_due = pinned = 0
    for places in tried():
        buffer = law.buffer(begin(law, *places))
        for pose, twist in motion:
            buffer.pose_b[:], buffer.twist_b[:] = pose, twist
            law.step_into(buffer)
        answer = buffer.proximity()
        if abs(answer.distance - runs.exact.distance[frames]) < ARRIVED:
            arrived += 1
            continue
        on_due += (answer.feature_a, answer.feature_b) == due
        pinned += is_pinned((runs.a, runs.b), poses, answer)
    return Ends(arrived, TRIED, law_words(law, told="random starts"), on_due, pinned)


@cache
def moves_by_resets() -> list[Move]:
    """Return what the printed resets do to the witness points, from every tried start.

    Up to `SWITCHED`: the start's own switches are over by then.
    """
    runs, times = run(), even_times(0.0, SWITCHED, STEP)
    law = printed_tracker(runs.a, runs.b)
    found: list[Move] = []
    for places in tried():
        made = track_along(law, PATH_A, PATH_B, times, state=begin(law, *places))
        found += moves_of(made, (PATH_A, PATH_B), GAIN)
    return found


def sequence(visits: Iterable[Visit]) -> tuple[tuple[str, str], ...]:
    """Return the visited modes in order, as the pictures name them: ("F0", "E2") and so on."""
    return tuple((short(visit.feature_a), short(visit.feature_b)) for visit in visits)


def stays(recording: Recording) -> list[Visit]:
    """Return the visited modes once the wrong start has come to the true features."""
    return [visit for visit in recording.modes() if visit.end > ENTERED]


def entered(recording: Recording) -> list[RecordedEvent]:
    """Return the switches after that."""
    return [event for event in recording.events if event.time > ENTERED]


def features_of(recording: Recording, body: str) -> tuple[str, ...]:
    """Return the features that one body's witness point goes through, in order."""
    names = [pair["AB".index(body)] for pair in sequence(stays(recording))]
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
        """Stretches of frames on one face, once the true features are entered: between them the
        parameters jump."""
        cuts = [0, *(np.flatnonzero(np.diff(self.face)) + 1).tolist(), len(self.face)]
        return [slice(i, k) for i, k in pairwise(cuts) if k > round(ENTERED / STEP)]


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


def _placed(time: float) -> tuple[Pose, Pose, Twist, Twist]:
    return PATH_A.pose(time), PATH_B.pose(time), PATH_A.twist(time), PATH_B.twist(time)
