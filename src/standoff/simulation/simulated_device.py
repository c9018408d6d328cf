"""A haptic device that is simulated: mechanism, hand, encoders, delay, and what goes wrong."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from types import TracebackType
from typing import Any, Final, Self

import numpy as np
import scipy

from standoff.checks.numbers import not_negative, positive, whole_number
from standoff.checks.real_numbers import shown
from standoff.errors import DeviceError, StandoffError, StandoffTypeError
from standoff.motion.paths import Path
from standoff.motion.pose import Pose, PoseLike
from standoff.motion.pose_function import path_of
from standoff.motion.rotations import without_rounding
from standoff.motion.twist import Twist
from standoff.simulation.device import (
    STILL,
    DeviceLimits,
    DeviceReading,
    HandleMotion,
    as_numbers,
)
from standoff.simulation.disturbances import Disturbances
from standoff.simulation.encoder import Encoder
from standoff.simulation.human_arm import HumanArm
from standoff.simulation.passivity import LONGEST_DELAY, Sampling
from standoff.simulation.six_axes import Vector, combined, difference, rotation_error, turned_on
from standoff.simulation.wrench import Wrench
from standoff.typing import Array

SQUARED_UP: Final = 1024
"""Samples after which the handle's rotation is made orthonormal again: rounding has left 1e-13."""


@dataclass(frozen=True, kw_only=True)
class Mechanism:
    """What a device's handle feels like with its motors off, the same in all directions.

    Raises StandoffError: a number that is not finite, or below zero; a mass or inertia of zero.

    Parameters
    ----------
    mass : float
        Above zero [kg].
    damping : float
        [N s/m]
    rotational_inertia : float
        Above zero [kg m²].
    rotational_damping : float
        [N m s/rad]
    """

    mass: float
    damping: float
    rotational_inertia: float = 1e-4
    rotational_damping: float = 1e-3

    def __post_init__(self) -> None:
        for name in ("mass", "damping", "rotational_inertia", "rotational_damping"):
            read = positive if name in ("mass", "rotational_inertia") else not_negative
            object.__setattr__(self, name, read(getattr(self, name), name))


@dataclass(frozen=True, kw_only=True)
class ScriptedHand:
    """A hand that holds the handle and tries to follow a path.

    Raises StandoffTypeError: not a path, or no arm.

    Parameters
    ----------
    path : Path or function of the time
        Where the hand tries to have the handle, from time 0 to the last reading.
    arm : HumanArm
        What holds it there.
    """

    path: Path | Callable[[float], PoseLike]
    arm: HumanArm = field(default_factory=HumanArm.relaxed)

    def __post_init__(self) -> None:
        object.__setattr__(self, "path", path_of(self.path))
        if not isinstance(self.arm, HumanArm):
            raise StandoffTypeError(f"arm is {shown(self.arm)}: give a HumanArm", "arm", self.arm)


class SimulatedDevice:
    """A `Device` with a simulated mechanism and hand.

    `read` holds the wrench written last for one period and returns the sample at its end; the first
    `read` returns the sample at time 0. Between samples the motion is exact for the held wrench and
    a path that is straight over a period; a rotation is taken as its vector since the last sample,
    exact about a fixed axis.

    Raises StandoffError: a period that is not above zero, a delay that is not a whole number from 0
    to 20, no pose; a mass too small for damping, stiffness and period. Raises StandoffTypeError: a
    part of the wrong kind.

    Parameters
    ----------
    mechanism : Mechanism
    hand : ScriptedHand, optional
        Without one the handle is free.
    period : float
        Time from sample to sample [s].
    pose : Pose or what `Pose.of` reads, optional
        Where the handle is at first, at rest, and the encoders' zero. The start of the hand's
        path if not given, else the identity.
    encoder : Encoder, optional
    delay : int
        Whole periods by which readings are late, 0 to 20; the device waits for the first one.
    limits : DeviceLimits, optional
        Larger wrenches are limited, as by motors, and counted in `cut`.
    disturbances : Disturbances, optional

    Attributes
    ----------
    limits : DeviceLimits
    hand : ScriptedHand or None
    held : Wrench
        What the motors hold now.
    cut : int
        Wrenches that were beyond the limits.
    """

    def __init__(
        self,
        mechanism: Mechanism,
        hand: ScriptedHand | None = None,
        *,
        period: float,
        pose: PoseLike | None = None,
        encoder: Encoder | None = None,
        delay: int = 0,
        limits: DeviceLimits | None = None,
        disturbances: Disturbances | None = None,
    ) -> None:
        parts: dict[str, tuple[Any, type]] = {
            "mechanism": (mechanism, Mechanism),
            "hand": (hand, ScriptedHand),
        }
        parts |= {"encoder": (encoder, Encoder), "limits": (limits, DeviceLimits)}
        parts |= {"disturbances": (disturbances, Disturbances)}
        for name, (part, kind) in parts.items():
            if not isinstance(part, kind) and (part is not None or name == "mechanism"):
                raise StandoffTypeError(
                    f"{name} is {shown(part)}: give a {kind.__name__}", name, part
                )
        self._mechanism, self.hand = mechanism, hand
        self._period = positive(period, "period")
        self._delay = whole_number(delay, "delay", 0, LONGEST_DELAY)
        self._encoder = encoder or Encoder()
        self._disturbances = (disturbances or Disturbances()).running()
        self.limits = limits or DeviceLimits(max_force=1e6, max_torque=1e6)
        self._path = None if hand is None else path_of(hand.path)
        arm = self._arm = HumanArm.none() if hand is None else hand.arm
        start = Pose.identity() if self._path is None else self._path.pose(0.0)
        self._home = start if pose is None else Pose.of(pose)
        self._linear = HeldMotion(
            mechanism.mass + arm.mass, mechanism.damping + arm.damping, arm.stiffness, self._period
        )
        self._turning = HeldMotion(
            mechanism.rotational_inertia + arm.rotational_inertia,
            mechanism.rotational_damping + arm.rotational_damping,
            arm.rotational_stiffness,
            self._period,
        )
        self._open = False
        self.held, self.cut = Wrench.zero(), 0
        self._moving = as_numbers(self._home, Twist.zero())
        self._pull = self._meant(0.0)
        self._sample, self._reads = 0, 0
        self._measured, self._velocity = self._home, Twist.zero()
        self._waiting: deque[DeviceReading] = deque()

    @property
    def pose(self) -> Pose:
        """Where the handle is, unmeasured."""
        return Pose.from_checked(np.array(self._moving.R).reshape(3, 3), np.array(self._moving.p))

    @property
    def twist(self) -> Twist:
        """How the handle moves, world axes."""
        return Twist.from_checked(np.array(self._moving.v), np.array(self._moving.omega))

    @property
    def sampling(self) -> Sampling:
        """What a `VirtualCoupler` has to know of this device to be passive with it."""
        return Sampling(
            period=self._period,
            device_damping=self._mechanism.damping,
            device_rotational_damping=self._mechanism.rotational_damping,
            delay=self._delay,
            velocity_time_constant=self._encoder.velocity_time_constant,
        )

    @property
    def time(self) -> float:
        """The time of the last sample [s]: the `now` of the loop."""
        return max(self._sample - 1, 0) * self._period

    def open(self) -> None:
        """Connect; the wrench is zero."""
        self._open, self.held = True, Wrench.zero()

    def close(self) -> None:
        """Set the wrench to zero and release the device."""
        self._open, self.held = False, Wrench.zero()

    def __enter__(self) -> Self:
        self.open()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def read(self) -> DeviceReading | None:
        """Hold the wrench for one period, and return the sample that comes at its end.

        Raises DeviceError if the device is not open, or gone.

        Returns
        -------
        DeviceReading or None
            Whatever the `Disturbances` make of it.
        """
        self._check_open()
        self._waiting.append(self._next_sample())
        while len(self._waiting) <= self._delay:
            self._waiting.append(self._next_sample())
        number, self._reads = self._reads, self._reads + 1
        try:
            read: DeviceReading | None = self._disturbances.disturbed(
                number, self._waiting.popleft()
            )
        except DeviceError:
            self.close()
            raise
        return read

    def write(self, wrench: Wrench) -> None:
        """Hold a wrench on the handle until the next.

        Raises DeviceError if the device is not open. Raises StandoffTypeError if that is not a
        `Wrench`.
        """
        self._check_open()
        if not isinstance(wrench, Wrench):
            raise StandoffTypeError(f"wrench is {shown(wrench)}: give a Wrench", "wrench", wrench)
        force, cut_force = _cut(wrench.force, self.limits.max_force)
        torque, cut_torque = _cut(wrench.torque, self.limits.max_torque)
        self.cut += cut_force or cut_torque
        self.held = Wrench(force, torque)

    def _check_open(self) -> None:
        if not self._open:
            raise DeviceError("the device is not open; open it, or use it in a with statement")

    def _next_sample(self) -> DeviceReading:
        """Move on by a period, but for the first, and measure."""
        if self._sample > 0:
            self._move()
        measured = self._encoder.measured(self.pose, self._home)
        if self._sample > 0:
            self._velocity = self._encoder.velocity(
                measured, self._measured, self._velocity, self._period
            )
        self._measured = measured
        twist = self._velocity if self._encoder.velocities else None
        reading = DeviceReading(self._sample * self._period, self._sample, measured, twist)
        self._sample += 1
        return reading

    def _move(self) -> None:
        """The mechanism and the hand over one period, with the wrench held."""
        R, p = self._moving.R, self._moving.p
        first, self._pull = self._pull, self._meant(self._sample * self._period)
        force, torque = tuple(self.held.force.tolist()), tuple(self.held.torque.tolist())
        forces, torques = [], []
        for meant in (first, self._pull):
            arm = self._arm
            way, turn = difference(meant.p, p), rotation_error(meant.R, R)
            pull = combined(arm.stiffness, way, arm.damping, meant.v)
            twist = combined(arm.rotational_stiffness, turn, arm.rotational_damping, meant.omega)
            forces.append(combined(1.0, force, 1.0, pull))
            torques.append(combined(1.0, torque, 1.0, twist))
        way, v = self._linear.after(self._moving.v, *forces)
        turn, omega = self._turning.after(self._moving.omega, *torques)
        R = turned_on(R, turn)
        if self._sample % SQUARED_UP == 0:
            R = tuple(without_rounding(np.array(R).reshape(3, 3)).ravel().tolist())
        self._moving = HandleMotion(R, combined(1.0, p, 1.0, way), v, omega)

    def _meant(self, t: float) -> HandleMotion:
        """Where the hand tries to be; the home position if there is no hand, which pulls at
        nothing."""
        if self._path is None:
            return HandleMotion(self._moving.R, self._moving.p, STILL, STILL)
        pose = self._path.pose(t)
        return as_numbers(pose, self._path.twist(t))


def _cut(vector: Array, most: float) -> tuple[Array, bool]:
    length = math.hypot(*vector.tolist())
    return (vector, False) if length <= most else (vector * (most / length), True)


# A mass on a spring and damper over one tick, in closed form.

STIFFEST: Final = 1e12
"""1/s², times s. Rates over a period beyond which the exponential has no digits left."""


class HeldMotion:
    """``m x'' + d x' + k x = f(t)`` over one period, with f linear in time: exact.

    Raises StandoffError: a mass too small to be followed.

    Parameters
    ----------
    mass, damping, stiffness : float
        m above zero.
    period : float
        [s]
    """

    def __init__(self, mass: float, damping: float, stiffness: float, period: float) -> None:
        # With f and its slope as two more states the exponential holds their integrals too.
        rates = np.zeros((4, 4))
        rates[0, 1] = rates[2, 3] = 1.0
        rates[1, :3] = -stiffness / mass, -damping / mass, 1.0 / mass
        if not np.isfinite(rates).all() or np.abs(rates).max() * period > STIFFEST:
            raise StandoffError(
                f"a mass of {mass:g} with damping {damping:g} and stiffness {stiffness:g} does not "
                f"move in a way that a period of {period:g} s can follow: give more mass",
                "mass",
                mass,
            )
        ((_, *self._way), (_, *self._speed)) = scipy.linalg.expm(rates * period)[:2].tolist()
        self._period = period

    def after(self, v: Vector, first: Vector, last: Vector) -> tuple[Vector, Vector]:
        """Return x and x' a period on from x = 0, with f from `first` to `last`."""
        # Linear in f: what it is at first, and its rise as a slope.
        (by_v, by_f, by_slope), (v_by_v, v_by_f, v_by_slope) = self._way, self._speed
        by_slope, v_by_slope = by_slope / self._period, v_by_slope / self._period
        x = combined(by_v, v, by_f - by_slope, first)
        x_rate = combined(v_by_v, v, v_by_f - v_by_slope, first)
        return combined(1.0, x, by_slope, last), combined(1.0, x_rate, v_by_slope, last)
