"""The simulated device: its mechanics, its encoders, its delay, and the loop with a coupler."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import scipy

from standoff import Pose, StandoffError, Twist
from standoff.motion import ConstantTwist, Fixed, PoseFunction
from standoff.simulation import (
    Device,
    DeviceLimits,
    Encoder,
    HumanArm,
    Mechanism,
    PassivityController,
    Sampling,
    ScriptedHand,
    SimulatedDevice,
    VirtualCoupler,
    Wrench,
    largest_stiffness,
)

T = 1e-3
HOME, AT_REST = Pose.identity(), Twist.zero()
MECHANISM = Mechanism(mass=0.1, damping=1.0, rotational_inertia=1e-4, rotational_damping=1e-3)
ARMS = {
    "none": HumanArm.none(),
    "fingertip": HumanArm.fingertip(),
    "relaxed": HumanArm.relaxed(),
    "tensed": HumanArm.tensed(),
}


def test_it_is_a_device() -> None:
    assert isinstance(SimulatedDevice(MECHANISM, period=T), Device)


def test_a_free_handle_coasts_to_a_stop_as_the_closed_form_says() -> None:
    device = SimulatedDevice(MECHANISM, period=T)
    force, torque = np.array([2.0, 0.0, -1.0]), np.array([0.0, 1e-3, 0.0])
    with device:
        device.read()
        for k in range(1, 101):
            device.write(Wrench(force, torque))
            device.read()
            t, rate = k * T, 10.0
            way = force / 1.0 * (t - (1.0 - math.exp(-rate * t)) / rate)
            np.testing.assert_allclose(device.pose.translation, way, rtol=1e-12, atol=1e-18)
            turn = torque / 1e-3 * (t - (1.0 - math.exp(-rate * t)) / rate)
            expected = scipy.spatial.transform.Rotation.from_rotvec(turn).as_matrix()
            np.testing.assert_allclose(device.pose.rotation, expected, atol=1e-14)


@pytest.mark.parametrize("name", ["fingertip", "relaxed", "tensed"])
def test_an_arm_swings_into_its_place_as_the_closed_form_says(name: str) -> None:
    arm = ARMS[name]
    meant = Pose.exp([0.0, 0.0, 0.4], [0.01, -0.02, 0.03])
    device = SimulatedDevice(
        MECHANISM, ScriptedHand(path=Fixed(meant), arm=arm), period=T, pose=HOME
    )
    with device:
        for _ in range(51):
            device.read()

    def part(mass: float, damping: float, stiffness: float) -> float:
        rates = np.array([[0.0, 1.0], [-stiffness / mass, -damping / mass]])
        return 1.0 - float(scipy.linalg.expm(rates * 50 * T)[0, 0])

    linear = part(0.1 + arm.mass, 1.0 + arm.damping, arm.stiffness)
    turning = part(
        1e-4 + arm.rotational_inertia, 1e-3 + arm.rotational_damping, arm.rotational_stiffness
    )
    np.testing.assert_allclose(device.pose.translation, linear * meant.translation, rtol=1e-10)
    turned = scipy.spatial.transform.Rotation.from_matrix(device.pose.rotation).as_rotvec()
    np.testing.assert_allclose(turned, [0.0, 0.0, 0.4 * turning], rtol=1e-9, atol=1e-12)


def test_a_hand_follows_its_path() -> None:
    path = ConstantTwist(HOME, ([0.1, 0.0, 0.0], [0.0, 0.0, 0.5]))
    device = SimulatedDevice(
        Mechanism(mass=0.1, damping=0.0, rotational_damping=0.0),
        ScriptedHand(path=path, arm=HumanArm.tensed()),
        period=T,
    )
    with device:
        for _ in range(1501):
            reading = device.read()
    assert reading is not None
    there = path.pose(1.5)
    np.testing.assert_allclose(device.pose.translation, there.translation, atol=1e-6)
    np.testing.assert_allclose(device.pose.rotation, there.rotation, atol=1e-6)
    np.testing.assert_allclose(reading.twist.v, [0.1, 0.0, 0.0], atol=1e-4)  # type: ignore[union-attr]
    # A function of the time serves as well.
    ScriptedHand(path=lambda t: Pose.exp([0.0, 0.0, t]))
    assert isinstance(ScriptedHand(path=lambda t: Pose.exp([0.0, 0.0, t])).path, PoseFunction)


def test_encoders_count() -> None:
    path = ConstantTwist(HOME, ([0.0137, 0.0, -0.02], [0.05, 0.0, 0.11]))
    exact, counted = (
        SimulatedDevice(MECHANISM, ScriptedHand(path=path), period=T, encoder=encoder)
        for encoder in (Encoder(), Encoder(position_step=3e-5, angle_step=1e-3))
    )
    with exact, counted:
        for _ in range(200):
            true, seen = exact.read(), counted.read()
            assert true is not None
            assert seen is not None
            off = seen.pose.translation - true.pose.translation  # type: ignore[union-attr]
            assert np.abs(off).max() <= 1.5e-5 + 1e-15
            counts = seen.pose.translation / 3e-5  # type: ignore[union-attr]
            np.testing.assert_allclose(counts, np.round(counts), atol=1e-9)
            turns = scipy.spatial.transform.Rotation.from_matrix(seen.pose.rotation).as_rotvec()  # type: ignore[union-attr]
            np.testing.assert_allclose(turns / 1e-3, np.round(turns / 1e-3), atol=1e-9)
            speeds = seen.twist.v / (3e-5 / T)  # type: ignore[union-attr]
            np.testing.assert_allclose(speeds, np.round(speeds), atol=1e-9)
    assert np.abs(counts).max() > 5.0
    assert np.abs(turns).max() > 5e-3


def test_velocities_are_filtered_differences() -> None:
    lag, past, expected = 4e-3, HOME, np.zeros(3)
    device = SimulatedDevice(MECHANISM, period=T, encoder=Encoder(velocity_time_constant=lag))
    assert device.sampling.velocity_time_constant == lag
    with device:
        for k in range(40):
            reading = device.read()
            assert reading is not None
            pose = reading.pose
            assert isinstance(pose, Pose)
            if k:
                raw = (pose.translation - past.translation) / T
                expected = (lag * expected + T * raw) / (lag + T)
                np.testing.assert_allclose(reading.twist.v, expected, rtol=1e-12)  # type: ignore[union-attr]
            past = pose
            device.write(Wrench([math.sin(k), 1.0, 0.0]))


def test_a_delay_brings_samples_late_with_their_own_time() -> None:
    device = SimulatedDevice(MECHANISM, period=T, delay=3)
    with device:
        for k in range(5):
            reading = device.read()
            assert reading is not None
            assert reading.sequence == k
            assert device.time - reading.time == pytest.approx(3 * T)


def test_wrenches_beyond_the_limits_are_cut_and_counted() -> None:
    device = SimulatedDevice(
        MECHANISM, period=T, limits=DeviceLimits(max_force=3.0, max_torque=0.0)
    )
    with device:
        device.write(Wrench([3.0, 4.0, 0.0], [0.0, 1.0, 0.0]))
        np.testing.assert_allclose(device.held.force, [1.8, 2.4, 0.0])
        assert not device.held.torque.any()
        device.write(Wrench([1.0, 0.0, 0.0]))
    assert device.cut == 1


def loop_matrix(
    motion: tuple[float, float, float], law: tuple[float, float], delay: int = 0
) -> Any:
    """Of (x, v, x before, delayed forces) from sample to sample, by the equations of motion."""
    (mass, damping, stiffness), (k, b) = motion, law
    rates = np.array([[0.0, 1.0], [-stiffness / mass, -damping / mass]])
    parts = (rates, np.array([[0.0], [1.0 / mass]]), np.eye(2), np.zeros((2, 1)))
    held, by_force, *_ = scipy.signal.cont2discrete(parts, T)
    step = np.zeros((3 + delay, 3 + delay))
    answer = np.zeros(3 + delay)
    answer[:3] = -k - b / T, 0.0, b / T
    step[:2, :2] = held
    step[:2] += by_force @ (answer if delay == 0 else np.eye(3 + delay)[-1])[None]
    step[2, 0] = 1.0
    if delay:
        step[3] = answer
        step[4:, 3:-1] = np.eye(delay - 1)
    return step


def limit(motion: tuple[float, float, float], b: float, delay: int = 0) -> float:
    """The least stiffness with an eigenvalue of modulus 1."""

    def beyond(k: float) -> float:
        return float(np.abs(np.linalg.eigvals(loop_matrix(motion, (k, b), delay))).max()) - 1.0

    low = 1e-9 * motion[0] / T**2
    while beyond(1.2 * low) < 0.0:
        low *= 1.2
    return float(scipy.optimize.brentq(beyond, low, 1.2 * low, rtol=1e-9))


@pytest.mark.parametrize("part", [0.9, 1.1])
@pytest.mark.parametrize("name", ARMS)
def test_the_closed_loop_is_the_sampled_system_and_leaves_stability_where_that_does(
    name: str, part: float
) -> None:
    """Coupler, device and arm in all six axes, tool held, against cont2discrete."""
    arm, b, turning_b = ARMS[name], 0.3, 3e-4
    linear = (0.1 + arm.mass, 1.0 + arm.damping, arm.stiffness)
    turning = (
        1e-4 + arm.rotational_inertia,
        1e-3 + arm.rotational_damping,
        arm.rotational_stiffness,
    )
    k, turning_k = part * limit(linear, b), part * limit(turning, turning_b)
    if part < 1.0:
        assert k > largest_stiffness(b, 1.0, Sampling(period=T, device_damping=1.0)) * 0.9
    coupler = VirtualCoupler(
        stiffness=k,
        damping=b,
        rotational_stiffness=turning_k,
        rotational_damping=turning_b,
        max_force=1e9,
        max_torque=1e9,
        engage_time=0.0,
        max_age=1.0,
    )
    device = SimulatedDevice(
        MECHANISM,
        ScriptedHand(path=Fixed(HOME), arm=arm),
        period=T,
        pose=Pose.exp([0.0, 0.0, 1e-7], [1e-6, 2e-6, -1e-6]),
    )
    expected = np.array([[1e-6, 1e-7], [0.0, 0.0], [1e-6, 1e-7]])
    steps = loop_matrix(linear, (k, b)), loop_matrix(turning, (turning_k, turning_b))
    state, sizes = coupler.engage(coupler.start()), []
    with device:
        for _ in range(600):
            reading = device.read()
            shown = [device.pose.translation[0], device.pose.rotation[1, 0]]
            np.testing.assert_allclose(shown, expected[0], rtol=1e-6, atol=1e-14)
            sizes.append(np.abs(shown))
            state, on_device, _ = coupler.step(state, reading, HOME, AT_REST, T, now=device.time)
            device.write(on_device)
            expected = np.stack([s @ expected[:, j] for j, s in enumerate(steps)], axis=1)
    middle, end = np.max(sizes[200:400], axis=0), np.max(sizes[400:], axis=0)
    assert ((end > middle) == (part > 1.0)).all()


def test_within_the_predicted_range_no_passive_load_makes_the_loop_unstable(
    rng: np.random.Generator,
) -> None:
    """Springs, dampers and masses drawn over decades; sufficient for every one of them."""
    for delay in (0, 1, 2):
        for b in (0.0, 0.4):
            sampling = Sampling(period=T, device_damping=1.0, delay=delay)
            k = 0.999 * largest_stiffness(b, 1.0, sampling)
            for _ in range(60):
                mass, stiffness = 0.05 * 10 ** rng.uniform(0, 2), 10 ** rng.uniform(-1, 7)
                damping = 1.0 + rng.choice([0.0, 10 ** rng.uniform(-2, 2)])
                step = loop_matrix((mass, damping, stiffness), (k, b), delay)
                assert np.abs(np.linalg.eigvals(step)).max() < 1.0


@pytest.mark.parametrize("delay", [0, 1, 2])
def test_a_spring_on_a_heavy_handle_leaves_stability_at_the_bound_itself(delay: int) -> None:
    """So the bound cannot be raised: a free mass, slow beside the sampling, needs all of it."""
    sampling = Sampling(period=T, device_damping=1.0, delay=delay)
    assert limit((10.0, 1.0, 0.0), 0.0, delay) == pytest.approx(
        largest_stiffness(0.0, 1.0, sampling), rel=2e-3
    )


class Active(VirtualCoupler):
    """A coupler whose spring is stiffer on the way out: it makes energy from every stroke."""

    def step(self, state: Any, reading: Any, *given: Any, **named: Any) -> Any:
        out = state.handle is not None and reading is not None
        x = reading.pose.translation[0] if out else 0.0
        before = state.handle.p[0] if out else 0.0
        object.__setattr__(self, "stiffness", 600.0 if x * (x - before) < 0.0 else 200.0)
        return super().step(state, reading, *given, **named)


def stroked(coupler: VirtualCoupler, ticks: int = 1200) -> tuple[Any, float, float]:
    """A relaxed hand that strokes a held tool: the state, and the work at the handle by hand."""
    path = PoseFunction(
        lambda t: Pose.exp([0.0, 0.0, 0.0], [0.01 * math.sin(12.0 * t), 0.0, 0.0]),
        lambda t: Twist([0.12 * math.cos(12.0 * t), 0.0, 0.0], [0.0, 0.0, 0.0]),
    )
    device = SimulatedDevice(MECHANISM, ScriptedHand(path=path), period=T)
    state, given, least = coupler.engage(coupler.start()), 0.0, 0.0
    with device:
        for _ in range(ticks):
            before, held = device.pose.translation, device.held.force
            reading = device.read()
            given -= float(held @ (device.pose.translation - before))
            least = min(least, given)
            state, on_device, _ = coupler.step(state, reading, HOME, AT_REST, T, now=device.time)
            device.write(on_device)
    assert state.fault == 0
    return state, given, least


STROKE: dict[str, Any] = {
    "stiffness": 400.0,
    "damping": 0.2,
    "max_force": 50.0,
    "engage_time": 0.0,
    "max_age": 0.01,
}
ONE_TICK = 600.0 * 0.01 * 0.12 * T
"""Energy [J] that the active spring gives in a tick at most: 600 N/m, 0.01 m, 0.12 m/s."""


def test_the_observer_sees_the_work_and_a_passive_coupler_keeps_it_above_zero() -> None:
    sampling = Sampling(period=T, device_damping=1.0)
    state, given, _ = stroked(VirtualCoupler(sampling=sampling, **STROKE))
    assert state.energy.device == pytest.approx(given, abs=1e-12)
    assert state.energy.friction > 0.0
    assert state.energy.tool == 0.0
    assert state.energy.least >= -1e-12  # rounding of sums of some joules


def test_the_observer_catches_an_active_coupler_and_the_controller_makes_it_passive() -> None:
    state, _, least = stroked(Active(**STROKE))
    assert state.energy.least < -30 * ONE_TICK
    assert least == pytest.approx(state.energy.least, rel=1e-3)
    controller = PassivityController(max_damping=60.0)
    state, _, least = stroked(Active(controller=controller, **STROKE))
    assert state.energy.least > -2.0 * ONE_TICK
    assert least > -2.0 * ONE_TICK
    assert state.counts.controlled > 20
    weak = PassivityController(max_damping=0.01)
    state, _, _ = stroked(Active(controller=weak, **STROKE))
    assert state.energy.least < -20 * ONE_TICK
    assert state.counts.control_limits > 20


def test_a_moving_tool_is_damped_where_the_handle_cannot() -> None:
    """The handle is at rest, the tool is driven: only damping at the tool takes energy."""

    def driven(controller: PassivityController | None) -> Any:
        coupler = Active(**{**STROKE, "damping": 0.0}, controller=controller)
        device = SimulatedDevice(MECHANISM, period=T)
        state = coupler.engage(coupler.start())
        at_tool = np.zeros(3)
        with device:
            for k in range(400):
                tool = Pose.exp([0, 0, 0], [0.01 * math.sin(0.03 * k), 0.0, 0.0])
                velocity = Twist([0.01 * 30.0 * math.cos(0.03 * k), 0.0, 0.0], np.zeros(3))
                # More stiffness while the tool comes back.
                back = tool.translation[0] * velocity.v[0] < 0.0
                object.__setattr__(coupler, "stiffness", 600.0 if back else 200.0)
                state, _, on_tool = VirtualCoupler.step(
                    coupler, state, device.read(), tool, velocity, T, now=device.time
                )
                at_tool = np.maximum(at_tool, np.abs(on_tool.force))
        return state

    active = driven(None)
    assert active.energy.device == 0.0
    assert active.energy.least < -1e-2
    controller = PassivityController(max_damping=60.0, max_tool_damping=60.0)
    assert driven(controller).energy.least > -2.0 * 600.0 * 0.01 * 0.3 * T


@pytest.mark.parametrize(
    ("make", "argument"),
    [
        (lambda: Mechanism(mass=0.0, damping=1.0), "mass"),
        (lambda: Mechanism(mass=1.0, damping=-1.0), "damping"),
        (lambda: Mechanism(mass=1.0, damping=1.0, rotational_inertia=0.0), "rotational_inertia"),
        (lambda: HumanArm(mass=-1.0, damping=0.0, stiffness=0.0), "mass"),
        (lambda: HumanArm(mass=1.0, damping=math.nan, stiffness=0.0), "damping"),
        (lambda: Encoder(position_step=-1.0), "position_step"),
        (lambda: Encoder(velocities=1), "velocities"),
        (lambda: DeviceLimits(max_force=-1.0), "max_force"),
        (lambda: DeviceLimits(max_force=1.0, workspace=math.nan), "workspace"),
        (lambda: SimulatedDevice(None, period=T), "mechanism"),
        (lambda: SimulatedDevice(MECHANISM, "hand", period=T), "hand"),
        (lambda: SimulatedDevice(MECHANISM, period=0.0), "period"),
        (lambda: SimulatedDevice(MECHANISM, period=T, delay=-1), "delay"),
        (lambda: SimulatedDevice(MECHANISM, period=T, encoder=3), "encoder"),
        (lambda: SimulatedDevice(MECHANISM, period=T, limits=3), "limits"),
        (lambda: SimulatedDevice(MECHANISM, period=T, disturbances=3), "disturbances"),
        (lambda: ScriptedHand(path=3), "path"),
        (lambda: ScriptedHand(path=Fixed(HOME), arm=3), "arm"),
    ],
)
def test_a_device_that_cannot_be_is_refused(make: Any, argument: str) -> None:
    with pytest.raises(StandoffError, match=argument):
        make()


def test_a_wrench_that_is_none_is_refused() -> None:
    with (
        SimulatedDevice(MECHANISM, period=T) as device,
        pytest.raises(StandoffError, match="wrench"),
    ):
        device.write([1.0, 0.0, 0.0])  # type: ignore[arg-type]
