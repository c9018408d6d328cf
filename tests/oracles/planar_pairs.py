"""Two planar loops by brute force: every feature of one against every feature of the other.

A pair's distance is the least over all pairs of features. Vertices are points; a curve's candidate
is where the distance is stationary inside the curve. Nothing is carried from one pose to the next.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .loops import Curve

Array = NDArray[Any]
Feature = tuple[str, int]
"""("vertex", i), where curve i begins, or ("curve", i)."""

SAMPLES = 17
"""Points of a curve before refinement."""
NEWTON_STEPS = 30
AT_REST = 1e-15
"""Change of a parameter at which Newton's method has come to rest."""
STATIONARY = 1e-11
"""Slope of the squared distance along a unit tangent, over the distance, at a stationary point."""
WORSE = 1e-9
"""The least distance may not be this much greater than that of the samples: a pair was missed."""


class Nearest(NamedTuple):
    """Least distances at n relative poses, and where.

    ``distance`` (n,); ``point_a``, ``point_b`` (n, 2) in A's axes; ``pair`` (n,) numbers into
    ``PlanarPair.pairs``; ``parameters`` (n, 2), nan for a vertex.
    """

    distance: Array
    point_a: Array
    point_b: Array
    pair: Array
    parameters: Array


class PlanarPair:
    """Two loops of curves, each counter-clockwise, in the plane."""

    def __init__(self, loop_a: Sequence[Curve], loop_b: Sequence[Curve]) -> None:
        self.loops = list(loop_a), list(loop_b)
        self.pairs = [
            (first, second)
            for first in self._features(self.loops[0])
            for second in self._features(self.loops[1])
        ]

    @staticmethod
    def _features(loop: list[Curve]) -> list[Feature]:
        return [(kind, k) for k in range(len(loop)) for kind in ("vertex", "curve")]

    def nearest(self, turns: ArrayLike, shifts: ArrayLike) -> Nearest:
        """Return the least distances with B turned by (n, 2, 2) and shifted by (n, 2) in A's axes.

        Raises
        ------
        ArithmeticError
            Samples of the curves lie closer than every stationary pair.
        """
        turn, shift = np.asarray(turns, dtype=float), np.asarray(shifts, dtype=float)
        found = [self.held(pair, turn, shift) for pair in self.pairs]
        best = np.argmin([row.distance for row in found], axis=0)
        rows = np.arange(len(shift))
        answer = Nearest(
            np.stack([row.distance for row in found])[best, rows],
            np.stack([row.point_a for row in found])[best, rows],
            np.stack([row.point_b for row in found])[best, rows],
            best,
            np.stack([row.parameters for row in found])[best, rows],
        )
        sampled = np.min([self._sampled(i, j, turn, shift)[0] for i, j in self._curves()], axis=0)
        if (answer.distance > sampled + WORSE).any():
            raise ArithmeticError("a pair of samples lies closer than every stationary pair")
        return answer

    def held(self, pair: tuple[Feature, Feature], turn: Array, shift: Array) -> Nearest:
        """Return one pair's stationary points; the distance is inf where none is inside."""
        (kind_a, i), (kind_b, j) = pair
        q = np.full((len(shift), 2), np.nan)
        free = kind_a == "curve", kind_b == "curve"
        if any(free):
            q[:] = self._start(pair, turn, shift)
            q[:, ~np.array(free)] = 0.0
            inside = self._refine((i, j), free, q, turn, shift)
        else:
            inside = np.ones(len(shift), dtype=bool)
            q[:] = 0.0
        a, b = self._jets((i, j), q, turn, shift)
        distance = np.where(inside, np.linalg.norm(a[0] - b[0], axis=1), np.inf)
        q[:, ~np.array(free)] = np.nan
        return Nearest(distance, a[0], b[0], np.zeros(len(shift), dtype=int), q)

    def _curves(self) -> list[tuple[int, int]]:
        return [(i, j) for i in range(len(self.loops[0])) for j in range(len(self.loops[1]))]

    def _start(self, pair: tuple[Feature, Feature], turn: Array, shift: Array) -> Array:
        (kind_a, i), (kind_b, j) = pair
        grids = [
            np.linspace(0.0, 1.0, SAMPLES) if kind == "curve" else np.zeros(1)
            for kind in (kind_a, kind_b)
        ]
        _, at = self._sampled(i, j, turn, shift, grids)
        return np.column_stack([grids[0][at[0]], grids[1][at[1]]])

    def _sampled(
        self, i: int, j: int, turn: Array, shift: Array, grids: Sequence[Array] | None = None
    ) -> tuple[Array, tuple[Array, ...]]:
        """Return least distances of samples (n,), and the samples' numbers on both curves."""
        grid_a, grid_b = grids or [np.linspace(0.0, 1.0, SAMPLES)] * 2
        a = self.loops[0][i].jet(grid_a)[0]
        b = self.loops[1][j].jet(grid_b)[0]
        least, at = np.empty(len(shift)), np.empty(len(shift), dtype=int)
        # By parts: all poses at once would take gigabytes.
        for part in np.array_split(np.arange(len(shift)), max(1, len(shift) // 500)):
            world = np.einsum("nij,kj->nki", turn[part], b) + shift[part, None]
            gaps = a[None, :, None] - world[:, None]
            squared = (gaps * gaps).sum(axis=3).reshape(len(part), -1)
            at[part] = squared.argmin(axis=1)
            least[part] = np.sqrt(squared[np.arange(len(part)), at[part]])
        return least, np.unravel_index(at, (len(a), len(b)))

    def _jets(self, curves: tuple[int, int], q: Array, turn: Array, shift: Array) -> list[Any]:
        """Return point and derivatives of both curves at parameters (n, 2), in A's axes."""
        a = self.loops[0][curves[0]].jet(q[:, 0])
        b = [np.einsum("nij,nj->ni", turn, x) for x in self.loops[1][curves[1]].jet(q[:, 1])]
        return [a, (b[0] + shift, b[1], b[2])]

    def _refine(
        self,
        curves: tuple[int, int],
        free: tuple[bool, bool],
        q: Array,
        turn: Array,
        shift: Array,
    ) -> Array:
        """Newton's method on the squared distance, in place; returns which ended inside."""
        fixed = ~np.array(free)
        for _ in range(NEWTON_STEPS):
            slope, bend, _ = self._derivatives(curves, q, turn, shift)
            slope[:, fixed] = 0.0
            for k in np.flatnonzero(fixed):
                bend[:, k], bend[:, :, k] = 0.0, 0.0
                bend[:, k, k] = 1.0
            step = -np.linalg.solve(bend, slope[:, :, None])[:, :, 0]
            # Far steps lead to other stationary points, or out of the curve for good.
            q += np.clip(step, -0.25, 0.25)
            q[:, list(free)] = np.clip(q[:, list(free)], -0.5, 1.5)
            if np.abs(step).max() <= AT_REST:
                break
        slope, bend, scale = self._derivatives(curves, q, turn, shift)
        still = (np.abs(slope) <= STATIONARY * scale)[:, ~fixed].all(axis=1)
        within = ((q > 0.0) & (q < 1.0))[:, ~fixed].all(axis=1)
        return still & within

    def _derivatives(
        self, curves: tuple[int, int], q: Array, turn: Array, shift: Array
    ) -> tuple[Array, Array, Array]:
        """Return gradient (n, 2), Hessian (n, 2, 2) of |a - b|²/2, and the gradient's scale."""
        (a, ua, uaa), (b, vb, vbb) = self._jets(curves, q, turn, shift)
        gap = a - b
        slope = np.column_stack([(gap * ua).sum(axis=1), -(gap * vb).sum(axis=1)])
        bend = np.empty((len(q), 2, 2))
        bend[:, 0, 0] = (ua * ua).sum(axis=1) + (gap * uaa).sum(axis=1)
        bend[:, 1, 1] = (vb * vb).sum(axis=1) - (gap * vbb).sum(axis=1)
        bend[:, 0, 1] = bend[:, 1, 0] = -(ua * vb).sum(axis=1)
        speeds = np.column_stack([np.linalg.norm(ua, axis=1), np.linalg.norm(vb, axis=1)])
        return slope, bend, speeds * np.linalg.norm(gap, axis=1)[:, None]
