"""A pointer as a device: whoever moves it, such as a page in a browser, says where it is."""

from __future__ import annotations

import threading
import time
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from standoff.bound_to_run import BoundToRun
from standoff.checks.arrays import finite
from standoff.checks.numbers import number
from standoff.devices.port import Port
from standoff.errors import DeviceError
from standoff.motion.pose import Pose, PoseLike
from standoff.simulation.device import DeviceReading, Fault


class PointerDevice(BoundToRun):
    """A handle that follows somebody's pointer; it feels no force.

    Any thread may call it. It keeps only the last pose. Positions come at 60 Hz or so; the loop
    that takes them needs a `max_age` above the longest pause between two of them, or calls of `put`
    while the pointer rests.

    Raises StandoffError: not a pose.

    Parameters
    ----------
    pose : Pose or what `Pose.of` reads, optional
        Where it is before the first `put`: its rotation is kept if only positions are put.

    Attributes
    ----------
    problem : str
        Why it no longer gives readings.
    """

    def __init__(self, pose: PoseLike | None = None) -> None:
        self._pose = Pose.identity() if pose is None else Pose.of(pose)
        self._lock = threading.Lock()
        self._port: Port | None = None
        self._sequence = 0
        self._stamp = -1.0
        self.problem = ""

    def attach(self, port: Port) -> None:
        """Begin to give readings to a port.

        Raises DeviceError: it gives them to another one.
        """
        with self._lock:
            if self._port is not None:
                raise DeviceError("the pointer moves another loop's handle; stop that loop first")
            self._port, self.problem = port, ""

    def detach(self) -> None:
        """Give no more readings."""
        with self._lock:
            self._port = None

    def put(self, at: PoseLike | ArrayLike, stamp: float | None = None) -> None:
        """Say where the pointer is.

        Raises StandoffError: neither a position nor a pose, or not finite. The handle stays where
        it was, and its reading grows old.

        Parameters
        ----------
        at : array_like, shape (3,), Pose or what `Pose.of` reads
            A position in the world [length], which keeps the rotation, or a pose.
        stamp : float, optional
            When it was there, on the clock of `time.monotonic()` [s]; now if not given. One that
            is not newer than the last counts as a repetition of it, and is dropped.
        """
        pose = self._read(at)
        when = time.monotonic() if stamp is None else number(stamp, "stamp")
        with self._lock:
            if when <= self._stamp:
                return
            self._pose, self._stamp = pose, when
            self._sequence += 1
            if self._port is not None:
                self._port.put(DeviceReading(when, self._sequence, pose))

    def lost(self) -> None:
        """Say that whoever moves the pointer is gone: no force until the loop is engaged again."""
        with self._lock:
            self.problem = "whoever had the pointer is gone; connect again, then engage again"
            if self._port is not None:
                self._port.fail(Fault.MISSING)

    def _read(self, at: Any) -> Pose:
        try:
            a_position = not isinstance(at, Pose) and np.shape(at) == (3,)
        except (TypeError, ValueError):  # a rotation beside a position has no one shape
            a_position = False
        if not a_position:
            return Pose.of(at)
        return Pose.from_checked(self._pose.rotation, finite(at, "at", (3,)))

    def __repr__(self) -> str:
        return f"<PointerDevice, {self._sequence} readings>"
