"""The convex part of a torus: what a rolling ball leaves between a plane and a cylinder."""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff.checks.numbers import magnitude, number
from standoff.errors import StandoffError
from standoff.geometry.curves import FULL_TURN
from standoff.geometry.domains import Domain
from standoff.geometry.surfaces import Surface
from standoff.geometry.tolerances import ANGLE_ROUNDOFF
from standoff.geometry.validation import Array, affine_map
from standoff.kernels.body import layout as L


def full_turn(first: float, last: float) -> bool:
    """Do angles run once round."""
    return last - first >= FULL_TURN * (1.0 - ANGLE_ROUNDOFF)


def checked_turn(first: Any, last: Any, name: str) -> tuple[float, float]:
    """Two finite angles, radians, less than or just a turn apart."""
    a, b = number(first, "first"), number(last, "last")
    if not 0.0 < b - a <= FULL_TURN * (1.0 + ANGLE_ROUNDOFF):
        raise StandoffError(
            f"{name} from angle {a} to {b}: give 0 < last - first <= 2 pi (radians).", "last", b
        )
    return a, b


class Torus(Surface):
    """((R + r cos v) cos u, (R + r cos v) sin u, r sin v), |v| <= pi/2: its convex part.

    Parameters
    ----------
    major, minor : R > 0 and r > 0, length: the circle's distance from the axis z, its radius.
    u0, u1 : angles about the axis, radians; a full turn, the default, is periodic.
    v0, v1 : angles of the circle, radians, in [-pi/2, pi/2].

    Raises
    ------
    ValueError
        A radius that is not positive, more than a turn, or angles beyond the convex part.
    """

    kind = L.TORUS
    periodic = False
    projection = None
    part_of = None
    ruled = False
    proof = "theorem"
    bulge = 1

    major: float
    minor: float

    def __init__(
        self,
        major: Any,
        minor: Any,
        u0: Any = 0.0,
        u1: Any = FULL_TURN,
        v0: Any = -0.5 * np.pi,
        v1: Any = 0.5 * np.pi,
    ) -> None:
        u0, u1 = checked_turn(u0, u1, "Torus")
        v0, v1 = number(v0, "v0"), number(v1, "v1")
        top = 0.5 * np.pi + ANGLE_ROUNDOFF
        if not -top <= v0 < v1 <= top:
            raise StandoffError(f"Torus from v = {v0} to {v1}: give -pi/2 <= v0 < v1 <= pi/2.")
        domain = (u0, u1, v0, v1)
        self._set(
            magnitude(major, "major"), magnitude(minor, "minor"), domain, np.eye(3), np.zeros(3)
        )

    def _set(self, major: float, minor: float, domain: Domain, linear: Array, shift: Array) -> None:
        object.__setattr__(self, "major", major)
        object.__setattr__(self, "minor", minor)
        object.__setattr__(self, "periodic", full_turn(*domain[:2]))
        super().__init__(linear, shift, domain)

    def _data(self) -> Array:
        return np.array([self.major, self.minor])

    def transformed(self, linear: Array, shift: Array) -> Torus:
        """The exact image under x -> linear x + shift; parameters stay the same."""
        linear, shift = affine_map(linear, shift)
        return self._with(self.domain, linear @ self.linear, linear @ self.shift + shift)

    def restricted(self, u0: float, u1: float, v0: float, v1: float) -> Torus:
        """The same surface on a smaller domain; parameters stay the same."""
        return self._with(self.smaller_domain(u0, u1, v0, v1), self.linear, self.shift)

    def _with(self, domain: Domain, linear: Array, shift: Array) -> Torus:
        surface = object.__new__(Torus)
        surface._set(self.major, self.minor, domain, linear, shift)
        return surface

    def within_hemisphere(self) -> bool:
        """A part above or below its middle plane, or less than half of it both ways."""
        u0, u1, v0, v1 = self.domain
        return bool(v0 > 0.0 or v1 < 0.0 or (u1 - u0 < np.pi and v1 - v0 < np.pi))

    def highest(self, direction: Array) -> tuple[float, float] | None:
        y = self.linear.T @ direction
        u0, u1, v0, v1 = self.domain
        u = u0 + (float(np.arctan2(y[1], y[0])) - u0) % FULL_TURN
        v = float(np.arctan2(y[2], np.hypot(y[0], y[1])))
        return (u, v) if u <= u1 and v0 <= v <= v1 else None
