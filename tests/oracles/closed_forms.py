"""Distances in closed form, by one-variable root finding, or by the few candidates there are.

Arguments are in the body frame of the shape named second, unless two segments or spheres are
given by their points. Every function returns ``(distance, nearest)`` with the nearest point(s).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

from standoff_studies.oracles import Box, Cap, Cone, Cylinder, Ellipsoid, Lens, Placed

from .loops import SAMPLES, Curve, PlanarLoop

Array = NDArray[Any]

ROOT = 4 * np.finfo(float).eps
"""Relative tolerance of root finding: the least that ``brentq`` accepts."""


def _array(value: ArrayLike) -> Array:
    return np.asarray(value, dtype=float)


def _result(point: Array, nearest: Array) -> tuple[float, Array]:
    return float(np.linalg.norm(point - nearest)), nearest


def sphere_sphere(
    centre_a: ArrayLike, radius_a: float, centre_b: ArrayLike, radius_b: float
) -> tuple[float, Array, Array]:
    """Return the signed distance of two balls and their witness points."""
    first, second = _array(centre_a), _array(centre_b)
    apart = float(np.linalg.norm(second - first))
    normal = (second - first) / apart
    return apart - radius_a - radius_b, first + radius_a * normal, second - radius_b * normal


def point_plane(point: ArrayLike, normal: ArrayLike, through: ArrayLike) -> tuple[float, Array]:
    """Return the signed distance of a point to a plane (positive along ``normal``)."""
    p, n = _array(point), _array(normal) / np.linalg.norm(normal)
    height = float(n @ (p - _array(through)))
    return height, p - height * n


def point_segment(point: ArrayLike, start: ArrayLike, end: ArrayLike) -> tuple[float, Array]:
    """Return the distance of a point to the segment ``start``-``end``."""
    p, a, b = _array(point), _array(start), _array(end)
    length = float((b - a) @ (b - a))
    t = np.clip((p - a) @ (b - a) / length, 0, 1) if length > 0 else 0.0
    return _result(p, a + t * (b - a))


def segments(a0: Array, a1: Array, b0: Array, b1: Array) -> tuple[Array, Array, Array]:
    """Return distances (k,) and nearest points (k, 3) twice of k pairs of segments.

    The interior pair of lines where it falls inside both, else the best of the four ends.
    """
    u, v, w = a1 - a0, b1 - b0, a0 - b0
    uu, uv, vv = (u * u).sum(1), (u * v).sum(1), (v * v).sum(1)
    determinant = uu * vv - uv * uv
    safe = np.where(determinant > 0, determinant, 1.0)
    s = (uv * (v * w).sum(1) - vv * (u * w).sum(1)) / safe
    t = (uu * (v * w).sum(1) - uv * (u * w).sum(1)) / safe
    inside = (determinant > 0) & (s >= 0) & (s <= 1) & (t >= 0) & (t <= 1)
    firsts, seconds = [a0 + s[:, None] * u], [b0 + t[:, None] * v]
    for point in (a0, a1):
        along = np.clip(((point - b0) * v).sum(1) / np.where(vv > 0, vv, 1), 0, 1)
        firsts.append(point)
        seconds.append(b0 + along[:, None] * v)
    for point in (b0, b1):
        along = np.clip(((point - a0) * u).sum(1) / np.where(uu > 0, uu, 1), 0, 1)
        firsts.append(a0 + along[:, None] * u)
        seconds.append(point)
    first, second = np.stack(firsts), np.stack(seconds)
    distance = np.linalg.norm(first - second, axis=2)
    distance[0] = np.where(inside, distance[0], np.inf)
    best, rows = distance.argmin(axis=0), np.arange(len(a0))
    return distance[best, rows], first[best, rows], second[best, rows]


def segment_segment(
    a0: ArrayLike, a1: ArrayLike, b0: ArrayLike, b1: ArrayLike
) -> tuple[float, Array, Array]:
    """Return the distance of two segments and the nearest point of each."""
    rows = [_array(value)[None] for value in (a0, a1, b0, b1)]
    distance, first, second = segments(*rows)
    return float(distance[0]), first[0], second[0]


def point_box(point: ArrayLike, box: Box) -> tuple[float, Array]:
    """Return the distance of an outside point to a box, rounding included."""
    p = _array(point)
    core = np.clip(p, -box.half, box.half)
    apart = float(np.linalg.norm(p - core))
    if apart <= box.sweep:
        raise ValueError(f"point {p} is inside the box")
    return apart - box.sweep, core + box.sweep * (p - core) / apart


def point_ellipsoid(point: ArrayLike, ellipsoid: Ellipsoid) -> tuple[float, Array]:
    """Return the distance of an outside point to an ellipsoid.

    The nearest point is ``a^2 p / (t + a^2)`` with t > 0 the root of the secular equation
    ``sum (a p / (t + a^2))^2 = 1``.
    """
    p, axes = _array(point), ellipsoid.axes

    def secular(t: float) -> float:
        return float(((axes * p / (t + axes**2)) ** 2).sum()) - 1.0

    if secular(0.0) <= 0:
        raise ValueError(f"point {p} is inside the ellipsoid of semi-axes {axes}")
    bound = float(np.linalg.norm(axes * p))
    t = float(brentq(secular, 0.0, bound, xtol=1e-300, rtol=ROOT, maxiter=500))
    offset = t * p / (t + axes**2)
    return float(np.linalg.norm(offset)), p - offset


def point_cylinder(point: ArrayLike, cylinder: Cylinder) -> tuple[float, Array]:
    """Return the distance of an outside point to a cylinder."""
    p = _array(point)
    radial = float(np.hypot(p[0], p[1]))
    shrink = min(1.0, cylinder.radius / radial) if radial > 0 else 1.0
    height = np.clip(p[2], -cylinder.length / 2, cylinder.length / 2)
    return _result(p, np.array([p[0] * shrink, p[1] * shrink, height]))


def point_cone(point: ArrayLike, cone: Cone) -> tuple[float, Array]:
    """Return the distance of an outside point to a cone: three sides of its half-section."""
    p = _array(point)
    radial = float(np.hypot(p[0], p[1]))
    flat = np.array([radial, p[2], 0.0])
    apex, foot = np.array([0, cone.height / 2, 0]), np.array([cone.radius, -cone.height / 2, 0])
    slope = cone.radius / cone.height
    if abs(p[2]) <= cone.height / 2 and radial <= slope * (cone.height / 2 - p[2]):
        raise ValueError(f"point {p} is inside the cone")
    axis = np.array([0, -cone.height / 2, 0])
    _, found = min(
        (point_segment(flat, apex, foot), point_segment(flat, axis, foot)), key=lambda r: r[0]
    )
    direction = p[:2] / radial if radial > 0 else np.array([1.0, 0.0])
    return _result(p, np.array([*(found[0] * direction), found[1]]))


def point_cap(point: ArrayLike, cap: Cap) -> tuple[float, Array]:
    """Return the distance of an outside point to a cap: its sphere, its disc or its rim."""
    p = _array(point)
    radial = float(np.hypot(p[0], p[1]))
    length = float(np.linalg.norm(p))
    if p[2] <= cap.offset:
        shrink = min(1.0, cap.rim / radial) if radial > 0 else 1.0
        return _result(p, np.array([p[0] * shrink, p[1] * shrink, cap.offset]))
    if length <= cap.radius:
        raise ValueError(f"point {p} is inside the cap")
    ball = cap.radius * p / length
    if ball[2] >= cap.offset:
        return _result(p, ball)
    return _result(p, np.array([*(cap.rim * p[:2] / radial), cap.offset]))


def point_lens(point: ArrayLike, lens: Lens) -> tuple[float, Array]:
    """Return the distance of an outside point to a lens.

    The projection on an intersection of balls is the nearest of those projections on single
    spheres, on their circles, and of the tips, that lie in all the balls.
    """
    p = _array(point)
    if lens.contains(p[None])[0]:
        raise ValueError(f"point {p} is inside the lens")
    candidates: list[tuple[Array, tuple[int, ...]]] = []
    for index, centre in enumerate(lens.centres):
        arm = p - centre
        candidates.append((centre + lens.radius * arm / np.linalg.norm(arm), (index,)))
    for pair in lens.pairs:
        centre, axis, radius = lens.circle(*pair)
        across = p - centre - ((p - centre) @ axis) * axis
        candidates.append((centre + radius * across / np.linalg.norm(across), pair))
    every = tuple(range(lens.count))
    candidates += [(np.array([0, 0, sign * lens.tip]), every) for sign in (-1, 1)]
    allowed = [found for found, skip in candidates if lens.contains(found[None], skip)[0]]
    return min((_result(p, found) for found in allowed), key=lambda r: r[0])


def body_halfspace(body: Placed, plane: Placed) -> tuple[float, Array, Array]:
    """Return the signed distance of any placed shape to a half-space, and the witnesses."""
    normal = plane.rotation[:, 2]
    lowest = body.relative(-normal)[1][0]
    height = float(normal @ (body.position - plane.position) + normal @ lowest)
    return height, lowest + body.position, lowest + body.position - height * normal


def point_curve(point: ArrayLike, curve: Curve) -> tuple[float, float, Array]:
    """Return distance, parameter and nearest point (2,) of a planar point to a curve."""
    p = _array(point)[:2]

    def slope(t: float) -> float:
        found, velocity, _ = curve.jet(np.array([t]))
        return float((found[0] - p) @ velocity[0])

    grid = np.linspace(*curve.span, 2 * SAMPLES + 1)
    slopes = [slope(t) for t in grid]
    options = [grid[0], grid[-1]]
    for low, high, before, after in zip(grid, grid[1:], slopes, slopes[1:], strict=False):
        if before <= 0 <= after and before < after:
            options.append(brentq(slope, low, high, xtol=1e-16, rtol=ROOT))
    points = curve.jet(np.array(options))[0]
    distance = np.linalg.norm(points - p, axis=1)
    best = int(distance.argmin())
    return float(distance[best]), float(options[best]), points[best]


def point_loop(point: ArrayLike, loop: PlanarLoop) -> tuple[float, int, float, Array]:
    """Return signed distance (negative inside), curve, parameter and nearest point (3,)."""
    p = _array(point)[:2]
    found = [point_curve(p, curve) for curve in loop.curves]
    index = int(np.argmin([row[0] for row in found]))
    distance, parameter, nearest = found[index]
    outline = np.vstack([c.jet(np.linspace(*c.span, SAMPLES + 1))[0][:-1] for c in loop.curves])
    arms = outline - p
    following = np.roll(arms, -1, axis=0)
    cross = arms[:, 0] * following[:, 1] - arms[:, 1] * following[:, 0]
    turns = np.arctan2(cross, (arms * following).sum(axis=1)).sum()
    if distance > 0 and turns > np.pi:
        distance = -distance
    return distance, index, parameter, np.array([*nearest, 0.0])
