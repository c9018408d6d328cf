"""Leaves of a solid: rectangles of its faces, intervals of its edges, and its vertices, with what
is proven of each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.face_leaves import FaceChart
from standoff.bodies.packed_parts import PackedParts
from standoff.geometry.curves import ConicArc
from standoff.geometry.patch_bounds import between
from standoff.geometry.roundness import round_arc
from standoff.kernels.body import layout as L
from standoff.kernels.entries.queries import edge_jet, on_face
from standoff.kernels.solids import spatial_layout as S
from standoff.read_only import KeepsReadOnly
from standoff.solids.spatial.analytic import natural_of, turned_axis
from standoff.solids.spatial.derivative_bounds import curve_derivatives, surface_derivatives
from standoff.solids.spatial.tolerances import (
    BOX_SPARE,
    COLLAPSED_FRAME,
    DERIVATIVE_INFLATION,
    LEAST_LENGTH,
    NO_AXIS,
    ROUND_KIND,
    SIDE_ROUNDING,
    SMOOTH_JOIN,
    SPOT_SPARE,
)
from standoff.solids.spatial.trims import CoedgePiece, PieceColumns, edge_ranges
from standoff.typing import Array

# Half angle of a leaf's cone of normals, radians.
WIDEST = 0.5
# Of that, what a part of a turn is made to take.
NARROW = 0.95
# Parts of the size: longest side of a leaf, of one that a trimming curve cuts, and of a plane: few
# hold two local minima then; longest part of an edge.
LONGEST, LONGEST_CUT, LONGEST_PLANE, LONGEST_PART = 0.3, 0.12, 0.25, 0.5
MOST_HALVINGS = 14
ARC = 0.6  # radians
UNKNOWN = np.pi


@dataclass
class Leaf(KeepsReadOnly):
    """One leaf, as ``kernels.solids.spatial_layout`` packs it."""

    dim: int
    feature: int
    chart: int
    cut: bool
    senses: int
    pieces: list[int]
    kind: int
    reals: Array
    centre: Array
    axes: Array
    half: Array
    beside: int = -1


def face_leaves(
    boundary: PackedParts, chart: FaceChart, pieces: list[CoedgePiece], own: list[int], size: float
) -> list[Leaf]:
    """The leaves of one chart; own: the numbers of its trimming curves' pieces."""
    natural = natural_of(chart)
    found: list[Leaf] = []
    waiting = _started(chart)
    for depth in range(MOST_HALVINGS + 1):
        waiting, cuts = _on_it(boundary, chart, waiting, pieces, own)
        if not len(waiting):
            break
        axes, angles = chart.surface.normal_cones(waiting)
        d = surface_derivatives(chart.surface, waiting)
        wide = np.stack([d[:, 0] * (waiting[:, 1] - waiting[:, 0]),
                         d[:, 1] * (waiting[:, 3] - waiting[:, 2])])  # fmt: skip
        cut = np.array([len(c) > 0 for c in cuts])
        longest = np.where(cut, LONGEST_CUT, LONGEST)
        if chart.surface.kind == L.PLANE:
            longest[:] = LONGEST_PLANE
        too_long = wide.max(axis=0) > longest * size
        split = (angles > WIDEST) | too_long
        if depth == MOST_HALVINGS:
            split[:] = False
        kept = np.flatnonzero(~split)
        for k, box in zip(kept, _face_boxes(chart, waiting[kept]), strict=True):
            cone = _face_cone(chart, axes[k], float(angles[k]))
            reals = _leaf_reals(waiting[k], d[k], cone, natural[1])
            found.append(
                Leaf(2, chart.face, chart.number, len(cuts[k]) > 0, S.OUTSIDE | S.INSIDE,
                     cuts[k], natural[0], reals, *box)
            )  # fmt: skip
        by_u = _bends_along_u(d, waiting, wide, angles > WIDEST)
        waiting = _halves(waiting[split], by_u[split])
    return found


def _started(chart: FaceChart) -> Array:
    """The chart's rectangle, in parts that no analytic break crosses."""
    u0, u1, v0, v1 = chart.rectangle
    if chart.surface.periodic:
        u1 = min(u1, u0 + 2.0 * np.pi)
    breaks = chart.surface.analytic_breaks()
    us = [u0, *sorted(u for u in np.asarray(breaks[0]).tolist() if u0 < u < u1), u1]
    if chart.surface.periodic:  # u is an angle: narrow enough at once
        us = [u for a, b in pairwise(us) for u in _angles(a, b)] + [u1]
    vs = [v0, *sorted(v for v in np.asarray(breaks[1]).tolist() if v0 < v < v1), v1]
    return np.array([[a, b, c, d] for a, b in pairwise(us) for c, d in pairwise(vs)])


def _angles(first: float, last: float) -> list[float]:
    """Where parts begin whose normals fit a cone of a leaf."""
    count = int(np.ceil((last - first) / (2.0 * NARROW * WIDEST)))
    return [first + (last - first) * k / count for k in range(count)]


def _on_it(
    boundary: PackedParts, chart: FaceChart, rows: Array, pieces: list[CoedgePiece], own: list[int]
) -> tuple[Array, list[list[int]]]:
    """The rectangles that may hold points of the face, and the pieces that may meet each."""
    kept: list[Array] = []
    cuts: list[list[int]] = []
    low = np.array([pieces[k].low for k in own]).reshape(-1, 2)
    high = np.array([pieces[k].high for k in own]).reshape(-1, 2)
    spare = SIDE_ROUNDING * float(np.abs(chart.rectangle).max())
    for row in rows:
        u0, u1, v0, v1 = row
        meets = (low <= [u1, v1]).all(axis=1) & (high >= [u0, v0]).all(axis=1)
        # a straight trim along the rectangle's side does not cut it
        inner = (low < [u1 - spare, v1 - spare]).all(axis=1)
        inner &= (high > [u0 + spare, v0 + spare]).all(axis=1)
        middle = on_face(
            boundary.ints, boundary.reals, chart.number, 0.5 * (u0 + u1), 0.5 * (v0 + v1)
        )
        if not meets.any() and not middle:
            continue
        if not inner.any():  # then it is on the face as its middle is, or off it
            if middle:
                kept.append(row)
                cuts.append([])
            continue
        kept.append(row)
        cuts.append([own[k] for k in np.flatnonzero(meets)])
    return np.reshape(kept, (-1, 4)), cuts


def _bends_along_u(
    d: Array, rows: Array, wide: Array, bent: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    hu, hv = rows[:, 1] - rows[:, 0], rows[:, 3] - rows[:, 2]
    with np.errstate(all="ignore"):
        bend_u = (d[:, 2] / d[:, 0] + d[:, 3] / d[:, 1]) * hu
        bend_v = (d[:, 4] / d[:, 1] + d[:, 3] / d[:, 0]) * hv
    known = np.isfinite(bend_u) & np.isfinite(bend_v)
    by_bend = np.where(known, bend_u >= bend_v, hu >= hv)
    by_width = np.where(np.isfinite(wide).all(axis=0), wide[0] >= wide[1], hu >= hv)
    return np.asarray(np.where(bent, by_bend, by_width))


def _halves(rows: Array, by_u: NDArray[np.bool_]) -> Array:
    first, second = rows.copy(), rows.copy()
    u, v = 0.5 * (rows[:, 0] + rows[:, 1]), 0.5 * (rows[:, 2] + rows[:, 3])
    first[by_u, 1], second[by_u, 0] = u[by_u], u[by_u]
    first[~by_u, 3], second[~by_u, 2] = v[~by_u], v[~by_u]
    return np.concatenate([first, second])


def _face_cone(chart: FaceChart, axis: Array, angle: float) -> Array:
    """Both cones: seen from outside and from inside."""
    wide = angle + SMOOTH_JOIN if angle < UNKNOWN else UNKNOWN
    out = chart.outward * axis
    return np.array([*out, wide, *-out, wide])


def _face_boxes(chart: FaceChart, rows: Array) -> list[tuple[Array, Array, Array]]:
    """(centre, axes, half) of a box round each rectangle's piece of the surface."""
    axes = []
    for u0, u1, v0, v1 in rows.tolist():
        _, xu, xv, *_ = chart.surface.jet(0.5 * (u0 + u1), 0.5 * (v0 + v1))
        axes.append(frame_along(xu if np.linalg.norm(xu) > 0.0 else xv, xv))
    if not axes:
        return []
    low, high = chart.surface.extents(rows, np.moveaxis(np.array(axes), 0, -1))
    return [box_of(a, low[:, k], high[:, k]) for k, a in enumerate(axes)]


def frame_along(first: Array, second: Array) -> Array:
    """(3, 3) rows: an orthonormal frame along a vector and near another."""
    scale = np.linalg.norm(first)
    a = first / scale if scale > 0.0 else np.array([1.0, 0.0, 0.0])
    b = second - (second @ a) * a
    if np.linalg.norm(b) <= COLLAPSED_FRAME * max(float(np.linalg.norm(second)), LEAST_LENGTH):
        b = np.eye(3)[int(np.abs(a).argmin())]
        b = b - (b @ a) * a
    b = b / np.linalg.norm(b)
    return np.stack([a, b, np.cross(a, b)])


def box_of(axes: Array, low: Array, high: Array) -> tuple[Array, Array, Array]:
    """(centre, axes, half) of a box from extents along its axes, grown for rounding."""
    reach = np.abs([low, high]).max()
    half = 0.5 * (high - low) + BOX_SPARE * reach
    return axes.T @ (0.5 * (low + high)), axes, half


def _leaf_reals(rect: Array, bounds: Array, cones: Array, natural: Array) -> Array:
    reals = np.zeros(S.LEAF_STRIDE)
    reals[S.RECT : S.RECT + 4] = rect
    reals[S.FIRST : S.FIRST + 12] = bounds
    reals[S.CONE_OUT : S.CONE_OUT + 8] = cones
    reals[S.NATURAL_REALS : S.NATURAL_REALS + 9] = natural
    return reals


def parts_of_edge(boundary: PackedParts, number: int) -> list[tuple[float, float]]:
    """The parts of an edge that are leaves; none of a smooth one, whose points are its faces'."""
    flags = edge_flags(boundary, number)
    if flags & L.SMOOTH and not flags & L.CREASED:
        return []
    return list(edge_ranges(boundary.edge_parts[number].curve, ARC, LONGEST_PART * boundary.size))


def edge_flags(boundary: PackedParts, number: int) -> int:
    row = int(boundary.ints[L.EDGES]) + L.EDGE_STRIDE * number
    return int(boundary.ints[row + L.EDGE_FLAGS])


def edge_leaves(
    boundary: PackedParts,
    number: int,
    ranges: list[tuple[float, float]],
    own: list[Cone],
    beside: tuple[int, Array],
    proven: bool,
) -> list[Leaf]:
    """The leaves of one edge: its parts, with the cones of their normals, and the potential of a
    round face beside it. If its kind is not proven it may hold nearest points on either side."""
    flags = edge_flags(boundary, number)
    senses = S.INSIDE if flags & L.REFLEX else S.OUTSIDE
    if flags & (L.MIXED | L.CREASED) or not proven:
        senses = S.OUTSIDE | S.INSIDE
    curve = boundary.edge_parts[number].curve
    feature = boundary.n_faces + number
    bounds = curve_derivatives(curve, ranges)
    arc = isinstance(curve, ConicArc) and round_arc(curve, ROUND_KIND)
    kind = S.ROUND_ARC if arc else S.NO_KIND
    axis = turned_axis(curve)
    if axis is not None:
        kind = S.TURNED
        record = np.concatenate([np.zeros(3), *axis])
        beside = beside if np.array_equal(beside[1][3:], record[3:]) else (S.NO_KIND, record)
    found = []
    for (first, last), d, cone in zip(ranges, bounds, own, strict=True):
        x, xt, xtt = (np.array(c) for c in edge_jet(boundary.ints, boundary.reals, feature,
                                                    0.5 * (first + last)))  # fmt: skip
        h = 0.5 * (last - first)
        axes = frame_along(xt, xtt)
        second = d[1] * h * h / 2.0
        half = np.abs(axes @ xt) * h + second
        half = half * (1.0 + DERIVATIVE_INFLATION) + SPOT_SPARE * float(np.abs(x).max())
        cones = np.full(8, -1.0)
        cones[:3], cones[4:7] = cone[0], -cone[0]
        cones[3] = cone[1] if senses & S.OUTSIDE else -1.0
        cones[7] = cone[1] if senses & S.INSIDE else -1.0
        every = np.zeros(12)
        every[0], every[2], every[5], every[9] = d
        reals = _leaf_reals(np.array([first, last, 0.0, 0.0]), every, cones, beside[1])
        found.append(Leaf(1, feature, -1, False, senses, [], kind, reals, x, axes, half, beside[0]))
    return found


Cone = tuple[Array, float]


class NormalCones(NamedTuple):
    """Cones that hold a face's outward normals along parts of edges, in the order of the parts.

    Columns: numbers of the parts and faces, axes (n, 3), half angles (radians), and whether a
    narrower part would have the same cone.
    """

    part: NDArray[np.int64]
    face: NDArray[np.int64]
    axis: Array
    angle: Array
    final: NDArray[np.bool_]


def face_cones(
    charts: dict[int, FaceChart],
    pieces: PieceColumns,
    ranges: Mapping[int, Sequence[tuple[float, float]]],
) -> NormalCones:
    """Of ascending parts of edges, numbered in their order, and each face beside them.

    Each chart is asked once for all parts of all its edges.
    """
    numbers = np.argsort(pieces.edge, kind="stable")
    edges = pieces.edge[numbers]
    which, part, start = [np.empty(0, np.int64)], [np.empty(0, np.int64)], 0
    for edge, parts in ranges.items():
        own = numbers[np.searchsorted(edges, edge) : np.searchsorted(edges, edge, "right")]
        low, high = np.reshape(parts, (-1, 2)).T
        first = np.searchsorted(high, pieces.ends[own, 0], "right")
        count = np.maximum(np.searchsorted(low, pieces.ends[own, 1]) - first, 0)
        which.append(np.repeat(own, count))
        part.append(start + ranked(first, count))
        start += len(low)
    all_pieces, all_parts = np.concatenate(which), np.concatenate(part)
    order = np.argsort(all_parts, kind="stable")
    all_pieces, all_parts = all_pieces[order], all_parts[order]
    ends = np.reshape([each for parts in ranges.values() for each in parts], (-1, 2))[all_parts]
    rows = pieces.clipped(all_pieces, ends)
    axis, angle = np.zeros((len(rows), 3)), np.zeros(len(rows))
    chart = pieces.chart[all_pieces]
    for number in np.unique(chart).tolist():
        own = np.flatnonzero(chart == number)
        axis[own], angle[own] = _normal_cones(charts[number], rows[own])
    within = (pieces.ends[all_pieces] - ends) * [1.0, -1.0] <= 0.0
    faces = np.array([charts[number].face for number in chart.tolist()], dtype=np.int64)
    final = ~pieces.straight[all_pieces] & within.all(axis=1)
    return NormalCones(all_parts, faces, axis, angle, final)


def ranked(first: NDArray[np.int64], count: NDArray[np.int64]) -> NDArray[np.int64]:
    """The numbers first, first + 1, ... of each group, `count` of each."""
    within = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    return np.asarray(np.repeat(first, count) + within)


def edge_cones(
    charts: dict[int, FaceChart],
    pieces: PieceColumns,
    ranges: dict[int, list[tuple[float, float]]],
) -> dict[int, list[Cone]]:
    """(axis, half angle) of a cone round both faces' normals along each part of each edge."""
    counts = [len(parts) for parts in ranges.values()]
    every = _cones_round(face_cones(charts, pieces, ranges), sum(counts))
    ends = np.cumsum(counts).tolist()
    return {
        edge: every[end - count : end]
        for edge, count, end in zip(ranges, counts, ends, strict=True)
    }


def _normal_cones(chart: FaceChart, rows: Array) -> tuple[Array, Array]:
    """(axes, half angles) of a chart's outward normals over rectangles; unknown ones where it has
    no bounds."""
    try:
        axes, angles = chart.surface.normal_cones(rows)
    except ValueError:
        return np.tile([0.0, 0.0, 1.0], (len(rows), 1)), np.full(len(rows), UNKNOWN)
    return chart.outward * axes, angles


def _cones_round(cones: NormalCones, count: int) -> list[Cone]:
    """A cone around those of each of `count` parts; of the half angle `UNKNOWN` where it would be
    too wide."""
    total = np.zeros((count, 3))
    np.add.at(total, cones.part, cones.axis)
    scale = np.linalg.norm(total, axis=1, keepdims=True)
    known = scale > NO_AXIS
    axis = np.where(known, total / np.where(known, scale, 1.0), [0.0, 0.0, 1.0])
    wide = np.where(known[:, 0], 0.0, UNKNOWN)
    np.maximum.at(wide, cones.part, between(axis[cones.part].T, cones.axis.T) + cones.angle)
    wide = np.where(wide + SMOOTH_JOIN < 0.5 * np.pi, wide + SMOOTH_JOIN, UNKNOWN)
    return list(zip(axis, wide.tolist(), strict=True))


def vertex_leaf(boundary: PackedParts, number: int) -> Leaf:
    """A vertex: every direction may lead to a nearest point."""
    x = np.asarray(boundary.vertex_points[number], dtype=float)
    cones = np.array([0.0, 0.0, 1.0, UNKNOWN, 0.0, 0.0, 1.0, UNKNOWN])
    reals = _leaf_reals(np.zeros(4), np.zeros(12), cones, np.zeros(9))
    feature = boundary.n_faces + boundary.n_edges + number
    senses = S.OUTSIDE | S.INSIDE
    half = np.full(3, SPOT_SPARE * float(np.abs(x).max()))
    return Leaf(0, feature, -1, False, senses, [], -1, reals, x, np.eye(3), half)
