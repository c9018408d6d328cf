"""Planar bodies, and brute force over their curves for a point's distance and side."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

import standoff as so
from standoff.geometry import ConicArc, Line

Array = NDArray[np.float64]
SAMPLES = 801


def ellipse() -> so.Body:
    return so.shapes.planar_loop([ConicArc((0, 0), (1.5, 0), (0, 0.7))])


def stadium() -> so.Body:
    """Two segments and two half discs: its joints are smooth, its medial axis a segment."""
    right = ConicArc((1, 0), (0.5, 0), (0, 0.5), -math.pi / 2, math.pi / 2)
    left = ConicArc((-1, 0), (0.5, 0), (0, 0.5), math.pi / 2, 1.5 * math.pi)
    low, high = Line((-1, -0.5), (1, -0.5)), Line((1, 0.5), (-1, 0.5))
    return so.shapes.planar_loop([low, right, high, left])


def clockwise() -> so.Body:
    corners = ((-1, -1), (0, 1), (1, -1))
    sides = [Line(corners[k], corners[(k + 1) % 3]) for k in range(3)]
    return so.shapes.planar_loop(sides)


def to_curve(body: so.Body, edge: int, x: Array) -> tuple[float, float]:
    """Least distance to one curve and its parameter: dense samples, then a bounded search."""
    curve = body.edge_parts[edge].curve
    t = np.linspace(curve.first, curve.last, SAMPLES)

    def far(s: float) -> float:
        return math.dist(curve.point(s)[:2], x[:2])

    k = int(np.argmin([far(float(s)) for s in t]))
    low, high = float(t[max(k - 1, 0)]), float(t[min(k + 1, SAMPLES - 1)])
    found = minimize_scalar(far, bounds=(low, high), method="bounded", options={"xatol": 1e-13})
    ends = [(far(float(s)), float(s)) for s in (low, high)]
    return min([(float(found.fun), float(found.x)), *ends])


def to_boundary(body: so.Body, x: Array) -> float:
    return min(to_curve(body, edge, x)[0] for edge in range(body.n_edges))


def winding(body: so.Body, x: Array) -> bool:
    """Is a point inside? By the angle that the sampled boundary turns about it."""
    total = 0.0
    for part in body.edge_parts:
        t = np.linspace(part.curve.first, part.curve.last, SAMPLES)
        away = np.array([part.curve.point(float(s))[:2] for s in t]) - x[:2]
        total += float(np.diff(np.unwrap(np.arctan2(away[:, 1], away[:, 0]))).sum())
    return abs(total) > math.pi
