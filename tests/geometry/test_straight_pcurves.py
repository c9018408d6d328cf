"""Straight trimming curves have no inflections by roundoff; segments of Bernstein polynomials."""

from __future__ import annotations

import numpy as np

from standoff.geometry.bernstein import basis, segments
from standoff.geometry.nurbs_pcurves import NurbsPcurve


def test_a_straight_spline_is_one_piece_a_span(rng: np.random.Generator) -> None:
    """Its v is constant up to the roundoff of the conversion to spans."""
    inner = np.sort(rng.uniform(0.0, 2.9, 21))
    knots = np.concatenate([np.zeros(4), inner, np.full(4, 2.9)])
    u = np.array([knots[i + 1 : i + 4].mean() for i in range(len(knots) - 4)])
    for level in (0.16503843, 31.7, -2e3):
        line = NurbsPcurve(np.column_stack([u, np.full_like(u, level)]), knots)
        assert len(line.pieces(0.0, 2.9)) == 22


def test_a_bend_is_still_found() -> None:
    points = np.array([[0.0, 5.0], [1.0, 5.0 + 1e-6], [2.0, 5.0 - 1e-6], [3.0, 5.0]])
    wave = NurbsPcurve(points, np.array([0.0, 0, 0, 0, 1, 1, 1, 1]))
    assert len(wave.pieces(0.0, 1.0)) == 2


def test_segments(rng: np.random.Generator) -> None:
    first, last = rng.uniform(0.0, 1.0, (2, 50))
    s = rng.uniform(0.0, 1.0, 7)
    for degree in (0, 1, 4, 9):
        matrices = segments(degree, first, last)
        whole = basis(degree, first[:, None] + (last - first)[:, None] * s)
        np.testing.assert_allclose(basis(degree, s) @ matrices, whole, rtol=0.0, atol=4e-15)
        assert matrices.min() >= 0.0
        whole = segments(degree, np.zeros(1), np.ones(1))[0]
        np.testing.assert_array_equal(whole, np.eye(degree + 1))
