"""The surfaces that a ball sweeps along an edge and about a vertex."""

from __future__ import annotations

import numpy as np

from standoff.bodies.shapes.quadrics import SINGLE_CHART_REACH
from standoff.bodies.topology import Edge
from standoff.geometry.curves import ConicArc, Curve, Line
from standoff.geometry.pcurves import Pcurve
from standoff.geometry.quadrics import Cylinder, Sphere, sphere_atlas
from standoff.geometry.surfaces import Surface
from standoff.geometry.torus import Torus
from standoff.kernels.body import layout as L
from standoff.typing import Array

# Points of each side of a spherical polygon that its chart must see.
SEEN = 9


def arc_about(centre: Array, first: Array, last: Array, tangent: Array, r: float) -> ConicArc:
    """The arc of a ball's great circle from one unit normal to another, both perpendicular to a
    unit tangent."""
    along = float(np.sign(np.cross(first, last) @ tangent)) * tangent
    across = np.cross(along, first)
    across = across / np.linalg.norm(across)
    angle = float(np.arctan2(last @ across, last @ first))
    return ConicArc(centre, r * first, r * across, 0.0, angle)


def frame_about(axis: Array) -> Array:
    """(3, 3) columns: a right-handed frame whose third vector is a unit one."""
    x = np.cross(axis, np.eye(3)[int(np.abs(axis).argmin())])
    x = x / np.linalg.norm(x)
    return np.column_stack([x, np.cross(axis, x), axis])


def cylinder_about(line: Line, towards: Array, r: float) -> Cylinder:
    """About a segment, v its parameter; u = 0 towards a direction perpendicular to it."""
    along = line.point(1.0) - line.point(0.0)
    axis = along / np.linalg.norm(along)
    x = towards - (towards @ axis) * axis
    x = x / np.linalg.norm(x)
    linear = np.column_stack([r * x, r * np.cross(axis, x), along])
    return Cylinder(linear, line.point(0.0))


class TorusStrip:
    """The part of a torus about an arc that a ball sweeps, u the arc's parameter.

    Attributes
    ----------
    surface : Torus
    """

    surface: Surface

    def __init__(self, arc: ConicArc, normals: tuple[Array, Array], r: float) -> None:
        a, b, centre = arc.basis().T
        major = float(np.linalg.norm(a))
        x, y = a / major, b / np.linalg.norm(b)
        self._axis = np.cross(x, y)
        self._axes = np.column_stack([x, y, self._axis])
        levels = sorted(self.level(n, arc.first) for n in normals)
        torus = Torus(major, r, arc.first, arc.last, *levels)
        self.surface = torus.transformed(self._axes, centre)

    def level(self, normal: Array, at: float) -> float:
        """v of a unit normal at a parameter of the arc, radians."""
        out = self._axes[:, :2] @ [np.cos(at), np.sin(at)]
        return float(np.arctan2(normal @ self._axis, normal @ out))

    def across(self, arc: Curve, at: float) -> Pcurve:
        """The trimming curve of an arc about the ball's centre at a parameter."""
        centre = arc.basis()[:, 2]
        ends = [self.level(arc.point(t) - centre, at) for t in (arc.first, arc.last)]
        rate = float(np.sign(ends[1] - ends[0]))
        return Pcurve(L.LINE, np.array([[0.0, 0.0, at], [rate, 0.0, ends[0]], [0.0, 0.0, 1.0]]))


def sphere_charts(centre: Array, sides: list[Edge], r: float) -> tuple[Surface, ...]:
    """Of a ball's part within some sides: one chart that sees it, or an atlas."""
    every = [
        edge.curve.point(t)
        for edge in sides
        for t in np.linspace(edge.curve.first, edge.curve.last, SEEN)
    ]
    out = (np.array(every) - centre) / r
    axis = out.sum(axis=0)
    length = float(np.linalg.norm(axis))
    if length > 0.0:
        depth = float((out @ axis).min()) / length
        if depth > 0.0 and (1.0 + SINGLE_CHART_REACH**2) * depth**2 >= 1.0:
            return (Sphere(r * frame_about(axis / length), centre),)
    return sphere_atlas(r * np.eye(3), centre)
