"""Simulation D, Figs. 16-18: the lens and a point on a helix, through faces, edges and a vertex."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies import Body, shapes
from standoff.motion import Fixed, Helix, Pose, Twist
from standoff.paper.bodies import lens_of_patches
from standoff.tracking import Feature, Recording, Tracker, Visit
from standoff.tracking.simulate import track_along
from standoff.tracking.times import even_times

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
    (1, (0.1, 0.9)),
    (2, (0.5, 0.5)),
)
"""Faces and parameters (u, v) that the paper's law is started from; the closest point is on face 1
at about (0.2, 0.6). Figs. 16-18 show the run from the first."""

SETTLED = 1e-6
"""Greatest normalised projection error at which a start is called settled."""


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
        With the paper's law, Heun, K = 1/STEP, from the `WRONG_STARTS`.
    printed : tuple of Recording
        The same with the printed switching: Voronoi tests on the point alone.
    """

    lens: Body
    point: Body
    exact: Recording
    paper: tuple[Recording, ...]
    printed: tuple[Recording, ...]


@cache
def run() -> Runs:
    """Track the point on its helix with both laws."""
    lens, point = lens_of_patches(RADIUS, OFFSET), shapes.point()
    times = even_times(0.0, DURATION, STEP)
    exact = track_along(Tracker(lens, point, STEP), REST, HELIX, times)
    laws = [
        Tracker(lens, point, STEP, law="paper", integrator="heun", switching=switching)
        for switching in ("multipliers", "voronoi")
    ]
    motion = Pose.identity(), HELIX.pose(0.0)
    twists = Twist.zero(), HELIX.twist(0.0)
    runs = []
    for law in laws:
        starts = [
            law.start_from(*motion, ("face", face), parameters, ("vertex", 0), (), *twists)
            for face, parameters in WRONG_STARTS
        ]
        runs.append(tuple(track_along(law, REST, HELIX, times, state=start) for start in starts))
    return Runs(lens, point, exact, *runs)


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
    """Return the first frame from which the projection errors stay below `SETTLED` to a switch.

    The first switch after the start may raise them again: it is the law's own error.
    """
    return int((recording.residual < SETTLED).argmax())


def settled_visits(recording: Recording) -> list[Visit]:
    """Return the stays in modes from the settled frame on."""
    settled = float(recording.time[settling_steps(recording)])
    return [visit for visit in recording.modes() if visit.end > settled]


def furthest_instants(recordings: Iterable[Recording], instants: Array) -> float:
    """Return how far any settled switch of some runs is from its instant in another [s].

    Infinite where their numbers differ.
    """
    found = [settled_switches(recording) for recording in recordings]
    if any(switches.shape != instants.shape for switches in found):
        return float("inf")
    return float(max(np.abs(switches - instants).max() for switches in found))


def settled_switches(recording: Recording) -> Array:
    """Return the switching instants after the start has settled [s]."""
    settled = float(recording.time[settling_steps(recording)])
    return np.array([event.time for event in recording.events if event.time > settled])


def sequence(visits: Iterable[Visit]) -> tuple[str, ...]:
    """Return the visited features of the lens in order."""
    return tuple(str(visit.feature_a) for visit in visits)
