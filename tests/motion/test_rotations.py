"""Rounded rotations: which are repaired, to what, how it is told, and what is left to `nearest`."""

from __future__ import annotations

import re

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation

from standoff.motion import Pose
from standoff.motion.rotations import defect, without_rounding

SHIFT = np.array([1.75, -2.0, 0.5])
TURN = Rotation.from_rotvec([0.7, -0.5, 0.9]).as_matrix()

rotations = arrays(np.float64, 3, elements=st.floats(-3.0, 3.0)).map(
    lambda v: Rotation.from_rotvec(v).as_matrix()
)
noises = arrays(np.float64, (3, 3), elements=st.floats(-1.0, 1.0))


def off(matrix: np.ndarray) -> float:
    return float(np.abs(matrix.T @ matrix - np.eye(3)).max())


def polar(matrix: np.ndarray) -> np.ndarray:
    left, _, right = np.linalg.svd(matrix)
    return np.asarray(left @ right)


@given(rotations, noises, st.floats(1e-9, 3e-6))
def test_a_rounded_rotation_becomes_the_nearest_one(
    turn: np.ndarray, noise: np.ndarray, size: float
) -> None:
    rounded = turn + size * noise
    assume(1e-9 < off(rounded) < 1e-5)
    pose = Pose(rounded, SHIFT)
    assert pose.repaired
    assert off(pose.rotation) < 2e-15
    np.testing.assert_allclose(pose.rotation, polar(rounded), rtol=0, atol=2e-14)
    np.testing.assert_array_equal(pose.translation, SHIFT)
    assert not (pose @ pose).repaired


@given(rotations, noises, st.floats(0.0, 1e-9))
def test_a_good_rotation_is_kept_bit_for_bit(
    turn: np.ndarray, noise: np.ndarray, size: float
) -> None:
    matrix = turn + size * noise
    assume(off(matrix) < 0.999e-9)
    homogeneous = np.eye(4)
    homogeneous[:3, :3] = matrix
    for pose in (Pose(matrix), Pose.of(homogeneous), Pose.nearest((matrix, SHIFT))):
        assert pose.rotation.tobytes() == matrix.tobytes()
        assert not pose.repaired


@given(rotations)
def test_single_precision_and_six_decimals_are_within_the_tolerance(turn: np.ndarray) -> None:
    chain = np.eye(3, dtype=np.float32)
    for _ in range(30):
        chain = chain @ turn.astype(np.float32)
    for rounded in (turn.astype(np.float32), chain, np.round(turn, 6), np.round(turn, 6).tolist()):
        given_numbers = np.asarray(rounded, dtype=np.float64)
        pose = Pose.of((rounded, SHIFT))
        assert pose.repaired is (off(given_numbers) > 1e-9)
        assert np.abs(pose.rotation - given_numbers).max() < 1.5e-5


@given(rotations, noises, st.floats(2e-5, 0.1))
def test_worse_ones_are_refused_and_sent_to_nearest(
    turn: np.ndarray, noise: np.ndarray, size: float
) -> None:
    matrix = turn + size * noise
    assume(off(matrix) > 1.001e-5)
    with pytest.raises(ValueError, match=r"not orthonormal: .*1e-05, is repaired; .*Pose\.nearest"):
        Pose(matrix)
    pose = Pose.nearest((matrix, SHIFT))
    assert pose.repaired
    assert off(pose.rotation) < 3e-15


@given(rotations, noises, st.floats(0.0, 0.3), st.floats(1e-6, 1e6))
def test_nearest_is_the_rotation_nearest_to_the_matrix(
    turn: np.ndarray, noise: np.ndarray, size: float, scale: float
) -> None:
    """R is the nearest to M if and only if RᵀM is symmetric with no two eigenvalues of sum < 0."""
    matrix = turn + size * noise
    assume(np.linalg.det(matrix) > 0.1)
    rotation = Pose.nearest((scale * matrix, SHIFT)).rotation
    stretch = rotation.T @ matrix
    np.testing.assert_allclose(stretch, stretch.T, atol=1e-14)
    assert np.linalg.eigvalsh(stretch).min() > -1e-9
    assert off(rotation) < max(3e-15, off(matrix) * (scale == 1.0 and off(matrix) < 1e-9))


def test_nearest_reads_what_a_pose_is_read_from() -> None:
    sheared = TURN @ [[1.0, 0.3, 0.0], [0.0, 1.1, 0.0], [0.0, 0.0, 0.9]]
    homogeneous = np.eye(4)
    homogeneous[:3, :3], homogeneous[:3, 3] = sheared, SHIFT
    for pose in (Pose.nearest(homogeneous), Pose.nearest((sheared.tolist(), SHIFT))):
        np.testing.assert_allclose(pose.rotation, polar(sheared), atol=1e-15)
        np.testing.assert_array_equal(pose.translation, SHIFT)
        assert pose.repaired
    made = Pose(TURN, SHIFT)
    assert Pose.nearest(made) is made


@pytest.mark.parametrize(
    ("matrix", "message"),
    [
        (np.zeros((3, 3)), "is flat: it stretches by"),
        (np.diag([1.0, 1.0, 1e-7]), "is flat: it stretches by"),
        (np.diag([1.0, 1e-7, 1e-7]), "is flat: it stretches by"),
        (-np.eye(3), "is mirrored: its determinant"),
        (np.diag([1.0, 1.0, -0.5]) @ TURN, "is mirrored: its determinant is below 0"),
        (np.where(np.eye(3) > 0.0, np.nan, TURN), r"rotation has a NaN or infinite number: .*nan"),
        (np.full((3, 3), np.inf), r"rotation has a NaN or infinite number: .*inf"),
        (np.eye(4), r"rotation has shape \(4, 4\)"),
    ],
)
def test_what_has_no_nearest_rotation_is_refused(matrix: np.ndarray, message: str) -> None:
    with pytest.raises(ValueError, match=f"(?s){message}"):
        Pose.nearest((matrix, SHIFT))


@pytest.mark.parametrize("scale", [1e-99, 1e-3, 1.0001, 1e49])
def test_nearest_drops_a_scale_of_any_size(scale: float) -> None:
    pose = Pose.nearest((scale * TURN, SHIFT))
    np.testing.assert_allclose(pose.rotation, TURN, atol=1e-14)


def test_a_rounded_mirror_image_is_no_rounded_rotation() -> None:
    mirror = np.round(TURN @ np.diag([1.0, 1.0, -1.0]), 6)
    with pytest.raises(ValueError, match="is mirrored: its determinant is −1"):
        Pose(mirror)


def test_a_turn_in_the_plane_stays_in_it() -> None:
    rounded = np.round(Rotation.from_rotvec([0.0, 0.0, 0.7]).as_matrix(), 6)
    pose = Pose(rounded)
    assert pose.repaired
    np.testing.assert_array_equal(pose.rotation[2], (0.0, 0.0, 1.0))
    np.testing.assert_array_equal(pose.rotation[:, 2], (0.0, 0.0, 1.0))


def test_a_stack_is_repaired_as_each_of_it(rng: np.random.Generator) -> None:
    stack = Rotation.random(50, rng=rng).as_matrix() + rng.uniform(-2e-6, 2e-6, (50, 3, 3))
    repaired, defects = without_rounding(stack), defect(stack)
    for k, matrix in enumerate(stack):
        assert repaired[k].tobytes() == without_rounding(matrix).tobytes()
        assert defects[k] == defect(matrix) == pytest.approx(off(matrix), abs=1e-15)


def test_the_message_keeps_the_number() -> None:
    with pytest.raises(ValueError, match=re.escape("by 0.0002, and only")):
        Pose(TURN * 1.0001)
