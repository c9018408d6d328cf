"""What two bodies are like where a direction n supports them, and the inertia of DESIGN's J.

From support points alone: differences of a body's support points with n are its radii of
curvature; where they jump the body is flat along the jump, and where they stay there is an edge
or a vertex. That gives tangents F and curvatures of either feature, hence the symmetric matrix

    J = [ -n.d2f  0     -F'   0 ]
        [  0      n.d2h  G'   0 ]
        [ -F      G     -d I -n ]
        [  0      0     -n'   0 ]

with d = -s(n). Eliminating the features leaves ``s I - (rho_A + rho_B)`` on the tangent plane and
one pair of opposite signs along n, so J has exactly 3 negative eigenvalues at a minimum of s(n), 2
at a saddle and 1 at a maximum (in the plane: 2 and 1).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from standoff_studies.oracles import Placed, unit

from .bounds import pair_size

Array = NDArray[Any]

RING = 1e-5
"""Angle within which support points are compared: sharper than any curvature of the tests."""
SIDE = 1e-6
"""Angle of the differences on one side of a jump."""
JUMP = 1e-3
"""Jump of the support point, over the size, from which a body is flat along it."""
STAYS = 1e-8
"""Radius of curvature, over the size, below which it is that of an edge or a vertex."""
RINGS = 16
NAMES = ("vertex", "edge", "face")


@dataclass(frozen=True)
class Contact:
    """One extremum of s(n) = depth, in world axes.

    ``normal`` from A to B, ``point_a`` and ``point_b`` the deepest points (point_a - point_b =
    depth * normal), ``feature_a`` and ``feature_b`` by curvature ("face", "edge", "vertex"),
    ``negative`` the number of negative eigenvalues of J: 3 at a minimum (2 in the plane),
    ``error`` how far point_a - point_b misses depth * normal: s is stationary where it is 0.
    """

    normal: Array
    depth: float
    point_a: Array
    point_b: Array
    feature_a: str
    feature_b: str
    negative: int
    error: float


@dataclass(frozen=True)
class Side:
    """One body around its support point: points of its support set, and curvature.

    ``flat`` (k, 3) are directions without curvature; ``radii`` (m, t, t) the radii of curvature
    across them in ``across`` (t, 3), one matrix for each of ``points`` (m, 3).
    """

    points: Array
    flat: Array
    across: Array
    radii: Array


def tangents(normal: Array, planar: bool = False) -> tuple[Array, Array]:
    """Return two unit vectors square to ``normal``; in the plane the second is zero."""
    if planar:
        return np.array([-normal[1], normal[0], 0.0]), np.zeros(3)
    axis = np.eye(3)[np.abs(normal).argmin()]
    first = np.cross(normal, axis)
    first /= np.linalg.norm(first)
    return first, np.cross(normal, first)


def _radii(body: Placed, normal: Array, frame: Array, step: float) -> Array:
    ends = body.relative(np.concatenate([normal + step * frame, normal - step * frame]))[1]
    slopes = (ends[: len(frame)] - ends[len(frame) :]) @ frame.T / (2 * step)
    return (slopes + slopes.T) / 2


def side(body: Placed, normal: Array, size: float, planar: bool) -> Side:
    """Return what a body is like where ``normal`` supports it."""
    frame = np.stack(tangents(normal, planar)[: 1 if planar else 2])
    angle = 2 * np.pi * np.arange(RINGS) / RINGS
    turns = np.stack([np.cos(angle), np.sin(angle)], axis=1)[:, : len(frame)]
    ring = body.relative(normal + RING * turns @ frame)[1]
    spread = np.linalg.svd((ring - ring.mean(axis=0)) @ frame.T, full_matrices=False)
    jumps = int(np.count_nonzero(spread[1] > JUMP * size * np.sqrt(RINGS)))
    none = np.zeros((0, 3))
    if jumps == 0:
        point = body.relative(normal)[1]
        return Side(point, none, frame, _radii(body, normal, frame, RING)[None])
    if jumps == len(frame):
        return Side(ring, frame, none, np.zeros((len(ring), 0, 0)))
    ends = [normal + sign * RING * spread[2][0] @ frame for sign in (1.0, -1.0)]
    points = body.relative(np.array(ends))[1]
    flat = points[0] - points[1]
    flat -= (flat @ normal) * normal
    flat /= np.linalg.norm(flat)
    across = np.cross(normal, flat)[None]
    radii = np.stack([_radii(body, end, across, SIDE) for end in ends])
    return Side(points, flat[None], across, radii)


def _shares(first: Side, second: Side, between: Array, size: float) -> tuple[Array, Array, Array]:
    """Return shares of both sides' points that make their difference ``between``; its error."""
    a, b = len(first.points), len(second.points)
    matrix = np.zeros((5, a + b))
    matrix[:3, :a], matrix[:3, a:] = first.points.T / size, -second.points.T / size
    matrix[3, :a] = matrix[4, a:] = 1.0
    shares, _ = nnls(matrix, np.array([*(between / size), 1.0, 1.0]))
    weights_a, weights_b = shares[:a] / shares[:a].sum(), shares[a:] / shares[a:].sum()
    return weights_a, weights_b, weights_a @ first.points - weights_b @ second.points - between


def _tangents_and_curvatures(body: Side, shares: Array, size: float) -> tuple[Array, Array]:
    """Return tangent columns (3, k) and curvatures (k, k) of the feature of a support point."""
    radii = np.tensordot(shares, body.radii, 1)
    values, vectors = np.linalg.eigh(radii) if len(radii) else (np.zeros(0), radii)
    bent = values > STAYS * size
    columns = np.concatenate([body.flat, (vectors.T @ body.across)[bent]])
    curvatures = np.concatenate([np.zeros(len(body.flat)), 1 / values[bent]])
    return columns.T, np.diag(curvatures)


def jacobian(
    first: tuple[Array, Array], second: tuple[Array, Array], normal: Array, distance: float
) -> Array:
    """Return DESIGN's J; each side is its tangents (3, k) and curvatures (k, k), both >= 0."""
    (F, curved_a), (G, curved_b) = first, second
    a, b = F.shape[1], G.shape[1]
    J = np.zeros((a + b + 4, a + b + 4))
    J[:a, :a], J[a : a + b, a : a + b] = curved_a, curved_b
    x = slice(a + b, a + b + 3)
    J[x, :a], J[x, a : a + b] = -F, G
    J[:a, x], J[a : a + b, x] = -F.T, G.T
    J[x, x] = -distance * np.eye(3)
    J[x, -1] = J[-1, x] = -normal
    return J


def contact(a: Placed, b: Placed, normal: Array) -> Contact:
    """Return the extremum of s at a direction where it is known to have one."""
    n = unit(np.asarray(normal, dtype=float)[None])[0]
    planar = a.shape.dimension == b.shape.dimension == 2
    size = pair_size(a, b)
    first, second = side(a, n, size, planar), side(b, -n, size, planar)
    between = b.position - a.position
    depth = float(a.relative(n)[0][0] + b.relative(-n)[0][0] - n @ between)
    weights_a, weights_b, miss = _shares(first, second, depth * n + between, size)
    point_a = weights_a @ first.points + a.position
    point_b = weights_b @ second.points + b.position
    sides = [
        _tangents_and_curvatures(first, weights_a, size),
        _tangents_and_curvatures(second, weights_b, size),
    ]
    scaled = [(columns, size * curvatures) for columns, curvatures in sides]
    J = jacobian(scaled[0], scaled[1], n, -depth / size)
    if planar:
        J = np.delete(np.delete(J, -2, axis=0), -2, axis=1)
    negative = int(np.count_nonzero(np.linalg.eigvalsh(J) < 0))
    names = [("vertex", "edge")[c.shape[1]] if planar else NAMES[c.shape[1]] for c, _ in sides]
    return Contact(n, depth, point_a, point_b, *names, negative, float(np.abs(miss).max()))
