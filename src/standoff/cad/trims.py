"""Trimming curves of a face, in its own (u, v) and in its edges' own parameters.

They are exact where they are lines, conics or splines in (u, v): from the kinds of curve and
surface, or as the file has them. Elsewhere they are fitted, and how far they miss their edges is
bounded in ``miss_bounds``.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from standoff.bodies.tolerances import DOMAIN_SPARE
from standoff.cad.curves import (
    Converted,
    NoExactForm,
    approximated,
    basis_of,
    breaks_of,
    interpolated,
    spline_of,
)
from standoff.cad.miss_bounds import misses
from standoff.cad.opencascade import coordinates
from standoff.cad.surfaces import Carrier
from standoff.cad.tolerances import (
    AT_POLE,
    CONSTANT,
    FITTED_TRIM,
    KEPT_TRIM,
    SAME_KNOT,
    SAME_TANGENTS,
)
from standoff.errors import StandoffError
from standoff.geometry.curves import FULL_TURN, ConicArc, Curve, Line
from standoff.geometry.exact_pcurves import pcurve_of
from standoff.geometry.knots import GREATEST_DEGREE
from standoff.geometry.nurbs_curves import NurbsCurve
from standoff.geometry.nurbs_pcurves import NurbsPcurve
from standoff.geometry.pcurves import Pcurve
from standoff.geometry.surfaces import Surface
from standoff.kernels.body import layout as L
from standoff.kernels.entries.queries import surface_jets
from standoff.typing import Array

Inverse = Callable[[Array], Array]

# How often the spans of a fitted trimming curve are halved at most, and how many are halved.
FIT_HALVINGS, MOST_SPANS = 12, 64
# With more spans than this, a spline is smooth at its knots.
FEW_SPANS = 5
# A trimming curve is near enough at this many times its edge's own distance from the surface.
NEAR_ENOUGH = 1.5
# Points of each span at which a trimming curve is compared with its edge.
COMPARED = 33
# Points of a trimming curve that tell whether it leaves its surface's domain, by a little.
EXTENT_POINTS = 513
# Steps of Newton's method from the file's trimming curve to the nearest points of a surface.
FEET_STEPS = 12


def trim(edge: Converted, on: Carrier, geometry: Any, size: float) -> tuple[Pcurve | None, str]:
    """The trimming curve of an edge, and how it was made: "exact", "file" or "fitted".

    Raises NoExactForm: there is neither a trimming curve in the file nor a closed form to fit.

    Parameters
    ----------
    edge : Converted
    on : Carrier
        Its face's.
    geometry : Geom2d_Curve or None
        The file's trimming curve.
    size : float
        Of the part, length.

    Returns
    -------
    Pcurve or None
        None where the library finds the exact one by itself.
    str
    """
    curve, surface = edge.curve, on.surface
    if surface.projection is not None and isinstance(curve, Line | ConicArc):
        try:
            pcurve_of(curve, surface)
        except StandoffError:
            pass
        else:
            return None, "exact"
    if on.kind == "plane":
        assert on.inverse is not None
        assert isinstance(curve, NurbsCurve)
        flat = on.inverse(curve.control_points)
        return NurbsPcurve(flat, curve.knots, curve.weights), "exact"
    found = of_file(geometry, edge, on) if geometry is not None and edge.affine else None
    if on.inverse is None and found is None:
        raise NoExactForm("an edge without a trimming curve on it")
    missed = np.inf if found is None else miss(found, curve, surface)
    if found is not None and on.inverse is None:
        at = found.places(np.linspace(curve.first, curve.last, EXTENT_POINTS))
        low, high = limits_of(on)
        room = DOMAIN_SPARE * np.where(np.isfinite(high - low), high - low, 0.0)
        inside = np.all((low - room <= at) & (at <= high + room))
        missed = missed if inside else np.inf
    if on.inverse is None and missed <= KEPT_TRIM * size:
        assert found is not None
        return found, "file"
    inverse = _inverse(on, curve, found)
    enough = near_enough(curve, surface, inverse, size)
    if found is not None and missed <= enough:
        return found, "file"
    try:
        fitted = fit(curve, on, inverse, hint(geometry, edge, on), enough)
    except StandoffError:  # its points have no smooth trimming curve
        if found is None:
            raise
        return found, "file"
    if found is not None and missed <= miss(fitted, curve, surface):
        return found, "file"
    return fitted, "fitted"


def _inverse(on: Carrier, curve: Curve, found: Pcurve | None) -> Inverse:
    """From parameters of a curve to those of its points' feet on a surface, (n, 2): in closed form,
    or from the file's trimming curve, which tells about where they are."""
    closed = on.inverse
    if closed is not None:
        return lambda ts: closed(curve.points(ts))
    assert found is not None
    return lambda ts: feet(on, curve.points(ts), found.places(ts))


def feet(on: Carrier, points: Array, near: Array) -> Array:
    """Parameters (n, 2) of points' feet on a surface, within its domain; from parameters near them
    by Newton's method. Where it gets no nearer, they stay."""
    surface = on.surface
    low, high = limits_of(on)
    ranges = np.where(np.isfinite(high - low), high - low, 1.0)
    at, best = np.clip(near, low, high), near
    least = np.full(len(points), np.inf)
    for _ in range(FEET_STEPS):
        jets = np.empty((len(points), 18))
        surface_jets(surface.reals, surface.kind, 0, np.ascontiguousarray(at), jets)
        away, xu, xv = points - jets[:, :3], jets[:, 3:6], jets[:, 6:9]
        off = np.linalg.norm(away, axis=1)
        nearer = off < least
        if not nearer.any():
            break
        best = np.where(nearer[:, None], at, best)
        least = np.minimum(off, least)
        metric = [np.sum(a * b, axis=1) for a, b in ((xu, xu), (xu, xv), (xv, xv))]
        slopes = [np.sum(a * away, axis=1) for a in (xu, xv)]
        area = metric[0] * metric[2] - metric[1] ** 2
        area = np.where(area > SAME_TANGENTS * metric[0] * metric[2], area, np.inf)
        # at a collapsed side the parameter along it is none of the point's: it stays
        speeds = np.sqrt(metric[0]) * ranges[0], np.sqrt(metric[2]) * ranges[1]
        moves = [speeds[k] > AT_POLE * speeds[1 - k] for k in (0, 1)]
        step = [
            (metric[2] * slopes[0] - metric[1] * slopes[1]) / area,
            (metric[0] * slopes[1] - metric[1] * slopes[0]) / area,
        ]
        at = np.clip(at + np.stack(step, axis=1) * np.stack(moves, axis=1), low, high)
    return np.asarray(best)


def extent(edges: Sequence[tuple[Converted, Any]], on: Carrier) -> tuple[Array, Array]:
    """The lowest and highest parameters, (2,) each, that the file's trimming curves of edges have
    at samples; of splines whose control points lie within the surface's domain, at these."""
    low, high = limits_of(on)
    rows = [np.zeros((0, 2))]
    for edge, flat in edges:
        if flat is not None and edge.affine:
            poles = np.reshape(_poles(basis_of(flat)), (-1, 2))
            if not len(poles) or not np.all((low <= poles) & (poles <= high)):
                ts = edge.own(np.linspace(edge.curve.first, edge.curve.last, EXTENT_POINTS))
                poles = np.array([coordinates(flat.Value(t)) for t in ts.tolist()])
            rows.append(poles)
    uv = np.concatenate(rows)
    return uv.min(axis=0, initial=np.inf), uv.max(axis=0, initial=-np.inf)


def _poles(flat: Any) -> list[Array]:
    if flat.DynamicType().Name() not in ("Geom2d_BSplineCurve", "Geom2d_BezierCurve"):
        return []
    return [coordinates(flat.Pole(k)) for k in range(1, flat.NbPoles() + 1)]


def limits_of(on: Carrier) -> tuple[Array, Array]:
    """(lowest, highest) parameters of a surface's domain; an angle has none."""
    low, high = np.reshape(on.surface.domain, (2, 2)).T
    return np.where(on.angles, -np.inf, low), np.where(on.angles, np.inf, high)


def near_enough(curve: Curve, surface: Surface, inverse: Inverse, size: float) -> float:
    """What a trimming curve may miss its edge by at samples, length: little more than the edge is
    from the surface, as none is nearer."""
    ts = np.linspace(curve.first, curve.last, COMPARED)
    off = np.linalg.norm(curve.points(ts) - surface.points(inverse(ts)), axis=1)
    return NEAR_ENOUGH * float(off.max()) + FITTED_TRIM * size


def of_file(geometry: Any, edge: Converted, on: Carrier) -> Pcurve | None:
    """The file's own trimming curve, exactly; None where it has no such form."""
    flat = basis_of(geometry)
    kind = flat.DynamicType().Name()
    linear = on.to_own[:, :2]
    if kind == "Geom2d_Line":
        start, way = coordinates(flat.Location()), coordinates(flat.Direction())
        way = linear @ way / edge.scale
        return _line(on.own(start[None])[0] - way * edge.shift, way)
    if kind in ("Geom2d_Circle", "Geom2d_Ellipse"):
        return _lowered(flat, edge, on)
    if kind in ("Geom2d_BSplineCurve", "Geom2d_BezierCurve"):
        first, last = edge.own(np.array([edge.curve.first, edge.curve.last]))
        if flat.Degree() > GREATEST_DEGREE:
            return _lowered(flat, edge, on)
        turn = _turn_to(flat, float(first), float(last))
        if turn is None:
            return None
        points, knots, weights = spline_of(flat, float(first) + turn, float(last) + turn)
        knots = _over((knots - turn) * edge.scale + edge.shift, edge.curve)
        points = straightened(on.own(points))
        if len(points) == 2 and weights is None:
            return _straight(points, knots[0], knots[-1])
        try:
            found = NurbsPcurve(points, knots, weights)
            found.pieces(edge.curve.first, edge.curve.last)
        except StandoffError:  # a cusp, or weights far apart
            return _lowered(flat, edge, on)
        return found
    return None


def _turn_to(flat: Any, first: float, last: float) -> float | None:
    """What leads from an edge's parameters to where its trimming curve is given: nothing, or, in
    some files, a turn; None where it is given nowhere there. How well it fits is bounded later."""
    if flat.IsPeriodic():
        return 0.0
    for turn in (0.0, FULL_TURN, -FULL_TURN):
        start = max(first + turn, flat.FirstParameter())
        if start < min(last + turn, flat.LastParameter()):
            return turn
    return None


def _straight(ends: Array, first: float, last: float) -> Pcurve:
    """The line between two places, which many files write as a spline."""
    way = (ends[1] - ends[0]) / (last - first)
    return _line(ends[0] - way * first, way)


def _line(start: Array, way: Array) -> Pcurve:
    rows = [[way[0], 0.0, start[0]], [way[1], 0.0, start[1]], [0.0, 0.0, 1.0]]
    return Pcurve(L.LINE, np.array(rows))


def _over(knots: Array, curve: Curve) -> Array:
    """Knots that begin and end with a curve, to which they are mapped with rounding."""
    first, last = knots[0], knots[-1]
    return np.where(knots == first, curve.first, np.where(knots == last, curve.last, knots))


def _lowered(flat: Any, edge: Converted, on: Carrier) -> Pcurve:
    """A spline near the file's trimming curve, of a degree that the kernels have."""

    def places(ts: Array) -> Array:
        return on.own(np.array([coordinates(flat.Value(float(t))) for t in edge.own(ts)]))

    first, last = edge.own(np.array([edge.curve.first, edge.curve.last])).tolist()
    breaks = breaks_of(flat, first, last) * edge.scale + edge.shift
    found, knots = approximated(places, _over(breaks, edge.curve))
    return NurbsPcurve(straightened(found), knots)


def straightened(points: Array) -> Array:
    """Control points whose u, or v, is constant up to roundoff: exactly constant. Else a curve
    would have an inflection wherever roundoff turns it."""
    middle = points.mean(axis=0)
    same = np.ptp(points, axis=0) <= CONSTANT * (1.0 + np.abs(middle))
    return np.where(same, middle, points)


def hint(geometry: Any, edge: Converted, on: Carrier) -> Array | None:
    """About where the middle of the trimming curve is, which tells the turn of its angles."""
    if geometry is None:
        return None
    if edge.affine:
        t = float(edge.own(np.array([0.5 * (edge.curve.first + edge.curve.last)]))[0])
    else:
        t = 0.5 * (geometry.FirstParameter() + geometry.LastParameter())
    if not np.isfinite(t) or abs(t) > 1e50:
        return None
    found: Array = on.own(coordinates(geometry.Value(t))[None])[0]
    return found


def fit(
    curve: Curve, on: Carrier, inverse: Inverse, near: Array | None, enough: float
) -> NurbsPcurve:
    """A polynomial trimming curve through the parameters of a curve's points: over the whole, then
    between the places where they are not smooth; spans are halved that are not near enough,
    length."""

    closed = on.inverse

    def places(ts: Array) -> Array:
        uv = inverse(ts)
        for t, way in ((curve.first, 1.0), (curve.last, -1.0)):
            for row in uv[ts == t]:
                if closed is not None and on.angles[0] and _at_pole(on, row):
                    # there the angle is that in which the curve leaves
                    beside = curve.point(t) + way * curve.jet(t)[1]
                    uv[ts == t, 0] = closed(beside[None])[0, 0]
        for k in (0, 1):
            if on.angles[k]:
                uv[:, k] = np.unwrap(uv[:, k])
        return uv

    breaks = np.array([curve.first, curve.last])
    for halving in range(FIT_HALVINGS + 1):
        found = _fitted(places, breaks, on, near)
        ts = np.linspace(breaks[:-1], breaks[1:], COMPARED, axis=1).ravel()
        off = misses(found, curve, on.surface, ts).reshape(-1, COMPARED).max(axis=1)
        if halving == FIT_HALVINGS or len(breaks) > MOST_SPANS or off.max() <= enough:
            break
        if halving == 0 and (crossed := _crossed(places, curve, on.surface)):
            breaks = np.unique([*breaks, *crossed])
        else:
            middles = 0.5 * (breaks[1:] + breaks[:-1])[off > enough]
            breaks = np.sort(np.concatenate([breaks, middles]))
    return found


def _crossed(places: Inverse, curve: Curve, surface: Surface) -> list[float]:
    """Where a curve's parameters are not smooth: at its own knots if they are few, as with many it
    is smooth enough, and where it crosses those of a surface."""
    own = curve.spans()
    ts = np.unique(np.linspace(own[:-1], own[1:], COMPARED))
    found = own[1:-1].tolist() if len(own) <= FEW_SPANS else []
    uv = places(ts)
    brackets: list[Array] = []
    for k, levels in enumerate(surface.analytic_breaks()):
        for level in np.asarray(levels).tolist():
            side = uv[:, k] - level
            at = np.flatnonzero(side[1:] * side[:-1] < 0.0)
            brackets += [np.array([ts[m], ts[m + 1], k, level]) for m in at]

    def away(t: Array, k: Array, level: Array) -> Array:
        order = np.argsort(t)
        uv = places(t[order])[np.argsort(order)]
        return np.where(k == 0, uv[:, 0], uv[:, 1]) - level

    if brackets:
        from scipy.optimize import elementwise

        low, high, axis, level = np.array(brackets).T
        roots = elementwise.find_root(away, (low, high), args=(axis, level))
        found += roots.x[roots.success].tolist()
    return _apart(found, curve.first, curve.last)


def _apart(ts: list[float], first: float, last: float) -> list[float]:
    """Ascending parameters between two, without those that are another one or an end but for
    rounding, as where a curve crosses a corner of knots."""
    near = SAME_KNOT * (last - first)
    found = [first]
    for t in sorted(ts):
        if found[-1] + near < t < last - near:
            found.append(t)
    return found[1:]


def _at_pole(on: Carrier, uv: Array) -> bool:
    """Is a point on the axis of an angle, up to what a file rounds?"""
    _, xu, xv, *_ = on.surface.jet(float(uv[0]), float(uv[1]))
    return bool(np.linalg.norm(xu) <= AT_POLE * np.linalg.norm(xv))


def _fitted(
    places: Callable[[Array], Array],
    breaks: Array,
    on: Carrier,
    near: Array | None,
) -> NurbsPcurve:
    points, knots = interpolated(places, breaks)
    if near is not None:
        turns = FULL_TURN * np.round((near - points[len(points) // 2]) / FULL_TURN)
        points = points + np.where(on.angles, turns, 0.0)
    points = np.clip(points, *limits_of(on))  # the curve stays within the hull of its points
    return NurbsPcurve(straightened(points), knots)


def miss(pcurve: Pcurve, curve: Curve, surface: Surface) -> float:
    """The greatest distance, at samples between all knots, of a trimming curve's image from its
    edge."""
    ends = np.asarray(curve.spans())
    if isinstance(pcurve, NurbsPcurve):
        inside = (curve.first < pcurve.knots) & (pcurve.knots < curve.last)
        ends = np.unique(np.concatenate([ends, pcurve.knots[inside]]))
    ts = np.linspace(ends[:-1], ends[1:], COMPARED, axis=1).ravel()
    return float(misses(pcurve, curve, surface, ts).max())
