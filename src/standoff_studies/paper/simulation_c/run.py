"""Simulation C's motion, tracked by the library's own law and by the paper's."""

from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.automaton import Visit
from standoff.bodies import Body
from standoff.motion import Carried, ConstantTwist, Fixed, Path, Pose, Spiral, Twist
from standoff.recording import Recording, simulate
from standoff.tracking import Feature, Tracker
from standoff.tracking.laws import PaperLaw
from standoff_studies.paper.bodies import leaf, planar_body

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

SNAPSHOT_STAYS = (0, 1, 3, 4, 5, 9, 11, 12, 15, 18, 21, 25)
"""Stays whose middles are the snapshots of Fig. 14: four of each kind of mode."""
LETTERS = "abcdefghijkl"


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
    recording : Recording
        By the library's own law: certified, switching instants located.
    paper : Recording
        By the paper's law with Heun's method and K h = 1, from the same start.
    stays : tuple of Visit
        The modes of `recording` in order of time.
    snapshots : tuple of Snapshot
    """

    a: Body
    b: Body
    path: Path
    recording: Recording
    paper: Recording
    stays: tuple[Visit, ...]
    snapshots: tuple[Snapshot, ...]

    @property
    def paths(self) -> tuple[Path, Path]:
        """Of A, which rests, and of B."""
        return Fixed(Pose.identity()), self.path


def motion() -> Path:
    """Return B's motion: it spins steadily while its centre follows a spiral."""
    spin = ConstantTwist(Pose.identity(), Twist((0.0, 0.0, 0.0), (0.0, 0.0, SPIN)))
    return Carried(Spiral(RADIUS, GROWTH, RATE, phase=PHASE), spin)


@cache
def run() -> Run:
    """Return the simulation, computed once."""
    a, b, path, home = planar_body(), leaf(), motion(), Pose.identity()
    recording = simulate(Tracker(a, b, FRAME), home, path, DURATION)
    paper = simulate(Tracker(a, b, FRAME, law=PaperLaw(integrator="heun")), home, path, DURATION)
    stays = tuple(recording.modes())
    snapshots = tuple(
        _snapshot(letter, stays[number])
        for letter, number in zip(LETTERS, SNAPSHOT_STAYS, strict=True)
    )
    return Run(a, b, path, recording, paper, stays, snapshots)


def _snapshot(letter: str, stay: Visit) -> Snapshot:
    frame = round(0.5 * (stay.start + stay.end) / FRAME)
    return Snapshot(letter, frame, frame * FRAME, stay.feature_a, stay.feature_b)


def loop_parameter(body: Body, features: NDArray[np.object_], parameters: Array) -> Array:
    """Return where around its loop a body's witness point is, shape (n,).

    The number of the curve plus its parameter in [0, 1]; at vertex i it is i.
    """
    found = np.array([float(feature.index) for feature in features])
    on_curve = np.array([feature.kind == "edge" for feature in features])
    found[on_curve] += parameters[on_curve, 0]
    return np.asarray(np.mod(found, body.n_edges))


def witness_error(simulation: Run) -> Array:
    """Return how far the paper's law's witness points are from the certified ones [length]."""
    first, second = simulation.recording, simulation.paper
    off_a = np.linalg.norm(second.point_a - first.point_a, axis=1)
    off_b = np.linalg.norm(second.point_b - first.point_b, axis=1)
    return np.asarray(np.maximum(off_a, off_b))


def vertex_slip(simulation: Run) -> float:
    """Return how far a witness point is from the vertex that holds it, at most [length]."""
    recording = simulation.recording
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
