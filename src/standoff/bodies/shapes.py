"""Ready-made shapes, all from the same parts: ``so.shapes``.

Semi-axes for ellipsoids; full lengths for box, cylinder, capsule (its cylindrical part) and
cone; all centred, axis z. A cone's apex is at +height/2, its base at -height/2.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from standoff.bodies.body import Body
from standoff.bodies.topology import Apex, BodyError, Edge, Face
from standoff.geometry.curves import ConicArc, Curve, Line
from standoff.geometry.surfaces import Cone, Cylinder, Plane, Sphere
from standoff.geometry.validation import Array, finite, not_negative, positive

# Facets of a polytope whose normals differ by less (sine) are one face; hull facets of one
# plane differ by the roundoff of their vertices.
COPLANAR = 1e-9
# A lens's offset, and its radius less the offset, are at least this part of its radius: what
# float64 can still tell from a ball and from nothing.
THIN_LENS = 1e-9
# A gnomonic chart alone serves a face up to this tangent of the angle from its centre.
SINGLE_CHART_REACH = 3.0

# Rotations that take e_z to the six axes: the charts of an ellipsoid's atlas.
_AXES = np.array(
    [
        [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
        [[1, 0, 0], [0, -1, 0], [0, 0, -1]],
        [[0, 0, 1], [1, 0, 0], [0, 1, 0]],
        [[0, 0, -1], [-1, 0, 0], [0, 1, 0]],
        [[0, 1, 0], [0, 0, 1], [1, 0, 0]],
        [[0, -1, 0], [0, 0, -1], [1, 0, 0]],
    ],
    dtype=np.float64,
)


def sphere_atlas(linear: Array, centre: Array) -> tuple[Sphere, ...]:
    """Six overlapping gnomonic charts of the ellipsoid linear @ (unit sphere) + centre."""
    return tuple(Sphere(linear @ turn, centre) for turn in _AXES)


def point() -> Body:
    """The origin."""
    return Body.from_brep([np.zeros(3)], name="point")


def segment(length: float) -> Body:
    """A segment of the z axis."""
    half = 0.5 * positive(length, "length")
    ends = np.array([[0.0, 0.0, -half], [0.0, 0.0, half]])
    return Body.from_brep(ends, [Edge(Line(ends[0], ends[1]), 0, 1)], name="segment")


def sphere(r: float) -> Body:
    """A point with a swept radius."""
    return Body.from_brep([np.zeros(3)], radius=positive(r, "r"), name="sphere")


def capsule(r: float, length: float) -> Body:
    """A segment with a swept radius; `length` is that of the segment."""
    r, half = positive(r, "r"), 0.5 * positive(length, "length")
    ends = np.array([[0.0, 0.0, -half], [0.0, 0.0, half]])
    return Body.from_brep(ends, [Edge(Line(ends[0], ends[1]), 0, 1)], radius=r, name="capsule")


def ellipsoid(a: float, b: float, c: float) -> Body:
    """Semi-axes a, b, c along x, y, z: one smooth face with an atlas of six charts."""
    axes = np.diag([positive(a, "a"), positive(b, "b"), positive(c, "c")])
    return Body.from_brep(faces=[Face(sphere_atlas(axes, np.zeros(3)))], name="ellipsoid")


def cylinder(r: float, length: float) -> Body:
    """Two discs and a side without a seam; the rims are closed edges."""
    r, half = positive(r, "r"), 0.5 * positive(length, "length")
    x, y = np.array([r, 0.0, 0.0]), np.array([0.0, r, 0.0])
    low, high = np.array([0.0, 0.0, -half]), np.array([0.0, 0.0, half])
    edges = [Edge(ConicArc(low, x, y)), Edge(ConicArc(high, x, y))]
    faces = [
        Face((Cylinder(np.diag([r, r, 1.0]), np.zeros(3)),), ((0, 1), (1, -1))),
        Face((Plane.through(low, y / r, x / r),), ((0, -1),)),
        Face((Plane.through(high, x / r, y / r),), ((1, 1),)),
    ]
    return Body.from_brep(edges=edges, faces=faces, name="cylinder")


def cone(r: float, height: float) -> Body:
    """Base of radius r at -height/2, apex at +height/2."""
    r, height = positive(r, "r"), positive(height, "height")
    x, y = np.array([r, 0.0, 0.0]), np.array([0.0, r, 0.0])
    base, apex = np.array([0.0, 0.0, -0.5 * height]), np.array([0.0, 0.0, 0.5 * height])
    side = Cone(np.diag([r, r, -height]), apex)
    return Body.from_brep(
        [apex],
        [Edge(ConicArc(base, x, y))],
        [
            Face((side,), ((0, 1),), (Apex(0, 0.0, 0.0, 2.0 * np.pi),)),
            Face((Plane.through(base, y / r, x / r),), ((0, -1),)),
        ],
        name="cone",
    )


def box(x: float, y: float, z: float, rounding: float = 0.0) -> Body:
    """Outer lengths x, y, z; `rounding` is the radius of its edges and corners.

    The core is the box of x - 2 rounding, ..., swept by a ball.
    """
    lengths = np.array([positive(x, "x"), positive(y, "y"), positive(z, "z")])
    rounding = not_negative(rounding, "rounding")
    core = lengths - 2.0 * rounding
    if core.min() <= 0.0:
        raise ValueError(
            f"rounding = {rounding} leaves no core in a box {lengths}: give less than half the "
            "least length, or use a capsule or a sphere."
        )
    signs = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
    return _polyhedron(0.5 * core * signs, radius=rounding, name="box")


def polytope(vertices: Any) -> Body:
    """The convex hull of points, (n, 3), n >= 4, not in one plane."""
    return _polyhedron(finite(vertices, "vertices", (-1, 3)), name="polytope")


def _polyhedron(points: Array, radius: float = 0.0, name: str = "polytope") -> Body:
    try:
        hull = ConvexHull(points)
    except (QhullError, ValueError) as error:
        raise BodyError(
            f"The {len(points)} vertices span no volume (flat polytope): give at least four "
            "points that are not in one plane."
        ) from error
    loops = _facets(points, hull)
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
    return Body.from_brep(points[used], edges, faces, radius=radius, name=name)


def _facets(points: Array, hull: Any) -> list[tuple[list[int], Array]]:
    """Facets merged by plane: (vertex loop counterclockwise from outside, outward normal)."""
    group = -np.ones(len(hull.simplices), dtype=int)
    groups: list[tuple[Array, set[int]]] = []
    for seed in range(len(group)):
        if group[seed] >= 0:
            continue
        normal = hull.equations[seed, :3]
        members: set[int] = set()
        front = [seed]
        group[seed] = len(groups)
        while front:  # spread over neighbours in the seed's plane
            k = front.pop()
            members.update(int(v) for v in hull.simplices[k])
            for m in hull.neighbors[k]:
                if group[m] < 0 and np.abs(hull.equations[m, :3] - normal).max() < COPLANAR:
                    group[m] = len(groups)
                    front.append(int(m))
        groups.append((normal, members))
    facets = []
    for normal, members in groups:
        corner = sorted(members)
        centre = points[corner].mean(axis=0)
        first = points[corner[0]] - centre
        x = first / np.linalg.norm(first)
        y = np.cross(normal, x)
        rel = points[corner] - centre
        order = np.argsort(np.arctan2(rel @ y, rel @ x))
        facets.append(([corner[k] for k in order], normal))
    return facets


def lens(radius: float, offset: float) -> Body:
    """The paper's body: the intersection of three balls centred `offset` from the origin.

    The centres are -offset (cos 120°i, sin 120°i, 0), i = 0, 1, 2. Three spherical faces, three
    edges, two vertices.
    """
    r, c = positive(radius, "radius"), positive(offset, "offset")
    if c >= r:
        raise ValueError(
            f"Empty lens: offset = {c} is not below radius = {r}, so the balls share no interior."
        )
    if c < THIN_LENS * r or r - c < THIN_LENS * r:
        raise ValueError(
            f"lens({r}, {c}): offset / radius must be from {THIN_LENS:g} to 1 - {THIN_LENS:g}; "
            "below it is a ball (so.shapes.sphere), above it is thinner than roundoff."
        )
    top = np.array([0.0, 0.0, np.sqrt((r - c) * (r + c))])
    angles = 2.0 * np.pi / 3.0 * np.arange(3)
    centres = [-c * np.array([np.cos(t), np.sin(t), 0.0]) for t in angles]
    edges = []
    for i in range(3):
        # the edge where balls i and i + 1 meet: opposite to ball i + 2's centre, a circle
        # about the midpoint of their centres, in the plane that bisects them
        a, b = centres[i], centres[(i + 1) % 3]
        middle = 0.5 * (a + b)
        out = -middle / np.linalg.norm(middle)
        reach = np.sqrt(r * r - 0.25 * float((a - b) @ (a - b)))
        x_axis, z_axis = reach * out, np.array([0.0, 0.0, reach])
        half = float(np.arctan2(top[2], float(-middle @ out)))
        edges.append(Edge(ConicArc(middle, x_axis, z_axis, -half, half), 0, 1))
    faces = []
    for i in range(3):
        z = -centres[i] / c
        x = np.cross([0.0, 0.0, 1.0], z)
        frame = r * np.column_stack([x, np.array([0.0, 0.0, 1.0]), z])
        charts: tuple[Sphere, ...] = (Sphere(frame, centres[i]),)
        if top[2] / c > SINGLE_CHART_REACH:
            charts = sphere_atlas(frame, centres[i])
        # seen from outside, edge i lies at greater angle about z, edge i - 1 at lesser
        faces.append(Face(charts, ((i, 1), ((i + 2) % 3, -1))))
    return Body.from_brep([-top, top], edges, faces, name="lens")


def cap(radius: float, offset: float) -> Body:
    """The part z >= offset of a ball, -radius < offset < radius: a disc and a spherical face."""
    r = positive(radius, "radius")
    h = float(finite(offset, "offset", ()))
    if not -r < h < r:
        raise ValueError(f"Cap with offset = {h} outside (-{r}, {r}): nothing or a ball is left.")
    rim = float(np.sqrt((r - h) * (r + h)))
    x, y = np.array([rim, 0.0, 0.0]), np.array([0.0, rim, 0.0])
    base = np.array([0.0, 0.0, h])
    frame = r * np.eye(3)
    charts: tuple[Sphere, ...] = (Sphere(frame, np.zeros(3)),)
    if h <= 0.0 or rim / h > SINGLE_CHART_REACH:
        charts = sphere_atlas(frame, np.zeros(3))
    return Body.from_brep(
        edges=[Edge(ConicArc(base, x, y))],
        faces=[
            Face(charts, ((0, 1),)),
            Face((Plane.through(base, y / rim, x / rim),), ((0, -1),)),
        ],
        name="cap",
    )


def halfspace() -> Body:
    """z <= 0: one plane without a boundary."""
    plane = Plane.through(np.zeros(3), np.array([1.0, 0, 0]), np.array([0, 1.0, 0]))
    return Body.from_brep(faces=[Face((plane,))], name="halfspace")


def planar_loop(curves: Sequence[Curve], radius: float = 0.0) -> Body:
    """A planar convex body: curves in z = 0, each beginning where the one before ends.

    One closed conic (an ellipse) is a loop by itself.
    """
    curves = list(curves)
    if len(curves) == 1 and curves[0].closed:
        edges = [Edge(curves[0])]
        return Body.from_brep(edges=edges, dimension=2, radius=radius, name="planar loop")
    if len(curves) < 2:
        raise BodyError(f"A planar loop of {len(curves)} open curves: give at least two.")
    vertices = np.array([c.point(c.first) for c in curves])
    n = len(curves)
    edges = [Edge(c, i, (i + 1) % n) for i, c in enumerate(curves)]
    return Body.from_brep(vertices, edges, dimension=2, radius=radius, name="planar loop")
