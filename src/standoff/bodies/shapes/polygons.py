"""Convex polygons in space: bodies without volume."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import scipy

from standoff.bodies.body import Body
from standoff.bodies.tolerances import NARROWEST, OFF_PLANE, PLANE_ROUNDINGS
from standoff.bodies.topology import Edge, Face
from standoff.checks.arrays import finite
from standoff.checks.numbers import magnitude_or_zero
from standoff.errors import BodyError
from standoff.geometry.curves import Line
from standoff.geometry.quadrics import Plane
from standoff.typing import Array


def polygon(vertices: Any, *, rounding: float = 0.0) -> Body:
    """The convex hull of points in one plane, such as a triangle: flat, without volume.

    Face 0 is the side from which the vertices run counterclockwise, face 1 the other. The rim is
    n faces without width; its edges exist twice, once for each side.

    Raises BodyError: the points are on one line, or not in one plane. Raises ValueError: a wrong
    shape, a number that is not finite or beyond 1e50, a negative rounding.

    Parameters
    ----------
    vertices : (n, 3) array_like
        At least three points of a plane of any orientation, not on one line, length. Those inside
        the hull are dropped. Points off the plane by up to 1e-9 of the extent are moved into it;
        ``body.check().notes`` says so, and how far.
    rounding : float
        Radius of a ball swept over it, length, zero or above: it becomes a plate with round edges.

    Returns
    -------
    Body
    """
    points = finite(vertices, "vertices", (-1, 3))
    radius = magnitude_or_zero(rounding, "rounding")
    given = points
    points, loop, normal = _outline(given)
    corners = points[loop]
    n = len(corners)
    sides = [corners[(k + 1) % n] - corners[k] for k in range(n)]
    curves = [Line(corners[k], corners[(k + 1) % n]) for k in range(n)]
    # edges 0 to n - 1 border the upper side, n to 2 n - 1 the lower one
    edges = [Edge(curve, k, (k + 1) % n) for _ in range(2) for k, curve in enumerate(curves)]
    along = sides[0] / np.linalg.norm(sides[0])
    across = np.cross(normal, along)
    middle = corners.mean(axis=0)
    upper = Face((Plane.through(middle, along, across),), tuple((k, 1) for k in range(n)))
    lower = Face(
        (Plane.through(middle, across, along),), tuple((n + k, -1) for k in reversed(range(n)))
    )
    rim = [Face((_beside(corners[k], sides[k], normal),), ((k, -1), (n + k, 1))) for k in range(n)]
    body = Body.from_brep(corners, edges, [upper, lower, *rim], rounding=radius, name="polygon")
    if points is given:
        return body
    away = np.linalg.norm(points - given, axis=1)
    note = f"{len(given)} vertices off their common plane by up to {away.max():.3g}: moved into it"
    return replace(body, report=replace(body.report, notes=(note, *body.report.notes)))


def _beside(corner: Array, side: Array, normal: Array) -> Plane:
    """The plane through a side that is perpendicular to the polygon."""
    return Plane.through(corner, side / np.linalg.norm(side), normal)


def _outline(points: Array) -> tuple[Array, list[int], Array]:
    """The points moved into their plane, the indices of the extreme ones in order, and the normal
    around which these run counterclockwise."""
    if len(points) < 3:
        raise BodyError(
            f"A polygon of {len(points)} vertices: give at least three, or take so.shapes.segment.",
            "vertices",
            points,
        )
    middle = points.mean(axis=0)
    away = points - middle
    axes = np.linalg.svd(away, full_matrices=False)[2]
    axes[2] = np.cross(axes[0], axes[1])
    length, width, thickness = (float(x) for x in np.ptp(away @ axes.T, axis=0))
    greatest = float(np.abs(points).max())
    eps = float(np.finfo(np.float64).eps)
    if width <= NARROWEST * length + PLANE_ROUNDINGS * eps * greatest:
        raise BodyError(
            f"The {len(points)} vertices of a polygon are on one line ({width:.3g} wide, "
            f"{length:.3g} long): take so.shapes.segment(start=..., end=...).",
            "vertices",
            points,
        )
    rounding = PLANE_ROUNDINGS * eps * greatest
    if thickness > OFF_PLANE * length + rounding:
        raise BodyError(
            f"The {len(points)} vertices of a polygon are not in one plane: {thickness:.3g} thick "
            f"on an extent of {length:.3g}. Use so.shapes.polytope, or triangles.",
            "vertices",
            points,
        )
    if thickness > rounding:
        points = points - np.outer(away @ axes[2], axes[2])
    flat = away @ axes[:2].T / length
    loop = [int(k) for k in scipy.spatial.ConvexHull(flat).vertices]
    normal = axes[2]
    # starting at the first vertex, in the given direction if that goes around once
    loop = loop[(at := loop.index(min(loop))) :] + loop[:at]
    if loop[1] > loop[-1]:
        loop, normal = [loop[0], *reversed(loop[1:])], -normal
    if len(loop) == 3:  # exactly that of their own plane
        normal = np.cross(points[loop[1]] - points[loop[0]], points[loop[2]] - points[loop[0]])
        normal = normal / np.linalg.norm(normal)
    return points, loop, normal
