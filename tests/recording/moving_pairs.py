"""Motions for the tests of recordings, and what every recording must keep."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

import standoff as so
from standoff.motion import ConstantTwist

REST = so.Pose.identity()


def straight(position: ArrayLike, velocity: ArrayLike) -> ConstantTwist:
    """Return a motion without turning."""
    return ConstantTwist(so.Pose(np.eye(3), position), so.Twist(velocity, (0.0, 0.0, 0.0)))


class Tumbling:
    """Turns steadily while its origin swings: a path that is not of the library."""

    def __init__(self, rng: np.random.Generator, centre: ArrayLike) -> None:
        self._centre = np.asarray(centre) + 0.1 * rng.normal(size=3)
        self._swing = 0.3 * rng.normal(size=3)
        self._rates = rng.uniform(0.5, 4.0, 3)
        self._first = rng.normal(size=3)
        self._spin = 2.0 * rng.normal(size=3)

    def pose(self, t: float) -> so.Pose:
        turn = Rotation.from_rotvec(self._spin * t) * Rotation.from_rotvec(self._first)
        origin = self._centre + self._swing * np.sin(self._rates * t)
        return so.Pose(turn.as_matrix(), origin)

    def twist(self, t: float) -> so.Twist:
        return so.Twist(self._swing * self._rates * np.cos(self._rates * t), self._spin)


def random_pairs(count: int) -> list[tuple[so.Body, so.Body, Tumbling, Tumbling]]:
    """Return pairs of sharp and smooth bodies that tumble close by."""
    rng = np.random.default_rng(20261121)
    shapes = so.shapes
    bodies = [
        shapes.box(1.0, 0.8, 0.6),
        shapes.lens(1.0, 0.45),
        shapes.cylinder(0.4, 0.9),
        shapes.polytope(0.4 * rng.normal(size=(12, 3))),
        shapes.cone(0.5, 1.0),
        shapes.capsule(0.2, 0.8),
        shapes.box(0.5, 0.5, 0.5, rounding=0.1),
        # Creased: eight faces, each an atlas of charts.
        shapes.superellipsoid(0.4, 0.4, 0.4, 1.6, 1.2),
    ]
    pairs = []
    for k in range(count):
        a, b = bodies[k % len(bodies)], bodies[int(rng.integers(len(bodies)))]
        pairs.append((a, b, Tumbling(rng, np.zeros(3)), Tumbling(rng, (2.1, 0.1, 0.2))))
    return pairs


def check_chain(recording: so.Recording) -> None:
    """Events follow on one another, in order of time, each within the step of its frame."""
    at = {"A": recording.feature_a[0], "B": recording.feature_b[0]}
    last = -np.inf
    for event in recording.events:
        assert event.source == at[event.body]
        assert event.target != event.source
        at[event.body] = event.target
        assert event.time >= last
        last = event.time
        assert recording.time[event.frame - 1] < event.time <= recording.time[event.frame]
    assert at == {"A": recording.feature_a[-1], "B": recording.feature_b[-1]}


def switch_times(recording: so.Recording) -> np.ndarray:
    """Return the times of the events, all of which must be located."""
    assert all(event.located for event in recording.events)
    return np.array([event.time for event in recording.events])
