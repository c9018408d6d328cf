"""Snyder's global minimisation: boxes of parameters, bounds on them, Newton where they are convex.

Nothing is kept from frame to frame.
"""

from __future__ import annotations

from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.geometry.boxes import Boxes
from standoff.geometry.intervals import Interval
from standoff.typing import Array
from standoff_studies.paper.field.newton import CONVERGED, Pair, Spots, hessian_of, slopes_of
from standoff_studies.paper.field.shells import VECTORS, Shell, Spot, held
from standoff_studies.paper.field.support import Lost

MOST_BOXES = 20_000
"""Pairs of boxes after which a frame gives up."""

MOST_STEPS = 30
"""Newton steps in a convex box, which converge there unless its sides hold them."""

FINEST = 1e-9
"""How far a point moves over a box that is not divided further [length]: less than the error that
`CONVERGED` leaves. At a side that has collapsed to a point that is soon so."""


class Jets(NamedTuple):
    """Bounds of points (3, m), tangents and second derivatives of one body over m boxes."""

    x: Interval
    tangents: list[Interval]
    bends: dict[tuple[int, int], Interval]


def _jets(shell: Shell, patch: int, low: Array, high: Array) -> Jets:
    """Bounds over boxes (m, n); each different box is counted once."""
    n = shell.n
    shell.vectors += VECTORS[n][2] * len(np.unique(np.hstack([low, high]), axis=0))
    if n == 0:
        point = np.repeat(np.asarray(shell.body.vertex_points).reshape(3, 1), len(low), axis=1)
        rows = [Interval(point, point)]
    else:
        t = Boxes(low, high) if n == 2 else Interval(low[:, 0], high[:, 0])
        bounds = shell.patches[patch].jets_over(t)
        rows = [bounds[:, k] for k in range(bounds.lo.shape[1])]
    rows = [_turned(shell.rotation, row) for row in rows]
    at = [(i, j) for i in range(n) for j in range(i, n)]
    bends = dict(zip(at, rows[1 + n :], strict=True))
    return Jets(rows[0] + shell.shift[:, None], rows[1 : 1 + n], bends)


def _turned(rotation: Array, x: Interval) -> Interval:
    rows = [x[0] * r[0] + x[1] * r[1] + x[2] * r[2] for r in rotation.tolist()]
    return Interval(np.stack([r.lo for r in rows]), np.stack([r.hi for r in rows]))


def _dot(a: Interval, b: Interval) -> Interval:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


class _Bounds(NamedTuple):
    """Over m pairs of boxes: a lower bound of the distance, the gradient's, which are convex, and
    how far a parameter moves its point."""

    least: Array
    low: Array
    high: Array
    convex: NDArray[np.bool_]
    widths: Array


def _bounds(shells: Pair, patches: tuple[int, int], low: Array, high: Array) -> _Bounds:
    n = shells[0].n
    a = _jets(shells[0], patches[0], low[:, :n], high[:, :n])
    b = _jets(shells[1], patches[1], low[:, n:], high[:, n:])
    r = a.x - b.x
    apart = np.maximum(np.maximum(r.lo, -r.hi), 0.0)
    tangents = [*a.tangents, *(-t for t in b.tangents)]
    slopes = [_dot(t, r) for t in tangents]
    size = len(tangents)
    middle, spread = np.zeros((len(low), size, size)), np.zeros((len(low), size, size))
    for i in range(size):
        for j in range(i, size):
            entry = _dot(tangents[i], tangents[j])
            if j < n:
                entry = entry + _dot(a.bends[i, j], r)
            elif i >= n:
                entry = entry - _dot(b.bends[i - n, j - n], r)
            middle[:, i, j] = middle[:, j, i] = 0.5 * (entry.lo + entry.hi)
            spread[:, i, j] = spread[:, j, i] = 0.5 * (entry.hi - entry.lo)
    sized = [np.linalg.norm(np.maximum(np.abs(t.lo), np.abs(t.hi)), axis=0) for t in tangents]
    convex = np.linalg.eigvalsh(middle)[:, 0] > np.linalg.norm(spread, axis=(1, 2))
    return _Bounds(
        np.linalg.norm(apart, axis=0),
        np.stack([s.lo for s in slopes], axis=1),
        np.stack([s.hi for s in slopes], axis=1),
        convex,
        np.stack(sized, axis=1) * (high - low),
    )


class _Best:
    """The least distance so far, and where."""

    def __init__(self, shells: Pair) -> None:
        self.shells, self.far = shells, np.inf
        self.spots: Spots = (Spot(0, np.zeros(shells[0].n)), Spot(0, np.zeros(shells[1].n)))
        self.points = np.zeros((2, 3))

    def note(self, patches: tuple[int, int], q: Array, points: Array) -> None:
        far = float(np.linalg.norm(points[0] - points[1]))
        if far < self.far:
            n = self.shells[0].n
            self.far, self.points = far, points
            self.spots = Spot(patches[0], q[:n]), Spot(patches[1], q[n:])

    def newton(self, patches: tuple[int, int], low: Array, high: Array) -> None:
        """The least distance in a convex box."""
        n, q = self.shells[0].n, 0.5 * (low + high)
        width = np.where(high > low, high - low, 1.0)
        for _ in range(MOST_STEPS):
            spots = Spot(patches[0], q[:n]), Spot(patches[1], q[n:])
            jets = [s.jet(spot, 2) for s, spot in zip(self.shells, spots, strict=True)]
            self.note(patches, q, np.array([jet.x for jet in jets]))
            r, slope, tangents = slopes_of(jets)
            free = ~held((q - low) / width, slope, tangents) & (high > low)
            lengths = np.linalg.norm(tangents[free], axis=1) * np.linalg.norm(r)
            if (np.abs(slope[free]) <= CONVERGED * lengths).all():
                return
            step = np.zeros(len(q))
            inner = hessian_of(jets, r)[np.ix_(free, free)]
            step[free] = -np.linalg.lstsq(inner, slope[free], rcond=None)[0]
            q = np.clip(q + step, low, high)


def minimise(shells: Pair, spots: Spots) -> tuple[Spots, Array]:
    """The global minimum from all boxes: places, and the witness points (2, 3).

    A box is dropped if it is too far, or if the distance falls along a parameter all over it and it
    does not end at a side of the patch, where it shrinks to that side. Where H is definite all over
    a box, Newton's iteration finds its minimum.
    """
    best, n = _Best(shells), shells[0].n + shells[1].n
    pairs = list(product(range(len(shells[0].patches)), range(len(shells[1].patches))))
    boxes = {pair: (np.zeros((1, n)), np.ones((1, n))) for pair in pairs}
    seen = 0
    while boxes:
        for pair in list(boxes):
            low, high = boxes.pop(pair)
            seen += len(low)
            if seen > MOST_BOXES:
                raise Lost("the boxes did not come to an end")
            low, high = _left(best, pair, low, high)
            if len(low):
                boxes[pair] = low, high
    return best.spots, best.points


def _left(best: _Best, pair: tuple[int, int], low: Array, high: Array) -> tuple[Array, Array]:
    """What is left to look at of some boxes of one pair of patches, halved."""
    bounds = _bounds(best.shells, pair, low, high)
    best_first = np.argsort(bounds.least)
    for k in best_first[:1].tolist():
        if bounds.least[k] < best.far:
            _middle(best, pair, 0.5 * (low[k] + high[k]))
    kept = bounds.least < best.far
    falls, rises = bounds.high < 0.0, bounds.low > 0.0
    inside = (falls & (high < 1.0)) | (rises & (low > 0.0))
    kept &= ~(inside & (high > low)).any(axis=1)
    low, high = np.where(falls, high, low), np.where(rises, low, high)
    for k in best_first[(kept & bounds.convex)[best_first]].tolist():
        if bounds.least[k] < best.far:
            best.newton(pair, low[k], high[k])
    kept &= ~bounds.convex & (bounds.least < best.far)
    widths = bounds.widths * (high > low)
    fine = widths.max(axis=1) <= FINEST
    for k in np.flatnonzero(kept & fine).tolist():
        _middle(best, pair, 0.5 * (low[k] + high[k]))
    kept &= ~fine
    low, high, widths = low[kept], high[kept], widths[kept]
    if not len(low):
        return low, high
    halves = Boxes(low, high).halves(np.argmax(widths, axis=1))
    return halves.low, halves.high


def _middle(best: _Best, pair: tuple[int, int], q: Array) -> None:
    n = best.shells[0].n
    spots = Spot(pair[0], q[:n]), Spot(pair[1], q[n:])
    points = [s.jet(spot, 0).x for s, spot in zip(best.shells, spots, strict=True)]
    best.note(pair, q, np.array(points))
