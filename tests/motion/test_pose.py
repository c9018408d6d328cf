"""Poses: every way to make one, the group, and what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from standoff.motion import Pose, Twist

ROTATION = Rotation.from_rotvec([0.7, -0.5, 0.9]).as_matrix()
SHIFT = np.array([1.75, -2.0, 0.5])

vectors = arrays(np.float64, 3, elements=st.floats(-5.0, 5.0))
poses = st.builds(Pose.exp, vectors, vectors)


def cross_matrix(w: Any) -> np.ndarray:
    x, y, z = w
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


class OfAnotherLibrary:
    """A rigid motion as jaxlie and mink have them."""

    def __init__(self, matrix: np.ndarray) -> None:
        self.matrix = matrix

    def as_matrix(self) -> np.ndarray:
        return self.matrix


def test_every_form_reads_as_the_same_pose() -> None:
    homogeneous = np.eye(4)
    homogeneous[:3, :3], homogeneous[:3, 3] = ROTATION, SHIFT
    x, y, z, w = Rotation.from_matrix(ROTATION).as_quat()
    for pose in (
        Pose(ROTATION, SHIFT),
        Pose.of(Pose(ROTATION, SHIFT)),
        Pose.of(homogeneous),
        Pose.of(homogeneous.tolist()),
        Pose.of((ROTATION, SHIFT)),
        Pose.of([ROTATION.tolist(), SHIFT.tolist()]),
        Pose.from_wxyz((w, x, y, z), SHIFT),
        Pose.from_xyzw((x, y, z, w), SHIFT),
        Pose.exp([0.7, -0.5, 0.9], SHIFT),
        Pose((scipys := Rotation.from_matrix(ROTATION)), SHIFT),
        Pose.of((scipys, SHIFT)),
        Pose.of([scipys, SHIFT.tolist()]),
        Pose.of(OfAnotherLibrary(homogeneous)),
        Pose.nearest((scipys, SHIFT)),
    ):
        np.testing.assert_allclose(pose.matrix, homogeneous, rtol=0, atol=4e-16)
        assert not pose.repaired


def test_scipys_rigid_transform_is_a_pose() -> None:
    rigid = pytest.importorskip("scipy.spatial.transform")
    if not hasattr(rigid, "RigidTransform"):
        pytest.skip("SciPy before 1.16")
    transform = rigid.RigidTransform.from_components(SHIFT, Rotation.from_matrix(ROTATION))
    np.testing.assert_allclose(Pose.of(transform).matrix, transform.as_matrix(), rtol=0, atol=0)
    stack = rigid.RigidTransform.concatenate([transform, transform.inv()])
    with pytest.raises(ValueError, match=r"not a pose: shape \(2, 4, 4\)"):
        Pose.of(stack)


@given(vectors)
def test_exp_is_the_matrix_exponential(vector: np.ndarray) -> None:
    np.testing.assert_allclose(Pose.exp(vector).rotation, expm(cross_matrix(vector)), atol=3e-13)


@given(poses, poses, poses, vectors)
def test_group_laws(a: Pose, b: Pose, c: Pose, point: np.ndarray) -> None:
    np.testing.assert_allclose((a @ b).matrix, a.matrix @ b.matrix, atol=1e-14)
    np.testing.assert_allclose((a @ b @ c).matrix, (a @ (b @ c)).matrix, atol=1e-13)
    np.testing.assert_allclose((a @ a.inverse()).matrix, np.eye(4), atol=1e-14)
    np.testing.assert_allclose((a.inverse() @ a).matrix, np.eye(4), atol=1e-14)
    np.testing.assert_allclose((a @ Pose.identity()).matrix, a.matrix, atol=0)
    np.testing.assert_allclose((a @ b).apply(point), a.apply(b.apply(point)), atol=1e-13)


def test_apply_maps_any_stack_of_points() -> None:
    pose = Pose(ROTATION, SHIFT)
    points = np.arange(24.0).reshape(2, 4, 3)
    mapped = pose.apply(points)
    assert mapped.shape == points.shape
    for index in np.ndindex(2, 4):
        np.testing.assert_allclose(mapped[index], ROTATION @ points[index] + SHIFT, rtol=1e-15)


@pytest.mark.parametrize("points", [1.0, [1.0, 2.0], np.zeros((3, 2))])
def test_apply_refuses_points_without_three_components(points: Any) -> None:
    with pytest.raises(ValueError, match=r"points have shape .* \(\.\.\., 3\)"):
        Pose.identity().apply(points)


def test_arrays_are_read_only_copies() -> None:
    rotation, shift = ROTATION.copy(), SHIFT.copy()
    made = Pose(rotation, shift)
    rotation[0, 0], shift[0] = 5.0, 5.0
    assert made.translation[0] == SHIFT[0]
    assert made.rotation[0, 0] == ROTATION[0, 0]
    for pose in (made, made @ made, made.inverse(), Pose.identity(), Pose.from_wxyz((1, 0, 0, 0))):
        with pytest.raises(ValueError, match="read-only"):
            pose.rotation[0, 0] = 1.0
        with pytest.raises(ValueError, match="read-only"):
            pose.translation[0] = 1.0
    with pytest.raises(AttributeError):
        made.rotation = rotation  # type: ignore[misc]


def test_rounded_quaternion_is_brought_to_unit_norm_and_says_so() -> None:
    exact = Rotation.from_matrix(ROTATION).as_quat()
    for factor, reported in ((1.0 + 1e-15, False), (1.0009, True), (0.9991, True)):
        pose = Pose.from_xyzw(exact * factor, SHIFT)
        assert pose.repaired is reported
        np.testing.assert_allclose(pose.rotation, ROTATION, atol=1e-15)
    assert not (pose @ pose).repaired


@pytest.mark.parametrize("norm", [1.0011, 0.9989, 0.0, 2.0])
def test_quaternion_far_from_unit_norm_is_refused_with_its_norm(norm: float) -> None:
    for make in (Pose.from_wxyz, Pose.from_xyzw):
        with pytest.raises(ValueError, match=rf"norm {norm:.9g},.*unit norm"):
            make(np.array([0.0, 0.6, 0.0, 0.8]) * norm)


NAN = float("nan")
MIRROR = np.diag([1.0, 1.0, -1.0])
TRANSPOSED = np.block([[ROTATION.T, np.zeros((3, 1))], [SHIFT, 1.0]])


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ((1.0, 0.0, 0.0, 0.0), r"four numbers .*from_wxyz.*from_xyzw"),
        (np.array([1.0, 0.0, 0.0, 0.0]), r"four numbers .*from_wxyz.*from_xyzw"),
        (((1.0, 0.0, 0.0, 0.0), SHIFT), r"four numbers .*from_wxyz.*from_xyzw"),
        (ROTATION, r"not a pose: shape \(3, 3\).*pair \(R, p\)"),
        (Rotation.from_matrix(ROTATION), r"not a pose: shape \(3, 3\).*pair \(R, p\)"),
        (Rotation, r"not a pose: .*give a Pose"),
        ((Rotation.random(2, rng=0), SHIFT), r"rotation has shape \(2, 3, 3\).*3 by 3"),
        (OfAnotherLibrary(ROTATION * NAN), r"not a pose: shape \(3, 3\)"),
        ("here", r"not a pose: shape \(\).*give a Pose"),
        ([[1.0], [2.0, 3.0], [4.0]], r"not a pose: \[\[1\.0\].*give a Pose"),
        (None, r"not a pose: .*give a Pose"),
        (TRANSPOSED, r"last row .*transpose"),
        ((2.0 * ROTATION, SHIFT), r"rotation .*not orthonormal: .* by 3"),
        ((np.zeros((3, 3)), SHIFT), r"rotation .*not orthonormal: .* by 1"),
        ((ROTATION + 1e-5, SHIFT), r"rotation .*not orthonormal: .*Pose\.nearest"),
        ((ROTATION @ MIRROR, SHIFT), r"mirrored: its determinant is −1"),
        ((ROTATION * NAN, SHIFT), r"rotation has a NaN or infinite number: .*nan"),
        ((ROTATION, (0.0, float("inf"), 0.0)), r"translation has a NaN or infinite number: .*inf"),
        ((ROTATION, (0.0, 0.0)), r"translation has shape \(2,\).*give 3 numbers"),
        ((ROTATION, ("a", 0.0, 0.0)), r"translation is .*'a'.*give 3 numbers"),
        ((np.eye(2), (0.0, 0.0)), r"rotation has shape \(2, 2\).*3 by 3"),
        ((ROTATION + 0j, SHIFT), r"rotation is .*all of them real"),
    ],
)
def test_what_is_no_pose_is_refused(value: Any, message: str) -> None:
    with pytest.raises(ValueError, match=f"(?s){message}"):
        Pose.of(value)


@pytest.mark.parametrize("make", [Pose.from_wxyz, Pose.from_xyzw])
def test_broken_quaternions_are_refused(make: Any) -> None:
    with pytest.raises(ValueError, match=r"quaternion .*finite"):
        make((NAN, 0.0, 0.0, 1.0))
    with pytest.raises(ValueError, match=r"quaternion .*shape \(3,\)"):
        make((0.0, 0.0, 1.0))
    with pytest.raises(ValueError, match=r"translation has shape"):
        make((0.5, 0.5, 0.5, 0.5), (1.0, 2.0))
    with pytest.raises(ValueError, match=r"rotation_vector .*finite"):
        Pose.exp((0.0, NAN, 0.0))


def test_composing_with_something_else_is_a_type_error() -> None:
    with pytest.raises(TypeError):
        Pose.identity() @ np.eye(4)  # type: ignore[operator]


def test_a_homogeneous_matrix_is_sent_to_where_it_is_read():
    with pytest.raises(ValueError, match=r"(?s)rotation has shape.*Pose\.of\(matrix\)"):
        Pose(np.eye(4))


def test_a_pose_and_a_twist_are_written_on_one_line_that_makes_them_again() -> None:
    pose = Pose.exp([0.1, -2.0, 1e-17], [1234.5678, 0.0, -1e-30])
    assert repr(pose) == "Pose.exp([0.1, -2, 0], [1234.57, 0, 0])"
    assert repr(Pose.identity()) == "Pose.exp([0, 0, 0], [0, 0, 0])"
    again = eval(repr(pose), {"Pose": Pose})
    assert np.abs(again.matrix - pose.matrix).max() < 1e-2
    assert np.abs(again.rotation - pose.rotation).max() < 1e-5
    assert repr(Twist([1, 2, 1e-20], [0, 0, 0.5])) == "Twist([1, 2, 0], [0, 0, 0.5])"
    assert repr(Twist([0, 0, 0], [0, 0, 1e-20], "body")).endswith('[0, 0, 1e-20], "body")')
