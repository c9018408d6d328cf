"""Bounds of the derivatives of surfaces and curves over pieces: to the third order for analytic
kinds, to the second with its spread for all others."""

from __future__ import annotations

from collections.abc import Sequence
from math import comb

import numpy as np

from standoff.geometry.boxes import Boxes
from standoff.geometry.curves import ConicArc, Curve, Line, RationalBezier
from standoff.geometry.interval_vectors import length, mapped
from standoff.geometry.intervals import Interval, interval
from standoff.geometry.net_bounds import CutNets
from standoff.geometry.nurbs import NurbsSurface
from standoff.geometry.nurbs_curves import NurbsCurve
from standoff.geometry.series import Series, power
from standoff.geometry.surface_curves import SurfaceCurve
from standoff.geometry.surfaces import Surface
from standoff.geometry.swept import Extrusion, Revolution
from standoff.kernels.body import layout as L
from standoff.solids.spatial.tolerances import DERIVATIVE_INFLATION
from standoff.typing import Array

# Columns: first (2), second (3), third (4) derivatives, spread of the second (3).
COLUMNS = 12
# Partial derivatives in the order of the columns.
ORDERS = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3))
ORDERS_ALONG = tuple((k, 0) for k in range(4))
FIRST, SECOND, THIRD, SPREAD = slice(0, 2), slice(2, 5), slice(5, 9), slice(9, 12)


def surface_derivatives(surface: Surface, rows: Array) -> Array:
    """(n, 12) bounds over rectangles (n, 4) that no analytic break crosses."""
    made = {
        L.PLANE: _plane,
        L.CYLINDER: _cylinder,
        L.CONE: _cone,
        L.TORUS: _torus,
        L.SPHERE: _sphere,
        L.NURBS: _nurbs,
        L.REVOLUTION: _revolution,
        L.EXTRUSION: _extrusion,
    }.get(surface.kind, _any)
    return made(surface, rows) * (1.0 + DERIVATIVE_INFLATION)


def _norms(surface: Surface) -> tuple[float, float, float]:
    """Greatest length of the map of a unit vector of the plane (x, y); of z; of any."""
    a = surface.linear
    flat = float(np.linalg.norm(a[:, :2], 2))
    return flat, float(np.linalg.norm(a[:, 2])), float(np.linalg.norm(a, 2))


def _plane(surface: Surface, rows: Array) -> Array:
    found = np.zeros((len(rows), COLUMNS))
    found[:, FIRST] = np.linalg.norm(surface.linear[:, :2], axis=0)
    return found


def _cylinder(surface: Surface, rows: Array) -> Array:
    flat, along, _ = _norms(surface)
    found = np.zeros((len(rows), COLUMNS))
    found[:, 0], found[:, 1], found[:, 2], found[:, 5] = flat, along, flat, flat
    return found


def _cone(surface: Surface, rows: Array) -> Array:
    flat, along, most = _norms(surface)
    v = np.abs(rows[:, 2:]).max(axis=1)
    found = np.zeros((len(rows), COLUMNS))
    found[:, 0], found[:, 1] = flat * v, min(flat + along, np.sqrt(2.0) * most)
    found[:, 2], found[:, 3] = flat * v, flat
    found[:, 5], found[:, 6] = flat * v, flat
    return found


def _torus(surface: Surface, rows: Array) -> Array:
    _, _, most = _norms(surface)
    major, minor = surface.data
    ring, tube = most * (major + minor), most * minor
    found = np.zeros((len(rows), COLUMNS))
    found[:, :] = [ring, tube, ring, tube, tube, ring, tube, tube, tube, 0.0, 0.0, 0.0]
    return found


def _sphere(surface: Surface, rows: Array) -> Array:
    _, _, most = _norms(surface)
    u = Series.variable(Interval(rows[:, 0], rows[:, 1]), 0, 3)
    v = Series.variable(Interval(rows[:, 2], rows[:, 3]), 1, 3)
    s = power(u**2 + v**2 + 1.0, -0.5)
    parts = [u * s, v * s, s]
    factors = [1.0, 1.0, 2.0, 1.0, 2.0, 6.0, 2.0, 2.0, 6.0]
    found = np.zeros((len(rows), COLUMNS))
    for k, factor in enumerate(factors):
        size = length(*(Interval(p.lo[k + 1], p.hi[k + 1]) for p in parts))
        found[:, k] = factor * most * size.hi
    return found


def _nurbs(surface: Surface, rows: Array) -> Array:
    assert isinstance(surface, NurbsSurface)
    nets = surface.nets_over(Boxes(rows[:, [0, 2]], rows[:, [1, 3]]))
    found = np.zeros((len(rows), COLUMNS))
    found[:, : len(ORDERS) - 1] = _of_nets(nets, surface.linear, ORDERS)
    return found


def _of_nets(nets: CutNets, linear: Array, orders: Sequence[tuple[int, int]]) -> Array:
    """(n, k - 1) bounds of derivatives of k orders, the lowest first, from the nets of the
    homogeneous ones, by Leibniz's rule for x w."""
    if nets.polynomial:
        return _of_polynomials(nets, linear, orders)
    found = np.zeros((len(nets.h), len(orders) - 1))
    centre = interval(nets.points.middle.mean(axis=1)[:, None])
    h, w = {}, {}
    for order in orders:
        net = _row(nets.net(*order))
        h[order], w[order] = _hull(net[:3] - centre * net[3]), _hull(net[3])
    x = {(0, 0): _hull(nets.points - centre)}
    for k, (a, b) in enumerate(orders[1:]):
        total = h[a, b]
        for i, j in orders:
            if i <= a and j <= b and (i, j) != (a, b):
                factor = float(comb(a, i) * comb(b, j))
                total = total - x[i, j] * w[a - i, b - j] * factor
        x[a, b] = total / w[0, 0]
        mapped_ = mapped(linear, x[a, b])
        found[:, k] = length(mapped_[0], mapped_[1], mapped_[2]).hi
    return np.where(np.isfinite(found), found, np.inf)


def _of_polynomials(nets: CutNets, linear: Array, orders: Sequence[tuple[int, int]]) -> Array:
    """The same of polynomials, whose derivatives are no longer than the longest of their nets."""
    found = np.zeros((len(nets.h), len(orders) - 1))
    w, most = abs(float(nets.h.flat[3])), float(np.linalg.norm(linear, 2))
    degrees = [size - 1 for size in nets.h.shape[1:3]]
    # weights that are one number up to roundoff move a point of the net by this
    uneven = np.ptp(nets.h[..., 3]) / w * np.linalg.norm(nets.h[..., :3], axis=3).max(axis=(1, 2))
    for k, order in enumerate(orders[1:]):
        net, moved = nets.net(*order), most * uneven
        rows = np.tensordot(linear, net.middle[:3], 1)
        off = most * np.linalg.norm(net.radius[:3], axis=0)
        found[:, k] = (np.linalg.norm(rows, axis=0) + off).max(axis=(1, 2))
        for degree, width, times in zip(degrees, nets.widths, order, strict=True):
            moved = moved * (2.0 * degree / width) ** times
        found[:, k] = (found[:, k] + moved) / w
    return np.where(np.isfinite(found), found, np.inf)


def _row(net: Interval) -> Interval:
    """(c, k, n) coefficients in one row, from (c, n, i, j)."""
    low, high = (np.moveaxis(e.reshape(*e.shape[:2], -1), 1, 2) for e in (net.lo, net.hi))
    return Interval(low, high)


def _hull(coefficients: Interval) -> Interval:
    """Bounds of values from those of the coefficients on the axis before the last."""
    return Interval(coefficients.lo.min(axis=-2), coefficients.hi.max(axis=-2))


def _revolution(surface: Surface, rows: Array) -> Array:
    assert isinstance(surface, Revolution)
    profile, most = surface.profile, _norms(surface)[2]
    ranges = [(float(a), float(b)) for a, b in rows[:, 2:]]
    c = curve_derivatives(profile, ranges)
    r = profile.jets_over(Interval(rows[:, 2], rows[:, 3]))[0, 0].magnitude
    found = np.zeros((len(rows), COLUMNS))
    columns = (r, c[:, 0], r, c[:, 0], c[:, 1], r, c[:, 0], c[:, 1], c[:, 2])
    for k, column in enumerate(columns):
        found[:, k] = most * column
    found[:, SPREAD.stop - 1] = most * c[:, 3]
    return np.where(np.isfinite(found), found, np.inf)


def _extrusion(surface: Surface, rows: Array) -> Array:
    assert isinstance(surface, Extrusion)
    most = _norms(surface)[2]
    c = curve_derivatives(surface.profile, [(float(a), float(b)) for a, b in rows[:, :2]])
    found = np.zeros((len(rows), COLUMNS))
    found[:, 0], found[:, 2], found[:, 5] = most * c[:, 0], most * c[:, 1], most * c[:, 2]
    found[:, 1] = most * float(np.linalg.norm(surface.direction))
    found[:, SPREAD.start] = most * c[:, 3]
    return np.where(np.isfinite(found), found, np.inf)


def _any(surface: Surface, rows: Array) -> Array:
    jets = surface.body_jets(Boxes(rows[:, [0, 2]], rows[:, [1, 3]]))
    found = np.zeros((len(rows), COLUMNS))
    for k in range(5):
        part = jets[:, k + 1]
        found[:, k] = length(part[0], part[1], part[2]).hi
        if k >= 2:
            found[:, SPREAD.start + k - 2] = np.linalg.norm(part.hi - part.lo, axis=0)
    return np.where(np.isfinite(found), found, np.inf)


def curve_derivatives(curve: Curve, pieces: Sequence[tuple[float, float]]) -> Array:
    """(n, 4) bounds of |x_t|, |x_tt|, |x_ttt|, and the spread of x_tt, over ranges of t."""
    found = np.zeros((len(pieces), 4))
    if isinstance(curve, Line):
        found[:, 0] = np.linalg.norm(curve.basis()[:, 0])
    elif isinstance(curve, ConicArc):
        found[:, :3] = np.linalg.norm(curve.basis()[:, :2], 2)
    elif isinstance(curve, RationalBezier | NurbsCurve):
        ends = np.array(pieces)
        nets = curve.nets_over(Interval(ends[:, 0], ends[:, 1]))
        found[:, :3] = _of_nets(nets, np.eye(3), ORDERS_ALONG)
    elif isinstance(curve, SurfaceCurve):
        found[:] = [_on_surface(curve, a, b) for a, b in pieces]
    else:
        ends = np.array(pieces)
        jets = curve.jets_over(Interval(ends[:, 0], ends[:, 1]))
        for k in range(2):
            part = jets[:, k + 1]
            found[:, k] = length(part[0], part[1], part[2]).hi
        found[:, 3] = np.linalg.norm(jets.hi[:, 2] - jets.lo[:, 2], axis=0)
    return np.where(np.isfinite(found), found, np.inf) * (1.0 + DERIVATIVE_INFLATION)


def _on_surface(curve: SurfaceCurve, first: float, last: float) -> list[float]:
    """Of a straight trimming curve's image on its surface; nothing is known of others."""
    pcurve = curve.pcurve
    if pcurve.kind != L.LINE or pcurve.matrix[2, 0] != 0.0:
        return [np.inf] * 4
    slope = pcurve.matrix[:2, 0] / pcurve.matrix[2, 2]
    ends = np.array([pcurve.point(first)[:2], pcurve.point(last)[:2]])
    row = np.array([[*ends[:, 0], *ends[:, 1]]])
    row = np.sort(row.reshape(1, 2, 2), axis=2).reshape(1, 4)
    b = surface_derivatives(curve.surface, row)[0]
    u, v = np.abs(slope)
    second = b[2] * u * u + 2.0 * b[3] * u * v + b[4] * v * v
    third = b[5] * u**3 + 3.0 * b[6] * u * u * v + 3.0 * b[7] * u * v * v + b[8] * v**3
    spread = b[9] * u * u + 2.0 * b[10] * u * v + b[11] * v * v
    return [float(b[0] * u + b[1] * v), float(second), float(third), float(spread)]
