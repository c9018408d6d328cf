"""What is wrong with a device's data takes the force away within the tick, and keeps it away."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from standoff import Pose, StandoffError, Twist
from standoff.errors import DeviceError
from standoff.motion import Fixed
from standoff.simulation import (
    CouplerState,
    DeviceReading,
    Disturbances,
    Fault,
    HumanArm,
    Mechanism,
    ScriptedHand,
    SimulatedDevice,
    VirtualCoupler,
    Wrench,
)

T = 1e-3
HOME, AT_REST = Pose.identity(), Twist.zero()
THERE = Pose.exp([0.0, 0.1, 0.0], [0.01, 0.0, 0.0])
COUPLER = VirtualCoupler(
    stiffness=500.0,
    damping=1.0,
    rotational_stiffness=1.0,
    max_force=5.0,
    max_torque=1.0,
    engage_time=0.0,
    max_age=3.5e-3,
)
NAN, INF = math.nan, math.inf


class Raises:
    """A pose that a driver made badly."""

    def as_matrix(self) -> Any:
        raise RuntimeError("driver")

    def __array__(self, *given: Any, **named: Any) -> Any:
        raise RuntimeError("driver")


def engaged(ticks: int = 3) -> CouplerState:
    """A coupler that renders 5 N after some ticks."""
    state = COUPLER.engage(COUPLER.start())
    for k in range(ticks):
        state, on_device, _ = COUPLER.step(
            state, DeviceReading(k * T, k, THERE, AT_REST), HOME, AT_REST, T, now=k * T
        )
    assert on_device.force[0] == pytest.approx(-5.0)
    return state


def good(k: int = 3) -> DeviceReading:
    return DeviceReading(k * T, k, THERE, AT_REST)


BAD: dict[str, tuple[Callable[[], Any], Fault]] = {
    "none": (lambda: None, Fault.MISSING),
    "late": (lambda: good()._replace(time=-0.6e-3), Fault.OUT_OF_ORDER),
    "ahead of the clock": (lambda: good()._replace(time=8e-3), Fault.LATE),
    "nan position": (lambda: good()._replace(pose=(np.eye(3), [NAN, 0, 0])), Fault.NON_FINITE),
    "inf position": (lambda: good()._replace(pose=(np.eye(3), [INF, 0, 0])), Fault.NON_FINITE),
    "nan matrix": (lambda: good()._replace(pose=np.full((4, 4), NAN)), Fault.NON_FINITE),
    "nan twist": (lambda: good()._replace(twist=np.full(6, NAN)), Fault.NON_FINITE),
    "inf twist": (lambda: good()._replace(twist=([0, 0, 0], [0, INF, 0])), Fault.NON_FINITE),
    "nan time": (lambda: good()._replace(time=NAN), Fault.NON_FINITE),
    "two numbers": (lambda: good()._replace(pose=(np.eye(3), [0.0, 0.0])), Fault.MALFORMED),
    "four numbers": (lambda: good()._replace(pose=[1.0, 0.0, 0.0, 0.0]), Fault.MALFORMED),
    "no rotation": (lambda: good()._replace(pose=(2 * np.eye(3), [0, 0, 0])), Fault.MALFORMED),
    "pose of none": (lambda: good()._replace(pose=None), Fault.MALFORMED),
    "text": (lambda: good()._replace(pose="here"), Fault.MALFORMED),
    "pose that raises": (lambda: good()._replace(pose=Raises()), Fault.MALFORMED),
    "twist of five": (lambda: good()._replace(twist=np.zeros(5)), Fault.MALFORMED),
    "no reading": (lambda: {"time": 3e-3, "sequence": 3}, Fault.MALFORMED),
    "sequence as text": (lambda: good()._replace(sequence="3"), Fault.MALFORMED),
    "sequence below zero": (lambda: good()._replace(sequence=-1), Fault.MALFORMED),
    "time as text": (lambda: good()._replace(time="now"), Fault.MALFORMED),
    "sequence as a duration": (
        lambda: good()._replace(sequence=np.timedelta64(3, "s")),
        Fault.MALFORMED,
    ),
    "time as array": (lambda: good()._replace(time=np.zeros(2)), Fault.MALFORMED),
    "valid as text": (lambda: good()._replace(valid="no"), Fault.MALFORMED),
    "sequence going back": (lambda: good(1)._replace(time=3e-3), Fault.OUT_OF_ORDER),
    "time going back": (lambda: good()._replace(time=1.5e-3), Fault.OUT_OF_ORDER),
    "same number, other time": (lambda: good(2)._replace(time=3e-3), Fault.OUT_OF_ORDER),
    "not valid": (lambda: good()._replace(valid=False), Fault.INVALID),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_data_takes_the_force_away_in_its_tick_until_engaged_again(name: str) -> None:
    make, fault = BAD[name]
    state, on_device, on_tool = COUPLER.step(engaged(), make(), HOME, AT_REST, T, now=3 * T)
    assert state.fault is fault
    assert not state.engaged
    for wrench in (on_device, on_tool):
        assert not wrench.force.any()
        assert not wrench.torque.any()
    # Good data changes nothing, and is no further fault.
    for k in range(4, 8):
        state, on_device, on_tool = COUPLER.step(state, good(k), HOME, AT_REST, T, now=k * T)
        assert not on_device.force.any()
        assert not on_tool.force.any()
    assert state.fault is fault
    assert state.counts.faults == 1
    assert state.fault.advice
    state = COUPLER.engage(state)
    assert state.fault is Fault.NONE
    state, on_device, _ = COUPLER.step(state, good(8), HOME, AT_REST, T, now=8 * T)
    assert on_device.force[0] == pytest.approx(-5.0)
    assert state.counts.faults == 1


@pytest.mark.parametrize("tool", [(np.eye(3), [NAN, 0, 0]), np.zeros(3), None])
def test_a_simulation_that_fails_takes_the_force_away(tool: Any) -> None:
    state, on_device, _ = COUPLER.step(engaged(), good(), tool, AT_REST, T)
    assert state.fault is Fault.TOOL
    assert not on_device.force.any()
    state, on_device, _ = COUPLER.step(engaged(), good(), HOME, np.full(6, NAN), T)
    assert state.fault is Fault.TOOL
    assert not on_device.force.any()


@pytest.mark.parametrize("with_clock", [True, False])
def test_a_reading_again_and_again_is_late_after_its_greatest_age(with_clock: bool) -> None:
    state, forces = engaged(), []
    for k in range(3, 9):
        now = k * T if with_clock else None
        state, on_device, _ = COUPLER.step(state, good(2), HOME, AT_REST, T, now=now)
        forces.append(float(-on_device.force[0]))
    # Taken at 2 ms, it is older than 3.5 ms from 6 ms on.
    assert forces == pytest.approx([5.0, 5.0, 5.0, 0.0, 0.0, 0.0])
    assert state.fault is Fault.LATE
    assert state.counts.repeated == 3


def test_lost_readings_are_counted() -> None:
    state = engaged()
    state, on_device, _ = COUPLER.step(state, good(5), HOME, AT_REST, T, now=5 * T)
    assert state.counts.skipped == 2
    assert on_device.force[0] == pytest.approx(-5.0)


@pytest.mark.parametrize(
    ("kind", "fault"),
    [
        ("missing", Fault.MISSING),
        ("late", Fault.LATE),
        ("nan", Fault.NON_FINITE),
        ("inf", Fault.NON_FINITE),
        ("shape", Fault.MALFORMED),
        ("order", Fault.OUT_OF_ORDER),
        ("invalid", Fault.INVALID),
        ("disconnect", Fault.MISSING),
    ],
)
def test_a_simulated_device_that_fails_holds_no_force(kind: Any, fault: Fault) -> None:
    at = 6
    device = SimulatedDevice(
        Mechanism(mass=0.1, damping=1.0),
        ScriptedHand(path=Fixed(THERE), arm=HumanArm.tensed()),
        period=T,
        disturbances=Disturbances(script={at: kind}),
    )
    state, on = COUPLER.engage(COUPLER.start()), []
    with device:
        for _ in range(15):
            try:
                reading = device.read()
            except DeviceError:
                reading = None
            state, on_device, _ = COUPLER.step(state, reading, HOME, AT_REST, T, now=device.time)
            if kind != "disconnect" or state.engaged:
                device.write(on_device)
            on.append(bool(device.held.force.any()))
    # The last good reading came a tick before; "late" is noticed at its greatest age.
    last = at + 3 if kind == "late" else at
    assert on == [True] * last + [False] * (15 - last)
    assert state.fault is fault


def test_a_block_that_ends_by_an_error_leaves_no_force() -> None:
    device = SimulatedDevice(Mechanism(mass=0.1, damping=1.0), period=T)

    def loop() -> None:
        with device:
            device.read()
            device.write(Wrench([1.0, 0.0, 0.0]))
            assert device.held.force[0] == 1.0
            raise RuntimeError("loop")

    with pytest.raises(RuntimeError, match="loop"):
        loop()
    assert not device.held.force.any()
    for call in (device.read, lambda: device.write(Wrench.zero())):
        with pytest.raises(DeviceError, match="not open"):
            call()


@pytest.mark.parametrize("seed", range(4))
def test_no_frame_of_a_bad_line_makes_a_force_after_the_first_fault(seed: int) -> None:
    device = SimulatedDevice(
        Mechanism(mass=0.1, damping=1.0),
        ScriptedHand(path=Fixed(THERE)),
        period=T,
        disturbances=Disturbances(drop_out=0.3, malformed=0.02, seed=seed),
    )
    state, faults = COUPLER.engage(COUPLER.start()), 0
    with device:
        for _ in range(400):
            state, on_device, on_tool = COUPLER.step(
                state, device.read(), HOME, AT_REST, T, now=device.time
            )
            device.write(on_device)
            assert state.engaged or not (on_device.force.any() or on_tool.force.any())
            assert np.isfinite(on_device.force).all()
            if not state.engaged:
                faults += 1
                state = COUPLER.engage(state)
    assert faults == state.counts.faults > 3


def test_the_same_seed_disturbs_in_the_same_way() -> None:
    def seen(seed: int) -> list[Any]:
        device = SimulatedDevice(
            Mechanism(mass=0.1, damping=1.0),
            period=T,
            disturbances=Disturbances(drop_out=0.2, seed=seed),
        )
        with device:
            readings = [device.read() for _ in range(50)]
        return [None if one is None else one.sequence for one in readings]

    assert seen(1) == seen(1) != seen(2)


@pytest.mark.parametrize(
    ("bad", "argument"),
    [
        ({"script": {3: "explode"}}, "script"),
        ({"script": {-3: "nan"}}, "script"),
        ({"drop_out": 1.5}, "drop_out"),
        ({"malformed": -0.1}, "malformed"),
        ({"seed": -1}, "seed"),
    ],
)
def test_disturbances_that_cannot_be_are_refused(bad: dict[str, Any], argument: str) -> None:
    with pytest.raises(StandoffError, match=argument) as caught:
        Disturbances(**bad)
    assert caught.value.argument == argument
