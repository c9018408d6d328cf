"""Points as a user gives them, spatial or planar, and their hull."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy

from standoff.bodies.assembly import assemble
from standoff.bodies.finishing import PackedBoundary, finish
from standoff.bodies.hulls.build import hull
from standoff.bodies.hulls.qhull import unit_of
from standoff.bodies.tolerances import NARROWEST
from standoff.bodies.topology import Edge
from standoff.checks.arrays import finite_rows
from standoff.checks.numbers import magnitude, magnitude_or_zero
from standoff.checks.real_numbers import shape_of
from standoff.errors import BodyError
from standoff.geometry.curves import Line
from standoff.typing import Array


def hull_of(points: Any, tolerance: float | None, rounding: float) -> tuple[float, PackedBoundary]:
    """(radius, packed hull) of ``Body.from_points``."""
    shape = shape_of(points)
    planar = shape is not None and len(shape) == 2 and shape[1] == 2
    given = finite_rows(points, "points", 2 if planar else 3)
    radius = magnitude_or_zero(rounding, "rounding")
    tolerance = None if tolerance is None else magnitude(tolerance, "tolerance")
    if planar:
        return radius, _planar(given, radius, tolerance)
    return radius, hull(given, radius, tolerance, "points")


def _planar(points: Array, radius: float, tolerance: float | None) -> PackedBoundary:
    """The loop of lines round points of a plane, (n, 2)."""
    unit = unit_of(points, "points")
    try:
        loop = scipy.spatial.ConvexHull(points / unit).vertices
    except (scipy.spatial.QhullError, ValueError) as error:
        raise BodyError(
            f"The {len(points)} points span no area: give at least three of the plane that are not "
            "in one line, or take so.shapes.segment.",
            "points",
            points,
        ) from error
    corners = np.column_stack([points[loop], np.zeros(len(loop))])
    size = float(np.linalg.norm(np.ptp(corners, axis=0)))
    turned = np.roll(corners, -1, axis=0)
    width = np.abs(np.cross(corners - corners[0], turned - corners)).max() / size
    if width <= NARROWEST * size:
        raise BodyError(
            f"The {len(points)} points are in one line ({width:.3g} wide, {size:.3g} long): take "
            "so.shapes.segment.",
            "points",
            points,
        )
    n = len(corners)
    edges = [Edge(Line(corners[k], corners[(k + 1) % n]), k, (k + 1) % n) for k in range(n)]
    joined = assemble(corners, edges, (), 2, size, tolerance)
    return finish(joined, radius, None)
