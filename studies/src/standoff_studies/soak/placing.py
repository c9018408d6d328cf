"""Support functions of bodies at world poses."""

from __future__ import annotations

import numpy as np

from standoff.typing import Array
from standoff_studies.oracles import HalfSpace, Region, Swept, dot
from standoff_studies.soak.shapes import Made


def to_body(poses: Array, vectors: Array) -> Array:
    """Transform world vectors (n, 3) to the axes of bodies at poses (n, 12)."""
    x, y, z = vectors.T
    turned = np.empty_like(vectors)
    for k in range(3):
        turned[:, k] = poses[:, k] * x + poses[:, 3 + k] * y + poses[:, 6 + k] * z
    return turned


def to_world(poses: Array, vectors: Array) -> Array:
    """Transform vectors (n, 3) from body axes to world axes."""
    x, y, z = vectors.T
    turned = np.empty_like(vectors)
    for k in range(3):
        turned[:, k] = poses[:, 3 * k] * x + poses[:, 3 * k + 1] * y + poses[:, 3 * k + 2] * z
    return turned


def heights(made: Made, poses: Array, n: Array) -> tuple[Array, Array]:
    """Return support values (n,) and points (n, 3), world, along unit directions (n, 3).

    For a half-space they are those of its plane: the direction must be its normal.
    """
    origin = poses[:, 9:]
    if isinstance(made.support, HalfSpace):
        return dot(n, origin), origin
    local = to_body(poses, n)
    points = made.support.points(local)
    return dot(local, points) + dot(n, origin), to_world(poses, points) + origin


def inside_parts(made: Made) -> tuple[Region, float]:
    """Return a body's core and the radius of the ball that is swept over it."""
    support = made.support
    core, radius = (support.core, support.sweep) if isinstance(support, Swept) else (support, 0.0)
    if not isinstance(core, Region):
        raise TypeError(f"{type(core).__name__} cannot tell how far a point is outside")
    return core, radius


def outside(made: Made, poses: Array, points: Array, n: Array) -> Array:
    """Return how far points (n, 3) lie outside; n (n, 3) are outward normals at them, world.

    A swept body's point is moved back to its core along the normal.
    """
    core, radius = inside_parts(made)
    local = to_body(poses, points - radius * n - poses[:, 9:])
    return core.outside(local)
