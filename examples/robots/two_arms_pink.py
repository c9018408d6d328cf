"""Both hands of a Baxter are sent to the same place, and stop before each other (Pink).

Pink's own example `yumi_self_collision` does this with a Yumi, and keeps two points of its hands 25
cm apart by `BodySphericalBarrier`. Here `PinkBarrier` does the same with a ball of 12.5 cm on each
hand, and then better: with the robot's own shapes, of all links, 2 cm apart.

Run it as `python two_arms_pink.py`; it needs the extra `pink` and the package example-robot-data.
"""

import sys
from pathlib import Path

import coal
import numpy as np
import pink
import pinocchio as pin

import standoff as so

DATA = Path(sys.prefix, "lib", f"python3.{sys.version_info.minor}", "site-packages")
BAXTER = DATA / "cmeel.prefix/share/example-robot-data/robots/baxter_description"
HANDS = ("left_gripper", "right_gripper")
READY = np.array([-0.08, -1.0, -1.19, 1.94, 0.67, 1.03, -0.5])
"""The left arm's joints before the start, rad; the right arm's mirror them."""
MIRROR = np.array([-1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0])
OPEN = 0.02
"""Way of each finger, m: closed, those of a hand are 7 mm apart."""
BALL, CLEARANCE = 0.125, 0.02
"""Radius of the balls on the hands, and what the shapes keep, m."""
STEP, END = 0.005, 2.0 * np.pi
"""Of the time, s: 200 Hz, as there."""


def baxter():
    """The robot with its exact shapes; the torso's and the head's meshes by their hulls."""
    srdf = BAXTER / "srdf/baxter_manipulation.srdf"
    return so.Robot.from_urdf(
        BAXTER / "urdf/baxter.urdf", srdf, mimic=False, meshes="hull", within=0.3
    )


def balls(model):
    """The same robot with nothing but a ball on each hand."""
    geometry = pin.GeometryModel()
    for name in HANDS:
        frame = model.frames[model.getFrameId(name)]
        geometry.addGeometryObject(
            pin.GeometryObject(name, frame.parentJoint, 0, frame.placement, coal.Sphere(BALL))
        )
    geometry.addCollisionPair(pin.CollisionPair(0, 1))
    return so.Robot.from_pinocchio(model, geometry)


def ready(model):
    """A configuration before the start."""
    q = pin.neutral(model)
    for side, joints in (("left", READY), ("right", MIRROR * READY)):
        for joint, angle in zip(("s0", "s1", "e0", "e1", "w0", "w1", "w2"), joints, strict=True):
            q[model.joints[model.getJointId(f"{side}_{joint}")].idx_q] = angle
        for finger, way in (("l", OPEN), ("r", -OPEN)):
            joint = f"{side[0]}_gripper_{finger}_finger_joint"
            q[model.joints[model.getJointId(joint)].idx_q] = way
    return q


def targets(t):
    """Where both hands shall be: as of the Yumi, in one point at 3/4 of the time."""
    across, up = 0.1 + 0.1 * np.sin(t), 0.2 + 0.1 * np.sin(t)
    return np.array([0.7, across, up]), np.array([0.7, -across, up])


def meet(model, barriers, begin=0.0, end=END):
    """(n, nq) configurations on the way."""
    state = pink.Configuration(model, model.createData(), ready(model))
    tasks = [pink.FrameTask(name, position_cost=50.0, orientation_cost=1.0) for name in HANDS]
    posture = pink.PostureTask(cost=1e-3)
    for task in (*tasks, posture):
        task.set_target_from_configuration(state)
    found = []
    for t in np.arange(begin, end, STEP):
        for task, place in zip(tasks, targets(t), strict=True):
            task.transform_target_to_world.translation[:] = place
        v = pink.solve_ik(state, [*tasks, posture], STEP, "daqp", barriers=barriers, damping=1e-6)
        state.integrate_inplace(v, STEP)
        found.append(state.q.copy())
    return np.array(found)


def hands_apart(model, path):
    """(n,) distances of the two hands' frames."""
    data, numbers, found = model.createData(), [model.getFrameId(name) for name in HANDS], []
    for q in path:
        pin.framesForwardKinematics(model, data, q)
        a, b = (data.oMf[k].translation for k in numbers)
        found.append(np.linalg.norm(a - b))
    return np.array(found)


def main():
    robot = baxter()
    model = robot.kinematics.model
    barriers = {
        "no barrier": [],
        "Pink's, 25 cm": [pink.barriers.BodySphericalBarrier(HANDS, 2.0 * BALL, gain=100.0)],
        "balls of 12.5 cm": [so.robots.PinkBarrier(balls(model), 0.0, gain=20.0)],
        "exact shapes": [so.robots.PinkBarrier(robot, CLEARANCE, gain=20.0, n_pairs=20)],
    }
    for name, used in barriers.items():
        path = meet(model, used)
        least = min(robot.clearance(q).distance for q in path)
        between = hands_apart(model, path).min()
        print(f"{name:17} hands {between:.4f} m apart at least, shapes {least:.4f} m")


if __name__ == "__main__":
    main()
