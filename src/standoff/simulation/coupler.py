"""The virtual coupler: a spring and damper between a haptic device and a simulated tool."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Any, Final

import numpy as np

from standoff.checks.numbers import not_negative, number, positive
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffTypeError
from standoff.kernels.compiler.entry import Entry
from standoff.kernels.dynamics import coupler_arrays as K
from standoff.kernels.entries.simulation import couple_once
from standoff.motion.pose import PoseLike
from standoff.motion.twist import TwistLike
from standoff.simulation.arrivals import motion_row, reading_row
from standoff.simulation.coupler_state import (
    NO_WRENCH,
    CouplerState,
    packed_state,
    unpacked_state,
)
from standoff.simulation.device import DeviceReading, Fault, read_motion
from standoff.simulation.passivity import Sampling, check_passive
from standoff.simulation.passivity_observer import PassivityController
from standoff.simulation.wrench import Wrench
from standoff.typing import Array

LET_GO_ANGLE: Final = K.LET_GO_ANGLE
"""Radian between handle and tool, at which the coupler lets go."""

LOST: Final = np.full(18, math.nan)
"""In place of the pose and twist of a tool that has none."""

SLOW: Final = 1.1
"""No unit. A tick longer by this factor than the period for which passivity was checked is counted:
clocks of common systems are late by some hundredths of a millisecond."""


ABOVE_ZERO = ("max_force", "max_age", "max_force_rate", "max_torque_rate")


@dataclass(frozen=True, kw_only=True)
class VirtualCoupler:
    """A spring and damper in six degrees of freedom between a device's handle and a tool.

    The force ``K (p_d − p_t) + B (v_d − v_t)`` acts on the tool at its origin, and the torque ``K_r
    log(R_d R_tᵀ) + B_r (ω_d − ω_t)`` about it; the opposite acts on the handle at its own origin
    (Colgate, Stanley and Brown, IROS 1995). All vectors are along the world's axes. So none of the
    six axes gives back more than its spring took, whatever the others do, and a device with three
    axes needs a rotational stiffness and damping of 0.

    The rotation is the shorter one, of any angle below π; at `LET_GO_ANGLE` the coupler lets go.

    A coupler never changes: what changes is a `CouplerState`, which goes into `step` and comes out.
    Until it is engaged, and from the first tick with a fault on until it is engaged again, both
    wrenches are zero.

    Raises StandoffError: a number that is not finite (rates may be infinite), or below zero; a
    greatest force, rate or age of zero. Raises PassivityError: a stiffness or damping beyond what
    the device keeps passive; the error has the largest stiffness.

    Parameters
    ----------
    stiffness : float
        K [N/m]
    damping : float
        B [N s/m]
    rotational_stiffness : float
        K_r [N m/rad]
    rotational_damping : float
        B_r [N m s/rad]
    max_force : float
        Greatest force [N].
    max_torque : float
        Greatest torque [N m]; above zero where there is a rotational stiffness or damping.
    max_force_rate, max_torque_rate : float
        Greatest rate at which force and torque grow [N/s, N m/s]. They fall as fast as the spring
        says: a force that outlasts its spring would push.
    engage_time : float
        Time in which stiffness and damping grow from 0 once it is engaged [s].
    max_age : float
        Greatest age of a reading, and the most by which it may be ahead of the clock [s].
    sampling : Sampling, optional
        Of the loop and the device. With it, a stiffness and damping that would not be passive are
        refused (see `standoff.simulation.passivity`), and the device's friction is part of the
        account of energy.
    controller : PassivityController, optional
        Damps at run time while more energy came out than went in.
    """

    stiffness: float
    damping: float
    rotational_stiffness: float = 0.0
    rotational_damping: float = 0.0
    max_force: float
    max_torque: float = 0.0
    max_force_rate: float = math.inf
    max_torque_rate: float = math.inf
    engage_time: float = 0.2
    max_age: float
    sampling: Sampling | None = None
    controller: PassivityController | None = None

    def __post_init__(self) -> None:
        for field in fields(self):
            name, value = field.name, getattr(self, field.name)
            if name in ("sampling", "controller"):
                kind = Sampling if name == "sampling" else PassivityController
                if value is not None and not isinstance(value, kind):
                    raise StandoffTypeError(
                        f"{name} is {shown(value)}: give a {kind.__name__}, or None", name, value
                    )
            elif name in ABOVE_ZERO:
                checked = positive(value, name, infinite=name.endswith("_rate"))
                object.__setattr__(self, name, checked)
            else:
                object.__setattr__(self, name, not_negative(value, name))
        turns = self.rotational_stiffness > 0.0 or self.rotational_damping > 0.0
        if turns:
            positive(self.max_torque, "max_torque")
        if self.sampling is not None:
            check_passive(self.stiffness, self.damping, self.sampling, of="translation")
            if turns:
                check_passive(
                    self.rotational_stiffness,
                    self.rotational_damping,
                    self.sampling,
                    of="rotation",
                )
        if isinstance(couple_once, Entry):  # a plain function under NUMBA_DISABLE_JIT=1
            couple_once.prepare()

    def start(self) -> CouplerState:
        """Return the state before the first tick: not engaged.

        Returns
        -------
        CouplerState
        """
        return CouplerState()

    def engage(self, state: CouplerState) -> CouplerState:
        """Return the state from which the coupler renders its wrench, growing from zero.

        The account of energy starts again. A state that is engaged is returned as it is.

        Raises StandoffTypeError if that is not a `CouplerState`.
        """
        _check_state(state)
        if state.engaged:
            return state
        ramp, held = 1.0 if self.engage_time == 0.0 else 0.0, (NO_WRENCH,) * self.past
        return CouplerState(engaged=True, ramp=ramp, counts=state.counts, held=held)

    def disengage(self, state: CouplerState) -> CouplerState:
        """Return the state that renders no wrench until it is engaged; this is no fault.

        Raises StandoffTypeError if that is not a `CouplerState`.
        """
        _check_state(state)
        return CouplerState(fault=state.fault, counts=state.counts)

    def step(
        self,
        state: CouplerState,
        reading: DeviceReading | None,
        tool_pose: PoseLike,
        tool_twist: TwistLike,
        dt: float,
        *,
        now: float | None = None,
    ) -> tuple[CouplerState, Wrench, Wrench]:
        """Take one tick: from where handle and tool are to the wrenches held until the next.

        Raises StandoffError: a `dt` that is not above zero, a `now` that is not finite, or an
        invalid state: a fault of the calling program, raised before anything is changed.

        Parameters
        ----------
        state : CouplerState
        reading : DeviceReading or None
            The device's newest sample; None where it has none, or is gone. Whatever is wrong with
            it, no exception is raised: the wrenches are zero from this tick on, and `state.fault`
            says why.
        tool_pose : Pose or what `Pose.of` reads
            In the world; an invalid pose, or one that is not finite, is a fault too.
        tool_twist : Twist or what `Twist.of` reads
        dt : float
            Time since the last tick [s].
        now : float, optional
            The time [s] on the clock of the readings, by which their age is judged. Without it the
            coupler's own clock is used: the time of the first reading after it was engaged, plus
            `dt` for each tick.

        Returns
        -------
        state : CouplerState
        on_device, on_tool : Wrench
            To be held on the handle and on the tool.
        """
        _check_state(state)
        seconds = positive(dt, "dt")
        clock = math.nan if now is None else number(now, "now")
        tool = read_motion(tool_pose, tool_twist)
        numbers = LOST if isinstance(tool, Fault) else motion_row(tool)
        data = packed_state(state, self.past)
        couple_once(self.packed, data, reading_row(reading), numbers, seconds, clock)
        after = unpacked_state(data)
        return after, after.wrench_on_device, after.wrench_on_tool

    @property
    def past(self) -> int:
        """Wrenches on the handle whose work is still to be seen: one, and one a tick of delay."""
        return 1 if self.sampling is None else self.sampling.delay + 1

    @property
    def packed(self) -> Array:
        """What the kernels read, laid out in ``standoff.kernels.dynamics.coupler_arrays``."""
        sampling, controller = self.sampling, self.controller
        row = np.zeros(K.N_COUPLER)
        row[: K.Q_LAG] = (
            *(self.stiffness, self.damping, self.rotational_stiffness, self.rotational_damping),
            *(self.max_force, self.max_torque, self.max_force_rate, self.max_torque_rate),
            *(self.engage_time, self.max_age),
        )
        row[K.Q_SLOW], row[K.Q_HELD] = math.inf, self.past
        if sampling is not None:
            row[K.Q_LAG] = sampling.velocity_time_constant
            row[K.Q_SLOW] = SLOW * sampling.period
            row[K.Q_FRICTION] = sampling.device_damping
            row[K.Q_TURN_FRICTION] = sampling.device_rotational_damping
        if controller is not None:
            row[K.Q_CONTROLLED : K.Q_HELD] = (
                *(1.0, controller.tolerance),
                *(controller.max_damping, controller.max_rotational_damping),
                *(controller.max_tool_damping, controller.max_tool_rotational_damping),
            )
        row.flags.writeable = False
        return row


def _check_state(state: Any) -> None:
    if not isinstance(state, CouplerState):
        raise StandoffTypeError(
            f"state is {shown(state)}: give the state that start, engage or the last step returned",
            "state",
            state,
        )
