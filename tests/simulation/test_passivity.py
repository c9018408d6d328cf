"""The discrete condition of passivity, against Colgate and Schenkel's own expression and a sum."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from standoff import Pose, StandoffError, Twist
from standoff.errors import PassivityError
from standoff.simulation import (
    DeviceReading,
    Sampling,
    VirtualCoupler,
    largest_stiffness,
    required_damping,
    required_damping_of,
)

T = 1e-3
HOME, AT_REST = Pose.identity(), Twist.zero()


def law(z: Any, k: float, b: float, delay: int, lag: float) -> Any:
    """H(z) of a spring and damper, as it stands in the paper, with filter and delay."""
    past = lag / (lag + T)
    return z**-delay * (k + b * (1 - past) / (1 - past / z) * (1 - 1 / z) / T)


@given(k=st.floats(0.0, 1e4), b=st.floats(-2.0, 2.0))
def test_without_delay_and_filter_it_is_the_bound_of_the_virtual_wall(k: float, b: float) -> None:
    found = required_damping(k, b, Sampling(period=T, device_damping=1.0))
    assert found == pytest.approx(k * T / 2 + abs(b), rel=1e-12, abs=1e-12)


@given(delay=st.integers(0, 20))
def test_a_delayed_spring_alone_needs_two_n_and_one_times_as_much(delay: int) -> None:
    sampling = Sampling(period=T, device_damping=1.0, delay=delay)
    assert required_damping(1e3, 0.0, sampling) == pytest.approx((2 * delay + 1) * 1e3 * T / 2)


@settings(max_examples=30)
@given(
    k=st.floats(0.0, 1e4),
    b=st.floats(-1.0, 1.0),
    delay=st.integers(0, 4),
    lag=st.sampled_from([0.0, 5e-4, 5e-3]),
)
def test_it_is_the_greatest_of_the_papers_right_side(
    k: float, b: float, delay: int, lag: float
) -> None:
    sampling = Sampling(period=T, device_damping=1.0, delay=delay, velocity_time_constant=lag)
    angles = np.linspace(1e-4, math.pi, 20001)
    z = np.exp(1j * angles)
    side = T / 2 / (1 - np.cos(angles)) * np.real((1 - 1 / z) * law(z, k, b, delay, lag))
    assert required_damping(k, b, sampling) == pytest.approx(side.max(), rel=3e-6, abs=3e-6)
    own = required_damping_of(lambda z: law(z, k, b, delay, lag), T)
    assert own == pytest.approx(side.max(), rel=3e-6, abs=3e-6)


@settings(max_examples=20)
@given(b=st.floats(0.0, 0.9), delay=st.integers(0, 4), lag=st.sampled_from([0.0, 1e-3]))
def test_the_largest_stiffness_needs_just_the_damping_there_is(
    b: float, delay: int, lag: float
) -> None:
    sampling = Sampling(period=T, device_damping=1.0, delay=delay, velocity_time_constant=lag)
    largest = largest_stiffness(b, 1.0, sampling)
    assert required_damping(largest, b, sampling) == pytest.approx(1.0, rel=1e-9)
    assert required_damping(1.001 * largest, b, sampling) > 1.0


def test_no_stiffness_is_passive_beside_too_much_damping() -> None:
    assert largest_stiffness(1.2, 1.0, Sampling(period=T, device_damping=1.0)) == -math.inf


def energy_a_tick(coupler: VirtualCoupler, angle: float, ticks: int) -> float:
    """What a hand that moves straight from sample to sample of a sine loses to the coupler.

    The observer's own account, of as many ticks as close a number of periods.
    """
    state = coupler.engage(coupler.start())
    for k in range(ticks + 1):
        pose = Pose.exp([0.0, 0.0, 0.0], [1e-3 * math.sin(angle * k + 0.3), 0.0, 0.0])
        state, _, _ = coupler.step(state, DeviceReading(k * T, k, pose), HOME, AT_REST, T)
        if k == ticks // 2:
            before = state.energy.observed
    return (state.energy.observed - before) / (ticks - ticks // 2)


@pytest.mark.parametrize("delay", [0, 1])
@pytest.mark.parametrize("part", [0.97, 1.03])
def test_energy_comes_out_of_the_handle_just_where_the_condition_says(
    delay: int, part: float
) -> None:
    """Necessary and sufficient: beyond the largest stiffness some motion gains, below none does."""
    free = Sampling(period=T, device_damping=1.0, delay=delay)
    stiffness = part * largest_stiffness(0.4, 1.0, free)
    coupler = VirtualCoupler(
        stiffness=stiffness, damping=0.4, max_force=1e3, max_age=1.0, engage_time=0.0
    )
    # The sampling is put in behind the check, which would refuse what is tried here.
    object.__setattr__(coupler, "sampling", free)
    gained = []
    for numerator in (1, 2, 5, 7, 10, 14, 18, 20):
        angle = math.pi * numerator / 20
        found = energy_a_tick(coupler, angle, 80)
        z = np.exp(1j * angle)
        side = T / 2 / (1 - math.cos(angle)) * ((1 - 1 / z) * law(z, stiffness, 0.4, delay, 0)).real
        # Of a sine at Nyquist's frequency every sample is at the same height.
        height = 1e-6 * (0.5 if numerator < 20 else math.sin(0.3) ** 2)
        assert found == pytest.approx(
            2 * height * (1 - math.cos(angle)) / T * (1.0 - side), rel=1e-6, abs=1e-12
        )
        gained.append(found < 0.0)
    assert any(gained) == (part > 1.0)


def test_a_violation_says_by_how_much_and_what_is_largest() -> None:
    sampling = Sampling(period=T, device_damping=1.0, device_rotational_damping=1e-3)
    given = {"damping": 0.3, "max_force": 5.0, "max_torque": 1.0, "max_age": 0.01}
    with pytest.raises(PassivityError, match=r"0\.2 too little.* is 1400 N/m") as caught:
        VirtualCoupler(stiffness=1800.0, sampling=sampling, **given)
    assert caught.value.argument == "stiffness"
    assert caught.value.required == pytest.approx(1.2)
    largest = caught.value.largest
    VirtualCoupler(stiffness=largest, sampling=sampling, **given)
    with pytest.raises(PassivityError, match="rotational_stiffness") as caught:
        VirtualCoupler(stiffness=1.0, rotational_stiffness=3.0, sampling=sampling, **given)
    assert caught.value.largest == pytest.approx(2.0)
    with pytest.raises(PassivityError, match="lower damping first"):
        VirtualCoupler(stiffness=1.0, sampling=sampling, **{**given, "damping": 2.0})


@pytest.mark.parametrize(
    ("bad", "argument"),
    [
        ({"period": 0.0}, "period"),
        ({"period": math.nan}, "period"),
        ({"device_damping": -1.0}, "device_damping"),
        ({"device_rotational_damping": "no"}, "device_rotational_damping"),
        ({"delay": 0.5}, "delay"),
        ({"delay": 21}, "delay"),
        ({"delay": -1}, "delay"),
        ({"velocity_time_constant": -1e-3}, "velocity_time_constant"),
    ],
)
def test_a_sampling_that_cannot_be_is_refused(bad: dict[str, Any], argument: str) -> None:
    with pytest.raises(StandoffError, match=argument) as caught:
        Sampling(**{"period": T, "device_damping": 1.0, **bad})
    assert caught.value.argument == argument


def test_bad_numbers_of_the_condition_are_refused() -> None:
    sampling = Sampling(period=T, device_damping=1.0)
    for call, argument in (
        (lambda: required_damping(-1.0, 0.0, sampling), "stiffness"),
        (lambda: required_damping(1.0, math.nan, sampling), "damping"),
        (lambda: largest_stiffness(math.inf, 1.0, sampling), "damping"),
        (lambda: largest_stiffness(0.0, -1.0, sampling), "device_damping"),
        (lambda: required_damping_of(lambda z: z, 0.0), "period"),
        (lambda: required_damping_of(lambda z: 1.0, T), "position_to_force"),
        (lambda: required_damping_of(lambda z: z * math.nan, T), "position_to_force"),
        (lambda: required_damping_of(lambda z: z, T, 2), "angles"),
    ):
        with pytest.raises(StandoffError, match=argument) as caught:
            call()
        assert caught.value.argument == argument
