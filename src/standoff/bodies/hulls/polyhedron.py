"""A polyhedron in arrays: planes of its faces, its edges and how faces meet there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from standoff.bodies.hulls.outlines import Outlines
from standoff.errors import BodyError
from standoff.read_only import KeepsReadOnly
from standoff.typing import Array, Ints


@dataclass(frozen=True, eq=False)
class Polyhedron(KeepsReadOnly):
    """Faces with one outline each, in planes.

    Attributes
    ----------
    vertices : (v, 3), body frame.
    corners : (k,) vertices round the faces, one face after another, counterclockwise from outside.
    starts : (f + 1,) where each face's corners begin, and the end.
    planes : (f, 3, 3) whose columns are x_u, x_v (unit vectors in the plane) and the outward
        normal.
    normals : (f, 3) outward unit normals, as the kernels compute them.
    shifts : (f, 3) the points of u = v = 0: the corners' middles, in their planes.
    edges : (k,) the edge from each corner to the next one of its face.
    senses : (k,) +1 where the face passes it from its first vertex to its last, else -1.
    ends : (e, 2) first and last vertices of edges.
    sides : (e, 2) for every edge the places in `corners` from which its first and its second face
        pass it.
    """

    vertices: Array
    corners: Ints
    starts: Ints
    planes: Array
    normals: Array
    shifts: Array
    edges: Ints
    senses: Ints
    ends: Ints
    sides: Ints

    @property
    def n_faces(self) -> int:
        return len(self.starts) - 1

    @property
    def owners(self) -> Ints:
        """(k,) the face of every corner."""
        return np.repeat(np.arange(self.n_faces), np.diff(self.starts))

    @property
    def faces_of_edges(self) -> Ints:
        """(e, 2) the faces of every edge, ascending."""
        return np.asarray(self.owners[self.sides], dtype=np.int64)

    def pcurves(self) -> Array:
        """(k, 2, 3) rows (du, 0, u), (dv, 0, v) of the trimming curves, by the edges' parameters.

        The same as ``pcurve_of`` a `Line` on a `Plane`.
        """
        one, other = (self.vertices[self.ends[self.edges, k]] for k in range(2))
        columns = np.zeros((len(self.corners), 3, 3))
        columns[:, :, 0] = other - one
        columns[:, :, 2] = one - self.shifts[self.owners]
        return np.asarray((np.linalg.inv(self.planes)[self.owners] @ columns)[:, :2])


def polyhedron(points: Array, found: Outlines, roundoff: float) -> Polyhedron:
    """The polyhedron of outlines; vertices have the order of the points.

    A face whose corners are further than `roundoff`, length, from one plane has that of its
    greatest triangle, above which no point is, moved inwards to its lowest corner: so the face is
    within the hull.

    Raises BodyError: a face whose corners are in one line.
    """
    used, corners = np.unique(found.corners, return_inverse=True)
    vertices, starts = points[used], found.starts
    following = found.following
    planes, shifts = _planes(vertices, found._replace(corners=corners), roundoff)
    start, stop = corners, corners[following]
    keys = np.minimum(start, stop) * len(vertices) + np.maximum(start, stop)
    _, first, group = np.unique(keys, return_index=True, return_inverse=True)
    rank = np.argsort(first)
    number = np.empty(len(first), dtype=np.int64)
    number[rank] = np.arange(len(first))
    edges, places = number[group], first[rank]
    ends = np.column_stack([start[places], stop[places]])
    senses = np.where(start == ends[edges, 0], 1, -1)
    sides = np.argsort(edges, kind="stable").reshape(-1, 2)
    normals = np.cross(planes[:, :, 0], planes[:, :, 1])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    arrays = (vertices, corners, starts, planes, normals, shifts, edges, senses, ends, sides)
    for array in arrays:
        array.flags.writeable = False
    return Polyhedron(*arrays)


def _planes(vertices: Array, found: Outlines, roundoff: float) -> tuple[Array, Array]:
    """(columns, shifts) as `Plane.through` has them: the first side of a face is along u."""
    corners, starts, owners = found.corners, found.starts, found.owners
    shifts = np.add.reduceat(vertices[corners], starts[:-1]) / np.diff(starts)[:, None]
    normals = _vector_areas(vertices, found)
    lengths = np.linalg.norm(normals, axis=1)
    if not (lengths > 0.0).all():
        k = int(lengths.argmin())
        where = vertices[corners[starts[k]]]
        raise BodyError(f"The corners of face {k} about {where} are in one line.")
    normals /= lengths[:, None]
    along = vertices[corners[starts[:-1] + 1]] - vertices[corners[starts[:-1]]]
    away = vertices[corners] - shifts[owners]
    off = np.abs(np.einsum("ij,ij->i", away, normals[owners]))
    bent = np.maximum.reduceat(off, starts[:-1]) > roundoff
    if bent.any():
        normals[bent] = found.normals[bent]
        heights = np.einsum("ij,ij->i", away, normals[owners])
        lowest = np.minimum.reduceat(heights, starts[:-1])
        shifts[bent] += lowest[bent, None] * normals[bent]
    # the first side may be as short as roundoff, and then point out of the plane
    along -= np.einsum("ij,ij->i", along, normals)[:, None] * normals
    along /= np.linalg.norm(along, axis=1)[:, None]
    across = np.cross(normals, along)
    third = np.cross(along, across)
    lengths = np.linalg.norm(third, axis=1)
    third *= (np.sqrt(lengths) / lengths)[:, None]
    return np.stack([along, across, third], axis=2), shifts


def _vector_areas(vertices: Array, found: Outlines) -> Array:
    """(f, 3) twice the vector areas of outlines: of a plane one its normal, whatever its corners'
    roundoff. Each is summed from an end of its shortest side on, which keeps a needle's digits."""
    corners, starts, owners = found.corners, found.starts, found.owners
    points = vertices[corners]
    steps = points[found.following] - points
    lengths = np.einsum("ij,ij->i", steps, steps)
    first = np.lexsort((lengths, owners))[starts[:-1]]
    terms = np.cross(points - points[first][owners], steps)
    return np.asarray(np.add.reduceat(terms, starts[:-1]))
