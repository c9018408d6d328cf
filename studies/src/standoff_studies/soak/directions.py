"""The least depth along many directions: a search independent of that of the tracker."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from standoff.typing import Array
from standoff_studies.soak.motions import Frames
from standoff_studies.soak.placing import heights
from standoff_studies.soak.shapes import Made

COUNT = 200
"""Directions of the first round: some 15 degrees apart."""

RINGS = 8
"""Directions around the best one, in each round of refinement."""

LOOKS = 30
"""Frames that are examined to move a body into another."""

HALVINGS = 30
"""Bisections of the distance by which it is moved."""

ROUNDS = 14
"""Rounds; the ring shrinks by SHRINK in each, from FIRST (an angle's tangent) to about 1e-4."""

FIRST, SHRINK = 0.2, 0.58


def spread(count: int) -> Array:
    """Return unit vectors (count, 3) evenly distributed over the sphere: Fibonacci's spiral."""
    k = np.arange(count) + 0.5
    z = 1.0 - 2.0 * k / count
    angle = np.pi * (1.0 + np.sqrt(5.0)) * k
    r = np.sqrt((1.0 - z) * (1.0 + z))
    return np.column_stack([r * np.cos(angle), r * np.sin(angle), z])


SPHERE = spread(COUNT)


def least_depths(a: Made, b: Made, frames: Frames, numbers: NDArray[np.int64]) -> Array:
    """Return the least s(n) found, (k,), at frames `numbers` (k,).

    With a half-space only its own direction is possible.
    """
    poses_a, poses_b = frames.poses_a[numbers], frames.poses_b[numbers]
    own = _own(a, b, poses_a, poses_b)
    if own is not None:
        return depths(a, b, poses_a, poses_b, own[:, None])[:, 0]
    n = np.broadcast_to(SPHERE, (len(numbers), COUNT, 3))
    found = depths(a, b, poses_a, poses_b, n)
    best = n[np.arange(len(n)), found.argmin(axis=1)]
    least = found.min(axis=1)
    angle = 2.0 * np.pi * np.arange(RINGS) / RINGS
    reach = FIRST
    for _ in range(ROUNDS):
        x, y = _tangents(best)
        ring = best[:, None] + reach * (
            np.cos(angle)[:, None] * x[:, None] + np.sin(angle)[:, None] * y[:, None]
        )
        ring /= np.linalg.norm(ring, axis=2)[:, :, None]
        found = depths(a, b, poses_a, poses_b, ring)
        lower = found.min(axis=1) < least
        best = np.where(lower[:, None], ring[np.arange(len(n)), found.argmin(axis=1)], best)
        least = np.minimum(least, found.min(axis=1))
        reach *= SHRINK
    return np.asarray(least)


def depths(a: Made, b: Made, poses_a: Array, poses_b: Array, n: Array) -> Array:
    """Return s(n), (k, m), along directions (k, m, 3) at poses (k, 12)."""
    m = n.shape[1]
    rows = np.ascontiguousarray(n).reshape(-1, 3)
    up = heights(a, np.repeat(poses_a, m, axis=0), rows)[0]
    down = heights(b, np.repeat(poses_b, m, axis=0), -rows)[0]
    return np.asarray((up + down).reshape(-1, m))


def shift_into(a: Made, b: Made, frames: Frames, u: Array, depth: float) -> float:
    """Return how far to move B along the unit vector u, (3,), for a given greatest depth in A.

    It uses LOOKS of the frames and COUNT directions: the true depth is slightly smaller.
    """
    numbers = np.unique(np.linspace(0, len(frames.steps) - 1, LOOKS).astype(np.int64))
    poses_a, poses_b = frames.poses_a[numbers], frames.poses_b[numbers]
    own = _own(a, b, poses_a, poses_b)
    n = np.broadcast_to(SPHERE, (len(numbers), COUNT, 3)) if own is None else own[:, None]
    here, along = depths(a, b, poses_a, poses_b, n), n @ u
    # far enough apart in front of A, and in its middle
    far = float(np.abs(here).max())
    low, high = -far, far
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        deepest = float((here - middle * along).min(axis=1).max())
        low, high = (middle, high) if deepest > depth else (low, middle)
    return high


def _own(a: Made, b: Made, poses_a: Array, poses_b: Array) -> Array | None:
    if not a.body.bounded:
        return poses_a[:, [2, 5, 8]]
    return None if b.body.bounded else np.asarray(-poses_b[:, [2, 5, 8]])


def _tangents(n: Array) -> tuple[Array, Array]:
    """Two unit vectors perpendicular to each n (k, 3)."""
    axis = np.eye(3)[np.abs(n).argmin(axis=1)]
    x = np.cross(n, axis)
    x /= np.linalg.norm(x, axis=1)[:, None]
    return x, np.cross(n, x)
