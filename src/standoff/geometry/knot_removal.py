"""Removal of a spline's redundant knots, found from its control points.

Inserted knots do not change a surface, but cut it into spans. Over a span of h of the domain,
control points rounded by eps make tangents wrong by eps/h and curvatures by eps/h^2. So jets and
proofs use the spline with the fewest knots, its *essential* ones. The control points there are a
least-squares solution, and how far the surface has moved is bounded by inserting the knots again:
two splines over the same knots are no farther apart than their control points.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from standoff.geometry.knots import KnotVector, insertion
from standoff.geometry.tolerances import SAME_WEIGHTS, SPARE_KNOT
from standoff.typing import Array

# Up to so many control points a dense solution is faster than a banded one.
FEW_POINTS = 24
# Solutions of the normal equations: the first, and two that refine it.
REFINEMENTS = 3


@dataclass(frozen=True, eq=False)
class PointSpread:
    """Where homogeneous control points lie: a centre (3,), and the greatest distances of the points
    from it and from the origin, length."""

    centre: Array
    radius: float
    reach: float

    @staticmethod
    def of(h: Array) -> PointSpread:
        """Of points (..., 4), components (w x, w y, w z, w)."""
        points = (h[..., :3] / h[..., 3:]).reshape(-1, 3)
        low, high = points.min(axis=0), points.max(axis=0)
        reach = float(np.linalg.norm(np.maximum(np.abs(low), np.abs(high))))
        return PointSpread(0.5 * (low + high), 0.5 * float(np.linalg.norm(high - low)), reach)

    @property
    def limit(self) -> float:
        """How far a spline may move when a knot is removed, length."""
        return SPARE_KNOT * max(2.0 * self.radius, self.reach)

    def moved(self, h: Array, other: Array) -> float:
        """A bound on the distance between splines with the same knots, at equal parameters.

        With x = sum B h / sum B w, the other's point minus x is sum B (dX - x dw) / sum B w', and
        so no longer than the greatest |dX - x dw| / w'. inf if a weight is not positive.
        """
        if float(other[..., 3].min()) <= 0.0:
            return np.inf
        change = other - h
        off = np.linalg.norm(change[..., :3] - change[..., 3:] * self.centre, axis=-1)
        off = off + self.radius * np.abs(change[..., 3])
        return float((off / other[..., 3]).max())


def essential_net(
    u: KnotVector, v: KnotVector, h: Array
) -> tuple[KnotVector, KnotVector, Array, float]:
    """A surface's homogeneous control points (n, m, 4) on its essential knots.

    Returns
    -------
    (u, v, points, moved) : knot vectors, points (n', m', 4), and a bound on how far the surface has
        moved, length.
    """
    place = PointSpread.of(h)
    u_less, net = _along_first(u, h, place)
    v_less, net = _along_first(v, net.swapaxes(0, 1), place)
    net = net.swapaxes(0, 1)
    moved = _moved_net(u, v, u_less, v_less, h, net, place)
    if moved > place.limit:  # each direction stays within the limit, but not both together
        v_less, (u_less, net) = v, _along_first(u, h, place)
        moved = _moved_net(u, v, u_less, v_less, h, net, place)
    if u_less is u and v_less is v:
        return u, v, h, 0.0
    return u_less, v_less, net, moved


def essential_row(vector: KnotVector, h: Array) -> tuple[KnotVector, Array, float]:
    """As `essential_net`, for a curve's homogeneous control points (n, 4)."""
    place = PointSpread.of(h)
    less, row = _along_first(vector, h[:, None], place)
    if less is vector:
        return vector, h, 0.0
    return less, row[:, 0], place.moved(h, _inserted_again(vector, less) @ row[:, 0])


def _moved_net(
    u: KnotVector,
    v: KnotVector,
    u_less: KnotVector,
    v_less: KnotVector,
    h: Array,
    net: Array,
    place: PointSpread,
) -> float:
    rows, columns = _inserted_again(u, u_less), _inserted_again(v, v_less)
    return place.moved(h, np.einsum("ia,abc,jb->ijc", rows, net, columns))


def _along_first(vector: KnotVector, h: Array, place: PointSpread) -> tuple[KnotVector, Array]:
    """(n, m, 4) points without the redundant knots along their first axis."""
    left_out: list[float] = []
    found = vector, h
    waiting = [group] if (group := _candidates(vector, h, place)) else []
    while waiting:
        # usually all together; if that moves the surface too far, as many as possible
        group = waiting.pop(0)
        less, points, moved = _without(vector, [*left_out, *group], h, place)
        if moved <= place.limit:
            left_out, found = [*left_out, *group], (less, points)
        elif len(group) > 1:
            middle = len(group) // 2
            waiting = [group[:middle], group[middle:], *waiting]
    return found


def _candidates(vector: KnotVector, h: Array, place: PointSpread) -> list[float]:
    """Inner knots that can each be removed alone, each as often as possible."""
    p, t = vector.degree, vector.knots
    found: list[float] = []
    for knot in vector.breaks[1:-1].tolist():
        times = vector.multiplicity(knot)
        first = int(np.searchsorted(t, knot))
        near = KnotVector(t[first - p - 1 : first + times + p + 1], p)
        part = h[first - p - 1 : first + times]
        if times > 1 and _without(near, [knot], part, place)[2] > place.limit:
            continue  # then it cannot be removed more often
        for count in range(times, 0, -1):
            if _without(near, [knot] * count, part, place)[2] <= place.limit:
                found += [knot] * count
                break
    return found


def _without(
    vector: KnotVector, left_out: Sequence[float], h: Array, place: PointSpread
) -> tuple[KnotVector, Array, float]:
    """The spline without some of its knots whose control points fit best, and `Place.moved`."""
    knots = vector.knots.tolist()
    for knot in left_out:
        knots.remove(knot)
    less = KnotVector(np.array(knots), vector.degree)
    again = _inserted_again(vector, less)
    # each point scaled by its weight, so that points of small weight are as exact as others
    scale = 1.0 / h[..., 3].mean(axis=1)[:, None]
    matrix, rows = again * scale, h.reshape(len(h), -1) * scale
    points = np.empty((less.count, rows.shape[1]))
    # with clamped knots the end points stay the same, bit for bit
    kept = [k for k, i in ((0, 0), (-1, -1)) if matrix[i, k] == scale[i, 0]]
    inner = slice(1 if 0 in kept else 0, -1 if -1 in kept else None)
    for k in kept:
        points[k] = h[k].ravel()
        rows = rows - matrix[:, k, None] * points[k]
    points[inner] = _fitted(matrix[:, inner], rows, vector.degree)
    points = points.reshape(less.count, *h.shape[1:])
    weights = points[..., 3]
    if float(np.ptp(h[..., 3])) <= SAME_WEIGHTS * float(h[..., 3].max()):
        weights[:] = h[0, 0, 3]
    return less, points, place.moved(h, np.tensordot(again, points, 1))


def _fitted(matrix: Array, rows: Array, degree: int) -> Array:
    """The least-squares solution of a matrix with a band of nonzero numbers.

    Its normal equations have `degree` diagonals on each side; what they lose of the digits, two
    steps of refinement give back.
    """
    if matrix.shape[1] <= FEW_POINTS:
        return np.asarray(np.linalg.lstsq(matrix, rows, rcond=None)[0])
    sparse = scipy.sparse.csr_array(matrix)
    normal = (sparse.T @ sparse).todia()
    band = np.zeros((degree + 1, matrix.shape[1]))
    for row, offset in zip(normal.data, normal.offsets, strict=True):
        if 0 <= offset <= degree:
            band[degree - offset, : len(row)] = row
    factor = scipy.linalg.cholesky_banded(band)
    found = np.zeros((matrix.shape[1], rows.shape[1]))
    for _ in range(REFINEMENTS):
        rest = sparse.T @ (rows - sparse @ found)
        found += scipy.linalg.cho_solve_banded((factor, False), rest)
    return found


def _inserted_again(vector: KnotVector, less: KnotVector) -> Array:
    """The matrix (n, n') from the points on fewer knots to those on all."""
    values, counts = np.unique(vector.knots, return_counts=True)
    missing = [
        knot
        for knot, count in zip(values.tolist(), counts.tolist(), strict=True)
        for _ in range(count - less.multiplicity(knot))
    ]
    return insertion(less, missing)[1]
