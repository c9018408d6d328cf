"""A device's reading, taken in or found at fault."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from standoff.simulation.coupler_state import CouplerState
from standoff.simulation.device import Fault, Seen, read_motion
from standoff.simulation.passivity import whole_number
from standoff.simulation.six_axes import combined, difference, rotation_error


class Arrival(NamedTuple):
    """A reading that can be used.

    Attributes
    ----------
    handle : Seen
        With the velocity that the driver gave, or that of the way from the last reading.
    time, sequence : float, int
        Its stamp.
    clock : float
        The time now, on the clock of the readings [s].
    elapsed : float
        Since the last reading [s]; 0 where there was none, or where this is it again.
    skipped : int
        Readings that should have come in between.
    repeated : bool
        It is the last one again.
    """

    handle: Seen
    time: float
    sequence: int
    clock: float
    elapsed: float
    skipped: int
    repeated: bool


def arrived(
    state: CouplerState, reading: Any, clock: float, max_age: float, lag: float
) -> Arrival | Fault:
    """Return what a reading says, or what is wrong with it.

    Parameters
    ----------
    state : CouplerState
    reading : DeviceReading, or whatever a driver may give
    clock : float
        The time now [s]; nan for that of the reading.
    max_age : float
        [s]
    lag : float
        Time constant of the filter behind differences [s].
    """
    if reading is None:
        return Fault.MISSING
    stamp = _stamp(reading)
    if isinstance(stamp, Fault):
        return stamp
    time, sequence = stamp
    clock = time if math.isnan(clock) else clock
    handle = read_motion(reading.pose, reading.twist)
    if isinstance(handle, Fault):
        return handle
    last, skipped, elapsed = state.handle, 0, 0.0
    repeated = last is not None and sequence == state.sequence and time == state.time
    if last is not None and repeated:
        handle = last
    elif last is not None:
        if sequence <= state.sequence or time <= state.time:
            return Fault.OUT_OF_ORDER
        skipped, elapsed = sequence - state.sequence - 1, time - state.time
        if reading.twist is None:
            handle = _with_differences(handle, last, elapsed, lag)
    if abs(clock - time) > max_age:
        return Fault.LATE
    return Arrival(handle, time, sequence, clock, elapsed, skipped, repeated)


def _stamp(reading: Any) -> tuple[float, int] | Fault:
    """Time and sequence number of a reading."""
    try:
        time, sequence, valid = reading.time, reading.sequence, reading.valid
        if isinstance(time, str | bytes | bool | Iterable):
            return Fault.MALFORMED
        seconds = float(time)
    except Exception:  # as in `read_motion`: never an exception, always a fault
        return Fault.MALFORMED
    if not whole_number(sequence) or not isinstance(valid, bool | np.bool_):
        return Fault.MALFORMED
    if not valid:
        return Fault.INVALID
    return (seconds, int(sequence)) if math.isfinite(seconds) else Fault.NON_FINITE


def _with_differences(handle: Seen, last: Seen, elapsed: float, lag: float) -> Seen:
    """A handle with the velocity of the way from the last reading, filtered."""
    new, old = 1.0 / (elapsed + lag), lag / (elapsed + lag)
    return handle._replace(
        v=combined(new, difference(handle.p, last.p), old, last.v),
        omega=combined(new, rotation_error(handle.R, last.R), old, last.omega),
    )
