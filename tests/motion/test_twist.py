"""Twists: frames, the exponential and its logarithm, and what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.linalg import expm

from standoff.motion import Pose, Twist

vectors = arrays(np.float64, 3, elements=st.floats(-3.0, 3.0))
poses = st.builds(Pose.exp, vectors, vectors)
V, OMEGA = np.array([1.0, -2.0, 0.5]), np.array([0.3, 0.2, -0.9])
PLACED = Pose.exp([0.7, -0.5, 0.9], [1.0, 2.0, 3.0])


def twist_matrix(v: np.ndarray, w: np.ndarray) -> np.ndarray:
    x, y, z = w
    return np.array([[0, -z, y, v[0]], [z, 0, -x, v[1]], [-y, x, 0, v[2]], [0, 0, 0, 0]])


def test_every_form_reads_as_the_same_twist() -> None:
    for value in (Twist(V, OMEGA), (V, OMEGA), [V.tolist(), OMEGA.tolist()], np.r_[V, OMEGA]):
        twist = Twist.of(value)
        assert twist.frame == "world"
        np.testing.assert_array_equal(twist.v, V)
        np.testing.assert_array_equal(twist.omega, OMEGA)


def test_in_world_turns_both_parts_of_a_body_frame_twist() -> None:
    world = Twist(V, OMEGA, frame="body").in_world(PLACED)
    assert world.frame == "world"
    np.testing.assert_allclose(world.v, PLACED.rotation @ V, rtol=1e-15)
    np.testing.assert_allclose(world.omega, PLACED.rotation @ OMEGA, rtol=1e-15)
    given_in_world = Twist(V, OMEGA)
    assert given_in_world.in_world(PLACED) is given_in_world


def test_arrays_are_read_only_copies() -> None:
    v = V.copy()
    twist = Twist(v, OMEGA)
    v[0] = 7.0
    assert twist.v[0] == V[0]
    with pytest.raises(ValueError, match="read-only"):
        twist.omega[0] = 1.0
    with pytest.raises(AttributeError):
        twist.frame = "body"  # type: ignore[misc]


@given(vectors, vectors, st.floats(-2.0, 2.0))
def test_carry_in_body_axes_is_the_exponential(
    v: np.ndarray, omega: np.ndarray, duration: float
) -> None:
    carried = Twist(v, omega, "body").carry(PLACED, duration)
    expected = PLACED.matrix @ expm(twist_matrix(v, omega) * duration)
    np.testing.assert_allclose(carried.matrix, expected, atol=1e-11)


@pytest.mark.parametrize("angle", [0.0, 1e-300, 1e-16, 1e-9, 1e-6, 1e-4, 1e-2, 1.0, 3.0, 3.14159])
def test_exponential_and_logarithm_keep_their_digits_at_every_angle(angle: float) -> None:
    omega = np.array([2.0, -1.0, 2.0]) / 3.0 * angle
    carried = Twist(V, omega, "body").carry(PLACED, 1.0)
    expected = PLACED.matrix @ expm(twist_matrix(V, omega))
    np.testing.assert_allclose(carried.matrix, expected, atol=3e-15)
    back = Twist.between(PLACED, carried, 1.0)
    np.testing.assert_allclose(back.v, V, atol=5e-15)
    np.testing.assert_allclose(back.omega, omega, atol=2e-15)


@given(poses, poses, st.floats(1e-3, 1e3))
def test_between_then_carry_arrives(first: Pose, second: Pose, duration: float) -> None:
    arrived = Twist.between(first, second, duration).carry(first, duration)
    np.testing.assert_allclose(arrived.matrix, second.matrix, atol=1e-13)


@given(vectors, vectors)
def test_carry_in_world_axes_goes_straight_while_turning(v: np.ndarray, omega: np.ndarray) -> None:
    carried = Twist(v, omega).carry(PLACED, 0.5)
    np.testing.assert_allclose(carried.translation, PLACED.translation + 0.5 * v, atol=1e-15)
    turned = Pose.exp(0.5 * omega).rotation @ PLACED.rotation
    np.testing.assert_allclose(carried.rotation, turned, atol=1e-15)


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (np.zeros(5), r"not a twist: shape \(5,\).*v first"),
        (np.zeros((3, 2)), r"not a twist: shape \(3, 2\).*v first"),
        ([[1.0], [2.0, 3.0]], r"not a twist: .*v first"),
        ("fast", r"not a twist: .*v first"),
        ((V, OMEGA * float("nan")), r"omega has a NaN or infinite number: .*nan"),
        ((V * float("inf"), OMEGA), r"v has a NaN or infinite number: .*inf"),
    ],
)
def test_what_is_no_twist_is_refused(value: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Twist.of(value)


def test_unknown_frame_is_refused() -> None:
    with pytest.raises(ValueError, match="frame = 'spatial': give 'world' or 'body'"):
        Twist(V, OMEGA, frame="spatial")  # type: ignore[arg-type]


@pytest.mark.parametrize("duration", [0.0, -1.0, float("nan"), "long"])
def test_between_refuses_a_duration_that_is_not_positive(duration: Any) -> None:
    with pytest.raises(ValueError, match="duration = "):
        Twist.between(PLACED, PLACED, duration)
