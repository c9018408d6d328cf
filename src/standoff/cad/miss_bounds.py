"""How far the image of a trimming curve may be from its edge: a proven bound."""

from __future__ import annotations

import numpy as np

from standoff.bodies.topology import Apex
from standoff.cad.closed_bounds import closed_bound
from standoff.cad.polynomial_bounds import polynomial_bound
from standoff.cad.tolerances import BOUND_FLOOR
from standoff.geometry.curves import Curve
from standoff.geometry.pcurves import Pcurve
from standoff.geometry.surfaces import Surface
from standoff.typing import Array

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
    low, high = surface.extents(rows, np.eye(3))
    away = np.maximum(np.abs(low - vertex[:, None]), np.abs(high - vertex[:, None]))
    off = float(np.linalg.norm(away, axis=0).max())
    return off if np.isfinite(off) else np.inf


def misses(piece: Pcurve, curve: Curve, surface: Surface, ts: Array) -> Array:
    """(n,) distances of a trimming curve's image from its edge at parameters, length."""
    away = surface.points(piece.places(ts)) - curve.points(ts)
    return np.asarray(np.linalg.norm(away, axis=1))
