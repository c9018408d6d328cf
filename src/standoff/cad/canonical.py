"""Splines that are planes, cylinders or cones: recognised, with a proven bound of how far they are.

Many files have nothing but splines. One that is a cylinder is told by samples of its points and
normals. What proves it is a polynomial over each of its Bezier parts: the square of the distance
from the axis, less that of the radius. Its coefficients bound it, and so how far the spline is from
the cylinder; cones and planes alike. Exact lengths, areas and trims then are those of the other.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from standoff.cad.surfaces import Carrier, carrier
from standoff.cad.tolerances import SAME_NORMALS
from standoff.geometry.bernstein import product
from standoff.geometry.curves import FULL_TURN
from standoff.geometry.nurbs import NurbsSurface
from standoff.geometry.tolerances import NET_ROUNDING
from standoff.geometry.validation import Array
from standoff.kernels.entries.queries import surface_jets

# Samples of each part of a spline along u and along v.
SHARES = np.array([0.1, 0.4, 0.7])


class Likeness(NamedTuple):
    """A surface of OpenCASCADE that a spline is, over which of its parameters, and how far at most.

    A spline that turned out to be another kind is as far as inf.
    """

    geometry: Any
    over: tuple[float, float, float, float]
    off: float


class Samples(NamedTuple):
    """Of a spline: points and unit normals, (n, 3) each, and homogeneous coefficients of its
    Bezier parts, (4, m, p + 1, q + 1)."""

    points: Array
    normals: Array
    net: Array


def recognised(on: Carrier, most: float) -> Carrier | None:
    """A spline's carrier as that of the plane, cylinder or cone that it is within `most`, length;
    None if it is none."""
    samples = _samples(on.surface)
    for find in FINDERS:
        found = find(samples)
        if found is not None and found.off + on.moved <= most:
            return replace(carrier(found.geometry, found.over), moved=found.off + on.moved)
    return None


def _samples(surface: Any) -> Samples:
    assert isinstance(surface, NurbsSurface)
    places = []
    for vector in (surface.essential_u, surface.essential_v):
        breaks = np.asarray(vector.breaks, dtype=np.float64)
        places.append((breaks[:-1, None] + SHARES * np.diff(breaks)[:, None]).ravel())
    uv = np.stack(np.meshgrid(*places, indexing="ij"), axis=-1).reshape(-1, 2)
    jets = np.empty((len(uv), 18))
    surface_jets(surface.reals, surface.kind, 0, np.ascontiguousarray(uv), jets)
    normals = np.cross(jets[:, 3:6], jets[:, 6:9])
    size = np.linalg.norm(normals, axis=1, keepdims=True)
    clear = size[:, 0] > 0.0
    blocks = surface.blocks.reshape(-1, *surface.blocks.shape[2:])
    return Samples(jets[clear, :3], normals[clear] / size[clear], np.moveaxis(blocks, -1, 0))


def _greatest(above: Array, below: Array, spare: Array) -> float:
    """A bound of |above / below| of polynomials, by their coefficients, known up to `spare`."""
    if not (below > 0.0).all():
        return np.inf
    return float(((np.abs(above) + NET_ROUNDING * spare) / below).max())


def _square(vector: Array) -> Array:
    """The square of a vector's length, of polynomials (3, ...)."""
    return np.asarray(product(vector, vector).sum(axis=0))


def _beside(samples: Samples, point: Array) -> tuple[Array, Array]:
    """Homogeneous vectors (3, ...) from a point, and the weights."""
    x, w = samples.net[:3], samples.net[3]
    return x - point[:, None, None, None] * w, w


def _frame(point: Array, axis: Array) -> Any:
    from OCP.gp import gp_Ax3, gp_Dir, gp_Pnt

    return gp_Ax3(gp_Pnt(*point.tolist()), gp_Dir(*axis.tolist()))


def _plane(samples: Samples) -> Likeness | None:
    from OCP.Geom import Geom_Plane

    point = samples.points.mean(axis=0)
    normal = np.linalg.svd(samples.points - point)[2][-1]
    if np.abs(np.cross(samples.normals, normal)).max() > SAME_NORMALS:
        return None
    y, w = _beside(samples, point)
    off = np.abs(np.tensordot(normal, y, 1)) + NET_ROUNDING * np.abs(y).max(axis=0)
    return Likeness(Geom_Plane(_frame(point, normal)), (0.0, 0.0, 0.0, 0.0), float((off / w).max()))


def _cylinder(samples: Samples) -> Likeness | None:
    from OCP.Geom import Geom_CylindricalSurface

    _, sizes, ways = np.linalg.svd(samples.normals, full_matrices=False)
    if sizes[2] > SAME_NORMALS * sizes[0] or sizes[1] <= SAME_NORMALS * sizes[0]:
        return None
    across, axis = ways[:2], ways[2]
    flat = samples.points @ across.T
    rows = np.column_stack([2.0 * flat, np.ones(len(flat))])
    found = np.linalg.lstsq(rows, (flat**2).sum(axis=1), rcond=None)[0]
    radius = float(np.sqrt(max(found[2] + found[:2] @ found[:2], 0.0)))
    if radius == 0.0:
        return None
    point = found[:2] @ across + (samples.points @ axis).mean() * axis
    y, w = _beside(samples, point)
    beside, wall = _square(np.tensordot(across, y, 1)), product(w, w)
    off = _greatest(beside - radius**2 * wall, wall, _square(np.abs(y)) + radius**2 * wall)
    geometry = Geom_CylindricalSurface(_frame(point, axis), radius)
    # |r² - R²| is at least R |r - R|
    return Likeness(geometry, (0.0, FULL_TURN, 0.0, 0.0), off / radius)


def _cone(samples: Samples) -> Likeness | None:
    from OCP.Geom import Geom_ConicalSurface

    points, normals = samples.points, samples.normals
    if np.linalg.svd(normals, compute_uv=False)[2] <= SAME_NORMALS:
        return None
    apex = np.linalg.lstsq(normals, (normals * points).sum(axis=1), rcond=None)[0]
    ways = points - apex
    lengths = np.linalg.norm(ways, axis=1)
    if not lengths.min() > 0.0:
        return None
    # all generators lean alike: (w, -1) . (axis, cos) = 0
    rows = np.column_stack([ways / lengths[:, None], -np.ones(len(ways))])
    axis = np.linalg.svd(rows, full_matrices=False)[2][-1]
    size = float(np.linalg.norm(axis[:3]))
    axis = axis * np.sign(axis[3]) / size if size > 0.0 else axis
    if not SAME_NORMALS < axis[3] < 1.0 - SAME_NORMALS**2:
        return None
    way, c = axis[:3], float(axis[3])
    s = float(np.sqrt(1.0 - c**2))
    y, w = _beside(samples, apex)
    along = np.tensordot(way, y, 1)
    least = float((along / w).min())
    if not least > 0.0:
        return None  # its apex is on it, or about there
    high, wall = product(along, along), product(w, w)
    beside = _square(y - way[:, None, None, None] * along)
    # (r c - h s) (r c + h s), of which the first is the distance from the cone
    off = _greatest(c**2 * beside - s**2 * high, wall, 2.0 * _square(np.abs(y)))
    tall = points @ way - apex @ way
    middle = 0.5 * float(tall.min() + tall.max())
    geometry = Geom_ConicalSurface(
        _frame(apex + middle * way, way), float(np.arctan2(s, c)), middle * s / c
    )
    over = (0.0, FULL_TURN, (tall.min() - middle) / c, (tall.max() - middle) / c)
    return Likeness(geometry, over, off / (least * s))


FINDERS: tuple[Callable[[Samples], Likeness | None], ...] = (_plane, _cylinder, _cone)
