"""Where a convex body touches its supporting plane: a point, a straight segment or a flat area.

The extreme points of such a set that do not lie inside a curved face lie on edges and vertices,
or, where a patch of several spans is straight or flat in some of them, on the lines between the
spans. So only vertices, edges and those lines are examined.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy

from standoff.bodies.packed_parts import PackedParts
from standoff.bodies.tolerances import HEIGHT_ROUNDINGS, LEVEL, NEAREST_SPOT, PEAK
from standoff.geometry.curves import ConicArc, Curve, Line
from standoff.geometry.nurbs import NurbsSurface
from standoff.geometry.surface_curves import SurfaceCurve
from standoff.geometry.surfaces import Surface
from standoff.kernels.body import layout as L
from standoff.kernels.entries.queries import on_face
from standoff.typing import Array

# Samples of a piece of a curve: between two of them an arc of a convex body's boundary rises and
# falls once.
SAMPLES = 17
# A level arc is represented by this many points, evenly spaced.
ARC_POINTS = 129
# More points are added near the point nearest to the witness, at these fractions of the arc, so
# that an overlap as thin as 1e-7 there is not lost between two points.
NEAR_WITNESS = np.logspace(-8.5, -2.0, 27)


@dataclass(frozen=True)
class CurvePiece:
    """One analytic piece of a curve: t from first to last; `jet` gives (x, x_t).

    Attributes
    ----------
    basis : (3, 3) array for a conic arc: x = basis @ (cos t, sin t, 1).
    """

    jet: Callable[[float], tuple[Array, Array]]
    first: float
    last: float
    basis: Array | None = None

    def points(self, parameters: Array) -> Array:
        if self.basis is not None:
            one = np.ones_like(parameters)
            circle = np.column_stack([np.cos(parameters), np.sin(parameters), one])
            return np.asarray(circle @ self.basis.T)
        return np.array([self.jet(float(t))[0] for t in parameters])


def support_set(body: PackedParts, direction: Array, witness: Array) -> Array:
    """Points, (n, 3), whose convex hull is where a core touches its supporting plane.

    Parameters
    ----------
    body : Body
        Bounded; its swept radius is ignored.
    direction : (3,) array
        Outward unit normal of the plane, body frame, accurate to LEVEL.
    witness : (3,) array
        A point of the set, body frame: the only one that lies inside a curved face.

    Notes
    -----
    Not found: a face trimmed through a span that is flat while its neighbours are not; a formula
    that is flat or straight in only a part of its domain.
    """
    size = float(body.reals[L.SIZE])
    offset = float(np.linalg.norm(body.reals[L.BOX_CENTRE : L.BOX_CENTRE + 3]))
    rounding = HEIGHT_ROUNDINGS * np.finfo(float).eps * (size + offset)
    lowest = float(witness @ direction) - rounding - LEVEL * size
    pieces = list(_pieces(body, direction, lowest))
    peaks = [p for piece in pieces for p in _peaks(piece, direction)]
    spots = np.vstack([witness[None], body.vertex_points, *(p[None] for p in peaks)])
    heights = (spots - witness) @ direction
    top = spots[int(heights.argmax())]
    level = _level(spots, top, direction, rounding)
    arcs = []
    for piece in pieces:
        if _level(piece.points(_spread(piece, SAMPLES)), top, direction, rounding).all():
            points = piece.points(_arc_parameters(piece, witness))
            arcs.append(points[_level(points, top, direction, rounding)])
    return np.vstack([spots[level], *arcs])


def _level(points: Array, top: Array, direction: Array, rounding: float) -> Array:
    """Which points are level with the highest one."""
    away = points - top
    return np.asarray(-(away @ direction) <= LEVEL * np.linalg.norm(away, axis=1) + rounding)


def _spread(piece: CurvePiece, count: int) -> Array:
    return np.linspace(piece.first, piece.last, count)


def _pieces(body: PackedParts, direction: Array, lowest: float) -> Iterator[CurvePiece]:
    """Curved edges, and lines between the spans of faces, that may reach a height."""
    for edge in body.edge_parts:
        if not isinstance(edge.curve, Line):  # the ends of a line are vertices
            yield from _edge_pieces(edge.curve, direction, lowest)
    for face, part in enumerate(body.face_parts):
        surface = part.charts[0]
        chart = int(body.ints[int(body.ints[L.FACES]) + L.FACE_STRIDE * face])
        for line in _inner_lines(surface):
            if _reaches(line, direction, lowest):
                yield from _on_face(body, chart, line)


def _edge_pieces(curve: Curve, direction: Array, lowest: float) -> Iterator[CurvePiece]:
    if isinstance(curve, ConicArc):
        basis = curve.basis()
        a, b, c = basis.T @ direction
        if c + np.hypot(a, b) >= lowest:
            yield CurvePiece(_curve_jet(curve), curve.first, curve.last, basis)
        return
    for first, last in pairwise(curve_breaks(curve)):
        line = _isoline_of(curve, float(first), float(last))
        if line is None:
            yield CurvePiece(_curve_jet(curve), float(first), float(last))
        elif _reaches(line, direction, lowest):
            yield CurvePiece(line.jet, line.first, line.last)


def _isoline_of(curve: Curve, first: float, last: float) -> _Isoline | None:
    """A part of an edge as an isoline of its surface; None if it is not one."""
    if not isinstance(curve, SurfaceCurve) or curve.pcurve.kind != L.LINE or curve.others:
        return None
    matrix = curve.pcurve.matrix / curve.pcurve.matrix[2, 2]
    for axis in (0, 1):
        if matrix[axis, 0] == 0.0 and matrix[2, 0] == 0.0:
            ends = sorted(matrix[1 - axis, 0] * t + matrix[1 - axis, 2] for t in (first, last))
            return _Isoline(curve.surface, axis, float(matrix[axis, 2]), *map(float, ends))
    return None


def _curve_jet(curve: Curve) -> Callable[[float], tuple[Array, Array]]:
    def jet(t: float) -> tuple[Array, Array]:
        x, tangent, _ = curve.jet(t)
        return x, tangent

    return jet


def curve_breaks(curve: Curve) -> Array:
    """Ends of the pieces on which a curve is analytic."""
    if not isinstance(curve, SurfaceCurve):
        return curve.spans()
    spots = [curve.first, curve.last]
    for axis, knots in enumerate(curve.surface.pieces()):
        ends = [curve.pcurve.point(t)[axis] for t in (curve.first, curve.last)]
        rate = (ends[1] - ends[0]) / (curve.last - curve.first)
        if curve.pcurve.kind == L.LINE and rate != 0.0:
            crossings = curve.first + (np.asarray(knots) - ends[0]) / rate
            spots += [float(t) for t in crossings if curve.first < t < curve.last]
    return np.unique(spots)


@dataclass(frozen=True)
class _Isoline:
    """u = level (v its parameter) or v = level, from first to last."""

    surface: Surface
    axis: int
    level: float
    first: float
    last: float

    def parameters(self, t: float) -> tuple[float, float]:
        return (self.level, t) if self.axis == 0 else (t, self.level)

    def jet(self, t: float) -> tuple[Array, Array]:
        x, xu, xv, *_ = self.surface.jet(*self.parameters(t))
        return x, xv if self.axis == 0 else xu


def _inner_lines(surface: Surface) -> Iterator[_Isoline]:
    breaks, domain = surface.pieces(), surface.domain
    for axis in (0, 1):
        along = 1 - axis
        ends = np.array([domain[2 * along], *breaks[along], domain[2 * along + 1]])
        for level in breaks[axis]:
            for first, last in pairwise(ends):
                yield _Isoline(surface, axis, float(level), float(first), float(last))


def _reaches(line: _Isoline, direction: Array, height: float) -> bool:
    """May a line between two spans of a NURBS reach a height: do the nearby control points?"""
    if not isinstance(line.surface, NurbsSurface):
        return True
    across, along = line.surface.essential_u.breaks, line.surface.essential_v.breaks
    blocks = line.surface.blocks
    if line.axis == 1:
        across, along, blocks = along, across, blocks.swapaxes(0, 1)
    k = int(np.searchsorted(across, line.level))
    m = int(np.searchsorted(along, 0.5 * (line.first + line.last))) - 1
    points = blocks[max(k - 1, 0) : k + 1, m].reshape(-1, 4)
    return bool((points[:, :3] @ direction >= height * points[:, 3]).any())


def _on_face(body: PackedParts, chart: int, line: _Isoline) -> Iterator[CurvePiece]:
    """A line between spans, if the trimmed face contains all of it."""
    inner = np.linspace(line.first, line.last, SAMPLES)[1:-1]
    if all(on_face(body.ints, body.reals, chart, *line.parameters(float(t))) for t in inner):
        yield CurvePiece(line.jet, line.first, line.last)


def _peaks(piece: CurvePiece, direction: Array) -> Iterator[Array]:
    """The highest points of a piece, ends included."""

    def slope(t: float) -> float:
        return float(piece.jet(t)[1] @ direction)

    spots = _spread(piece, SAMPLES)
    slopes = [slope(float(t)) for t in spots]
    yield from piece.points(spots[[0, -1]])
    for k, (a, b) in enumerate(pairwise(slopes)):
        if a > 0.0 >= b:
            t = scipy.optimize.brentq(slope, spots[k], spots[k + 1], xtol=PEAK, rtol=PEAK)
            yield piece.jet(float(t))[0]


def _arc_parameters(piece: CurvePiece, witness: Array) -> Array:
    """Evenly spaced, and denser near the point nearest to the witness."""

    def away(t: float) -> float:
        return float(np.sum((piece.jet(t)[0] - witness) ** 2))

    even = _spread(piece, ARC_POINTS)
    k = int(((piece.points(even) - witness) ** 2).sum(axis=1).argmin())
    low, high = even[max(k - 1, 0)], even[min(k + 1, ARC_POINTS - 1)]
    found = scipy.optimize.minimize_scalar(
        away, bounds=(low, high), method="bounded", options={"xatol": NEAREST_SPOT}
    )
    near = float(found.x) if found.fun < away(float(even[k])) else float(even[k])
    steps = (piece.last - piece.first) * np.concatenate([-NEAR_WITNESS, [0.0], NEAR_WITNESS])
    return np.unique(np.clip(np.concatenate([even, near + steps]), piece.first, piece.last))


__all__ = ["curve_breaks", "support_set"]
