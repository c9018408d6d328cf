"""A device's reading as the kernels read it: its stamp and numbers, or what is wrong with it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Final

import numpy as np

from standoff.checks.numbers import is_whole
from standoff.kernels.dynamics import coupler_arrays as K
from standoff.simulation.device import Fault, HandleMotion, read_motion
from standoff.typing import Array

MOST_READINGS: Final = 2**53
"""Greatest sequence number: beyond it a float does not tell two neighbours apart, and at 1 kHz a
device comes there after 285 000 years."""


def reading_row(reading: Any) -> Array:
    """Return what a driver gave as K.N_READING numbers, and never an exception.

    Parameters
    ----------
    reading : DeviceReading, None, or whatever a driver may give
    """
    row = np.zeros(K.N_READING)
    fault = _read_into(row, reading)
    row[K.G_FAULT] = fault
    return row


def motion_row(seen: HandleMotion) -> Array:
    """Pose and twist as 18 numbers."""
    return np.array((*seen.R, *seen.p, *seen.v, *seen.omega))


def _read_into(row: Array, reading: Any) -> Fault:
    if reading is None:
        return Fault.MISSING
    stamp = _stamp(reading)
    if isinstance(stamp, Fault):
        return stamp
    row[K.G_TIME], row[K.G_SEQUENCE] = stamp
    handle = read_motion(reading.pose, reading.twist)
    if isinstance(handle, Fault):
        return handle
    row[K.G_TWIST] = reading.twist is not None
    row[K.G_MOTION :] = motion_row(handle)
    return Fault.NONE


def _stamp(reading: Any) -> tuple[float, int] | Fault:
    """Time and sequence number of a reading."""
    try:
        time, sequence, valid = reading.time, reading.sequence, reading.valid
        if isinstance(time, str | bytes | bool | Iterable):
            return Fault.MALFORMED
        seconds = float(time)
    except Exception:  # as in `read_motion`: never an exception, always a fault
        return Fault.MALFORMED
    if not is_whole(sequence) or not 0 <= sequence <= MOST_READINGS:
        return Fault.MALFORMED
    if not isinstance(valid, bool | np.bool_):
        return Fault.MALFORMED
    return (seconds, int(sequence)) if valid else Fault.INVALID
