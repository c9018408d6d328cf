"""What a servo is given, checked before anything is made."""

from __future__ import annotations

import math
from typing import Any, Final

from standoff.checks.numbers import positive, whole_number
from standoff.checks.real_numbers import shown
from standoff.devices.port import LiveDevice
from standoff.devices.trace import Trace
from standoff.errors import StandoffError, StandoffTypeError
from standoff.servo.tolerances import FASTEST, RATES_AGREE, SLOWEST
from standoff.simulation.device import Device
from standoff.simulation.operator import Operator
from standoff.simulation.rigid_body import DRIVEN

MOST_LOGGED: Final = 5_000_000
"""Ticks of a log: 1.2 GB."""

LONGEST_RUN: Final = 1e9
"""Seconds of a run: thirty years."""


def system_of(operator: Any) -> None:
    """Refuse what is not an operator, or one that no device can feel."""
    if not isinstance(operator, Operator):
        raise StandoffTypeError(
            f"operator is {shown(operator)}: give a standoff.simulation.Operator.",
            "operator",
            operator,
        )
    if operator.system.coupler is None:
        raise StandoffError(
            "the operator's system has no coupler, and so no device can feel it: give one with "
            "System(..., coupler=..., tool=...).",
            "operator",
            operator,
        )
    driven = [k for k, body in enumerate(operator.system.bodies) if body.kind == DRIVEN]
    if driven:
        raise StandoffError(
            f"body {driven[0]} is driven along a path, which is computed in Python and so cannot "
            "be in a real-time loop: make it fixed or free.",
            "operator",
            operator,
        )


def rate_of(period: float, given: Any) -> float:
    """An operator's ticks a second; a rate that is given must equal them."""
    rate = 1.0 / period
    if not SLOWEST * (1.0 - RATES_AGREE) <= rate <= FASTEST * (1.0 + RATES_AGREE):
        raise StandoffError(
            f"the operator's tick of {period:g} s is {rate:g} a second: a servo runs at "
            f"{SLOWEST:g} to {FASTEST:g}. Change its step, or the period of the coupler's device.",
            "operator",
        )
    if given is not None:
        wanted = positive(given, "rate")
        if abs(wanted - rate) > RATES_AGREE * rate:
            raise StandoffError(
                f"rate is {wanted:g}, but the operator makes {rate:g} ticks a second: give "
                f"Operator(..., dt={1.0 / wanted:g}), with a coupler whose sampling has that "
                "period.",
                "rate",
                given,
            )
    return rate


def ticks_in(seconds: Any, rate: float) -> int:
    """Ticks of a run; 0 for no end."""
    if seconds is None:
        return 0
    given = positive(seconds, "seconds")
    if given > LONGEST_RUN:
        raise StandoffError(
            f"seconds is {given:g}: give at most {LONGEST_RUN:g}, or None to run without end.",
            "seconds",
            seconds,
        )
    return max(1, math.ceil(given * rate * (1.0 - RATES_AGREE)))


def log_ticks(given: Any) -> int:
    """Rows of a log."""
    return whole_number(given, "log_ticks", 0, MOST_LOGGED)


def kind_of_device(device: Any) -> None:
    """Refuse what is not a device."""
    if device is not None and not isinstance(device, LiveDevice | Device | Trace):
        raise StandoffTypeError(
            f"device is {shown(device)}: give a Trace, a device of standoff.devices, one with the "
            "calls of standoff.simulation.Device, or None.",
            "device",
            device,
        )
