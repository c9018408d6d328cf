"""How far the image of a trimming curve may be from its edge: a proven bound."""

from __future__ import annotations

import numpy as np

from standoff.bodies.topology import Apex
from standoff.cad.closed_bounds import closed_bound
from standoff.cad.polynomial_bounds import polynomial_bound
from standoff.cad.tolerances import BOUND_FLOOR
from standoff.geometry.boxes import Boxes
from standoff.geometry.curves import Curve
from standoff.geometry.intervals import Interval, interval
from standoff.geometry.patch_bounds import cut
from standoff.geometry.pcurves import Pcurve
from standoff.geometry.surfaces import Surface
from standoff.geometry.validation import Array

# Parts of a collapsed side.
SIDE_PARTS = 32


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
    proven = polynomial_bound(pcurve, curve, surface, size)
    return min((x for x in (closed, proven) if x is not None), default=np.inf)


def side_miss(surface: Surface, apex: Apex, vertex: Array) -> float:
    """A bound of how far a collapsed side of a surface is from its vertex, length."""
    along, across = (0, 1) if apex.side[0] == "v" else (1, 0)
    spans = np.linspace(apex.lo, apex.hi, SIDE_PARTS + 1)
    rows = np.empty((SIDE_PARTS, 4))
    rows[:, 2 * along], rows[:, 2 * along + 1] = spans[:-1], spans[1:]
    rows[:, 2 * across : 2 * across + 2] = apex.level
    away = _jets(surface, rectangles_boxes(rows))[0] - interval(vertex[:, None])
    off = float(np.linalg.norm(away.magnitude, axis=0).max())
    return off if np.isfinite(off) else np.inf


def misses(piece: Pcurve, curve: Curve, surface: Surface, ts: Array) -> Array:
    """(n,) distances of a trimming curve's image from its edge at parameters, length."""
    away = surface.points(piece.places(ts)) - curve.points(ts)
    return np.asarray(np.linalg.norm(away, axis=1))


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
