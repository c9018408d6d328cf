"""How a servo loop ended, and what it kept."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from standoff.kernels.dynamics import servo_arrays as V
from standoff.read_only import KeepsReadOnly
from standoff.servo.statistics import NANO, ServoStatistics
from standoff.simulation.device import Fault
from standoff.simulation.system_state import SystemState
from standoff.typing import Array
from standoff.wording import counted

Log = NDArray[np.void]

LOGGED = np.dtype(
    [
        *((name, np.float64) for name in ("tick", "time", "lateness", "work", "engaged", "fault")),
        ("distance", np.float64),
        ("position", np.float64, 3),
        ("rotation", np.float64, (3, 3)),
        *((name, np.float64, 3) for name in ("tool", "force", "torque")),
    ]
)
"""A row of the log: the numbers of ``V.J_TICK`` to ``V.J_LOGGED``, in their order."""


class Ended(IntEnum):
    """Why a servo loop ended; in any case without a force."""

    STOPPED = V.STOPPED
    DONE = V.DONE
    BROKEN = V.BROKEN
    JUMPED = V.JUMPED
    STALLED = V.STALLED
    SUSPENDED = V.SUSPENDED

    @property
    def sound(self) -> bool:
        """Did it end as asked?"""
        return self in (Ended.STOPPED, Ended.DONE)


_TOLD = {
    Ended.STOPPED: "stopped as it was asked to",
    Ended.DONE: "done: its time is over",
    Ended.BROKEN: "a body's motion was no longer finite: take a shorter step or less stiffness",
    Ended.JUMPED: "the clock went back by {away:.3g} s: check the machine's clock",
    Ended.STALLED: "nothing ran for {away:.3g} s: the clock jumped ahead, or the machine was "
    "held up; check its load, its power saving, and a virtual machine's host",
    Ended.SUSPENDED: "the machine was suspended for {away:.3g} s",
}


@dataclass(frozen=True, eq=False)
class ServoReport(KeepsReadOnly):
    """How a servo loop ended.

    Attributes
    ----------
    ended : Ended
    message : str
        The same in words, with what to do.
    rate : float
        Intended ticks a second.
    statistics : ServoStatistics
    state : SystemState
        At the end; its coupler is at rest.
    fault : Fault
        Why the coupler let go last; `Fault.NONE` if it never did.
    notes : tuple of str
        What the system refused: a real-time priority, locked memory.
    problem : str
        What the device said was wrong with it.
    log : (n,) array with named columns
        The last ticks, oldest first, such as ``log["force"]``, (n, 3): "tick"; "time", on the clock
        of `time.monotonic()` [s]; "lateness" and "work" [s]; "engaged", 1 or 0; "fault", a number
        of `Fault`; "distance", the least of all pairs; "position" and "rotation" of the handle, all
        0 before the first reading; "tool", its position; "force" and "torque" on the handle [N, N
        m].
    """

    ended: Ended
    message: str
    rate: float
    statistics: ServoStatistics
    state: SystemState
    fault: Fault
    notes: tuple[str, ...]
    problem: str
    log: Log

    def __repr__(self) -> str:
        ticks = counted(self.statistics.ticks, "tick")
        fault = "" if self.fault is Fault.NONE else f", fault {self.fault.name}"
        return f"<ServoReport {self.ended.name}, {ticks}{fault}>"


def told(ended: Ended, away: int, fault: Fault) -> str:
    """Return in words why a loop ended, `away` in nanoseconds, and why its coupler let go."""
    why = _TOLD[ended].format(away=away / NANO) + "; no force is on the handle"
    return why if fault is Fault.NONE else f"{why}. Before, the coupler let go: {fault_told(fault)}"


def fault_told(fault: Fault) -> str:
    """Return a fault's name, what happened, and what to do."""
    return f"{fault.name}: {fault.advice}"


def in_order(log: Array, ticks: int) -> Log:
    """Return the rows of a log that goes round, oldest first, with names, read-only."""
    count = len(log)
    rows = log[:ticks] if ticks <= count else np.roll(log, -(ticks % count), axis=0)
    kept: Log = rows.copy().view(LOGGED)[:, 0]
    kept.flags.writeable = False
    return kept
