"""Bodies of revolution about the axis z."""

from __future__ import annotations

import numpy as np

from standoff.bodies.body import Body
from standoff.bodies.shapes.isolines import along_u
from standoff.bodies.shapes.profile_hulls import Chain, ProfileArc, hull_chain
from standoff.bodies.tolerances import SAME_RADIUS
from standoff.bodies.topology import Apex, Edge, Face
from standoff.checks.numbers import magnitude_or_zero
from standoff.geometry.curves import FULL_TURN, ConicArc, Curve, Line
from standoff.geometry.quadrics import Cone, Cylinder, Plane
from standoff.geometry.swept import Revolution
from standoff.typing import Array


def hull_of_revolution(curve: Curve, *, rounding: float = 0.0) -> Body:
    """The convex hull of a planar curve rotated about the axis z.

    Arcs of the curve that are on the hull stay exact. Concave parts are bridged by cones and
    cylinders that touch the arcs, and ends off the axis are closed by discs.

    Raises BodyError: the curve spans no volume; its hull is finer than 2048 samples; it is a closed
    curve of another kind. Raises ValueError: it is not a `Curve`, leaves the plane y = 0 or crosses
    the axis; a negative rounding.

    Parameters
    ----------
    curve : Curve
        In the half-plane y = 0, x >= 0: x is the radius, z the height, lengths; open, or a closed
        `ConicArc`. It may touch the axis only at its ends.
    rounding : float
        Radius of a ball swept over it, length, zero or above: the body grows by it all round.

    Returns
    -------
    Body
    """
    rounding = magnitude_or_zero(rounding, "rounding")
    whole = Revolution(curve)
    chain = hull_chain(curve)
    vertices: list[Array] = []
    edges: list[Edge] = []
    ring: list[int] = []  # number of the edge, or of the vertex if the ring is a point
    for r, z in chain.rings:
        if r == 0.0:
            ring.append(len(vertices))
            vertices.append(np.array([0.0, 0.0, z]))
        else:
            ring.append(len(edges))
            edges.append(Edge(ConicArc([0.0, 0.0, z], [r, 0.0, 0.0], [0.0, r, 0.0])))
    faces = [_piece(whole, chain, ring, k) for k in range(len(chain.pieces))]
    for end, sense in ((0, -1), (-1, 1)):
        r, z = chain.rings[end]
        if r > 0.0:
            across = np.array([0.0, float(sense), 0.0])
            disc = Plane.through(np.array([0.0, 0.0, z]), np.array([1.0, 0.0, 0.0]), across)
            faces.append(Face((disc,), ((ring[end], sense),)))
    points = np.array(vertices).reshape(-1, 3)
    return Body.from_brep(points, edges, faces, rounding=rounding, name="hull of revolution")


def _piece(whole: Revolution, chain: Chain, ring: list[int], k: int) -> Face:
    """The face between rings k and k + 1."""
    low, high = chain.rings[k], chain.rings[k + 1]
    piece = chain.pieces[k]
    if piece is not None:
        v0, v1 = sorted((piece.low, piece.high))
        return _band(_part(whole, v0, v1), piece, low, high, ring, k)
    if low[0] == 0.0 or high[0] == 0.0:
        return _cone(low, high, ring, k)
    if abs(high[0] - low[0]) <= SAME_RADIUS * high[0]:
        r = high[0]
        side = Cylinder(np.diag([r, r, 1.0]), np.zeros(3))
        return Face((side,), ((ring[k], 1), (ring[k + 1], -1)))
    slant = Revolution(Line([low[0], 0.0, low[1]], [high[0], 0.0, high[1]]))
    return _band(slant, ProfileArc(0.0, 1.0), low, high, ring, k)


def _part(whole: Revolution, v0: float, v1: float) -> Revolution:
    """A part of a revolved curve; that of a closed conic may pass the ends of its period."""
    profile = whole.profile
    if not profile.closed:
        return whole.restricted(0.0, FULL_TURN, v0, v1)
    a, b, centre = profile.basis().T
    return Revolution(ConicArc(centre, a, b, v0, v1))


def _band(
    surface: Revolution, piece: ProfileArc, low: Array, high: Array, ring: list[int], k: int
) -> Face:
    loop, apexes, pcurves = [], [], []
    ends = (piece.low, piece.high)
    for number, radius, level, sense in (
        (ring[k], low[0], piece.low, 1),
        (ring[k + 1], high[0], piece.high, -1),
    ):
        if radius > 0.0:
            loop.append((number, sense))
            pcurves.append(along_u(level))
        else:
            side = "v0" if level == min(ends) else "v1"
            apexes.append(Apex(number, level, 0.0, FULL_TURN, side=side))
    return Face((surface,), tuple(loop), tuple(apexes), tuple(pcurves))


def _cone(low: Array, high: Array, ring: list[int], k: int) -> Face:
    """A cone whose apex is the ring that lies on the axis."""
    above = high[0] == 0.0
    (r, z), apex = (low, high[1]) if above else (high, low[1])
    side = Cone(np.diag([r, r, z - apex]), np.array([0.0, 0.0, apex]))
    vertex, edge = (ring[k + 1], ring[k]) if above else (ring[k], ring[k + 1])
    loop = ((edge, 1 if above else -1),)
    return Face((side,), loop, (Apex(vertex, 0.0, 0.0, FULL_TURN),))
