"""Bounds of sub-patches in gnomonic charts, x = shift + linear (u, v, 1) s(u, v)."""

from __future__ import annotations

from itertools import product

import numpy as np

from standoff.geometry.boxes import Boxes
from standoff.geometry.interval_vectors import (
    by_generator,
    cofactors,
    length,
    mapped,
    stacked,
    wave,
)
from standoff.geometry.intervals import Interval, atan, interval, sqrt
from standoff.geometry.jet_bounds import widened
from standoff.geometry.patch_bounds import PatchBounds, between, cone_round
from standoff.geometry.surfaces import Surface
from standoff.geometry.tolerances import LENGTH_ROUNDING
from standoff.typing import Array


def corners(boxes: Boxes) -> list[tuple[Array, Array]]:
    """(u, v) of the four corners of each box."""
    us, vs = ((boxes.low[:, k], boxes.high[:, k]) for k in (0, 1))
    return list(product(us, vs))


def ellipsoid_extents(surface: Surface, boxes: Boxes, directions: Array) -> Interval:
    """(m, n) bounds of direction . x, exact up to rounding.

    On the unit sphere the sides of a box are arcs of great circles, along which a height is a
    sinusoid; inside, a height is extreme only where the direction itself meets the sphere.
    """
    a = stacked([mapped(directions, interval(column[:, None])) for column in surface.linear.T])
    held = _along_sides(a[0], a[1], a[2], boxes.sides[0], boxes.sides[1])
    other = _along_sides(a[1], a[0], a[2], boxes.sides[1], boxes.sides[0])
    low, high = np.minimum(held.lo, other.lo), np.maximum(held.hi, other.hi)
    size = length(a[0], a[1], a[2])
    high = np.where(_meets(a, boxes), np.maximum(high, size.hi), high)
    low = np.where(_meets(-a, boxes), np.minimum(low, -size.hi), low)
    return Interval(low, high) + mapped(directions, interval(surface.shift[:, None]))


def _along_sides(
    across: Interval, along: Interval, up: Interval, u: Interval, v: Interval
) -> Interval:
    """Heights on the two sides u = const, where (u, 0, 1)/c and (0, 1, 0) span a great circle."""
    sides = []
    for end in (u.lo, u.hi):
        c = sqrt(interval(end) ** 2 + 1.0)
        sides.append(wave((across * interval(end) + up) / c, along, atan(v / c)))
    first, last = sides
    return Interval(np.minimum(first.lo, last.lo), np.maximum(first.hi, last.hi))


def _meets(a: Interval, boxes: Boxes) -> Array:
    """May a direction meet the sphere inside a box?"""
    seen = a[2].hi > 0.0
    for k in (0, 1):
        low, high = (interval(c[:, k]) for c in (boxes.low, boxes.high))
        seen = seen & ((a[k] - low * a[2]).hi >= 0.0) & ((high * a[2] - a[k]).hi >= 0.0)
    return np.asarray(seen)


def ellipsoid_bounds(surface: Surface, boxes: Boxes) -> PatchBounds:
    """Boxes, cones of normals and curvatures.

    The unit sphere's normals over a box are positive combinations of those at its corners. The
    normal curvature along the image of a unit tangent t at n is -det(A) / (|C n| |A t|²), where C
    are the cofactors of A; both lengths are near those at the middle, and within the singular
    values.
    """
    extents = ellipsoid_extents(surface, boxes, np.eye(3)[..., None])
    axis, angle = ellipsoid_cones(surface, boxes)
    spots = _spots(boxes)
    middle = np.stack([*boxes.middle.T, np.ones(len(boxes))])
    middle = middle / np.linalg.norm(middle, axis=0)
    turn = np.max([between(middle, x) for x in spots], axis=0)
    chord = 2.0 * np.sin(0.5 * np.minimum(turn, np.pi)) * (1.0 + LENGTH_ROUNDING)
    a, b, c = (float(x) for x in np.linalg.svd(surface.linear, compute_uv=False))
    image = cofactors(surface.linear).middle @ middle
    normal = _near(np.linalg.norm(image, axis=0), chord, b * c, a * b)
    least, most = _tangent_lengths(surface.linear, middle)
    low, high = _near(least, chord, c, a), _near(most, chord, c, a)
    held = interval(a) * b * c / (normal * Interval(low.lo, high.hi) ** 2)
    signed = -held if np.linalg.det(surface.linear) > 0.0 else held
    return PatchBounds(*widened(extents), axis, angle, signed.lo, signed.hi)


def ellipsoid_cones(surface: Surface, boxes: Boxes) -> tuple[Array, Array]:
    """(axis (n, 3), angle (n,)) of cones around the normals alone."""
    generators = by_generator([interval(x) for x in _spots(boxes)])
    return cone_round(mapped(cofactors(surface.linear), generators))


def _spots(boxes: Boxes) -> list[Array]:
    """(3, n) directions of each corner of the boxes."""
    return [np.stack([u, v, np.ones(len(boxes))]) for u, v in corners(boxes)]


def _near(size: Array, chord: Array, least: float, most: float) -> Interval:
    """Length of the image of a unit vector within a chord of one with a known image, bounded by
    singular values."""
    spare = LENGTH_ROUNDING * most
    low = np.maximum(size - most * chord, least) - spare
    return Interval(np.maximum(low, 0.0), np.minimum(size + most * chord, most) + spare)


def _tangent_lengths(linear: Array, normals: Array) -> tuple[Array, Array]:
    """Least and greatest length of the image of unit vectors perpendicular to normals (3, n)."""
    n = normals.T
    helper = np.eye(3)[np.abs(n).argmin(axis=1)]
    first = np.cross(n, helper)
    first = first / np.linalg.norm(first, axis=1)[:, None]
    pair = np.stack([first, np.cross(n, first)], axis=2)
    values = np.linalg.svd(linear @ pair, compute_uv=False)
    return values[:, 1], values[:, 0]
