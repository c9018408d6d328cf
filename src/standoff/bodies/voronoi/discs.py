"""Discs inside a planar body that touch its boundary at one, two or three points."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np
import scipy

from standoff.bodies.voronoi.outline import Arc, ArcOutline, BoundaryFoot, Place
from standoff.bodies.voronoi.tolerances import (
    GRADES,
    LEAST_HEIGHT,
    NEWTON_STEPS,
    PART_SAMPLES,
    SOLVED,
)
from standoff.kernels.tolerances import EPS
from standoff.typing import Array

# Radii between two samples are not smaller than theirs by more than this factor.
FAR_ABOVE = 4.0
# Minima refined on one arc, the lowest first: on a circle every other sample is one, by roundoff.
MOST_ROOTS = 4
# How often an arc is sampled, each time between the neighbours of the previous lowest sample.
ZOOMS = 4


class Touch(NamedTuple):
    """Where a disc touches the boundary, and its radius, length."""

    place: Place
    radius: float


class Junction(NamedTuple):
    """A disc that touches at three places, in their order."""

    centre: Array
    radius: float
    places: tuple[Place, Place, Place]


def greatest_disc(
    outline: ArcOutline, foot: BoundaryFoot, start: Place, stop: Place, graded: bool = True
) -> Touch:
    """The largest disc inside that touches the boundary at a foot, and where it touches the part of
    the boundary from start to stop, which does not contain the foot. `graded`: the ends of that
    part may be arbitrarily near to the foot, but are not the foot.

    A disc that touches at x with the normal n has the boundary point y on its rim if its radius is
    |x - y|²/(2 n·(x - y)): the largest empty one has the least of these radii.
    """
    best = Touch(start, np.inf)
    stretches = outline.stretches(start, stop)
    least = LEAST_HEIGHT * outline.size
    for k, (n, lo, hi) in enumerate(stretches):
        arc = outline.arc(n)
        us, samples = arc.us, arc.samples
        ends = graded and k == 0, graded and k == len(stretches) - 1
        if lo > arc.lo or hi < arc.hi or any(ends):
            us = _graded(lo, hi, *ends)
            samples = arc.sampled(us)
        u, radius = _least_radius(foot, arc, us, samples, least)
        if radius < best.radius:
            best = Touch((n, u), radius)
    return best


def _least_radius(
    foot: BoundaryFoot, arc: Arc, us: Array, samples: tuple[Array, Array, Array], least: float
) -> tuple[float, float]:
    """(u, radius) of the least disc over samples of an arc, refined as `nearest_on_arc` does."""
    best, at = np.inf, float(us[0])
    for _ in range(ZOOMS):
        radii, slopes = _radii(foot, samples[0], samples[1], least)
        k = int(radii.argmin())
        if radii[k] < best:
            best, at = float(radii[k]), float(us[k])
        rises = np.flatnonzero((slopes[:-1] < 0.0) & (slopes[1:] >= 0.0))
        lows = np.minimum(radii[rises], radii[rises + 1])
        for i in rises[np.argsort(lows)][:MOST_ROOTS]:
            if min(radii[i], radii[i + 1]) > FAR_ABOVE * best:
                break
            u = _root(partial(_slope, foot, arc), us, int(i))
            radius = _radius(foot, arc, u)
            if radius < best:
                best, at = radius, u
        if best < radii[k] or not np.isfinite(best):
            break
        us = np.linspace(us[max(k - 1, 0)], us[min(k + 1, len(us) - 1)], PART_SAMPLES)
        samples = arc.sampled(us)
    return at, best


def _graded(lo: float, hi: float, first: bool, last: bool) -> Array:
    """Samples from lo to hi, ever denser towards the ends of the whole part: there it may come
    arbitrarily near to the foot, as on the two sides of a corner."""
    fine: Array = (hi - lo) / (PART_SAMPLES - 1) * np.float64(0.5) ** np.arange(1, GRADES)
    ends = [lo + fine] * first + [hi - fine] * last
    return np.unique(np.concatenate([np.linspace(lo, hi, PART_SAMPLES), *ends]))


def _root(function: Callable[[float], float], us: Array, i: int) -> float:
    """The root between samples i and i + 1, where the function increases through zero."""
    a, b = float(us[i]), float(us[i + 1])
    if function(a) >= 0.0 or function(b) <= 0.0:  # zero up to the samples' roundoff
        return a if abs(function(a)) <= abs(function(b)) else b
    return float(scipy.optimize.brentq(function, a, b, xtol=EPS, rtol=4.0 * EPS))


def _radii(foot: BoundaryFoot, y: Array, yu: Array, least: float) -> tuple[Array, Array]:
    """Radii of discs through boundary points y, and numbers with the sign of their derivatives."""
    d = foot.x - y
    height, square = d @ foot.n, np.einsum("ij,ij->i", d, d)
    seen = height > least
    radii = np.where(seen, square / np.where(seen, 2.0 * height, 1.0), np.inf)
    slopes = square * (yu @ foot.n) - 2.0 * np.einsum("ij,ij->i", d, yu) * height
    return radii, slopes


def _radius(foot: BoundaryFoot, arc: Arc, u: float) -> float:
    d = foot.x - arc.jet(u)[0]
    height = float(d @ foot.n)
    return float(d @ d) / (2.0 * height) if height > 0.0 else np.inf


def _slope(foot: BoundaryFoot, arc: Arc, u: float) -> float:
    y, yu, _ = arc.jet(u)
    d = foot.x - y
    return float((d @ d) * (yu @ foot.n) - 2.0 * (d @ yu) * (d @ foot.n))


def junction(outline: ArcOutline, places: tuple[Place, Place, Place]) -> Junction | None:
    """The disc that touches the boundary near three places, by Newton's method to roundoff.

    The unknowns are centre c, radius r and the three feet: c + r n_i - x_i = 0. None if it does not
    converge.
    """
    feet = [outline.foot(p) for p in places]
    start = np.vstack([np.column_stack([np.eye(2), f.n]) for f in feet])
    y = np.linalg.lstsq(start, np.concatenate([f.x for f in feet]), rcond=None)[0]
    now = list(places)
    last = np.inf
    for _ in range(NEWTON_STEPS):
        miss = np.concatenate([y[:2] + y[2] * f.n - f.x for f in feet])
        matrix = np.zeros((6, 6))
        matrix[:, :3] = np.vstack([np.column_stack([np.eye(2), f.n]) for f in feet])
        for i, f in enumerate(feet):
            matrix[2 * i : 2 * i + 2, 3 + i] = (y[2] * f.curvature - 1.0) * f.tangent
        try:
            step = np.linalg.solve(matrix, -miss)
        except np.linalg.LinAlgError:
            return None
        y = y + step[:3]
        now = [
            _moved(outline, p, float(s) / f.speed)
            for p, s, f in zip(now, step[3:], feet, strict=True)
        ]
        feet = [outline.foot(p) for p in now]
        length = float(np.abs(step).max())
        # if two feet are close, steps never get small: the end is roundoff of the equations
        solved = float(np.abs(miss).max()) <= SOLVED * outline.size
        if length <= EPS * outline.size or (solved and length >= 0.5 * last):
            return Junction(y[:2], float(y[2]), (now[0], now[1], now[2]))
        if not np.isfinite(length):
            return None
        last = length
    return None


def _moved(outline: ArcOutline, place: Place, du: float) -> Place:
    """A place moved by du, across a smooth joint if it meets one; it stops at a corner."""
    n, u = place
    arc = outline.arc(n)
    u += du
    if u > arc.hi:
        if outline.corner(n + 1):
            return n, arc.hi
        after = outline.arc(n + 1)
        return n + 1, min(after.lo + (u - arc.hi) * _speeds(arc, arc.hi, after, after.lo), after.hi)
    if u < arc.lo:
        if outline.corner(n):
            return n, arc.lo
        before = outline.arc(n - 1)
        rate = _speeds(arc, arc.lo, before, before.hi)
        return n - 1, max(before.hi + (u - arc.lo) * rate, before.lo)
    return n, u


def _speeds(arc: Arc, u: float, other: Arc, v: float) -> float:
    return arc.foot(u).speed / other.foot(v).speed


def nearest_on_arc(arc: Arc, point: Array) -> tuple[float, float]:
    """(distance, u) of the arc's point nearest to a point (2,).

    The nearest point is sought between the samples nearest to the point, and then between finer
    samples there.
    """
    us, (x, xu, _) = arc.us, arc.samples
    best, at = np.inf, float(us[0])
    for _ in range(ZOOMS):
        d = x - point
        slopes = np.einsum("ij,ij->i", d, xu)
        squares = np.einsum("ij,ij->i", d, d)
        k = int(squares.argmin())
        if squares[k] < best:
            best, at = float(squares[k]), float(us[k])
        for i in np.flatnonzero((slopes[:-1] < 0.0) & (slopes[1:] >= 0.0)):
            u = _root(lambda u: _rise(arc, point, u), us, int(i))
            out = arc.jet(u)[0] - point
            if out @ out < best:
                best, at = float(out @ out), u
        if best < squares[k]:
            break
        us = np.linspace(us[max(k - 1, 0)], us[min(k + 1, len(us) - 1)], PART_SAMPLES)
        x, xu, _ = arc.sampled(us)
    return float(np.sqrt(best)), at


def _rise(arc: Arc, point: Array, u: float) -> float:
    """Half the derivative of the squared distance to a point."""
    y, yu, _ = arc.jet(u)
    return float((y - point) @ yu)


def edge_distances(outline: ArcOutline, point: Array) -> dict[int, tuple[float, Place]]:
    """The nearest place of every edge to a point (2,) and its distance, length.

    For edges that are certainly farther away than the nearest one, the nearest sample is used.
    """
    squares = [((arc.samples[0] - point) ** 2).sum(axis=1) for arc in outline.arcs]
    rough = [(float(np.sqrt(square.min())), n) for n, square in enumerate(squares)]
    found: dict[int, tuple[float, Place]] = {}
    best = np.inf
    for distance, n in sorted(rough):
        arc = outline.arcs[n]
        u = float(arc.us[squares[n].argmin()])
        if distance - arc.chord <= best:
            distance, u = nearest_on_arc(arc, point)
            best = min(best, distance)
        if distance < found.get(arc.edge, (np.inf, (0, 0.0)))[0]:
            found[arc.edge] = distance, (n, u)
    return found
