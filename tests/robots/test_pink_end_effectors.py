"""Pink's example of two end effectors that must not meet, with our barrier in its place.

`yumi_self_collision.py` keeps two hands apart by `BodySphericalBarrier`. Its robot is in no
package; Baxter, which has two arms of seven joints too, takes its place.
"""

from __future__ import annotations

import numpy as np
import pink
import pinocchio as pin
import pytest
from pink.barriers import BodySphericalBarrier
from robot_models import urdf

import standoff as so
from standoff.robots import PinkBarrier

coal = pytest.importorskip("coal")

HANDS = ("left_gripper", "right_gripper")
LEAST = 0.2
DT = 0.02


@pytest.fixture(scope="module")
def baxter() -> tuple[so.Robot, pin.Model]:
    """Its joints, and a ball around each hand that is half the least distance large."""
    model, geometry = pin.buildModelFromUrdf(str(urdf("baxter"))), pin.GeometryModel()
    for name in HANDS:
        frame = model.frames[model.getFrameId(name)]
        ball = pin.GeometryObject(
            name, frame.parentJoint, frame.placement, coal.Sphere(0.5 * LEAST)
        )
        geometry.addGeometryObject(ball)
    geometry.addCollisionPair(pin.CollisionPair(0, 1))
    return so.Robot.from_pinocchio(model, geometry), model


def ready(model: pin.Model) -> pink.Configuration:
    q = pin.neutral(model)
    for side, turn in (("left", -1.0), ("right", 1.0)):
        for joint, value in (("s0", 0.6 * turn), ("s1", -0.5), ("e1", 1.4), ("w1", 0.6)):
            q[model.joints[model.getJointId(f"{side}_{joint}")].idx_q] = value
    return pink.Configuration(model, model.createData(), q)


def test_rows_are_those_of_pinks_spheres(baxter: tuple[so.Robot, pin.Model]) -> None:
    """Theirs is the square of the distance of the centres less that of the least one."""
    robot, model = baxter
    at = ready(model)
    ours, theirs = PinkBarrier(robot, 0.0), BodySphericalBarrier(HANDS, d_min=LEAST)
    (gap,) = ours.compute_barrier(at)
    (squared,) = theirs.compute_barrier(at)
    assert (gap + LEAST) ** 2 - LEAST**2 == pytest.approx(squared, rel=1e-12)
    np.testing.assert_allclose(
        2.0 * (gap + LEAST) * ours.compute_jacobian(at)[0],
        theirs.compute_jacobian(at),
        atol=1e-12,
    )


def crossed(model: pin.Model, barriers: list[pink.barriers.Barrier]) -> float:
    """Both hands are asked to change sides; the least distance of their frames on the way."""
    configuration = ready(model)
    tasks = [pink.tasks.FrameTask(n, position_cost=50.0, orientation_cost=0.1) for n in HANDS]
    posture = pink.tasks.PostureTask(cost=1e-3)
    for task in (*tasks, posture):
        task.set_target_from_configuration(configuration)
    begun = [task.transform_target_to_world.translation.copy() for task in tasks]
    least = np.inf
    for t in np.arange(0.0, 3.0, DT):
        part = 0.5 * (1.0 - np.cos(2.0 * np.pi * t / 3.0))
        for task, own, other in zip(tasks, begun, begun[::-1], strict=True):
            task.transform_target_to_world.translation[:] = own + part * (other - own)
        v = pink.solve_ik(
            configuration, [*tasks, posture], DT, "daqp", barriers=barriers, damping=1e-6,
            safety_break=False,
        )  # fmt: skip
        configuration.integrate_inplace(v, DT)
        hands = [configuration.get_transform_frame_to_world(n).translation for n in HANDS]
        least = min(least, float(np.linalg.norm(hands[0] - hands[1])))
    return least


def test_the_hands_stay_apart(baxter: tuple[so.Robot, pin.Model]) -> None:
    robot, model = baxter
    ours = crossed(model, [PinkBarrier(robot, 0.0, gain=1.0 / DT)])
    theirs = crossed(model, [BodySphericalBarrier(HANDS, d_min=LEAST, gain=1.0 / DT)])
    assert crossed(model, []) < 0.1
    # a step along the tangents of both balls loses what is of second order in it
    assert ours == pytest.approx(LEAST, abs=1e-2)
    assert ours == pytest.approx(theirs, abs=2e-3)
