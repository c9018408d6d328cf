"""Exact distances and depths of bodies with corners on a lattice, in integers.

Coordinates are multiples of a lattice step: every product below is an integer that fits in int64,
so that a distance is the square root of a quotient of integers, two roundings in total.
"""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

Whole = NDArray[np.int64]

PER_LENGTH = 8
"""Lattice steps in a length of 1: an eighth, as a box's corner is half of a side of quarters."""

FARTHEST = 2**7
"""Greatest coordinate (steps): squares of triple products of differences stay within int64."""


def whole(points: Any) -> Whole:
    """Return lattice coordinates (n, 3) of points.

    Raises
    ------
    ValueError
        A point is not on the lattice, or too far out.
    """
    steps = np.asarray(points, dtype=float).reshape(-1, 3) * PER_LENGTH
    if (steps != np.round(steps)).any() or np.abs(steps).max(initial=0.0) > FARTHEST:
        raise ValueError("a point is not on the lattice, or farther out than its integers hold")
    return steps.astype(np.int64)


def signed_distance(a: Whole, b: Whole, planar: bool) -> float:
    """Return the signed distance between the hulls of two sets of lattice points, as a length.

    In overlap it is negative: minus the least push (in the plane if planar) that separates them.
    """
    apart = _least_square(a, b)
    if apart > 0.0:
        depth = _depth(a, b, planar)
        # flat hulls in one plane, or hulls without an edge in common: nevertheless apart
        return -depth if depth > 0.0 else float(np.sqrt(apart)) / PER_LENGTH
    return min(-_depth(a, b, planar), 0.0)


def _least_square(a: Whole, b: Whole) -> float:
    """The least squared distance (steps squared) of corners, chords and triangles of both.

    These are subsets of the hulls and include all their vertices, edges and faces: if the hulls are
    apart, the least is exact.
    """
    quotients = [_between_points(a, b)]
    for first, second in ((a, b), (b, a)):
        quotients += [_points_to_chords(first, second), _points_to_triangles(first, second)]
    quotients.append(_between_chords(a, b))
    return min(quotients)


def _between_points(a: Whole, b: Whole) -> float:
    gap = a[:, None] - b[None]
    return float((gap * gap).sum(axis=2).min())


def _chords(points: Whole) -> tuple[Whole, Whole]:
    """Starts and vectors (m, 3) of all chords."""
    pairs = np.array(list(combinations(range(len(points)), 2)), dtype=np.int64).reshape(-1, 2)
    return points[pairs[:, 0]], points[pairs[:, 1]] - points[pairs[:, 0]]


def _quotients(above: Whole, below: Whole, where: NDArray[np.bool_]) -> float:
    """The least of exact quotients; inf if there is none."""
    return float((above[where] / below[where]).min(initial=np.inf))


def _points_to_chords(points: Whole, others: Whole) -> float:
    start, along = _chords(others)
    way = points[:, None] - start[None]
    t, square = (way * along).sum(axis=2), (along * along).sum(axis=1)[None]
    across = np.cross(way, np.broadcast_to(along, way.shape))
    return _quotients(
        (across * across).sum(axis=2),
        np.broadcast_to(square, t.shape),
        (square > 0) & (t > 0) & (t < square),
    )


def _between_chords(a: Whole, b: Whole) -> float:
    (p, u), (q, v) = _chords(a), _chords(b)
    p, u = p[:, None], u[:, None]
    q, v = q[None], v[None]
    way = p - q
    uu, uv, vv = (u * u).sum(axis=2), (u * v).sum(axis=2), (v * v).sum(axis=2)
    d, e = (u * way).sum(axis=2), (v * way).sum(axis=2)
    below = uu * vv - uv * uv
    s, t = uv * e - vv * d, uu * e - uv * d
    square_to = np.cross(np.broadcast_to(u, way.shape), np.broadcast_to(v, way.shape))
    height = (square_to * way).sum(axis=2)
    inside = (below > 0) & (s > 0) & (s < below) & (t > 0) & (t < below)
    return _quotients(height * height, below, inside)


def _points_to_triangles(points: Whole, others: Whole) -> float:
    if len(others) < 3:
        return float("inf")
    corners = np.array(list(combinations(range(len(others)), 3)), dtype=np.int64)
    x = [others[corners[:, k]] for k in range(3)]
    normal = np.cross(x[1] - x[0], x[2] - x[0])
    square = (normal * normal).sum(axis=1)
    inside = np.broadcast_to(square > 0, (len(points), len(square))).copy()
    for k in range(3):
        side = np.cross(x[(k + 1) % 3] - x[k], points[:, None] - x[k][None])
        inside &= (side * normal).sum(axis=2) >= 0
    height = ((points[:, None] - x[0][None]) * normal).sum(axis=2)
    return _quotients(height * height, np.broadcast_to(square, height.shape), inside)


def _depth(a: Whole, b: Whole, planar: bool) -> float:
    """The least s(n) (length) over all normals that a face of a - b can have.

    At most 0 if a plane separates them, or if a - b is flat.
    """
    normals = _normals(a, b, planar)
    if not len(normals):
        return 0.0
    up = (a @ normals.T).max(axis=0) - (b @ normals.T).min(axis=0)
    return float((up / np.sqrt((normals * normals).sum(axis=1))).min()) / PER_LENGTH


def _normals(a: Whole, b: Whole, planar: bool) -> Whole:
    """Both vectors perpendicular to two chords."""
    along = np.concatenate([_chords(a)[1], _chords(b)[1]])
    if not len(along):
        return np.zeros((0, 3), dtype=np.int64)
    along = np.unique(along, axis=0)
    if planar:
        square_to = np.column_stack([along[:, 1], -along[:, 0], np.zeros_like(along[:, 0])])
    else:
        i, j = np.triu_indices(len(along), 1)
        square_to = np.cross(along[i], along[j])
    square_to = square_to[(square_to != 0).any(axis=1)]
    if len(square_to):
        square_to //= np.gcd.reduce(square_to, axis=1)[:, None]
        square_to = np.unique(square_to, axis=0)
    return np.concatenate([square_to, -square_to])
