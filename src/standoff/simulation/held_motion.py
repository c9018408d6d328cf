"""A mass on a spring and damper over one tick, in closed form."""

from __future__ import annotations

from typing import Final

import numpy as np
import scipy

from standoff.errors import StandoffError
from standoff.simulation.six_axes import Vector, combined

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
