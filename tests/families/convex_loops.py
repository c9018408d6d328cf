"""Random convex loops of lines, Bezier and NURBS curves, with corners and smooth joints."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial import ConvexHull

import standoff as so
from standoff.geometry import Curve, Line, NurbsCurve, RationalBezier

SMOOTH_SHARE = 0.3
"""Part of the vertices where both curves have one tangent."""
LEAST_SINE = 1e-2
"""Two end tangents more parallel than this are joined by a line, or by nothing."""


def random_loop(seed: int) -> so.Body | None:
    """Return a loop round a random polygon's vertices; None where its tangents cannot be joined.

    A curve keeps within the triangle of its chord and its end tangents, and each vertex's tangents
    within the polygon's outer angle, so that the loop is convex.
    """
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(rng.integers(6, 11), 2)) * np.exp(rng.normal(size=2) * 0.4)
    points = points[ConvexHull(points).vertices]
    sides = np.roll(points, -1, axis=0) - points
    after = np.arctan2(sides[:, 1], sides[:, 0])
    before = np.roll(after, 1)
    turn = (after - before) % (2.0 * np.pi)
    share = rng.uniform(0.1, 0.9, len(points))
    smooth = rng.random(len(points)) < SMOOTH_SHARE
    arrive = before + turn * share * np.where(smooth, 1.0, rng.random(len(points)))
    leave = np.where(smooth, arrive, before + turn * (1.0 - (1.0 - share) * rng.random(len(turn))))
    curves: list[Curve] = []
    for i, (p, q) in enumerate(zip(points, np.roll(points, -1, axis=0), strict=True)):
        k = (i + 1) % len(points)
        tangents = np.column_stack(
            [[np.cos(angle), np.sin(angle)] for angle in (leave[i], arrive[k])]
        )
        straight = not (smooth[i] or smooth[k])
        if straight and (rng.random() < 0.25 or abs(np.linalg.det(tangents)) < LEAST_SINE):
            curves.append(Line(p, q))
            continue
        if abs(np.linalg.det(tangents)) < LEAST_SINE:
            return None
        along = np.linalg.solve(tangents, q - p)
        if along.min() <= 0.0:
            return None
        curves.append(_bulge(rng, p, p + along[0] * tangents[:, 0], q))
    try:
        return so.shapes.planar_loop(curves)
    except so.BodyError:  # a rational cubic may be hollow all the same
        return None


def _bulge(rng: np.random.Generator, p: Any, apex: Any, q: Any) -> Curve:
    kind = rng.integers(0, 3)
    if kind == 0:
        return RationalBezier([p, apex, q], [1.0, np.exp(0.5 * rng.normal()), 1.0])
    a, b = rng.uniform(0.3, 0.9, 2)
    control = [p, p + a * (apex - p), q + b * (apex - q), q]
    weights = np.exp(rng.normal(size=4) * 0.15)
    if kind == 1:
        return RationalBezier(control, weights)
    return NurbsCurve(control, [0.0, 0.0, 0.0, 0.5, 1.0, 1.0, 1.0], weights)
