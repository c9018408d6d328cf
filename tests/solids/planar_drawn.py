"""Planar solids drawn at random, and dense samples of boundaries with a bound of their own."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

import standoff as so
from standoff.geometry import ConicArc, Curve, Line, NurbsCurve, RationalBezier

Array = NDArray[np.float64]


def planar_pose(x: float, y: float, angle: float = 0.0) -> so.Pose:
    c, s = np.cos(angle), np.sin(angle)
    return so.Pose([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]], (x, y, 0.0))


def star(rng: np.random.Generator, n: int, kinds: str = "lab") -> list[Curve]:
    """A star-shaped loop of n curves: lines, arcs of circles through both ends, Bezier curves."""
    angles = (np.arange(n) + rng.uniform(0.0, 0.6, n)) * 2.0 * np.pi / n
    radii = 0.8 + rng.uniform(-1.0, 1.0, n) * min(0.2, 4.0 / n) + wave(rng, angles, n)
    corners = radii[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
    curves: list[Curve] = []
    for k in range(n):
        p, q = corners[k], corners[(k + 1) % n]
        kind = kinds[rng.integers(len(kinds))]
        bulge = rng.uniform(-0.12, 0.12)
        if kind == "l":
            curves.append(Line(p, q))
        elif kind == "a":
            curves.append(bulged(p, q, bulge))
        else:
            side = np.array([p[1] - q[1], q[0] - p[0]])
            inner = [p + u * (q - p) + rng.uniform(-0.08, 0.08) * side for u in (0.33, 0.66)]
            if kind == "b":
                weights = rng.uniform(0.7, 1.4, 4)
                curves.append(RationalBezier([p, *inner, q], weights))
            else:
                points = [[*each, 0.0] for each in (p, *inner, q)]
                knots = [0.0, 0.0, 0.0, 0.5, 1.0, 1.0, 1.0]
                curves.append(NurbsCurve(points, knots))
    return curves


def wave(rng: np.random.Generator, angles: Array, n: int) -> Array:
    """Hollows that many curves make together."""
    if n < 40:
        return np.zeros(n)
    height: Array = rng.uniform(0.0, 0.2) * np.cos(rng.integers(2, 6) * angles)
    return height


def bulged(p: Array, q: Array, bulge: float) -> Curve:
    """The arc from p to q, or back, whose sag is half of bulge |q - p|."""
    chord = q - p
    length = float(np.linalg.norm(chord))
    across = np.array([chord[1], -chord[0]]) / length
    if abs(bulge) < 1e-3:
        return Line(p, q)
    radius = length * (1.0 + bulge**2) / (4.0 * abs(bulge))
    centre = 0.5 * (p + q) - np.sign(bulge) * across * (radius - 0.5 * abs(bulge) * length)
    first, last = (np.arctan2(*(each - centre)[::-1]) for each in ((p, q) if bulge > 0 else (q, p)))
    return ConicArc(
        centre, (radius, 0.0), (0.0, radius), first, first + (last - first) % (2 * np.pi)
    )


def samples(solid: so.PlanarSolid, per_curve: int = 60) -> tuple[Array, float]:
    """Points (n, 2) of a boundary, and how far any boundary point is from one of them at most, by
    the greatest speed that differences show, and a half more."""
    points, reach = [], 0.0
    for curve in solid.edges:
        t = np.linspace(curve.first, curve.last, per_curve + 1)
        at = np.array([curve.point(x)[:2] for x in t])
        steps = np.linalg.norm(np.diff(at, axis=0), axis=1)
        reach = max(reach, 0.75 * float(steps.max()))
        points.append(at)
    return np.concatenate(points), reach


def moved(points: Array, pose: Any) -> Array:
    pose = so.Pose.of(pose)
    image: Array = points @ np.asarray(pose.rotation)[:2, :2].T + np.asarray(pose.translation)[:2]
    return image


def between_samples(one: Array, two: Array) -> float:
    return float(cKDTree(one).query(two)[0].min())


def even_odd(polygon: Array, point: Array) -> bool:
    """Is a point inside a closed polygon (n, 2), by counting crossings?"""
    x, y = point
    ax, ay = polygon.T
    bx, by = np.roll(polygon, -1, axis=0).T
    crosses = (ay > y) != (by > y)
    with np.errstate(divide="ignore", invalid="ignore"):
        at = ax + (y - ay) * (bx - ax) / (by - ay)
    return bool(np.count_nonzero(crosses & (x < at)) % 2)
