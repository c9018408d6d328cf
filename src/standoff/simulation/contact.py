"""How two bodies of a system push each other where they overlap."""

from __future__ import annotations

import math
from dataclasses import dataclass

from standoff.checks.numbers import not_negative, positive
from standoff.errors import StandoffError


@dataclass(frozen=True, kw_only=True)
class HuntCrossley:
    """Hunt and Crossley's force along the normal, and Coulomb's friction, regularised.

    At a depth d that grows at the rate d' the bodies push each other by ``F = k d^1.5 (1 + 1.5 c
    d')``, never less than zero: a spring that loses energy only while it is pressed, with no jump
    where contact begins (Hunt and Crossley, J. Appl. Mech. 42, 1975). Across the normal friction is
    ``mu F u / sqrt(u² + s²)`` against the slip u.

    Raises StandoffError: a number that is negative or not finite; friction without a slip speed.

    Parameters
    ----------
    stiffness : float
        k [force/length^1.5], positive.
    damping : float
        c [time/length]; the restitution at an impact speed v is near 1 - c v while that is small.
    friction : float
        Coefficient mu, no unit.
    slip_speed : float
        Speed s [length/time] below which friction gives way; positive if there is friction. A body
        at rest on a slope creeps at a fraction of it.
    depth : float, optional
        Greatest depth [length] for which the contact is meant: its stiffness there is checked
        against the step. A hundredth of the smaller body's size if not given. A run that went
        deeper says so (`SystemRun.deepest`).
    """

    stiffness: float
    damping: float = 0.0
    friction: float = 0.0
    slip_speed: float = 0.0
    depth: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "stiffness", positive(self.stiffness, "stiffness"))
        for name in ("damping", "friction", "slip_speed"):
            object.__setattr__(self, name, not_negative(getattr(self, name), name))
        if self.depth is not None:
            object.__setattr__(self, "depth", positive(self.depth, "depth"))
        if self.friction > 0.0 and self.slip_speed == 0.0:
            raise StandoffError(
                f"friction = {self.friction:g} needs a slip_speed above zero: below it friction "
                "gives way; a hundredth of the speeds of interest serves.",
                "slip_speed",
                self.slip_speed,
            )

    def force(self, depth: float, rate: float = 0.0) -> float:
        """The normal force [force] at a depth [length] and its rate [length/time]."""
        if depth <= 0.0:
            return 0.0
        spring = self.stiffness * depth * math.sqrt(depth)
        return max(0.0, spring * (1.0 + 1.5 * self.damping * rate))

    def restitution(self, speed: float) -> float:
        """The ratio of the speeds after and before an impact without friction.

        Parameters
        ----------
        speed : float
            Of approach [length/time], positive.

        Returns
        -------
        float
            e of ``ln((1 + a v)/(1 - a e v)) = a v (1 + e)`` with a = 1.5 c: what both phases of the
            impact give, integrated over the depth. It does not depend on the stiffness.
        """
        x = 1.5 * self.damping * positive(speed, "speed")
        if x == 0.0:
            return 1.0

        def off(e: float) -> float:
            return math.log1p(x) - math.log1p(-e * x) - x * (1.0 + e)

        low, high = 0.0, min(1.0, math.nextafter(1.0, 0.0) / x)
        for _ in range(200):  # halved to the last digit
            middle = 0.5 * (low + high)
            low, high = (middle, high) if off(middle) < 0.0 else (low, middle)
        return 0.5 * (low + high)

    def tangent(self, depth: float) -> tuple[float, float]:
        """(stiffness, damping) of the force about rest at a depth: its slopes by d and by d'."""
        spring = self.stiffness * depth * math.sqrt(depth)
        return 1.5 * spring / depth, 1.5 * self.damping * spring
