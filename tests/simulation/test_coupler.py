"""The virtual coupler's wrenches: their law, their symmetries, their limits."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from standoff import Pose, StandoffError, Twist
from standoff.simulation import (
    CouplerState,
    DeviceReading,
    Fault,
    PassivityController,
    VirtualCoupler,
    Wrench,
)
from standoff.simulation.six_axes import limited, rotation_error

T = 1e-3
HOME, AT_REST = Pose.identity(), Twist.zero()
GIVEN: dict[str, Any] = {
    "stiffness": 500.0,
    "damping": 2.0,
    "rotational_stiffness": 1.5,
    "rotational_damping": 0.01,
    "max_force": 1e6,
    "max_torque": 1e6,
    "engage_time": 0.0,
    "max_age": 0.01,
}
COUPLER = VirtualCoupler(**GIVEN)

numbers = st.floats(-1.0, 1.0)
vectors = st.tuples(numbers, numbers, numbers).map(np.array)
# Below LET_GO_ANGLE apart, whatever two of them are given.
turns = vectors.map(lambda v: 0.8 * v)
any_turn = st.tuples(vectors, st.floats(0.0, math.pi)).map(
    lambda drawn: drawn[1] * drawn[0] / max(float(np.linalg.norm(drawn[0])), 1e-3)
)


def rotation(vector: Any) -> Any:
    return Rotation.from_rotvec(np.array(vector)).as_matrix()


def flat(matrix: Any) -> tuple[float, ...]:
    return tuple(np.asarray(matrix).ravel().tolist())


def rendered(
    handle: Pose, moving: Twist, tool: Pose, tool_moving: Twist, coupler: VirtualCoupler = COUPLER
) -> tuple[Wrench, Wrench]:
    """The wrenches of a first tick."""
    state = coupler.engage(coupler.start())
    state, on_device, on_tool = coupler.step(
        state, DeviceReading(0.0, 0, handle, moving), tool, tool_moving, T
    )
    assert state.fault is Fault.NONE
    return on_device, on_tool


@settings(max_examples=40)
@given(p=vectors, f=turns, v=vectors, w=vectors, q=vectors, g=turns)
def test_the_wrenches_are_those_of_spring_and_damper(
    p: Any, f: Any, v: Any, w: Any, q: Any, g: Any
) -> None:
    on_device, on_tool = rendered(
        Pose.exp(f, p), Twist(v, w), Pose.exp(g, q), Twist(0.5 * w, -0.3 * v)
    )
    error = Rotation.from_matrix(rotation(f) @ rotation(g).T).as_rotvec()
    force = 500.0 * (p - q) + 2.0 * (v - 0.5 * w)
    torque = 1.5 * error + 0.01 * (w + 0.3 * v)
    np.testing.assert_allclose(on_tool.force, force, rtol=1e-12, atol=1e-11)
    np.testing.assert_allclose(on_tool.torque, torque, rtol=1e-9, atol=1e-11)
    assert (on_device.force == -on_tool.force).all()
    assert (on_device.torque == -on_tool.torque).all()


@settings(max_examples=40)
@given(p=vectors, f=turns, v=vectors, w=vectors, q=vectors, g=turns)
def test_exchanging_handle_and_tool_turns_the_wrenches_round(
    p: Any, f: Any, v: Any, w: Any, q: Any, g: Any
) -> None:
    one, other = (Pose.exp(f, p), Twist(v, w)), (Pose.exp(g, q), Twist(w, v))
    _, on_tool = rendered(*one, *other)
    _, exchanged = rendered(*other, *one)
    np.testing.assert_allclose(on_tool.force, -exchanged.force, rtol=1e-12, atol=1e-11)
    np.testing.assert_allclose(on_tool.torque, -exchanged.torque, rtol=1e-9, atol=1e-11)


@settings(max_examples=40)
@given(p=vectors, f=turns, v=vectors, w=vectors, shift=vectors, about=any_turn)
def test_a_turned_and_shifted_world_turns_the_wrenches(
    p: Any, f: Any, v: Any, w: Any, shift: Any, about: Any
) -> None:
    tool = Pose.exp([0.1, -0.2, 0.3], [0.2, 0.1, 0.0])
    _, on_tool = rendered(Pose.exp(f, p), Twist(v, w), tool, AT_REST)
    world = Pose(rotation(about), shift)
    turn = world.rotation
    moved = Twist(turn @ v, turn @ w)
    _, there = rendered(world @ Pose.exp(f, p), moved, world @ tool, AT_REST)
    np.testing.assert_allclose(there.force, turn @ on_tool.force, rtol=1e-11, atol=1e-10)
    np.testing.assert_allclose(there.torque, turn @ on_tool.torque, rtol=1e-9, atol=1e-10)


@given(f=any_turn, g=any_turn)
def test_the_rotation_error_is_the_logarithm(f: Any, g: Any) -> None:
    found = np.array(rotation_error(flat(rotation(f)), flat(rotation(g))))
    truth = Rotation.from_matrix(rotation(f) @ rotation(g).T).as_rotvec()
    # Where both ways round are as short, SciPy may take the other.
    if np.linalg.norm(truth) > math.pi - 1e-7 and found @ truth < 0.0:
        truth *= 1.0 - 2.0 * math.pi / np.linalg.norm(truth)
    np.testing.assert_allclose(found, truth, rtol=0.0, atol=3e-8)
    np.testing.assert_allclose(rotation(found), rotation(f) @ rotation(g).T, atol=1e-14)


@given(angle=st.floats(1e-9, math.pi - 1e-9), axis=vectors)
def test_the_rotation_error_keeps_its_digits_at_small_and_large_angles(
    angle: float, axis: Any
) -> None:
    length = float(np.linalg.norm(axis))
    if length < 1e-2:
        axis, length = np.array([0.0, 0.6, 0.8]), 1.0
    vector = angle * axis / length
    found = np.array(rotation_error(flat(rotation(vector)), flat(np.eye(3))))
    np.testing.assert_allclose(found, vector, rtol=0.0, atol=1e-15 + 1e-14 * angle)


@given(f=any_turn, direction=vectors)
def test_the_torque_is_the_gradient_of_the_potential(f: Any, direction: Any) -> None:
    """Of ½ |log R|², along turns of R about the world's axes; central differences, order 4."""
    if np.linalg.norm(f) > math.pi - 0.02:
        f = f * (math.pi - 0.02) / np.linalg.norm(f)

    def potential(s: float) -> float:
        turned = rotation(s * direction) @ rotation(f)
        error = rotation_error(flat(turned), flat(np.eye(3)))
        return 0.5 * sum(part * part for part in error)

    h = 1e-3
    slope = 8.0 * (potential(h) - potential(-h)) - (potential(2 * h) - potential(-2 * h))
    error = np.array(rotation_error(flat(rotation(f)), flat(np.eye(3))))
    assert slope / (12.0 * h) == pytest.approx(float(error @ direction), abs=1e-9)


def test_at_a_half_turn_either_way_is_returned_and_both_are_half_turns() -> None:
    for axis in np.vstack([np.eye(3), [[0.6, 0.0, 0.8], [-0.6, 0.8, 0.0]]]):
        half = 2.0 * np.outer(axis, axis) - np.eye(3)
        found = np.array(rotation_error(flat(half), flat(np.eye(3))))
        assert np.linalg.norm(found) == pytest.approx(math.pi, abs=1e-14)
        assert np.linalg.norm(np.cross(found, axis)) == pytest.approx(0.0, abs=1e-14)


def test_near_a_half_turn_the_coupler_lets_go() -> None:
    state = COUPLER.engage(COUPLER.start())
    for k, angle in enumerate([2.9, 2.99, 3.01, 2.0]):
        reading = DeviceReading(k * T, k, Pose.exp([0.0, angle, 0.0]), AT_REST)
        state, on_device, on_tool = COUPLER.step(state, reading, HOME, AT_REST, T)
        expected = 1.5 * angle if k < 2 else 0.0
        assert on_tool.torque[1] == pytest.approx(expected)
        assert on_device.torque[1] == pytest.approx(-expected)
    assert state.fault is Fault.HALF_TURN
    assert state.counts.faults == 1
    # With no rotational spring there is no torque to turn round.
    three = VirtualCoupler(stiffness=1.0, damping=0.0, max_force=1.0, max_age=0.01, engage_time=0.0)
    rendered(Pose.exp([0.0, 3.1, 0.0]), AT_REST, HOME, AT_REST, three)


@given(wanted=vectors, last=vectors, most=st.floats(0.01, 2.0), rise=st.floats(1e-3, 2.0))
def test_limits_never_turn_a_vector_round(wanted: Any, last: Any, most: float, rise: float) -> None:
    found, shortened, slewed = limited(tuple(wanted), tuple(last), most, rise)
    size, length = float(np.linalg.norm(found)), float(np.linalg.norm(wanted))
    assert np.linalg.norm(np.cross(found, wanted)) <= 1e-12
    assert np.dot(found, wanted) >= 0.0
    assert size <= min(most, length) * (1 + 1e-12)
    assert size <= np.linalg.norm(last) + rise + 1e-12
    assert shortened == (length > most)
    if not shortened and not slewed:
        assert found == pytest.approx(tuple(wanted), rel=1e-15)
    # Within the rise there is a longer one only if that is beyond the limits.
    longer = np.array(found) * (1.0 + 1e-6)
    if slewed and size > 1e-6 and np.linalg.norm(np.array(found) - last) < rise * (1 - 1e-3):
        assert np.linalg.norm(longer - last) > rise or np.linalg.norm(longer) > min(most, length)


def run(coupler: VirtualCoupler, ways: list[float]) -> tuple[CouplerState, list[float]]:
    """The force on the tool along x for a handle at each of some places."""
    state, forces = coupler.engage(coupler.start()), []
    for k, x in enumerate(ways):
        reading = DeviceReading(k * T, k, Pose.exp([0.0, 0.0, 0.0], [x, 0.0, 0.0]), AT_REST)
        state, _, on_tool = coupler.step(state, reading, HOME, AT_REST, T)
        forces.append(float(on_tool.force[0]))
    return state, forces


def test_force_and_its_rise_are_limited_and_counted() -> None:
    coupler = VirtualCoupler(**{**GIVEN, "max_force": 3.0, "max_force_rate": 1000.0})
    # 500 N/m: 5 N wanted, then 1 N, then 2 N the other way.
    state, forces = run(coupler, [0.01] * 5 + [0.002] + [-0.004] * 4)
    assert forces == pytest.approx([1.0, 2.0, 3.0, 3.0, 3.0, 1.0, 0.0, -1.0, -2.0, -2.0])
    assert (state.counts.force_limits, state.counts.force_rises) == (5, 4)
    assert (state.counts.torque_limits, state.counts.torque_rises) == (0, 0)


def test_torque_and_its_rise_are_limited_and_counted() -> None:
    coupler = VirtualCoupler(**{**GIVEN, "max_torque": 0.5, "max_torque_rate": 200.0})
    state, found = coupler.engage(coupler.start()), []
    for k in range(5):
        reading = DeviceReading(k * T, k, Pose.exp([0.0, 0.0, 1.0]), AT_REST)
        state, on_device, _ = coupler.step(state, reading, HOME, AT_REST, T)
        found.append(on_device.torque[2])
    assert found == pytest.approx([-0.2, -0.4, -0.5, -0.5, -0.5])
    assert (state.counts.torque_limits, state.counts.torque_rises) == (5, 2)


def test_it_engages_slowly() -> None:
    coupler = VirtualCoupler(**{**GIVEN, "engage_time": 4e-3})
    _, forces = run(coupler, [0.01] * 7)
    assert forces == pytest.approx([0.0, 1.25, 2.5, 3.75, 5.0, 5.0, 5.0])


def test_until_it_is_engaged_there_is_no_force_and_disengaging_takes_it_away() -> None:
    state = COUPLER.start()
    reading = DeviceReading(0.0, 0, Pose.exp([0.0, 0.0, 0.0], [0.1, 0.0, 0.0]), AT_REST)
    state, on_device, on_tool = COUPLER.step(state, reading, HOME, AT_REST, T)
    assert not on_device.force.any()
    assert not on_tool.force.any()
    assert state.counts.ticks == 1
    state = COUPLER.engage(state)
    assert COUPLER.engage(state) is state
    state, on_device, _ = COUPLER.step(state, reading, HOME, AT_REST, T)
    assert on_device.force[0] == pytest.approx(-50.0)
    state = COUPLER.disengage(state)
    assert state.fault is Fault.NONE
    state, on_device, _ = COUPLER.step(state, reading, HOME, AT_REST, T)
    assert not on_device.force.any()
    assert state.counts == (3, 1, *(0,) * (len(state.counts) - 2))


def test_without_a_twist_the_velocity_is_the_difference_of_readings() -> None:
    coupler = VirtualCoupler(**{**GIVEN, "stiffness": 0.0, "rotational_stiffness": 0.0})
    state = coupler.engage(coupler.start())
    for k, x in enumerate([0.0, 0.001, 0.003]):
        reading = DeviceReading(k * T, k, Pose.exp([0.0, 0.0, 10.0 * x], [x, 0.0, 0.0]))
        state, _, on_tool = coupler.step(state, reading, HOME, AT_REST, T)
    assert on_tool.force[0] == pytest.approx(2.0 * 2.0)
    assert on_tool.torque[2] == pytest.approx(0.01 * 20.0)


@pytest.mark.parametrize(
    ("bad", "argument"),
    [
        *(({name: -1.0}, name) for name in GIVEN),
        *(({name: math.nan}, name) for name in GIVEN),
        *(({name: 0.0}, name) for name in ("max_force", "max_torque", "max_age")),
        ({"max_force_rate": 0.0}, "max_force_rate"),
        ({"max_torque_rate": -math.inf}, "max_torque_rate"),
        ({"max_force": math.inf}, "max_force"),
        ({"stiffness": "stiff"}, "stiffness"),
        ({"sampling": 1e-3}, "sampling"),
        ({"controller": True}, "controller"),
    ],
)
def test_a_coupler_that_cannot_be_is_refused(bad: dict[str, Any], argument: str) -> None:
    with pytest.raises(StandoffError, match=argument) as caught:
        VirtualCoupler(**{**GIVEN, **bad})
    assert caught.value.argument == argument


def test_bad_arguments_of_a_tick_are_refused() -> None:
    state, reading = COUPLER.engage(COUPLER.start()), DeviceReading(0.0, 0, HOME)
    for bad, argument in (
        ({"dt": 0.0}, "dt"),
        ({"dt": math.inf}, "dt"),
        ({"now": math.nan}, "now"),
        ({"state": None}, "state"),
    ):
        call: dict[str, Any] = {"state": state, "dt": T, "now": None} | bad
        with pytest.raises(StandoffError, match=argument) as caught:
            COUPLER.step(call["state"], reading, HOME, AT_REST, call["dt"], now=call["now"])
        assert caught.value.argument == argument
    for method in (COUPLER.engage, COUPLER.disengage):
        with pytest.raises(StandoffError, match="state"):
            method(None)  # type: ignore[arg-type]
    with pytest.raises(StandoffError, match="max_damping"):
        PassivityController(max_damping=-1.0)
    with pytest.raises(StandoffError, match="force"):
        Wrench([math.nan, 0.0, 0.0])
