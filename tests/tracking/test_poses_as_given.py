"""Poses as users have them, in queries and runs: rounded, SciPy's, and functions of time."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial import transform
from scipy.spatial.transform import Rotation

import standoff as so
from standoff.motion import Bounded, PoseFunction, PoseLike, PoseSamples, Screw
from standoff.motion.moving import MotionLike

LENS, TOOL = so.shapes.lens(1.0, 0.45), so.shapes.ellipsoid(0.15, 0.30, 0.20)
HOME = so.Pose.identity()
SCREW = Screw(so.Pose.exp([0.0, 0.4, 0.3], [1.6, 0.3, 0.2]), (0, 0, 1), angular_rate=0.8, pitch=0.1)
AWAY = SCREW.pose(0.3)
SINGLE = AWAY.matrix.astype(np.float32)
TURN = Rotation.from_matrix(AWAY.rotation)
MOVING = so.Twist([0.1, 0.0, 0.0], [0.0, 0.0, 0.2])

ROUNDED = {
    "single precision": SINGLE,
    "single precision in double": SINGLE.astype(np.float64),
    "six decimals": np.round(AWAY.matrix, 6),
    "a list": SINGLE.tolist(),
    "a pair": (SINGLE[:3, :3], SINGLE[:3, 3]),
    "a pose": so.Pose.of(SINGLE),
}


@pytest.mark.parametrize("pose", ROUNDED.values(), ids=ROUNDED.keys())
def test_a_rounded_pose_is_answered_for_its_nearest_rotation_and_counted(pose: PoseLike) -> None:
    repaired = so.Pose.of(pose)
    assert repaired.repaired
    exact = so.Pose(repaired.rotation, repaired.translation)
    expected = so.distance(LENS, TOOL, HOME, exact)
    assert expected.repaired == 0
    assert expected.distance == pytest.approx(
        so.distance(LENS, TOOL, HOME, AWAY).distance, abs=1e-5
    )

    answer = so.distance(LENS, TOOL, HOME, pose)
    assert (answer.distance, answer.repaired) == (expected.distance, 1)
    assert so.distance(TOOL, LENS, pose, pose).repaired == 2

    tracker = so.Tracker(LENS, TOOL)
    plain = tracker.step(tracker.start(HOME, HOME), HOME, exact, MOVING, MOVING)[1]
    stepped = tracker.step(tracker.start(HOME, HOME), HOME, pose, MOVING, MOVING)[1]
    np.testing.assert_array_equal(stepped.row, plain.row)
    assert (stepped.repaired, plain.repaired) == (1, 0)
    assert stepped.poses is not None
    np.testing.assert_array_equal(stepped.poses[1][:9], exact.rotation.ravel())


def test_a_given_matrix_is_not_written_to() -> None:
    given = SINGLE.astype(np.float64)
    kept = given.copy()
    so.distance(LENS, TOOL, given, given)
    np.testing.assert_array_equal(given, kept)


def test_good_matrices_are_answered_bit_for_bit_and_not_counted() -> None:
    answer = so.distance(LENS, TOOL, HOME.matrix, AWAY.matrix)
    np.testing.assert_array_equal(answer.row, so.distance(LENS, TOOL, HOME, AWAY).row)
    assert answer.repaired == 0
    assert answer.poses is not None
    assert answer.poses[1][:9].tobytes() == AWAY.rotation.tobytes()


def test_rows_that_miss_the_tolerance_where_columns_pass_are_repaired() -> None:
    """The kernels ask of the rows what a pose asks of the columns."""
    turn, found = AWAY.rotation, 0
    for size in np.linspace(3.2e-10, 5e-10, 40):
        matrix = turn @ np.array([[1.0, size, size], [size, 1.0, size], [size, size, 1.0]])
        columns = np.abs(matrix.T @ matrix - np.eye(3)).max()
        rows = np.abs(matrix @ matrix.T - np.eye(3)).max()
        if columns <= 1e-9 < rows:
            found += 1
            assert so.distance(LENS, TOOL, HOME, (matrix, AWAY.translation)).repaired == 1
    assert found


def test_a_frame_in_place_repairs_the_buffer_and_counts() -> None:
    tracker = so.Tracker(LENS, TOOL)
    buffer = tracker.buffer(tracker.start(HOME, AWAY))
    buffer.pose_b[:9], buffer.pose_b[9:] = SINGLE[:3, :3].ravel(), SINGLE[:3, 3]
    exact = so.Pose.of(SINGLE)
    distance = tracker.step_into(buffer)
    assert (buffer.repaired, buffer.proximity().repaired) == (1, 1)
    np.testing.assert_array_equal(buffer.pose_b[:9], exact.rotation.ravel())
    tracker.step_into(buffer)
    assert (buffer.repaired, buffer.proximity().repaired) == (0, 0)
    assert distance == pytest.approx(so.distance(LENS, TOOL, HOME, AWAY).distance, abs=1e-6)


def test_a_position_beyond_all_lengths_is_named() -> None:
    far = np.eye(4)
    far[0, 3] = 1e101
    with pytest.raises(so.StandoffError, match=r"pose_b: translation has a number beyond 1e\+50"):
        so.distance(LENS, TOOL, HOME, far)


def test_scipys_rotation_and_transform_are_answered() -> None:
    expected = so.distance(LENS, TOOL, HOME, AWAY).distance
    given: list[PoseLike] = [(TURN, AWAY.translation)]
    if hasattr(transform, "RigidTransform"):  # from SciPy 1.16 on
        given.append(transform.RigidTransform.from_components(AWAY.translation, TURN))
    for pose in given:
        assert so.distance(LENS, TOOL, HOME, pose).distance == pytest.approx(expected, abs=1e-14)


# --- functions of time ------------------------------------------------------------------------


def run(path_b: MotionLike, **options: float) -> so.Recording:
    return so.track(so.Tracker(LENS, TOOL, 2e-3), HOME, path_b, 0.3, **options)


def test_a_function_of_time_is_a_path() -> None:
    exact, found = run(SCREW), run(lambda t: SCREW.pose(t).matrix)
    np.testing.assert_allclose(found.distance, exact.distance, atol=1e-12)
    np.testing.assert_allclose(found.rate, exact.rate, atol=1e-9)
    assert found.certified.all()
    assert found.counts[1:, 1].mean() == pytest.approx(exact.counts[1:, 1].mean(), abs=0.05)
    own = run(PoseFunction(SCREW.pose, SCREW.twist))
    np.testing.assert_array_equal(own.distance, exact.distance)


def test_a_run_asks_a_function_for_no_time_outside_it() -> None:
    def guarded(t: float) -> so.Pose:
        assert 0.5 <= t <= 0.8 + 1e-12
        return SCREW.pose(t)

    assert run(guarded, start=0.5).certified.all()


def test_a_run_counts_the_rounded_poses_of_its_paths() -> None:
    frames = len(run(SCREW))
    assert run(SCREW).info.repaired == 0
    for path in (
        lambda t: SCREW.pose(t).matrix.astype(np.float32),
        lambda t: np.round(SCREW.pose(t).matrix, 6),
    ):
        recording = run(path)
        assert recording.info.repaired == frames
        assert recording.certified.all()


class Raw:
    """A path whose poses are plain matrices in single precision."""

    def pose(self, t: float) -> np.ndarray:
        return SCREW.pose(t).matrix.astype(np.float32)

    def twist(self, t: float) -> so.Twist:
        return SCREW.twist(t)


class Widened(Raw):
    def pose(self, t: float) -> np.ndarray:
        return super().pose(t).astype(np.float64)


@pytest.mark.parametrize("path", [Raw(), Widened()])
def test_a_path_of_plain_matrices_is_repaired_and_its_switches_located(path: Raw) -> None:
    recording = run(path)
    assert recording.info.repaired == len(recording)
    exact = run(SCREW)
    np.testing.assert_allclose(recording.distance, exact.distance, atol=1e-6)
    assert recording.certified.all()


def test_a_function_with_bounds_has_a_time_of_impact() -> None:
    def falling(t: float) -> tuple[Rotation, list[float]]:
        return Rotation.from_rotvec([0.0, 0.0, 0.3 * t]), [3.0 - t, 0.1, 0.0]

    bounds = {"speed": 1.0, "acceleration": 0.0, "angular_speed": 0.3, "angular_acceleration": 0.0}
    found = so.time_of_impact(LENS, TOOL, HOME, Bounded(falling, **bounds), 3.0)
    exact = so.time_of_impact(
        LENS,
        TOOL,
        HOME,
        so.motion.ConstantTwist(so.Pose.of(falling(0.0)), ([-1.0, 0, 0], [0, 0, 0.3])),
        3.0,
    )
    assert found.status is so.impact.ImpactStatus.IMPACT
    assert found.time == pytest.approx(exact.time, abs=1e-8)
    with pytest.raises(TypeError, match=r"it is not known how fast PoseFunction.*Bounded"):
        so.time_of_impact(LENS, TOOL, HOME, falling, 3.0)


def test_samples_in_single_precision_reach_an_impact() -> None:
    times = np.linspace(0.0, 3.0, 31)
    matrices = np.array([so.Pose.exp([0, 0, 0.3 * t], [3.0 - t, 0.1, 0.0]).matrix for t in times])
    found = so.time_of_impact(
        LENS, TOOL, HOME, PoseSamples(times, matrices.astype(np.float32)), 3.0
    )
    exact = so.time_of_impact(LENS, TOOL, HOME, PoseSamples(times, matrices), 3.0)
    assert found.time == pytest.approx(exact.time, abs=1e-5)


def test_a_point_follows_a_function() -> None:
    disc = so.shapes.planar_loop([so.geometry.ConicArc((0, 0), (1, 0), (0, 1), 0.0, math.tau)])
    times = np.linspace(0.0, 0.2, 41)

    def passing(t: float) -> so.Pose:
        assert 0.0 <= t <= 0.2
        return so.Pose(np.eye(3), [2.0, t, 0.0])

    recording = so.points.record_point(so.PointTracker(disc), passing, times)
    np.testing.assert_allclose(recording.distance, np.hypot(2.0, times) - 1.0, atol=1e-9)


def test_what_is_neither_path_nor_pose_is_refused() -> None:
    with pytest.raises(TypeError, match=r"path_b = 3\.0 is neither a path .* nor a function of"):
        run(3.0)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"at t = 0\.0: not a pose"):
        run(lambda t: None)  # type: ignore[arg-type, return-value]


def test_what_evaluates_a_pair_at_rest_counts_repaired_poses_too() -> None:
    body = so.shapes.ellipsoid(1.0, 0.8, 0.6)
    away = so.Pose(AWAY.rotation, AWAY.translation + np.array([3.0, 0.0, 0.0]))
    best = so.distance(body, body, HOME, away)
    places = best.place_a, best.place_b
    tracker = so.Tracker(body, body, 1e-3)
    for pose, count in ((away, 0), (away.matrix.astype(np.float32), 1)):
        assert so.tracking.pair_system(body, body, HOME, pose, *places).repaired == count
        assert so.control.basin(tracker, HOME, pose, [places], 1).repaired == count
        levels = so.control.lyapunov_level(body, body, HOME, pose, directions=2)
        assert levels.repaired == count
