"""Bounds of sub-patches of superellipsoids, whose gnomonic charts are cut at the coordinate planes.

In a chart's coordinates (a, b, c) = (u, v, 1) s the gauge is (|a|^m2 + |b|^m2)^(m1/m2) + |c|^m1 for
the chart about the axis, and (|c|^m2 + |a|^m2)^(m1/m2) + |b|^m1 for the one about a point of the
equator. Near a coordinate plane its second derivatives may be infinite, so points and normals have
separate bounds: by convexity, and because the gauge's gradient is monotone in |u| and |v|.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff.geometry.boxes import Boxes
from standoff.geometry.gnomonic import corners
from standoff.geometry.interval_vectors import by_generator, cofactors, dot, mapped, stacked
from standoff.geometry.intervals import Interval, interval, power
from standoff.geometry.jet_bounds import JetBounds, box_corners, series_jets, widened
from standoff.geometry.patch_bounds import PatchBounds, cone_round
from standoff.geometry.series import Series
from standoff.geometry.series import power as series_power
from standoff.geometry.surfaces import Surface
from standoff.kernels.body import layout as L
from standoff.typing import Array


def _signs(side: Interval) -> Array:
    """Signs of a parameter, which does not change sign within a box."""
    return np.where(side.lo + side.hi < 0.0, -1.0, 1.0)


def _size(side: Interval) -> Interval:
    """|u| over each box."""
    return Interval(side.mignitude, side.magnitude)


def _not_negative(total: Interval) -> Interval:
    """A sum of non-negative numbers, whose lower bound may have been rounded below zero."""
    return Interval(np.maximum(total.lo, 0.0), total.hi)


def _is_pole(surface: Surface) -> bool:
    return surface.kind == L.SUPERELLIPSOID_POLE


def superellipsoid_jets(surface: Surface, boxes: Boxes) -> Interval:
    """(3, 6, n) bounds of the canonical jet; unknown next to a plane if a power is not integer."""
    m1, m2 = (float(m) for m in surface.data[:2])
    su, sv = (_signs(side) for side in boxes.sides)

    def raised(x: Any, m: float) -> Any:
        return x ** int(m) if m == int(m) else series_power(x, m)

    def form(u: Series, v: Series) -> tuple[Series, Series, Series]:
        a, b = raised(u * su, m2), v * sv
        if _is_pole(surface):
            gauge = raised(a + raised(b, m2), m1 / m2) + 1.0
        else:
            gauge = raised(a + 1.0, m1 / m2) + raised(b, m1)
        s = series_power(gauge, -1.0 / m1)
        return u * s, v * s, s

    return series_jets(boxes, form)


def _points(surface: Surface, u: Interval, v: Interval) -> Interval:
    """(3, n) bounds of canonical points."""
    m1, m2 = surface.data[:2]
    a, b = power(_size(u), m2), _size(v)
    if _is_pole(surface):
        gauge = power(_not_negative(a + power(b, m2)), m1 / m2) + 1.0
    else:
        gauge = power(a + 1.0, m1 / m2) + power(b, m1)
    s = power(gauge, -1.0 / m1)
    return stacked([u * s, v * s, s])


def _normals(surface: Surface, boxes: Boxes) -> Interval:
    """(3, n) bounds of the gauge's gradient up to its length."""
    m1, m2 = surface.data[:2]
    su, sv = (_signs(side) for side in boxes.sides)
    a, b = (_size(side) for side in boxes.sides)
    if not _is_pole(surface):
        common = power(power(a, m2) + 1.0, m1 / m2 - 1.0)
        return stacked([common * power(a, m2 - 1.0) * su, power(b, m1 - 1.0) * sv, common])
    # scaled by the greater of |u| and |v| to avoid 0 / 0 at the centre
    size = Interval(np.maximum(a.lo, b.lo), np.maximum(a.hi, b.hi))
    first, second = _share(a, b), _share(b, a)
    total = (power(first, m2) + power(second, m2)).within(Interval(np.array(1.0), np.array(2.0)))
    common = power(size, m1 - 1.0) * power(total, m1 / m2 - 1.0)
    one = interval(np.ones(len(boxes)))
    return stacked(
        [common * power(first, m2 - 1.0) * su, common * power(second, m2 - 1.0) * sv, one]
    )


def _share(a: Interval, b: Interval) -> Interval:
    """a / max(a, b) for non-negative numbers; [0, 1] where both may be 0."""
    with np.errstate(all="ignore"):
        low = np.nextafter(a.lo / np.maximum(a.lo, b.hi), -np.inf)
        high = np.nextafter(a.hi / np.maximum(a.hi, b.lo), np.inf)
    return Interval(np.clip(np.nan_to_num(low), 0, 1), np.clip(np.nan_to_num(high, nan=1.0), 0, 1))


def _support(surface: Surface, n: Interval) -> Interval:
    """The greatest n . x over the whole canonical body, the dual of the gauge."""
    q1, q2 = (m / (m - 1.0) for m in surface.data[:2])
    a, b, c = (power(_size(n[k]), q) for k, q in enumerate((q2, q2, q1)))
    if not _is_pole(surface):
        a, b, c = a, power(_size(n[2]), q2), power(_size(n[1]), q1)
    pair = power(_not_negative(a + b), q1 / q2)
    return power(_not_negative(pair + c), 1.0 / q1)


def superellipsoid_extents(surface: Surface, boxes: Boxes, directions: Array) -> Interval:
    """(m, n) bounds of direction . x.

    A point outside the corners' hull is a point of the hull moved outward, at most to a supporting
    plane.
    """
    middle = boxes.middle
    n = interval(_normals(surface, Boxes(middle, middle)).middle)
    support = _support(surface, n)
    with np.errstate(all="ignore"):
        inner = [_points(surface, interval(u), interval(v)) for u, v in corners(boxes)]
        outer = [p * (support / dot(n, p)) for p in inner]
        plain = _points(surface, *boxes.sides)
    held = by_generator([*inner, *outer])
    # the smaller of the hull and the box of the coordinates
    image = [mapped(directions, interval(column[:, None])) for column in surface.linear.T]
    total, box = interval(0.0), interval(0.0)
    for k, a in enumerate(image):
        total = total + a[:, None] * held[k]
        box = box + a * plain[k]
    known = total.known.all(axis=1) & (held.known.all(axis=(0, 1)))
    low = np.where(known, np.maximum(total.lo.min(axis=1), box.lo), box.lo)
    high = np.where(known, np.minimum(total.hi.max(axis=1), box.hi), box.hi)
    return Interval(low, high) + mapped(directions, interval(surface.shift[:, None]))


def superellipsoid_bounds(surface: Surface, boxes: Boxes) -> PatchBounds:
    """Boxes, cones of normals and curvatures."""
    extents = superellipsoid_extents(surface, boxes, np.eye(3)[..., None])
    jets = JetBounds(boxes, surface.body_jets)
    box = by_generator(box_corners(_normals(surface, boxes)))
    axis, angle = cone_round(mapped(cofactors(surface.linear), box))
    other, closer = jets.normals()
    axis = np.where((closer < angle)[:, None], other, axis)
    reach = np.linalg.norm(surface.linear, 2)
    return PatchBounds(
        *widened(extents, reach), axis, np.minimum(angle, closer), *jets.curvatures()
    )
