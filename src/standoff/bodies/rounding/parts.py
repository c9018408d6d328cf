"""The parts of a rounded body's boundary as they are made, with what each is swept from."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from standoff.bodies.body import Body
from standoff.bodies.boundary import Boundary
from standoff.bodies.features import Feature
from standoff.bodies.rounding.strips import arc_about
from standoff.bodies.tolerances import NO_STRIP
from standoff.bodies.topology import Edge, Face
from standoff.typing import Array


class Origin(NamedTuple):
    """What of the core a part of the boundary is swept from.

    Attributes
    ----------
    feature : Feature
    kept : tuple of (int, float)
        The core's parameters: which of the part's own each is, and what is added to it.
    """

    feature: Feature
    kept: tuple[tuple[int, float], ...] = ()

    def parameters(self, own: Array) -> tuple[float, ...]:
        """Those of the core."""
        return tuple(float(own[k]) + more for k, more in self.kept)


class Rounded(NamedTuple):
    """The boundary of a body with a radius, with what its parts are swept from.

    Attributes
    ----------
    boundary : Boundary
    origins : dict of Feature to Origin
        Of every face, edge and vertex of it.
    """

    boundary: Boundary
    origins: dict[Feature, Origin]


class SweptParts:
    """Vertices, edges and faces; those about a vertex of the core are found again.

    Attributes
    ----------
    around : dict of dict
        Of each vertex of the core: the edges about it that one face has so far, with the sense in
        which another's loop runs along them.
    """

    def __init__(self, core: Body) -> None:
        self.core, self.r = core, core.radius
        self.points: list[Array] = []
        self.edges: list[Edge] = []
        self.faces: list[Face] = []
        self.senses: list[int] = []
        self.origins: dict[Feature, Origin] = {}
        self.around: dict[int, dict[int, int]] = {}
        # of each vertex of the core: (unit normal, corner)
        self._corners: dict[int, list[tuple[Array, int]]] = {}
        # (vertex, both corners) of each arc about a vertex: its edge
        self._arcs: dict[tuple[int, frozenset[int]], int] = {}

    def rounded(self) -> Rounded:
        """All of them as a boundary."""
        made = Boundary.from_brep(
            np.array(self.points).reshape(-1, 3),
            self.edges,
            self.faces,
            senses=self.senses,
            name=self.core.name,
        )
        return Rounded(made, self.origins)

    def same(self, one: Array, other: Array) -> bool:
        """Do two unit normals move a point to one place?"""
        return self.r * float(np.linalg.norm(one - other)) <= NO_STRIP * self.core.size

    def corner(self, vertex: int, normal: Array) -> int:
        """The point of a vertex moved along a unit normal."""
        known = self._corners.setdefault(vertex, [])
        for other, number in known:
            if self.same(other, normal):
                return number
        known.append((normal, len(self.points)))
        self.origins[Feature("vertex", len(self.points))] = Origin(Feature("vertex", vertex))
        self.points.append(np.asarray(self.core.vertex_points[vertex]) + self.r * normal)
        return len(self.points) - 1

    def add_edge(self, edge: Edge, origin: Origin) -> int:
        self.origins[Feature("edge", len(self.edges))] = origin
        self.edges.append(edge)
        return len(self.edges) - 1

    def add_face(self, face: Face, sense: int, origin: Origin) -> None:
        self.origins[Feature("face", len(self.faces))] = origin
        self.faces.append(face)
        self.senses.append(sense)

    def arc(self, vertex: int, normals: tuple[Array, Array], tangent: Array) -> tuple[int, int]:
        """(edge, +1 or -1 where it runs the other way) about a vertex, between two normals."""
        first, last = (self.corner(vertex, n) for n in normals)
        key = (vertex, frozenset((first, last)))
        if key not in self._arcs:
            centre = np.asarray(self.core.vertex_points[vertex], dtype=float)
            curve = arc_about(centre, *normals, tangent, self.r)
            self._arcs[key] = self.add_edge(
                Edge(curve, first, last), Origin(Feature("vertex", vertex))
            )
        number = self._arcs[key]
        return number, 1 if self.edges[number].first == first else -1

    def ran(self, vertex: int, edge: int, sense: int) -> None:
        """A face's loop runs along an edge about a vertex; the sphere's may run the other way."""
        around = self.around.setdefault(vertex, {})
        if edge in around:
            del around[edge]  # two strips meet there
        else:
            around[edge] = -sense
