"""Sampled poses: meeting the samples, constant screws between them, and what is refused."""

from __future__ import annotations

import math
import time
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from standoff.motion import ConstantTwist, Pose, PoseSamples, Twist

POSES = [
    Pose.exp([0.7, -0.5, 0.9], [1.0, 2.0, 3.0]),
    Pose.identity(),
    Pose.exp([2.0, 1.0, 0.5], [0.0, -1.0, 0.2]),
]
TIMES = [-1.0, 0.5, 0.75]
SAMPLES = PoseSamples(TIMES, POSES)
MATRICES = np.array([pose.matrix for pose in POSES])


def test_every_sample_is_met_exactly() -> None:
    for t, pose in zip(TIMES, POSES, strict=True):
        np.testing.assert_array_equal(SAMPLES.pose(t).matrix, pose.matrix)
    for before, pose in ((0.5, POSES[1]), (0.75, POSES[2])):
        near = SAMPLES.pose(math.nextafter(before, -1.0))
        np.testing.assert_allclose(near.matrix, pose.matrix, atol=3e-15)


@given(st.floats(-3.0, 3.0), st.lists(st.floats(0.01, 0.99), min_size=2, max_size=6, unique=True))
def test_samples_of_a_screw_give_the_screw(rate: float, fractions: list[float]) -> None:
    screw = ConstantTwist(POSES[0], Twist([1.0, -2.0, 0.5], [0.3 * rate, 0.2, -0.9], "body"))
    times = sorted(fractions)
    samples = PoseSamples(times, [screw.pose(t) for t in times])
    for t in np.linspace(samples.start, samples.end, 7):
        np.testing.assert_allclose(samples.pose(t).matrix, screw.pose(t).matrix, atol=2e-14)


def test_twist_is_that_of_the_interval_that_begins() -> None:
    in_body = [
        SAMPLES.pose(t).rotation.T @ SAMPLES.twist(t).omega for t in (-1.0, 0.4999, 0.5, 0.75)
    ]
    first = Twist.between(POSES[0], POSES[1], 1.5).omega
    second = Twist.between(POSES[1], POSES[2], 0.25).omega
    assert np.linalg.norm(first - second) > 1.0
    for found, expected in zip(in_body, (first, first, second, second), strict=True):
        np.testing.assert_allclose(found, expected, atol=1e-13)


@pytest.mark.parametrize("t", [-1.0000001, 0.7500001, 1e9])
def test_outside_the_samples_the_range_is_named(t: float) -> None:
    for ask in (SAMPLES.pose, SAMPLES.twist):
        with pytest.raises(ValueError, match=r"outside the samples: .* from -1\.0 to 0\.75"):
            ask(t)


def test_starting_at_shifts_the_times_alone() -> None:
    shifted = SAMPLES.starting_at(10.0)
    np.testing.assert_array_equal(shifted.times, [10.0, 11.5, 11.75])
    np.testing.assert_allclose(shifted.pose(11.6).matrix, SAMPLES.pose(0.6).matrix, atol=1e-14)
    assert (SAMPLES.start, shifted.start, shifted.end) == (-1.0, 10.0, 11.75)
    with pytest.raises(ValueError, match="start = nan"):
        SAMPLES.starting_at(math.nan)


def test_repaired_poses_are_counted() -> None:
    rounded = Pose.from_xyzw((0.0, 0.0, 0.0, 1.0001))
    samples = PoseSamples([0.0, 1.0, 2.0], [rounded, POSES[0], rounded])
    assert samples.repaired == 2
    assert samples.starting_at(5.0).repaired == 2
    assert SAMPLES.repaired == 0
    assert [pose.repaired for pose in samples.poses] == [True, False, True]
    single = PoseSamples([0.0, 1.0, 2.0], MATRICES.astype(np.float32))
    assert single.repaired == 2  # the identity is exact
    assert single.starting_at(1.0).repaired == 2


def test_an_array_of_matrices_is_the_list_of_them() -> None:
    for matrices in (
        MATRICES,
        MATRICES.astype(np.float32),
        np.round(MATRICES, 6),
        MATRICES.astype(object),
        np.asfortranarray(MATRICES),
        np.ma.array(MATRICES),
    ):
        stacked, listed = PoseSamples(TIMES, matrices), PoseSamples(TIMES, list(matrices))
        assert stacked.repaired == listed.repaired
        for one, other in zip(stacked.poses, listed.poses, strict=True):
            assert one.matrix.tobytes() == other.matrix.tobytes()
            assert one.repaired is other.repaired
        for t in (-1.0, -0.3, 0.5, 0.75):
            assert stacked.pose(t).matrix.tobytes() == listed.pose(t).matrix.tobytes()
            np.testing.assert_array_equal(stacked.twist(t).v, listed.twist(t).v)
    good = PoseSamples(TIMES, MATRICES)
    assert all(p.matrix.tobytes() == m.tobytes() for p, m in zip(good.poses, MATRICES, strict=True))


def test_the_array_is_copied() -> None:
    given = MATRICES.copy()
    samples = PoseSamples(TIMES, given)
    given[:] = 0.0
    np.testing.assert_array_equal(samples.poses[0].matrix, MATRICES[0])
    with pytest.raises(ValueError, match="read-only"):
        samples.poses[0].rotation[0, 0] = 1.0


def test_scipys_rigid_transforms_are_samples() -> None:
    rigid = pytest.importorskip("scipy.spatial.transform")
    if not hasattr(rigid, "RigidTransform"):
        pytest.skip("SciPy before 1.16")
    samples = PoseSamples(TIMES, rigid.RigidTransform.from_matrix(MATRICES))
    for pose, matrix in zip(samples.poses, MATRICES, strict=True):
        np.testing.assert_allclose(pose.matrix, matrix, atol=1e-15)


def changed(index: int, place: tuple[int, int], value: float) -> np.ndarray:
    """The matrices with one entry of one, and all of the last, replaced."""
    matrices = MATRICES.copy()
    matrices[index][place] = value
    matrices[2] *= np.nan
    return matrices


@pytest.mark.parametrize(
    ("matrices", "message"),
    [
        (changed(1, (0, 0), math.nan), r"pose 1: .*nan.*finite"),
        (changed(1, (0, 3), math.inf), r"pose 1: .*inf.*finite"),
        (changed(1, (0, 3), 2e100), r"pose 1: .*beyond 1e\+50"),
        (changed(1, (0, 0), 1e200), r"pose 1: .*beyond 1e\+50"),
        (changed(0, (0, 0), 1.0), r"pose 0: rotation .*not orthonormal"),
        (changed(1, (1, 1), -1.0), r"pose 1: rotation .*mirrored"),
        (changed(1, (3, 0), 1e-8), r"pose 1: the last row"),
        (MATRICES[:, :3], r"poses has shape \(3, 3, 4\): .*\(n, 4, 4\)"),
        (MATRICES[0], r"poses has shape \(4, 4\): .*\(n, 4, 4\)"),
        (np.zeros((3, 7)), r"poses has shape \(3, 7\): .*\(n, 4, 4\)"),
        (MATRICES > 0.0, r"poses is .*real"),
        (MATRICES + 0j, r"poses is .*real"),
        (np.ma.masked_equal(MATRICES, 1.0), "poses has masked numbers"),
        (MATRICES[:2], r"times has shape \(3,\).*give 2 numbers"),
        (np.zeros((0, 4, 4)), r"times has shape \(3,\).*give 0 numbers"),
    ],
)
def test_a_bad_array_is_refused_and_its_first_bad_pose_named(matrices: Any, message: str) -> None:
    with pytest.raises(ValueError, match=f"(?s){message}"):
        PoseSamples(TIMES, matrices)


@given(st.integers(0, 400), st.integers(0, 400))
def test_a_half_turn_is_found_wherever_it_is(place: int, seed: int) -> None:
    turns = np.random.default_rng(seed).normal(size=(402, 3)) * 0.5
    matrices = np.array([Pose.exp(turn).matrix for turn in turns[: place + 1]])
    half = Pose.exp([0.0, math.pi - 1e-10, 0.0]).matrix
    matrices = np.concatenate([matrices, [matrices[-1] @ half]])
    with pytest.raises(ValueError, match=rf"poses {place} and {place + 1} .*half turn"):
        PoseSamples(np.arange(place + 2.0), matrices)


@given(st.lists(st.floats(1e-9, 3.0), min_size=2, max_size=9), st.integers(0, 99))
def test_the_screw_of_each_interval_is_the_one_between_its_poses(
    angles: list[float], seed: int
) -> None:
    rng = np.random.default_rng(seed)
    poses = [Pose.exp(rng.normal(size=3), rng.normal(size=3))]
    for angle in angles:
        axis = rng.normal(size=3)
        poses.append(poses[-1] @ Pose.exp(angle * axis / np.linalg.norm(axis), rng.normal(size=3)))
    times = np.cumsum(rng.uniform(0.1, 1.0, len(poses)))
    samples = PoseSamples(times, poses)
    for k, t in enumerate(times[:-1].tolist()):
        expected = Twist.between(poses[k], poses[k + 1], times[k + 1] - times[k])
        np.testing.assert_array_equal(samples.twist(t).v, poses[k].rotation @ expected.v)
        np.testing.assert_array_equal(samples.twist(t).omega, poses[k].rotation @ expected.omega)


def test_ten_thousand_matrices_are_read_at_once() -> None:
    """Some 1 µs a pose; one by one they took 250."""
    turns = np.cumsum(np.full((10_000, 3), 1e-3), axis=0)
    matrices = np.tile(np.eye(4), (len(turns), 1, 1))
    matrices[:, :3, :3] = Rotation.from_rotvec(turns).as_matrix()
    times = np.arange(len(turns)) * 1e-3
    best = {}
    for name, stack in (("double", matrices), ("single", matrices.astype(np.float32))):
        spent = []
        for _ in range(5):
            begin = time.perf_counter()
            samples = PoseSamples(times, stack)
            spent.append(time.perf_counter() - begin)
            assert (samples.repaired > 9000) is (name == "single")
        best[name] = min(spent) / len(turns)
    assert max(best.values()) < 20e-6, best


@pytest.mark.parametrize(
    ("times", "poses", "message"),
    [
        ([0.0, 2.0, 1.0], POSES, r"times\[2\] = 1\.0 follows times\[1\] = 2\.0; sort"),
        ([0.0, 0.0, 1.0], POSES, r"times\[1\] = 0\.0 follows times\[0\] = 0\.0"),
        ([0.0, 1.0], POSES, r"times has shape \(2,\).*give 3 numbers"),
        ([0.0, math.nan, 1.0], POSES, r"times has a NaN or infinite number: .*nan"),
        ([0.0], POSES[:1], "1 samples do not make a motion"),
        ([], [], "0 samples do not make a motion"),
        ([0.0, 1.0], [POSES[0], np.eye(3)], r"pose 1: not a pose"),
        ([0.0, 1.0], [POSES[1], Pose.exp([0.0, math.pi, 0.0])], r"poses 0 and 1 .*half turn"),
        ([0.0, 1e-100], [POSES[1], POSES[2]], r"poses 0 and 1 .*too far apart .*beyond 1e\+50"),
        ([0.0, 5e-324], [POSES[1], POSES[2]], r"poses 0 and 1 .*too far apart .*beyond 1e\+50"),
    ],
)
def test_bad_samples_are_refused(times: Any, poses: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        PoseSamples(times, poses)


def test_just_less_than_a_half_turn_has_one_way() -> None:
    samples = PoseSamples([0.0, 1.0], [POSES[1], Pose.exp([0.0, math.pi - 1e-6, 0.0])])
    np.testing.assert_allclose(samples.twist(0.3).omega, (0.0, math.pi - 1e-6, 0.0), atol=1e-14)
