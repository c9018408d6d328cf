"""Bounds of a trimming curve's second derivatives, and the parts that an edge is cut into."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from standoff.geometry import NurbsCurve, RationalBezier
from standoff.geometry.bernstein import segment
from standoff.geometry.pcurve_boxes import bezier_bend
from standoff.solids.spatial.trims import edge_ranges


def places(points: np.ndarray, ts: np.ndarray) -> np.ndarray:
    """(n, 2) of a rational Bezier curve's homogeneous points, by de Casteljau's rule."""
    rows = np.broadcast_to(points, (len(ts), *points.shape)).copy()
    while rows.shape[1] > 1:
        rows = (1.0 - ts[:, None, None]) * rows[:, :-1] + ts[:, None, None] * rows[:, 1:]
    return np.asarray(rows[:, 0, :2] / rows[:, 0, 2:])


@given(st.integers(0, 10_000), st.integers(1, 7), st.floats(0.0, 2.0))
def test_no_second_difference_is_above_the_bound(seed: int, degree: int, spread: float) -> None:
    rng = np.random.default_rng(seed)
    weights = np.exp(rng.uniform(-spread, spread, degree + 1))
    points = np.column_stack([rng.normal(size=(degree + 1, 2)) * weights[:, None], weights])
    first, last = np.sort(rng.uniform(size=2))
    part = segment(degree, first, last) @ points
    bound = bezier_bend(part)
    h = 1e-3
    ts = np.linspace(h, 1.0 - h, 301)
    bends = (places(part, ts + h) - 2.0 * places(part, ts) + places(part, ts - h)) / h**2
    scale = float(np.abs(places(part, ts)).max())
    assert (np.abs(bends).max(axis=0) <= bound * (1.0 + 1e-9) + 1e-8 * scale).all()


def test_the_bound_of_a_polynomial_curve_shrinks_to_its_bend() -> None:
    points = np.array([[0.0, 0.0, 1.0], [1.0, 3.0, 1.0], [2.0, -1.0, 1.0], [3.0, 0.0, 1.0]])
    at, h = 0.3, 1e-3
    part = segment(3, at, at + h) @ points
    _, v = places(points, np.array([at - 1e-4, at, at + 1e-4])).T
    true = abs(v[0] - 2.0 * v[1] + v[2]) / 1e-8
    assert bezier_bend(part)[1] / h**2 == pytest.approx(true, rel=1e-2)


@given(st.integers(0, 10_000), st.floats(0.1, 1.5), st.floats(0.05, 2.0))
def test_each_part_of_a_spline_turns_little_and_is_short(
    seed: int, arc: float, longest: float
) -> None:
    rng = np.random.default_rng(seed)
    points = np.cumsum(rng.uniform(0.2, 1.0, (6, 3)), axis=0)
    curve = NurbsCurve(points, [0.0] * 4 + [0.4, 0.7] + [1.0] * 4)
    parts = edge_ranges(curve, arc, longest)
    assert parts[0][0] == 0.0
    assert parts[-1][1] == 1.0
    for (first, last), following in zip(parts, [*parts[1:], None], strict=True):
        assert following is None or following[0] == last
        ts = np.linspace(first, last, 41)
        spots = np.array([curve.point(t) for t in ts])
        reach = float(np.linalg.norm(np.diff(spots, axis=0), axis=1).sum())
        tangents = np.array([curve.jet(t)[1] for t in ts])
        tangents /= np.linalg.norm(tangents, axis=1)[:, None]
        turn = float(np.arccos(np.clip(tangents @ tangents[20], -1.0, 1.0)).max())
        deepest = last - first <= 2.0**-5
        assert deepest or (reach <= longest * (1.0 + 1e-9) and turn <= arc)


def test_a_straight_spline_is_one_part() -> None:
    curve = RationalBezier([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (2.0, 0.0, 0.0)])
    assert edge_ranges(curve, 0.6, 10.0) == [(0.0, 1.0)]
