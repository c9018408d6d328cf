"""Joints that mimic others: before them, in chains, by nothing, endlessly; and whose q is whose."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

import standoff as so

pin = pytest.importorskip("pinocchio")


def link(name: str) -> str:
    shape = '<geometry><sphere radius="0.1"/></geometry>'
    return f'<link name="{name}"><collision>{shape}</collision></link>'


def joint(name: str, child: str, kind: str, mimic: str = "", place: str = "1 0 0") -> str:
    """Of the base, along z."""
    return (
        f'<joint name="{name}" type="{kind}"><parent link="base"/><child link="{child}"/>'
        f'<origin xyz="{place}"/><axis xyz="0 0 1"/>'
        f'<limit lower="-3" upper="3" effort="1" velocity="1"/>{mimic}</joint>'
    )


def read(tmp_path: Path, *joints: str, mimic: bool = True) -> so.Robot:
    links = "".join(link(name) for name in ("base", "x", "y", "z")[: len(joints) + 1])
    path = tmp_path / "r.urdf"
    path.write_text(f'<robot name="r">{links}{"".join(joints)}</robot>')
    return so.Robot.from_urdf(path, mimic=mimic)


def follow(master: str, ratio: float, offset: float = 0.0) -> str:
    return f'<mimic joint="{master}" multiplier="{ratio}" offset="{offset}"/>'


SLIDE, TURN, ENDLESS = "prismatic", "revolute", "continuous"


def test_a_joint_before_its_master_and_a_mimic_of_a_mimic(tmp_path: Path) -> None:
    robot = read(
        tmp_path,
        joint("a", "x", SLIDE, follow("z", 2.0, 0.5)),
        joint("b", "y", SLIDE, follow("a", -1.0, 0.25), "0 1 0"),
        joint("z", "z", SLIDE, "", "0 0 1"),
    )
    assert (robot.nq, robot.nv, robot.joints.names) == (1, 1, ("a", "b", "z"))
    heights = robot.poses([0.3])[:, 2, 3]
    assert np.abs(heights - [0.0, 1.1, -0.85, 1.3]).max() <= 1e-15
    rates = robot.kinematics.jacobians(np.array([0.3]))[:, 2, 0]
    assert np.abs(rates - [2.0, -2.0, 1.0]).max() <= 1e-15
    again = pickle.loads(pickle.dumps(robot.kinematics))
    assert (again.poses(np.array([0.3])) == robot.kinematics.poses(np.array([0.3]))).all()


def test_the_owner_of_a_number_is_named_by_all(tmp_path: Path) -> None:
    """``outside``, ``certify`` and the sliders, of a mimic that comes first."""
    robot = read(
        tmp_path, joint("a", "x", SLIDE, follow("z", 1.0)), joint("z", "y", SLIDE, "", "0 1 0")
    )
    assert robot.outside([4.0]) == ("z",)
    with pytest.raises(so.StandoffError, match=r"joint 'z' \(q\[0\]\) is 4.0"):
        robot.certify([[0.0], [4.0]])
    assert [robot.joints.owner(0), *robot.joints.mimics] == [1, 0]


def test_a_multiplier_of_nothing_stands_at_its_offset(tmp_path: Path) -> None:
    robot = read(
        tmp_path,
        joint("a", "x", SLIDE),
        joint("b", "y", SLIDE, follow("a", 0.0, 0.7), "0 1 0"),
    )
    for q in (-1.0, 2.0):
        assert np.abs(robot.poses([q])[2, :3, 3] - [0.0, 1.0, 0.7]).max() <= 1e-15
    assert ("base_0", "y_0", "rigid to each other") in robot.report().left_out
    model, geometry = two_joints(0.0, -0.7)
    robot = so.Robot.from_pinocchio(model, geometry)
    for q in (-1.0, 2.0):
        at = robot.poses([q])[1, :3, :3]
        assert (
            np.abs(at - so.Pose.exp([0, 0, q], np.zeros(3)).rotation @ turn_x(-0.7)).max() <= 1e-15
        )
    assert robot.certify([[-1.0], [2.0]], 0.1).verdict.name == "PROVEN"


def turn_x(angle: float) -> np.ndarray:
    return np.asarray(so.Pose.exp([angle, 0.0, 0.0], np.zeros(3)).rotation)


def two_joints(ratio: float, offset: float) -> tuple[object, object]:
    """A hinge about z, and one about x on it that mimics it."""
    import coal

    model, geometry = pin.Model(), pin.GeometryModel()
    first = model.addJoint(0, pin.JointModelRZ(), pin.SE3.Identity(), "a")
    second = model.addJoint(first, pin.JointModelRX(), pin.SE3.Identity(), "b")
    model = pin.transformJointIntoMimic(model, first, second, ratio, offset)
    for k, at in enumerate((0, second)):
        place = pin.SE3(np.eye(3), np.array([0.0, 0.0, 0.5 * k]))
        geometry.addGeometryObject(pin.GeometryObject(f"g{k}", at, place, coal.Sphere(0.1)))
    geometry.addAllCollisionPairs()
    return model, geometry


@pytest.mark.parametrize("kind", [TURN, ENDLESS])
def test_what_mimics_an_endless_joint_turns_whole_times_as_far(tmp_path: Path, kind: str) -> None:
    robot = read(
        tmp_path,
        joint("a", "x", ENDLESS),
        joint("b", "y", kind, follow("a", -2.0, 0.3), "0 1 0"),
    )
    for angle in (-3.0, 0.4, 3.1):
        turn = robot.poses([np.cos(angle), np.sin(angle)])[2, :3, :3]
        wanted = so.Pose.exp([0.0, 0.0, 0.3 - 2.0 * angle], np.zeros(3)).rotation
        assert np.abs(turn - wanted).max() <= 1e-14
    proof = robot.certify([[1.0, 0.0], [-1.0, 1e-9]], 0.1)
    assert proof.verdict.name == "PROVEN"


@pytest.mark.parametrize(
    ("joints", "said"),
    [
        ((joint("a", "x", ENDLESS), joint("b", "y", TURN, follow("a", 0.5))), "0.5 times as far"),
        ((joint("a", "x", ENDLESS), joint("b", "y", SLIDE, follow("a", 1.0))), "and slides"),
        ((joint("a", "x", TURN), joint("b", "y", TURN, follow("c", 1.0))), "'c' is no joint of"),
        ((joint("a", "x", TURN, follow("a", 1.0)),), "'a' is in a circle with it"),
        (
            (joint("a", "x", TURN, follow("b", 1.0)), joint("b", "y", TURN, follow("a", 1.0))),
            "in a circle",
        ),
        (
            (joint("a", "x", "floating"), joint("b", "y", TURN, follow("a", 1.0))),
            "a floating joint",
        ),
        ((joint("a", "x", TURN), joint("b", "y", TURN, follow("a", "x"))), "multiplier='x'"),  # type: ignore[arg-type]
    ],
)
def test_what_cannot_follow_is_refused_by_name(
    tmp_path: Path, joints: tuple[str, ...], said: str
) -> None:
    with pytest.raises(so.StandoffError, match=said):
        read(tmp_path, *joints)
    if "multiplier" not in said:
        assert read(tmp_path, *joints, mimic=False).nq >= 1


def test_a_robot_of_one_joint(tmp_path: Path) -> None:
    """Its Jacobian is a vector in Pinocchio."""
    ball = {"o": (so.shapes.sphere(0.1), so.Pose(np.eye(3), [3.0, 0.0, 0.0]))}
    robot = read(tmp_path, joint("a", "x", SLIDE)).with_obstacles(ball)
    near = robot.clearance([1.0])
    assert abs(near.distance - (5.0**0.5 - 0.2)) <= 1e-15
    assert abs(near.gradient[0] - 1.0 / 5.0**0.5) <= 1e-15
    assert robot.kinematics.motion(np.array([1.0])).screws.shape == (6, 1)
