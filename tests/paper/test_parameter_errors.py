"""The squared parameter error along the law: its rate, its ball, and where it rises."""

from __future__ import annotations

import numpy as np
import pytest

from standoff.motion import Twist
from standoff_studies.paper.control.levels import ball, case, errors, outline, proven
from standoff_studies.paper.control.parameter_errors import (
    GAINS,
    RISES,
    in_ball,
    law,
    least_gains,
    rates,
)


@pytest.mark.parametrize("bodies", ["point", "faces"])
def test_rates_at_rest_are_those_of_the_formulas(bodies: str) -> None:
    made, system = errors(bodies), errors(bodies).system()
    points = in_ball(made, 0.8 * ball(bodies).length, 20)
    measured = rates(made, law(GAINS[0]), points, Twist.zero())
    for q, row in zip(points, measured, strict=True):
        g, H, _, _ = system.at(q)
        w = -GAINS[0] * np.linalg.solve(H, g)
        v = -2.0 * GAINS[0] * 0.5 * g @ np.linalg.solve(made.metric, g)
        np.testing.assert_allclose(row, [2.0 * (q - made.optimum) @ w, v, g @ w], rtol=5e-3)


def test_volumes_are_the_areas_within_the_curves() -> None:
    """The law's curves are followed by length; Green's formula around them gives the areas."""
    levels, found = case("point").levels, proven("point")

    def area(values: np.ndarray, level: float) -> float:
        x, y = outline("point", values, level).T
        return 0.5 * abs(float((x[:-1] * y[1:] - x[1:] * y[:-1]).sum()))

    assert found.v == pytest.approx(area(0.5 * levels.slopes**2, levels.level), rel=0.01)
    assert found.energy == pytest.approx(area(levels.energies, levels.energy_level), rel=0.01)
    assert found.ball == pytest.approx(np.pi * ball("point").length ** 2)
    assert found.v < found.energy < found.ball < found.region


def test_the_error_rises_where_h_is_definite_on_the_lens() -> None:
    """A counterexample to the paper's sentence: the ray to the right leaves the set it falls in."""
    made = errors("patch")
    ray = made.ray(np.array([0.85, -0.53]))
    assert ray.cause == RISES
    q = made.optimum + (ray.length + 0.02) * ray.direction
    assert np.linalg.eigvalsh(made.system().at(q)[1])[0] > 1e-3
    squared, v, energy = rates(made, law(GAINS[0]), [q], Twist.zero())[0]
    assert squared > 1e-2
    assert v < 0.0
    assert energy < 0.0


def test_the_ball_ends_where_it_says() -> None:
    for bodies in ("point", "faces", "patch"):
        made, shortest = errors(bodies), ball(bodies)
        for inside, factor in ((True, 0.999), (False, 1.001)):
            q = made.optimum + factor * shortest.length * shortest.direction
            assert (made.ends(made.system(), q) == "") is inside


def test_above_the_least_gain_the_error_falls_while_the_bodies_move() -> None:
    made = errors("faces")
    points = in_ball(made, 0.5 * ball("faces").length, 40)
    twist = Twist(np.array([3.0, -5.0, 4.0]), np.array([5.0, 2.0, -7.0]))
    least = least_gains(made, points, twist)
    assert least[0] > 1.0
    for factor, falls in ((1.05, True), (0.9, False)):
        found = rates(made, law(factor * least[0]), points, twist)
        assert bool((found[:, 0] < 0.0).all()) is falls
    assert (rates(made, law(1.0), points, twist)[:, 1] < 0.0).all(), "V falls at any gain"
