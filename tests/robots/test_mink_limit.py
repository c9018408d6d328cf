"""`so.robots.MinkLimit`: rows through contact, mink's own cases, and its inverse kinematics."""

from __future__ import annotations

import mink
import mujoco
import numpy as np
import pytest
from contact_models import ARM, TWO, differences, model, touching

import standoff as so
from standoff.errors import StandoffError, StandoffTypeError
from standoff.robots import MinkLimit

FREE_SPHERES = """
<mujoco><worldbody>
<body><joint type="free"/><geom name="g1" type="sphere" size="0.05"/></body>
<body><joint type="free"/><geom name="g2" type="sphere" size="0.05"/></body>
</worldbody></mujoco>"""

WHERE = np.array([0.1, 0.05, -0.2, 0.3])
"""Apart; going down by 0.6 overlaps."""
DOWN = np.array([0.0, 0.0, -0.6, 0.0])


@pytest.fixture(scope="module")
def two() -> so.Robot:
    return so.Robot.from_mujoco(model(TWO))


def configuration(robot: so.Robot, q: np.ndarray) -> mink.Configuration:
    return mink.Configuration(robot.kinematics.model, q=q)


def theirs(robot: so.Robot, q: np.ndarray, **options: float) -> mink.limits.limit.Constraint:
    limit = mink.CollisionAvoidanceLimit(
        robot.kinematics.model, [(["a"], ["b"])], collision_detection_distance=2.0, **options
    )
    return limit.compute_qp_inequalities(configuration(robot, q), 1e-2)


def distance_of(robot: so.Robot):
    return lambda q: robot.distances(q).distance[0]


def test_rows_are_the_differences_apart_touching_and_overlapping(two: so.Robot) -> None:
    limit = MinkLimit(two, 0.0)
    contact = touching(distance_of(two), WHERE, DOWN)
    assert abs(two.distances(contact).distance[0]) < 1e-15
    for q in (WHERE, contact, contact + np.array([0.0, 0.0, -0.02, 0.0])):
        found, _ = limit.compute_qp_inequalities(configuration(two, q), 1e-2)
        wanted = differences(lambda x: two.distances(x).distance, two.kinematics, q)
        np.testing.assert_allclose(found, -wanted, atol=1e-8)


def test_mink_has_the_x_axis_at_contact_and_we_the_normal(two: so.Robot) -> None:
    contact = touching(distance_of(two), WHERE, DOWN)
    near = theirs(two, contact + np.array([0.0, 0.0, 1e-3, 0.0])).G[0]
    ours, _ = MinkLimit(two, 0.0).compute_qp_inequalities(configuration(two, contact), 1e-2)
    np.testing.assert_allclose(ours[0], near, atol=0.02)  # theirs is right a millimetre away
    at = model(FREE_SPHERES)
    q = np.concatenate([np.zeros(3), [1, 0, 0, 0], [0.0, 0.0, 0.1], [1, 0, 0, 0]])
    spheres = so.Robot.from_mujoco(at)
    limit = mink.CollisionAvoidanceLimit(at, [(["g1"], ["g2"])], collision_detection_distance=1.0)
    broken = limit.compute_qp_inequalities(mink.Configuration(at, q=q), 1e-2).G[0]
    right = MinkLimit(spheres, 0.0).compute_qp_inequalities(mink.Configuration(at, q=q), 1e-2).G[0]
    np.testing.assert_allclose(np.abs(broken[:3]), [1.0, 0.0, 0.0], atol=1e-6)
    np.testing.assert_allclose(right[:3], [0.0, 0.0, 1.0], atol=1e-12)


def test_rows_agree_with_mink_where_it_is_right(two: so.Robot) -> None:
    for q in (WHERE, WHERE + np.array([0.2, -0.1, 0.1, 0.5])):
        ours = MinkLimit(two, 0.0, gain=0.5).compute_qp_inequalities(configuration(two, q), 1e-2)
        other = theirs(two, q, gain=0.5, minimum_distance_from_collisions=0.0)
        np.testing.assert_allclose(ours.G, other.G, atol=1e-4)
        # mink divides the distance by dt although its unknown is the way of a step
        np.testing.assert_allclose(ours.h / 1e-2, other.h, rtol=1e-4)


def test_right_side_is_by_the_proven_bound(two: so.Robot) -> None:
    rows = two.distances(WHERE)
    _, h = MinkLimit(two, 0.01, gain=0.5).compute_qp_inequalities(configuration(two, WHERE), 1.0)
    np.testing.assert_array_equal(h, 0.5 * (rows.lower_bound - 0.01))
    assert rows.lower_bound[0] <= rows.distance[0]


def test_below_the_minimum_it_only_forbids_or_wins_back(two: so.Robot) -> None:
    q = touching(distance_of(two), WHERE, DOWN) + np.array([0.0, 0.0, -0.02, 0.0])
    bound = two.distances(q).lower_bound[0]
    for part in (0.0, 0.25):
        _, h = MinkLimit(two, 0.0, recover=part).compute_qp_inequalities(configuration(two, q), 1.0)
        assert h[0] == part * bound


# mink's tests/test_collision_avoidance_limit.py, its cases in our words


def test_dimensions_are_those_of_the_near_pairs() -> None:
    robot = so.Robot.from_mujoco(model(ARM))
    limit = MinkLimit(robot, within=0.5)
    q = np.zeros(4)
    G, h = limit.compute_qp_inequalities(configuration(robot, q), 1e-3)
    near = len(robot.distances(q, within=0.5))
    assert 0 < near < len(robot.pairs)
    assert G.shape == (near, robot.nv)
    assert h.shape == (near,)


def test_inactive_where_no_pair_is_near(two: so.Robot) -> None:
    far = WHERE + np.array([0.0, 0.0, 50.0, 0.0])
    limit = MinkLimit(two, within=0.1)
    assert limit.compute_qp_inequalities(configuration(two, far), 1e-2).inactive


def test_rows_are_mujocos_contact_jacobian() -> None:
    at = model(FREE_SPHERES)
    at.opt.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    at.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    at.geom_condim[:] = 1
    data = mujoco.MjData(at)
    data.qpos[:] = [0, 0, 0, 1, 0, 0, 0, 0.06, 0.02, 0.05, 1, 0, 0, 0]
    mujoco.mj_forward(at, data)
    assert data.ncon == 1
    robot = so.Robot.from_mujoco(at)
    ours = MinkLimit(robot, 0.0).compute_qp_inequalities(mink.Configuration(at, q=data.qpos), 1e-2)
    np.testing.assert_allclose(-ours.G[0], data.efc_J[: at.nv], atol=1e-10)


def test_one_row_through_contact_and_its_sign() -> None:
    at = model(FREE_SPHERES)
    robot = so.Robot.from_mujoco(at)
    limit = MinkLimit(robot, 0.01)
    found = []
    for x in (0.15, 0.1, 0.05):
        q = np.array([0, 0, 0, 1, 0, 0, 0, x, 0, 0, 1, 0, 0, 0], dtype=float)
        found.append(limit.compute_qp_inequalities(mink.Configuration(at, q=q), 1e-2))
    for other in found[1:]:
        np.testing.assert_allclose(found[0].G, other.G, atol=1e-10)
    approach = np.zeros(at.nv)
    approach[6] = -1.0
    assert found[0].G[0] @ approach > 0.0 > found[0].G[0] @ -approach
    assert [c.h[0] for c in found] == pytest.approx([0.85 * 0.04, 0.0, 0.0], abs=1e-12)


def test_inverse_kinematics_keeps_the_clearance() -> None:
    robot = so.Robot.from_mujoco(model(ARM))
    least = run(robot, MinkLimit(robot, 5e-3, within=0.3))
    assert least > 5e-3 - 1e-4
    # the same task without a limit runs into the post: what the test would miss
    assert run(robot, None) < -0.01


def run(robot: so.Robot, limit: MinkLimit | None) -> float:
    """The least true distance on the way of the tip to a target behind the post."""
    at = robot.kinematics.model
    state = configuration(robot, np.array([0.2, 1.2, 0.1, 0.0]))
    task = mink.FrameTask("tip", "site", position_cost=1.0, orientation_cost=0.0, lm_damping=1e-3)
    task.set_target(mink.SE3.from_translation(np.array([0.45, 0.45, 0.35])))
    limits = [mink.ConfigurationLimit(at)] + ([limit] if limit is not None else [])
    least, dt = np.inf, 1e-2
    for _ in range(200):
        v = mink.solve_ik(state, [task], dt, "daqp", damping=1e-4, limits=limits)
        state.integrate_inplace(np.clip(v, -2.0, 2.0), dt)
        least = min(least, robot.clearance(state.q).distance)
    return least


def test_what_does_not_fit_is_refused(two: so.Robot) -> None:
    with pytest.raises(StandoffTypeError, match=r"give a so\.Robot"):
        MinkLimit("panda")  # type: ignore[arg-type]
    with pytest.raises(StandoffError, match="gain"):
        MinkLimit(two, gain=1.5)
    with pytest.raises(StandoffError, match="greater horizon"):
        MinkLimit(two, 0.1, within=0.05)
    other = model(ARM.replace('<joint name="j4" type="slide" axis="0 0 1" range="-0.05 0.1"/>', ""))
    with pytest.raises(StandoffError, match="of the same model"):
        MinkLimit(two).compute_qp_inequalities(mink.Configuration(other), 1e-2)
