"""Simulation D, Figs. 16-18: the lens and a point on a helix, through faces, edges and a vertex."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.automaton import Visit
from standoff.bodies import Body, shapes
from standoff.motion import Fixed, Helix, Path, Pose, Twist
from standoff.recording import RecordedEvent, Recording, track
from standoff.recording.times import even_times
from standoff.recording.track import track_along
from standoff.tracking import Feature, Tracker, TrackerState, distance
from standoff.tracking.laws import PaperLaw
from standoff_studies.paper.bodies import lens_of_patches
from standoff_studies.paper.law_words import law_words
from standoff_studies.paper.many_starts import Ends, is_pinned
from standoff_studies.paper.resets import Move, moves_of

Array = NDArray[np.float64]

RADIUS, OFFSET = 1.0, 0.45
"""Of the lens's balls, and of their centres from its middle [length]."""

STEP = 1e-3
"""Sample time [s]: the paper's 1 kHz."""

DURATION = 5.34
"""Time of 1.7 turns of the helix [s]."""

HELIX = Helix(
    radius=1.6,
    pitch=0.6,
    rate=2.0,
    centre=(-0.29, 0.05, 0.37),
    axis=(15.0, 0.0, 4.0),
    phase=np.radians(100.0),
)
"""The point's path [length, rad/s]: chosen so that the sequence the paper describes occurs."""

REST = Fixed(Pose.identity())
"""The lens stays where it is."""

WRONG_STARTS: tuple[tuple[int, tuple[float, float]], ...] = (
    (0, (0.8, 0.3)),
    (2, (0.5, 0.5)),
)
"""Faces and parameters (u, v) that the printed system is started from, of those that arrive; the
closest point is on face 1 at about (0.2, 0.6). Figs. 16-18 show the run from the first."""

GAIN = 25.0
"""K of the printed system [1/s]: "a very low controller gain"."""

ENTERED = 0.005
"""After these seconds the switches of a wrong start to the true feature are over: the guards see
the point alone, and a frame passes several [s]."""

SETTLED = 1e-4
"""Greatest normalised projection error at which a start is called settled."""

TRIED = (0.1, 0.3, 0.5, 0.7, 0.9)
"""u and v of the starts that are tried, on each of three faces: 75."""

PATIENCE = 1.0
"""Time after which a tried start has arrived, or counts as one that has not [s]: 25 / `GAIN`."""

ARRIVED = 1e-3
"""Greatest error of a start that has arrived [length]."""


class Place(NamedTuple):
    """Where a feature's point lies on one of its faces.

    Attributes
    ----------
    u, v : float
        Parameters of the face; u is nan at a vertex, where a whole side has collapsed.
    """

    u: float
    v: float


@dataclass(frozen=True, eq=False)
class Runs:
    """What the three figures show.

    Attributes
    ----------
    lens, point : Body
    exact : Recording
        With the default law: every frame certified, every switch located within its step.
    paper : tuple of Recording
        With the system as printed at the low `GAIN`, from the `WRONG_STARTS`.
    """

    lens: Body
    point: Body
    exact: Recording
    paper: tuple[Recording, ...]

    @property
    def by(self) -> str:
        """What statements on `paper` were measured with."""
        return law_words(*self.paper, told="wrong start")

    @property
    def own(self) -> str:
        """What statements on `exact` were measured with."""
        return law_words(self.exact)


@cache
def pair() -> tuple[Body, Body]:
    """Return the lens and the point."""
    return lens_of_patches(RADIUS, OFFSET), shapes.point()


@cache
def exact_run() -> Recording:
    """Track the point on its helix with the library's own law."""
    return track(Tracker(*pair(), STEP), REST, HELIX, DURATION)


@cache
def run() -> Runs:
    """Track the point on its helix with the printed system, and with the library's own law."""
    (lens, point), exact = pair(), exact_run()
    times = even_times(0.0, DURATION, STEP)
    law = printed_tracker(lens, point)
    starts = [begin(law, face, parameters) for face, parameters in WRONG_STARTS]
    paper = tuple(track_along(law, REST, HELIX, times, state=start) for start in starts)
    return Runs(lens, point, exact, paper)


def printed_tracker(lens: Body, point: Body) -> Tracker:
    """Return the tracker of the system as printed."""
    return Tracker(lens, point, STEP, law=PaperLaw.as_printed(gain=GAIN))


def begin(
    law: Tracker, face: int, parameters: tuple[float, float], path: Path = HELIX
) -> TrackerState:
    """Return the state at parameters of a face, whatever they are worth."""
    poses = Pose.identity(), path.pose(0.0)
    twists = Twist.zero(), path.twist(0.0)
    places = (("face", face), parameters), (("vertex", 0), ())
    return law.start_from(*poses, *places, *twists, settle=False)


@cache
def arrivals(*, moving: bool = True) -> Ends:
    """Try starts all over the three faces with the printed system, for `PATIENCE`.

    The point goes along its helix, or rests where that begins.
    """
    runs, path = run(), HELIX if moving else Fixed(HELIX.pose(0.0))
    law = printed_tracker(runs.lens, runs.point)
    times = even_times(0.0, PATIENCE, STEP)[1:].tolist()
    motion = [(path.pose(t).translation, path.twist(t).v) for t in times]
    poses = REST.pose(PATIENCE), path.pose(PATIENCE)
    due = distance(runs.lens, runs.point, *poses)
    arrived = placed = pinned = 0
    for place in tried():
        buffer = law.buffer(begin(law, *place, path))
        for x, v in motion:
            buffer.pose_b[9:], buffer.twist_b[:3] = x, v
            law.step_into(buffer)
        answer = buffer.proximity()
        if np.linalg.norm(answer.point_a - due.point_a) < ARRIVED:
            arrived += 1
            continue
        placed += answer.feature_a == due.feature_a
        pinned += is_pinned((runs.lens, runs.point), poses, answer)
    by = law_words(law, told="starts on a grid")
    return Ends(arrived, len(tried()), by, placed, pinned)


def tried() -> list[tuple[int, tuple[float, float]]]:
    """Return the starts that are tried: a face, and (u, v) on it."""
    return [(face, (u, v)) for face in range(run().lens.n_faces) for u in TRIED for v in TRIED]


@cache
def moves_by_resets() -> list[Move]:
    """Return what the printed resets do to the witness points, from every tried start.

    Up to `ENTERED`: by then its switches to the true feature are over.
    """
    runs, times = run(), even_times(0.0, ENTERED, STEP)
    law = printed_tracker(runs.lens, runs.point)
    found: list[Move] = []
    for place in tried():
        made = track_along(law, REST, HELIX, times, state=begin(law, *place))
        found += moves_of(made, (REST, HELIX), GAIN)
    return found


def entered(recording: Recording) -> list[RecordedEvent]:
    """Return the switches after a wrong start has come to the true feature."""
    return [event for event in recording.events if event.time > ENTERED]


def place_on(body: Body, face: int, feature: Feature, parameters: Array) -> Place | None:
    """Return where an answer lies in the parameters of a face; None where it is not on the face.

    Parameters
    ----------
    body : Body
        Of untrimmed patches.
    face : int
    feature : Feature
        Of the answer.
    parameters : ndarray, shape (3,)
        As a recording has them.
    """
    part = body.face_parts[face]
    if feature.kind == "face":
        return Place(*parameters[:2].tolist()) if feature.index == face else None
    if feature.kind == "edge":
        for pcurve, (edge, _) in zip(part.pcurves, part.loop, strict=True):
            if edge == feature.index and pcurve is not None:
                u, v, _ = pcurve.point(float(parameters[0]))
                return Place(float(u), float(v))
        return None
    for apex in part.apexes:
        if apex.vertex == feature.index:
            across = apex.side.startswith("u")
            return Place(apex.level, np.nan) if across else Place(np.nan, apex.level)
    return None


def face_parameters(recording: Recording, face: int) -> Array:
    """Return (u, v) on one face in every frame, (n, 2): nan in frames that are not on it.

    Answers on the face's edges and at its vertices are on it too.
    """
    assert recording.pair is not None, "not opened from a file"
    found = np.full((len(recording), 2), np.nan)
    for k, (feature, parameters) in enumerate(
        zip(recording.feature_a, recording.parameters_a, strict=True)
    ):
        place = place_on(recording.pair[0], face, feature, parameters)
        if place is not None:
            found[k] = place
    return found


def short(feature: Feature) -> str:
    """Return what a feature is called in the pictures: F, E or V and its number."""
    return f"{feature.kind[0].upper()}{feature.index}"


def settling_steps(recording: Recording) -> int:
    """Return the first frame with projection errors below `SETTLED`."""
    return int((recording.residual < SETTLED).argmax())


def furthest_instants(recordings: Iterable[Recording], exact: Recording) -> float:
    """Return how far any switch of some runs is from that of an exact one [s].

    Infinite where the features differ.
    """
    wanted, furthest = [event[2:5] for event in exact.events], 0.0
    for recording in recordings:
        events = entered(recording)
        if [event[2:5] for event in events] != wanted:
            return float("inf")
        pairs = zip(events, exact.events, strict=True)
        furthest = max(furthest, *(abs(one.time - other.time) for one, other in pairs))
    return furthest


def sequence(visits: Iterable[Visit]) -> tuple[str, ...]:
    """Return the visited features of the lens in order."""
    return tuple(str(visit.feature_a) for visit in visits)
