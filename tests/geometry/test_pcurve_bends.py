"""Boxes and bends of parts of trimming curves, against samples."""

from __future__ import annotations

import numpy as np
import pytest

from standoff.geometry.pcurve_boxes import pcurve_bends, pcurve_boxes
from standoff.kernels.body import layout as L


def homogeneous(kind: int, matrix: np.ndarray, t: np.ndarray) -> np.ndarray:
    one, zero = np.ones_like(t), np.zeros_like(t)
    rows = [t, zero, one] if kind == L.LINE else [np.cos(t), np.sin(t), one]
    return matrix @ np.array(rows)


def second(kind: int, matrix: np.ndarray, t: np.ndarray) -> np.ndarray:
    """(2, n) by Taylor's arithmetic of a quotient: from (h, h', h'')."""
    one, zero = np.ones_like(t), np.zeros_like(t)
    h = homogeneous(kind, matrix, t)
    if kind == L.LINE:
        first, other = matrix @ np.array([one, zero, zero]), np.zeros_like(h)
    else:
        first = matrix @ np.array([-np.sin(t), np.cos(t), zero])
        other = matrix @ np.array([-np.cos(t), -np.sin(t), zero])
    w, w1, w2 = h[2], first[2], other[2]
    inverse = 1.0 / w
    return np.asarray(
        other[:2] * inverse
        - 2.0 * first[:2] * w1 * inverse**2
        + h[:2] * (2.0 * w1**2 * inverse**3 - w2 * inverse**2)
    )


@pytest.mark.parametrize("kind", [L.LINE, L.CONIC])
def test_they_hold_all_samples_and_are_near_them(kind: int, rng: np.random.Generator) -> None:
    for _ in range(50):
        matrix = rng.normal(size=(3, 3))
        matrix[2, 2] = 0.3 + np.abs(matrix[2, :2]).sum()
        ends = np.sort(rng.uniform(0.0, 1.0, 4))
        bends = pcurve_bends(kind, matrix, ends)
        low, high = pcurve_boxes(kind, matrix, ends)
        for k in range(3):
            t = np.linspace(ends[k], ends[k + 1], 200)
            found = np.abs(second(kind, matrix, t)).max(axis=1)
            assert (found <= bends[k] * (1.0 + 1e-12)).all()
            scale = np.abs(second(kind, matrix, np.linspace(0.0, 1.0, 50))).max()
            assert (bends[k] <= 12.0 * found + 3.0 * scale + 1e-12).all()
            h = homogeneous(kind, matrix, t)
            places = (h[:2] / h[2]).T
            assert (places >= low[k] - 1e-12).all()
            assert (places <= high[k] + 1e-12).all()


def test_one_that_leaves_its_chart_has_no_bound() -> None:
    matrix = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
    assert np.isinf(pcurve_bends(L.CONIC, matrix, np.array([1.0, 2.0]))).all()
