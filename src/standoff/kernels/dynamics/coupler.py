"""The virtual coupler's law, one tick of it: spring and damper, limits, faults, energies.

Its own state alone is changed. The device is held by a wrench from reading to reading, the tool by
one from tick to tick; where every tick has its reading, as in a loop with a device, they are one.
"""

from __future__ import annotations

from math import isnan, sqrt
from typing import Any, NamedTuple

from standoff.kernels.algebra.rigid import read_vector
from standoff.kernels.algebra.vectors import add, axpy, dot, scale, sub
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.dynamics.coupler_arrays import (
    C_CLOCK,
    C_COUNTS,
    C_DAMPED,
    C_DEVICE,
    C_ENGAGED,
    C_FAULT,
    C_GIVEN,
    C_HANDLE,
    C_HELD,
    C_LEAST,
    C_ON_DEVICE,
    C_ON_TOOL,
    C_RAMP,
    C_RUBBED,
    C_SEEN,
    C_SEQUENCE,
    C_STORED,
    C_TIME,
    C_TOOL,
    G_SEQUENCE,
    G_TIME,
    HALF_TURN,
    K_CONTROL_LIMITS,
    K_CONTROLLED,
    K_ENGAGED,
    K_FAULTS,
    K_FORCE_LIMITS,
    K_FORCE_RISES,
    K_REPEATED,
    K_SKIPPED,
    K_SLOW,
    K_TICKS,
    K_TORQUE_LIMITS,
    K_TORQUE_RISES,
    LET_GO_ANGLE,
    NO_FAULT,
    Q_AT_HANDLE,
    Q_AT_TOOL,
    Q_CONTROLLED,
    Q_DAMPING,
    Q_ENGAGE,
    Q_FORCE,
    Q_FORCE_RATE,
    Q_FRICTION,
    Q_HELD,
    Q_SLOW,
    Q_STIFFNESS,
    Q_TOLERANCE,
    Q_TORQUE,
    Q_TORQUE_RATE,
    Q_TURN_AT_HANDLE,
    Q_TURN_AT_TOOL,
    Q_TURN_DAMPING,
    Q_TURN_FRICTION,
    Q_TURN_STIFFNESS,
    TOOL,
)
from standoff.kernels.dynamics.coupler_arrival import (
    all_finite,
    arrived,
    motion_at,
    rotation_error,
    standing,
)


class Moment(NamedTuple):
    """When a tick is."""

    dt: float  # since the last tick
    clock: float  # time now on the clock of the readings, nan where the coupler's own serves
    fresh: bool  # a reading comes with this tick, and its wrench on the handle is written
    span: float  # time since a wrench on the handle was written last


class Asked(NamedTuple):
    """Force and torque that spring, damper and controller ask for, at the handle or the tool."""

    force: Any
    torque: Any


@kernel
def limited(wanted, last, most, rise):
    """Return the part of a vector that its limits allow; did its size, did its rise limit it?

    The answer is λ `wanted` with λ from 0 to 1: it never turns round, and never exceeds what was
    wanted. Of those not longer than `most` it is the longest within `rise` of `last`; where none
    is, the one nearest to `last`. So only rises are limited: to hold on to a force that the spring
    no longer has would push, and to approach one of the other sign slowly would push backwards.
    """
    squared = wanted[0] * wanted[0] + wanted[1] * wanted[1] + wanted[2] * wanted[2]
    length = sqrt(squared)
    if length == 0.0:
        return (0.0, 0.0, 0.0), False, False
    largest = most / length if length > most else 1.0
    along = wanted[0] * last[0] + wanted[1] * last[1] + wanted[2] * last[2]
    before = last[0] * last[0] + last[1] * last[1] + last[2] * last[2]
    reach = along * along - squared * (before - rise * rise)
    share = along / squared
    if reach > 0.0:
        share += sqrt(reach) / squared
    slewed = share < largest
    share = min(max(share, 0.0), largest)
    return (share * wanted[0], share * wanted[1], share * wanted[2]), largest < 1.0, slewed


@kernel
def put_vector(x, to, o):
    to[o], to[o + 1], to[o + 2] = x[0], x[1], x[2]


@kernel
def put_motion(motion, to, o):
    for k in range(9):
        to[o + k] = motion.pose.R[k]
    put_vector(motion.pose.p, to, o + 9)
    put_vector(motion.v, to, o + 12)
    put_vector(motion.w, to, o + 15)


@kernel
def let_go(coupler, state, fault):
    """No wrench from now on; counts and the account of energy stay readable."""
    state[C_ENGAGED], state[C_RAMP], state[C_SEEN], state[C_STORED] = 0.0, 0.0, 0.0, 0.0
    state[C_FAULT] = fault
    state[C_CLOCK], state[C_TIME], state[C_SEQUENCE] = float("nan"), float("nan"), -1.0
    for k in range(12 + 6 * int(coupler[Q_HELD])):
        state[C_ON_DEVICE + k] = 0.0
    state[C_COUNTS + K_FAULTS] += 1.0


@kernel
def account(coupler, state, arrival, tool):
    """The work of the last tick at both ports, and what the device's own friction took at least."""
    handle = motion_at(state, C_HANDLE)
    before = motion_at(state, C_TOOL)
    into_device, friction = 0.0, 0.0
    if not arrival.repeated:
        way = sub(arrival.handle.pose.p, handle.pose.p)
        turn = rotation_error(arrival.handle.pose.R, handle.pose.R)
        friction = coupler[Q_FRICTION] * dot(way, way)
        friction += coupler[Q_TURN_FRICTION] * dot(turn, turn)
        friction /= arrival.elapsed
        into_device = -dot(read_vector(state, C_HELD), way)
        into_device -= dot(read_vector(state, C_HELD + 3), turn)
    way = sub(tool.pose.p, before.pose.p)
    turn = rotation_error(tool.pose.R, before.pose.R)
    into_tool = -dot(read_vector(state, C_ON_TOOL), way)
    into_tool -= dot(read_vector(state, C_ON_TOOL + 3), turn)
    state[C_DEVICE] += into_device
    state[C_GIVEN] += into_tool
    state[C_RUBBED] += friction
    observed = state[C_DEVICE] + state[C_GIVEN] + state[C_RUBBED]
    state[C_LEAST] = min(state[C_LEAST], observed)


@kernel
def take_in(state, reading, arrival, tool, fresh):
    """Handle, tool and stamp as they are now."""
    if fresh:
        state[C_COUNTS + K_REPEATED] += 1.0 if arrival.repeated else 0.0
        state[C_COUNTS + K_SKIPPED] += arrival.skipped
        state[C_TIME], state[C_SEQUENCE] = reading[G_TIME], reading[G_SEQUENCE]
        put_motion(arrival.handle, state, C_HANDLE)
    state[C_CLOCK] = arrival.clock
    put_motion(tool, state, C_TOOL)
    state[C_SEEN] = 1.0


@kernel
def damped_port(missing, motion, linear, turning, dt):
    """Force and torque of a damper that dissipates what is missing, and what is still missing
    afterwards."""
    able = (linear * dot(motion.v, motion.v) + turning * dot(motion.w, motion.w)) * dt
    share = 0.0 if able == 0.0 else min(1.0, missing / able)
    asked = Asked(scale(-share * linear, motion.v), scale(-share * turning, motion.w))
    return asked, (0.0 if missing <= able else missing - able)


@kernel
def controlled(coupler, state, handle, tool, moment):
    """What the passivity controller asks for at the handle and at the tool."""
    still = Asked((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    if coupler[Q_CONTROLLED] == 0.0:
        return still, still
    observed = state[C_DEVICE] + state[C_GIVEN] + state[C_RUBBED]
    missing = -observed - coupler[Q_TOLERANCE]
    if not missing > 0.0:
        return still, still
    at_handle = still
    if moment.fresh:
        at_handle, missing = damped_port(
            missing, handle, coupler[Q_AT_HANDLE], coupler[Q_TURN_AT_HANDLE], moment.span
        )
    at_tool, missing = damped_port(
        missing, tool, coupler[Q_AT_TOOL], coupler[Q_TURN_AT_TOOL], moment.dt
    )
    state[C_COUNTS + K_CONTROLLED] += 1.0
    state[C_COUNTS + K_CONTROL_LIMITS] += 1.0 if missing > 0.0 else 0.0
    return at_handle, at_tool


@kernel
def held_within(coupler, asked, state, o, dt):
    """Limit a wrench, in place of the last one; what limited it, as four truth values."""
    force, forced, rose = limited(
        asked.force, read_vector(state, o), coupler[Q_FORCE], coupler[Q_FORCE_RATE] * dt
    )
    torque, turned_most, turned_on = limited(
        asked.torque, read_vector(state, o + 3), coupler[Q_TORQUE], coupler[Q_TORQUE_RATE] * dt
    )
    put_vector(force, state, o)
    put_vector(torque, state, o + 3)
    return forced, rose, turned_most, turned_on


@kernel
def spring_energy(stiffness, most, square):
    """What a spring holds at a squared length, whose force is limited."""
    if stiffness * stiffness * square <= most * most:
        return 0.5 * stiffness * square
    return most * (sqrt(square) - 0.5 * most / stiffness)


@kernel
def stored_in(coupler, state, tool):
    """Energy in the coupler's springs with the tool at a motion, the handle where it was read."""
    if state[C_ENGAGED] == 0.0 or state[C_SEEN] == 0.0:
        return 0.0
    handle, ramp = motion_at(state, C_HANDLE), state[C_RAMP]
    way = sub(handle.pose.p, tool.pose.p)
    turn = rotation_error(handle.pose.R, tool.pose.R)
    linear = spring_energy(ramp * coupler[Q_STIFFNESS], coupler[Q_FORCE], dot(way, way))
    twisted = spring_energy(ramp * coupler[Q_TURN_STIFFNESS], coupler[Q_TORQUE], dot(turn, turn))
    return linear + twisted


@kernel
def pull(coupler, state, moment):
    """The wrenches of a tick, from where handle and tool are in the state."""
    handle, tool = motion_at(state, C_HANDLE), motion_at(state, C_TOOL)
    turn = rotation_error(handle.pose.R, tool.pose.R)
    turns = coupler[Q_TURN_STIFFNESS] > 0.0 or coupler[Q_TURN_DAMPING] > 0.0
    if turns and dot(turn, turn) > LET_GO_ANGLE * LET_GO_ANGLE:
        let_go(coupler, state, HALF_TURN)
        return
    ramp = state[C_RAMP]
    way = sub(handle.pose.p, tool.pose.p)
    slip, spin = sub(handle.v, tool.v), sub(handle.w, tool.w)
    force = add(scale(ramp * coupler[Q_STIFFNESS], way), scale(ramp * coupler[Q_DAMPING], slip))
    torque = add(
        scale(ramp * coupler[Q_TURN_STIFFNESS], turn), scale(ramp * coupler[Q_TURN_DAMPING], spin)
    )
    at_handle, at_tool = controlled(coupler, state, handle, tool, moment)
    limits = (False, False, False, False)
    if moment.fresh:
        on_device = Asked(axpy(-1.0, force, at_handle.force), axpy(-1.0, torque, at_handle.torque))
        limits = held_within(coupler, on_device, state, C_ON_DEVICE, moment.span)
    on_tool = Asked(add(force, at_tool.force), add(torque, at_tool.torque))
    more = held_within(coupler, on_tool, state, C_ON_TOOL, moment.dt)
    counts = (K_FORCE_LIMITS, K_FORCE_RISES, K_TORQUE_LIMITS, K_TORQUE_RISES)
    for k in range(4):
        state[C_COUNTS + counts[k]] += 1.0 if limits[k] or more[k] else 0.0
    lost = coupler[Q_DAMPING] * dot(slip, slip) + coupler[Q_TURN_DAMPING] * dot(spin, spin)
    state[C_DAMPED] += ramp * lost * moment.dt
    state[C_STORED] = stored_in(coupler, state, tool)
    engage = coupler[Q_ENGAGE]
    state[C_RAMP] = 1.0 if engage == 0.0 else min(1.0, ramp + moment.dt / engage)


@kernel
def remember(coupler, state):
    """The wrench just written joins those whose work is not yet known; the oldest leaves."""
    last = 6 * (int(coupler[Q_HELD]) - 1)
    for k in range(last):
        state[C_HELD + k] = state[C_HELD + k + 6]
    for k in range(6):
        state[C_HELD + last + k] = state[C_ON_DEVICE + k]


@kernel
def couple(coupler, state, reading, tool_row, moment):
    """One tick: from where handle and tool are to the wrenches held until the next.

    Parameters
    ----------
    coupler, state, reading : arrays, laid out in ``coupler_arrays``
        The state is changed in place; the reading is looked at where the tick has a fresh one.
    tool_row : array
        The tool's pose (12) and twist (6), world.
    moment : Moment
    """
    state[C_COUNTS + K_TICKS] += 1.0
    state[C_COUNTS + K_SLOW] += 1.0 if moment.dt > coupler[Q_SLOW] else 0.0
    if state[C_ENGAGED] == 0.0:
        return
    state[C_COUNTS + K_ENGAGED] += 1.0
    clock = state[C_CLOCK] + moment.dt if isnan(moment.clock) else moment.clock
    arrival = standing(state, clock)
    if moment.fresh:
        arrival = arrived(coupler, state, reading, clock)
    fault = arrival.fault
    if fault == NO_FAULT and not all_finite(tool_row, 0, 18):
        fault = TOOL
    if fault != NO_FAULT:
        let_go(coupler, state, fault)
        return
    tool = motion_at(tool_row, 0)
    if state[C_SEEN] > 0.0:
        account(coupler, state, arrival, tool)
    take_in(state, reading, arrival, tool, moment.fresh)
    pull(coupler, state, moment)
    if moment.fresh and state[C_ENGAGED] > 0.0:
        remember(coupler, state)
