"""Motions of many bodies, by arrays: they drift and turn, pause, and jump; some leave and enter."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from standoff.typing import Array
from standoff_studies.soak.shapes import Made, Shape, made

Ints = NDArray[np.int64]
Rng = np.random.Generator

H = 2e-3
"""Time of a frame, s."""
JUMPS = 0.002
"""Part of the bodies that jump in a frame."""
PAUSES = 0.2
"""Part of the bodies that rest in a frame."""
ALL_PAUSE = 0.02
"""Part of the frames in which all rest."""
ROOM = 1.45
"""Side of the cube that each body has to itself."""
AWAY = 0.1
"""Part of the bodies that are not there, between one change of the cast and the next."""
HORIZONS = 0.05, 0.15, 0.25
"""Of which one is drawn at each change, length."""

SHAPES = (
    Shape("sphere", {"r": 0.4}),
    Shape("capsule", {"r": 0.2, "length": 0.6}),
    Shape("ellipsoid", {"axes": [0.3, 0.5, 0.4]}),
    Shape("box", {"axes": [0.6, 0.5, 0.7]}),
    Shape("rounded box", {"axes": [0.6, 0.5, 0.7], "rounding": 0.1}),
    Shape("cylinder", {"r": 0.3, "length": 0.7}),
    Shape("cone", {"r": 0.4, "height": 0.8}),
    Shape("cap", {"radius": 0.5, "offset": 0.1}),
    Shape("lens", {"radius": 0.5, "offset": 0.2}),
    Shape("superellipsoid", {"axes": [0.4, 0.3, 0.5], "e1": 0.6, "e2": 0.8}),
    Shape("egg", {"radius": 0.3, "length": 1.0, "taper": 0.2}),
    Shape("spindle", {"radius": 0.4, "length": 1.0}),
    Shape("gore", {"radius": 0.3, "height": 0.8, "sides": 5}),
    Shape("sewn ellipsoid", {"axes": [0.4, 0.3, 0.35]}),
)
"""Bodies of about one size: without faces, with flat and curved ones, of NURBS."""


def kinds() -> list[Made]:
    """A body of each shape, and a polytope of 24 facets."""
    rng = np.random.default_rng(4)
    points = rng.normal(size=(14, 3))
    points *= 0.4 / np.linalg.norm(points, axis=1)[:, None]
    return [made(shape) for shape in (*SHAPES, Shape("polytope", {"vertices": points.tolist()}))]


class Drift:
    """Bodies in a cube; a body that is away goes on drifting."""

    def __init__(self, n: int, rng: Rng) -> None:
        self.rng, self.side = rng, ROOM * n ** (1.0 / 3.0)
        self.poses = self._drawn(n)
        self.speed = rng.normal(size=(n, 3))
        self.turn = Rotation.from_rotvec(2.0 * H * rng.normal(size=(n, 3))).as_matrix()

    def _drawn(self, n: int) -> Array:
        poses = np.tile(np.eye(4), (n, 1, 1))
        poses[:, :3, :3] = Rotation.random(n, random_state=self.rng).as_matrix()
        poses[:, :3, 3] = self.rng.uniform(-0.5, 0.5, (n, 3)) * self.side
        return poses

    def step(self) -> Array:
        """Move all but those that pause; some jump."""
        if self.rng.random() < ALL_PAUSE:
            return self.poses
        n = len(self.poses)
        poses = self.poses.copy()
        go = self.rng.random(n) > PAUSES
        poses[go, :3, 3] += H * self.speed[go]
        poses[go, :3, :3] = nearest_rotations(self.turn[go] @ poses[go, :3, :3])
        at = poses[:, :3, 3]
        self.speed = np.where(
            np.abs(at) > self.side / 2, -np.sign(at) * abs(self.speed), self.speed
        )
        jump = np.flatnonzero(self.rng.random(n) < JUMPS)
        poses[jump] = self._drawn(len(jump))
        self.poses = poses
        return poses

    def cast(self) -> Ints:
        """The bodies that are there from now on, in their order."""
        there: Ints = np.flatnonzero(self.rng.random(len(self.poses)) >= AWAY)
        return there


def nearest_rotations(turns: Array) -> Array:
    """One Newton step towards orthonormal matrices: products of many turns drift."""
    found: Array = turns @ (1.5 * np.eye(3) - 0.5 * turns.transpose(0, 2, 1) @ turns)
    return found
