"""A torus, such as the blend that a rolling ball makes between a plane and a cylinder."""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff.checks.numbers import magnitude, number
from standoff.errors import StandoffError
from standoff.geometry.curves import FULL_TURN
from standoff.geometry.interval_vectors import stacked, wave
from standoff.geometry.intervals import Interval, cos, interval, near, sin
from standoff.geometry.rotational import Rotational
from standoff.geometry.tolerances import ANGLE_ROUNDOFF
from standoff.geometry.validation import Domain, affine_map
from standoff.kernels.body import layout as L
from standoff.typing import Array


def full_turn(first: float, last: float) -> bool:
    """Do angles make a full turn?"""
    return last - first >= FULL_TURN * (1.0 - ANGLE_ROUNDOFF)


def checked_turn(first: Any, last: Any, name: str) -> tuple[float, float]:
    """Two finite angles, radians, at most a full turn apart."""
    a, b = number(first, "first"), number(last, "last")
    if not 0.0 < b - a <= FULL_TURN * (1.0 + ANGLE_ROUNDOFF):
        raise StandoffError(
            f"{name} from angle {a} to {b}: give 0 < last - first <= 2 pi (radians).", "last", b
        )
    return a, b


def _outside(v0: float, v1: float, inside: bool = False) -> bool:
    """Is cos v nowhere negative (and with `inside`, nowhere zero)?"""
    middle = 0.5 * (v0 + v1)
    away = abs(middle - FULL_TURN * round(middle / FULL_TURN)) + 0.5 * (v1 - v0)
    return away < 0.5 * np.pi if inside else away <= 0.5 * np.pi + ANGLE_ROUNDOFF


def _inmost(v0: float, v1: float) -> float:
    """The least cos v."""
    turns = np.ceil((v0 - np.pi) / FULL_TURN)
    return -1.0 if np.pi + FULL_TURN * turns <= v1 else float(min(np.cos(v0), np.cos(v1)))


class Torus(Rotational):
    """((R + r cos v) cos u, (R + r cos v) sin u, r sin v): its outer half, |v| <= pi/2, is convex.

    Raises ValueError: a radius that is not positive, more than a turn, or a range of v that meets
    the axis.

    Parameters
    ----------
    major, minor : R > 0 and r > 0, length: distance of the circle's centre from the axis z, and
        radius of the circle.
    u0, u1 : angles about the axis, radians; a full turn, the default, is periodic.
    v0, v1 : angles of the circle, radians, at most a turn apart; its convex part by default.
    """

    kind = L.TORUS
    periodic = False
    angles = (True, True)
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
        v0, v1 = checked_turn(v0, v1, "Torus, around its circle,")
        major, minor = magnitude(major, "major"), magnitude(minor, "minor")
        if minor >= major and _inmost(v0, v1) * minor + major <= 0.0:
            raise StandoffError(
                f"Torus of radii {major} and {minor} from v = {v0} to {v1}: it meets its axis; "
                "give major > minor, or a range of v where major + minor cos v > 0.",
                "minor",
                minor,
            )
        self._set(major, minor, (u0, u1, v0, v1), np.eye(3), np.zeros(3))

    def _set(self, major: float, minor: float, domain: Domain, linear: Array, shift: Array) -> None:
        object.__setattr__(self, "major", major)
        object.__setattr__(self, "minor", minor)
        object.__setattr__(self, "periodic", full_turn(*domain[:2]))
        object.__setattr__(self, "bulge", 1 if _outside(*domain[2:]) else None)
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
        """If it lies above or below the middle plane, or is less than half of the outer or inner
        half in both directions."""
        u0, u1, v0, v1 = self.domain
        half = _outside(v0, v1) or _outside(v0 - np.pi, v1 - np.pi)
        level = _outside(v0 - 0.5 * np.pi, v1 - 0.5 * np.pi, inside=True)
        level |= _outside(v0 + 0.5 * np.pi, v1 + 0.5 * np.pi, inside=True)
        return level or (half and u1 - u0 < np.pi and v1 - v0 < np.pi)

    def meridian(self, v: Interval) -> Interval:
        c, s = cos(v), sin(v)
        rho, z = c * self.minor, s * self.minor
        return stacked([stacked([rho + self.major, -z, -rho]), stacked([z, rho, -z])])

    def over_radius(self, v: Interval) -> Interval:
        """cos v / (R / r + cos v) increases with cos v on each side of the axis."""
        c = cos(v)
        ratio = interval(np.array(self.major)) / self.minor
        ends = [x / (ratio + x) for x in (interval(c.lo), interval(c.hi))]
        crosses = ~((ratio + c).mignitude > 0.0)
        low, high = ends[0].lo, ends[1].hi
        return Interval(np.where(crosses, -np.inf, low), np.where(crosses, np.inf, high))

    def speed_and_bend(self, v: Interval) -> tuple[Interval, Interval]:
        square = interval(np.full_like(v.lo, self.minor)) ** 2
        return square, -square

    def meridian_heights(self, rho: Interval, z: Interval, v: Interval) -> Interval:
        return rho * self.major + wave(rho * self.minor, z * self.minor, v)

    def meridian_normals(self, v: Interval) -> list[Interval]:
        """At both ends, and where they are parallel to the axis if that is between them."""
        spots = [stacked([cos(t), sin(t)]) for t in (interval(v.lo), interval(v.hi))]
        zero = np.zeros_like(v.lo)
        for crest, up in ((0.5 * np.pi, 1.0), (1.5 * np.pi, -1.0)):
            inside = cos(v - near(crest)).hi >= 1.0
            up_there = stacked([interval(zero), interval(zero + up)])
            spots.append(
                Interval(
                    np.where(inside, up_there.lo, spots[0].lo),
                    np.where(inside, up_there.hi, spots[0].hi),
                )
            )
        return spots

    def highest(self, direction: Array) -> tuple[float, float] | None:
        y = self.linear.T @ direction
        u0, u1, v0, v1 = self.domain
        u = u0 + (float(np.arctan2(y[1], y[0])) - u0) % FULL_TURN
        v = v0 + (float(np.arctan2(y[2], np.hypot(y[0], y[1]))) - v0) % FULL_TURN
        return (u, v) if u <= u1 and v0 <= v <= v1 else None
