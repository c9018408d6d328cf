"""The energy that goes through a coupler's two ports, and the damping that keeps it passive.

After Hannaford and Ryu (IEEE Trans. Robotics and Automation 18(1), 2002), with the held force times
the displacement until the next sample, which is exactly the work and not an estimate (Ryu, Kim and
Hannaford, IEEE Trans. Robotics 20(4), 2004).
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import NamedTuple

from standoff.checks.numbers import not_negative


class PortEnergy(NamedTuple):
    """The energy that went through a coupler since it was engaged [J].

    Attributes
    ----------
    device : float
        Into the coupler from the handle; below zero where more came out.
    tool : float
        Into the coupler from the tool.
    friction : float
        The least that the device's own damping took: b |Δx|²/dt of each tick, if the coupler was
        given a `Sampling`. It covers the energy that holding the force creates.
    least : float
        The least that the three ever summed to. It stays above minus a tolerance if coupler and
        device are passive.
    """

    device: float = 0.0
    tool: float = 0.0
    friction: float = 0.0
    least: float = 0.0

    @property
    def observed(self) -> float:
        """What went in and did not come out again, stored or dissipated [J]."""
        return self.device + self.tool + self.friction


@dataclass(frozen=True, kw_only=True)
class PassivityController:
    """Variable damping at a coupler's ports while more energy came out than went in.

    Each tick it dissipates what is missing, as far as its limits allow: at the handle first, the
    rest at the tool. A held damper is passive only up to about the device's own damping, or the
    mass that moves over the tick, so its limit is not a formality.

    Raises StandoffError: a number that is not finite, or below zero.

    Parameters
    ----------
    max_damping : float
        At the handle [N s/m].
    max_rotational_damping : float
        At the handle [N m s/rad].
    max_tool_damping : float
        At the tool [N s/m].
    max_tool_rotational_damping : float
        At the tool [N m s/rad].
    tolerance : float
        Energy that may be missing before it acts [J].
    """

    max_damping: float
    max_rotational_damping: float = 0.0
    max_tool_damping: float = 0.0
    max_tool_rotational_damping: float = 0.0
    tolerance: float = 0.0

    def __post_init__(self) -> None:
        for field in fields(self):
            value = not_negative(getattr(self, field.name), field.name)
            object.__setattr__(self, field.name, value)
