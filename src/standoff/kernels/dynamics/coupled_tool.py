"""The virtual coupler within a system: the tool as it sees it, and its wrench among the loads."""

from standoff.kernels.algebra.rigid import read_vector
from standoff.kernels.algebra.vectors import add, dot
from standoff.kernels.compiler.decorators import ahead, kernel
from standoff.kernels.dynamics.arrays import (
    I_READING,
    I_TOOL,
    N_BODY,
    N_LOAD,
    S_GIVEN,
    body_row,
    coupler_row,
)
from standoff.kernels.dynamics.coupler import Moment, couple, put_motion, stored_in
from standoff.kernels.dynamics.coupler_arrays import C_ON_TOOL, N_READING
from standoff.kernels.dynamics.rigid_body import load, pose_and_twist, put
from standoff.kernels.values import Motion, Pose


@kernel
def coupled(system):
    """Is one of the bodies the tool of a coupler?"""
    return system.layout[I_TOOL] >= 0


@kernel
def tool_motion(system, rows, first):
    """The tool's pose and the twist of its origin, world."""
    tool = system.layout[I_TOOL]
    R, p, v, w = pose_and_twist(system, tool, rows, first + N_BODY * tool)
    return Motion(Pose(R, p), v, w)


@kernel
def pull_tool(system, state, drives, tick, h, scratch):
    """The coupler's part of a tick: its wrenches, by a reading if one is due.

    Their clock is nan if the coupler's own is used.
    """
    every = system.layout[I_READING]
    row = N_READING * min(tick // every, drives.count - 1)
    moment = Moment(h, drives.clock, tick % every == 0, every * h)
    put_motion(tool_motion(system, state, body_row(0)), scratch.motion, 0)
    own = ahead(state, coupler_row(system))
    couple(system.coupler, own, ahead(drives.readings, row), scratch.motion, moment)


@kernel
def add_pull(system, state, rows, first, loads):
    """The coupler's wrench on the tool, at its origin as it stands in some rows, to the loads."""
    tool = system.layout[I_TOOL]
    o = coupler_row(system) + C_ON_TOOL
    origin = tool_motion(system, rows, first).pose.p
    load(system, tool, rows, first + N_BODY * tool, origin, read_vector(state, o), loads)
    torque = add(read_vector(loads, N_LOAD * tool + 3), read_vector(state, o + 3))
    put(torque, loads, N_LOAD * tool + 3)


@kernel
def power_of_pull(system, state):
    """What the coupler's wrench gives the tool a second, in the state."""
    o = coupler_row(system) + C_ON_TOOL
    tool = tool_motion(system, state, body_row(0))
    return dot(read_vector(state, o), tool.v) + dot(read_vector(state, o + 3), tool.w)


@kernel
def book_pull(system, state, h, before):
    """The work of the held wrench over a tick: by the mean power, as its force is constant."""
    state[S_GIVEN] += 0.5 * h * (before + power_of_pull(system, state))


@kernel
def stored_in_coupler(system, state):
    """Energy in the coupler's springs."""
    tool = tool_motion(system, state, body_row(0))
    return stored_in(system.coupler, ahead(state, coupler_row(system)), tool)
