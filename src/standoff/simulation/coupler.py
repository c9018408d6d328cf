"""The virtual coupler: a spring and damper between a haptic device and a simulated tool."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Any, Final

from standoff.errors import StandoffTypeError
from standoff.motion import inputs
from standoff.motion.pose import PoseLike
from standoff.motion.twist import TwistLike
from standoff.real_numbers import shown
from standoff.simulation.arrivals import Arrival, arrived
from standoff.simulation.coupler_state import NO_WRENCH, CouplerState
from standoff.simulation.device import STILL, DeviceReading, Fault, Seen, read_motion
from standoff.simulation.passivity import Sampling, check_passive, non_negative
from standoff.simulation.passivity_observer import PassivityController
from standoff.simulation.six_axes import (
    Vector,
    combined,
    difference,
    dot,
    limited,
    rotation_error,
)
from standoff.simulation.wrench import Wrench

LET_GO_ANGLE: Final = 3.0
"""Radian between handle and tool, at which the coupler lets go. At π the shorter way round changes
its side, and the torque would turn round. To cross what is left from one tick to the next, 0.28
rad, a hand would have to turn at 280 rad/s at 1 kHz; it reaches 20."""

SLOW: Final = 1.1
"""No unit. A tick longer by this factor than the period for which passivity was checked is
counted: clocks of common systems are late by some hundredths of a millisecond."""


@dataclass(frozen=True, kw_only=True)
class VirtualCoupler:
    """A spring and damper in six degrees of freedom between a device's handle and a tool.

    On the tool act, at its origin, ``K (p_d − p_t) + B (v_d − v_t)`` and, about it,
    ``K_r log(R_d R_tᵀ) + B_r (ω_d − ω_t)``; on the handle, at its own origin, the opposite
    (Colgate, Stanley and Brown, IROS 1995). All vectors are along the world's axes. So each of the
    six axes takes no more than the spring gave, whatever the others do, and a device with three
    axes is served with a rotational stiffness and damping of 0.

    The rotation is the shorter one, of any angle below π; at `LET_GO_ANGLE` the coupler lets go.

    A coupler never changes: what runs is a `CouplerState`, which goes into `step` and comes out.
    Until it is engaged, and from the first tick with a fault on until it is engaged again, both
    wrenches are zero.

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
        Greatest age of a reading, and the most that it may be ahead of the clock [s].
    sampling : Sampling, optional
        Of the loop and the device. With it a stiffness and damping that would not be passive are
        refused (see `standoff.simulation.passivity`), and the device's friction is part of the
        account of energy.
    controller : PassivityController, optional
        Damps at run time while more energy came out than went in.

    Raises
    ------
    StandoffError
        A number that is not finite (rates may be infinite), or below zero; a greatest force, rate
        or age of zero.
    PassivityError
        A stiffness or damping beyond what the device keeps passive: it has the largest stiffness.
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
        positive = {"max_force", "max_age", "max_force_rate", "max_torque_rate"}
        for field in fields(self):
            name, value = field.name, getattr(self, field.name)
            if name in ("sampling", "controller"):
                kind = Sampling if name == "sampling" else PassivityController
                if value is not None and not isinstance(value, kind):
                    raise StandoffTypeError(
                        f"{name} is {shown(value)}: give a {kind.__name__}, or None", name, value
                    )
            elif not (name.endswith("_rate") and isinstance(value, float) and value == math.inf):
                checked = non_negative(value, name, above_zero=name in positive)
                object.__setattr__(self, name, checked)
        turns = self.rotational_stiffness > 0.0 or self.rotational_damping > 0.0
        non_negative(self.max_torque, "max_torque", above_zero=turns)
        if self.sampling is not None:
            check_passive(self.stiffness, self.damping, self.sampling, of="translation")
            if turns:
                check_passive(
                    self.rotational_stiffness,
                    self.rotational_damping,
                    self.sampling,
                    of="rotation",
                )

    def start(self) -> CouplerState:
        """Return the state before the first tick: not engaged.

        Returns
        -------
        CouplerState
        """
        return CouplerState()

    def engage(self, state: CouplerState) -> CouplerState:
        """Return the state from which the coupler renders its wrench, growing from zero.

        The account of energy begins anew. A state that is engaged is returned as it is.

        Raises
        ------
        StandoffTypeError
            If that is no `CouplerState`.
        """
        _check_state(state)
        if state.engaged:
            return state
        past = 1 if self.sampling is None else self.sampling.delay + 1
        ramp = 1.0 if self.engage_time == 0.0 else 0.0
        return CouplerState(engaged=True, ramp=ramp, counts=state.counts, held=(NO_WRENCH,) * past)

    def disengage(self, state: CouplerState) -> CouplerState:
        """Return the state that renders no wrench until it is engaged; this is no fault.

        Raises
        ------
        StandoffTypeError
            If that is no `CouplerState`.
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

        Parameters
        ----------
        state : CouplerState
        reading : DeviceReading or None
            The device's newest sample; None where it has none, or is gone. Whatever is wrong with
            it, no exception is raised: the wrenches are zero from this tick on, and `state.fault`
            says why.
        tool_pose : Pose or what `Pose.of` reads
            In the world; a pose that is none, or not finite, is a fault too.
        tool_twist : Twist or what `Twist.of` reads
        dt : float
            Time since the last tick [s].
        now : float, optional
            The time [s] on the clock of the readings, by which their age is judged. Without it the
            coupler's own clock serves: the time of the first reading after it was engaged, and
            `dt` on with each tick.

        Returns
        -------
        state : CouplerState
        on_device, on_tool : Wrench
            To be held on the handle and on the tool.

        Raises
        ------
        StandoffError
            A `dt` that is not above zero, a `now` that is not finite, or a state that is none: a
            fault of the calling program, before anything is changed.
        """
        _check_state(state)
        seconds = non_negative(dt, "dt", above_zero=True)
        clock = None if now is None else inputs.number(now, "now")
        slow = self.sampling is not None and seconds > SLOW * self.sampling.period
        counts = state.counts._replace(
            ticks=state.counts.ticks + 1,
            engaged=state.counts.engaged + state.engaged,
            slow=state.counts.slow + slow,
        )
        state = state._replace(counts=counts)
        if not state.engaged:
            return state, Wrench.zero(), Wrench.zero()
        lag = 0.0 if self.sampling is None else self.sampling.velocity_time_constant
        known = state.clock + seconds if clock is None else clock
        handle = arrived(state, reading, known, self.max_age, lag)
        tool = read_motion(tool_pose, tool_twist)
        if isinstance(handle, Fault):
            state = _let_go(state, handle)
        elif isinstance(tool, Fault):
            state = _let_go(state, Fault.TOOL)
        else:
            state = self._coupled(self._accounted(state, handle, tool), seconds)
        return state, state.wrench_on_device, state.wrench_on_tool

    def _accounted(self, state: CouplerState, arrival: Arrival, tool: Seen) -> CouplerState:
        """The state with a reading taken in, and the work of the last tick in its account."""
        energy, counts, handle = state.energy, state.counts, arrival.handle
        if state.handle is not None and state.tool is not None:
            way = difference(handle.p, state.handle.p)
            turn = rotation_error(handle.R, state.handle.R)
            friction = 0.0
            if self.sampling is not None and not arrival.repeated:
                friction = self.sampling.device_damping * dot(way, way)
                friction += self.sampling.device_rotational_damping * dot(turn, turn)
                friction /= arrival.elapsed
            held = state.held[0]
            way_of_tool = difference(tool.p, state.tool.p)
            turn_of_tool = rotation_error(tool.R, state.tool.R)
            energy = energy.after(
                -dot(held[:3], way) - dot(held[3:], turn),
                -dot(state.on_tool[:3], way_of_tool) - dot(state.on_tool[3:], turn_of_tool),
                friction,
            )
            counts = counts._replace(
                repeated=counts.repeated + arrival.repeated,
                skipped=counts.skipped + arrival.skipped,
            )
        return state._replace(
            energy=energy,
            counts=counts,
            clock=arrival.clock,
            time=arrival.time,
            sequence=arrival.sequence,
            handle=handle,
            tool=tool,
        )

    def _coupled(self, state: CouplerState, dt: float) -> CouplerState:
        """The state with the wrenches of a tick, from where handle and tool are in it."""
        handle, tool = state.handle, state.tool
        assert handle is not None
        assert tool is not None
        turn = rotation_error(handle.R, tool.R)
        if (self.rotational_stiffness > 0.0 or self.rotational_damping > 0.0) and (
            dot(turn, turn) > LET_GO_ANGLE**2
        ):
            return _let_go(state, Fault.HALF_TURN)
        spring = _spring_and_damper(
            state.ramp,
            (self.stiffness, difference(handle.p, tool.p)),
            (self.damping, difference(handle.v, tool.v)),
        )
        twisting = _spring_and_damper(
            state.ramp,
            (self.rotational_stiffness, turn),
            (self.rotational_damping, difference(handle.omega, tool.omega)),
        )
        counts = state.counts
        at_device: tuple[Vector, Vector] = (STILL, STILL)
        at_tool: tuple[Vector, Vector] = (STILL, STILL)
        if self.controller is not None:
            missing = -state.energy.observed - self.controller.tolerance
            if missing > 0.0:
                moving = (handle.v, handle.omega), (tool.v, tool.omega)
                at_device, at_tool, short = self.controller.damped(missing, *moving, dt)
                counts = counts._replace(
                    controlled=counts.controlled + 1, control_limits=counts.control_limits + short
                )
        on_device, limits = self._within_limits(
            (
                combined(-1.0, spring, 1.0, at_device[0]),
                combined(-1.0, twisting, 1.0, at_device[1]),
            ),
            state.on_device,
            dt,
        )
        on_tool, more = self._within_limits(
            (combined(1.0, spring, 1.0, at_tool[0]), combined(1.0, twisting, 1.0, at_tool[1])),
            state.on_tool,
            dt,
        )
        force, rise, torque, torque_rise = (a or b for a, b in zip(limits, more, strict=True))
        grown = 1.0 if self.engage_time == 0.0 else state.ramp + dt / self.engage_time
        return state._replace(
            ramp=min(1.0, grown),
            on_device=on_device,
            on_tool=on_tool,
            held=(*state.held[1:], on_device),
            counts=counts._replace(
                force_limits=counts.force_limits + force,
                force_rises=counts.force_rises + rise,
                torque_limits=counts.torque_limits + torque,
                torque_rises=counts.torque_rises + torque_rise,
            ),
        )

    def _within_limits(
        self, wanted: tuple[Vector, Vector], last: Vector, dt: float
    ) -> tuple[Vector, tuple[bool, bool, bool, bool]]:
        """Six numbers within the limits, and what limited: force, its rise, torque, its rise."""
        force, *of_force = limited(wanted[0], last[:3], self.max_force, self.max_force_rate * dt)
        torque, *of_torque = limited(
            wanted[1], last[3:], self.max_torque, self.max_torque_rate * dt
        )
        return force + torque, (of_force[0], of_force[1], of_torque[0], of_torque[1])


def _spring_and_damper(
    share: float, spring: tuple[float, Vector], damper: tuple[float, Vector]
) -> Vector:
    """A share of stiffness times displacement plus damping times its rate."""
    return combined(share * spring[0], spring[1], share * damper[0], damper[1])


def _let_go(state: CouplerState, fault: Fault) -> CouplerState:
    """The state of a coupler that a fault has disengaged; the account of energy stays readable."""
    counts = state.counts._replace(faults=state.counts.faults + 1)
    return CouplerState(fault=fault, counts=counts, energy=state.energy)


def _check_state(state: Any) -> None:
    if not isinstance(state, CouplerState):
        raise StandoffTypeError(
            f"state is {shown(state)}: give the state that start, engage or the last step returned",
            "state",
            state,
        )
