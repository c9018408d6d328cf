"""Bodies with plane faces, sharp or swept by a ball."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, overload

import numpy as np
import scipy

from standoff.bodies.body import Body
from standoff.bodies.shapes.arguments import by_position, positive_numbers
from standoff.bodies.tolerances import (
    COPLANAR_FACETS,
    FAR_OFF,
    FLATTEST,
    LEAST_CORE,
    SAME_VERTEX,
    THIN,
)
from standoff.bodies.topology import Edge, Face
from standoff.checks.arrays import finite
from standoff.checks.numbers import LEAST, magnitude_or_zero
from standoff.errors import BodyError, StandoffError
from standoff.geometry.curves import Line
from standoff.geometry.quadrics import Plane
from standoff.geometry.validation import Array

# A face's vertices, counterclockwise seen from outside, and its outward normal.
Loop = tuple[list[int], Array]

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


@overload
def box(x: float, y: float, z: float, /, rounding: float = ...) -> Body: ...


@overload
def box(size: Any, rounding: float = ...) -> Body: ...


def box(*lengths: Any, size: Any = None, rounding: float | None = None) -> Body:
    """A box about the origin, with edges along x, y, z, sharp or rounded.

    It keeps its size when it is rounded: its core, smaller by 2 rounding along each axis, is swept
    by a ball.

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

    Raises
    ------
    BodyError
        A core that is flat, thinner than 5e-15 of its length.
    TypeError
        A size that is missing, or given twice.
    ValueError
        A number that is not finite, a length that is not positive, a rounding that is negative or
        leaves no core.
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
    planes = [(n, {int(k) for k in np.flatnonzero(CORNERS @ n > 0.0)}) for n in NORMALS]
    return _solid(points, _loops(points, planes), rounding, "box")


def polytope(vertices: Any, *, rounding: float = 0.0) -> Body:
    """The convex hull of points.

    With a rounding it grows; ``rounded_polytope`` rounds it within its planes.

    Vertices may lie far from the origin, like those of a mesh in map coordinates. The hull is then
    computed relative to their middle, as ``body.check().notes`` says, and answers are as accurate
    as the vertices' own digits.

    Parameters
    ----------
    vertices : (n, 3) array_like
        At least four points that are not in one plane, length. Those inside the hull are dropped.
    rounding : float
        Radius of a ball swept over it, length, zero or above: the body grows by it all round.

    Returns
    -------
    Body

    Raises
    ------
    BodyError
        The points span no volume, are too thin for their extent, or extend over less than 1e-50.
    ValueError
        A wrong shape, a number that is not finite or beyond 1e50, a negative rounding.
    """
    points = finite(vertices, "vertices", (-1, 3))
    radius = magnitude_or_zero(rounding, "rounding")
    return _polyhedron(points, points, _middle(points), radius, "polytope")


def rounded_polytope(vertices: Any, rounding: float) -> Body:
    """The opening of a polytope by a ball: edges, corners and anything narrower become round.

    It is the union of all balls of radius `rounding` inside the convex hull of the points. The
    core, the polytope with all its planes moved inwards by `rounding`, is swept by the ball, so
    that the blends are exact cylinders and spheres. The planes stay where they were.

    Parameters
    ----------
    vertices : (n, 3) array_like
        At least four points that are not in one plane, length.
    rounding : float
        Radius of the ball, length; 0 for a sharp polytope.

    Returns
    -------
    Body

    Raises
    ------
    BodyError
        The points lie in a plane or are too thin for their extent, or `rounding` leaves no core.
    ValueError
        A wrong shape, a number that is not finite or beyond 1e50, a negative rounding.
    """
    points = finite(vertices, "vertices", (-1, 3))
    rounding = magnitude_or_zero(rounding, "rounding")
    middle = _middle(points)
    local = points - middle
    if rounding == 0.0:
        return _polyhedron(points, points, middle, 0.0, "rounded polytope")
    unit = _unit(local)
    facets = _facets(local)
    normals = np.array([normal for _, normal in facets])
    offsets = np.array([max(local[loop] @ normal) for loop, normal in facets])
    try:
        core = unit * _inner_vertices(normals, offsets / unit, rounding / unit, unit)
    except scipy.spatial.QhullError as error:
        raise _thin(points) or BodyError(f"The core was not found: {_line(error)}") from error
    return _polyhedron(points, middle + core, middle, rounding, "rounded polytope")


def _inner_vertices(normals: Array, offsets: Array, rounding: float, unit: float) -> Array:
    """The vertices of normals @ x <= offsets - rounding, (n, 3); all lengths in `unit`.

    Raises
    ------
    BodyError
        The rounding leaves no core.
    QhullError
        The vertices are lost in roundoff.
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


def _polyhedron(given: Array, points: Array, middle: Array, radius: float, name: str) -> Body:
    """The hull of points relative to a middle; messages and notes are about the given points."""
    try:
        body = _solid(points, _facets(points - middle), radius, name)
    except BodyError as error:
        # Points that Qhull finds in one plane are reported as such.
        flat = points is given and isinstance(
            error.__cause__, scipy.spatial.QhullError | ValueError
        )
        thin = None if flat else _thin(given)
        if thin is None:
            raise
        raise thin from error
    if not middle.any():
        return body
    away = float(np.abs(given).max()) / float(np.ptp(given, axis=0).max())
    note = f"recentred: the hull is computed about {middle}: the origin is {away:.3g} extents away"
    return replace(body, report=replace(body.report, notes=(note, *body.report.notes)))


def _middle(points: Array) -> Array:
    """The point about which the hull is computed: the middle of distant points, else the origin."""
    extent = float(np.ptp(points, axis=0).max(initial=0.0)) if len(points) else 0.0
    if extent == 0.0 or float(np.abs(points).max()) <= FAR_OFF * extent:
        return np.zeros(3)
    return np.asarray(0.5 * (points.min(axis=0) + points.max(axis=0)))


def _thin(points: Array) -> BodyError | None:
    """The error for a polytope that cannot be built, if the reason is that it is thin."""
    axes = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2]
    extent, thickness = (float(np.ptp(points @ axis)) for axis in (axes[0], axes[-1]))
    if thickness >= THIN * extent:
        return None
    return BodyError(
        f"The {len(points)} vertices are too nearly in one plane: {thickness:.3g} thick on an "
        f"extent of {extent:.3g}, so that its facets cannot be distinguished. Make it thicker than "
        f"{THIN * extent:.1g}, or use a flat body, so.shapes.polygon."
    )


def _line(error: Exception) -> str:
    """The first line of Qhull's message, without the tables that follow."""
    return str(error).strip().splitlines()[0]


def _solid(points: Array, loops: list[Loop], radius: float, name: str) -> Body:
    used = sorted({k for loop, _ in loops for k in loop})
    number = {k: i for i, k in enumerate(used)}
    edge_number: dict[tuple[int, int], int] = {}
    edges: list[Edge] = []
    faces = []
    for loop, normal in loops:
        coedges = []
        for a, b in zip(loop, loop[1:] + loop[:1], strict=True):
            key = (min(a, b), max(a, b))
            if key not in edge_number:
                edge_number[key] = len(edges)
                edges.append(Edge(Line(points[a], points[b]), number[a], number[b]))
            edge = edges[edge_number[key]]
            coedges.append((edge_number[key], 1 if edge.first == number[a] else -1))
        centre = points[loop].mean(axis=0)
        along = points[loop[1]] - points[loop[0]]
        along = along / np.linalg.norm(along)
        faces.append(Face((Plane.through(centre, along, np.cross(normal, along)),), tuple(coedges)))
    return Body.from_brep(points[used], edges, faces, rounding=radius, name=name)


def _unit(points: Array) -> float:
    """A power of two near the points' extent, since Qhull's and linprog's tolerances are absolute.

    Division by it does not change any digit.
    """
    extent = float(np.ptp(points, axis=0).max()) if len(points) else 0.0
    if 0.0 < extent < LEAST:
        raise BodyError(
            f"The {len(points)} vertices extend over {extent:.3g}, below {LEAST:g}; choose a "
            "smaller unit."
        )
    return 2.0 ** round(np.log2(extent)) if extent > 0.0 else 1.0


def _hull(points: Array) -> Any:
    try:
        return scipy.spatial.ConvexHull(points / _unit(points))
    except (scipy.spatial.QhullError, ValueError) as error:
        raise BodyError(
            f"The {len(points)} vertices span no volume (flat polytope): give at least four "
            "points that are not in one plane."
        ) from error


def _facets(points: Array) -> list[Loop]:
    """The faces of the points' hull; facets in one plane become one face."""
    hull = _hull(points)
    group = -np.ones(len(hull.simplices), dtype=int)
    planes: list[tuple[Array, set[int]]] = []
    for seed in range(len(group)):
        if group[seed] >= 0:
            continue
        normal = hull.equations[seed, :3]
        members: set[int] = set()
        front = [seed]
        group[seed] = len(planes)
        while front:  # spread to neighbours in the seed's plane
            k = front.pop()
            members.update(int(v) for v in hull.simplices[k])
            for m in hull.neighbors[k]:
                if group[m] < 0 and np.abs(hull.equations[m, :3] - normal).max() < COPLANAR_FACETS:
                    group[m] = len(planes)
                    front.append(int(m))
        planes.append((normal, members))
    return _loops(points, planes)


def _loops(points: Array, planes: list[tuple[Array, set[int]]]) -> list[Loop]:
    """Loops around the vertices of planes, each given by its outward normal and its vertices."""
    loops = []
    for normal, members in planes:
        corner = sorted(members)
        centre = points[corner].mean(axis=0)
        first = points[corner[0]] - centre
        x = first / np.linalg.norm(first)
        y = np.cross(normal, x)
        rel = points[corner] - centre
        order = np.argsort(np.arctan2(rel @ y, rel @ x))
        loops.append(([corner[k] for k in order], normal))
    return loops
