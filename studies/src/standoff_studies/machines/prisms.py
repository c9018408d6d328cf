"""Planar solids as spatial ones: extruded along z, with their holes and a round one."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.special import comb

import standoff as so
from standoff.bodies import Edge, Face
from standoff.geometry import (
    ConicArc,
    Curve,
    Cylinder,
    Extrusion,
    FormulaCurve,
    Line,
    NurbsCurve,
    NurbsPcurve,
    Pcurve,
    Plane,
    Surface,
)
from standoff.kernels.body import layout as L
from standoff.solids import Solid

X, Y, Z = np.eye(3)
DEGREE = 9
"""Of the polynomial in the place of a formula: an involute's flank is one to 1e-12 of its size."""

Loop = tuple[tuple[int, int], ...]


class _Side(NamedTuple):
    """A curve of the outline at z = 0, and +1, or -1 where the outline goes against it."""

    curve: Curve
    sense: int


def extruded(outline: so.PlanarSolid, low: float, high: float, bore: float = 0.0) -> Solid:
    """What is over a planar solid from one height to another, with a round hole about the axis z
    unless its radius is 0."""
    sides = [
        _Side(_polynomial(curve), -1 if back else 1)
        for loop in outline.loops
        for curve, back in zip(loop.curves, loop.backward, strict=True)
    ]
    after = _after([len(loop.curves) for loop in outline.loops])
    n = len(sides)
    flat = np.array([c.point(c.first if s > 0 else c.last) for c, s in sides])
    points = np.concatenate([flat + low * Z, flat + high * Z])
    edges: list[Edge] = []
    for level, height in enumerate((low, high)):
        for k, (curve, sense) in enumerate(sides):
            ends = (k, after[k])[::sense]
            moved = curve.transformed(np.eye(3), height * Z)
            edges.append(Edge(moved, n * level + ends[0], n * level + ends[1]))
    edges += [Edge(Line(points[k], points[n + k]), k, n + k) for k in range(n)]
    faces = [_wall(side, (k, after[k], n), low, high) for k, side in enumerate(sides)]
    for level, height in enumerate((low, high)):
        rim = tuple((n * level + k, side.sense) for k, side in enumerate(sides))
        hole = ((3 * n + level, 1),) if bore else ()
        pcurves = (*(_flat(side.curve) for side in sides), *(None for _ in hole))
        faces.append(Face((Plane.through(height * Z, X, Y),), rim + hole, pcurves=pcurves))
    if bore:
        edges += [Edge(ConicArc(height * Z, bore * X, bore * Y)) for height in (low, high)]
        wall = Cylinder(np.diag([bore, bore, 1.0]), np.zeros(3))
        faces.append(Face((wall,), ((3 * n, 1), (3 * n + 1, 1))))
    return Solid.from_brep(points, edges, faces, name=outline.name)


def _after(lengths: list[int]) -> list[int]:
    """Of each side of loops, one after the other, the next one of its loop."""
    found: list[int] = []
    for length in lengths:
        first = len(found)
        found += [first + (k + 1) % length for k in range(length)]
    return found


def _polynomial(curve: Curve) -> Curve:
    """A Bezier curve in the place of a formula, which has no exact trimming curve."""
    if not isinstance(curve, FormulaCurve):
        return curve
    k = np.arange(DEGREE + 1)
    s = 0.5 * (1.0 - np.cos(np.pi * k / DEGREE))
    at = np.array([curve.point(t) for t in curve.first + s * (curve.last - curve.first)])
    basis = comb(DEGREE, k) * s[:, None] ** k * (1.0 - s[:, None]) ** (DEGREE - k)
    points = np.linalg.solve(basis, at)
    points[0], points[-1] = at[0], at[-1]
    return NurbsCurve(points, np.repeat([0.0, 1.0], DEGREE + 1))


def _flat(curve: Curve) -> Pcurve | None:
    """A curve's trimming curve in its own plane; None where its kind tells it."""
    if not isinstance(curve, NurbsCurve):
        return None
    return NurbsPcurve(curve.control_points[:, :2], curve.vector.knots, curve.weights)


def _wall(side: _Side, place: tuple[int, int, int], low: float, high: float) -> Face:
    """The face over a curve of the outline; `place` is its number, the next one's, and of how
    many."""
    curve, sense = side
    k, after, n = place
    loop = (k, sense), (2 * n + after, 1), (n + k, -sense), (2 * n + k, -1)
    if isinstance(curve, Line):
        first = curve.point(curve.first)
        plane = Plane.through(first, curve.point(curve.last) - first, Z)
        return Face((plane,), loop)
    surface: Surface = Extrusion(curve, Z, low, high)
    along = [_straight((1.0, 0.0), (0.0, height)) for height in (low, high)]
    ends = (curve.first, curve.last)[::sense]
    up = [_straight((0.0, high - low), (end, low)) for end in ends]
    return Face((surface,), loop, pcurves=(along[0], up[1], along[1], up[0]))


def _straight(slope: tuple[float, float], start: tuple[float, float]) -> Pcurve:
    """A line in (u, v)."""
    matrix = [[slope[0], 0.0, start[0]], [slope[1], 0.0, start[1]], [0.0, 0.0, 1.0]]
    return Pcurve(L.LINE, np.array(matrix))
