"""The arrays of joints against the packages' own kinematics, and Jacobians against differences."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from robot_models import EXACT, MJCF, URDF, drawn, exact_robot
from scipy.spatial.transform import Rotation

import standoff as so
from standoff.robots.joints import SLIDES, JointKind, Joints

mujoco = pytest.importorskip("mujoco")
pin = pytest.importorskip("pinocchio")


def motion_of(joints: Joints, j: int, q: np.ndarray) -> np.ndarray:
    """The motion of one joint, by SciPy's rotations."""
    found, kind, at = np.eye(4), JointKind(joints.kinds[j]), joints.q_at[j]
    if kind in (JointKind.HINGE, *SLIDES):
        way = (joints.ratios[j] * q[at] + joints.offsets[j]) * joints.axes[j]
        if kind in SLIDES:
            found[:3, 3] = way
        else:
            found[:3, :3] = Rotation.from_rotvec(way).as_matrix()
    elif kind == JointKind.CONTINUOUS:
        angle = joints.ratios[j] * np.arctan2(q[at + 1], q[at]) + joints.offsets[j]
        found[:3, :3] = Rotation.from_rotvec(angle * joints.axes[j]).as_matrix()
    else:
        first = at + (3 if kind == JointKind.FREE else 0)
        turn = Rotation.from_quat(q[first : first + 4], scalar_first=joints.scalar_first)
        found[:3, :3] = turn.as_matrix()
        if kind == JointKind.FREE:
            found[:3, 3] = q[at : at + 3]
    return found


def forward(robot: so.Robot, q: np.ndarray) -> np.ndarray:
    """World poses of all geometries by the arrays of joints alone."""
    joints = robot.joints
    moved: list[np.ndarray] = []
    for j, parent in enumerate(joints.parents):
        before = moved[parent] if parent >= 0 else np.eye(4)
        moved.append(before @ joints.placements[j] @ motion_of(joints, j, q))
    geoms = robot.geoms
    return np.array(
        [
            (moved[j] if j >= 0 else np.eye(4)) @ placement
            for j, placement in zip(geoms.joints, geoms.placements, strict=True)
        ]
    )


@pytest.fixture(scope="module")
def every_joint() -> so.Robot:
    return so.Robot.from_mujoco(mujoco.MjModel.from_xml_string(MJCF))


@pytest.mark.parametrize("name", EXACT)
def test_joints_place_the_links_where_pinocchio_does(name: str) -> None:
    robot, rng = exact_robot(name), np.random.default_rng(1)
    for _ in range(20):
        q = drawn(robot, rng)
        assert np.abs(forward(robot, q) - robot.poses(q)).max() <= 1e-12


def test_poses_are_those_of_pinocchio_s_geometries() -> None:
    from robot_models import urdf

    path = urdf("a1")
    model = pin.buildModelFromUrdf(str(path))
    geometry = pin.buildGeomFromUrdf(model, str(path), pin.GeometryType.COLLISION)
    geometry.addAllCollisionPairs()
    robot = so.Robot.from_pinocchio(model, geometry)
    data, places = model.createData(), geometry.createData()
    q = drawn(robot, np.random.default_rng(2))
    pin.updateGeometryPlacements(model, data, geometry, places, q)
    for name, pose in zip(robot.geoms.names, robot.poses(q), strict=True):
        own = places.oMg[geometry.getGeometryId(name)].homogeneous
        assert np.abs(own - pose).max() <= 1e-14


def test_joints_place_the_links_where_mujoco_does(every_joint: so.Robot) -> None:
    rng = np.random.default_rng(3)
    kinds = {JointKind(kind) for kind in every_joint.joints.kinds}
    assert kinds == {JointKind.FREE, JointKind.HINGE, JointKind.SLIDE, JointKind.BALL}
    for _ in range(50):
        q = drawn(every_joint, rng)
        assert np.abs(forward(every_joint, q) - every_joint.poses(q)).max() <= 1e-12


def composed_model() -> tuple[object, object]:
    """A Pinocchio model of joints that a URDF does not have, with a geometry on each."""
    import coal

    model, geometry, joint = pin.Model(), pin.GeometryModel(), 0
    rng = np.random.default_rng(4)
    for k, kind in enumerate(
        [
            pin.JointModelPlanar(),
            pin.JointModelTranslation(),
            pin.JointModelSphericalZYX(),
            pin.JointModelRUBY(),
            pin.JointModelSpherical(),
            pin.JointModelPrismaticUnaligned(np.array([0.6, 0.0, 0.8])),
            pin.JointModelRevoluteUnaligned(np.array([0.0, 0.6, 0.8])),
        ]
    ):
        joint = model.addJoint(joint, kind, pin.SE3.Random(), f"joint {k}")
        place = pin.SE3(Rotation.random(random_state=k).as_matrix(), rng.normal(size=3))
        geometry.addGeometryObject(pin.GeometryObject(f"ball {k}", joint, place, coal.Sphere(0.1)))
    geometry.addAllCollisionPairs()
    return model, geometry


def test_joints_of_several_motions_are_several_rows() -> None:
    robot = so.Robot.from_pinocchio(*composed_model())
    rng = np.random.default_rng(5)
    assert len(robot.joints.names) == 3 + 3 + 3 + 4
    assert robot.joints.names[2] == "joint 0/2"
    for _ in range(20):
        q = drawn(robot, rng)
        assert np.abs(forward(robot, q) - robot.poses(q)).max() <= 1e-12


def check_jacobians(robot: so.Robot, q: np.ndarray) -> None:
    """Jacobians against central differences of the package's own poses."""
    kinematics, h = robot.kinematics, 1e-6
    found = kinematics.jacobians(q)
    here = kinematics.poses(q)
    for dof in range(robot.nv):
        way = h * np.eye(robot.nv)[dof]
        ahead, behind = (
            kinematics.poses(kinematics.check(kinematics.integrate(q, s * way))) for s in (1, -1)
        )
        rates = (ahead - behind) / (2.0 * h)
        turns = rates[:, :3, :3] @ here[:, :3, :3].transpose(0, 2, 1)
        omega = np.stack([turns[:, 2, 1], turns[:, 0, 2], turns[:, 1, 0]], axis=1)
        expected = np.concatenate([rates[:, :3, 3], omega], axis=1)
        assert np.abs(expected - found[:, :, dof]).max() <= 1e-8


@pytest.mark.parametrize("which", ["every joint", "composed", "panda", "romeo"])
def test_jacobians_are_differences_of_poses(which: str, every_joint: so.Robot) -> None:
    if which == "every joint":
        robot = every_joint
    elif which == "composed":
        robot = so.Robot.from_pinocchio(*composed_model())
    else:
        robot = exact_robot(which)
    check_jacobians(robot, drawn(robot, np.random.default_rng(6)))


def test_integrate_and_difference_are_inverse(every_joint: so.Robot) -> None:
    kinematics, rng = every_joint.kinematics, np.random.default_rng(7)
    q, v = drawn(every_joint, rng), 0.3 * rng.normal(size=every_joint.nv)
    again = kinematics.difference(q, kinematics.integrate(q, v))
    assert np.abs(again - v).max() <= 1e-12


@pytest.mark.parametrize("grip", ["revolute", "prismatic"])
@pytest.mark.parametrize("mimic", [True, False])
def test_joints_that_mimic(tmp_path: Path, grip: str, mimic: bool) -> None:
    path = tmp_path / "two_arms.urdf"
    path.write_text(URDF.format(grip=grip))
    robot, rng = so.Robot.from_urdf(path, mimic=mimic), np.random.default_rng(8)
    assert (robot.nq, robot.nv) == ((3, 2) if mimic else (4, 3))
    for _ in range(20):
        q = drawn(robot, rng)
        assert np.abs(forward(robot, q) - robot.poses(q)).max() <= 1e-12
    check_jacobians(robot, q)
