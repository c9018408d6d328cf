"""How far the image of a trimming curve may be from its edge, proven by values alone.

Over a short enough range of the edge's parameter t the difference g = S(p(t)) - C(t) is N / D with
polynomials N and D of known degree n, but for a known remainder: sines and cosines are their Taylor
polynomials, splines those of one knot span. At m > n Chebyshev points, |N| <= its greatest value
there / cos(pi n / 2 m) (Ehlich and Zeller 1964), for each component in any direction, and so for
its length; D is bounded alike. Ranges that leave too much are halved.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import factorial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.cad.tolerances import BOUND_FLOOR, BOUND_SHARE, REMAINDER
from standoff.geometry.bernstein import basis, equal_segments, segments
from standoff.geometry.curves import ConicArc, Curve, Line
from standoff.geometry.nurbs import NurbsSurface
from standoff.geometry.nurbs_curves import NurbsCurve
from standoff.geometry.nurbs_pcurves import NurbsPcurve
from standoff.geometry.pcurve_boxes import bezier_box
from standoff.geometry.pcurves import Pcurve
from standoff.geometry.surfaces import Surface
from standoff.geometry.swept import Extrusion, Revolution, Swept
from standoff.geometry.vectors import crosses
from standoff.kernels.body import layout as L
from standoff.typing import Array, Ints

# Chebyshev points for each degree: the bound is above the greatest value there by 8 % at most.
POINTS = 4
BETWEEN = 1.0 / np.cos(0.5 * np.pi / POINTS)
# Greatest degree, how often a range is halved, and how many are open, at most.
MOST_DEGREE, MOST_HALVINGS, MOST_OPEN = 80, 16, 1024
# Bezier patches that one range may meet.
MOST_PATCHES = 9


class TrimRanges(NamedTuple):
    """Ranges (n, 2) of an edge's parameter, over each of which the trimming curve and the edge are
    one polynomial: Bezier nets (n, d + 1, 3) of the one, (n, e + 1, 4) of the other if it is a
    spline."""

    ends: Array
    flat: Array
    net: Array | None


def polynomial_bound(pcurve: Pcurve, curve: Curve, surface: Surface, size: float) -> float | None:
    """A bound of |S(p(t)) - C(t)| over an edge, length; None where this does not find one."""
    ranges = _ranges(pcurve, curve, surface)
    found = _sphere_bounds if surface.kind == L.SPHERE else _bounds
    if ranges is None or (found is _bounds and _degree(surface, np.zeros(2)) is None):
        return None
    proven = sampled = 0.0
    for halving in range(MOST_HALVINGS + 1):
        bounds, at = found(ranges, curve, surface)
        sampled = max(sampled, float(at.max()))
        open_ = ~(bounds <= max(BOUND_FLOOR * size, (1.0 + BOUND_SHARE) * sampled))
        if halving == MOST_HALVINGS or open_.sum() > MOST_OPEN:
            open_[:] = False
        proven = max(proven, float(bounds[~open_].max(initial=0.0)))
        if not open_.any():
            break
        ranges = _halves(ranges, open_)
    return proven if np.isfinite(proven) else None


def _ranges(pcurve: Pcurve, curve: Curve, surface: Surface) -> TrimRanges | None:
    """An edge between all knots whose parameters are known."""
    inside = [float(t) for t in curve.spans()]
    if isinstance(pcurve, NurbsPcurve):
        parts = [(part.first, part.last, part.matrix) for part in pcurve.spans]
        inside += [first for first, _, _ in parts]
    elif pcurve.kind == L.LINE and pcurve.matrix[2].tolist() == [0.0, 0.0, 1.0]:
        ends = np.array([[curve.first, 0.0, 1.0], [curve.last, 0.0, 1.0]])
        parts = [(curve.first, curve.last, ends @ pcurve.matrix.T)]
        for (slope, _, start), levels in zip(
            pcurve.matrix, surface.analytic_breaks(), strict=False
        ):
            inside += ((levels - start) / slope).tolist() if slope != 0.0 else []
    else:
        return None
    ts = np.unique([curve.first, *(t for t in inside if curve.first < t < curve.last), curve.last])
    ends = np.array(list(pairwise(ts)))
    flat = _cut([part[:2] for part in parts], np.array([part[2] for part in parts]), ends)
    net = None
    if isinstance(curve, NurbsCurve):
        net = _cut(list(pairwise(curve.essential.breaks)), curve.blocks, ends)
    elif not isinstance(curve, Line | ConicArc):
        return None
    return TrimRanges(ends, flat, net)


def _cut(spans: list[tuple[float, float]], nets: Array, ends: Array) -> Array:
    """(n, d + 1, k): Bezier nets of spans (m, d + 1, k), cut to ranges (n, 2) within them."""
    low, high = np.array(spans).T
    owners = np.clip(np.searchsorted(low, ends.mean(axis=1)) - 1, 0, len(low) - 1)
    shares = (ends - low[owners, None]) / (high - low)[owners, None]
    first, last = np.clip(shares, 0.0, 1.0).T
    return np.asarray(segments(nets.shape[1] - 1, first, last) @ nets[owners])


def _halves(ranges: TrimRanges, which: NDArray[np.bool_]) -> TrimRanges:
    ends = ranges.ends[which]
    middle = ends.mean(axis=1)
    low, high = np.column_stack([ends[:, 0], middle]), np.column_stack([middle, ends[:, 1]])
    both = [
        None
        if nets is None
        else np.concatenate(equal_segments(nets.shape[1] - 1, 2)[:, None] @ nets[which])
        for nets in (ranges.flat, ranges.net)
    ]
    assert both[0] is not None
    return TrimRanges(np.concatenate([low, high]), both[0], both[1])


def _taylor(half: float) -> int | None:
    """The degree of the Taylor polynomial of a sine that leaves REMAINDER of BOUND_FLOOR at most
    `half` from its middle, radians; None where none of a sensible degree does."""
    for degree in range(1, MOST_DEGREE):
        if half ** (degree + 1) / factorial(degree + 1) <= REMAINDER * BOUND_FLOOR:
            return degree
    return None


def _degree(surface: Surface, half: Array) -> int | None:
    """The degree of a surface over boxes of half widths (2,) in u and v; None if it has none."""
    degrees: list[int | None] = []
    turns = [_taylor(float(h)) for h in half]
    if isinstance(surface, NurbsSurface):
        degrees = [sum(surface.degrees)]
    elif isinstance(surface, Swept):
        along = int(isinstance(surface, Revolution))
        profile = surface.profile
        if isinstance(profile, Line | ConicArc | NurbsCurve):
            bent = profile.degree if isinstance(profile, NurbsCurve) else 1
            degrees = [turns[along] if isinstance(profile, ConicArc) else bent, *turns[:along]]
    elif surface.kind in (L.PLANE, L.CYLINDER, L.CONE, L.TORUS):
        degrees = turns[: {L.PLANE: 0, L.TORUS: 2}.get(surface.kind, 1)]
        degrees += [1] if surface.kind in (L.PLANE, L.CONE) else []
    known = [degree for degree in degrees if degree is not None]
    return sum(known) if known and len(known) == len(degrees) else None


def _bounds(ranges: TrimRanges, curve: Curve, surface: Surface) -> tuple[Array, Array]:
    """(n,) bounds of |g| over ranges, inf where they are too long, and greatest values seen."""
    low, high = bezier_box(ranges.flat)
    half = 0.5 * (high - low)
    bent = _edge_degree(ranges, curve)
    own = _degree(surface, half.max(axis=0))
    lost = np.full(len(low), np.inf), np.zeros(len(low))
    if own is None or bent is None:
        return lost
    nets = [net[..., -1] for net in (ranges.flat, ranges.net) if net is not None]
    own_weights = getattr(getattr(surface, "profile", surface), "weights", np.ones(1))
    rational = any(bool(np.ptp(w) > 0.0) for w in (own_weights, *nets))
    image = own * (ranges.flat.shape[1] - 1)
    degree = image + bent if rational else max(image, bent)
    if degree > MOST_DEGREE:
        return lost
    p, c, weights = _values(ranges, curve, degree)
    uv = p[..., :2] / p[..., 2:]
    owners, x, w = _images(surface, uv, low, high)
    away = np.linalg.norm(x - c[owners], axis=2)
    spare = _surface_remainder(surface, x) + _curve_remainder(curve)
    each = _greatest(away + spare, (p[..., 2] ** own * weights)[owners] * w) + spare
    bounds, seen = np.zeros(len(low)), np.full(uv.shape[:2], np.inf)
    np.maximum.at(bounds, owners, each)
    np.minimum.at(seen, owners, away)
    bounds[~np.isfinite(seen).all(axis=1)] = np.inf
    return bounds, np.where(np.isfinite(bounds), seen.max(axis=1), 0.0)


def _sphere_bounds(ranges: TrimRanges, curve: Curve, surface: Surface) -> tuple[Array, Array]:
    """The same in a gnomonic chart, whose points are a root's: of the edge's distance from the
    sphere, and of the angle between its direction and that of (u, v, 1)."""
    bent = _edge_degree(ranges, curve)
    degree = MOST_DEGREE + 1 if bent is None else 2 * (bent + ranges.flat.shape[1] - 1)
    if degree > MOST_DEGREE:
        return np.full(len(ranges.ends), np.inf), np.zeros(len(ranges.ends))
    way, c, weights = _values(ranges, curve, degree)
    x = surface.points((way[..., :2] / way[..., 2:]).reshape(-1, 2)).reshape(c.shape)
    stretch = float(np.linalg.norm(surface.linear, 2))
    spare = _curve_remainder(curve) / float(np.linalg.svd(surface.linear, compute_uv=False)[-1])
    y = np.linalg.solve(surface.linear, (c - surface.shift)[..., None])[..., 0]
    far, long = np.linalg.norm(y, axis=2), np.linalg.norm(way, axis=2)
    across = np.linalg.norm(crosses(np.asarray(y), way), axis=2) / (far * long)
    sine = np.sqrt(_greatest(across**2, (far * long * weights) ** 2)) + 2.0 * spare
    off = _greatest(np.abs(far**2 - 1.0), weights**2) + 3.0 * spare
    near = (sine < 0.5) & (off < 0.5) & ((y * way).sum(axis=2) > 0.0).all(axis=1)
    off = off / (1.0 + np.sqrt(np.maximum(1.0 - off, 0.0)))
    chord = sine * np.sqrt(2.0 / (1.0 + np.sqrt(np.maximum(1.0 - sine**2, 0.0))))
    bounds = stretch * np.hypot(off, chord * np.sqrt(1.0 + off))
    return np.where(near, bounds, np.inf), np.linalg.norm(x - c, axis=2).max(axis=1)


def _edge_degree(ranges: TrimRanges, curve: Curve) -> int | None:
    """The degree of an edge's polynomial over ranges; None where they are too long for one."""
    if ranges.net is not None:
        return int(ranges.net.shape[1] - 1)
    widest = float(np.ptp(ranges.ends, axis=1).max())
    return _taylor(0.5 * widest) if isinstance(curve, ConicArc) else 1


def _values(ranges: TrimRanges, curve: Curve, degree: int) -> tuple[Array, Array, Array]:
    """At the Chebyshev points of each range for polynomials of a degree: homogeneous (u, v), and
    the edge's points and weights."""
    nodes = chebyshev_points(POINTS * degree)
    p = basis(ranges.flat.shape[1] - 1, nodes) @ ranges.flat
    if ranges.net is not None:
        c = basis(ranges.net.shape[1] - 1, nodes) @ ranges.net
        return p, c[..., :3] / c[..., 3:], c[..., 3]
    ts = ranges.ends[:, :1] + nodes * np.diff(ranges.ends, axis=1)
    return p, curve.points(ts.ravel()).reshape(*ts.shape, 3), np.ones(ts.shape)


def chebyshev_points(count: int) -> Array:
    """Of the unit interval, ascending."""
    return np.asarray(0.5 - 0.5 * np.cos(np.pi * (np.arange(count) + 0.5) / count))


def _greatest(values: Array, below: Array) -> Array:
    """(n,) bounds of |N / D| from values (n, m) of it and of D > 0 at Chebyshev points."""
    least = 0.5 * ((1.0 + BETWEEN) * below.min(axis=1) + (1.0 - BETWEEN) * below.max(axis=1))
    with np.errstate(divide="ignore"):
        return np.asarray(BETWEEN * (values * below).max(axis=1) / np.maximum(least, 0.0))


def _curve_remainder(curve: Curve) -> float:
    """What Taylor polynomials leave of an edge, length."""
    arc = np.linalg.norm(curve.basis()[:, :2]) if isinstance(curve, ConicArc) else 0.0
    return 2.0 * REMAINDER * BOUND_FLOOR * float(arc)


def _surface_remainder(of: Surface, points: Array) -> float:
    """What Taylor polynomials leave of a surface near points, length."""
    if isinstance(of, NurbsSurface) or of.kind == L.PLANE:
        return 0.0
    reach = BETWEEN * float(np.linalg.norm(points - of.shift, axis=-1).max(initial=0.0))
    own = np.abs(of.data[:2]).sum() if of.kind == L.TORUS else 0.0
    if isinstance(of, Swept) and isinstance(of.profile, ConicArc):
        own = np.linalg.norm(of.profile.basis()[:, :2])
    return float(4.0 * REMAINDER * BOUND_FLOOR * (reach + np.linalg.norm(of.linear) * own))


def _images(surface: Surface, uv: Array, low: Array, high: Array) -> tuple[Ints, Array, Array]:
    """Of ranges that have boxes (n, 2) in (u, v): (owners (r,), points (r, m, 3), weights (r, m))
    at uv (n, m, 2), once by each polynomial that a range may meet, also beyond its own knots; none
    of those that meet too many."""
    if isinstance(surface, NurbsSurface):
        breaks = surface.essential_u.breaks, surface.essential_v.breaks
        owners, (i, j) = _met(breaks, low, high)
        along, across = (
            basis(surface.degrees[k], _shares(breaks[k], place, uv[owners, :, k]))
            for k, place in enumerate((i, j))
        )
        rows = along @ surface.blocks[i, j].reshape(len(owners), along.shape[2], -1)
        h = (rows.reshape(*rows.shape[:2], -1, 4) * across[..., None]).sum(axis=2)
        return owners, h[..., :3] / h[..., 3:], h[..., 3]
    if isinstance(surface, Extrusion | Revolution) and isinstance(surface.profile, NurbsCurve):
        k, profile = int(isinstance(surface, Revolution)), surface.profile
        knots = profile.essential.breaks
        owners, (i,) = _met([knots], low[:, k : k + 1], high[:, k : k + 1])
        h = basis(profile.degree, _shares(knots, i, uv[owners, :, k])) @ profile.blocks[i]
        x, other = h[..., :3] / h[..., 3:], uv[owners, :, 1 - k, None]
        if isinstance(surface, Extrusion):
            x = x + other * surface.direction
        else:
            x = np.concatenate(
                [x[..., :1] * np.cos(other), x[..., :1] * np.sin(other), x[..., 2:]], 2
            )
        return owners, x @ surface.linear.T + surface.shift, h[..., 3]
    x = surface.points(uv.reshape(-1, 2)).reshape(*uv.shape[:2], 3)
    return np.arange(len(uv)), x, np.ones(uv.shape[:2])


def _met(breaks: Sequence[Array], low: Array, high: Array) -> tuple[Ints, list[Ints]]:
    """(owners (r,), numbers (r,) of spans along each axis): the spans between knots, or products of
    them, that boxes (n, axes) may meet."""
    spans = []
    for k, knots in enumerate(breaks):
        start = np.clip(np.searchsorted(knots, low[:, k], "right") - 1, 0, len(knots) - 2)
        stop = np.clip(np.searchsorted(knots, high[:, k]) - 1, start, len(knots) - 2)
        spans.append((start, stop - start + 1))
    number = np.prod([count for _, count in spans], axis=0)
    number[number > MOST_PATCHES] = 0
    owners = np.repeat(np.arange(len(low)), number)
    order = np.arange(len(owners)) - np.repeat(np.cumsum(number) - number, number)
    found = []
    for start, count in reversed(spans):
        found.append(start[owners] + order % count[owners])
        order = order // count[owners]
    return owners, found[::-1]


def _shares(knots: Array, spans: Ints, at: Array) -> Array:
    """Parameters (r, m) as shares of knot spans (r,), beyond 0 and 1 outside."""
    return np.asarray((at - knots[spans, None]) / np.diff(knots)[spans, None])
