"""Faces and edges of a polytope from its vertices (Qhull), coplanar triangles merged."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

Array = NDArray[Any]

COPLANAR = 1e-9
"""Greatest difference of two unit normals, and of offsets over the size, in one plane."""


class Facets:
    """Planes and edges of a polytope.

    Attributes
    ----------
    normals, offsets : (m, 3), (m,)
        Outward unit normals and ``n.x`` of the planes.
    edges : (e, 2)
        Vertex indices of the sharp edges.
    edge_faces : (e, 2)
        The two planes that meet at each edge.
    """

    def __init__(self, vertices: Array) -> None:
        hull: Any = ConvexHull(vertices)
        size = float(np.linalg.norm(vertices, axis=1).max())
        planes: list[Array] = []
        plane_of: list[int] = []
        for equation in np.asarray(hull.equations):
            scale = np.array([1, 1, 1, 1 / size])
            close = [np.abs((equation - known) * scale).max() <= COPLANAR for known in planes]
            if not any(close):
                planes.append(equation)
                close.append(True)
            plane_of.append(close.index(True))
        stacked = np.stack(planes)
        self.normals: Array = stacked[:, :3]
        self.offsets: Array = (vertices @ self.normals.T).max(axis=0)
        edges: list[tuple[int, int]] = []
        faces: list[tuple[int, int]] = []
        for one, neighbours in enumerate(hull.neighbors):
            for other in neighbours:
                if other > one and plane_of[one] != plane_of[other]:
                    shared = sorted(set(hull.simplices[one]) & set(hull.simplices[other]))
                    edges.append((int(shared[0]), int(shared[1])))
                    faces.append((plane_of[one], plane_of[other]))
        self.edges: Array = np.array(edges)
        self.edge_faces: Array = np.array(faces)

    @property
    def edge_normals(self) -> tuple[Array, Array]:
        """Normals (e, 3) of the two faces of each edge."""
        return self.normals[self.edge_faces[:, 0]], self.normals[self.edge_faces[:, 1]]
