"""Solids of plane faces alone, that need not be convex."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from standoff.bodies import Edge, Face
from standoff.geometry import Line, Plane
from standoff.solids import Solid


def polyhedron(
    points: NDArray[np.float64], loops: Sequence[Sequence[int]], name: str = "polyhedron"
) -> Solid:
    """A solid from its vertices (n, 3) and the loop of each face, by numbers of vertices in turn.

    The first three vertices of a loop are not in line.
    """
    edges: list[Edge] = []
    number: dict[tuple[int, int], int] = {}
    faces = []
    for loop in loops:
        sides = []
        for p, q in zip(loop, [*loop[1:], loop[0]], strict=True):
            key = (min(p, q), max(p, q))
            if key not in number:
                number[key] = len(edges)
                edges.append(Edge(Line(points[key[0]], points[key[1]]), *key))
            sides.append((number[key], 1 if p < q else -1))
        first, second, third = (points[k] for k in loop[:3])
        faces.append(Face((Plane.through(first, second - first, third - first),), tuple(sides)))
    return Solid.from_brep(points, edges, faces, name=name)
