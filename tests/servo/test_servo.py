"""The servo loop: what it computes, what it tells, and that it always ends without force."""

from __future__ import annotations

import gc
import os
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numba.core import event
from numba.core.runtime import _nrt_python, rtsys
from scenes import PERIOD, coupled, knocking

import standoff as so
from standoff import simulation as sim
from standoff.devices import PointerDevice, Trace
from standoff.errors import StandoffError
from standoff.kernels.compiler import modules
from standoff.kernels.dynamics import coupler_arrays as K
from standoff.kernels.dynamics import servo_arrays as V
from standoff.kernels.entries import servo as entries
from standoff.servo import Ended, Servo
from standoff.servo.exchange import Mailbox
from standoff.servo.loop_port import LoopPort
from standoff.servo.statistics import end_of_bin, spread_of
from standoff.simulation import Fault
from standoff.solids import Solid
from waiting import LONG, until

TRACE = Trace(knocking, 0.0, 0.6, there_and_back=True)


@pytest.fixture
def counted() -> Iterator[None]:
    """Numba counts what compiled code allocates and frees."""
    _nrt_python.memsys_enable_stats()
    yield
    _nrt_python.memsys_disable_stats()


@pytest.fixture(scope="module")
def operator() -> sim.Operator:
    return coupled()


@pytest.fixture
def pointed(operator: sim.Operator) -> Iterator[tuple[Servo, PointerDevice]]:
    """A loop that runs, engaged, moved by a pointer that was put away from the tool."""
    pointer = PointerDevice()
    servo = Servo(operator, device=pointer, max_age=1.0)
    servo.start()
    pointer.put(knocking(0.0).translation + np.array([0.01, 0.0, 0.0]))
    until(lambda: servo.ready)
    servo.engage()
    until(lambda: forced(servo))
    yield servo, pointer
    servo.stop()


def forced(servo: Servo) -> bool:
    return bool(servo.latest().wrench.force.any())


def test_it_computes_what_the_operator_does(operator: sim.Operator) -> None:
    check_ticks(operator)


def test_and_so_with_solids() -> None:
    """Their places of contact are found in the loop; the hand feels what it felt of bodies."""
    found, bodies = (
        check_ticks(coupled(stiffness=4e4, made=made)) for made in (Solid, lambda b: b)
    )
    pressed = bodies.distances < 0.0
    assert pressed.any()
    np.testing.assert_allclose(found.distances[pressed], bodies.distances[pressed], atol=1e-9)
    np.testing.assert_allclose(found.coupler.on_device, bodies.coupler.on_device, atol=1e-6)
    assert found.spots.max() == 1


def check_ticks(operator: sim.Operator) -> sim.SystemRun:
    """The same readings through `Operator.run`, which has no clock but its own; what it did."""
    ticks = 200
    servo = Servo(operator, device=TRACE, seconds=ticks * PERIOD, max_age=1.0)
    servo.engage()
    servo.start()
    servo.wait()
    report = servo.stop()
    assert report.ended is Ended.DONE
    rows = TRACE.rows(PERIOD)[:ticks]
    readings = sim.DeviceReadings([None])
    readings.rows = rows
    state = operator.start().engage()
    expected = operator.run(state, ticks, device=readings)
    # The clocks differ, a real one and a sum, so the differences that filters take may round.
    for body in (0, 1):
        pose = report.state.pose(body)
        np.testing.assert_allclose(pose.translation, expected.positions(body)[-1], atol=1e-12)
    log = report.log
    np.testing.assert_allclose(log["force"], expected.coupler.on_device[1:, :3], atol=1e-7)
    np.testing.assert_allclose(log["torque"], expected.coupler.on_device[1:, 3:], atol=1e-7)
    np.testing.assert_allclose(log["distance"], expected.distances[1:, 0], atol=1e-12)
    assert (log["distance"] < 0.0).any()
    handle = rows[:, K.G_MOTION : K.G_MOTION + 12]
    np.testing.assert_array_equal(log["rotation"].reshape(-1, 9), handle[:, :9])
    np.testing.assert_array_equal(log["position"], handle[:, 9:])
    np.testing.assert_allclose(log["tool"], expected.positions(1)[1:], atol=1e-12)
    assert (np.diff(log["time"]) > 0.0).all()
    assert not log["fault"].any()
    assert set(log["engaged"].tolist()) <= {0.0, 1.0}
    assert report.statistics.engaged == report.statistics.ticks == ticks
    assert report.state.coupler is not None
    assert not report.state.coupler.wrench_on_device.force.any()
    return expected


@pytest.mark.usefixtures("counted")
def test_nothing_is_compiled_or_allocated_in_the_loop(operator: sim.Operator) -> None:
    compiled: list[Any] = []

    class Heard(event.Listener):
        def on_start(self, event: Any) -> None:
            compiled.append(event)

        def on_end(self, event: Any) -> None:
            compiled.append(event)

    allocated = []
    with event.install_listener("numba:compile", Heard()):
        for ticks in (20, 300):
            servo = Servo(operator, device=TRACE, seconds=ticks * PERIOD)
            servo.engage()
            before = rtsys.get_allocation_stats()
            servo.start()
            servo.wait()
            after = rtsys.get_allocation_stats()
            allocated.append((after.alloc - before.alloc, after.free - before.free))
            assert servo.stop().statistics.ticks == ticks
    assert compiled == []
    assert allocated[0] == allocated[1]
    assert allocated[0][0] == allocated[0][1] > 0


def test_the_loop_goes_on_while_python_is_held_up(operator: sim.Operator) -> None:
    """A thread that keeps Python's lock for as long as it likes: the loop needs none."""
    servo = Servo(operator, device=TRACE)
    with servo:
        until(lambda: servo.latest().tick > 5)
        first = servo.latest().tick
        began = time.monotonic()
        total = sum(range(20_000_000))  # in one bytecode: nobody else gets the lock
        passed = time.monotonic() - began
        gone = servo.latest().tick - first
    assert total > 0
    assert gone >= 0.05 * passed / PERIOD > 1  # far fewer ticks than fit: others want the core


def test_it_is_at_rest_until_engaged_and_after_disengaging(
    pointed: tuple[Servo, PointerDevice], operator: sim.Operator
) -> None:
    servo, _ = pointed
    servo.disengage()
    until(lambda: not servo.latest().engaged)
    assert not forced(servo)
    assert servo.latest().fault is Fault.NONE
    fresh = Servo(operator, device=TRACE, seconds=20 * PERIOD)
    fresh.start()
    fresh.wait()
    assert not any(fresh.stop().log[name].any() for name in ("force", "torque"))


def test_limits_are_lowered_never_raised(pointed: tuple[Servo, PointerDevice]) -> None:
    servo, pointer = pointed
    servo.lower_force_limit(0.5)
    until(lambda: servo.latest().force_limit == 0.5)
    pointer.put(knocking(0.0).translation + np.array([0.05, 0.0, 0.0]))
    time.sleep(5 * PERIOD)
    assert np.linalg.norm(servo.latest().wrench.force) <= 0.5 * (1.0 + 1e-12)
    servo.lower_force_limit(5.0)
    time.sleep(5 * PERIOD)
    assert servo.latest().force_limit == 0.5
    with pytest.raises(StandoffError, match="force = -1"):
        servo.lower_force_limit(-1.0)
    servo.lower_torque_limit(0.0)
    until(lambda: servo.latest().torque_limit == 0.0)


def test_a_pointer_that_rests_too_long_or_is_lost_ends_the_force(
    pointed: tuple[Servo, PointerDevice],
) -> None:
    servo, pointer = pointed
    pointer.lost()
    until(lambda: not servo.latest().engaged)
    assert servo.latest().fault is Fault.MISSING
    assert not forced(servo)
    pointer.put(knocking(0.0).translation)  # dropped, or taken in at the next tick
    time.sleep(5 * PERIOD)
    pointer.put(knocking(0.0).translation)
    servo.engage()
    until(lambda: servo.latest().engaged)
    until(lambda: not servo.latest().engaged)  # nothing was put for a second
    assert servo.latest().fault is Fault.LATE
    assert not forced(servo)
    report = servo.stop()
    assert report.message.endswith(f"Before, the coupler let go: LATE: {Fault.LATE.advice}")
    assert repr(report).endswith(", fault LATE>")
    assert report.log["fault"][-1] == Fault.LATE
    assert Fault.MISSING in report.log["fault"]


@pytest.mark.parametrize(
    ("cell", "jump", "ended"),
    [
        (V.W_SHIFT, -3600.0, Ended.JUMPED),
        (V.W_SHIFT, -0.02, Ended.JUMPED),
        (V.W_SHIFT, 3600.0, Ended.STALLED),
        (V.W_ASLEEP, 5.0, Ended.SUSPENDED),
    ],
)
def test_a_clock_that_jumps_ends_in_zero_force(
    pointed: tuple[Servo, PointerDevice], cell: int, jump: float, ended: Ended
) -> None:
    servo, _ = pointed
    servo._asked[cell] = int(jump * 1e9)
    assert servo.wait(LONG)
    last = servo.latest()
    assert last.ended is ended
    assert not last.engaged
    assert not last.wrench.force.any()
    assert not servo.port.wrench().force.any()
    report = servo.stop()
    assert report.ended is ended
    assert not report.ended.sound
    assert "no force is on the handle" in report.message


def test_what_is_forgotten_ends_with_the_program() -> None:
    """The interpreter's end must not be waited for, nor leave a loop in memory that is gone."""
    text = """
from scenes import coupled
from waiting import until
from standoff.devices import Trace
from scenes import knocking
from standoff.servo import Servo
servo = Servo(coupled(), device=Trace(knocking, 0.0, 0.5, there_and_back=True))
servo.engage()
servo.start()
until(lambda: servo.latest().engaged)
print("runs")
"""
    paths = Path(so.__file__).parents[1], Path(__file__).parents[1]
    ended = subprocess.run(
        [sys.executable, "-c", text],
        cwd=Path(__file__).parent,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(map(str, paths))},
        capture_output=True,
        text=True,
        timeout=LONG if modules.AVAILABLE else 5.0 * LONG,
    )
    assert (ended.returncode, ended.stdout.strip()) == (0, "runs"), ended.stderr


def test_a_fault_is_taken_in_though_the_device_is_held_up(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The loop goes on for ten ticks while the device's thread has just looked at it."""
    inbox, outbox = Mailbox(K.N_READING), Mailbox(V.OUT_HEADER + K.C_HELD + 6)
    port = LoopPort(inbox, outbox, V.OUT_HEADER, PERIOD, 1.0)
    seen, told = [], np.zeros(V.OUT_HEADER + K.C_HELD + 6)

    def ten_ticks() -> None:
        for _ in range(10):
            row = inbox.newest_row()
            if row is not None:
                seen.append(Fault(int(row[K.G_FAULT])))
            told[V.TOLD_TICK] += 1.0
            outbox.put(told)

    look = port._look
    held_up = [True]

    def slow_look() -> int:
        found = look()
        if held_up and held_up.pop():
            ten_ticks()
        return found

    ten_ticks()
    monkeypatch.setattr(port, "_look", slow_look)
    port.fail(Fault.INVALID)
    port.put(sim.DeviceReading(time.monotonic(), 1, knocking(0.0)))
    ten_ticks()
    assert Fault.INVALID in seen


def test_a_fault_stays_until_it_is_taken_in() -> None:
    """A good reading that comes before the loop's next tick does not hide the bad one."""
    inbox, outbox = Mailbox(K.N_READING), Mailbox(V.OUT_HEADER + K.C_HELD + 6)
    port = LoopPort(inbox, outbox, V.OUT_HEADER, PERIOD, 1.0)
    told = np.zeros(V.OUT_HEADER + K.C_HELD + 6)
    told[V.OUT_HEADER + K.C_ON_DEVICE] = 3.0
    for tick in range(4):
        told[V.TOLD_TICK], told[V.TOLD_CLOCK] = tick, time.monotonic()
        outbox.put(told)
        if tick == 1:
            assert port.wrench().force[0] == 3.0
            port.fail(Fault.INVALID)
        port.put(sim.DeviceReading(time.monotonic(), tick, knocking(0.0)))
        row = inbox.newest_row()
        assert row is not None
        assert row[K.G_FAULT] == (Fault.INVALID if tick in (1, 2) else Fault.NONE)
        assert port.wrench().force[0] == (0.0 if tick in (1, 2) else 3.0)


def test_rows_are_never_torn() -> None:
    """A writer that goes round as fast as it can, beside readers that compare every number."""
    box, stop = Mailbox(64), threading.Event()

    def write() -> None:
        number = 0.0
        while not stop.is_set():
            number += 1.0
            box.put(np.full(64, number))

    writers = threading.Thread(target=write)
    writers.start()
    last, rows = 0.0, 0
    end = time.monotonic() + 0.5
    while time.monotonic() < end or rows <= 100:
        row = box.newest_row()
        if row is not None:
            assert (row == row[0]).all()
            assert row[0] >= last
            last, rows = row[0], rows + 1
    stop.set()
    writers.join()


def test_a_row_that_is_written_over_is_not_read() -> None:
    """What the race would be: the number moves on while the row is copied."""
    box = Mailbox(4)
    row = np.zeros(4)
    assert box.newest_row() is None
    for k in range(1, 2 * V.BOX_ROWS):
        box.put(np.full(4, float(k)))
        assert entries.take_row(box.newest, box.rows, k - 1, row) == k
        assert entries.take_row(box.newest, box.rows, k, row) == k
        assert (row == k).all()


def test_quantiles_are_those_of_numpy(rng: np.random.Generator) -> None:
    times = (10.0 ** rng.uniform(1.0, 8.0, 5000)).astype(np.int64)
    bins = np.zeros(V.BINS, dtype=np.int64)
    for value in times.tolist():
        number = next_bin(value)
        assert end_of_bin(number) >= value
        assert number == 0 or end_of_bin(number - 1) < value
        bins[number] += 1
    found = spread_of(bins, int(times.max()))
    wanted = np.quantile(times, [0.5, 0.99, 0.999, 0.9999], method="inverted_cdf") / 1e9
    np.testing.assert_allclose(found[:4], wanted, rtol=1 / 100)
    assert found.worst == times.max() / 1e9


def next_bin(value: int) -> int:
    """The bin of a time, from below."""
    low, high = 0, V.BINS - 1
    while low < high:
        middle = (low + high) // 2
        low, high = (low, middle) if end_of_bin(middle) >= value else (middle + 1, high)
    return low


def test_the_loop_s_bins_are_those_of_the_statistics(operator: sim.Operator) -> None:
    servo = Servo(operator, device=TRACE, seconds=50 * PERIOD)
    servo.start()
    servo.wait()
    report = servo.stop()
    work = np.round(1e9 * report.log["work"]).astype(int).tolist()
    bins = np.zeros(V.BINS, dtype=np.int64)
    for value in work:
        bins[next_bin(value)] += 1
    assert (bins == servo._bins[V.H_WORK]).all()


@pytest.mark.usefixtures("counted")
def test_memory_is_flat(operator: sim.Operator) -> None:
    servo = Servo(operator, device=TRACE, log_ticks=50)
    with servo:
        until(lambda: servo.latest().tick > 60)
        gc.collect()
        before = rtsys.get_allocation_stats().alloc
        tick = int(servo._tallies[V.Y_TICKS])
        until(lambda: servo._tallies[V.Y_TICKS] > tick + 100)
        assert rtsys.get_allocation_stats().alloc == before
    assert len(servo.stop().log) == 50  # the last ones, oldest first
    assert (np.diff(servo.stop().log["tick"]) == 1).all()


@pytest.mark.parametrize(
    ("named", "message"),
    [
        ({"rate": 1000.0}, "rate is 1000, but the operator makes 500 ticks"),
        ({"device": "haply"}, "device is 'haply': give a Trace"),
        ({"seconds": 0.0}, "seconds = 0.0"),
        ({"seconds": 1e12}, "give at most 1e.09"),
        ({"max_age": -1.0}, "max_age = -1"),
        ({"log_ticks": 10**9}, "log_ticks = 1000000000"),
        ({"state": 3}, "state is 3"),
    ],
)
def test_what_cannot_serve_is_refused(
    operator: sim.Operator, named: dict[str, Any], message: str
) -> None:
    with pytest.raises(StandoffError, match=message):
        Servo(operator, **named)


def test_systems_that_no_device_feels_are_refused() -> None:
    ball = sim.RigidBody.free(so.shapes.sphere(0.1), mass=1.0)
    free = sim.System([ball], sim.HuntCrossley(stiffness=1.0), gravity=[0, 0, 0])
    with pytest.raises(StandoffError, match="has no coupler"):
        Servo(sim.Operator(free, 1e-3))
    with pytest.raises(StandoffError, match="10 to 10000"):
        Servo(coupled(period=1e-5))
    with pytest.raises(StandoffError, match="never started"):
        Servo(coupled()).stop()
