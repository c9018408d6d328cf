"""Simulation C's motion, tracked by the printed system from a wrong start and by the library."""

from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.automaton import Visit
from standoff.bodies import Body
from standoff.motion import Carried, ConstantTwist, Fixed, Path, Pose, Spiral, Twist
from standoff.recording import RecordedEvent, Recording, track
from standoff.recording.times import even_times
from standoff.recording.track import track_along
from standoff.tracking import Feature, Tracker, TrackerState
from standoff.tracking.laws import PaperLaw
from standoff_studies.paper.bodies import leaf, planar_body
from standoff_studies.paper.law_words import law_words
from standoff_studies.paper.many_starts import Arrivals, distances, motion_along

Array = NDArray[np.float64]

DURATION = 12.0
"""Of the motion [s]."""
FRAME = 1e-3
"""From frame to frame [s]: the paper's 1 kHz."""

RADIUS, GROWTH = 3.0, -0.13
"""Of B's centre from A's origin at t = 0 [length], and by the angle turned [length/rad]."""
RATE, PHASE = math.pi / 4.0, math.radians(150.0)
"""Of B's centre around A: one and a half turns [rad/s], and where it begins [rad]."""
SPIN = -1.5
"""Of B about its centre [rad/s], against the turn of the spiral."""

LETTERS = "abcdefghijkl"
"""Of the snapshots of Fig. 14: the middles of as many equal parts of the motion."""

GAIN = 25.0
"""K of the printed system [1/s]: "a very low controller gain"."""

START = ((1, 0.7), (0, 0.2))
"""Curve and parameter of A and of B where the printed system is started, one of those that arrive;
the closest points are on A's C1 at 0.1 and at B's V1."""

CONVERGED = 0.6
"""When the start has converged [s]: exp(-K t) is 3e-7."""

TRIED, ARRIVED = 200, 1e-3
"""Random starts on both bodies, and to which distance [length] they count as arrived, after
`CONVERGED`."""


REST = Fixed(Pose.identity())
"""A stays where it is."""


class Snapshot(NamedTuple):
    """One picture of Fig. 14: its letter, its frame in the recordings, its time [s], its mode."""

    letter: str
    frame: int
    time: float
    feature_a: Feature
    feature_b: Feature


class Run(NamedTuple):
    """The simulation.

    Attributes
    ----------
    a, b : Body
        A is at rest at home.
    path : Path
        B's motion.
    exact : Recording
        By the library's own law: certified, switching instants located.
    paper : Recording
        By the printed system at the low `GAIN`, from `START`. All figures show it.
    stays : tuple of Visit
        The modes of `paper` in order of time.
    snapshots : tuple of Snapshot
    """

    a: Body
    b: Body
    path: Path
    exact: Recording
    paper: Recording
    stays: tuple[Visit, ...]
    snapshots: tuple[Snapshot, ...]

    @property
    def paths(self) -> tuple[Path, Path]:
        """Of A, which rests, and of B."""
        return REST, self.path

    @property
    def by(self) -> str:
        """What statements on `paper` were measured with."""
        return law_words(self.paper, told="wrong start")

    @property
    def own(self) -> str:
        """What statements on `exact` were measured with."""
        return law_words(self.exact)


@cache
def motion() -> Path:
    """Return B's motion: it spins steadily while its centre follows a spiral."""
    spin = ConstantTwist(Pose.identity(), Twist((0.0, 0.0, 0.0), (0.0, 0.0, SPIN)))
    return Carried(Spiral(RADIUS, GROWTH, RATE, phase=PHASE), spin)


@cache
def pair() -> tuple[Body, Body]:
    """Return A and B."""
    return planar_body(), leaf()


@cache
def exact_run() -> Recording:
    """Track the pair with the library's own law."""
    return track(Tracker(*pair(), FRAME), REST, motion(), DURATION)


@cache
def run() -> Run:
    """Return the simulation, computed once."""
    (a, b), path, exact = pair(), motion(), exact_run()
    law = printed_tracker(a, b)
    state, times = begin(law, path, *START), even_times(0.0, DURATION, FRAME)
    paper = track_along(law, REST, path, times, state=state)
    part = DURATION / len(LETTERS)
    snapshots = tuple(
        _snapshot(letter, paper, round((k + 0.5) * part / FRAME))
        for k, letter in enumerate(LETTERS)
    )
    return Run(a, b, path, exact, paper, tuple(paper.modes()), snapshots)


def printed_tracker(a: Body, b: Body) -> Tracker:
    """Return the tracker of the system as printed."""
    return Tracker(a, b, FRAME, law=PaperLaw.as_printed(gain=GAIN))


Place = tuple[int, float]
"""A curve, and its parameter."""


def begin(law: Tracker, path: Path, place_a: Place, place_b: Place) -> TrackerState:
    """Return the state at parameters of two curves, whatever they are worth."""
    of_a, of_b = (("edge", place[0]) for place in (place_a, place_b))
    places = (of_a, place_a[1:]), (of_b, place_b[1:])
    twists = Twist.zero(), path.twist(0.0)
    return law.start_from(Pose.identity(), path.pose(0.0), *places, *twists, settle=False)


@cache
def arrivals() -> Arrivals:
    """Try random starts on both bodies with the printed system."""
    simulation, rng = run(), np.random.default_rng(1)
    law = printed_tracker(simulation.a, simulation.b)
    motion = motion_along(*simulation.paths, even_times(0.0, CONVERGED, FRAME))
    due, found = simulation.exact.distance[len(motion.rows)], 0
    for _ in range(TRIED):
        curves, at = rng.integers(3, size=2).tolist(), rng.uniform(0.02, 0.98, 2).tolist()
        state = begin(law, simulation.path, *zip(curves, at, strict=True))
        found += bool(abs(distances(law, state, motion)[-1] - due) < ARRIVED)
    return Arrivals(found, TRIED, law_words(law, told="random starts"))


def entered(recording: Recording) -> list[RecordedEvent]:
    """Return the switches after the wrong start has converged."""
    return [event for event in recording.events if event.time > CONVERGED]


def furthest_instants(simulation: Run) -> float:
    """Return how far any switch is from that of the library's own law [s], once converged.

    Infinite where the features differ.
    """
    ours, due = entered(simulation.paper), entered(simulation.exact)
    if [event[2:5] for event in ours] != [event[2:5] for event in due]:
        return float("inf")
    return max(abs(one.time - other.time) for one, other in zip(ours, due, strict=True))


def _snapshot(letter: str, recording: Recording, frame: int) -> Snapshot:
    mode = recording.feature_a[frame], recording.feature_b[frame]
    return Snapshot(letter, frame, frame * FRAME, *mode)


def curve_parameters(body: Body, features: NDArray[np.object_], parameters: Array) -> Array:
    """Return each curve's parameter by frame, (n, curves): nan while the point is not on it.

    At a vertex that of the curve into it is 1, that of the curve out of it 0.
    """
    found = np.full((len(features), body.n_edges), np.nan)
    for k, feature in enumerate(features):
        if feature.kind == "edge":
            found[k, feature.index] = parameters[k, 0]
        else:
            found[k, feature.index] = 0.0
            found[k, feature.index - 1] = 1.0
    return found


def witness_error(simulation: Run) -> Array:
    """Return how far the printed system's witness points are from the certified ones [length]."""
    first, second = simulation.exact, simulation.paper
    off_a = np.linalg.norm(second.point_a - first.point_a, axis=1)
    off_b = np.linalg.norm(second.point_b - first.point_b, axis=1)
    return np.asarray(np.maximum(off_a, off_b))


def vertex_slip(simulation: Run) -> float:
    """Return how far a witness point is from the vertex that holds it, at most [length]."""
    recording = simulation.paper
    poses = [simulation.path.pose(time) for time in recording.time.tolist()]
    turns = np.array([pose.rotation for pose in poses])
    shifts = np.array([pose.translation for pose in poses])
    in_b = np.einsum("kji,kj->ki", turns, recording.point_b - shifts)
    slips = [0.0]
    sides = (
        (simulation.a, recording.feature_a, recording.point_a),
        (simulation.b, recording.feature_b, in_b),
    )
    for body, features, points in sides:
        for index, corner in enumerate(np.asarray(body.vertex_points)):
            held = features == Feature("vertex", index)
            slips.append(float(np.abs(points[held] - corner).max(initial=0.0)))
    return max(slips)
