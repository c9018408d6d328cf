"""The loop as its device sees it."""

from __future__ import annotations

import math
import threading
import time

import numpy as np

from standoff.kernels.dynamics import coupler_arrays as K
from standoff.kernels.dynamics import servo_arrays as V
from standoff.kernels.entries import servo as entries
from standoff.servo.exchange import Mailbox
from standoff.simulation.arrivals import reading_row
from standoff.simulation.device import DeviceReading, Fault
from standoff.simulation.wrench import Wrench
from standoff.typing import Array

NOTHING = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

TICKS_TO_SEE = 2
"""Ticks after the one that was published last, at the end of which a reading has surely been taken
in: the next one may have begun before it came."""


class LoopPort:
    """The end of a servo loop that a device holds; see `standoff.devices.Port`.

    A faulty reading stays the newest until the loop has taken it in, whatever comes after it, and
    until then the wrench here is already zero.

    Parameters
    ----------
    inbox, outbox : Mailbox
        Of the loop.
    at : int
        Where the coupler's state begins in a row of the outbox.
    period : float
        Of the loop [s].
    max_age : float
        Greatest age of a reading [s].
    """

    def __init__(
        self, inbox: Mailbox, outbox: Mailbox, at: int, period: float, max_age: float
    ) -> None:
        self._inbox, self._outbox = inbox, outbox
        self._at = at + K.C_ON_DEVICE
        self._told = np.zeros(self._at + 6)
        self._lock = threading.Lock()
        self._until: float | None = None
        self.max_age = max_age
        self._longest = max(max_age, TICKS_TO_SEE * period)

    def put(self, reading: DeviceReading | None) -> None:
        """Give the newest reading; None where there is none."""
        row = reading_row(reading)
        with self._lock:
            if self._waits():
                return
            self._put(row)

    def fail(self, fault: Fault) -> None:
        """Say that the device cannot be trusted."""
        row = np.zeros(K.N_READING)
        row[K.G_FAULT] = fault
        with self._lock:
            self._put(row)

    def wrench(self) -> Wrench:
        """Return what to hold on the handle now."""
        with self._lock:
            if self._waits() or self._look() == 0:
                return Wrench.zero()
            six = tuple(self._told[self._at : self._at + 6].tolist())
            old = time.monotonic() - self._told[V.TOLD_CLOCK] > self._longest
            if old or self._told[V.TOLD_ENDED] != V.RUNNING or not all(map(math.isfinite, six)):
                six = NOTHING
        return Wrench.from_checked(six)

    def _put(self, row: Array) -> None:
        self._inbox.put(row)
        if row[K.G_FAULT] != K.NO_FAULT:
            # Looked at after the row is there: a thread that is held up in between would count
            # ticks that had not seen it.
            ticks = self._told[V.TOLD_TICK] if self._look() else 0.0
            self._until = ticks + TICKS_TO_SEE

    def _waits(self) -> bool:
        """Has a faulty reading not been taken in yet?"""
        if self._until is not None and self._look() and self._told[V.TOLD_TICK] >= self._until:
            self._until = None
        return self._until is not None

    def _look(self) -> int:
        """Copy what the loop published last; 0 if it has published nothing yet."""
        newest, rows = self._outbox.arrays
        number = entries.take_row(newest, rows, 0, self._told)
        while number < 0:
            number = entries.take_row(newest, rows, 0, self._told)
        return int(number)
