"""The cells of one face, for any kind of surface."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from standoff.bodies.moments.cells import MomentCell, integrate
from standoff.bodies.moments.directions import (
    BoundaryArc,
    DirectedEllipsoid,
    farthest_start,
    part_cells,
    sphere_cells,
)
from standoff.bodies.moments.faces import (
    MomentChart,
    TrimmingCurve,
    chart_cells,
    superellipsoid_cells,
)
from standoff.bodies.moments.flux import AREA, COLUMNS, IntegralFrame
from standoff.bodies.moments.tolerances import ANGLE_TOLERANCE
from standoff.bodies.packed_parts import PackedParts
from standoff.bodies.support_sets import curve_breaks
from standoff.geometry.surfaces import Surface
from standoff.kernels.body import layout as L
from standoff.typing import Array

# Signs of the integrand's columns when the normal is reversed: all but the area change.
FLIPPED = np.where(np.arange(COLUMNS) == AREA, 1.0, -1.0)
# Greatest number of nodes for the solid angle of an ellipsoidal face.
ANGLE_NODES = 20_000


def face_cells(body: PackedParts, face: int, frame: IntegralFrame) -> list[MomentCell]:
    """The cells of one face's core."""
    row = int(body.ints[L.FACES]) + L.FACE_STRIDE * face
    first, count = (int(n) for n in body.ints[row : row + 2])
    charts = [MomentChart(body, number, frame) for number in range(first, first + count)]
    surface = body.face_parts[face].charts[0]
    if surface.part_of == "ellipsoid":
        return _ellipsoid_cells(body, surface, charts)
    if surface.part_of == "superellipsoid" and len(charts) > 1:
        return superellipsoid_cells(charts, bool(body.face_parts[face].loop))
    return [cell for chart in charts for cell in chart_cells(chart)]


def _ellipsoid_cells(
    body: PackedParts, surface: Surface, charts: list[MomentChart]
) -> list[MomentCell]:
    """A face of an ellipsoid: its edges, on the unit sphere, bound its directions."""
    ellipsoid = DirectedEllipsoid(surface.linear, surface.shift, charts[0].frame)
    # a gnomonic chart's x_u × x_v points out of the unit sphere; for a pit, outward is inwards
    bulges = charts[0].outward * ellipsoid.sense > 0.0

    def values(y: Array) -> Array:
        found = ellipsoid.flux(y)
        return found if bulges else np.asarray(found * FLIPPED)

    bounding = set()
    for chart in charts:
        for k in chart.coedges:
            curve = TrimmingCurve(body, k)
            if curve.edge >= 0:
                bounding.add((curve.edge, curve.side))
    arcs = []
    for edge, side in sorted(bounding):
        part = body.edge_parts[edge].curve
        piece = ellipsoid.boundary(part)
        arcs += [
            BoundaryArc(piece, float(a), float(b), side) for a, b in pairwise(curve_breaks(part))
        ]
    if not arcs:
        return sphere_cells(values)
    start = farthest_start(arcs)
    cells = part_cells(arcs, start, values)
    angle = integrate(part_cells(arcs, start, _one), np.ones_like, ANGLE_TOLERANCE, ANGLE_NODES)
    return cells + sphere_cells(values) if angle.values[0] < 0.0 else cells


def _one(y: Array) -> Array:
    return np.ones((*y.shape[:-1], 1))
