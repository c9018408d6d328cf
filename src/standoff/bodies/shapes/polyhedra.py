"""Bodies with plane faces, sharp or swept by a ball."""

from __future__ import annotations

from typing import Any, overload

import numpy as np
import scipy

from standoff.bodies.body import Body, made_body
from standoff.bodies.hulls.build import (
    facets,
    hull,
    middle_of,
    recentred,
    solid_body,
    thin_error,
)
from standoff.bodies.hulls.outlines import Outlines, begun
from standoff.bodies.hulls.qhull import unit_of
from standoff.bodies.shapes.arguments import by_position, positive_numbers
from standoff.bodies.tolerances import FLATTEST, LEAST_CORE, SAME_VERTEX
from standoff.checks.arrays import finite
from standoff.checks.numbers import magnitude_or_zero
from standoff.errors import BodyError, StandoffError
from standoff.typing import Array

# The corners and outward normals of a box. Its vertices, edges and faces are numbered after them,
# and its digest depends on the signs of the zeros.
CORNERS = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
NORMALS = np.array(
    [
        [-0.0, -0.0, -1.0],
        [0.0, -1.0, 0.0],
        [1.0, -0.0, -0.0],
        [-1.0, -0.0, -0.0],
        [0.0, 1.0, -0.0],
        [-0.0, -0.0, 1.0],
    ]
)
ROUND = [0, 2, 6, 4, 0, 4, 5, 1, 4, 6, 7, 5, 0, 1, 3, 2, 2, 3, 7, 6, 1, 5, 7, 3]
LOOPS = Outlines(np.array(ROUND), np.arange(0, 25, 4), NORMALS)


@overload
def box(x: float, y: float, z: float, /, rounding: float = ...) -> Body: ...


@overload
def box(size: Any, rounding: float = ...) -> Body: ...


def box(*lengths: Any, size: Any = None, rounding: float | None = None) -> Body:
    """A box about the origin, with edges along x, y, z, sharp or rounded.

    It keeps its size when it is rounded: its core, smaller by 2 rounding along each axis, is swept
    by a ball.

    Raises BodyError: a core that is flat, thinner than 5e-15 of its length. Raises TypeError: a
    size that is missing, or given twice. Raises ValueError: a number that is not finite, a length
    that is not positive, a rounding that is negative or leaves no core.

    Parameters
    ----------
    *lengths : float
        The size, number by number, and the rounding: ``box(x, y, z, rounding)``.
    size : (3,) array_like
        Outer lengths along x, y, z, positive.
    rounding : float
        Radius of its edges and corners, length, zero or above and below half of the least length.

    Returns
    -------
    Body
    """
    named = {"size": size, "rounding": rounding}
    given = by_position("box", lengths, {"size": 3, "rounding": 0}, named)
    outer = positive_numbers(given["size"], "size", 3)
    rounding = magnitude_or_zero(given.get("rounding", 0.0), "rounding")
    core = outer - 2.0 * rounding
    if core.min() <= 0.0:
        raise StandoffError(
            f"rounding = {rounding} leaves no core in a box {outer}: give less than half the "
            "least length, or use a capsule or a sphere.",
            "rounding",
            rounding,
        )
    if core.min() < FLATTEST * core.max():
        raise BodyError(
            f"The core {core} of a box is flat: thinner than {FLATTEST} of its length. Make it "
            "thicker, or round it less."
        )
    points = 0.5 * core * CORNERS
    return made_body("box", rounding, solid_body(points, begun(points, LOOPS), rounding))


def polytope(vertices: Any, *, rounding: float = 0.0) -> Body:
    """The convex hull of points.

    With a rounding it grows; ``rounded_polytope`` rounds it within its planes. It is
    ``Body.from_points``, which can also leave out points to have fewer facets.

    Vertices may lie far from the origin, like those of a mesh in map coordinates. The hull is then
    computed relative to their middle, as ``body.check().notes`` says, and answers are as accurate
    as the vertices' own digits.

    Raises BodyError: the points span no volume, are too thin for their extent, or extend over less
    than 1e-50. Raises ValueError: a wrong shape, a number that is not finite or beyond 1e50, a
    negative rounding.

    Parameters
    ----------
    vertices : (n, 3) array_like
        At least four points that are not in one plane, length. Those inside the hull are dropped.
    rounding : float
        Radius of a ball swept over it, length, zero or above: the body grows by it all round.

    Returns
    -------
    Body
    """
    points = finite(vertices, "vertices", (-1, 3))
    radius = magnitude_or_zero(rounding, "rounding")
    return made_body("polytope", radius, hull(points, radius))


def rounded_polytope(vertices: Any, rounding: float) -> Body:
    """The opening of a polytope by a ball: edges, corners and anything narrower become round.

    It is the union of all balls of radius `rounding` inside the convex hull of the points. The
    core, the polytope with all its planes moved inwards by `rounding`, is swept by the ball, so
    that the blends are exact cylinders and spheres. The planes stay where they were.

    Raises BodyError: the points lie in a plane or are too thin for their extent, or `rounding`
    leaves no core. Raises ValueError: a wrong shape, a number that is not finite or beyond 1e50, a
    negative rounding.

    Parameters
    ----------
    vertices : (n, 3) array_like
        At least four points that are not in one plane, length.
    rounding : float
        Radius of the ball, length; 0 for a sharp polytope.

    Returns
    -------
    Body
    """
    points = finite(vertices, "vertices", (-1, 3))
    rounding = magnitude_or_zero(rounding, "rounding")
    if rounding == 0.0:
        return made_body("rounded polytope", 0.0, hull(points, 0.0))
    middle = middle_of(points)
    faces = facets(points - middle)
    try:
        core = middle + _core(points - middle, faces, rounding)
        packed = solid_body(core, facets(core - middle), rounding)
    except scipy.spatial.QhullError as error:
        found = BodyError(f"The core was not found: {_line(error)}")
        raise thin_error(points, "vertices") or found from error
    except BodyError as error:
        thin = thin_error(points, "vertices")
        if thin is None:
            raise
        raise thin from error
    return made_body("rounded polytope", rounding, recentred(packed, points, middle))


def _core(points: Array, faces: Outlines, rounding: float) -> Array:
    """The vertices of a polytope whose planes are moved inwards, (n, 3)."""
    unit = unit_of(points, "vertices")
    tops = np.maximum.reduceat(
        np.einsum("ij,ij->i", points[faces.corners], faces.normals[faces.owners]),
        faces.starts[:-1],
    )
    return unit * _inner_vertices(faces.normals, tops / unit, rounding / unit, unit)


def _inner_vertices(normals: Array, offsets: Array, rounding: float, unit: float) -> Array:
    """The vertices of normals @ x <= offsets - rounding, (n, 3); all lengths in `unit`.

    Raises BodyError: the rounding leaves no core. Raises QhullError: the vertices are lost in
    roundoff.
    """
    # the inscribed ball: the greatest r with normals @ x + r <= offsets
    columns = np.column_stack([normals, np.ones(len(normals))])
    bounds = [(None, None)] * 3 + [(0.0, None)]
    ball = scipy.optimize.linprog([0.0, 0.0, 0.0, -1.0], columns, offsets, bounds=bounds).x
    inscribed = float(ball[3])
    if inscribed <= 0.0:
        raise scipy.spatial.QhullError("no ball fits into the polytope")
    if rounding > inscribed * (1.0 - LEAST_CORE):
        raise BodyError(
            f"rounding = {rounding * unit} leaves no core: the polytope's inscribed ball has "
            f"radius {inscribed * unit:.6g}. Give less.",
            "rounding",
            rounding * unit,
        )
    planes = np.column_stack([normals, rounding - offsets])
    meeting = scipy.spatial.HalfspaceIntersection(planes, ball[:3])
    size = float(np.ptp(meeting.intersections, axis=0).max())
    vertices: list[Array] = []
    for spot, meet in zip(meeting.intersections, meeting.dual_facets, strict=True):
        # Qhull computes in the dual space; solving for the planes that meet gives the last digits
        heights = normals[meet] @ spot - (offsets[meet] - rounding)
        vertex = spot - np.linalg.lstsq(normals[meet], heights, rcond=None)[0]
        if all(np.linalg.norm(vertex - known) > SAME_VERTEX * size for known in vertices):
            vertices.append(vertex)
    return np.array(vertices)


def _line(error: Exception) -> str:
    """The first line of Qhull's message, without the tables that follow."""
    return str(error).strip().splitlines()[0]
