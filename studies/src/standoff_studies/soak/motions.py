"""Random smooth motions of two bodies, every frame of them at once, with exact twists.

A path is a moving origin (uniform, plus waves) and two successive rotations; its parameters are
plain numbers, so that a failure's file contains the motion itself, not a random seed for it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.typing import Array

Rng = np.random.Generator

GOLDEN = 0.6180339887498949
"""The fractional parts of its multiples are evenly distributed: uneven steps without a draw."""

AXES = ((2, 1), (0, 2), (1, 0))
"""Where a cross product's matrix has its entries."""


class Frames(NamedTuple):
    """Poses (n, 12: R row-major, p) and twists (n, 6: v, omega) of both bodies, and steps (n,)."""

    poses_a: Array
    poses_b: Array
    twists_a: Array
    twists_b: Array
    steps: Array

    @property
    def motions(self) -> Array:
        """Poses and twists as the kernels read them, one row per frame."""
        return np.hstack(self[:4])

    def part(self, which: slice | NDArray[np.int64]) -> Frames:
        """Return some of the frames."""
        return Frames(*(array[which] for array in self))


@dataclass(frozen=True)
class Turn:
    """A turn about a fixed axis by ``rate t + swing sin(frequency t + phase)``."""

    axis: list[float]
    rate: float = 0.0
    swing: float = 0.0
    frequency: float = 0.0
    phase: float = 0.0

    def at(self, t: Array) -> tuple[Array, Array]:
        """Return angles and rates, (n,)."""
        inner = self.frequency * t + self.phase
        return (
            self.rate * t + self.swing * np.sin(inner),
            self.rate + self.swing * self.frequency * np.cos(inner),
        )


@dataclass(frozen=True)
class Path:
    """A body's path: ``R = turn_1 turn_2 start``, ``p = centre + velocity t + waves``.

    Waves are rows (x, y, z, frequency, phase), lengths and 1/s.
    """

    start: list[list[float]]
    centre: list[float]
    velocity: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])
    turns: list[Turn] = field(default_factory=list)
    waves: list[list[float]] = field(default_factory=list)

    @classmethod
    def of(cls, facts: dict[str, Any]) -> Path:
        """Return the path of a failure's file."""
        turns = [Turn(**turn) for turn in facts["turns"]]
        return cls(**(facts | {"turns": turns}))

    def at(self, t: Array) -> tuple[Array, Array, Array, Array]:
        """Return R (n, 3, 3), p, v and omega (n, 3) at times (n,), world axes."""
        position = t[:, None] * np.array(self.velocity)
        v = np.broadcast_to(np.array(self.velocity), (len(t), 3)).copy()
        for *reach, frequency, phase in self.waves:
            inner = frequency * t + phase
            position += np.sin(inner)[:, None] * np.array(reach)
            v += (frequency * np.cos(inner))[:, None] * np.array(reach)
        rotation = np.broadcast_to(np.array(self.start), (len(t), 3, 3))
        omega = np.zeros((len(t), 3))
        for turn in reversed(self.turns):
            angle, rate = turn.at(t)
            axis = np.array(turn.axis)
            matrix = _about(axis, angle)
            rotation = matrix @ rotation
            omega = np.einsum("kij,kj->ki", matrix, omega) + rate[:, None] * axis
        # added last, so that a shifted path is bit for bit the one drawn there
        return rotation, position + np.array(self.centre), v, omega


def _about(axis: Array, angle: Array) -> Array:
    """Rotations (n, 3, 3) about a unit axis."""
    cross = np.zeros((3, 3))
    for k, (i, j) in enumerate(AXES):
        cross[i, j], cross[j, i] = axis[k], -axis[k]
    half = np.sin(0.5 * angle)
    return np.asarray(
        np.eye(3)
        + np.sin(angle)[:, None, None] * cross
        + (2.0 * half * half)[:, None, None] * (cross @ cross)
    )


@dataclass(frozen=True)
class Motion:
    """Two paths, and how they are given to the tracker.

    Attributes
    ----------
    a, b : Path
    step : float
        Time from frame to frame [s].
    uneven : float
        Fraction by which the steps vary, 0 to 1.
    jumps : list of [frame, seconds]
        From that frame on the paths' clock is ahead by this time: a teleport of which the tracker
        is not told.
    twists : bool
        Are twists given?
    twist_factor, twist_error
        The given ones are the true ones times the factor, plus the error (6: length/s, rad/s).
    """

    a: Path
    b: Path
    step: float
    uneven: float = 0.0
    jumps: list[list[float]] = field(default_factory=list)
    twists: bool = True
    twist_factor: float = 1.0
    twist_error: list[float] = field(default_factory=lambda: [0.0] * 6)

    @classmethod
    def of(cls, facts: dict[str, Any]) -> Motion:
        """Return the motion of a failure's file."""
        return cls(**(facts | {"a": Path.of(facts["a"]), "b": Path.of(facts["b"])}))

    def times(self, frames: int) -> tuple[Array, Array]:
        """Return the paths' times and the steps, (n,)."""
        numbers = np.arange(frames)
        steps = self.step * (1.0 + self.uneven * (np.mod(numbers * GOLDEN, 1.0) - 0.5))
        t = np.cumsum(steps) - steps[0]
        for frame, ahead in self.jumps:
            t[numbers >= frame] += ahead
        return t, steps

    def frames(self, count: int) -> Frames:
        """Return a number of frames."""
        t, steps = self.times(count)
        parts: list[tuple[Array, Array]] = []
        for path in (self.a, self.b):
            rotation, position, v, omega = path.at(t)
            pose = np.concatenate([rotation.reshape(-1, 9), position], axis=1)
            told = self.twist_factor * np.concatenate([v, omega], axis=1)
            parts.append((pose, told + np.array(self.twist_error)))
        (pose_a, twist_a), (pose_b, twist_b) = parts
        return Frames(pose_a, pose_b, twist_a, twist_b, steps)


def stream(seed: int, which: int, number: int) -> Rng:
    """Return one of a seed's streams of random numbers, independent of other draws."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(which, number)))


def random_direction(rng: Rng) -> Array:
    """Return a unit vector, (3,)."""
    n = rng.normal(size=3)
    return np.asarray(n / np.linalg.norm(n))


def random_rotation(rng: Rng) -> Array:
    """Return a rotation matrix, (3, 3); sometimes exactly a permutation of axes."""
    if rng.random() < 0.1:
        signs = np.diag(rng.choice([-1.0, 1.0], 3))
        exact = signs[:, rng.permutation(3)]
        return np.asarray(exact * np.sign(np.linalg.det(exact)))
    q = rng.normal(size=4)
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def draw_path(rng: Rng, size: float, reach: float) -> Path:
    """Draw a path that stays within about `reach` sizes of the origin, with similar rotations.

    Parameters
    ----------
    rng : Generator
    size : float
        Size of the pair [length].
    reach : float
        1 for motions as large as the size; rotations are proportional to it up to 1.
    """
    turns = []
    for _ in range(int(rng.integers(0, 3))):
        swing = min(reach, 1.0) * float(rng.uniform(0.0, 2.0))
        steady = float(np.exp(rng.uniform(np.log(0.1), np.log(5.0)))) if reach >= 1.0 else 0.0
        rate = steady * float(rng.choice([-1.0, 0.0, 1.0]))
        turns.append(
            Turn(random_direction(rng).tolist(), rate, swing, _frequency(rng), _phase(rng))
        )
    waves = []
    for _ in range(int(rng.integers(1, 4))):
        amplitude = random_direction(rng) * size * reach * rng.uniform(0.05, 0.7)
        waves.append([*amplitude.tolist(), _frequency(rng), _phase(rng)])
    return Path(random_rotation(rng).tolist(), [0.0, 0.0, 0.0], turns=turns, waves=waves)


def _frequency(rng: Rng) -> float:
    return float(np.exp(rng.uniform(np.log(0.2), np.log(8.0))))


def _phase(rng: Rng) -> float:
    return float(rng.uniform(0.0, 2.0 * np.pi))
