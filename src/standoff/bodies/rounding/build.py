"""From a convex body with a radius to its boundary, which has faces of exact kinds.

Each face of the core is moved out, each sharp edge becomes a strip of a cylinder or a torus, and
each vertex a part of a sphere. They join smoothly.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from standoff.bodies.body import Body
from standoff.bodies.charts import loop_pcurve, surface_normal
from standoff.bodies.features import Feature, charts_of
from standoff.bodies.rounding.parts import Origin, Rounded, SweptParts
from standoff.bodies.rounding.strips import (
    TorusStrip,
    cylinder_about,
    frame_about,
    sphere_charts,
)
from standoff.bodies.shapes.isolines import along_u
from standoff.bodies.tessellation import chart_row
from standoff.bodies.tolerances import EXACT_KIND
from standoff.bodies.topology import Apex, Edge, Face
from standoff.errors import BodyError
from standoff.geometry.curves import ConicArc, Curve, Line
from standoff.geometry.pcurves import Pcurve
from standoff.geometry.quadrics import Cone, Cylinder, sphere_atlas
from standoff.geometry.roundness import alike, round_arc, square
from standoff.geometry.surfaces import Surface
from standoff.geometry.swept import Revolution
from standoff.geometry.torus import Torus
from standoff.kernels.body import layout as L
from standoff.typing import Array

# Points of an edge at which its faces' normals are compared.
COMPARED = 5
# Kinds on which lines and arcs have exact trimming curves.
BY_RULE = (L.PLANE, L.SPHERE, L.CYLINDER, L.CONE)


def rounded_boundary(body: Body) -> Rounded:
    """The boundary of a bounded spatial body with a radius.

    Raises BodyError: a face or an edge of the core that no exact kind is at the radius from.
    """
    return _Builder(body).built()


class _RoundedSide(NamedTuple):
    """An edge moved out with one of its faces: its curve, its unit normals at both ends, and how
    the face's loop runs along it."""

    face: int
    sense: int
    curve: Curve
    normals: tuple[Array, Array]


class _Builder:
    def __init__(self, body: Body) -> None:
        self.body, self.r, self.parts = body, body.radius, SweptParts(body)
        # of each entry (face, edge, sense) of the core's loops: its edge here
        self.moved: dict[tuple[int, int, int], int] = {}

    def built(self) -> Rounded:
        body = self.body
        if not body.face_parts:
            self._thin()
        else:
            moved = [self._surface(k) for k in range(body.n_faces)]
            sides = self._sides()
            for number in range(body.n_edges):
                self._edge(number, sides.get(number, []))
            for number, surface in enumerate(moved):
                self._face(number, surface)
            for vertex in range(body.n_vertices):
                self._vertex(vertex)
        return self.parts.rounded()

    def _refused(self, part: str, number: int, kind: str) -> BodyError:
        return BodyError(
            f"{self.body!r} is rounded by {self.r:g}, and its {part} {number}, a {kind}, has no "
            "exact surface at that distance: give a body without rounding, or one of planes, "
            "spheres, cylinders, cones, tori and turned arcs.",
            "body",
            self.body,
            part=(part, number),
        )

    def _outward(self, face: int) -> float:
        row = chart_row(self.body, charts_of(self.body, face)[0])
        return float(self.body.reals[int(row[L.CHART_REALS]) + L.OUTWARD])

    def _surface(self, number: int) -> list[MovedSurface]:
        found = []
        for chart in self.body.face_parts[number].charts:
            moved = moved_surface(chart, self._outward(number), self.r)
            if moved is None:
                raise self._refused("face", number, type(chart).__name__)
            found.append(moved)
        return found

    # --- edges of the core

    def _sides(self) -> dict[int, list[_RoundedSide]]:
        found: dict[int, list[_RoundedSide]] = {}
        edges = self.body.edge_parts
        for number, face in enumerate(self.body.face_parts):
            for entry, (j, sense) in enumerate(face.loop):
                curve = edges[j].curve
                spots = np.linspace(curve.first, curve.last, COMPARED)
                normals = self._normals(number, entry, spots)
                moved = moved_edge(curve, normals, spots, self.r)
                if moved is None:
                    raise self._refused("edge", j, type(curve).__name__)
                found.setdefault(j, []).append(
                    _RoundedSide(number, sense, moved, (normals[0], normals[-1]))
                )
        return found

    def _normals(self, number: int, entry: int, spots: Array) -> Array:
        """Outward unit normals of a face along an entry of its loop."""
        face = self.body.face_parts[number]
        j, _ = face.loop[entry]
        if len(face.charts) > 1:  # charts of a sphere
            points = np.array([self.body.edge_parts[j].curve.point(float(t)) for t in spots])
            away = points - face.charts[0].shift
            return np.asarray(away / np.linalg.norm(away, axis=1)[:, None])
        surface = face.charts[0]
        pcurve = loop_pcurve(face, entry, self.body.edge_parts, surface)
        places = [pcurve.point(float(t))[:2] for t in spots]
        return self._outward(number) * np.array([surface_normal(surface, u, v) for u, v in places])

    def _edge(self, number: int, sides: list[_RoundedSide]) -> None:
        given = self.body.edge_parts[number]
        by_sense = sorted(sides, key=lambda side: -side.sense)
        if [side.sense for side in by_sense] != [1, -1]:
            raise self._refused("edge", number, "seam that does not join two sides")
        one, other = by_sense
        origin = Origin(Feature("edge", number), ((0, 0.0),))
        smooth = all(map(self.parts.same, one.normals, other.normals))
        for side in by_sense:
            if smooth and side is other:
                new = self.moved[one.face, number, 1]
            else:
                first, last = (
                    None if vertex is None else self.parts.corner(vertex, n)
                    for vertex, n in zip((given.first, given.last), side.normals, strict=True)
                )
                new = self.parts.add_edge(Edge(side.curve, first, last), origin)
            self.moved[side.face, number, side.sense] = new
        if not smooth:
            self._strip(number, one, other)

    def _strip(self, number: int, one: _RoundedSide, other: _RoundedSide) -> None:
        """The part of a cylinder or a torus between the faces of a sharp edge."""
        given = self.body.edge_parts[number]
        curve = given.curve
        loop = [(self.moved[one.face, number, 1], -1), (self.moved[other.face, number, -1], 1)]
        ends: list[tuple[int, float]] = []
        for vertex, at, k in ((given.first, curve.first, 0), (given.last, curve.last, 1)):
            if vertex is None:
                continue
            tangent = curve.jet(at)[1]
            normals = one.normals[k], other.normals[k]
            arc, sense = self.parts.arc(vertex, normals, tangent / np.linalg.norm(tangent))
            sense = sense if k == 0 else -sense
            self.parts.ran(vertex, arc, sense)
            ends.append((arc, at))
            loop.insert(1 if k == 0 else 3, (arc, sense))
        if isinstance(curve, Line):
            face = Face((cylinder_about(curve, one.normals[0], self.r),), tuple(loop))
            self.parts.add_face(face, 1, Origin(Feature("edge", number), ((1, 0.0),)))
            return
        assert isinstance(curve, ConicArc)
        strip = TorusStrip(curve, (one.normals[0], other.normals[0]), self.r)
        levels = [along_u(strip.level(side.normals[0], curve.first)) for side in (one, other)]
        by_edge: dict[int, Pcurve] = {loop[0][0]: levels[0]}
        by_edge |= {self.moved[other.face, number, -1]: levels[1]}
        pcurves = [
            by_edge[j] if j in by_edge else strip.across(self.parts.edges[j].curve, dict(ends)[j])
            for j, _ in loop
        ]
        face = Face((strip.surface,), tuple(loop), pcurves=tuple(pcurves))
        self.parts.add_face(face, 1, Origin(Feature("edge", number), ((0, 0.0),)))

    # --- faces and vertices of the core

    def _face(self, number: int, moved: list[MovedSurface]) -> None:
        given = self.body.face_parts[number]
        surface, raised = moved[0].surface, moved[0].raised
        loop = [(self.moved[number, j, sense], sense) for j, sense in given.loop]
        by_rule = surface.kind in BY_RULE and not given.pcurves
        pcurves: list[Pcurve | None] = [
            None if by_rule else _raised(loop_pcurve(given, k, self.body.edge_parts,
                                                     given.charts[0]), raised)
            for k in range(len(loop))
        ]  # fmt: skip
        apexes = []
        for apex in given.apexes:
            flat = self._pole(number, apex)
            if flat is not None:
                vertex = self.parts.corner(apex.vertex, flat)
                apexes.append(Apex(vertex, apex.level + raised, apex.lo, apex.hi, apex.side))
                continue
            edge, sense = self._circle(number, apex)
            loop.append((edge, sense))
            pcurves.append(along_u(apex.level + raised))
        charts = tuple(each.surface for each in moved)
        kept = tuple(pcurves) if len(charts) == 1 and any(pcurves) else ()
        origin = Origin(Feature("face", number), ((0, 0.0), (1, -raised)))
        self.parts.add_face(
            Face(charts, tuple(loop), tuple(apexes), kept), int(self._outward(number)), origin
        )

    def _apex_normal(self, number: int, apex: Apex, t: float) -> Array:
        spot = (t, apex.level) if apex.side[0] == "v" else (apex.level, t)
        surface = self.body.face_parts[number].charts[0]
        return self._outward(number) * surface_normal(surface, *spot)

    def _pole(self, number: int, apex: Apex) -> Array | None:
        """The normal at a collapsed side, if it is one; else None."""
        normals = [
            self._apex_normal(number, apex, t) for t in np.linspace(apex.lo, apex.hi, COMPARED)
        ]
        return normals[0] if all(self.parts.same(n, normals[0]) for n in normals) else None

    def _circle(self, number: int, apex: Apex) -> tuple[int, int]:
        """(edge, sense) of the circle about a pointed end of a turned face."""
        surface = self.body.face_parts[number].charts[0]
        if surface.kind not in (L.CONE, L.REVOLUTION) or apex.side[0] != "v":
            raise self._refused("face", number, f"{type(surface).__name__} with a pointed end")
        x, y, axis = (surface.linear / np.linalg.norm(surface.linear, axis=0)).T
        n = self._apex_normal(number, apex, apex.lo)
        out = n @ (np.cos(apex.lo) * x + np.sin(apex.lo) * y)
        centre = np.asarray(self.body.vertex_points[apex.vertex]) + self.r * (n @ axis) * axis
        curve = ConicArc(centre, self.r * out * x, self.r * out * y, apex.lo, apex.hi)
        first = last = None
        if not curve.closed:
            first, last = (
                self.parts.corner(apex.vertex, self._apex_normal(number, apex, t))
                for t in (apex.lo, apex.hi)
            )
        edge = self.parts.add_edge(Edge(curve, first, last), Origin(Feature("vertex", apex.vertex)))
        sense = int(self._outward(number)) * (1 if apex.side == "v0" else -1)
        self.parts.ran(apex.vertex, edge, sense)
        return edge, sense

    def _vertex(self, vertex: int) -> None:
        """The part of a sphere about a vertex of the core."""
        loop = list(self.parts.around.get(vertex, {}).items())
        if not loop:
            return
        centre = np.asarray(self.body.vertex_points[vertex], dtype=float)
        charts = sphere_charts(centre, [self.parts.edges[j] for j, _ in loop], self.r)
        self.parts.add_face(
            Face(charts, tuple(_chained(loop, self.parts.edges))),
            1,
            Origin(Feature("vertex", vertex)),
        )

    def _thin(self) -> None:
        """A ball about a point, or all around a segment."""
        body, r = self.body, self.r
        points = np.asarray(body.vertex_points, dtype=float)
        if not body.edge_parts:
            atlas = sphere_atlas(r * np.eye(3), points[0])
            self.parts.add_face(Face(atlas), 1, Origin(Feature("vertex", 0)))
            return
        line = body.edge_parts[0].curve
        if not isinstance(line, Line):
            raise self._refused("edge", 0, type(line).__name__)
        along = line.point(1.0) - line.point(0.0)
        frame = frame_about(along / np.linalg.norm(along))
        x, y = r * frame[:, 0], r * frame[:, 1]
        for vertex, t in ((body.edge_parts[0].first, 0.0), (body.edge_parts[0].last, 1.0)):
            assert vertex is not None
            self.parts.add_edge(
                Edge(ConicArc(line.point(t), x, y)), Origin(Feature("vertex", vertex))
            )
        side = Face((cylinder_about(line, x, r),), ((0, 1), (1, -1)))
        self.parts.add_face(side, 1, Origin(Feature("edge", 0), ((1, 0.0),)))
        for edge, sense in ((0, -1), (1, 1)):
            atlas = sphere_atlas(r * np.eye(3), self.parts.edges[edge].curve.basis()[:, 2])
            origin = self.parts.origins[Feature("edge", edge)]
            self.parts.add_face(Face(atlas, ((edge, sense),)), 1, origin)


def _raised(pcurve: Pcurve, more: float) -> Pcurve:
    """A trimming curve with more v."""
    if more == 0.0:
        return pcurve
    matrix = pcurve.matrix.copy()
    matrix[1] += more * matrix[2]
    return Pcurve(pcurve.kind, matrix)


def _chained(loop: list[tuple[int, int]], edges: list[Edge]) -> list[tuple[int, int]]:
    """A loop's edges in the order in which they follow each other."""
    left = list(loop)
    found = [left.pop(0)]
    while left:
        j, sense = found[-1]
        end = edges[j].last if sense > 0 else edges[j].first
        k = next(
            (
                k
                for k, (i, way) in enumerate(left)
                if end is not None and (edges[i].first if way > 0 else edges[i].last) == end
            ),
            0,
        )
        found.append(left.pop(k))
    return found


# Surfaces and curves moved out by a radius, where the moved one is of an exact kind too.


class MovedSurface(NamedTuple):
    """A surface at a distance outside another.

    Attributes
    ----------
    surface : Surface
        A point of it has the parameters (u, v + `raised`) of the one that it was moved from.
    raised : float
        Of a cone, whose apex moves; 0 of all others.
    """

    surface: Surface
    raised: float = 0.0


def moved_surface(surface: Surface, outward: float, r: float) -> MovedSurface | None:
    """The surface at the distance r outside a convex face; None where it has no exact kind.

    outward : +1 where x_u × x_v points outward, else -1.
    """
    a, shift = surface.linear, surface.shift
    lengths = np.linalg.norm(a, axis=0)
    if surface.kind == L.PLANE:
        normal = np.cross(a[:, 0], a[:, 1])
        return MovedSurface(
            surface.transformed(np.eye(3), outward * r * normal / np.linalg.norm(normal))
        )
    if not (alike(lengths[0], lengths[1], EXACT_KIND) and square(a, EXACT_KIND)):
        return None
    if surface.kind == L.CYLINDER:
        grown = 1.0 + r / lengths[0]
        return MovedSurface(Cylinder(a * [grown, grown, 1.0], shift, surface.domain))
    if surface.kind == L.CONE:
        return _moved_cone(surface, r)
    if not alike(lengths[0], lengths[2], EXACT_KIND):
        return None
    scale = float(lengths[0])
    if surface.kind == L.SPHERE:
        grown = 1.0 + r / scale
        return MovedSurface(surface.transformed(grown * np.eye(3), (1.0 - grown) * shift))
    if isinstance(surface, Torus) and surface.bulge == 1:
        grown_torus = Torus(surface.major, surface.minor + r / scale, *surface.domain)
        return MovedSurface(grown_torus.transformed(a, shift))
    if isinstance(surface, Revolution):
        own = outward * float(np.sign(np.linalg.det(a)))
        profile = _moved_profile(surface, own, r / scale)
        if profile is not None:
            turned = Revolution(profile, *surface.domain[:2]).transformed(a, shift)
            return MovedSurface(turned.restricted(*surface.domain))
    return None


def _moved_cone(surface: Surface, r: float) -> MovedSurface:
    """With the same opening: its apex moves back by r / sin, where sin is that of half of it."""
    a, (u0, u1, v0, v1) = surface.linear, surface.domain
    radius, height = float(np.linalg.norm(a[:, 0])), float(np.linalg.norm(a[:, 2]))
    slant = float(np.hypot(radius, height))
    raised = r * height / (slant * radius)
    back = a[:, 2] / height * (r * slant / radius)
    return MovedSurface(
        Cone(a, surface.shift - back, (u0, u1, max(v0 + raised, 0.0), v1 + raised)), raised
    )


def _moved_profile(surface: Revolution, side: float, r: float) -> Curve | None:
    """A profile (x, 0, z) moved by r to its side along side * (z', 0, -x')."""
    profile, (_, _, v0, v1) = surface.profile, surface.domain
    middle = 0.5 * (v0 + v1)
    x, rate, _ = profile.jet(middle)
    out = side * np.array([rate[2], 0.0, -rate[0]]) / np.hypot(rate[0], rate[2])
    if isinstance(profile, Line):
        return Line(profile.point(0.0) + r * out, profile.point(1.0) + r * out)
    if isinstance(profile, ConicArc) and round_arc(profile, EXACT_KIND):
        p, q, centre = profile.basis().T
        radius = float(np.linalg.norm(p))
        grown = 1.0 + r * float(np.sign(out @ (x - centre))) / radius
        return ConicArc(centre, grown * p, grown * q, v0, v1) if grown > 1.0 else None
    return None


def moved_edge(curve: Curve, normals: Array, spots: Array, r: float) -> Curve | None:
    """A curve of a face moved out by r, with the same parameter; None where the face's unit
    normals (n, 3) at its parameters `spots` do not make the moved one a line or an arc."""
    if isinstance(curve, Line):
        n = normals[len(normals) // 2]
        if np.abs(normals - n).max() > EXACT_KIND:
            return None
        return Line(curve.point(0.0) + r * n, curve.point(1.0) + r * n)
    if not (isinstance(curve, ConicArc) and round_arc(curve, EXACT_KIND)):
        return None
    a, b, centre = curve.basis().T
    radius = float(np.linalg.norm(a))
    axis = np.cross(a, b) / np.linalg.norm(np.cross(a, b))
    radial = (np.outer(np.cos(spots), a) + np.outer(np.sin(spots), b)) / radius
    out, up = np.einsum("ij,ij->i", normals, radial), normals @ axis
    if max(np.ptp(out), np.ptp(up), np.abs(np.hypot(out, up) - 1.0).max()) > EXACT_KIND:
        return None
    grown = 1.0 + r * float(out.mean()) / radius
    centre = centre + r * float(up.mean()) * axis
    return ConicArc(centre, grown * a, grown * b, curve.first, curve.last)
