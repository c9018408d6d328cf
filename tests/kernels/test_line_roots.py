"""Where lines meet trimming curves: every root is one, and none is missed."""

import numpy as np
import pytest
from numba import njit

from standoff.geometry import NurbsPcurve
from standoff.kernels.body import layout as L
from standoff.kernels.body import line_roots
from standoff.kernels.compiler.decorators import pointer

NOISE = 1e-14


@njit
def roots(block, u, v, du, dv):
    # kernels are compiled for pointers
    return line_roots.line_roots(pointer(block, 0), L.BEZIER, 2, u, v, du, dv, NOISE)


def convex_pieces(degree, rng):
    """Pieces of a random rational pcurve, each turning by less than 180 degrees."""
    count = degree + 3
    knots = np.concatenate([[0.0] * degree, np.sort(rng.uniform(0, 3, 4)), [3.0] * degree])
    curve = NurbsPcurve(rng.normal(size=(count, 2)), knots, rng.uniform(0.3, 3, count))
    return curve.pieces(knots[degree], knots[count])


@pytest.mark.parametrize("degree", [1, 2, 3, 5, 9])
def test_roots_lie_on_the_line_and_none_is_missed(degree, rng):
    met = 0
    for _ in range(12):
        for piece, first, last in convex_pieces(degree, rng):
            block = np.concatenate([[first, last], piece.data])
            ts = np.linspace(first, last, 400)
            points = np.array([piece.point(t)[:2] for t in ts])
            for _ in range(25):
                start = points[rng.integers(len(points))] + rng.choice([0, 1e-9, 0.3]) * rng.normal(
                    size=2
                )
                way = 10.0 ** rng.uniform(-12, 0) * rng.normal(size=2)
                left = np.array([-way[1], way[0]]) / np.linalg.norm(way)
                heights = (points - start) @ left
                clear = np.abs(heights).max() * 1e-9 + 1e-13
                crossed = [
                    k
                    for k in range(399)
                    if heights[k] * heights[k + 1] < 0.0
                    and min(abs(heights[k]), abs(heights[k + 1])) > clear
                ]
                number, *found = roots(block, *start, *way)
                found = found[: max(number, 0)]
                for t in found:
                    on = piece.point(min(max(t, first), last))[:2]
                    assert abs((on - start) @ left) <= 1e-11 * (1 + np.abs(points).max())
                for k in crossed:
                    assert number == line_roots.TOUCHING_LINE or any(
                        ts[k] <= t <= ts[k + 1] for t in found
                    )
                    met += 1
    assert met > 100
