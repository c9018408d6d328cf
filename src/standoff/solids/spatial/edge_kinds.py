"""Kinds of edges, proven: convex, reflex or smooth by bounds of both faces' normals all along.

With the unit normals n and m of both faces and the unit tangent t along which the first face's loop
runs, (n × m) . t is the sine of the edge's turn, above 0 at a convex edge. Where n, m and t are in
cones of the half angles a, b and c, n × m differs from that of the axes by no more than
o = 2 sin(a / 2) + 2 sin(b / 2), and the sine by o + 2 sin(c / 2) |n × m|. Where that does not
decide, a part of an edge is halved.

Around an arc whose faces both are turned about its axis, the turn is the same all along, so that
one place decides; so it does along a line of two faces with one normal each along it.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.boundary import EdgeKind
from standoff.bodies.face_leaves import FaceChart
from standoff.bodies.packed_parts import PackedParts
from standoff.bodies.tessellation import coedge_range
from standoff.bodies.tolerances import SMOOTH_ANGLE
from standoff.geometry.curves import ConicArc, Curve
from standoff.geometry.patch_bounds import between
from standoff.geometry.roundness import round_arc
from standoff.geometry.vectors import crosses
from standoff.kernels.body import layout as L
from standoff.kernels.entries.queries import chart_normal, coedge_parameters
from standoff.kernels.solids.torus_potential import AXIS_OF, CENTRE_OF, CONE_OF, TORUS_THROUGH
from standoff.solids.spatial.analytic import natural_of
from standoff.solids.spatial.derivative_bounds import curve_derivatives
from standoff.solids.spatial.leaves import (
    UNKNOWN,
    NormalCones,
    edge_flags,
    face_cones,
    ranked,
)
from standoff.solids.spatial.tolerances import ONE_AXIS, ROUND_KIND, TURN_ROUNDING
from standoff.solids.spatial.trims import CoedgePiece, PieceColumns, edge_ranges
from standoff.typing import Array

# Parts of an edge at first, radians; and how often a part is halved.
FIRST_ARC = 0.6
MOST_HALVINGS = 5
TINY = float(np.finfo(np.float64).tiny)

Range = tuple[float, float]


class EdgeSide(NamedTuple):
    """A face at an edge: its number, and +1 where its loop runs along the edge's parameter."""

    face: int
    way: float


def proven_kinds(
    boundary: PackedParts,
    charts: dict[int, FaceChart],
    pieces: list[CoedgePiece],
    columns: PieceColumns,
) -> list[EdgeKind | None]:
    """Of each edge, what is proven of all its points; None where only samples decide. `columns`
    are those of the pieces."""
    sides = _sides(boundary)
    found: list[EdgeKind | None] = [None] * boundary.n_edges
    of_edge: dict[int, list[CoedgePiece]] = {}
    for piece in pieces:
        of_edge.setdefault(piece.edge, []).append(piece)
    asked: dict[int, list[Range]] = {}
    for k in range(boundary.n_edges):
        if len(sides[k]) != 2:
            continue
        found[k] = _constant(boundary, charts, of_edge.get(k, []), sides[k], k)
        if found[k] is None and (parts := _asked(boundary, of_edge.get(k, []), k)):
            asked[k] = parts
    told: dict[int, set[EdgeKind | None]] = {k: set() for k in asked}
    for depth in range(MOST_HALVINGS + 1):
        if not asked:
            break
        kinds, lost = _decided(boundary, asked, sides, face_cones(charts, columns, asked))
        waiting: dict[int, list[Range]] = {}
        number = 0
        for k, parts in asked.items():
            for part in parts:
                kind = kinds[number]
                if kind is None and depth < MOST_HALVINGS and not lost[number]:
                    middle = 0.5 * (part[0] + part[1])
                    waiting.setdefault(k, []).extend([(part[0], middle), (middle, part[1])])
                else:
                    told[k].add(kind)
                number += 1
        asked = {k: parts for k, parts in waiting.items() if len(told[k] - {None}) < 2}
    for k, each in told.items():
        found[k] = next(iter(each)) if len(each) == 1 else None
        if {EdgeKind.CONVEX, EdgeKind.REFLEX} <= each:
            found[k] = EdgeKind.MIXED
    return found


def sampled_edges(kinds: list[EdgeKind | None], told: tuple[EdgeKind, ...]) -> tuple[int, ...]:
    """Edges whose kind, as the boundary tells it by samples, is not the proven one."""
    return tuple(k for k, (one, other) in enumerate(zip(kinds, told, strict=True)) if one != other)


def _smooth(boundary: PackedParts, edge: int) -> bool:
    """Was an edge found to be smooth? No halving makes its normals' cones as narrow as that."""
    return bool(edge_flags(boundary, edge) & L.SMOOTH)


def _asked(boundary: PackedParts, pieces: list[CoedgePiece], edge: int) -> list[Range]:
    """The parts of an edge whose kinds cones may show, if any."""
    parts = list(edge_ranges(boundary.edge_parts[edge].curve, FIRST_ARC, boundary.size))
    return [] if _smooth(boundary, edge) and _turning(boundary, pieces, parts[0]) else parts


def _turning(boundary: PackedParts, pieces: list[CoedgePiece], part: Range) -> bool:
    """Do normals of a face turn along a part of an edge? Then no cones of them show it smooth."""
    for piece in pieces:
        first, last = max(part[0], piece.first), min(part[1], piece.last)
        if first < last:
            n, m = (_normal(boundary, piece, t) for t in (first, last))
            if float(between(n, m)) > 2.0 * SMOOTH_ANGLE + TURN_ROUNDING:
                return True
    return False


def _normal(boundary: PackedParts, piece: CoedgePiece, t: float) -> Array:
    u, v, *_ = coedge_parameters(boundary.ints, boundary.reals, piece.coedge, t)
    return np.array(chart_normal(boundary.ints, boundary.reals, piece.chart, u, v))


def _sides(boundary: PackedParts) -> list[list[EdgeSide]]:
    """The faces of each edge."""
    found: list[dict[int, float]] = [{} for _ in range(boundary.n_edges)]
    ints, reals = boundary.ints, boundary.reals
    for chart in range(int(ints[L.N_CHARTS])):
        row = int(ints[L.CHARTS]) + L.CHART_STRIDE * chart
        outward = float(reals[int(ints[row + L.CHART_REALS]) + L.OUTWARD])
        for coedge in coedge_range(boundary, chart):
            at = int(ints[L.COEDGES]) + L.COEDGE_STRIDE * coedge
            edge = int(ints[at + L.COEDGE_EDGE])
            if edge >= 0:
                way = float(ints[at + L.COEDGE_SIDE]) * outward
                found[edge][int(ints[row + L.CHART_FACE])] = way
    return [[EdgeSide(face, way) for face, way in each.items()] for each in found]


def _tangents(curve: Curve, parts: list[Range]) -> tuple[Array, Array]:
    """(axes (n, 3), half angles (n,)) of cones around the directions of a curve in each part."""
    first, last = np.array(parts).T
    tangents = curve.jets(0.5 * (first + last))[:, 1]
    size = np.linalg.norm(tangents, axis=1)
    away = curve_derivatives(curve, parts)[:, 1] * 0.5 * (last - first)
    angle = np.full(len(parts), UNKNOWN)
    with np.errstate(over="ignore"):
        np.arcsin(away / np.maximum(size, TINY), out=angle, where=away < size)
    return tangents / np.maximum(size, TINY)[:, None], angle


def _decided(
    boundary: PackedParts,
    asked: dict[int, list[Range]],
    sides: list[list[EdgeSide]],
    cones: NormalCones,
) -> tuple[list[EdgeKind | None], NDArray[np.bool_]]:
    """The kind of each part of edges by the cones of its faces' normals and of its tangents, and
    where a narrower part decides no better: a smooth edge's, or one with the same normals' cones
    that leave it open whatever the tangent is."""
    counts = [len(parts) for parts in asked.values()]
    count = sum(counts)
    tangents = [_tangents(boundary.edge_parts[k].curve, parts) for k, parts in asked.items()]
    edges = np.repeat(np.array(list(asked), dtype=np.int64), counts)
    firsts, ways = np.reshape([(sides[k][0].face, sides[k][0].way) for k in asked], (-1, 2)).T
    mine = cones.face == np.repeat(firsts, counts)[cones.part]
    ones, others = np.flatnonzero(mine), np.flatnonzero(~mine)
    many = np.bincount(cones.part[others], minlength=count)
    at = cones.part[ones]
    i, j = np.repeat(ones, many[at]), others[ranked((np.cumsum(many) - many)[at], many[at])]
    part = cones.part[i]
    axes, wide = (np.concatenate(rows) for rows in zip(*tangents, strict=True))
    t, turns = axes * np.repeat(ways, counts)[:, None], wide[part]
    kinds = _kinds(cones.axis[i], cones.axis[j], t[part], (cones.angle[i], cones.angle[j], turns))
    lost = np.array([_smooth(boundary, k) for k in edges.tolist()], dtype=bool)
    lost[part[kinds.lost & cones.final[i] & cones.final[j]]] = True
    found: list[EdgeKind | None] = [None] * count
    for kind, shown in kinds.shown.items():
        every = np.bincount(part, minlength=count) > 0
        every[part[~shown]] = False
        for number in np.flatnonzero(every).tolist():
            found[number] = kind
    return found, lost


class Kinds(NamedTuple):
    """Where each kind is shown, and where none is whatever the tangents are, (n,)."""

    shown: dict[EdgeKind, NDArray[np.bool_]]
    lost: NDArray[np.bool_]


def _kinds(n: Array, m: Array, t: Array, angles: tuple[Any, Any, Any]) -> Kinds:
    """Where normals n and m, of cones of these half angles, meet along t, all (k, 3)."""
    smooth = between(n.T, m.T) + angles[0] + angles[1] + TURN_ROUNDING <= SMOOTH_ANGLE
    turned = crosses(n, m)
    sine, size = (turned * t).sum(axis=-1), np.linalg.norm(turned, axis=-1)
    one, other, along = (2.0 * np.sin(0.5 * np.minimum(angle, np.pi)) for angle in angles)
    off = one + other
    spare = off + np.minimum(size + off, 1.0) * along + TURN_ROUNDING
    shown = {
        EdgeKind.REFLEX: ~smooth & (sine < -spare),
        EdgeKind.CONVEX: ~smooth & (sine > spare),
        EdgeKind.SMOOTH: smooth,
    }
    return Kinds(shown, ~smooth & (np.abs(sine) + size * along <= off))


def _constant(
    boundary: PackedParts,
    charts: dict[int, FaceChart],
    pieces: list[CoedgePiece],
    sides: list[EdgeSide],
    edge: int,
) -> EdgeKind | None:
    """The kind of an edge that has the same turn all along: none between parts of one surface, that
    of one place around an arc whose faces are turned about its axis. None of others. `pieces` are
    the edge's."""
    by_side = [[p for p in pieces if charts[p.chart].face == side.face] for side in sides]
    if not all(by_side):
        return None
    ones, others = ({p.chart for p in own} for own in by_side)
    if all(_one_surface(charts[k], charts[m], boundary.size) for k in ones for m in others):
        return EdgeKind.SMOOTH
    curve = boundary.edge_parts[edge].curve
    if not (isinstance(curve, ConicArc) and round_arc(curve, ROUND_KIND)):
        return None
    if not all(_turned_about(charts[k], curve, boundary.size) for k in ones | others):
        return None
    normals = []
    middle = 0.5 * (curve.first + curve.last)
    for own in by_side:
        piece = next((p for p in own if p.first <= middle <= p.last), own[0])
        t = min(max(middle, piece.first), piece.last)
        normals.append(_normal(boundary, piece, t))
        tangent = np.asarray(curve.jet(t)[1], dtype=float)
    way = sides[0].way * tangent / np.linalg.norm(tangent)
    shown = _kinds(normals[0], normals[1], way, (0.0, 0.0, 0.0)).shown
    return next((kind for kind, at in shown.items() if at), None)


def _one_surface(one: FaceChart, other: FaceChart, size: float) -> bool:
    """Are two charts parts of one surface, with one outward side?"""
    a, b = one.surface, other.surface
    if a.kind == b.kind and one.outward == other.outward and np.array_equal(a.reals, b.reals):
        return True
    (kind, first), (same, second) = natural_of(one), natural_of(other)
    if kind < 0 or kind != same:
        return False
    (point, axis), (spot, way) = (first[3:6], first[6:9]), (second[3:6], second[6:9])
    if kind == TORUS_THROUGH:  # the sign is that of the normal
        axis, way = first[0] * axis, second[0] * way
    elif first[0] != second[0]:
        return False
    along, off = float(axis @ way), spot - point
    if kind == TORUS_THROUGH:
        off = (off @ axis) * axis
    elif kind == AXIS_OF:
        off = off - (off @ axis) * axis
    straight = kind == CENTRE_OF or float(np.linalg.norm(np.cross(axis, way))) <= ONE_AXIS
    faces = along > 0.0 or kind not in (TORUS_THROUGH, CONE_OF)
    near = float(np.linalg.norm(off)) + float(np.abs(first[1:3] - second[1:3]).sum())
    return straight and faces and near <= ONE_AXIS * size


def _turned_about(chart: FaceChart, arc: ConicArc, size: float) -> bool:
    """Does a turn about an arc's axis move a face's surface into itself?"""
    kind, record = natural_of(chart)
    if kind < 0:
        return False
    basis = arc.basis()
    axis = np.cross(basis[:, 0], basis[:, 1])
    axis = axis / np.linalg.norm(axis)
    point, own = record[3:6], record[6:9]
    straight = float(np.linalg.norm(np.cross(axis, own))) <= ONE_AXIS
    if kind == TORUS_THROUGH:
        return straight
    off = np.asarray(point - basis[:, 2])
    beside = float(np.linalg.norm(off - (off @ axis) * axis)) <= ONE_AXIS * size
    return beside and (straight or kind == CENTRE_OF)
