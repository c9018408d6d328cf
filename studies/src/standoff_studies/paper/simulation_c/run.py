"""Simulation C's motion, tracked by the printed system from a wrong start and by the library."""

from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies import Body
from standoff.motion import Carried, ConstantTwist, Path, Pose, Spiral, Twist
from standoff.tracking import Feature
from standoff.typing import Array
from standoff_studies.paper.bodies import leaf, planar_body
from standoff_studies.paper.many_starts import Ends
from standoff_studies.paper.pair_simulation import REST, Simulation, ends_of, random_starts

RADIUS, GROWTH = 3.0, -0.13
"""Distance of B's centre from A at t = 0 [length], and its change by angle [length/rad]."""
RATE, PHASE = math.pi / 4.0, math.radians(150.0)
"""Angular velocity of B's centre around A, one and a half turns [rad/s], and its start [rad]."""
SPIN = -1.5
"""Angular velocity of B about its centre [rad/s], opposite to the spiral."""

MOTION: Path = Carried(
    Spiral(RADIUS, GROWTH, RATE, phase=PHASE),
    ConstantTwist(Pose.identity(), Twist((0.0, 0.0, 0.0), (0.0, 0.0, SPIN))),
)
"""B's motion: it spins steadily while its centre follows a spiral."""

SIMULATION = Simulation(
    bodies=lambda: (planar_body(), leaf()),
    paths=(REST, MOTION),
    duration=12.0,
    step=1e-3,  # the paper's 1 kHz
    gain=25.0,  # "a very low controller gain"
    # One that arrives; the closest points are on A's C1 at 0.1 and at B's V1.
    starts=(((("edge", 1), (0.7,)), (("edge", 0), (0.2,))),),
    entered=0.6,  # when the start has converged: exp(-K t) is 3e-7
)

LETTERS = "abcdefghijkl"
"""Letters of the snapshots of Fig. 14, at the middles of as many equal parts of the motion."""

TRIED, ARRIVED = 200, 1e-3
"""Number of random starts on both bodies, and the error [length] below which they count as arrived
when the shown start has converged."""


class Snapshot(NamedTuple):
    """One picture of Fig. 14: its letter, its frame in the recordings, its time [s], its mode."""

    letter: str
    frame: int
    time: float
    feature_a: Feature
    feature_b: Feature


@cache
def snapshots() -> tuple[Snapshot, ...]:
    """Return the snapshots of the printed system's run."""
    paper, part = SIMULATION.paper, SIMULATION.duration / len(LETTERS)
    frames = [round((k + 0.5) * part / SIMULATION.step) for k in range(len(LETTERS))]
    return tuple(
        Snapshot(letter, k, k * SIMULATION.step, paper.feature_a[k], paper.feature_b[k])
        for letter, k in zip(LETTERS, frames, strict=True)
    )


@cache
def arrivals() -> Ends:
    """Try random starts on both bodies with the printed system."""
    return ends_of(
        SIMULATION,
        random_starts("edge", TRIED),
        SIMULATION.entered,
        lambda answer, due: abs(answer.distance - due.distance) < ARRIVED,
        "random starts",
    )


def curve_parameters(body: Body, features: NDArray[np.object_], parameters: Array) -> Array:
    """Return each curve's parameter by frame, (n, curves): nan while the point is not on it.

    At a vertex it is 1 for the curve that ends there, and 0 for the curve that begins there.
    """
    found = np.full((len(features), body.n_edges), np.nan)
    for k, feature in enumerate(features):
        if feature.kind == "edge":
            found[k, feature.index] = parameters[k, 0]
        else:
            found[k, feature.index] = 0.0
            found[k, feature.index - 1] = 1.0
    return found


def vertex_slip(simulation: Simulation) -> float:
    """Return how far a witness point is from the vertex that holds it, at most [length]."""
    recording = simulation.paper
    poses = [simulation.paths[1].pose(time) for time in recording.time.tolist()]
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
