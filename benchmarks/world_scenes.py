"""Scenes of many bodies for `benchmarks.worlds`: spheres and ellipsoids that drift, and boxes in
the manner of Broadmark (Serpa and Rodrigues, Computer Graphics Forum 39(1), 2020).

Broadmark's scenes come from a physics engine. These are made anew without one, so boxes overlap
where they meet: only the pattern of the motion is theirs.

* ``brownian``: boxes in a cube; each is given another velocity once in 25 frames, at random.
* ``free fall``: boxes in a column fall from rest, and stop at heights of their own above a floor.
* ``gravity``: boxes in a cube under a strong gravity that turns once in 400 frames; walls stop
  them, so that they crowd in one corner after another.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]

H = 2e-3
"""Time of a frame, s."""
AXES = ((0.3, 0.5, 0.4), (0.4, 0.4, 0.4), (0.5, 0.3, 0.2))
ROOM = 1.55
"""Side of the cube that each body has to itself."""
DRIFTING = "density", "volume", "floor"
BROADMARK = "brownian", "free fall", "gravity"


class Scene(NamedTuple):
    """Bodies by their half-axes, and their poses in every frame (m, n, 4, 4)."""

    name: str
    boxes: bool
    axes: list[tuple[float, float, float]]
    path: Array
    floor: bool


def scene(name: str, n: int, frames: int) -> Scene:
    """A scene of n bodies."""
    rng = np.random.default_rng(n)
    scale = (100.0 / n) ** (1.0 / 3.0) if name == "volume" else 1.0
    axes = [(scale * a, scale * b, scale * c) for a, b, c in (AXES[k % 3] for k in range(n))]
    side = ROOM * n ** (1.0 / 3.0) * scale
    if name in BROADMARK:
        at = {"brownian": _brownian, "free fall": _free_fall, "gravity": _gravity}[name]
        where = at(rng, n, frames, side)
    else:
        where = _drifting(rng, n, frames, side, scale, name == "floor")
    turn = Rotation.from_rotvec(H * rng.normal(size=(n, 3))).as_matrix()
    path = np.tile(np.eye(4), (frames, n, 1, 1))
    path[0, :, :3, :3] = Rotation.random(n, random_state=rng).as_matrix()
    for k in range(1, frames):
        # what has stopped turns no more
        goes = (where[k] != where[k - 1]).any(axis=1)[:, None, None]
        path[k, :, :3, :3] = np.where(goes, turn @ path[k - 1, :, :3, :3], path[k - 1, :, :3, :3])
    path[..., :3, 3] = where
    return Scene(name, name in BROADMARK, axes, path, name in ("floor", "free fall"))


def _drifting(
    rng: np.random.Generator, n: int, frames: int, side: float, scale: float, floor: bool
) -> Array:
    at = rng.uniform(-side / 2.0, side / 2.0, (n, 3))
    speed = scale * rng.normal(size=(n, 3))
    if floor:
        at[:, 2] = rng.uniform(0.45, 0.65, n)
        at[:, :2] = rng.uniform(-0.6, 0.6, (n, 2)) * n**0.5
        speed[:, 2] = 0.0
    return np.asarray(at + H * np.arange(1, frames + 1)[:, None, None] * speed)


def _brownian(rng: np.random.Generator, n: int, frames: int, side: float) -> Array:
    where = np.empty((frames, n, 3))
    where[0] = rng.uniform(-side / 2.0, side / 2.0, (n, 3))
    speed = rng.normal(size=(n, 3))
    for k in range(1, frames):
        anew = rng.random(n) < 1.0 / 25.0
        speed[anew] = rng.normal(size=(int(anew.sum()), 3))
        back = np.abs(where[k - 1]) > side / 2.0
        speed = np.where(back, -np.sign(where[k - 1]) * np.abs(speed), speed)
        where[k] = where[k - 1] + H * speed
    return where


def _free_fall(rng: np.random.Generator, n: int, frames: int, side: float) -> Array:
    at = rng.uniform(-side / 2.0, side / 2.0, (n, 3))
    layer = rng.integers(0, 4, n)
    rest = 0.45 + 0.7 * layer
    # most have landed by the last frame
    height = rng.uniform(0.0, 0.5 * 9.81 * (1.3 * H * frames) ** 2, n)
    fallen = 0.5 * 9.81 * (H * np.arange(frames)[:, None]) ** 2
    where = np.broadcast_to(at, (frames, n, 3)).copy()
    where[..., 2] = rest + np.maximum(height - fallen, 0.0)
    return where


def _gravity(rng: np.random.Generator, n: int, frames: int, side: float) -> Array:
    where = np.empty((frames, n, 3))
    where[0] = rng.uniform(-side / 2.0, side / 2.0, (n, 3))
    speed = np.zeros((n, 3))
    for k in range(1, frames):
        angle = 2.0 * np.pi * k / 400.0
        pull = 50.0 * np.array([np.cos(angle), np.sin(angle), -0.3])
        speed += H * pull
        now = where[k - 1] + H * speed
        speed[np.abs(now) > side / 2.0] = 0.0
        where[k] = np.clip(now, -side / 2.0, side / 2.0)
    return where


def boxes_of(given: Scene, frame: int) -> tuple[Array, Array]:
    """Low and high corners (n, 3) of the boxes around the bodies, axes of the world."""
    poses, half = given.path[frame], np.array(given.axes)
    turns = poses[:, :3, :3]
    if given.boxes:
        reach = np.einsum("nij,nj->ni", np.abs(turns), half)
    else:
        reach = np.sqrt(np.einsum("nij,nj->ni", turns**2, half**2))
    low, high = poses[:, :3, 3] - reach, poses[:, :3, 3] + reach
    if given.floor:
        low = np.concatenate([low, [[-1000.0, -1000.0, -0.2]]])
        high = np.concatenate([high, [[1000.0, 1000.0, 0.0]]])
    return low, high
