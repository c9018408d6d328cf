"""The moments of a body, by integrals over cells of its boundary, and bounds on their errors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from standoff.bodies.boundary import Boundary
from standoff.bodies.charts import edge_points, loop_pcurve
from standoff.bodies.moments.cells import integrate
from standoff.bodies.moments.face_cells import face_cells
from standoff.bodies.moments.flux import (
    AREA,
    COLUMNS,
    FIRST,
    SECOND,
    TENSOR,
    VECTOR_AREA,
    VOLUME,
    IntegralFrame,
)
from standoff.bodies.moments.skin import skin_cells
from standoff.bodies.topology import Edge, Face
from standoff.geometry.curves import Curve
from standoff.kernels.body import layout as L
from standoff.typing import Array

# Computed points of the boundary have this many roundings (eps of the frame's reach, and of the
# distance of the surfaces' own origins) from affine maps, jets and sums.
POINT_ROUNDINGS = 32.0
# About the greatest number of boundary points that are used.
MOST_NODES = 400_000
# Samples of an edge whose chords estimate its length, and by which factor it may be longer.
CHORDS, LONGER = 65, 1.01


@dataclass(frozen=True, eq=False)
class Moments:
    """Integrals over a body's interior, relative to a point, and bounds on their errors.

    Attributes
    ----------
    about : (3,) array
        The point, body frame.
    volume : float
        Length cubed.
    first : (3,) array
        ∫ x dV, with x measured from the point, length⁴.
    second : (3, 3) array
        ∫ x xᵀ dV, length⁵.
    area : float
        Of the boundary, length squared.
    volume_error, first_error, second_error
        Bounds, of the same shapes and units.
    nodes : int
        How many points of the boundary were used.
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


def moments_of(body: Boundary, tolerance: float) -> Moments:
    """The moments of a bounded spatial body.

    Parameters
    ----------
    body : Boundary
    tolerance : float
        Where refinement ends, relative to the volume, and to its products with the reach and the
        reach squared.
    """
    frame = _frame(body)
    cells = [cell for face in range(body.n_faces) for cell in face_cells(body, face, frame)]
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
    """The scale of each column's error: the volume for the moments; infinite for the columns that
    only check whether the boundary is closed."""
    sizes = np.full(COLUMNS, np.inf)
    least = np.finfo(float).eps * float(values[AREA])
    sizes[FIRST] = sizes[SECOND] = sizes[VOLUME] = max(abs(float(values[VOLUME])), least)
    return sizes


def _symmetric(six: Array) -> Array:
    xx, yy, zz, xy, yz, zx = six
    return np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])


def _frame(body: Boundary) -> IntegralFrame:
    """Centred at a point inside, with the reach of the body."""
    centre = _amid(body.vertex_points, body.edge_parts, body.face_parts)
    box = body.reals[L.BOX_CENTRE : L.BOX_CENTRE + 3]
    half = body.reals[L.BOX_HALF : L.BOX_HALF + 3]
    reach = float(np.linalg.norm(np.abs(centre - box) + half)) + body.radius
    return IntegralFrame(centre, reach, body.radius)


def _amid(vertices: Array, edges: Sequence[Edge], faces: Sequence[Face]) -> Array:
    """A point inside the convex hull of the boundary."""
    points = [vertices] if len(vertices) else []
    points += [edge_points(e) for e in edges]
    points += [_amid_face(face, edges) for face in faces]
    return np.asarray(np.concatenate(points).mean(axis=0))


def _amid_face(face: Face, edges: Sequence[Edge]) -> Array:
    """Points of a face's surface inside its loop, (n, 3); its first chart is centred on it."""
    if not face.loop:
        return np.array([chart.jet(0.0, 0.0)[0] for chart in face.charts])
    surface = face.charts[0]
    if surface.periodic:  # its edges surround it, and its angles are not joined yet
        return np.zeros((0, 3))
    if len(face.charts) > 1:
        return surface.jet(0.0, 0.0)[0][None]
    spots = []
    for k, (j, _) in enumerate(face.loop):
        if 0 <= j < len(edges):
            c = edges[j].curve
            pcurve = loop_pcurve(face, k, edges, surface)
            spots += [pcurve.point(t) for t in np.linspace(c.first, c.last, 9)]
    u, v = np.mean([p[:2] for p in spots if p[2] > 0.0] or [(0.0, 0.0)], axis=0)
    return surface.jet(float(u), float(v))[0][None]


def _displaced(body: Boundary, frame: IntegralFrame, area: float) -> float:
    """A bound on the moments of a layer as thick as the error of boundary points, and of the gaps
    along edges, in the frame's unit.

    The error of points is roundoff, of coordinates as large as those of the surfaces' own points,
    plus the body's slack.
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
    """By how much the boundary fails to be closed and counted once: ∮ x nᵀ dA should be the volume
    times the identity, ∮ n dA zero."""
    tensor = values[TENSOR].reshape(3, 3) - volume * np.eye(3)
    return float(max(np.abs(tensor).max(), np.abs(values[VECTOR_AREA]).max()))
