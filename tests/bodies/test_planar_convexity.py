"""Planar bodies are proven convex, not sampled."""

from __future__ import annotations

import numpy as np
import pytest

import standoff as so
from shares import share
from standoff.geometry import ConicArc, FormulaCurve, Line, NurbsCurve

LOWER_HALF = ConicArc([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], np.pi, 2.0 * np.pi)


def lid(height: float, width: float) -> NurbsCurve:
    """From (1, 0) to (-1, 0), straight but for a bump or dent near x = 0.1234."""
    near = -0.1234 + width * np.arange(-3.0, 4.0)
    knots = np.concatenate([[-1.0] * 4, [-0.8], near, [0.8], [1.0] * 4])
    x = np.array([-knots[i + 1 : i + 4].mean() for i in range(len(knots) - 4)])
    y = np.where(np.arange(len(x)) == len(x) // 2, height, 0.0)
    return NurbsCurve(np.column_stack([x, y, np.zeros(len(x))]), knots)


@pytest.mark.parametrize(("width", "height"), share(3, [1e-3, 1e-2, 0.1], [1e-2, -1e-2, 1e-4]))
def test_a_narrow_bump_or_dent_is_refused(height: float, width: float) -> None:
    with pytest.raises(so.BodyError, match="Not convex"):
        so.shapes.planar_loop([lid(height, width), LOWER_HALF])


def test_a_formula_with_a_narrow_dent_is_refused() -> None:
    y = "(1 - t**2)*0.2 - 0.001*exp(-(1000*(t - 0.1234))**2)*(1 - t**2)"
    with pytest.raises(so.BodyError, match="Not convex"):
        so.shapes.planar_loop([FormulaCurve("-t", y, "0", -1.0, 1.0), LOWER_HALF])


def test_curves_tell_how_they_were_proven() -> None:
    dome = FormulaCurve("-t", "(1 - t**2)*0.2", "0", -1.0, 1.0)
    report = so.shapes.planar_loop([dome, LOWER_HALF]).check()
    assert [(p.surface, p.method, p.convex) for p in report.patches] == [
        ("FormulaCurve", "interval", True),
        ("ConicArc", "theorem", True),
    ]
    assert report.slack == 0.0


def test_a_circle_of_quarter_arcs_with_double_knots_is_convex() -> None:
    s = np.sqrt(0.5)
    points = [(1, 0, 0), (1, 1, 0), (0, 1, 0), (-1, 1, 0), (-1, 0, 0)]
    half = NurbsCurve(points, [0, 0, 0, 1, 1, 2, 2, 2], [1, s, 1, s, 1])
    report = so.shapes.planar_loop([half, LOWER_HALF]).check()
    assert all(p.convex for p in report.patches)


def test_a_corner_inside_a_curve_is_refused() -> None:
    roof = NurbsCurve([(1, 0, 0), (0, 1, 0), (-1, 0, 0)], [0, 0, 1, 2, 2])
    with pytest.raises(so.BodyError, match="corner at its knot 1: split it there"):
        so.shapes.planar_loop([roof, LOWER_HALF])


def test_a_loop_that_runs_round_twice_is_refused() -> None:
    corners = [np.array([np.cos(t), np.sin(t), 0.0]) for t in 0.5 * np.pi * np.arange(8)]
    lines = [Line(corners[k], corners[(k + 1) % 8]) for k in range(8)]
    with pytest.raises(so.BodyError, match="turns 2 times"):
        so.shapes.planar_loop(lines)


def test_a_hollow_corner_is_refused() -> None:
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0.5, 0.9999, 0), (0, 1, 0)]
    lines = [Line(corners[k], corners[(k + 1) % 5]) for k in range(5)]
    with pytest.raises(so.BodyError, match=r"corner 3 .* is hollow by 0\.0229 degrees"):
        so.shapes.planar_loop(lines)
