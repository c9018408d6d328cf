"""The law of every path, pose and twist belonging together, and each kind's own shape."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from standoff.motion import (
    Carried,
    ConstantTwist,
    Fixed,
    Helix,
    Offset,
    Path,
    Pose,
    PoseSamples,
    Screw,
    Spiral,
    Twist,
)

PLACED = Pose.exp([0.7, -0.5, 0.9], [1.0, 2.0, 3.0])
V, OMEGA = np.array([1.0, -2.0, 0.5]), np.array([0.3, 0.2, -0.9])
TILTED = (1.0, -2.0, -0.5)
SAMPLES = PoseSamples(
    [-1.0, 0.5, 0.9, 4.0],
    [PLACED, Pose.identity(), Pose.exp([2.0, 1.0, 0.5]), Pose.exp([0, 0, 3.0], [1, 1, 1])],
)

PATHS: dict[str, Path] = {
    "fixed": Fixed(PLACED),
    "constant twist, world axes": ConstantTwist(PLACED, (V, OMEGA)),
    "constant twist, body axes": ConstantTwist(PLACED, Twist(V, OMEGA, "body")),
    "screw": Screw(PLACED, TILTED, (0.5, 0.0, -1.0), angular_rate=1.3, pitch=0.7),
    "helix": Helix(1.5, 0.4, 2.0, phase=0.3),
    "helix about a tilted axis": Helix(1.5, -0.4, 2.0, (1, 2, 3), TILTED, orientation="turning"),
    "spiral": Spiral(0.5, 0.2, -2.0, centre=(1.0, 2.0), phase=0.3),
    "turning spiral": Spiral(0.5, 0.2, 2.0, orientation="turning"),
    "samples": SAMPLES,
    "offset from a screw": Offset(Screw(PLACED, TILTED, angular_rate=1.3, pitch=0.7), PLACED),
    "offset from samples": Offset(SAMPLES, PLACED),
    "carried by a helix, turning on its own": Carried(
        Helix(1.5, 0.4, 2.0, orientation="turning"),
        ConstantTwist(PLACED, Twist(V, OMEGA, "body")),
    ),
    "carried by samples": Carried(SAMPLES, Screw(PLACED, TILTED, angular_rate=1.3)),
}
TIMES = (0.0, 0.1, 0.7, 1.9, 3.3)


@pytest.mark.parametrize("path", PATHS.values(), ids=PATHS.keys())
def test_twist_is_the_derivative_of_pose(path: Path) -> None:
    """Central differences, extrapolated once: the error is of order step⁴ and rounding / step."""
    assert isinstance(path, Path)
    for t in TIMES:
        linear, angular = [], []
        for step in (2e-3, 1e-3):
            before, after = path.pose(t - step), path.pose(t + step)
            linear.append((after.translation - before.translation) / (2 * step))
            turn = after.rotation @ before.rotation.T
            angular.append(Rotation.from_matrix(turn).as_rotvec() / (2 * step))
        twist = path.twist(t)
        assert twist.frame == "world"
        np.testing.assert_allclose(twist.v, (4 * linear[1] - linear[0]) / 3, atol=1e-9)
        np.testing.assert_allclose(twist.omega, (4 * angular[1] - angular[0]) / 3, atol=1e-9)


@pytest.mark.parametrize("path", PATHS.values(), ids=PATHS.keys())
def test_every_pose_is_a_pose(path: Path) -> None:
    for t in TIMES:
        pose = path.pose(t)
        checked = Pose(pose.rotation, pose.translation)
        assert not checked.rotation.flags.writeable
        np.testing.assert_allclose(checked.rotation.T @ checked.rotation, np.eye(3), atol=2e-15)


@pytest.mark.parametrize("path", PATHS.values(), ids=PATHS.keys())
@pytest.mark.parametrize("t", [math.nan, math.inf, "noon"])
def test_time_must_be_a_finite_number(path: Path, t: Any) -> None:
    for ask in (path.pose, path.twist):
        with pytest.raises(ValueError, match=r"^t = "):
            ask(t)


def test_paths_given_by_a_formula_start_at_zero_and_do_not_end() -> None:
    for name, path in PATHS.items():
        if "samples" in name:  # also where the samples carry another path
            start = 0.0 if "carried" in name else -1.0
            assert (path.start, path.end) == (start, 4.0)
        else:
            assert (path.start, path.end) == (0.0, math.inf)


@pytest.mark.parametrize("name", ["constant twist, world axes", "constant twist, body axes"])
def test_constant_twist_starts_at_its_pose_and_keeps_its_components(name: str) -> None:
    path = PATHS[name]
    np.testing.assert_array_equal(path.pose(0.0).matrix, PLACED.matrix)
    for t in TIMES:
        back = np.eye(3) if "world" in name else path.pose(t).rotation.T
        np.testing.assert_allclose(back @ path.twist(t).v, V, atol=1e-15)
        np.testing.assert_allclose(back @ path.twist(t).omega, OMEGA, atol=1e-15)


def test_screw_keeps_the_distance_to_its_axis_and_advances_by_the_pitch() -> None:
    point, axis = np.array([0.5, 0.0, -1.0]), np.array(TILTED) / np.linalg.norm(TILTED)
    path = Screw(PLACED, TILTED, point, angular_rate=1.3, pitch=0.7)
    np.testing.assert_array_equal(path.pose(0.0).matrix, PLACED.matrix)
    reach = np.linalg.norm(np.cross(axis, PLACED.translation - point))
    for t in TIMES:
        arm = path.pose(t).translation - point
        assert np.linalg.norm(np.cross(axis, arm)) == pytest.approx(reach, rel=1e-14)
    turned = path.pose(math.tau / 1.3)
    np.testing.assert_allclose(turned.rotation, PLACED.rotation, atol=1e-14)
    np.testing.assert_allclose(turned.translation, PLACED.translation + 0.7 * axis, atol=1e-14)


@pytest.mark.parametrize("axis", [(0, 0, 1), (0, 0, -1), (1e-9, 0, -1), TILTED, (0, 3e200, 0)])
def test_helix_winds_right_handed_at_its_radius_and_pitch(axis: Any) -> None:
    unit = np.array(axis) / np.abs(axis).max()
    unit /= np.linalg.norm(unit)
    centre = np.array([1.0, 2.0, 3.0])
    path = Helix(1.5, 0.4, 2.0, centre, axis, orientation="turning")
    for t in TIMES:
        pose, arm = path.pose(t), path.pose(t).translation - centre
        assert arm @ unit == pytest.approx(0.4 * 2.0 * t / math.tau, abs=1e-14)
        across = arm - (arm @ unit) * unit
        np.testing.assert_allclose(pose.rotation[:, 0], across / 1.5, atol=1e-14)
        np.testing.assert_allclose(pose.rotation[:, 2], unit, atol=1e-15)
        assert np.cross(across, path.twist(t).v) @ unit == pytest.approx(2.0 * 1.5**2, rel=1e-13)


def test_helix_about_z_counts_its_phase_from_x_to_y() -> None:
    origin = Helix(2.0, 0.4, 1.0, phase=math.pi / 2).pose(0.0)
    np.testing.assert_allclose(origin.translation, (0.0, 2.0, 0.0), atol=1e-15)
    np.testing.assert_array_equal(origin.rotation, np.eye(3))


def test_spiral_stays_in_the_plane_and_grows_with_the_angle() -> None:
    for orientation in ("fixed", "turning"):
        path = Spiral(0.5, 0.2, 2.0, (1.0, 2.0), 0.3, orientation)  # type: ignore[arg-type]
        for t in TIMES:
            pose, twist = path.pose(t), path.twist(t)
            arm = pose.translation - (1.0, 2.0, 0.0)
            direction = np.array([math.cos(0.3 + 2.0 * t), math.sin(0.3 + 2.0 * t), 0.0])
            np.testing.assert_allclose(arm, (0.5 + 0.2 * 2.0 * t) * direction, atol=1e-15)
            outwards = direction if orientation == "turning" else (1.0, 0.0, 0.0)
            np.testing.assert_allclose(pose.rotation[:, 0], outwards, atol=1e-15)
            np.testing.assert_array_equal(pose.rotation[:, 2], (0.0, 0.0, 1.0))
            assert twist.v[2] == twist.omega[0] == twist.omega[1] == 0.0


class AnswersInBodyAxes:
    """A path that a user wrote, with its twist in the body's axes."""

    start, end = 0.0, 1.0

    def pose(self, t: float) -> Pose:
        return Twist(V, OMEGA, "body").carry(PLACED, t)

    def twist(self, t: float) -> Twist:
        return Twist(V, OMEGA, "body")


def test_offset_follows_any_path_and_its_times() -> None:
    for carrier in (AnswersInBodyAxes(), ConstantTwist(PLACED, Twist(V, OMEGA, "body"))):
        path = Offset(carrier, PLACED)
        assert (path.start, path.end) == (carrier.start, carrier.end)
        np.testing.assert_array_equal(path.pose(0.5).matrix, (carrier.pose(0.5) @ PLACED).matrix)
        # In the body's axes: the carrier's velocity at the offset point.
        expected = V + np.cross(OMEGA, PLACED.translation)
        back = carrier.pose(0.5).rotation.T
        np.testing.assert_allclose(back @ path.twist(0.5).v, expected, rtol=1e-14)
        np.testing.assert_allclose(back @ path.twist(0.5).omega, OMEGA, rtol=1e-14)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Fixed((1.0, 0.0, 0.0, 0.0)), "from_wxyz"),
        (lambda: ConstantTwist(PLACED, np.zeros(5)), "not a twist"),
        (lambda: Screw(PLACED, (0.0, 0.0, 0.0)), r"axis is \[0\. 0\. 0\.\]: .*above zero"),
        (lambda: Screw(PLACED, TILTED, pitch=math.nan), "pitch = nan"),
        (lambda: Screw(PLACED, TILTED, angular_rate=math.inf), "angular_rate = inf"),
        (lambda: Screw(PLACED, TILTED, point=(1.0, 2.0)), "point has shape"),
        (lambda: Helix(0.0, 1.0, 1.0), r"radius = 0\.0: must be pos"),
        (lambda: Helix(-1.0, 1.0, 1.0), r"radius = -1\.0: must be pos"),
        (lambda: Helix(1.0, "high", 1.0), "pitch = 'high'"),
        (lambda: Helix(1.0, 1.0, 1.0, axis=(0, 0, 0)), "axis is"),
        (lambda: Helix(1.0, 1.0, 1.0, orientation="loose"), "'loose': give 'fixed' or"),
        (lambda: Spiral(-0.1, 1.0, 1.0), r"radius = -0\.1: must be zero or pos"),
        (lambda: Spiral(1.0, 1.0, 1.0, centre=(0, 0, 0)), r"centre has shape \(3,\).*2 numbers"),
        (lambda: Spiral(1.0, 1.0, 1.0, orientation="loose"), "'loose': give 'fixed' or"),
        (lambda: Offset(Fixed(PLACED), np.eye(3)), "not a pose"),
    ],
)
def test_bad_input_is_refused(make: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make()


def test_a_carried_path_is_known_while_both_are() -> None:
    path = Carried(SAMPLES, PoseSamples([0.0, 9.0], [PLACED, PLACED]))
    assert (path.start, path.end) == (0.0, 4.0)
    assert Carried(Fixed(PLACED), Fixed(PLACED)).end == math.inf
