"""Splines that are planes, cylinders, cones, spheres or tori, lines or circles: recognised, with a
proven bound of how far they are.

Many files have nothing but splines. One that is a cylinder is told by samples of its points and
normals. What proves it is a polynomial over each of its Bezier parts: the square of the distance
from the axis, less that of the radius. Its coefficients bound it, and so how far the spline is from
the cylinder; the others alike. Exact lengths, areas and trims then are those of the other.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from standoff.cad.curves import Converted
from standoff.cad.surfaces import Carrier, carrier
from standoff.cad.tolerances import SAME_NORMALS
from standoff.geometry.bernstein import product
from standoff.geometry.curves import FULL_TURN, ConicArc, Curve, Line
from standoff.geometry.nurbs import NurbsSurface
from standoff.geometry.nurbs_curves import NurbsCurve
from standoff.geometry.tolerances import NET_ROUNDING, WHOLE_CONIC
from standoff.geometry.vectors import crosses
from standoff.kernels.entries.queries import surface_jets
from standoff.typing import Array

# Samples of each part of a spline along u and along v.
SHARES = np.array([0.05, 0.4, 0.7, 0.95])
# Points of each part of a spline curve.
CURVE_SAMPLES = 7
# Greatest turn round a torus's tube, radians.
MOST_ROUND = 1.8 * np.pi
UP = np.array([0.0, 0.0, 1.0])


class Likeness(NamedTuple):
    """A surface of OpenCASCADE that a spline is, over which of its parameters, and how far at most.

    A spline that turned out to be another kind is as far as inf; one whose normals point into its
    sphere has the way -1.
    """

    geometry: Any
    over: tuple[float, float, float, float]
    off: float
    way: int = 1


class Samples(NamedTuple):
    """Of a spline: points and unit normals, (n, 3) each, and homogeneous coefficients of its
    Bezier parts, (4, m, p + 1, q + 1)."""

    points: Array
    normals: Array
    net: Array


def recognised(on: Carrier, most: float) -> tuple[Carrier, Likeness] | None:
    """A spline's carrier as that of the plane, cylinder, cone, sphere or torus that it is within
    `most`, length; None if it is none."""
    samples = _samples(on.surface)
    for find in FINDERS:
        found = find(samples)
        if found is not None and found.off + on.moved <= most:
            made = carrier(found.geometry, found.over)
            if made.kind == "torus":
                made = replace(made, inverse=_turned_near(made, 0.5 * sum(found.over[2:])))
            return replace(made, moved=found.off + on.moved), found
    return None


def _turned_near(on: Carrier, middle: float) -> Callable[[Array], Array]:
    """A torus's parameters of points, v within half a turn of the middle of its domain."""
    inverse = on.inverse
    assert inverse is not None

    def turned(points: Array) -> Array:
        uv = inverse(points)
        uv[:, 1] = middle + (uv[:, 1] - middle + np.pi) % FULL_TURN - np.pi
        return uv

    return turned


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
    normal = np.linalg.svd(samples.points - point, full_matrices=False)[2][-1]
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


def _torus(samples: Samples) -> Likeness | None:
    """All its normals meet the axis."""
    from OCP.Geom import Geom_ToroidalSurface

    points, normals = samples.points, samples.normals
    middle = points.mean(axis=0)
    size = float(np.linalg.norm(points - middle, axis=1).max())
    x = (points - middle) / size
    # the moment of a line's points about another vanishes where they meet
    rows = np.column_stack([crosses(x, normals), normals])
    _, sizes, ways = np.linalg.svd(rows, full_matrices=False)
    axis, moment = ways[-1, :3], ways[-1, 3:]
    long = float(np.linalg.norm(axis))
    if sizes[-1] > SAME_NORMALS * sizes[0] or sizes[-2] <= SAME_NORMALS * sizes[0] or long == 0.0:
        return None
    axis, moment = axis / long, moment / long
    foot = middle + size * np.cross(axis, moment)
    height = (points - foot) @ axis
    across = np.linalg.norm(points - foot - height[:, None] * axis, axis=1)
    flat = np.column_stack([across, height])
    (major, rise, rest), *_ = np.linalg.lstsq(
        np.column_stack([2.0 * flat, np.ones(len(flat))]), (flat**2).sum(axis=1), rcond=None
    )
    minor = float(np.sqrt(max(rest + major**2 + rise**2, 0.0)))
    if not 0.0 < minor < major:
        return None
    centre = foot + rise * axis
    y, w = _beside(samples, centre)
    wall = product(w, w)
    square = _square(y)
    beside = _square(y - axis[:, None, None, None] * np.tensordot(axis, y, 1))
    near = float((beside / wall).min())
    if not near > 0.0:
        return None  # it meets the axis, or about there
    # (q - r²) (q - r² + 4 R rho) with q = (rho - R)² + z², of which the first is small
    whole = square + (major**2 - minor**2) * wall
    four = product(whole, whole) - 4.0 * major**2 * product(beside, wall)
    spare = _square(np.abs(y)) + (major**2 + minor**2) * wall
    off = _greatest(four, product(wall, wall), 2.0 * product(spare, spare))
    off = off / (2.0 * major * np.sqrt(near))
    own = np.abs((across - major) ** 2 + (height - rise) ** 2 - minor**2).max()
    if not max(off, own) <= major * np.sqrt(near):
        return None
    angle = np.arctan2(height - rise, across - major)
    angle = angle[0] + (angle - angle[0] + np.pi) % FULL_TURN - np.pi
    if np.ptp(angle) > MOST_ROUND:
        return None  # it would need a seam round its tube
    amid = 0.5 * float(angle.min() + angle.max())
    geometry = Geom_ToroidalSurface(_frame(centre, axis), major, minor)
    return Likeness(geometry, (0.0, FULL_TURN, amid - np.pi, amid + np.pi), off / minor)


def _sphere(samples: Samples) -> Likeness | None:
    """All its normals meet in one point."""
    from OCP.Geom import Geom_SphericalSurface

    points, normals = samples.points, samples.normals
    middle = points.mean(axis=0)
    across = np.eye(3) - normals[:, :, None] * normals[:, None, :]
    feet = (across @ (points - middle)[..., None]).reshape(-1)
    centre, _, rank, _ = np.linalg.lstsq(across.reshape(-1, 3), feet, rcond=SAME_NORMALS)
    if rank < 3:
        return None
    centre = centre + middle
    out = points - centre
    radius = float(np.linalg.norm(out, axis=1).mean())
    ways = np.sign((out * normals).sum(axis=1))
    if radius == 0.0 or np.ptp(ways) > 0.0:
        return None
    y, w = _beside(samples, centre)
    wall = product(w, w)
    off = _greatest(_square(y) - radius**2 * wall, wall, _square(np.abs(y)) + radius**2 * wall)
    geometry = Geom_SphericalSurface(_frame(centre, UP), radius)
    # |r² - R²| is at least R |r - R|
    over = (0.0, FULL_TURN, -0.5 * np.pi, 0.5 * np.pi)
    return Likeness(geometry, over, off / radius, int(ways[0]))


FINDERS: tuple[Callable[[Samples], Likeness | None], ...] = (
    _plane,
    _cylinder,
    _cone,
    _sphere,
    _torus,
)


def recognised_curve(made: Converted, most: float) -> tuple[Converted, float] | None:
    """A spline as the line or the circle's arc that it is within `most`, and how far at most,
    lengths; None if it is neither."""
    curve = made.curve
    if not isinstance(curve, NurbsCurve):
        return None
    h = np.moveaxis(curve.blocks, -1, 0)
    breaks = curve.essential.breaks
    ts = np.unique(np.linspace(breaks[:-1], breaks[1:], CURVE_SAMPLES))
    points = curve.points(ts)
    for found in (_line(points, h), _arc(points, h, curve.closed)):
        if found is not None and found[1] <= most:
            return Converted(found[0], affine=False), found[1]
    return None


def _line(points: Array, h: Array) -> tuple[Curve, float] | None:
    a, b = points[0], points[-1]
    long = float(np.linalg.norm(b - a))
    along = (points - a) @ (b - a)
    if long == 0.0 or not (np.diff(along) > 0.0).all():
        return None
    way = (b - a) / long
    y = h[:3] - a[:, None, None] * h[3]
    off = np.abs(y - way[:, None, None] * np.tensordot(way, y, 1)) + NET_ROUNDING * np.abs(y)
    return Line(a, b), float((np.linalg.norm(off, axis=0) / h[3]).max())


def _arc(points: Array, h: Array, closed: bool) -> tuple[Curve, float] | None:
    middle = points.mean(axis=0)
    frame = np.linalg.svd(points - middle, full_matrices=False)[2]
    flat = (points - middle) @ frame[:2].T
    rows = np.column_stack([2.0 * flat, np.ones(len(flat))])
    found, _, rank, _ = np.linalg.lstsq(rows, (flat**2).sum(axis=1), rcond=None)
    if rank < 3:
        return None
    centre = middle + found[:2] @ frame[:2]
    radius = float(np.sqrt(found[2] + found[:2] @ found[:2]))
    x = points[0] - centre
    x = x - (x @ frame[2]) * frame[2]
    x = x / np.linalg.norm(x)
    z = frame[2]
    y = np.cross(z, x)
    turns = np.unwrap(np.arctan2((points - centre) @ y, (points - centre) @ x))
    if turns[-1] < 0.0:
        y, z, turns = -y, -z, -turns
    whole = abs(turns[-1] - FULL_TURN) <= WHOLE_CONIC * FULL_TURN
    if not (np.diff(turns) > 0.0).all() or whole != closed or (turns[-1] > FULL_TURN and not whole):
        return None
    moved = h[:3] - centre[:, None, None] * h[3]
    above = _curve_product(*([np.tensordot(np.stack([x, y]), moved, 1)] * 2)).sum(axis=0)
    wall = _curve_product(h[3], h[3])
    spare = _curve_product(np.abs(moved), np.abs(moved)).sum(axis=0) + radius**2 * wall
    round_ = _greatest(above - radius**2 * wall, wall, spare) / radius
    flat_off = (np.abs(np.tensordot(z, moved, 1)) + NET_ROUNDING * np.abs(moved).max(axis=0)) / h[3]
    last = FULL_TURN if whole else float(turns[-1])
    off = float(np.hypot(round_, flat_off.max()))
    return ConicArc(centre, radius * x, radius * y, 0.0, last), off


def _curve_product(a: Array, b: Array) -> Array:
    """The product of polynomials of one parameter, (..., m, n) coefficients."""
    return np.asarray(product(a[..., None], b[..., None])[..., 0])
