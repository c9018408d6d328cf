"""A servo: a system in real time, with a device that feels it."""

from __future__ import annotations

import atexit
import threading
import weakref
from types import TracebackType
from typing import Any, Final, NamedTuple, Self

import numpy as np

from standoff.bound_to_run import BoundToRun
from standoff.checks.numbers import not_negative, positive, yes_or_no
from standoff.devices.polled import Polled
from standoff.devices.port import LiveDevice
from standoff.devices.trace import Trace
from standoff.errors import StandoffError
from standoff.kernels.dynamics import arrays as A
from standoff.kernels.dynamics import coupler_arrays as K
from standoff.kernels.dynamics import servo_arrays as V
from standoff.kernels.entries import servo as entries
from standoff.kernels.entries.preparing import prepare_servo
from standoff.servo import checked
from standoff.servo.exchange import Mailbox
from standoff.servo.loop_port import LoopPort
from standoff.servo.report import Ended, ServoReport, in_order, told
from standoff.servo.statistics import NANO, statistics_of
from standoff.servo.system_calls import ask_for_real_time, clocks, unlock_memory
from standoff.servo.tolerances import LONGEST_GAP, SPIN, SPIN_SHARE, STOPPED_WITHIN
from standoff.simulation.device import Device, DeviceReading, Fault
from standoff.simulation.operator import Operator
from standoff.simulation.simulated_device import SimulatedDevice
from standoff.simulation.system_state import SystemState, coupler_at, state_length
from standoff.simulation.wrench import Wrench

LOG_TICKS: Final = 100_000
"""Ticks that are logged if nothing is said: 24 MB, the last 100 s at 1 kHz."""


class Snapshot(NamedTuple):
    """What a servo published last.

    Attributes
    ----------
    tick : int
        The tick's number, from 0; -1 before the first.
    clock : float
        When it began, on the clock of `time.monotonic()` [s].
    state : SystemState
        After it, of bodies, trackers and coupler.
    late, work : float
        How late it began, and how long the tick before it took [s].
    missed : int
        Deadlines missed so far.
    force_limit, torque_limit : float
        The greatest force and torque as they are now [N, N m].
    ended : Ended or None
        Why the loop ended; None while it runs.
    """

    tick: int
    clock: float
    state: SystemState
    late: float
    work: float
    missed: int
    force_limit: float
    torque_limit: float
    ended: Ended | None

    @property
    def engaged(self) -> bool:
        """Does the coupler render a force?"""
        return self.state.coupler is not None and self.state.coupler.engaged

    @property
    def fault(self) -> Fault:
        """Why the coupler let go last."""
        return Fault.NONE if self.state.coupler is None else self.state.coupler.fault

    @property
    def wrench(self) -> Wrench:
        """What is on the handle."""
        coupler = self.state.coupler
        return Wrench.zero() if coupler is None else coupler.wrench_on_device


class Servo(BoundToRun):
    """A system with a coupler, advanced in real time at a fixed rate, and felt by a device.

    The loop is one compiled call in a thread of its own: it sleeps, spins, takes the newest
    reading, moves coupler, bodies and trackers by one tick, and publishes its whole state. It holds
    no lock, allocates nothing and calls no Python. The coupler is at rest until `engage`, and after
    any fault until `engage` again. Used as a context manager, it is started, and stopped
    afterwards.

    Raises StandoffTypeError: an argument of the wrong kind. Raises StandoffError: a system without
    a coupler, or with driven bodies; a rate that is not the operator's, or not within 10 to 10 000
    a second; a system without the clocks that are needed.

    Parameters
    ----------
    operator : Operator
        Of a system with a coupler. A tick is one period of the coupler's device: so many steps.
    state : SystemState, optional
        Where it begins; `operator.start()` if not given.
    device : LiveDevice, Device or Trace, optional
        What moves the handle. A `Device` is read and written by a thread in Python, once per
        period. Without one, readings are given by `put`.
    rate : float, optional
        Ticks a second, as a check: it must be the operator's.
    seconds : float, optional
        How long to run [s]; until `stop` if not given.
    max_age : float, optional
        In place of the coupler's own greatest age of a reading [s].
    real_time : bool
        Ask the system for a real-time priority and locked memory.
    log_ticks : int
        How many of the last ticks to keep.

    Attributes
    ----------
    rate : float
        Ticks a second.
    port : LoopPort
        What a device of your own gives its readings to.
    """

    def __init__(
        self,
        operator: Operator,
        *,
        state: SystemState | None = None,
        device: LiveDevice | Device | Trace | None = None,
        rate: float | None = None,
        seconds: float | None = None,
        max_age: float | None = None,
        real_time: bool = False,
        log_ticks: int = LOG_TICKS,
    ) -> None:
        checked.system_of(operator)
        self._operator, self._system = operator, operator.system
        self._period = operator.dt * operator.ticks_a_reading
        self.rate = checked.rate_of(self._period, rate)
        begin = operator.start() if state is None else state
        operator._check_state(begin)
        self._first, self._data = begin, operator.room_for(begin)
        self._device = self._live(device)
        self._script = np.zeros((0, K.N_READING))
        if isinstance(device, Trace):
            self._script = device.rows(self._period).copy()
        self._real_time = yes_or_no(real_time, "real_time")
        self._numbers = operator.packed[1].copy()
        coupler = int(operator.packed[0][A.I_COUPLER])
        if max_age is not None:
            age = positive(max_age, "max_age")
            self._numbers[coupler + K.Q_AGE] = age
        self._plan = self._planned(checked.ticks_in(seconds, self.rate), device)
        self._at = V.OUT_HEADER + coupler_at(self._system)
        self._make_shared(checked.log_ticks(log_ticks))
        oldest = float(self._numbers[coupler + K.Q_AGE])
        self.port = LoopPort(self._inbox, self._outbox, self._at, self._period, oldest)
        self._lock = threading.Lock()
        self._thread: threading.Thread | None = None
        self._why: int | None = None
        self._error: BaseException | None = None
        self._notes: list[str] = []
        prepare_servo()

    def _live(self, device: Any) -> LiveDevice | None:
        checked.kind_of_device(device)
        if isinstance(device, LiveDevice):
            return device
        if isinstance(device, Device):
            stamped = not isinstance(device, SimulatedDevice)
            return Polled(device, period=self._period, stamped=stamped)
        return None

    def _planned(self, ticks: int, device: Any) -> np.ndarray[Any, np.dtype[np.int64]]:
        """The loop's plan, laid out in ``servo_arrays``."""
        plan = np.zeros(V.N_PLAN, dtype=np.int64)
        plan[V.V_PERIOD] = round(self._period * NANO)
        plan[V.V_SPIN] = round(min(SPIN, SPIN_SHARE * self._period) * NANO)
        plan[V.V_GAP] = round(LONGEST_GAP * NANO)
        plan[V.V_TICKS] = ticks
        plan[V.V_REPEAT] = isinstance(device, Trace) and device.there_and_back
        plan[V.V_CLOCK : V.N_PLAN] = clocks()
        return plan

    def _make_shared(self, log_ticks: int) -> None:
        self._asked = np.zeros(V.N_ASKED, dtype=np.int64)
        self._limits = np.full(V.N_LIMITS, np.inf)
        self._inbox = Mailbox(K.N_READING)
        self._outbox = Mailbox(V.OUT_HEADER + state_length(self._system))
        self._bins = np.zeros((V.N_MEASURED, V.BINS), dtype=np.int64)
        self._tallies = np.zeros(V.N_TALLIES, dtype=np.int64)
        self._log = np.zeros((log_ticks, V.J_LOGGED))

    def start(self) -> None:
        """Connect the device and start the loop; the coupler is at rest.

        Raises DeviceError: there is no device. Raises StandoffError: it was started before.
        """
        if self._thread is not None:
            raise StandoffError("this servo was already started: make another one.")
        if self._device is not None:
            self._device.attach(self.port)
        self._thread = threading.Thread(target=self._run, name="servo", daemon=True)
        atexit.register(_stopped, weakref.ref(self))
        self._thread.start()

    def _run(self) -> None:
        """The servo's thread: one compiled call."""
        locked = False
        try:
            if self._real_time:
                self._notes = ask_for_real_time()
                locked = not any(note.startswith("memory") for note in self._notes)
            packed = (*self._operator.packed[:1], self._numbers, *self._operator.packed[2:])
            table = np.zeros((1, 1))  # no body is driven
            self._why = entries.serve(
                packed,
                self._numbers,
                self._data,
                self._plan,
                (self._asked, self._limits),
                (table, self._script),
                (self._inbox.arrays, self._outbox.arrays),
                (self._bins, self._tallies, self._log),
            )
        except BaseException as error:  # told by `stop`, in the thread that asks
            self._error = error
        finally:
            if locked:
                unlock_memory()

    def put(self, reading: DeviceReading | None) -> None:
        """Give the loop a reading, where it has no device; its time is `time.monotonic()`."""
        self.port.put(reading)

    @property
    def ready(self) -> bool:
        """Has the loop taken in a reading?"""
        return bool(self._tallies[V.Y_FRESH] > 0)

    @property
    def running(self) -> bool:
        """Does the loop run?"""
        return self._thread is not None and self._thread.is_alive()

    @property
    def problem(self) -> str:
        """Why the device no longer gives readings; empty while nothing is wrong."""
        return "" if self._device is None else self._device.problem

    def engage(self) -> None:
        """Put the coupler to work from the next tick on, its force growing from zero."""
        self._ask(V.W_ENGAGE)

    def disengage(self) -> None:
        """Put the coupler to rest from the next tick on."""
        self._ask(V.W_REST)

    def _ask(self, what: int) -> None:
        with self._lock:
            self._asked[what] += 1

    def lower_force_limit(self, force: float) -> None:
        """Lower the greatest force from the next tick on; it is never raised.

        Raises StandoffError: a force below zero, or not finite.

        Parameters
        ----------
        force : float
            [N]; one above the present limit changes nothing.
        """
        self._lower(V.L_FORCE, not_negative(force, "force"))

    def lower_torque_limit(self, torque: float) -> None:
        """Lower the greatest torque [N m] from the next tick on; as `lower_force_limit`."""
        self._lower(V.L_TORQUE, not_negative(torque, "torque"))

    def _lower(self, which: int, most: float) -> None:
        with self._lock:
            self._limits[which] = min(float(self._limits[which]), most)

    def latest(self) -> Snapshot:
        """Return what the loop published last; never waits for it."""
        row = self._outbox.newest_row()
        if row is None:
            at = int(self._operator.packed[0][A.I_COUPLER])
            limits = float(self._numbers[at + K.Q_FORCE]), float(self._numbers[at + K.Q_TORQUE])
            return Snapshot(-1, 0.0, self._first, 0.0, 0.0, 0, *limits, None)
        ended = int(row[V.TOLD_ENDED])
        return Snapshot(
            tick=int(row[V.TOLD_TICK]),
            clock=float(row[V.TOLD_CLOCK]),
            state=self._state_of(row[V.OUT_HEADER :].copy()),
            late=float(row[V.TOLD_LATE]),
            work=float(row[V.TOLD_WORK]),
            missed=int(row[V.TOLD_MISSED]),
            force_limit=float(row[V.TOLD_FORCE_LIMIT]),
            torque_limit=float(row[V.TOLD_TORQUE_LIMIT]),
            ended=None if ended == V.RUNNING else Ended(ended),
        )

    def _state_of(self, data: np.ndarray[Any, np.dtype[np.float64]]) -> SystemState:
        data.flags.writeable = False
        return SystemState(self._system, data)

    def wait(self, seconds: float | None = None) -> bool:
        """Wait until the loop has ended, or for so long [s]; has it ended?"""
        if self._thread is not None:
            self._thread.join(seconds)
        return not self.running

    def stop(self) -> ServoReport:
        """End the loop with no force on the handle, and release the device.

        Raises StandoffError: it was never started.

        Returns
        -------
        ServoReport
            The same if it had already ended.
        """
        if self._thread is None:
            raise StandoffError("this servo was never started: call start first.")
        self._asked[V.W_STOP] = 1
        self._thread.join(STOPPED_WITHIN)
        if self._device is not None:
            self._device.detach()
        if self._thread.is_alive():
            raise StandoffError("the servo's loop did not end: end the program.")
        if self._error is not None:
            raise self._error
        return self._report()

    def _report(self) -> ServoReport:
        ended = Ended(self._why or V.STOPPED)
        state = self._state_of(self._data.copy())
        fault = Fault.NONE if state.coupler is None else state.coupler.fault
        return ServoReport(
            ended=ended,
            message=told(ended, int(self._tallies[V.Y_AWAY]), fault),
            rate=self.rate,
            statistics=statistics_of(self._bins, self._tallies),
            state=state,
            fault=fault,
            notes=tuple(self._notes),
            problem=self.problem,
            log=in_order(self._log, int(self._tallies[V.Y_TICKS])),
        )

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.stop()

    def __repr__(self) -> str:
        return f"<Servo of {self._system!r} at {self.rate:g} Hz>"


def _stopped(servo: weakref.ref[Servo]) -> None:
    """At the end of the program: a servo that nobody stopped."""
    found = servo()
    if found is not None and found.running:
        found.stop()
