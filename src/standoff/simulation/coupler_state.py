"""What a virtual coupler knows from one tick to the next, as a value."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from standoff.kernels.dynamics import coupler_arrays as K
from standoff.simulation.device import Fault, HandleMotion
from standoff.simulation.passivity_observer import PortEnergy
from standoff.simulation.wrench import Wrench
from standoff.typing import Array

NO_WRENCH = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


class CouplerCounts(NamedTuple):
    """How often a coupler did what its user should know about, since its start.

    Attributes
    ----------
    ticks : int
    engaged : int
        Ticks with the coupler engaged.
    repeated : int
        Readings that came twice, because there was no newer one.
    skipped : int
        Readings that never came, by their sequence numbers.
    force_limits, torque_limits : int
        Ticks in which the greatest force or torque limited.
    force_rises, torque_rises : int
        Ticks in which the greatest rate of force or torque limited.
    controlled : int
        Ticks in which the passivity controller damped.
    control_limits : int
        Those in which it was not allowed to damp enough.
    slow : int
        Ticks longer than the period for which passivity was checked.
    faults : int
        How often it let go.
    """

    ticks: int = 0
    engaged: int = 0
    repeated: int = 0
    skipped: int = 0
    force_limits: int = 0
    torque_limits: int = 0
    force_rises: int = 0
    torque_rises: int = 0
    controlled: int = 0
    control_limits: int = 0
    slow: int = 0
    faults: int = 0


class CouplerState(NamedTuple):
    """The running state of a `VirtualCoupler`: goes into a tick, and a new one comes out.

    Attributes
    ----------
    engaged : bool
        Whether it renders a wrench.
    fault : Fault
        Why it let go last; `Fault.NONE` while it is engaged, and before it ever was.
    ramp : float
        From 0, just engaged, to 1: the share of stiffness and damping in use.
    energy : PortEnergy
        Since it was engaged.
    counts : CouplerCounts
    clock : float
        Its own clock [s], used where a tick is given no `now`; nan before the first reading.
    time, sequence : float, int
        Of the last reading; nan and -1 where there is none since it was engaged.
    handle, tool : HandleMotion or None
        Where they were last.
    on_device, on_tool : tuples of six floats
        The wrenches of the last tick, force first [N, N m].
    held : tuple of tuples of six floats
        Those on the handle whose work is still to be seen, oldest first: one, and one more for
        each tick of delay.
    damped : float
        Lost in the coupler's damper since it was engaged [J].
    stored : float
        In its springs at the last tick [J]; of a spring at its greatest force, what it gives back.
    """

    engaged: bool = False
    fault: Fault = Fault.NONE
    ramp: float = 0.0
    energy: PortEnergy = PortEnergy()
    counts: CouplerCounts = CouplerCounts()
    clock: float = math.nan
    time: float = math.nan
    sequence: int = -1
    handle: HandleMotion | None = None
    tool: HandleMotion | None = None
    on_device: tuple[float, ...] = NO_WRENCH
    on_tool: tuple[float, ...] = NO_WRENCH
    held: tuple[tuple[float, ...], ...] = ()
    damped: float = 0.0
    stored: float = 0.0

    @property
    def wrench_on_device(self) -> Wrench:
        """The wrench of the last tick on the handle."""
        return Wrench.from_checked(self.on_device)

    @property
    def wrench_on_tool(self) -> Wrench:
        """The wrench of the last tick on the tool."""
        return Wrench.from_checked(self.on_tool)


def packed_state(state: CouplerState, held: int) -> Array:
    """Return a state as the kernels keep it, with room for some wrenches on the handle."""
    row = np.zeros(K.C_HELD + 6 * held)
    row[: K.C_SEEN] = (
        *(state.engaged, state.fault, state.ramp),
        *(state.clock, state.time, state.sequence),
    )
    row[K.C_DEVICE : K.C_COUNTS] = (*state.energy, state.damped, state.stored)
    row[K.C_COUNTS : K.C_HANDLE] = state.counts
    if state.handle is not None and state.tool is not None:
        row[K.C_SEEN] = 1.0
        for at, seen in ((K.C_HANDLE, state.handle), (K.C_TOOL, state.tool)):
            row[at : at + 18] = (*seen.R, *seen.p, *seen.v, *seen.omega)
    row[K.C_ON_DEVICE : K.C_ON_TOOL] = state.on_device
    row[K.C_ON_TOOL : K.C_HELD] = state.on_tool
    for number, wrench in enumerate(state.held):
        row[K.C_HELD + 6 * number : K.C_HELD + 6 * number + 6] = wrench
    return row


def unpacked_state(row: Array) -> CouplerState:
    """Return the state that stands in a row of the kernels."""
    x = row.tolist()
    engaged, seen = x[K.C_ENGAGED] > 0.0, x[K.C_SEEN] > 0.0
    held = range(K.C_HELD, len(x), 6) if engaged else range(0)
    return CouplerState(
        engaged=engaged,
        fault=Fault(int(x[K.C_FAULT])),
        ramp=x[K.C_RAMP],
        energy=PortEnergy(*x[K.C_DEVICE : K.C_DAMPED]),
        counts=CouplerCounts(*map(int, x[K.C_COUNTS : K.C_HANDLE])),
        clock=x[K.C_CLOCK],
        time=x[K.C_TIME],
        sequence=int(x[K.C_SEQUENCE]),
        handle=_seen(x[K.C_HANDLE : K.C_TOOL]) if seen else None,
        tool=_seen(x[K.C_TOOL : K.C_ON_DEVICE]) if seen else None,
        on_device=tuple(x[K.C_ON_DEVICE : K.C_ON_TOOL]),
        on_tool=tuple(x[K.C_ON_TOOL : K.C_HELD]),
        held=tuple(tuple(x[k : k + 6]) for k in held),
        damped=x[K.C_DAMPED],
        stored=x[K.C_STORED],
    )


def _seen(x: list[float]) -> HandleMotion:
    return HandleMotion(tuple(x[:9]), tuple(x[9:12]), tuple(x[12:15]), tuple(x[15:18]))
