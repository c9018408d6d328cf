"""Bounds of sub-patches of any kind, from bounds of their jets over boxes of parameters.

From a jet's bounds over a box and at its middle, x is bounded by a second-order Taylor expansion,
N = x_u × x_v by its value and slopes, and the curvature by II / I in the two tangents. The error of
the first two decreases with the square of the box's width, that of the last with the width.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from standoff.geometry.boxes import Boxes
from standoff.geometry.interval_vectors import by_generator, cross, dot, mapped, stacked
from standoff.geometry.intervals import Interval, interval
from standoff.geometry.patch_bounds import (
    PatchBounds,
    area_of,
    cone_round,
    normal_curvatures,
    orthonormal,
)
from standoff.geometry.series import Series
from standoff.geometry.tolerances import BOX_MARGIN
from standoff.typing import Array

SIGNS = (-1.0, 1.0)
# Indices in a jet, and the factorials of Taylor coefficients in the order of `Series`.
X, XU, XV, XUU, XUV, XVV = range(6)
FACTORIALS = np.array([1.0, 1.0, 1.0, 2.0, 1.0, 2.0])[:, None]


def series_jets(boxes: Boxes, form: Callable[[Series, Series], Any]) -> Interval:
    """(3, 6, n) bounds of a jet over boxes, from x(u, v) written once for Taylor series."""
    u, v = (Series.variable(side, axis, 2) for axis, side in enumerate(boxes.sides))
    with np.errstate(all="ignore"):
        return derivatives([c if isinstance(c, Series) else u * 0.0 + c for c in form(u, v)])


def derivatives(rows: Sequence[Series]) -> Interval:
    """(3, 6, n) from the coordinates' Taylor coefficients up to order two."""
    return stacked([Interval(c.lo * FACTORIALS, c.hi * FACTORIALS) for c in rows])


def affine_jets(jets: Interval, linear: Array, shift: Array) -> Interval:
    """The jets' images under x -> linear x + shift."""
    image = mapped(linear, jets)
    moved = image[:, X] + interval(shift[:, None])
    low, high = image.lo.copy(), image.hi.copy()
    low[:, X], high[:, X] = moved.lo, moved.hi
    return Interval(low, high)


class JetBounds:
    """Bounds (3, 6, n) of a jet over boxes, `over`, and at their middles, `at`."""

    def __init__(self, boxes: Boxes, jets: Callable[[Boxes], Interval]) -> None:
        self.over = jets(boxes)
        middle = boxes.middle
        self.at = jets(Boxes(middle, middle))
        self.half = np.nextafter(np.maximum(boxes.high - middle, middle - boxes.low), np.inf).T

    def extents(self, directions: Array) -> Interval:
        """(m, n) bounds of direction . x, for directions (m, 3), or (m, 3, n) with one per box."""
        with np.errstate(all="ignore"):
            over, at = mapped(directions, self.over), mapped(directions, self.at)
            u, v = (Interval(-h, h) for h in self.half)
            total = at[:, X] + at[:, XU] * u + at[:, XV] * v
            total = total + over[:, XUU] * u**2 * 0.5 + over[:, XUV] * u * v
            total = total + over[:, XVV] * v**2 * 0.5
        return total.within(over[:, X])

    def normals(self) -> tuple[Array, Array]:
        """(axis, angle) of cones around x_u × x_v."""
        with np.errstate(all="ignore"):
            value, slopes = _normal(self.at)
            steps, off = [], interval(0.0)
            for slope, wide, h in zip(slopes, _normal(self.over)[1], self.half, strict=True):
                middle = interval(slope.middle)
                steps.append(middle * interval(h))
                off = off + (wide - middle) * Interval(-h, h)
            ends = [value + steps[0] * s + steps[1] * t + off for s in SIGNS for t in SIGNS]
            by_slope = cone_round(by_generator(ends))
            box = cross(self.over[:, XU], self.over[:, XV])
            plain = cone_round(by_generator(box_corners(box)))
        closer = plain[1] < by_slope[1]
        axis = np.where(closer[:, None], plain[0], by_slope[0])
        return axis, np.minimum(plain[1], by_slope[1])

    def curvatures(self) -> tuple[Array, Array]:
        """(least, greatest) normal curvature."""
        with np.errstate(all="ignore"):
            xu, xv = (interval(self.at[:, k].middle) for k in (XU, XV))
            metric = (dot(xu, xu), dot(xu, xv), dot(xv, xv))
            a, b, d = (interval(c) for c in orthonormal(*(c.middle for c in metric)))
            xu, xv = self.over[:, XU], self.over[:, XV]
            first, second = xu * a, xu * b + xv * d
            uu, uv, vv = (self.over[:, k] for k in (XUU, XUV, XVV))
            bends = (
                uu * a**2,
                uu * (a * b) + uv * (a * d),
                uu * b**2 + uv * (b * d * 2.0) + vv * d**2,
            )
            normal, area = area_of((first, second))
            metric = dot(first, first), dot(first, second), dot(second, second)
            return normal_curvatures(metric, [dot(normal, c) for c in bends], area)

    def bounds(self, extents: Interval) -> PatchBounds:
        """All bounds, with known extents along the axes."""
        return PatchBounds(*widened(extents), *self.normals(), *self.curvatures())


def widened(extents: Interval, reach: Any = 0.0) -> tuple[Array, Array]:
    """(low, high), (n, 3), of a box that also contains computed points: see BOX_MARGIN. `reach` is
    the greatest number from which they are computed, if larger than the extents, length."""
    margin = BOX_MARGIN * np.maximum(extents.magnitude.max(axis=0), reach)
    return (extents.lo - margin).T, (extents.hi + margin).T


def _normal(jets: Interval) -> tuple[Interval, tuple[Interval, Interval]]:
    """N = x_u × x_v, (3, n), and its slopes along u and v."""
    xu, xv, uu, uv, vv = (jets[:, k] for k in (XU, XV, XUU, XUV, XVV))
    return cross(xu, xv), (cross(uu, xv) + cross(xu, uv), cross(uv, xv) + cross(xu, vv))


def box_corners(box: Interval) -> list[Interval]:
    """The eight corners, each (3, n) and without width, of bounds (3, n)."""
    ends = (box.lo, box.hi)
    picks = [(ends[i][0], ends[j][1], ends[k][2]) for i in (0, 1) for j in (0, 1) for k in (0, 1)]
    return [interval(np.stack(pick)) for pick in picks]
