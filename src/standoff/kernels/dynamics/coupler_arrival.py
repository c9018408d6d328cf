"""A device's reading, taken in or found to be faulty."""

from __future__ import annotations

from math import isfinite, isnan
from typing import Any, NamedTuple

from standoff.kernels.algebra.rigid import log_rotation, read_rotation, read_vector
from standoff.kernels.algebra.vectors import add, scale, sub
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.dynamics.coupler_arrays import (
    C_HANDLE,
    C_SEEN,
    C_SEQUENCE,
    C_TIME,
    G_FAULT,
    G_MOTION,
    G_SEQUENCE,
    G_TIME,
    G_TWIST,
    LATE,
    NO_FAULT,
    NON_FINITE,
    OUT_OF_ORDER,
    Q_AGE,
    Q_LAG,
)
from standoff.kernels.values import Motion, Pose


class Arrival(NamedTuple):
    """What is made of a reading."""

    fault: int
    handle: Any  # `Motion`, world: the velocity that came, or that of the way from the last reading
    clock: float  # time now, on the clock of the readings
    elapsed: float  # since the last reading; 0 where there was none, or where this is it again
    skipped: float  # readings that should have come in between
    repeated: bool


@kernel
def turned(R, S):
    """``R Sᵀ``: the rotation, along the world's axes, that brings S to R."""
    return (
        R[0] * S[0] + R[1] * S[1] + R[2] * S[2],
        R[0] * S[3] + R[1] * S[4] + R[2] * S[5],
        R[0] * S[6] + R[1] * S[7] + R[2] * S[8],
        R[3] * S[0] + R[4] * S[1] + R[5] * S[2],
        R[3] * S[3] + R[4] * S[4] + R[5] * S[5],
        R[3] * S[6] + R[4] * S[7] + R[5] * S[8],
        R[6] * S[0] + R[7] * S[1] + R[8] * S[2],
        R[6] * S[3] + R[7] * S[4] + R[8] * S[5],
        R[6] * S[6] + R[7] * S[7] + R[8] * S[8],
    )


@kernel
def rotation_error(R, S):
    """The rotation vector, along the world's axes, that brings S to R by the shorter way."""
    return log_rotation(turned(R, S))


@kernel
def motion_at(row, o):
    """Pose and twist of 18 numbers."""
    pose = Pose(read_rotation(row, o), read_vector(row, o + 9))
    return Motion(pose, read_vector(row, o + 12), read_vector(row, o + 15))


@kernel
def all_finite(row, o, count):
    total = 0.0
    for k in range(count):
        total += 0.0 * row[o + k]  # nan from an infinite one or a nan
    return total == 0.0


@kernel
def with_differences(handle, last, elapsed, lag):
    """A handle with the velocity of the way from the last reading, filtered."""
    new, old = 1.0 / (elapsed + lag), lag / (elapsed + lag)
    way = sub(handle.pose.p, last.pose.p)
    turn = rotation_error(handle.pose.R, last.pose.R)
    v = add(scale(new, way), scale(old, last.v))
    return Motion(handle.pose, v, add(scale(new, turn), scale(old, last.w)))


@kernel
def arrived(coupler, state, reading, clock):
    """What a reading says, or what is wrong with it; `clock` is nan for the reading's own time."""
    handle, time = motion_at(reading, G_MOTION), reading[G_TIME]
    last = motion_at(state, C_HANDLE)
    now = time if isnan(clock) else clock
    fault = int(reading[G_FAULT])
    skipped, elapsed, repeated = 0.0, 0.0, False
    if fault == NO_FAULT and not (isfinite(time) and all_finite(reading, G_MOTION, 18)):
        fault = NON_FINITE
    if fault == NO_FAULT and state[C_SEEN] > 0.0:
        further = reading[G_SEQUENCE] - state[C_SEQUENCE]
        elapsed = time - state[C_TIME]
        repeated = further == 0.0 and elapsed == 0.0
        if repeated:
            handle = last
        elif further <= 0.0 or elapsed <= 0.0:
            fault = OUT_OF_ORDER
        else:
            skipped = further - 1.0
            if reading[G_TWIST] == 0.0:
                handle = with_differences(handle, last, elapsed, coupler[Q_LAG])
    if fault == NO_FAULT and abs(now - time) > coupler[Q_AGE]:
        fault = LATE
    return Arrival(fault, handle, now, elapsed, skipped, repeated)


@kernel
def standing(state, clock):
    """Between two readings: the handle is where it was."""
    return Arrival(NO_FAULT, motion_at(state, C_HANDLE), clock, 0.0, 0.0, True)
