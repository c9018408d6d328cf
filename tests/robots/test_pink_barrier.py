"""`so.robots.PinkBarrier`: rows through contact, Pink's own cases, and its inverse kinematics."""

from __future__ import annotations

import numpy as np
import pink
import pinocchio as pin
import pytest
from contact_models import differences, touching

import standoff as so
from standoff.errors import StandoffError
from standoff.robots import PinkBarrier

coal = pytest.importorskip("coal")

WHERE, DOWN = np.array([0.05, 0.02, 0.9, 0.2]), np.array([0.0, 0.0, -0.7, 0.0])


def two() -> tuple[pin.Model, pin.GeometryModel]:
    """Two ellipsoids a metre from the origin, one on three slides and a hinge."""
    model, geometry = pin.Model(), pin.GeometryModel()
    joint, at = 0, pin.SE3(np.eye(3), np.ones(3))
    for kind, name in (
        (pin.JointModelPX(), "x"),
        (pin.JointModelPY(), "y"),
        (pin.JointModelPZ(), "z"),
        (pin.JointModelRX(), "turn"),
    ):
        joint = model.addJoint(joint, kind, at, name)
        at = pin.SE3.Identity()
    turned = pin.SE3(pin.rpy.rpyToMatrix(0.4, 0.3, 0.1), np.ones(3))
    still = pin.GeometryObject("a", 0, 0, turned, coal.Ellipsoid(0.3, 0.2, 0.25))
    moving = pin.GeometryObject("b", joint, 0, pin.SE3.Identity(), coal.Ellipsoid(0.15, 0.2, 0.1))
    numbers = [geometry.addGeometryObject(x) for x in (still, moving)]
    geometry.addCollisionPair(pin.CollisionPair(*numbers))
    return model, geometry


def configured(model: pin.Model, geometry: pin.GeometryModel, q: np.ndarray) -> pink.Configuration:
    return pink.Configuration(
        model,
        model.createData(),
        q,
        collision_model=geometry,
        collision_data=geometry.createData(),
    )


@pytest.fixture(scope="module")
def pair() -> tuple[so.Robot, pin.Model, pin.GeometryModel]:
    model, geometry = two()
    return so.Robot.from_pinocchio(model, geometry), model, geometry


def contact_of(robot: so.Robot) -> np.ndarray:
    return touching(lambda q: robot.distances(q).distance[0], WHERE, DOWN)


def test_rows_are_the_differences_apart_touching_and_overlapping(pair) -> None:
    robot, model, geometry = pair
    barrier = PinkBarrier(robot, 0.0)
    contact = contact_of(robot)
    for q in (WHERE, contact, contact + 0.05 * DOWN):
        found = barrier.compute_jacobian(configured(model, geometry, q))
        wanted = differences(lambda x: robot.distances(x).distance, robot.kinematics, q)
        np.testing.assert_allclose(found, wanted, atol=1e-8)


def test_pinks_row_is_zero_near_contact_and_turned_round_in_overlap(pair) -> None:
    robot, model, geometry = pair
    ours, other = PinkBarrier(robot, 0.0), pink.barriers.SelfCollisionBarrier(1, d_min=0.0)
    contact = contact_of(robot)
    for gap, part in ((1e-2, 1.0), (5e-6, 0.0), (-1e-2, -1.0)):
        at = configured(model, geometry, _at_gap(robot, contact, gap))
        row = ours.compute_jacobian(at)[0]
        assert row[2] > 0.9
        np.testing.assert_allclose(other.compute_jacobian(at)[0], part * row, atol=5e-3)


def _at_gap(robot: so.Robot, contact: np.ndarray, gap: float) -> np.ndarray:
    """Along z, by Newton's method."""
    q = contact.copy()
    for _ in range(20):
        rows = robot.distances(q)
        q[2] += (gap - rows.distance[0]) / rows.jacobian[0, 2]
    return q


def test_the_barrier_is_the_proven_bound(pair) -> None:
    robot, model, geometry = pair
    at = configured(model, geometry, WHERE)
    rows = robot.distances(WHERE)
    np.testing.assert_array_equal(
        PinkBarrier(robot, 0.1).compute_barrier(at), rows.lower_bound - 0.1
    )
    matrix, right = PinkBarrier(robot, 0.1, gain=3.0).compute_qp_inequalities(at, 1e-2)
    np.testing.assert_allclose(matrix, -rows.jacobian / 1e-2)
    np.testing.assert_allclose(right, 3.0 * (rows.lower_bound - 0.1))


def test_no_value_is_kept_for_another_configuration(pair) -> None:
    robot, model, geometry = pair
    barrier, at = PinkBarrier(robot, 0.0), configured(model, geometry, WHERE)
    _, before = barrier.compute_qp_inequalities(at)
    at.update(WHERE + 4e-6)
    _, after = barrier.compute_qp_inequalities(at)
    assert before[0] != after[0]


# Pink's tests/test_self_collision_barrier.py and tests/test_barrier.py, their cases in our words


@pytest.fixture(scope="module")
def arms() -> tuple[so.Robot, pin.Model, pin.GeometryModel]:
    """Two arms of balls on hinges beside each other, as in Pink's kukas_self_collision."""
    model, geometry = pin.Model(), pin.GeometryModel()
    for side, y in (("left", 0.2), ("right", -0.2)):
        _add_arm(model, geometry, side, y)
    n = geometry.ngeoms
    for i in range(n):
        for j in range(i + 2, n):
            if (
                abs(i - j) > 2
                or geometry.geometryObjects[i].name[0] != (geometry.geometryObjects[j].name[0])
            ):
                geometry.addCollisionPair(pin.CollisionPair(i, j))
    return so.Robot.from_pinocchio(model, geometry), model, geometry


def _add_arm(model: pin.Model, geometry: pin.GeometryModel, side: str, y: float) -> None:
    """Seven hinges as of an iiwa, a ball of 10 cm at each and one at the tip."""
    axes = (pin.JointModelRZ, pin.JointModelRY) * 3 + (pin.JointModelRZ,)
    joint, at = 0, pin.SE3(np.eye(3), np.array([0.0, y, 0.15]))
    for k, kind in enumerate(axes):
        joint = model.addJoint(
            joint, kind(), at, f"{side}_{k}",
            np.full(1, 50.0), np.full(1, 2.0), np.full(1, -2.8), np.full(1, 2.8),
        )  # fmt: skip
        at = pin.SE3(np.eye(3), np.array([0.0, 0.0, 0.2]))
        ball = pin.GeometryObject(
            f"{side}_ball_{k}", joint, 0, pin.SE3.Identity(), coal.Sphere(0.1)
        )
        geometry.addGeometryObject(ball)
    model.addFrame(pin.Frame(f"{side}_tip", joint, 0, at, pin.FrameType.OP_FRAME))
    ball = pin.GeometryObject(f"{side}_ball_tip", joint, 0, at, coal.Sphere(0.08))
    geometry.addGeometryObject(ball)


def test_shapes(arms) -> None:
    robot, model, geometry = arms
    at = configured(model, geometry, np.full(14, 0.3))
    for n in (10, len(robot.pairs)):
        barrier = PinkBarrier(robot, n_pairs=n)
        assert barrier.dim == n
        assert barrier.gain.shape == (n,)
        assert barrier.compute_barrier(at).shape == (n,)
        assert barrier.compute_jacobian(at).shape == (n, robot.nv)
        matrix, right = barrier.compute_qp_inequalities(at, 1e-3)
        assert matrix.shape == (n, robot.nv)
        assert right.shape == (n,)


FOLDED = np.array([0.0, 2.0, 0.0, 2.0, 0.0, 2.0, 0.0, 1.6, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0])


def test_signs_and_values_are_pinks_for_balls(arms) -> None:
    robot, model, geometry = arms
    at = configured(
        model, geometry, np.array([0.0, 2.0, 0.0, 2.0, 0.0, 2.0, 0.0, 1.6, 1.0, 0, 0, 0, 0, 0])
    )
    ours = PinkBarrier(robot, 0.02).compute_barrier(at)
    other = pink.barriers.SelfCollisionBarrier(len(robot.pairs), d_min=0.02).compute_barrier(at)
    np.testing.assert_allclose(np.sort(ours), np.sort(other), atol=1e-9)
    assert ours.min() < 0.0 < ours.max()


def test_nearest_pairs_are_kept(arms) -> None:
    robot, model, geometry = arms
    q = np.linspace(-1.0, 1.0, 14)
    found = PinkBarrier(robot, 0.02, n_pairs=5).compute_barrier(configured(model, geometry, q))
    wanted = np.sort(robot.distances(q).lower_bound)[:5] - 0.02
    np.testing.assert_allclose(found, wanted, atol=1e-14)


def test_rows_without_a_pair_are_at_the_horizon(arms) -> None:
    robot, model, geometry = arms
    q = np.zeros(14)
    barrier = PinkBarrier(robot, 0.02, within=0.3)
    near = len(robot.distances(q, within=0.3))
    assert near < barrier.dim
    at = configured(model, geometry, q)
    assert (barrier.compute_barrier(at)[near:] == 0.3 - 0.02).all()
    assert not barrier.compute_jacobian(at)[near:].any()


def test_objective(arms) -> None:
    robot, model, geometry = arms
    at = configured(model, geometry, np.full(14, 0.3))
    for weight in (0.0, 1.0):
        H, c = PinkBarrier(robot, safe_displacement_gain=weight).compute_qp_objective(at)
        assert H.shape == (14, 14)
        assert not c.any()
        assert H.any() == (weight > 0.0)
    far = PinkBarrier(robot, 0.01, within=0.011).compute_qp_objective(
        configured(model, geometry, np.zeros(14))
    )
    assert np.isfinite(far[0]).all()


def test_repr_names_what_pinks_does(arms) -> None:
    told = repr(PinkBarrier(arms[0], n_pairs=3))
    assert all(word in told for word in ("gain=", "safe_displacement=", "dim=3"))


def swap(configuration: pink.Configuration, barriers: list[pink.barriers.Barrier], robot: so.Robot):
    """The tips of both arms change sides, as in Pink's example; the least true distances."""
    tasks = [
        pink.tasks.FrameTask(f"{side}_tip", position_cost=50.0, orientation_cost=0.0)
        for side in ("left", "right")
    ]
    posture = pink.tasks.PostureTask(cost=1e-3)
    for task in (*tasks, posture):
        task.set_target_from_configuration(configuration)
    dt, least, lost = 0.02, np.inf, 0
    first, second = np.array([0.39, 0.39, 0.6]), np.array([0.39, -0.39, 0.6])
    for t in np.arange(0.0, 2.0 * np.pi, dt):
        part = 0.5 * (1.0 + np.cos(t))
        tasks[0].transform_target_to_world.translation[:] = part * first + (1.0 - part) * second
        tasks[1].transform_target_to_world.translation[:] = part * second + (1.0 - part) * first
        try:
            v = pink.solve_ik(
                configuration, [*tasks, posture], dt, "daqp", barriers=barriers, damping=1e-6,
                safety_break=False,
            )  # fmt: skip
        except pink.exceptions.NoSolutionFound:
            v, lost = np.zeros(configuration.model.nv), lost + 1
        configuration.integrate_inplace(v, dt)
        least = min(least, robot.clearance(configuration.q).distance)
    return least, lost


def test_two_arms_change_sides(arms) -> None:
    robot, model, geometry = arms
    q = np.array([0.0, 0.6, 0.0, 1.0, 0.0, 0.8, 0.0] * 2)
    barrier = PinkBarrier(robot, 0.05, gain=20.0, n_pairs=20)
    least, lost = swap(configured(model, geometry, q), [barrier], robot)
    assert least > 0.05 - 5e-3
    assert lost == 0
    without, _ = swap(configured(model, geometry, q), [], robot)
    assert without < 0.0


def test_what_does_not_fit_is_refused(pair, arms) -> None:
    robot, model, geometry = pair
    for wrong in (-1, 0, 2):
        with pytest.raises(StandoffError, match="n_pairs"):
            PinkBarrier(robot, n_pairs=wrong)
    with pytest.raises(StandoffError, match="gain"):
        PinkBarrier(robot, gain=0.0)
    with pytest.raises(StandoffError, match="of the same model"):
        PinkBarrier(arms[0]).compute_barrier(configured(model, geometry, WHERE))
