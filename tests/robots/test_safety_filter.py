"""`so.robots.SafetyFilter`: the nearest safe velocities, and what it says where there are none."""

from __future__ import annotations

import numpy as np
import pytest
from contact_models import ARM, TWO, model

import standoff as so
from standoff.errors import StandoffError
from standoff.robots import FilterStatus, SafetyFilter


@pytest.fixture(scope="module")
def arm() -> so.Robot:
    return so.Robot.from_mujoco(model(ARM))


def test_a_safe_velocity_is_unchanged_to_the_last_bit(arm: so.Robot) -> None:
    wanted = np.array([0.1, -0.2, 0.05, 0.0])
    found = SafetyFilter(arm, 0.01, gain=5.0).filter(np.zeros(4), wanted)
    assert found.status is FilterStatus.UNCHANGED
    np.testing.assert_array_equal(found.velocity, wanted)
    assert found.slack > 0.0


def test_one_row_is_the_projection_in_closed_form() -> None:
    robot = so.Robot.from_mujoco(model(TWO))
    q, wanted = np.array([0.1, 0.05, -0.45, 0.3]), np.array([0.0, 0.0, -3.0, 0.5])
    rows = robot.distances(q)
    row, least = rows.jacobian[0], -2.0 * (rows.lower_bound[0] - 0.01)
    assert row @ wanted < least
    for weights in (np.ones(4), np.array([1.0, 4.0, 2.0, 0.5])):
        found = SafetyFilter(robot, 0.01, gain=2.0, weights=weights).filter(q, wanted)
        way = row / weights
        exact = wanted + way * (least - row @ wanted) / (row @ way)
        assert found.status is FilterStatus.CHANGED
        np.testing.assert_allclose(found.velocity, exact, atol=1e-6)


def test_it_is_the_nearest_of_many_rows(arm: so.Robot, rng: np.random.Generator) -> None:
    """No random velocity that keeps all rows is nearer than the filter's."""
    keeper = SafetyFilter(arm, 0.02, gain=1.0)
    for _ in range(10):
        q = rng.uniform(arm.lower, arm.upper)
        if arm.clearance(q).lower_bound < 0.02:
            continue
        wanted = rng.normal(size=4)
        found = keeper.filter(q, wanted)
        least = -(found.rows.lower_bound - 0.02)
        assert found.velocity is not None
        assert (found.rows.jacobian @ found.velocity - least).min() > -1e-6
        tried = found.velocity + 0.3 * rng.normal(size=(2000, 4))
        safe = (tried @ found.rows.jacobian.T >= least).all(axis=1)
        far = np.linalg.norm(tried[safe] - wanted, axis=1)
        assert far.min(initial=np.inf) > np.linalg.norm(found.velocity - wanted) - 1e-5


def test_a_loop_never_comes_below_the_minimum(arm: so.Robot) -> None:
    keeper = SafetyFilter(arm, 0.01, gain=20.0, within=0.5)
    q, dt, changed, least = np.array([0.2, 1.2, 0.1, 0.0]), 1e-2, 0, np.inf
    wanted = np.array([0.8, 0.0, -0.4, 0.0])
    for _ in range(200):
        found = keeper.filter(q, wanted)
        assert found.velocity is not None
        changed += found.status is FilterStatus.CHANGED
        q = arm.kinematics.integrate(q, dt * found.velocity)
        least = min(least, arm.clearance(q).distance)
    assert changed > 50
    assert least > 0.01 - 1e-3  # what the curvature of one step may take


def test_overlap_is_backed_out_of() -> None:
    robot = so.Robot.from_mujoco(model(TWO))
    q = np.array([0.1, 0.05, -0.75, 0.3])
    before = robot.clearance(q).distance
    assert before < 0.0
    found = SafetyFilter(robot, 0.0, gain=5.0).filter(q, np.zeros(4))
    assert found.velocity is not None
    after = robot.clearance(robot.kinematics.integrate(q, 1e-3 * found.velocity)).distance
    assert after - before == pytest.approx(5e-3 * -before, rel=1e-2)


def test_infeasible_is_said_and_nothing_is_returned() -> None:
    robot = so.Robot.from_mujoco(model(TWO))
    limits = np.full(4, 0.01)
    keeper = SafetyFilter(robot, 0.0, gain=5.0, lower=-limits, upper=limits)
    found = keeper.filter(np.array([0.1, 0.05, -0.75, 0.3]), np.zeros(4))
    assert found.status is FilterStatus.INFEASIBLE
    assert found.velocity is None
    assert found.slack == -np.inf


def test_limits_hold_where_no_pair_is_near(arm: so.Robot) -> None:
    keeper = SafetyFilter(arm, 0.0, within=1e-3, lower=np.full(4, -0.1), upper=np.full(4, 0.1))
    found = keeper.filter(np.zeros(4), np.array([1.0, 0.0, -1.0, 0.05]))
    assert not len(found.rows)
    np.testing.assert_allclose(found.velocity, [0.1, 0.0, -0.1, 0.05], atol=1e-9)


def test_what_does_not_fit_is_refused(arm: so.Robot) -> None:
    with pytest.raises(StandoffError, match="not installed"):
        SafetyFilter(arm, solver="nobody")
    with pytest.raises(StandoffError, match="lower limits below"):
        SafetyFilter(arm, lower=np.ones(4), upper=np.zeros(4))
    with pytest.raises(StandoffError, match="lower limits below"):
        SafetyFilter(arm, lower=np.full(4, np.nan))
    with pytest.raises(StandoffError, match="velocity has shape"):
        SafetyFilter(arm).filter(np.zeros(4), np.zeros(3))
    with pytest.raises(StandoffError, match="gain"):
        SafetyFilter(arm, gain=0.0)
