"""Which side of a boundary is outside, at a point of it."""

from __future__ import annotations

import numpy as np

from standoff.geometry.validation import Array
from standoff.kernels.body import layout as L
from standoff.kernels.entries.queries import chart_normal, coedge_conormal
from standoff.solids.spatial.minimum import leaf_jet_of
from standoff.solids.spatial.solid import Solid

# Part of the way that is left between two normals that are opposed: no side is told by their sum.
OPPOSED = 1e-3


def outside_direction(solid: Solid, leaf: int, u: float, v: float) -> Array | None:
    """A vector d at a point y of the boundary, own frame: a point p whose nearest point of the
    boundary is y is outside where d . (p - y) > 0. None at vertices, and between faces that are
    nearly opposed.

    At an edge p - y is a sum of the faces' normals with weights of one sign, so their plain sum
    tells which.
    """
    part = solid.leaves[leaf]
    ints, reals = solid.boundary.ints, solid.boundary.reals
    if part.dim == 2:
        normal = np.array(chart_normal(ints, reals, part.chart, u, v))
        return normal if normal.any() else None
    if part.dim == 0:
        return None
    row = int(ints[L.EDGES]) + L.EDGE_STRIDE * (part.feature - solid.boundary.n_faces)
    _, tangent, *_ = leaf_jet_of(solid.packed, leaf, u, v)
    size = float(np.linalg.norm(tangent))
    if size == 0.0:
        return None
    along = (float(tangent[0] / size), float(tangent[1] / size), float(tangent[2] / size))
    total = np.zeros(3)
    for k in (L.EDGE_COEDGE_0, L.EDGE_COEDGE_1):
        total += np.array(coedge_conormal(ints, reals, int(ints[row + k]), along, u)[1])
    return total if float(np.linalg.norm(total)) > OPPOSED else None
