"""Edges and faces of a polyhedron as objects."""

from __future__ import annotations

from standoff.bodies.hulls.polyhedron import Polyhedron
from standoff.bodies.made_parts import MadeParts
from standoff.bodies.report import PatchCheck
from standoff.bodies.topology import Edge, Face
from standoff.geometry.curves import Line
from standoff.geometry.quadrics import Plane


class Edges(MadeParts[Edge]):
    """The edges of a `Polyhedron`."""

    source: Polyhedron

    def __len__(self) -> int:
        return len(self.source.ends)

    def make(self, number: int) -> Edge:
        first, last = self.source.ends[number].tolist()
        vertices = self.source.vertices
        return Edge(Line(vertices[first], vertices[last]), first, last)


class Faces(MadeParts[Face]):
    """The faces of a `Polyhedron`."""

    source: Polyhedron

    def __len__(self) -> int:
        return self.source.n_faces

    def make(self, number: int) -> Face:
        solid = self.source
        own = slice(*solid.starts[number : number + 2])
        plane = Plane(solid.planes[number], solid.shifts[number])
        loop = zip(solid.edges[own].tolist(), solid.senses[own].tolist(), strict=True)
        return Face((plane,), tuple(loop))


def plane_checks(count: int) -> tuple[PatchCheck, ...]:
    """Of so many plane faces that each is convex, by theorem."""
    return tuple(
        PatchCheck(k, "Plane", "theorem", True, 0.0, True, (0.0, 0.0)) for k in range(count)
    )
