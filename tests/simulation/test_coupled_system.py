"""A device's handle coupled to a tool within the operator: its law, its faults, its energies."""

from __future__ import annotations

import math
import pickle
from typing import Any

import numpy as np
import pytest
from scenes_with_coupler import (
    CONTACT,
    LENS,
    MASS,
    OVER,
    PERIOD,
    REACH,
    SPRINGLESS,
    TOOL,
    VALUES,
    coupled,
    dragged,
)

import standoff as so
from shares import share
from standoff import simulation as sim
from standoff.kernels.dynamics import coupler_arrays as K
from standoff.motion import Fixed

READINGS = 2000
HOME = OVER.pose(0.0)


def readings(count: int, period: float = PERIOD) -> list[sim.DeviceReading | None]:
    """A handle that moves off at 20 mm/s."""
    moving = so.Twist([0.02, 0.0, 0.0], [0.0, 0.0, 0.1])
    return [
        sim.DeviceReading(k * period, k, _off(k * period), moving, valid=True) for k in range(count)
    ]


def _off(t: float) -> so.Pose:
    return so.Pose.exp([0.0, 0.0, 0.1 * t], HOME.translation + np.array([0.02 * t, 0.0, 0.0]))


def record(run: sim.SystemRun) -> sim.CouplerRun:
    found = run.coupler
    assert found is not None
    return found


@pytest.mark.parametrize("tracker", ["beside", "inside"])
def test_the_operators_coupler_is_the_virtual_coupler_to_the_last_bit(tracker: str) -> None:
    given, count = readings(300), 300
    given[100] = given[99]  # it comes again
    given[200] = given[200]._replace(twist=None)  # type: ignore[union-attr]
    scene = coupled(tracker=tracker)
    run = scene.operator.run(scene.state, count, device=sim.DeviceReadings(given))
    coupler = scene.operator.system.coupler
    assert coupler is not None
    state = coupler.engage(coupler.start())
    for k in range(count):
        after = run.state(k + 1).coupler
        assert after is not None
        assert after.tool is not None
        R, p, v, omega = after.tool
        assert np.abs(run.positions(1)[k] - p).max() < 1e-15
        assert np.abs(run.velocities(1)[k] - v).max() < 1e-15
        pose, twist = so.Pose.from_checked(np.reshape(R, (3, 3)), np.array(p)), so.Twist(v, omega)
        state, on_device, on_tool = coupler.step(state, given[k], pose, twist, PERIOD)
        assert after == state
        assert (on_device.force == record(run).on_device[k + 1, :3]).all()
        assert (on_tool.torque == record(run).on_tool[k + 1, 3:]).all()
    assert state.counts.repeated == 1
    assert state.energy.device > 1e-7


@pytest.mark.parametrize("ticks", [1, 4])
def test_a_run_by_recorded_readings_is_the_run_with_the_device(ticks: int) -> None:
    scene = coupled(ticks=ticks)
    heard: list[Any] = []
    read = scene.device.read

    def listening() -> Any:
        heard.append(read())
        return heard[-1]

    scene.device.read = listening  # type: ignore[method-assign]
    wanted = dragged(scene, 400)
    assert len(heard) == 400
    found = scene.operator.run(scene.state, 400 * ticks, ticks, device=sim.DeviceReadings(heard))
    # the times of a run in blocks are counted anew in each
    assert np.array_equal(found.states[:, 1:], wanted.states[:, 1:], equal_nan=True)
    assert np.allclose(found.times, wanted.times, rtol=0.0, atol=1e-12)
    assert np.array_equal(found.accounts, wanted.accounts)


def test_a_step_takes_one_reading() -> None:
    scene, given = coupled(ticks=4), readings(20)
    state = scene.state
    for reading in given:
        state = scene.operator.step(state, reading)
    run = scene.operator.run(scene.state, 80, 4, device=sim.DeviceReadings(given))
    assert state.coupler == run.final.coupler
    assert state.time == pytest.approx(0.02)
    assert state.coupler is not None
    assert state.coupler.wrench_on_device.force[0] < 0.0


def test_between_readings_the_handle_stands_and_the_tool_is_pulled() -> None:
    scene = coupled(ticks=4)
    run = scene.operator.run(scene.state, 400, 4, device=sim.DeviceReadings(readings(100)))
    one = coupled(ticks=1)
    whole = one.operator.run(one.state, 100, device=sim.DeviceReadings(readings(100)))
    # the same motion, but for what finer ticks change
    assert np.abs(run.positions(1) - whole.positions(1)).max() < 2e-5
    assert record(run).counts.ticks == 400
    assert record(run).counts.repeated == 0
    # each reading's wrench is held on the handle until the next one
    found = record(run)
    way, turn = np.diff(found.handle_positions[1:], axis=0), 0.1 * PERIOD
    work = -(found.on_device[1:-1, :3] * way).sum() - (found.on_device[1:-1, 5] * turn).sum()
    assert found.energy.device[-1] == pytest.approx(work, rel=1e-9)


def test_the_device_holds_what_the_coupler_asks_for() -> None:
    scene = coupled()
    with scene.device:
        run = scene.operator.run(scene.state, 900, device=scene.device)
        held = scene.device.held
        assert np.linalg.norm(held.force) > 0.5
        assert (held.force == record(run).on_device[-1, :3]).all()
        assert (held.torque == record(run).on_device[-1, 3:]).all()


def test_force_and_torque_move_the_tool_in_the_tick() -> None:
    scene, shift, angle = coupled(), 1e-3, 0.1
    there = so.Pose.exp([0.0, 0.0, angle], HOME.translation + np.array([shift, 0.0, 0.0]))
    state = scene.operator.step(scene.state, sim.DeviceReading(0.0, 0, there, so.Twist.zero()))
    inertia = 0.4 * MASS * REACH**2
    speed = PERIOD * VALUES["stiffness"] * shift / MASS
    spin = PERIOD * VALUES["rotational_stiffness"] * angle / inertia
    assert state.twist(1).v == pytest.approx([speed, 0.0, 0.0], rel=1e-9, abs=1e-12)
    assert state.twist(1).omega == pytest.approx([0.0, 0.0, spin], rel=1e-9, abs=1e-9)


def test_a_hand_drags_the_tool_over_face_vertex_and_edge() -> None:
    run = dragged(coupled(), READINGS)
    features = run.answers(0).mode[:, 0].astype(int)
    touching = run.spots[:, 0] > 0
    firsts = np.cumsum([LENS.n_faces, LENS.n_edges])  # faces, then edges, then vertices
    assert set(np.searchsorted(firsts, features[touching], side="right")) == {0, 1, 2}
    assert run.uncertified == 0
    found = record(run)
    assert found.engaged[1:].all()
    assert 1.0 < np.linalg.norm(found.on_tool[:, :3], axis=1).max() < VALUES["max_force"]


def force_steps(run: sim.SystemRun) -> tuple[Any, Any]:
    """(steps of the contact's force, the most that stiffness and motion explain), a tick each.

    Without damping and friction the force is k d^1.5 along the normal of a ball about the lens:
    along it it changes by no more than its slope, across it by no more than F over the ball's
    radius, that of the tool less the depth.
    """
    forces, moved = run.forces[:, 0], np.diff(run.positions(1), axis=0)
    steps = np.linalg.norm(np.diff(forces, axis=0), axis=1)
    depth = np.maximum(0.0, -run.distances[:, 0])
    deeper = np.maximum(depth[1:], depth[:-1])
    slope = 1.5 * SPRINGLESS.stiffness * np.sqrt(deeper)
    across = SPRINGLESS.stiffness * deeper**1.5 / (REACH - deeper)
    return steps, np.hypot(slope, across) * np.linalg.norm(moved, axis=1)


def test_no_step_of_force_is_larger_than_stiffness_and_motion_explain() -> None:
    run = dragged(coupled(contact=SPRINGLESS), READINGS)
    steps, explained = force_steps(run)
    features = run.answers(0).mode[:, 0]
    switched = np.flatnonzero(np.diff(features) != 0.0)
    touching = (run.spots[:-1, 0] > 0) & (run.spots[1:, 0] > 0)
    assert touching[switched].sum() >= 2
    # the chord of a curve is shorter than the curve: a part in a thousand at these steps
    assert (steps <= explained * 1.001 + 1e-12).all()
    found = record(run)
    pulls = np.linalg.norm(np.diff(found.on_tool[1:, :3], axis=0), axis=1)
    apart = found.handle_positions[1:] - run.positions(1)[:-1]
    speed = np.diff(run.velocities(1), axis=0)[:-1]
    of_spring = VALUES["stiffness"] * np.linalg.norm(np.diff(apart, axis=0), axis=1)
    # the handle's velocity is the difference of its places
    jerk = np.diff(found.handle_positions[1:], n=2, axis=0, prepend=np.nan) / PERIOD
    of_damper = VALUES["damping"] * np.linalg.norm(jerk[1:] - speed[1:], axis=1)
    assert (pulls[2:] <= of_spring[2:] + of_damper[1:] + 1e-9).all()


def total(run: sim.SystemRun) -> Any:
    """Energy of tool, contact and coupler, less what came in by the hand and covers the holding."""
    found = record(run)
    given = found.energy.device + found.energy.friction
    return run.energy.mechanical + found.stored - given


@pytest.mark.parametrize(
    ("ticks", "contact", "tracker"), share(2, [1, 5], [CONTACT, SPRINGLESS], ["beside", "inside"])
)
def test_energy_never_grows_in_contact_with_a_passive_coupler(
    ticks: int, contact: sim.HuntCrossley, tracker: str
) -> None:
    run = dragged(coupled(tracker=tracker, contact=contact, ticks=ticks), READINGS)
    assert run.spots[:, 0].any()
    kept = total(run)
    scale = np.abs(record(run).energy.device).max()
    assert scale > 1e-3
    assert (kept - kept[0]).max() < 1e-4 * scale
    assert record(run).energy.least.min() >= -1e-12
    assert record(run).damped[-1] > 0.0
    # what the coupler gave the tool is in the system's own account
    drift = np.abs(run.energy.balance - run.energy.balance[0]).max()
    assert drift < 1e-2 * scale


class Active(sim.VirtualCoupler):
    """A coupler whose damper pushes: it makes energy from every motion."""

    @property
    def packed(self) -> Any:
        row = super().packed.copy()
        row[K.Q_DAMPING] = -4.0
        row.flags.writeable = False
        return row


def test_the_observer_catches_an_active_coupler_and_the_controller_damps_it() -> None:
    run = dragged(coupled(coupler=Active), 1000)
    found = record(run)
    assert found.energy.least[-1] < -1e-4
    assert (total(run) - total(run)[0]).max() > 1e-4

    def damped(**values: Any) -> Active:
        both = sim.PassivityController(max_damping=1.5, max_tool_damping=5.0)
        return Active(controller=both, **values)

    held = record(dragged(coupled(coupler=damped), 1000))
    assert held.counts.controlled > 10
    assert held.energy.least[-1] > 0.1 * found.energy.least[-1]


@pytest.mark.parametrize(
    ("bad", "fault"),
    [
        (None, sim.Fault.MISSING),
        ("nan", sim.Fault.NON_FINITE),
        ("shape", sim.Fault.MALFORMED),
        ("late", sim.Fault.LATE),
        ("order", sim.Fault.OUT_OF_ORDER),
        ("invalid", sim.Fault.INVALID),
    ],
)
@pytest.mark.parametrize("ticks", [1, 3])
def test_bad_data_takes_the_force_away_in_its_tick_until_engaged_again(
    bad: Any, fault: sim.Fault, ticks: int
) -> None:
    given, at = readings(120), 50
    good: Any = given[at]
    spoilt = {
        "nan": good._replace(pose=(np.eye(3), [math.nan, 0.0, 0.0])),
        "shape": good._replace(pose=(np.eye(3), [0.0, 0.0])),
        "late": good._replace(time=good.time + 0.01),
        "order": good._replace(sequence=at - 3),
        "invalid": good._replace(valid=False),
    }
    given[at] = None if bad is None else spoilt[bad]
    scene = coupled(ticks=ticks)
    # records at each reading: row k + 1 has the wrench of reading k
    run = scene.operator.run(scene.state, 80 * ticks, ticks, device=sim.DeviceReadings(given))
    found = record(run)
    assert found.on_tool[at].any()
    assert not found.on_tool[at + 1 :].any()
    assert not found.on_device[at + 1 :].any()
    assert (found.fault[at + 1 :] == fault).all()
    assert np.isnan(found.handle_positions[at + 1 :]).all()
    assert found.counts.faults == 1
    again = scene.operator.run(
        run.final.engage(), 20 * ticks, ticks, device=sim.DeviceReadings(given[80:100])
    )
    assert record(again).engaged.all()
    assert record(again).on_tool[-1].any()


def test_an_engaged_coupler_without_a_device_lets_go() -> None:
    scene = coupled()
    found = record(scene.operator.run(scene.state, 5))
    assert found.fault.tolist() == [0] + [sim.Fault.MISSING] * 5
    state = scene.operator.step(scene.state)
    assert state.coupler is not None
    assert state.coupler.fault is sim.Fault.MISSING
    rest = scene.operator.run(scene.state.disengage(), 5, device=sim.DeviceReadings(readings(5)))
    assert not record(rest).on_tool.any()
    assert record(rest).counts.faults == 0


def test_a_device_that_goes_away_leaves_the_tool_alone() -> None:
    scene = coupled()
    with scene.device:
        first = scene.operator.run(scene.state, 300, device=scene.device)
    second = scene.operator.run(first.final, 10, device=scene.device)
    assert record(second).fault[1] == sim.Fault.MISSING
    assert not record(second).on_tool[1:].any()


def test_a_stored_state_goes_on_the_same() -> None:
    scene, given = coupled(), sim.DeviceReadings(readings(40))
    half = scene.operator.run(scene.state, 20, device=given).final
    wanted = scene.operator.run(half, 20, device=sim.DeviceReadings(readings(40)[20:]))
    operator, state = pickle.loads(pickle.dumps((scene.operator, half)))
    found = operator.run(state, 20, device=sim.DeviceReadings(readings(40)[20:]))
    assert np.array_equal(found.states, wanted.states, equal_nan=True)


def free(mass: float = MASS) -> sim.RigidBody:
    return sim.RigidBody.free(TOOL, mass=mass, pose=HOME)


def joined(**over: Any) -> sim.VirtualCoupler:
    return sim.VirtualCoupler(**{**VALUES, **over})


@pytest.mark.parametrize("method", ["semi-implicit", "rk4", "euler"])
def test_a_coupler_too_stiff_for_its_tool_names_the_largest_stable_stiffness(method: str) -> None:
    def operator(stiffness: float) -> sim.Operator:
        coupler = joined(stiffness=stiffness, damping=2.0, rotational_stiffness=0.0)
        system = sim.System([free()], CONTACT, coupler=coupler, tool=0)
        return sim.Operator(system, PERIOD, method)

    with pytest.raises(so.StandoffError, match="the largest stable one is") as refused:
        operator(1e8)
    assert refused.value.argument == "stiffness"
    largest = float(str(refused.value).split("stable one is ")[1].split(". ")[0])
    start = operator(0.999 * largest)
    with pytest.raises(so.StandoffError, match="stable"):
        operator(1.002 * largest)
    # held fast at a place off the tool, it swings and comes to no more than that
    there = so.Pose(np.eye(3), HOME.translation + np.array([0.001, 0.0, 0.0]))
    still = sim.DeviceReadings.along(Fixed(there), 400, PERIOD)
    state = start.start().engage()
    system = sim.System([free()], CONTACT, gravity=[0, 0, 0], coupler=start.system.coupler, tool=0)
    swinging = sim.Operator(system, PERIOD, method)
    run = swinging.run(swinging.start().engage(), 400, device=still)
    assert np.abs(run.positions(0)[:, 0] - HOME.translation[0]).max() < 4e-3
    assert state.coupler is not None


def test_turning_is_checked_too() -> None:
    coupler = joined(rotational_stiffness=100.0)
    with pytest.raises(so.StandoffError, match="rotational_stiffness = 100"):
        sim.Operator(sim.System([free()], CONTACT, coupler=coupler, tool=0), PERIOD)


@pytest.mark.parametrize(
    ("given", "argument"),
    [
        ({"coupler": joined()}, "tool"),
        ({"tool": 1}, "tool"),
        ({"coupler": joined(), "tool": 0}, "tool"),
        ({"coupler": joined(), "tool": 2}, "tool"),
        ({"coupler": joined(), "tool": True}, "tool"),
        ({"coupler": joined(), "tool": "ball"}, "tool"),
        ({"coupler": 3, "tool": 1}, "coupler"),
    ],
)
def test_a_coupler_goes_with_a_free_body(given: dict[str, Any], argument: str) -> None:
    with pytest.raises(so.StandoffError, match=argument) as refused:
        sim.System([sim.RigidBody.fixed(LENS), free()], CONTACT, **given)
    assert refused.value.argument == argument


def test_what_does_not_go_together_is_refused() -> None:
    scene = coupled(ticks=4)
    with pytest.raises(so.StandoffError, match="whole number of times"):
        sim.Operator(scene.operator.system, 0.3e-3)
    run = scene.operator.run
    with pytest.raises(so.StandoffError, match="3 is not a multiple of 4"):
        run(scene.state, 6, 3)
    with pytest.raises(so.StandoffError, match="2 readings, and the run takes 3"):
        run(scene.state, 12, 4, device=sim.DeviceReadings(readings(2)))
    with pytest.raises(so.StandoffError, match="device"):
        run(scene.state, 4, 4, device=7)  # type: ignore[arg-type]
    alone = sim.Operator(sim.System([free()], CONTACT), 1e-3)
    with pytest.raises(so.StandoffError, match="has none"):
        alone.run(alone.start(), 1, device=sim.DeviceReadings(readings(1)))
    for call in (alone.start().engage, alone.start().disengage):
        with pytest.raises(so.StandoffError, match="no coupler"):
            call()
    assert alone.start().coupler is None
    assert alone.run(alone.start(), 1).coupler is None
    for bad in (3, "abc"):
        with pytest.raises(so.StandoffError, match="readings"):
            sim.DeviceReadings(bad)  # type: ignore[arg-type]
    with pytest.raises(so.StandoffError, match="empty"):
        sim.DeviceReadings([])
