"""What a haptic device is to the library: a small protocol, and what is made of its readings."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from types import TracebackType
from typing import Any, NamedTuple, Protocol, Self, runtime_checkable

import numpy as np

from standoff.checks.numbers import not_negative
from standoff.errors import StandoffError
from standoff.kernels.dynamics import coupler_arrays as K
from standoff.motion.pose import Pose, PoseLike
from standoff.motion.twist import Twist, TwistLike
from standoff.simulation.wrench import Wrench


class DeviceReading(NamedTuple):
    """What a device said last. Nothing in it is checked: `VirtualCoupler.step` does that.

    Attributes
    ----------
    time : float
        When it was sampled [s], on the clock that the loop gives the coupler as `now`.
    sequence : int
        Grows by one with each sample of the device, so that doubled and lost ones are noticed.
    pose : Pose or what `Pose.of` reads
        Of the handle, in the world [length].
    twist : Twist, what `Twist.of` reads, or None
        Of the handle. None if the driver has none: the coupler then takes differences of poses.
    buttons : sequence of bool
        Pressed or not, in the device's own order.
    valid : bool
        False if the device itself says that its data cannot be trusted.
    """

    time: float
    sequence: int
    pose: PoseLike
    twist: TwistLike | None = None
    buttons: Sequence[bool] = ()
    valid: bool = True


@dataclass(frozen=True, kw_only=True)
class DeviceLimits:
    """What a device can do.

    Raises StandoffError: a number below zero, or not finite; the workspace may be infinite.

    Parameters
    ----------
    max_force : float
        Greatest force that it can hold [N].
    max_torque : float
        Greatest torque [N m]; 0 for a device without one.
    workspace : float
        Radius of the ball about its home position that the handle can reach [length].
    """

    max_force: float
    max_torque: float = 0.0
    workspace: float = math.inf

    def __post_init__(self) -> None:
        for name in ("max_force", "max_torque"):
            object.__setattr__(self, name, not_negative(getattr(self, name), name))
        reach: Any = self.workspace
        if not (isinstance(reach, float) and reach == math.inf):
            object.__setattr__(self, "workspace", not_negative(self.workspace, "workspace"))


@runtime_checkable
class Device(Protocol):
    """A haptic device that reads a pose and renders a wrench (impedance type).

    Used as a context manager, it is open within the block and its wrench is zero afterwards,
    however the block ends.

    Attributes
    ----------
    limits : DeviceLimits
    """

    @property
    def limits(self) -> DeviceLimits: ...

    def open(self) -> None:
        """Connect; the wrench is zero. Raises `DeviceError` where there is no device."""
        ...

    def read(self) -> DeviceReading | None:
        """Return the newest sample, again if there is no newer one; None if there is none.

        Raises `DeviceError` once the device is closed or gone: give the coupler None then.
        """
        ...

    def write(self, wrench: Wrench) -> None:
        """Hold a wrench on the handle until the next. Raises `DeviceError` as `read`."""
        ...

    def close(self) -> None:
        """Set the wrench to zero and release the device; does nothing if it is closed."""
        ...

    def __enter__(self) -> Self: ...

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None: ...


class Fault(IntEnum):
    """Why a coupler let go."""

    NONE = K.NO_FAULT
    MISSING = K.MISSING
    LATE = K.LATE
    NON_FINITE = K.NON_FINITE
    MALFORMED = K.MALFORMED
    OUT_OF_ORDER = K.OUT_OF_ORDER
    INVALID = K.INVALID
    HALF_TURN = K.HALF_TURN
    TOOL = K.TOOL

    @property
    def advice(self) -> str:
        """What happened, and what to do."""
        return _ADVICE[self]


_ADVICE = {
    Fault.NONE: "No fault.",
    Fault.MISSING: "The device gave no reading; check its connection, then engage again.",
    Fault.LATE: "The newest reading is older than max_age, or ahead of the clock; check the load "
    "of the machine and the device's rate, then engage again.",
    Fault.NON_FINITE: "A number of the reading is not finite; check the driver.",
    Fault.MALFORMED: "The reading does not have the shape of a pose and a twist; check the driver.",
    Fault.OUT_OF_ORDER: "A reading came after a newer one; check the connection.",
    Fault.INVALID: "The device says that its data cannot be trusted; calibrate it.",
    Fault.HALF_TURN: "Handle and tool came near a half turn apart, beyond which the torque would "
    "reverse; bring them together, then engage again.",
    Fault.TOOL: "The tool's pose or twist is not finite, or is missing; the simulation failed.",
}


class HandleMotion(NamedTuple):
    """Pose and twist as plain numbers: what a tick computes with.

    Attributes
    ----------
    R : nine floats, row by row
    p : three floats
    v, omega : three floats each, along the world's axes
    """

    R: tuple[float, ...]
    p: tuple[float, ...]
    v: tuple[float, ...]
    omega: tuple[float, ...]


STILL = (0.0, 0.0, 0.0)
_AT_REST = Twist.zero()


def read_motion(pose: Any, twist: Any) -> HandleMotion | Fault:
    """Return a pose and a twist (or None) as plain numbers, or what is wrong with them."""
    # Whatever a driver hands over, and whatever it raises when it is read, the answer is a fault,
    # never an exception: the force on the handle must go to zero in this very tick.
    try:
        placed = Pose.of(pose)
        moving = _AT_REST if twist is None else Twist.of(twist)
    except StandoffError:
        return _non_finite_or_malformed(pose, twist)
    except Exception:
        return Fault.MALFORMED
    return as_numbers(placed, moving)


def as_numbers(pose: Pose, twist: Twist) -> HandleMotion:
    """Return a pose and a twist as plain numbers."""
    moving = twist.in_world(pose)
    return HandleMotion(
        tuple(pose.rotation.ravel().tolist()),
        tuple(pose.translation.tolist()),
        tuple(moving.v.tolist()),
        tuple(moving.omega.tolist()),
    )


def _non_finite_or_malformed(*given: Any) -> Fault:
    for value in given:
        for part in value if isinstance(value, tuple) else (value,):
            try:
                finite = np.isfinite(np.asarray(part, dtype=np.float64)).all()
            except (TypeError, ValueError, OverflowError):
                continue
            if part is not None and not finite:
                return Fault.NON_FINITE
    return Fault.MALFORMED
