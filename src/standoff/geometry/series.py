"""Taylor series in two parameters whose coefficients are intervals over many boxes.

Evaluating a formula on the series of u and v over a box bounds all its Taylor coefficients
(derivatives over factorials) at every point of the box at once. Unlike bounds of differentiated
expressions, these do not widen with the length of the derivatives' expressions.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from standoff.geometry.intervals import FUNCTIONS, TINY, Interval, interval
from standoff.typing import Array

PLAIN: dict[str, Any] = dict(FUNCTIONS)
EPS = float(np.finfo(np.float64).eps)


def place(k: int, m: int) -> int:
    """Row of the coefficient of u^k v^m, by total degree, so that a prefix is a lower order."""
    return (k + m) * (k + m + 1) // 2 + m


def rows(order: int) -> int:
    return (order + 1) * (order + 2) // 2


def powers(order: int) -> list[tuple[int, int]]:
    """(k, m) of each row."""
    return [(d - m, m) for d in range(order + 1) for m in range(d + 1)]


@lru_cache(maxsize=32)
def _pairs(order: int) -> tuple[Any, Any, Any]:
    """Rows of both factors of each product, by the row that they add to, and where rows begin."""
    found = []
    for k, m in powers(order):
        found.append(
            [(place(a, b), place(k - a, m - b)) for a in range(k + 1) for b in range(m + 1)]
        )
    starts = np.cumsum([0, *(len(f) for f in found[:-1])])
    flat = np.array([pair for f in found for pair in f])
    return flat[:, 0], flat[:, 1], starts


class Series(Interval):
    """Coefficients (rows(order), n), intervals; a number counts as a constant series.

    It is a subclass of `Interval`, so that Python calls its operators even if the left operand is
    an interval.
    """

    __slots__ = ("order",)

    def __init__(self, lo: Array, hi: Array, order: int) -> None:
        super().__init__(lo, hi)
        self.order = order

    @staticmethod
    def variable(side: Interval, axis: int, order: int) -> Series:
        """u (axis 0) or v (axis 1) over boxes with these sides (n,)."""
        c = np.zeros((rows(order), len(side.lo)))
        c[1 + axis] = 1.0
        low, high = c, c.copy()
        low[0], high[0] = side.lo, side.hi
        return Series(low, high, order)

    @property
    def constant(self) -> Interval:
        return Interval(self.lo[0], self.hi[0])

    def cut(self, order: int) -> Series:
        n = rows(order)
        return Series(self.lo[:n], self.hi[:n], order)

    def with_constant(self, value: Interval) -> Series:
        low, high = self.lo.copy(), self.hi.copy()
        low[0], high[0] = value.lo, value.hi
        return Series(low, high, self.order)

    def columns(self, which: slice) -> Series:
        return Series(self.lo[:, which], self.hi[:, which], self.order)

    def derivative(self, axis: int) -> Series:
        """The derivative by u (0) or v (1), of one order less."""
        source, factor = [], []
        for k, m in powers(self.order - 1):
            source.append(place(k + 1, m) if axis == 0 else place(k, m + 1))
            factor.append(float(k + 1 if axis == 0 else m + 1))
        times = np.array(factor)[:, None]
        scaled = Interval(self.lo[source], self.hi[source]) * interval(times)
        return Series(scaled.lo, scaled.hi, self.order - 1)

    def divided(self, axis: int) -> Series:
        """Divided by u (0) or v (1) minus the value where the series vanishes exactly.

        With f(w) = w g(w), where w is the distance from there, g's coefficients are means of f's
        next higher ones over the interval from there: bounds over boxes that contain it are the
        same.
        """
        source = [
            place(k + 1, m) if axis == 0 else place(k, m + 1) for k, m in powers(self.order - 1)
        ]
        return Series(self.lo[source], self.hi[source], self.order - 1)

    def __neg__(self) -> Series:
        return Series(-self.hi, -self.lo, self.order)

    def __add__(self, other: Any) -> Series:
        if not isinstance(other, Series):
            return self.with_constant(self.constant + other)
        order = min(self.order, other.order)
        a, b = self.cut(order), other.cut(order)
        low = np.nextafter(a.lo + b.lo, -np.inf)
        return Series(low, np.nextafter(a.hi + b.hi, np.inf), order)

    __radd__ = __add__

    def __sub__(self, other: Any) -> Series:
        found: Series = self + (-other)
        return found

    def __rsub__(self, other: Any) -> Series:
        found: Series = (-self) + other
        return found

    def __mul__(self, other: Any) -> Series:
        if not isinstance(other, Series):
            scaled = Interval(self.lo, self.hi) * interval(other)
            return Series(scaled.lo, scaled.hi, self.order)
        order = min(self.order, other.order)
        i, j, starts = _pairs(order)
        a, b, c, d = self.lo[i], self.hi[i], other.lo[j], other.hi[j]
        p, q, r, s = a * c, a * d, b * c, b * d
        low = np.minimum(np.minimum(p, q), np.minimum(r, s))
        high = np.maximum(np.maximum(p, q), np.maximum(r, s))
        size = np.add.reduceat(np.maximum(np.abs(low), np.abs(high)), starts, axis=0)
        # each row is the sum of at most rows(order) products, each rounded once
        spare = size * (EPS * (rows(order) + 2)) + TINY
        low = np.add.reduceat(low, starts, axis=0) - spare
        return Series(low, np.add.reduceat(high, starts, axis=0) + spare, order)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Series:
        other = power(other, -1.0) if isinstance(other, Series) else 1.0 / interval(other)
        found: Series = self * other
        return found

    def __rtruediv__(self, other: Any) -> Series:
        found: Series = power(self, -1.0) * other
        return found

    def __pow__(self, exponent: int) -> Series:
        """An integer power; its constant separately, because a square is never negative."""
        if exponent < 0:
            over: Series = power(self, float(exponent))
            return over
        if exponent == 0:
            one = np.zeros_like(self.lo)
            one[0] = 1.0
            return Series(one, one, self.order)
        half = self ** (exponent // 2) if exponent > 1 else self
        result = half * half if exponent > 1 else self
        if exponent > 1 and exponent % 2:
            result = result * self
        return result.with_constant(result.constant.within(self.constant**exponent))


def composed(outer: Sequence[Interval], inner: Series) -> Series:
    """g(f) from g's Taylor coefficients over f's values, by Horner's rule."""
    away = inner.with_constant(interval(np.zeros(inner.lo.shape[1])))
    result = away * outer[inner.order] + outer[inner.order - 1] if inner.order else None
    for c in reversed(outer[: max(inner.order - 1, 0)]):
        result = result * away + c if result is not None else None
    return result if result is not None else inner.with_constant(outer[0])


def power(base: Any, exponent: Any) -> Any:
    """base**exponent for a positive base, or with an integer exponent for a nonzero base."""
    if isinstance(exponent, Series):
        return exp(exponent * log(base))
    if not isinstance(base, Series):
        return PLAIN["power"](base, exponent)
    a, e = base.constant, interval(exponent)
    whole = isinstance(exponent, float) and exponent == int(exponent)
    found = [a ** int(exponent) if whole else PLAIN["power"](a, e)]
    over = 1.0 / a
    for k in range(1, base.order + 1):
        found.append(found[-1] * over * (e - float(k - 1)) * (1.0 / interval(float(k))))
    return composed(found, base)


def sqrt(a: Any) -> Any:
    if not isinstance(a, Series):
        return PLAIN["sqrt"](a)
    found = [PLAIN["sqrt"](a.constant)]
    over = 1.0 / a.constant
    for k in range(1, a.order + 1):
        found.append(found[-1] * over * (1.5 - k) * (1.0 / interval(float(k))))
    return composed(found, a)


def log(a: Any) -> Any:
    if not isinstance(a, Series):
        return PLAIN["log"](a)
    over = 1.0 / a.constant
    found = [
        over**k * (1.0 / interval(float(k))) * (1.0 if k % 2 else -1.0)
        for k in range(1, a.order + 1)
    ]
    return composed([PLAIN["log"](a.constant), *found], a)


def exp(a: Any) -> Any:
    if not isinstance(a, Series):
        return PLAIN["exp"](a)
    value = PLAIN["exp"](a.constant)
    return composed(_over_factorials([value] * (a.order + 1)), a)


def _over_factorials(derivatives: Sequence[Interval]) -> list[Interval]:
    found, factorial = [], 1.0
    for k, d in enumerate(derivatives):
        factorial *= max(k, 1)
        found.append(d * (1.0 / interval(factorial)))
    return found


def _cycle(names: Sequence[str], signs: Sequence[float]) -> Callable[[Any], Any]:
    """A function whose derivatives repeat, such as sin, cos, -sin, -cos."""

    def function(a: Any) -> Any:
        if not isinstance(a, Series):
            return PLAIN[names[0]](a)
        values = [PLAIN[name](a.constant) for name in names]
        count = len(signs)
        derivatives = [
            values[k % len(names)] * interval(signs[k % count]) for k in range(a.order + 1)
        ]
        return composed(_over_factorials(derivatives), a)

    return function


def _squared(name: str, sign: float) -> Callable[[Any], Any]:
    """tan and tanh: y' = 1 + sign y^2."""

    def function(a: Any) -> Any:
        if not isinstance(a, Series):
            return PLAIN[name](a)
        y = [PLAIN[name](a.constant)]
        for k in range(a.order):
            total = y[0] * y[k] if k else y[0] ** 2
            for i in range(1, k + 1):
                total = total + y[i] * y[k - i]
            slope = total * interval(sign) + (1.0 if k == 0 else 0.0)
            y.append(slope * (1.0 / interval(float(k + 1))))
        return composed(y, a)

    return function


def _arc(name: str, sign: float, exponent: float, factor: float) -> Callable[[Any], Any]:
    """asin, acos and atan: y' = factor (1 + sign x^2)^exponent."""

    def function(x: Any) -> Any:
        if not isinstance(x, Series):
            return PLAIN[name](x)
        a = x.constant
        q = (a**2 * interval(sign) + 1.0, a * interval(2.0 * sign), interval(sign))
        root = PLAIN["sqrt"](q[0])
        w = [1.0 / (root if exponent == -0.5 else q[0])]
        for k in range(1, x.order):
            total = interval(0.0)
            for j in range(1, min(k, 2) + 1):
                total = total + q[j] * w[k - j] * interval(exponent * j - (k - j))
            w.append(total / (q[0] * float(k)))
        slopes = [s * interval(factor) / float(k + 1) for k, s in enumerate(w)]
        return composed([PLAIN[name](a), *slopes], x)

    return function


def atan2(y: Any, x: Any) -> Any:
    if not isinstance(y, Series) and not isinstance(x, Series):
        return PLAIN["atan2"](y, x)
    some = y if isinstance(y, Series) else x
    y, x = (a if isinstance(a, Series) else some * 0.0 + a for a in (y, x))
    over = power(x**2 + y**2, -1.0)
    slopes = [(x * y.derivative(k) - y * x.derivative(k)) * over for k in (0, 1)]
    result = (y * 0.0).with_constant(PLAIN["atan2"](y.constant, x.constant))
    for row, (k, m) in enumerate(powers(result.order)):
        if k + m == 0:
            continue
        slope, n = (slopes[0], k) if k else (slopes[1], m)
        source = place(k - 1, m) if k else place(0, m - 1)
        part = Interval(slope.lo[source], slope.hi[source]) / float(n)
        result.lo[row], result.hi[row] = part.lo, part.hi
    return result


SERIES_FUNCTIONS: dict[str, Any] = {
    "sin": _cycle(("sin", "cos"), (1.0, 1.0, -1.0, -1.0)),
    "cos": _cycle(("cos", "sin"), (1.0, -1.0, -1.0, 1.0)),
    "sinh": _cycle(("sinh", "cosh"), (1.0,)),
    "cosh": _cycle(("cosh", "sinh"), (1.0,)),
    "tan": _squared("tan", 1.0),
    "tanh": _squared("tanh", -1.0),
    "asin": _arc("asin", -1.0, -0.5, 1.0),
    "acos": _arc("acos", -1.0, -0.5, -1.0),
    "atan": _arc("atan", 1.0, -1.0, 1.0),
    "atan2": atan2, "exp": exp, "log": log, "sqrt": sqrt, "power": power,
    "near": PLAIN["near"],
}  # fmt: skip
"""By the names that formulas use."""
