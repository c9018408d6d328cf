"""Pieces of trimming curves: where each is in (u, v), and bounds of its derivatives."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.face_leaves import FaceChart
from standoff.bodies.packed_parts import PackedParts
from standoff.bodies.tessellation import coedge_range, packed_pcurve
from standoff.geometry.bernstein import segments
from standoff.geometry.curves import ConicArc, Curve, Line
from standoff.geometry.pcurve_boxes import bezier_bend, bezier_box, pcurve_bends, pcurve_boxes
from standoff.kernels.body import layout as L
from standoff.kernels.entries.queries import coedge_parameters
from standoff.solids.spatial.derivative_bounds import curve_derivatives
from standoff.solids.spatial.tolerances import BEND_SPARE, TURN_SPARE
from standoff.typing import Array

# Parts of a trimming curve by its kind.
PARTS = {L.LINE: 1, L.CONIC: 8, L.BEZIER: 4}
# How often a span of an edge is halved for its leaves, at most, and where nothing is known of it.
MOST_HALVINGS, BLIND_HALVINGS = 5, 3

Boxes = tuple[Array, Array, Array]
"""(low, high) in (u, v) of each part of a trimming curve, and the greatest second derivatives of u
and v along it, each (n, 2)."""


@dataclass(frozen=True)
class CoedgePiece:
    """A part of a packed coedge.

    Attributes
    ----------
    coedge, chart, edge : packed numbers; the edge of a collapsed side is -1 - vertex.
    first, last : parameters.
    low, high : (2,) of a box around it in (u, v).
    bend : (2,) greatest second derivatives of u and v; inf where none is known.
    shift : what was added to u, a whole number of turns.
    bounds : (4,) as ``curve_derivatives`` gives them.
    straight : the ends (2, 2) of a straight one.
    """

    coedge: int
    chart: int
    edge: int
    first: float
    last: float
    low: Array
    high: Array
    bend: Array
    shift: float
    bounds: Array
    straight: Array | None


class PieceColumns(NamedTuple):
    """Pieces as columns: their edges, charts, parameters (n, 2), boxes (n, 4) as rectangles
    (u0, u1, v0, v1), which are straight, and the ends (n, 2, 2) of these."""

    edge: NDArray[np.int64]
    chart: NDArray[np.int64]
    ends: Array
    boxes: Array
    straight: NDArray[np.bool_]
    corners: Array

    def clipped(self, which: NDArray[np.int64], ranges: Array) -> Array:
        """(n, 4) rectangles around the parts of pieces (n,) within ranges (n, 2)."""
        found = self.boxes[which]
        at = np.flatnonzero(self.straight[which])
        first, last = self.ends[which[at]].T
        shares = (np.clip(ranges[at].T, first, last) - first) / (last - first)
        start, stop = np.moveaxis(self.corners[which[at]], 1, 0)
        ends = start + shares[..., None] * (stop - start)
        found[at, ::2], found[at, 1::2] = ends.min(axis=0), ends.max(axis=0)
        return found


def columns_of(pieces: list[CoedgePiece]) -> PieceColumns:
    straight = np.array([p.straight is not None and p.last > p.first for p in pieces], dtype=bool)
    corners = [np.zeros((2, 2)) if p.straight is None else p.straight for p in pieces]
    boxes = np.reshape([(p.low, p.high) for p in pieces], (-1, 2, 2))
    return PieceColumns(
        np.array([p.edge for p in pieces], dtype=np.int64),
        np.array([p.chart for p in pieces], dtype=np.int64),
        np.reshape([(p.first, p.last) for p in pieces], (-1, 2)),
        np.moveaxis(boxes, 1, 2).reshape(-1, 4),
        straight,
        np.reshape(corners, (-1, 2, 2)),
    )


def pieces_of(boundary: PackedParts, charts: dict[int, FaceChart]) -> list[CoedgePiece]:
    """The pieces of all trimming curves; on periodic charts with their images a turn away that the
    chart's rectangle reaches."""
    coedges = [(number, k) for number in charts for k in coedge_range(boundary, number)]
    ends = {coedge: _ends(boundary, coedge) for _, coedge in coedges}
    bounds, boxes = _bounds(boundary, ends), _boxes(boundary, ends)
    found = []
    for number, coedge in coedges:
        chart = charts[number]
        for piece in _pieces(
            boundary, (number, coedge), ends[coedge], bounds[coedge], boxes[coedge]
        ):
            found += _shifted(piece, chart) if chart.surface.periodic else [piece]
    return found


def _edge_of(boundary: PackedParts, coedge: int) -> int:
    row = int(boundary.ints[L.COEDGES]) + L.COEDGE_STRIDE * coedge
    return int(boundary.ints[row + L.COEDGE_EDGE])


def _ends(boundary: PackedParts, coedge: int) -> Array:
    """Ascending parameters (n + 1,) that part a packed coedge."""
    kind, first, last, _ = packed_pcurve(boundary, coedge)
    ends = np.linspace(first, last, PARTS[kind] + 1)
    edge = _edge_of(boundary, coedge)
    curve = boundary.edge_parts[edge].curve if edge >= 0 else None
    if curve is None or isinstance(curve, Line | ConicArc):
        return ends
    spans = [t for t in curve.spans().tolist() if first < t < last]
    return np.unique(np.concatenate([ends, spans]))


def _bounds(boundary: PackedParts, ends: dict[int, Array]) -> dict[int, Array]:
    """(n, 4) bounds of derivatives along each part of coedges, of all parts of an edge at once."""
    found = {coedge: np.zeros((len(t) - 1, 4)) for coedge, t in ends.items()}
    of_edge: dict[int, list[int]] = {}
    for coedge in ends:
        of_edge.setdefault(_edge_of(boundary, coedge), []).append(coedge)
    for edge, coedges in of_edge.items():
        if edge < 0:
            continue  # a collapsed side
        ranges = [part for coedge in coedges for part in pairwise(ends[coedge].tolist())]
        rows = curve_derivatives(boundary.edge_parts[edge].curve, ranges)
        counts = np.cumsum([len(found[coedge]) for coedge in coedges])
        found.update(zip(coedges, np.split(rows, counts[:-1]), strict=True))
    return found


def _shifted(piece: CoedgePiece, chart: FaceChart) -> list[CoedgePiece]:
    u0, u1 = chart.rectangle[:2]
    found = []
    for turns in (-1, 0, 1):
        move = np.array([2.0 * np.pi * turns, 0.0])
        low, high = piece.low + move, piece.high + move
        if turns and (high[0] < u0 - TURN_SPARE or low[0] > u1 + TURN_SPARE):
            continue
        straight = None if piece.straight is None else piece.straight + move
        found.append(
            CoedgePiece(piece.coedge, piece.chart, piece.edge, piece.first, piece.last, low, high,
                  piece.bend, float(move[0]), piece.bounds, straight)
        )  # fmt: skip
    return found


def _pieces(
    boundary: PackedParts, of: tuple[int, int], ends: Array, bounds: Array, boxes: Boxes
) -> list[CoedgePiece]:
    """The pieces of a coedge, `of` (chart, coedge)."""
    chart, coedge = of
    kind = packed_pcurve(boundary, coedge)[0]
    edge = _edge_of(boundary, coedge)
    found = []
    lows, highs, bends = boxes
    for k, (a, b) in enumerate(pairwise(ends.tolist())):
        low, high, straight = lows[k], highs[k], None
        if kind == L.LINE and (bends[k] == 0.0).all():
            straight = np.array(
                [coedge_parameters(boundary.ints, boundary.reals, coedge, t)[:2] for t in (a, b)]
            )
            # along an isoline the level is one number, free of the box's margin
            low, high = straight.min(axis=0), straight.max(axis=0)
        found.append(
            CoedgePiece(coedge, chart, edge, a, b, low, high, bends[k], 0.0, bounds[k], straight)
        )
    return found


def _boxes(boundary: PackedParts, ends: dict[int, Array]) -> dict[int, Boxes]:
    """Of packed trimming curves the boxes of parts, of all Bezier ones of a degree at once."""
    found: dict[int, Boxes] = {}
    alike: dict[int, list[tuple[int, Array]]] = {}
    for coedge, ts in ends.items():
        kind, _, _, matrix = packed_pcurve(boundary, coedge)
        if kind == L.BEZIER:
            alike.setdefault(len(matrix), []).append((coedge, matrix))
        else:
            found[coedge] = _plain_boxes(kind, matrix, ts)
    for n, group in alike.items():
        every, nets = [ends[coedge] for coedge, _ in group], [net for _, net in group]
        counts = [len(ts) - 1 for ts in every]
        shares = [(ts - ts[0]) / (ts[-1] - ts[0]) for ts in every]
        first, last = (
            np.concatenate([s[part] for s in shares]) for part in (slice(-1), slice(1, None))
        )
        parts = segments(n - 1, first, last) @ np.repeat(nets, counts, axis=0)
        wide = np.concatenate([np.diff(ts) for ts in every])[:, None]
        rows = *bezier_box(parts), bezier_bend(parts) / wide**2 * (1.0 + BEND_SPARE)
        split = (np.split(each, np.cumsum(counts)[:-1]) for each in rows)
        found.update(zip([coedge for coedge, _ in group], zip(*split, strict=True), strict=True))
    return found


def _plain_boxes(kind: int, matrix: Array, ends: Array) -> Boxes:
    """Those of a line or a conic."""
    if (matrix[2, :2] != 0.0).any():
        bends = pcurve_bends(kind, matrix, ends)
    else:
        across = np.hypot(matrix[:2, 0], matrix[:2, 1]) / abs(float(matrix[2, 2]))
        bend = np.zeros(2) if kind == L.LINE else across * (1.0 + BEND_SPARE)
        bends = np.tile(bend, (len(ends) - 1, 1))
    return *pcurve_boxes(kind, matrix, ends), bends


def edge_ranges(curve: Curve, arc: float, longest: float) -> list[tuple[float, float]]:
    """An edge's parameter in ranges for leaves, each of which turns by no more than `arc`, radians,
    and is no longer than `longest`."""
    spans = list(pairwise(curve.spans().tolist()))
    if not isinstance(curve, Line | ConicArc):
        return _halved(curve, spans, arc, longest)
    found = []
    for a, b in spans:
        if isinstance(curve, ConicArc):
            parts = int(np.ceil((b - a) / arc))
        else:
            reach = float(np.linalg.norm(curve.point(b) - curve.point(a)))
            parts = int(np.ceil(reach / longest))
        steps = np.linspace(a, b, max(parts, 1) + 1)
        found += list(pairwise(steps.tolist()))
    return found


def _halved(
    curve: Curve, spans: list[tuple[float, float]], arc: float, longest: float
) -> list[tuple[float, float]]:
    """Spans halved until each turns little; `BLIND_HALVINGS` times where no bounds are known."""
    found: list[tuple[float, float]] = []
    waiting = spans
    for depth in range(MOST_HALVINGS + 1):
        again: list[tuple[float, float]] = []
        speeds = np.linalg.norm(curve.jets(np.mean(waiting, axis=1))[:, 1], axis=1)
        bounds = curve_derivatives(curve, waiting)
        for (a, b), d, speed in zip(waiting, bounds, speeds.tolist(), strict=True):
            known = bool(np.isfinite(d[:2]).all())
            if known:
                done = d[1] * (b - a) <= arc * speed and d[0] * (b - a) <= longest
            else:
                done = depth == BLIND_HALVINGS
            if done or depth == MOST_HALVINGS:
                found.append((a, b))
            else:
                middle = 0.5 * (a + b)
                again += [(a, middle), (middle, b)]
        if not again:
            break
        waiting = again
    return sorted(found)
