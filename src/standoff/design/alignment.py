"""Which feature of a neighbouring body is which of a design's own.

The order of a polytope's edges depends on its numbers, down to the roundoff. Planes and lines may
be renumbered and described anew: any of their points rises with them. All else must stay as it is.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from standoff.bodies.boundary import Boundary
from standoff.design.points import Group, points_of
from standoff.kernels.body import layout as L
from standoff.typing import Array, Ints

CLEARLY = 2.0
"""Times the least distance: what another feature must be nearer by to be meant."""


def numbers_in(other: Boundary, own: Boundary) -> Ints | None:
    """The packed number in `other` of each feature of `own`, of the same counts; -1: none is it."""
    found, first = np.full(own.n_faces + own.n_edges + own.n_vertices, -1), 0
    for there, here in zip(_marks(other), _marks(own), strict=True):
        if not len(here):
            continue
        nearest, numbers = cKDTree(there).query(here)
        kept = np.linalg.norm(there - here, axis=1) <= CLEARLY * nearest
        numbers = np.where(kept, np.arange(len(here)), numbers)
        straight = np.array([_straight(other, first + int(k)) for k in numbers])
        alone = np.bincount(numbers, minlength=len(here))[numbers] == 1
        found[first : first + len(here)] = np.where(alone & (kept | straight), first + numbers, -1)
        first += len(here)
    return None if (found == np.arange(len(found))).all() else found


def _marks(body: Boundary) -> tuple[Array, Array, Array]:
    """A point for each face (the mean of its edges'), each edge (its middle), and each vertex."""
    edges = np.zeros((body.n_edges, 3))
    for k in range(body.n_edges):
        number = body.n_faces + k
        at = int(body.ints[L.edge_record(body.ints, number) + L.EDGE_REALS])
        middle = 0.5 * (body.reals[at + L.EDGE_T0] + body.reals[at + L.EDGE_T1])
        place = Group(number, -1, np.zeros(1, dtype=np.int64), np.array([[middle, 0.0]]))
        edges[k] = points_of(body, place)[0]
    faces = np.zeros((body.n_faces, 3))
    for k, face in enumerate(body.face_parts):
        around = [number for number, _ in face.loop]
        if around:
            faces[k] = edges[around].mean(axis=0)
    return faces, edges, np.reshape(body.vertex_points, (-1, 3))


def _straight(body: Boundary, number: int) -> bool:
    """Is a feature a plane, a line or a point?"""
    ints = body.ints
    if number < body.n_faces:
        first = int(ints[int(ints[L.FACES]) + L.FACE_STRIDE * number])
        return bool(ints[L.chart_record(ints, first) + L.CHART_KIND] == L.PLANE)
    if number < body.n_faces + body.n_edges:
        return bool(ints[L.edge_record(ints, number) + L.EDGE_KIND] == L.LINE)
    return True
