"""How far the image of a trimming curve may be from its edge: a proven bound.

Between two samples of g(t) = S(p(t)) - C(t), which are h apart, |g| is at most the greater of the
two plus h² / 8 times the greatest |g''|. Interval arithmetic bounds g'' over each span, where it
nearly cancels. Spans that leave too much are halved.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from standoff.bodies.topology import Apex
from standoff.cad.closed_bounds import closed_bound
from standoff.cad.polynomial_bounds import polynomial_bound
from standoff.cad.tolerances import BOUND_FLOOR, BOUND_SHARE
from standoff.geometry.boxes import Boxes
from standoff.geometry.curves import Curve
from standoff.geometry.intervals import Interval, cos, interval, sin
from standoff.geometry.net_bounds import curve_nets
from standoff.geometry.nurbs_curves import NurbsCurve
from standoff.geometry.nurbs_pcurves import NurbsPcurve
from standoff.geometry.patch_bounds import cut
from standoff.geometry.pcurves import Pcurve
from standoff.geometry.surfaces import Surface
from standoff.geometry.validation import Array
from standoff.kernels.body import layout as L

# Spans of an edge at first, how often they are halved at most, and how many are open at most.
EPS = float(np.finfo(np.float64).eps)
FIRST_SPANS = 32
MOST_HALVINGS = 14
MOST_OPEN = 2048


class Parts(NamedTuple):
    """The Bezier parts (m, p + 1, 4) of a trimming curve, in z = 0, and (m + 1,) their ends."""

    blocks: Array
    breaks: Array


def miss_bound(pcurve: Pcurve, curve: Curve, surface: Surface, size: float) -> float:
    """A bound of |S(p(t)) - C(t)| over an edge, length.

    Parameters
    ----------
    pcurve : Pcurve
        With the edge's parameter.
    curve : Curve
    surface : Surface
    size : float
        Of the part, length.

    Returns
    -------
    float
        Infinite where the surface has no bounds.
    """
    closed = closed_bound(pcurve, curve, surface)
    if closed is not None and closed <= BOUND_FLOOR * size:
        return closed
    proven = None
    if isinstance(curve, NurbsCurve):
        proven = polynomial_bound(pcurve, curve, surface)
    if closed is not None or proven is not None:
        return min(x for x in (closed, proven) if x is not None)
    return _interval_bound(pcurve, curve, surface, size)


def side_miss(surface: Surface, apex: Apex, vertex: Array) -> float:
    """A bound of how far a collapsed side of a surface is from its vertex, length."""
    along, across = (0, 1) if apex.side[0] == "v" else (1, 0)
    spans = np.linspace(apex.lo, apex.hi, FIRST_SPANS + 1)
    rows = np.empty((FIRST_SPANS, 4))
    rows[:, 2 * along], rows[:, 2 * along + 1] = spans[:-1], spans[1:]
    rows[:, 2 * across : 2 * across + 2] = apex.level
    away = _jets(surface, rectangles_boxes(rows))[0] - interval(vertex[:, None])
    off = float(np.linalg.norm(away.magnitude, axis=0).max())
    return off if np.isfinite(off) else np.inf


def _interval_bound(pcurve: Pcurve, curve: Curve, surface: Surface, size: float) -> float:
    flat = None
    ends = np.asarray(curve.spans(), dtype=np.float64)
    if isinstance(pcurve, NurbsPcurve):
        rows = np.array([span.matrix for span in pcurve.spans])
        breaks = np.array([span.first for span in pcurve.spans] + [pcurve.spans[-1].last])
        flat = Parts(np.insert(rows, 2, 0.0, axis=2), breaks)
        ends = np.union1d(ends, breaks)
    ends = np.clip(ends, curve.first, curve.last)
    each = max(2, FIRST_SPANS // len(ends))
    ts = np.unique([np.linspace(a, b, each + 1) for a, b in pairwise(np.unique(ends))])
    low, high = ts[:-1], ts[1:]
    proven = 0.0
    for halving in range(MOST_HALVINGS + 1):
        places, which = np.unique(np.concatenate([low, high]), return_inverse=True)
        at = misses(pcurve, curve, surface, places)[which]
        at = np.maximum(at[: len(low)], at[len(low) :])
        rest = (high - low) ** 2 / 8.0 * _second(pcurve, flat, curve, surface, Interval(low, high))
        rest = np.where(np.isnan(rest), np.inf, rest)
        allowed = max(BOUND_FLOOR * size, BOUND_SHARE * max(float(at.max()), proven))
        open_ = rest > allowed
        if halving == MOST_HALVINGS or open_.sum() > MOST_OPEN:
            open_[:] = False
        proven = max(proven, float((at + rest)[~open_].max(initial=0.0)))
        if not open_.any():
            return proven
        low, high = low[open_], high[open_]
        middle = 0.5 * (low + high)
        low, high = np.concatenate([low, middle]), np.concatenate([middle, high])
    return proven


def misses(piece: Pcurve, curve: Curve, surface: Surface, ts: Array) -> Array:
    """(n,) distances of a trimming curve's image from its edge at parameters, length."""
    away = surface.points(piece.places(ts)) - curve.points(ts)
    return np.asarray(np.linalg.norm(away, axis=1))


def _second(
    pcurve: Pcurve, flat: Parts | None, curve: Curve, surface: Surface, t: Interval
) -> Array:
    """(n,) bounds of |g''| over spans of the parameter."""
    u, v = _parameters(pcurve, flat, t)
    boxes = Boxes(np.stack([u[0].lo, v[0].lo], 1), np.stack([u[0].hi, v[0].hi], 1))
    _, xu, xv, xuu, xuv, xvv = _jets(surface, boxes)
    with np.errstate(all="ignore"):
        total = xuu * u[1] ** 2 + xuv * (u[1] * v[1] * 2.0) + xvv * v[1] ** 2
        total = total + xu * u[2] + xv * v[2] - curve.jets_over(t)[:, 2]
        return np.asarray(np.sqrt((total.magnitude**2).sum(axis=0)) * (1.0 + 4.0 * EPS))


def _parameters(
    pcurve: Pcurve, flat: Parts | None, t: Interval
) -> tuple[list[Interval], list[Interval]]:
    """(u, u', u'') and (v, v', v'') over spans of the parameter."""
    if flat is not None:
        jets = curve_nets(flat.blocks, flat.breaks, t).jets()
        return [jets[0, k] for k in (0, 1, 3)], [jets[1, k] for k in (0, 1, 3)]
    one, zero = interval(np.ones_like(t.lo)), interval(np.zeros_like(t.lo))
    c, s = cos(t), sin(t)
    lines = [(t, zero, one), (one, zero, zero), (zero, zero, zero)]
    rounds = [(c, s, one), (-s, c, zero), (-c, -s, zero)]
    columns = lines if pcurve.kind == L.LINE else rounds
    a, b, w = (
        [sum((x * float(m) for x, m in zip(column, row, strict=True)), zero) for column in columns]
        for row in pcurve.matrix
    )
    return _quotient(a, w), _quotient(b, w)


def _quotient(a: list[Interval], w: list[Interval]) -> list[Interval]:
    value = a[0] / w[0]
    slope = (a[1] - value * w[1]) / w[0]
    return [value, slope, (a[2] - slope * w[1] * 2.0 - value * w[2]) / w[0]]


def _jets(surface: Surface, boxes: Boxes) -> list[Interval]:
    """Jets over boxes that breaks may cross: of all parts of each."""
    u0, u1, v0, v1 = surface.domain
    rectangles = np.stack([boxes.low[:, 0], boxes.high[:, 0], boxes.low[:, 1], boxes.high[:, 1]], 1)
    rectangles = np.clip(rectangles, [u0, u0, v0, v0], [u1, u1, v1, v1])
    if surface.periodic:
        rectangles[:, 0], rectangles[:, 1] = boxes.low[:, 0], boxes.high[:, 0]
    parts, owners = cut(rectangles_boxes(rectangles), surface.analytic_breaks())
    jets = surface.body_jets(parts)
    shape = (*jets.lo.shape[:2], len(boxes))
    low, high = np.full(shape, np.inf), np.full(shape, -np.inf)
    for k in range(shape[0]):
        for m in range(shape[1]):
            np.minimum.at(low[k, m], owners, jets.lo[k, m])
            np.maximum.at(high[k, m], owners, jets.hi[k, m])
    return [Interval(low[:, m], high[:, m]) for m in range(6)]


def rectangles_boxes(rectangles: Array) -> Boxes:
    """Rows (u0, u1, v0, v1) as boxes."""
    return Boxes(rectangles[:, [0, 2]], rectangles[:, [1, 3]])
