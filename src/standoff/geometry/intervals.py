"""Interval arithmetic over many boxes at once, the basis of what is proven over a patch.

An `Interval` holds arrays of lower and upper bounds; every result is guaranteed to contain the
values of the operation over its operands. +, -, *, / and sqrt are rounded outward by one unit in
the last place, which is enough by IEEE 754; NumPy's elementary functions by `LIBRARY_ERROR`. If an
operation is undefined somewhere in a box (a division by an interval that contains zero, the root of
one with negative values), both bounds are NaN, and stay so.

Intervals are stored by endpoints, not by midpoints and radii as in python-flint's `arb`: its radii
of 30 bits extend beyond the edge of a domain, where a root then has no bound, and one call per box
and operation is a hundred times as slow. `arb` is the oracle of the tests.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.geometry.tolerances import CREST_ROUNDOFF, LIBRARY_ERROR
from standoff.typing import Array

TINY = float(np.finfo(np.float64).tiny)
# Greatest angle that is reduced: for larger ones the quadrant is not known reliably.
GREATEST_ANGLE = 1e6
TURN = 2.0 * np.pi


class Interval:
    """Bounds [lo, hi], arrays of the same shape; NaN where nothing is known."""

    __slots__ = ("hi", "lo")
    __array_ufunc__ = None  # so that array @ interval is rejected instead of looped over

    def __init__(self, lo: Array, hi: Array) -> None:
        self.lo = lo
        self.hi = hi

    def __getitem__(self, which: Any) -> Interval:
        return Interval(self.lo[which], self.hi[which])

    def __neg__(self) -> Interval:
        return Interval(-self.hi, -self.lo)

    def __add__(self, other: Interval | float | Array) -> Interval:
        b = interval(other)
        return _rounded(self.lo + b.lo, self.hi + b.hi)

    __radd__ = __add__

    def __sub__(self, other: Interval | float | Array) -> Interval:
        return self + (-interval(other))

    def __rsub__(self, other: float) -> Interval:
        return interval(other) + (-self)

    def __mul__(self, other: Interval | float | Array) -> Interval:
        if not isinstance(other, Interval | np.ndarray):
            if other == 1.0:
                return self
            if other == -1.0:
                return -self
        b = interval(other)
        p, q, r, s = self.lo * b.lo, self.lo * b.hi, self.hi * b.lo, self.hi * b.hi
        low = np.minimum(np.minimum(p, q), np.minimum(r, s))
        return _rounded(low, np.maximum(np.maximum(p, q), np.maximum(r, s)))

    __rmul__ = __mul__

    def __truediv__(self, other: Interval | float | Array) -> Interval:
        return self * reciprocal(interval(other))

    def __rtruediv__(self, other: float) -> Interval:
        return interval(other) * reciprocal(self)

    def __pow__(self, exponent: int) -> Interval:
        """An integer power."""
        if exponent < 0:
            return reciprocal(self**-exponent)
        low, high = self.lo**exponent, self.hi**exponent
        if exponent % 2:
            return _widened(low, high)
        holds_zero = (self.lo <= 0.0) & (self.hi >= 0.0)
        least = np.where(holds_zero, 0.0, np.minimum(low, high))
        result = _widened(least, np.maximum(low, high))
        return Interval(np.maximum(result.lo, 0.0), result.hi)

    @property
    def known(self) -> NDArray[np.bool_]:
        """Where both bounds are finite."""
        return np.isfinite(self.lo) & np.isfinite(self.hi)

    @property
    def magnitude(self) -> Array:
        """The greatest absolute value."""
        return np.maximum(np.abs(self.lo), np.abs(self.hi))

    @property
    def middle(self) -> Array:
        """A number between the bounds."""
        return np.asarray(0.5 * self.lo + 0.5 * self.hi)

    @property
    def radius(self) -> Array:
        """The greatest distance of a value from `middle`."""
        middle = self.middle
        return np.asarray(np.nextafter(np.maximum(self.hi - middle, middle - self.lo), np.inf))

    @property
    def mignitude(self) -> Array:
        """The least absolute value."""
        return np.maximum(np.maximum(self.lo, -self.hi), 0.0)

    def within(self, other: Interval) -> Interval:
        """The intersection of two bounds of the same value; unknown bounds are ignored."""
        return Interval(np.fmax(self.lo, other.lo), np.fmin(self.hi, other.hi))


def interval(value: Interval | float | Array) -> Interval:
    """`value` as an interval; numbers are taken as exact."""
    if isinstance(value, Interval):
        return value
    exact = np.asarray(value, dtype=np.float64)
    return Interval(exact, exact)


def near(value: float) -> Interval:
    """An interval that contains the real number whose nearest float64 is `value`."""
    exact = np.asarray(value, dtype=np.float64)
    return _rounded(exact, exact)


def _rounded(low: Any, high: Any) -> Interval:
    return Interval(np.nextafter(low, -np.inf), np.nextafter(high, np.inf))


def _widened(low: Any, high: Any) -> Interval:
    return Interval(
        low - (LIBRARY_ERROR * np.abs(low) + TINY), high + (LIBRARY_ERROR * np.abs(high) + TINY)
    )


def _only(inside: NDArray[np.bool_], result: Interval) -> Interval:
    """`result` where the argument lies inside the function's domain, NaN elsewhere."""
    return Interval(np.where(inside, result.lo, np.nan), np.where(inside, result.hi, np.nan))


def reciprocal(a: Interval) -> Interval:
    return _only((a.lo > 0.0) | (a.hi < 0.0), _rounded(1.0 / a.hi, 1.0 / a.lo))


def sqrt(a: Interval | float) -> Interval:
    a = interval(a)
    inside = a.lo >= 0.0
    root = _rounded(np.sqrt(np.maximum(a.lo, 0.0)), np.sqrt(np.maximum(a.hi, 0.0)))
    return _only(inside, Interval(np.maximum(root.lo, 0.0), root.hi))


def exp(a: Interval | float) -> Interval:
    a = interval(a)
    e = _widened(np.exp(a.lo), np.exp(a.hi))
    return Interval(np.maximum(e.lo, 0.0), e.hi)


def log(a: Interval | float) -> Interval:
    a = interval(a)
    inside = a.lo > 0.0
    return _only(
        inside, _widened(np.log(np.where(inside, a.lo, 1.0)), np.log(np.where(inside, a.hi, 1.0)))
    )


def power(a: Interval | float, e: Interval | float) -> Interval:
    """a**e for a >= 0, or a > 0 if e may be negative; its extremes are at the corners."""
    a, e = interval(a), interval(e)
    inside = (a.lo > 0.0) | ((a.lo >= 0.0) & (e.lo > 0.0))
    inside &= ~np.isnan(e.lo + e.hi)  # IEEE 754 has 1**nan = 1
    low, high = np.where(inside, a.lo, 1.0), np.where(inside, a.hi, 1.0)
    p, q, r, s = low**e.lo, low**e.hi, high**e.lo, high**e.hi
    least = np.minimum(np.minimum(p, q), np.minimum(r, s))
    result = _widened(least, np.maximum(np.maximum(p, q), np.maximum(r, s)))
    return _only(inside, Interval(np.maximum(result.lo, 0.0), result.hi))


def sin(a: Interval | float) -> Interval:
    a = interval(a)
    return _wave(a, np.sin, 0.5 * np.pi)


def cos(a: Interval | float) -> Interval:
    a = interval(a)
    return _wave(a, np.cos, 0.0)


def _wave(a: Interval, function: Any, crest: float) -> Interval:
    """A wave of period 2 pi, 1 at `crest`, -1 half a period later."""
    low, high = function(a.lo), function(a.hi)
    ends = _widened(np.minimum(low, high), np.maximum(low, high))
    # a crest within roundoff of an end counts as inside
    spare = CREST_ROUNDOFF * (1.0 + a.magnitude)
    first, last = (a.lo - spare - crest) / TURN, (a.hi + spare - crest) / TURN
    top = np.floor(last) >= np.ceil(first)
    bottom = np.floor(last - 0.5) >= np.ceil(first - 0.5)
    lost = ~(a.magnitude < GREATEST_ANGLE)
    unknown = np.where(np.isnan(a.lo) | np.isnan(a.hi), np.nan, 1.0)
    low = np.where(bottom | lost, -1.0, np.maximum(ends.lo, -1.0)) * unknown
    return Interval(low, np.where(top | lost, 1.0, np.minimum(ends.hi, 1.0)) * unknown)


def tan(a: Interval | float) -> Interval:
    a = interval(a)
    spare = CREST_ROUNDOFF * (1.0 + a.magnitude)
    branch = np.floor((a.lo - spare) / np.pi + 0.5)
    inside = (branch == np.floor((a.hi + spare) / np.pi + 0.5)) & (a.magnitude < GREATEST_ANGLE)
    return _only(inside, _widened(np.tan(a.lo), np.tan(a.hi)))


def asin(a: Interval | float) -> Interval:
    a = interval(a)
    inside = (a.lo >= -1.0) & (a.hi <= 1.0)
    low, high = np.where(inside, a.lo, 0.0), np.where(inside, a.hi, 0.0)
    return _only(inside, _widened(np.arcsin(low), np.arcsin(high)))


def acos(a: Interval | float) -> Interval:
    a = interval(a)
    inside = (a.lo >= -1.0) & (a.hi <= 1.0)
    low, high = np.where(inside, a.lo, 0.0), np.where(inside, a.hi, 0.0)
    return _only(inside, _widened(np.arccos(high), np.arccos(low)))


def atan(a: Interval | float) -> Interval:
    a = interval(a)
    return _widened(np.arctan(a.lo), np.arctan(a.hi))


def atan2(y: Interval | float, x: Interval | float) -> Interval:
    """The angle of (x, y) in boxes that do not touch the cut y = 0, x <= 0."""
    y, x = interval(y), interval(x)
    right, above, below = x.lo > 0.0, y.lo > 0.0, y.hi < 0.0
    quarter = near(0.5 * np.pi)
    by_x, by_y = atan(y / x), atan(x / y)
    upper, lower = quarter - by_y, -quarter - by_y
    low = np.where(above, upper.lo, np.where(below, lower.lo, np.nan))
    high = np.where(above, upper.hi, np.where(below, lower.hi, np.nan))
    return Interval(np.where(right, by_x.lo, low), np.where(right, by_x.hi, high))


def sinh(a: Interval | float) -> Interval:
    a = interval(a)
    return _widened(np.sinh(a.lo), np.sinh(a.hi))


def cosh(a: Interval | float) -> Interval:
    a = interval(a)
    result = _widened(np.cosh(a.mignitude), np.cosh(a.magnitude))
    unknown = np.where(np.isnan(a.lo) | np.isnan(a.hi), np.nan, 1.0)
    return Interval(np.maximum(result.lo, 1.0) * unknown, result.hi * unknown)


def tanh(a: Interval | float) -> Interval:
    a = interval(a)
    return _widened(np.tanh(a.lo), np.tanh(a.hi))


FUNCTIONS = {
    "sin": sin, "cos": cos, "tan": tan, "asin": asin, "acos": acos, "atan": atan, "atan2": atan2,
    "sinh": sinh, "cosh": cosh, "tanh": tanh, "exp": exp, "log": log, "sqrt": sqrt,
    "power": power, "near": near,
}  # fmt: skip
"""By the names that formulas use."""
