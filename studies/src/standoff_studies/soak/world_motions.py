"""Motions of all bodies of a world: smooth ones, pauses, jumps, and changes of one rounding."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from standoff.typing import Array

Rng = np.random.Generator

FAMILIES = {"smooth": 0.6, "some pause": 0.12, "all pause": 0.08, "jump": 0.1, "rounding": 0.1}
"""What a frame is, and how often."""

ONE_AXIS = 0.3
"""Share of the worlds that move along one axis alone: a mistake in one of three shows."""


class Flight(NamedTuple):
    """Frames of n bodies.

    Attributes
    ----------
    poses : (m, n, 4, 4) array
    twists : (m, n, 6) array or None
        Those that the world is given: not always true.
    steps : (m,) array
        Time since the frame before, s.
    workers : (m,) array of int
    """

    poses: Array
    twists: Array | None
    steps: Array
    workers: NDArray[np.int64]


def drawn_flight(
    rng: Rng, poses: Array, fixed: NDArray[np.bool_], size: float, frames: int, planar: bool
) -> Flight:
    """Frames that begin at some poses; fixed bodies stay there."""
    n = len(poses)
    steps = 10.0 ** rng.uniform(-3.0, -1.0) * np.ones(frames)
    if rng.random() < 0.5:
        steps *= 10.0 ** rng.uniform(-1.0, 0.5, frames)
    middle = poses[:, :3, 3].mean(axis=0)
    side = float(np.abs(poses[:, :3, 3] - middle).max()) + size
    pace = size * 10.0 ** rng.uniform(-1.0, 1.0)
    v, omega = pace * rng.normal(size=(n, 3)), 10.0 ** rng.uniform(-1, 1) * rng.normal(size=(n, 3))
    if rng.random() < ONE_AXIS:
        v *= np.eye(3)[int(rng.integers(3))]
        omega *= rng.choice([0.0, 1.0])
    if planar:
        v[:, 2], omega[:, :2] = 0.0, 0.0
    v[fixed], omega[fixed] = 0.0, 0.0
    moves = ~fixed
    found = np.empty((frames, n, 4, 4))
    found[0] = poses
    for k in range(1, frames):
        now = found[k - 1].copy()
        kind = str(rng.choice(list(FAMILIES), p=list(FAMILIES.values())))
        going = moves & (rng.random(n) < 0.4) if kind == "some pause" else moves
        if kind in ("smooth", "some pause"):
            _go(now, going, steps[k], v, omega)
        elif kind == "jump":
            _jump(rng, now, moves & (rng.random(n) < 0.3), middle, side, planar)
        elif kind == "rounding":
            _round(rng, now, moves, planar)
        out = np.abs(now[:, :3, 3] - middle) > side
        v = np.where(out, -np.sign(now[:, :3, 3] - middle) * np.abs(v), v)
        found[k] = now
    twists = None
    if rng.random() < 0.5:
        given = np.concatenate([v, omega], axis=1)
        twists = np.tile(given * rng.choice([1.0, 1.0, -1.0, 0.0, 10.0]), (frames, 1, 1))
    return Flight(found, twists, steps, rng.integers(1, 3, frames))


def _go(poses: Array, which: NDArray[np.bool_], h: float, v: Array, omega: Array) -> None:
    """Move some bodies on by their velocities, in place."""
    poses[which, :3, 3] += h * v[which]
    if which.any() and omega[which].any():
        turn = Rotation.from_rotvec(h * omega[which]) * Rotation.from_matrix(poses[which, :3, :3])
        poses[which, :3, :3] = turn.as_matrix()


def _jump(
    rng: Rng, poses: Array, which: NDArray[np.bool_], middle: Array, side: float, planar: bool
) -> None:
    """Put some bodies anywhere, or one where another is, or far away."""
    count = int(which.sum())
    away = 1e3 if rng.random() < 0.15 else 1.0
    at = middle + away * side * rng.uniform(-1.0, 1.0, (count, 3))
    if count and rng.random() < 0.3:
        at[0] = poses[int(rng.integers(len(poses))), :3, 3]
    turns = rng.uniform(-np.pi, np.pi, (count, 3)) * (np.array([0, 0, 1]) if planar else 1.0)
    if planar:
        at[:, 2] = 0.0
    if count:
        poses[which, :3, 3] = at
        poses[which, :3, :3] = Rotation.from_rotvec(turns).as_matrix()


def _round(rng: Rng, poses: Array, which: NDArray[np.bool_], planar: bool) -> None:
    """Change numbers by one rounding."""
    rows = 2 if planar else 3
    for columns in (slice(3, 4), slice(0, 3)):
        block = poses[which, :rows, columns]
        towards = rng.choice([-np.inf, np.inf], block.shape)
        changed = np.where(block == 0.0, block, np.nextafter(block, towards))
        if planar and columns != slice(3, 4):
            continue
        poses[which, :rows, columns] = np.where(rng.random(block.shape) < 0.5, changed, block)
