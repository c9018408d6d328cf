"""The moments of a body: its boundary cut into cells, integrated, and what they may be off."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from standoff.bodies.body import Body
from standoff.bodies.charts import interior_point
from standoff.bodies.support_sets import curve_breaks
from standoff.geometry.curves import Curve
from standoff.geometry.surfaces import Surface
from standoff.geometry.validation import Array
from standoff.kernels.body import layout as L
from standoff.simulation.moments.cells import Cell, integrate
from standoff.simulation.moments.directions import (
    Arc,
    Ellipsoid,
    farthest_start,
    part_cells,
    sphere_cells,
)
from standoff.simulation.moments.faces import (
    Chart,
    TrimmingCurve,
    chart_cells,
    superellipsoid_cells,
)
from standoff.simulation.moments.flux import (
    AREA,
    COLUMNS,
    FIRST,
    SECOND,
    TENSOR,
    VECTOR_AREA,
    VOLUME,
    Frame,
)
from standoff.simulation.moments.skin import skin_cells
from standoff.simulation.tolerances import ANGLE_TOLERANCE

# Points on the boundary are off their places by so many roundings (eps of the frame's reach, and of
# how far the surfaces' own origins are): affine maps, jets and sums.
POINT_ROUNDINGS = 32.0
# Points of the boundary that are taken at most, about.
MOST_NODES = 400_000
# Samples of an edge whose chords give its length, and how much longer it may be.
CHORDS, LONGER = 65, 1.01
# Most nodes of the area of an ellipsoidal face's directions.
ANGLE_NODES = 20_000


@dataclass(frozen=True, eq=False)
class Moments:
    """Integrals over a body's inside about a point, and bounds of their errors.

    Attributes
    ----------
    about : (3,) array
        The point, body frame.
    volume : float
        Length cubed.
    first : (3,) array
        ∫ x dV, from the point, length⁴.
    second : (3, 3) array
        ∫ x xᵀ dV, length⁵.
    area : float
        Of the boundary, length squared.
    volume_error, first_error, second_error
        Bounds, of the same shapes and units.
    nodes : int
        Points of the boundary that were taken.
    """

    about: Array
    volume: float
    first: Array
    second: Array
    area: float
    volume_error: float
    first_error: Array
    second_error: Array
    nodes: int


def moments_of(body: Body, tolerance: float) -> Moments:
    """The moments of a bounded spatial body.

    Parameters
    ----------
    body : Body
    tolerance : float
        At which refinement ends, relative to the volume, its reach and its reach squared.
    """
    frame = _frame(body)
    cells = [cell for face in range(body.n_faces) for cell in _face_cells(body, face, frame)]
    if frame.radius > 0.0:
        cells += skin_cells(body, frame)
    found = integrate(cells, _scale, tolerance, MOST_NODES)
    values, reach = found.values, frame.reach
    off = found.remainder + POINT_ROUNDINGS * np.finfo(float).eps * found.magnitude
    volume = float(values[VOLUME])
    common = _displaced(body, frame, float(values[AREA])) + _unclosed(values, volume)
    return Moments(
        frame.centre,
        volume * reach**3,
        values[FIRST] * reach**4,
        _symmetric(values[SECOND]) * reach**5,
        float(values[AREA]) * reach**2,
        float((off[VOLUME] + common) * reach**3),
        (off[FIRST] + common) * reach**4,
        _symmetric(off[SECOND] + common) * reach**5,
        found.nodes,
    )


def _scale(values: Array) -> Array:
    """What the differences of the columns count by: the moments by the volume; what only tells
    whether the boundary is closed needs no digits of its own."""
    sizes = np.full(COLUMNS, np.inf)
    least = np.finfo(float).eps * float(values[AREA])
    sizes[FIRST] = sizes[SECOND] = sizes[VOLUME] = max(abs(float(values[VOLUME])), least)
    return sizes


def _symmetric(six: Array) -> Array:
    xx, yy, zz, xy, yz, zx = six
    return np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])


def _frame(body: Body) -> Frame:
    """About a point inside, as far as the body goes."""
    centre = interior_point(body.vertex_points, body.edge_parts, body.face_parts)
    box = body.reals[L.BOX_CENTRE : L.BOX_CENTRE + 3]
    half = body.reals[L.BOX_HALF : L.BOX_HALF + 3]
    reach = float(np.linalg.norm(np.abs(centre - box) + half)) + body.radius
    return Frame(centre, reach, body.radius)


def _face_cells(body: Body, face: int, frame: Frame) -> list[Cell]:
    row = int(body.ints[L.FACES]) + L.FACE_STRIDE * face
    first, count = (int(n) for n in body.ints[row : row + 2])
    charts = [Chart(body, number, frame) for number in range(first, first + count)]
    surface = body.face_parts[face].charts[0]
    if surface.part_of == "ellipsoid":
        return _ellipsoid_cells(body, surface, charts)
    if surface.part_of == "superellipsoid" and len(charts) > 1:
        return superellipsoid_cells(charts, bool(body.face_parts[face].loop))
    return [cell for chart in charts for cell in chart_cells(chart)]


def _ellipsoid_cells(body: Body, surface: Surface, charts: list[Chart]) -> list[Cell]:
    """A face of an ellipsoid: its edges, on the unit sphere, bound its directions."""
    ellipsoid = Ellipsoid(surface.linear, surface.shift, charts[0].frame)
    bounding = set()
    for chart in charts:
        at = int(body.ints[int(body.ints[L.CHARTS]) + L.CHART_STRIDE * chart.number + 1])
        outward = int(body.reals[at + L.OUTWARD])
        for k in chart.coedges:
            curve = TrimmingCurve(body, k)
            if curve.edge >= 0:
                bounding.add((curve.edge, curve.side * outward))
    arcs = []
    for edge, side in sorted(bounding):
        part = body.edge_parts[edge].curve
        piece = ellipsoid.boundary(part)
        arcs += [
            Arc(piece, float(a), float(b), side * ellipsoid.sense)
            for a, b in pairwise(curve_breaks(part))
        ]
    if not arcs:
        return sphere_cells(ellipsoid.flux)
    start = farthest_start(arcs)
    cells = part_cells(arcs, start, ellipsoid.flux)
    angle = integrate(part_cells(arcs, start, _one), np.ones_like, ANGLE_TOLERANCE, ANGLE_NODES)
    return cells + sphere_cells(ellipsoid.flux) if angle.values[0] < 0.0 else cells


def _one(y: Array) -> Array:
    return np.ones((*y.shape[:-1], 1))


def _displaced(body: Body, frame: Frame, area: float) -> float:
    """A bound of the moments of the layer, as thick as points of the boundary may be off, and of
    the gaps along edges, in the frame's unit.

    Points are off by roundoff, of coordinates that go as far as the surfaces' own points, and by
    the body's slack.
    """
    origins = [
        surface.farthest() or float(np.linalg.norm(surface.shift))
        for face in body.face_parts
        for surface in face.charts
    ]
    coordinates = float(np.linalg.norm(frame.centre)) + frame.reach + max(origins, default=0.0)
    off = POINT_ROUNDINGS * np.finfo(float).eps * coordinates
    off += max(body.report.slack, body.report.sewing_residual)
    length = sum(_length(edge.curve) for edge in body.edge_parts) if body.face_parts else 0.0
    return off / frame.reach * (area + length / frame.reach)


def _length(curve: Curve) -> float:
    points = np.array([curve.point(float(t)) for t in np.linspace(curve.first, curve.last, CHORDS)])
    return LONGER * float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def _unclosed(values: Array, volume: float) -> float:
    """How far the boundary is from closed and counted once: ∮ x nᵀ dA from the volume, ∮ n dA from
    nothing."""
    tensor = values[TENSOR].reshape(3, 3) - volume * np.eye(3)
    return float(max(np.abs(tensor).max(), np.abs(values[VECTOR_AREA]).max()))
