"""Poses of two solids at chosen gaps: nearly touching by faces, edges and vertices, aligned, inside
one another, and anywhere."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from standoff_studies.soak import solid_forms
from standoff_studies.soak.solid_outlines import Array
from standoff_studies.soak.solid_parts import Part
from standoff_studies.soak.solid_search import Sampled
from standoff_studies.soak.solid_truth import signed

Rng = np.random.Generator

GAPS = (1.0, 0.1, 1e-2, 1e-3, 1e-6)
"""Of the mean size."""
NUDGES = (0.0, 0.0, 1e-12, 1e-9, 1e-6, 1e-3)
"""Offsets, of a length of 1, and tilts, radians, of aligned solids."""
SHARES = {"near": 0.55, "aligned": 0.2, "inside": 0.1, "anywhere": 0.15}
SPINS = 10
"""Nearly touching poses that are tried until one has no sampled point inside the other solid."""
STEP = 1e-6
"""Of the size: of differences that give a direction; poses need not be exact."""


class Known(NamedTuple):
    """A part with what is drawn from.

    Attributes
    ----------
    part : Part
    size : float
    sampled : Sampled
    spots, ways : (m, 3) arrays
        Points of the boundary, and directions from each into the space around the solid.
    inner_spots, inner_ways : (k, 3) arrays
        The same into its material.
    """

    part: Part
    size: float
    sampled: Sampled
    spots: Array
    ways: Array
    inner_spots: Array
    inner_ways: Array

    def depth(self, point: Array) -> float:
        """The signed distance of a point, own frame."""
        return float(solid_forms.signed(self.sampled.boundary.form, *(float(x) for x in point)))


def known(part: Part, seed: int = 0) -> Known:
    """A part's cells, and places of its boundary by faces, edges and vertices."""
    rng = np.random.default_rng(seed)
    size = part.boundary.size
    sampled = Sampled(part.truth, size)
    rows = rng.integers(len(sampled.points), size=4000)
    points = sampled.points[rows] + 0.08 * size * rng.normal(size=(4000, 3))
    told = signed(part.truth, points)
    steps = STEP * size * np.eye(3)
    slope = [signed(part.truth, points + s) - signed(part.truth, points - s) for s in steps]
    way = np.stack(slope, axis=1) / (2.0 * STEP * size)
    spots = points - told[:, None] * way
    length = np.linalg.norm(way, axis=1)
    good = (np.abs(signed(part.truth, spots)) < 1e-6 * size) & (np.abs(length - 1.0) < 1e-4)
    out, within = good & (told > 0.0), good & (told < 0.0)
    way /= np.maximum(length, 0.5)[:, None]
    return Known(part, size, sampled, spots[out], way[out], spots[within], -way[within])


def draw_poses(a: Known, b: Known, count: int, rng: Rng) -> tuple[Array, Array]:
    """(n, 4, 4) world poses of both solids."""
    poses_a, poses_b = np.tile(np.eye(4), (2, count, 1, 1))
    for k, way in enumerate(rng.choice(list(SHARES), count, p=list(SHARES.values()))):
        relative = DRAWN[way](a, b, rng)
        if rng.uniform() < 0.7:  # else A stands still: nothing is rounded
            poses_a[k, :3, :3], poses_a[k, :3, 3] = turn(rng), rng.normal(size=3)
        poses_b[k] = poses_a[k] @ relative
    return poses_a, poses_b


def turn(rng: Rng) -> Array:
    """A rotation, any with the same chance."""
    q = rng.normal(size=4)
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def _placed(rotation: Array, shift: Array) -> Array:
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = rotation, shift
    return pose


def _near(a: Known, b: Known, rng: Rng) -> Array:
    """Two places face each other at a gap; seldom it is not looked whether the solids meet."""
    gap = float(rng.choice(GAPS)) * 0.5 * (a.size + b.size)
    tries = 1 if rng.uniform() < 0.1 else SPINS
    into = b.size < 0.5 * a.size and len(a.inner_spots) and rng.uniform() < 0.3
    spots, ways = (a.inner_spots, a.inner_ways) if into else (a.spots, a.ways)
    pose = np.eye(4)
    for _ in range(tries):
        i, j = rng.integers(len(spots)), rng.integers(len(b.spots))
        rotation = _facing(b.ways[j], -ways[i], rng)
        pose = _placed(rotation, spots[i] + gap * ways[i] - rotation @ b.spots[j])
        if not _crossing(a, b, pose):
            break
    return pose


def _facing(way: Array, onto: Array, rng: Rng) -> Array:
    """A rotation of one unit vector onto another, with any spin."""

    def frame(n: Array) -> Array:
        side = np.cross(n, rng.normal(size=3))
        side /= np.linalg.norm(side)
        return np.column_stack([n, side, np.cross(n, side)])

    return np.asarray(frame(onto) @ frame(way).T)


def _crossing(a: Known, b: Known, pose: Array) -> bool:
    """Does the sampled boundary of one of them have points on both sides of the other's?"""
    points = b.sampled.points @ pose[:3, :3].T + pose[:3, 3]
    back = (a.sampled.points - pose[:3, 3]) @ pose[:3, :3]
    for truth, rows in ((a.part.truth, points), (b.part.truth, back)):
        told = signed(truth, rows)
        if told.min() < 0.0 < told.max():
            return True
    return False


def _aligned(a: Known, b: Known, rng: Rng) -> Array:
    """Axes along axes and lengths that are multiples of 0.05, or off by little."""
    rows = rng.permutation(3)
    rotation = np.eye(3)[rows] * rng.choice([-1.0, 1.0], 3)[:, None]
    rotation[0] *= np.linalg.det(rotation)
    if rng.uniform() < 0.5:
        rotation = np.eye(3)
    angle, nudge = rng.choice(NUDGES, 2)
    axis = rng.normal(size=3)
    tilt = _rotation(angle * axis / np.linalg.norm(axis))
    shift = 0.05 * rng.integers(-30, 31, size=3)
    if rng.uniform() < 0.5:
        shift[:2] = 0.0
    return _placed(rotation @ tilt, shift + nudge * rng.normal(size=3))


def _rotation(vector: Array) -> Array:
    angle = float(np.linalg.norm(vector))
    if angle == 0.0:
        return np.eye(3)
    x, y, z = vector / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    versine = 2.0 * np.sin(0.5 * angle) ** 2
    return np.asarray(np.eye(3) + np.sin(angle) * cross + versine * cross @ cross)


def _inside(a: Known, b: Known, rng: Rng) -> Array:
    """A point of B's boundary within A's material."""
    if not len(a.inner_spots):
        return _anywhere(a, b, rng)
    i, j = rng.integers(len(a.inner_spots)), rng.integers(len(b.spots))
    deep = rng.uniform(0.0, 0.15) * a.size
    rotation = turn(rng)
    return _placed(rotation, a.inner_spots[i] + deep * a.inner_ways[i] - rotation @ b.spots[j])


def _anywhere(a: Known, b: Known, rng: Rng) -> Array:
    middle = rng.normal(size=3) * 0.5 * (a.size + b.size)
    return _placed(turn(rng), middle)


DRAWN = {"near": _near, "aligned": _aligned, "inside": _inside, "anywhere": _anywhere}


def relative_poses(poses_a: Array, poses_b: Array) -> tuple[Array, Array]:
    """Rotations (n, 3, 3) and shifts (n, 3) from A's frame into B's."""
    turns = np.swapaxes(poses_b[:, :3, :3], 1, 2)
    away = poses_a[:, :3, 3] - poses_b[:, :3, 3]
    return turns @ poses_a[:, :3, :3], np.einsum("nij,nj->ni", turns, away)


def pairs_of(parts: Sequence[str]) -> list[tuple[str, str]]:
    """All pairs, a solid with itself too; of each the first that is named first."""
    return [(a, b) for k, a in enumerate(parts) for b in parts[k:]]
