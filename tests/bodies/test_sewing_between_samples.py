"""What sides do between the points that a coarse grid sees."""

from __future__ import annotations

import numpy as np
import pytest

import standoff as so
from standoff.geometry import BezierPatch, NurbsPcurve, NurbsSurface

WIDTHS = (1e-3, 3e-3, 1e-2)


def quad(a, b, c, d) -> BezierPatch:
    return BezierPatch(np.array([[a, b], [d, c]], dtype=float))


def cube_with_a_lip(height: float, width: float) -> list:
    """A cube whose plane top juts out at y = 1 by two thirds of the height, near x = 0.1234."""
    near = 0.1234 + width * np.arange(-3.0, 4.0)
    knots = np.concatenate([[-1.0] * 4, [-0.8], near, [0.8], [1.0] * 4])
    x = np.array([knots[i + 1 : i + 4].mean() for i in range(len(knots) - 4)])
    one = np.ones_like(x)
    points = np.stack([np.column_stack([x, -one, one]), np.column_stack([x, one, one])], axis=1)
    points[len(x) // 2, 1, 1] += height
    return [
        NurbsSurface(points, knots, [0.0, 0.0, 1.0, 1.0]),
        quad((-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1)),
        quad((-1, -1, -1), (1, -1, -1), (1, -1, 1), (-1, -1, 1)),
        quad((-1, 1, -1), (1, 1, -1), (1, 1, 1), (-1, 1, 1)),
        quad((-1, -1, -1), (-1, 1, -1), (-1, 1, 1), (-1, -1, 1)),
        quad((1, -1, -1), (1, 1, -1), (1, 1, 1), (1, -1, 1)),
    ]


@pytest.mark.parametrize("width", WIDTHS)
def test_a_narrow_lip_is_no_joint(width: float) -> None:
    with pytest.raises(so.BodyError, match=r"patch 0 side v1 .*0\.0066 apart"):
        so.Body.from_patches(cube_with_a_lip(1e-2, width))


@pytest.mark.parametrize("width", WIDTHS)
def test_without_the_lip_it_is_a_cube(width: float) -> None:
    report = so.Body.from_patches(cube_with_a_lip(0.0, width)).check()
    assert report.faces == 6
    assert report.slack == 0.0


def test_a_lip_within_the_tolerance_goes_into_the_slack() -> None:
    body = so.Body.from_patches(cube_with_a_lip(1e-6, 1e-3), tolerance=1e-5)
    assert body.check().sewing_residual == pytest.approx(2e-6 / 3, rel=0.2)
    assert body.check().slack >= body.check().sewing_residual


def test_a_trimming_curve_that_turns_back_on_itself_is_refused() -> None:
    pcurve = NurbsPcurve([[0.0, 0.0], [2.0, 0.0], [0.5, 0.0]], [0, 0, 0, 1, 1, 1])
    with pytest.raises(ValueError, match="turns back on itself"):
        pcurve.pieces(0.0, 1.0)


@pytest.mark.parametrize("patches", [float("nan"), float("inf"), 3.5, "3", None])
def test_spindle_and_gore_take_whole_numbers(patches) -> None:
    for shape in (so.shapes.spindle, so.shapes.gore):
        with pytest.raises(so.BodyError, match="whole number"):
            shape(1.0, 3.0, patches)
