"""Does a witness point lie where its feature gives way to another?"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.bodies.features import charts_of
from standoff.kernels.body import layout as L
from standoff.kernels.entries.queries import (
    coedge_conormal,
    edge_jet,
    end_direction,
    feature_jet,
    on_face,
)
from standoff.tracking.tolerances import BESIDE_FEATURE

Array = NDArray[np.float64]


def at_boundary(body: Body, number: int, chart: int, q: Array, n: Array) -> bool:
    """Whether a feature's point is, to BESIDE_FEATURE, one of a neighbouring feature as well.

    Parameters
    ----------
    number, chart : int
        Of the feature, packed.
    q : (2,) array
        Its parameters.
    n : (3,) array
        Unit normal out of the body, body frame.

    Notes
    -----
    Of a vertex its edges are looked at, so not the apex of a cone that has none; and a face of
    several charts is taken to have no boundary.
    """
    if number < body.n_faces:
        return _beside_loop(body, number, chart, q)
    if number < body.n_faces + body.n_edges:
        return _edge_ends(body, number, float(q[0]), n)
    row = int(body.ints[L.VERTICES]) + L.VERTEX_STRIDE * (number - body.n_faces - body.n_edges)
    fan, count = (int(body.ints[row + k]) for k in (L.VERTEX_FAN, L.VERTEX_N_FAN))
    for k in range(count):
        edge, end = (int(body.ints[fan + 2 * k + i]) for i in (0, 1))
        way = end_direction(body.ints, body.reals, body.n_faces + edge, end)
        if n @ np.array(way) > -BESIDE_FEATURE:
            return True
    return False


def _beside_loop(body: Body, face: int, chart: int, q: Array) -> bool:
    if not body.bounded or charts_of(body, face)[1] > 1:
        return False
    jet = np.array(feature_jet(body.ints, body.reals, face, chart, q[0], q[1]))
    lengths = np.linalg.norm(jet[1:3], axis=1)
    if not lengths.all():
        return True  # a pole: other parameters name the same point
    reach = BESIDE_FEATURE * body.size / lengths
    for du, dv in ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, -1), (1, -1), (-1, 1)):
        u, v = float(q[0] + du * reach[0]), float(q[1] + dv * reach[1])
        if not on_face(body.ints, body.reals, chart, u, v):
            return True
    return False


def _edge_ends(body: Body, number: int, t: float, n: Array) -> bool:
    curve = body.edge_parts[number - body.n_faces].curve
    tangent = np.array(edge_jet(body.ints, body.reals, number, t)[1])
    length = float(np.linalg.norm(tangent))
    to_end = min(t - curve.first, curve.last - t) * length
    if not curve.closed and to_end <= BESIDE_FEATURE * body.size:
        return True
    row = int(body.ints[L.EDGES]) + L.EDGE_STRIDE * (number - body.n_faces)
    along = tuple(tangent / length)
    for side in range(2):
        coedge = int(body.ints[row + L.EDGE_COEDGE_0 + side])
        if coedge < 0:
            continue
        way = coedge_conormal(body.ints, body.reals, coedge, along, t)[0]
        if n @ np.array(way) > -BESIDE_FEATURE:
            return True
    return False
