"""Bounds of rational Bezier patches and curves over parts of them, from their control nets.

Derivatives are nets too; each is restricted to the part, whose values its coefficients enclose.
Quotients are taken relative to a point of the part, so that the weights' bounds multiply small
vectors.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from standoff.geometry.bernstein import segments
from standoff.geometry.boxes import Boxes
from standoff.geometry.interval_vectors import stacked
from standoff.geometry.intervals import Interval, interval
from standoff.geometry.jet_bounds import JetBounds, widened
from standoff.geometry.patch_bounds import PatchBounds
from standoff.geometry.tolerances import (
    CONE_ROUNDING,
    NET_ROUNDING,
    POLYNOMIAL_WEIGHTS,
    SPAN_ROUNDING,
)
from standoff.kernels.entries.queries import net_cones
from standoff.typing import Array

EPS = float(np.finfo(np.float64).eps)
# Cones wider than this (radians) are computed again from the product of the nets.
WIDE_CONE = 0.1


class CutNets:
    """Parts of a grid of rational Bezier patches, over boxes that no break crosses.

    Parameters
    ----------
    blocks : (nu, nv, p + 1, q + 1, 4) homogeneous points; curves have nv = 1, q = 0.
    breaks : (nu + 1,) and (nv + 1,) parameters between the patches.
    boxes : n boxes.
    """

    def __init__(self, blocks: Array, breaks: tuple[Array, Array], boxes: Boxes) -> None:
        self.spans, self.ends, self.widths = [], [], []
        for axis, levels in enumerate(breaks):
            middle, low, high = (b[:, axis] for b in (boxes.middle, boxes.low, boxes.high))
            span = np.clip(np.searchsorted(levels, middle, "right") - 1, 0, len(levels) - 2)
            first, width = levels[span], levels[span + 1] - levels[span]
            start, stop = (low - first) / width - SPAN_ROUNDING, (high - first) / width
            stop = stop + SPAN_ROUNDING
            # beyond its ends the grid goes on as its last patches: trimming curves may lie there
            least = np.where(low < levels[0], np.minimum(start, 0), 0)
            most = np.where(high > levels[-1], np.maximum(stop, 1), 1)
            self.spans.append(span)
            self.widths.append(width)
            self.ends.append((np.clip(start, least, 1), np.clip(stop, 0, most)))
        self.h = blocks[self.spans[0], self.spans[1]]
        self.parts: dict[tuple[int, int], Array] = {}

    def _part(self, axis: int, degree: int) -> Array:
        """(n, i, a) matrices to the coefficients of each part along an axis, made once."""
        if (axis, degree) not in self.parts:
            self.parts[axis, degree] = segments(degree, *self.ends[axis])
        return self.parts[axis, degree]

    def net(self, along_u: int, along_v: int) -> Interval:
        """(4, n, i, j) coefficients of a partial derivative over each box, rounding included."""
        h, off = self.h, np.zeros_like(self.h)
        if along_u >= h.shape[1] or along_v >= h.shape[2]:
            return interval(np.zeros((4, len(h), 1, 1)))
        scale: Array = np.ones(len(h))
        for axis, times in ((1, along_u), (2, along_v)):
            later = (slice(None),) * axis + (slice(1, None),)
            first = (slice(None),) * axis + (slice(-1),)
            for _ in range(times):
                degree = h.shape[axis] - 1
                # the difference of equal points is exactly zero
                h = degree * (h[later] - h[first])
                off = degree * (off[later] + off[first]) + 2.0 * EPS * np.abs(h)
                scale = scale / self.widths[axis - 1]
        rows, columns = self._part(0, h.shape[1] - 1), self._part(1, h.shape[2] - 1)
        every = np.concatenate([h, np.abs(h), off], axis=3)
        part, size, off = np.split(_cut(every, rows, columns) * scale[:, None, None], 3)
        spare = NET_ROUNDING * size + 2.0 * off
        return Interval(part - spare, part + spare)

    @cached_property
    def points(self) -> Interval:
        """(3, k, n) control points, whose hull contains each part."""
        h = _flat(self.net(0, 0))
        return h[:3] / h[3]

    @cached_property
    def polynomial(self) -> bool:
        """Are all weights one number, but for the roundoff of inserted knots?"""
        w = self.h[..., 3]
        return bool(np.ptp(w) <= POLYNOMIAL_WEIGHTS * np.abs(w).max())

    def normal_cones(self) -> tuple[Array, Array]:
        """(axis (n, 3), angle (n,)) of cones around x_u × x_v, angle pi where none is known.

        Points are taken relative to one of the part.
        """
        nets = [self.net(*order) for order in ((0, 0), (1, 0), (0, 1))]
        rational = bool(np.ptp(self.h[..., 3]) > 0.0)
        if rational:
            centre = interval(self.points.middle.mean(axis=1)[:, :, None, None])
            nets = [stacked([*(h[k] - centre[k] * h[3] for k in range(3)), h[3]]) for h in nets]
        p, q = (count - 1 for count in self.h.shape[1:3])
        sides = [self._collapsed(axis, end) for axis in (0, 1) for end in (0, 1)]
        collapsed = np.stack(sides, axis=1).astype(np.float64)
        found = np.empty((len(self.h), 4))
        rows = map(_coefficients, nets)
        net_cones(*rows, p, q, collapsed, rational, found)
        angle = found[:, 3] + CONE_ROUNDING
        return found[:, :3], np.where(angle < 0.5 * np.pi, angle, np.pi)

    def _collapsed(self, axis: int, end: int) -> NDArray[np.bool_]:
        """(n,) which parts begin (0) or end (1) along u or v at a side that is a single point."""
        at_end = self.ends[axis][end] == float(end)
        side = np.take(self.h, -end, axis=1 + axis)
        x = side[..., :3] / side[..., 3:]
        width = np.ptp(x, axis=1).max(axis=1)
        return np.asarray(at_end & (width <= NET_ROUNDING * np.abs(x).max(axis=(1, 2))))

    def heights(self, directions: Interval | Array) -> Interval:
        """(m, n) bounds of direction . x; directions (m, 3, n)."""
        rows = []
        given = interval(directions)
        for low, high in zip(given.lo, given.hi, strict=True):
            total = interval(0.0)
            for k in range(3):
                total = total + self.points[k] * Interval(low[k], high[k])
            rows.append(_held(total))
        return stacked(rows)

    def jets(self) -> Interval:
        """(3, 6, n) bounds of the jet."""
        centre = interval(self.points.middle.mean(axis=1)[:, None])
        offset = _held(self.points - centre)
        weights, nets = {}, {}
        for order in ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)):
            h = _flat(self.net(*order))
            nets[order], weights[order] = _held(h[:3] - centre * h[3]), _held(h[3])
        w = weights[0, 0]
        wu, wv, wuu, wuv, wvv = (weights[k] for k in ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2)))
        xu = (nets[1, 0] - offset * wu) / w
        xv = (nets[0, 1] - offset * wv) / w
        rows = (
            offset + centre[:, 0],
            xu,
            xv,
            (nets[2, 0] - xu * wu * 2.0 - offset * wuu) / w,
            (nets[1, 1] - xu * wv - xv * wu - offset * wuv) / w,
            (nets[0, 2] - xv * wv * 2.0 - offset * wvv) / w,
        )
        return Interval(np.stack([r.lo for r in rows], 1), np.stack([r.hi for r in rows], 1))


def _cut(net: Array, rows: Array, columns: Array) -> Array:
    """(c, n, i, j) from nets (n, a, b, c), rows (n, i, a) and columns (n, j, b)."""
    n, a, b, c = net.shape
    first = np.matmul(rows, net.reshape(n, a, b * c)).reshape(n, -1, b, c)
    return np.moveaxis(np.matmul(columns[:, None], first), -1, 0)


def _flat(net: Interval) -> Interval:
    """(..., k, n) coefficients in one row, from (..., n, i, j)."""
    n, i, j = net.lo.shape[-3:]
    rows = (np.moveaxis(c.reshape(*c.shape[:-3], n, i * j), -2, -1) for c in (net.lo, net.hi))
    return Interval(*rows)


def _coefficients(net: Interval) -> Array:
    """(n, 6 i j) rows of what a net (4, n, i, j) has of each coefficient: its vector, by how much
    that may be wrong, its weight, and the same of it.

    Sums of up to a hundred products of two are rounded by less than twice `NET_ROUNDING`.
    """
    x, w = net.middle[:3], net.middle[3]
    spare = 2.0 * NET_ROUNDING
    off = np.linalg.norm(net.radius[:3], axis=0) + spare * np.linalg.norm(x, axis=0)
    off_weight = net.radius[3] + spare * np.abs(w)
    every = np.stack([*x, off, w, off_weight], axis=-1)
    return every.reshape(len(every), -1)


def net_bounds(nets_over: Callable[[Boxes], CutNets], boxes: Boxes) -> PatchBounds:
    """Boxes, cones of normals and curvatures of a NURBS, over boxes that no knot crosses."""
    nets = nets_over(boxes)
    jets = JetBounds(boxes, lambda parts: nets_over(parts).jets())
    axis, angle = jets.normals()
    wide = np.flatnonzero(angle > WIDE_CONE)
    if len(wide):
        # the product of the nets gives narrower bounds than the mean value, at a higher cost
        other, closer = nets_over(boxes[wide]).normal_cones()
        axis[wide] = np.where((closer < angle[wide])[:, None], other, axis[wide])
        angle[wide] = np.minimum(closer, angle[wide])
    box = widened(nets.heights(np.eye(3)[..., None]))
    return PatchBounds(*box, axis, angle, *jets.curvatures())


def curve_nets(blocks: Array, breaks: Array, t: Interval) -> CutNets:
    """The nets of a curve's pieces (m, p + 1, 4), over ranges of t."""
    none, one = np.zeros_like(t.lo), np.ones_like(t.lo)
    boxes = Boxes(np.stack([t.lo, none], 1), np.stack([t.hi, one], 1))
    return CutNets(blocks[:, None, :, None], (breaks, np.array([0.0, 1.0])), boxes)


def _held(coefficients: Interval) -> Interval:
    """Bounds of values from those of the coefficients on the axis before the last."""
    return Interval(coefficients.lo.min(axis=-2), coefficients.hi.max(axis=-2))
