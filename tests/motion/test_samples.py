"""Sampled poses: meeting the samples, constant screws between them, and what is refused."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from standoff.motion import ConstantTwist, Pose, PoseSamples, Twist

POSES = [
    Pose.exp([0.7, -0.5, 0.9], [1.0, 2.0, 3.0]),
    Pose.identity(),
    Pose.exp([2.0, 1.0, 0.5], [0.0, -1.0, 0.2]),
]
TIMES = [-1.0, 0.5, 0.75]
SAMPLES = PoseSamples(TIMES, POSES)


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
    with pytest.raises(ValueError, match="start is nan"):
        SAMPLES.starting_at(math.nan)


def test_normalised_quaternions_are_counted() -> None:
    rounded = Pose.from_xyzw((0.0, 0.0, 0.0, 1.0001))
    samples = PoseSamples([0.0, 1.0, 2.0], [rounded, POSES[0], rounded])
    assert samples.normalised == 2
    assert samples.starting_at(5.0).normalised == 2
    assert SAMPLES.normalised == 0


@pytest.mark.parametrize(
    ("times", "poses", "message"),
    [
        ([0.0, 2.0, 1.0], POSES, r"times\[2\] = 1\.0 follows times\[1\] = 2\.0; sort"),
        ([0.0, 0.0, 1.0], POSES, r"times\[1\] = 0\.0 follows times\[0\] = 0\.0"),
        ([0.0, 1.0], POSES, r"times has shape \(2,\).*give 3 numbers"),
        ([0.0, math.nan, 1.0], POSES, r"times is .*nan.*finite"),
        ([0.0], POSES[:1], "1 samples make no motion"),
        ([], [], "0 samples make no motion"),
        ([0.0, 1.0], [POSES[0], np.eye(3)], r"pose 1: no pose"),
        ([0.0, 1.0], [POSES[1], Pose.exp([0.0, math.pi, 0.0])], r"poses 0 and 1 .*half turn"),
    ],
)
def test_bad_samples_are_refused(times: Any, poses: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        PoseSamples(times, poses)


def test_just_less_than_a_half_turn_has_one_way() -> None:
    samples = PoseSamples([0.0, 1.0], [POSES[1], Pose.exp([0.0, math.pi - 1e-6, 0.0])])
    np.testing.assert_allclose(samples.twist(0.3).omega, (0.0, math.pi - 1e-6, 0.0), atol=1e-14)
