"""Faces and edges of a polytope from its vertices (Qhull), coplanar triangles merged."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from standoff_studies.oracles.shape import extended, unit

Array = NDArray[Any]

COPLANAR = 1e-9
"""Greatest difference between unit normals, and between offsets over the size, in one plane."""


class Facets:
    """Planes and edges of a polytope.

    Attributes
    ----------
    normals, offsets : (m, 3), (m,)
        Outward unit normals and ``n.x`` of the planes.
    long_normals : (m, 3)
        The normals in extended precision.
    corners : list of (c,)
        Vertex indices of every plane.
    edges : (e, 2)
        Vertex indices of the sharp edges.
    edge_faces : (e, 2)
        The two planes that meet at each edge.
    """

    def __init__(self, vertices: Array) -> None:
        hull: Any = ConvexHull(vertices)
        size = float(np.linalg.norm(vertices, axis=1).max())
        scale = np.array([1, 1, 1, 1 / size])
        plane_of = np.full(len(hull.equations), -1)
        normals: list[Array] = []
        outward: list[Array] = []
        self.corners: list[Array] = []
        for number, equation in enumerate(hull.equations):
            if plane_of[number] >= 0:
                continue
            close = np.abs((hull.equations - equation) * scale).max(axis=1) <= COPLANAR
            same = close & (plane_of < 0)
            plane_of[same] = len(normals)
            normals.append(equation[:3])
            a, b, c = extended(vertices[hull.simplices[number]])
            across = unit(np.cross(b - a, c - a))
            outward.append(across if across @ equation[:3] > 0 else -across)
            self.corners.append(np.unique(hull.simplices[same]))
        self.normals: Array = np.stack(normals)
        self.long_normals: Array = np.stack(outward)
        self.offsets: Array = (vertices @ self.normals.T).max(axis=0)
        self.edges, self.edge_faces = _edges(hull, plane_of)

    @property
    def edge_normals(self) -> tuple[Array, Array]:
        """Normals (e, 3) of the two faces of each edge."""
        return self.normals[self.edge_faces[:, 0]], self.normals[self.edge_faces[:, 1]]


def _edges(hull: Any, plane_of: Array) -> tuple[Array, Array]:
    """The ends of the edges between different planes, and these planes."""
    edges: list[tuple[int, int]] = []
    faces: list[tuple[int, int]] = []
    for one, neighbours in enumerate(hull.neighbors):
        for other in neighbours:
            if other > one and plane_of[one] != plane_of[other]:
                shared = sorted(set(hull.simplices[one]) & set(hull.simplices[other]))
                edges.append((int(shared[0]), int(shared[1])))
                faces.append((int(plane_of[one]), int(plane_of[other])))
    return np.array(edges), np.array(faces)
