"""Knot vectors of B-splines: checks, Bezier spans, insertion, elevation.

All of it is based on the blossom (polar form) of a polynomial piece: its value at p arguments, by
de Boor's recursion with a different argument in every step (Ramshaw 1989). The Bezier points of a
span are blossoms at its ends, the coefficients of an elevated spline at its own knots; single knots
are inserted by Boehm's rule (1980). `coefficients` have one row per basis function.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import Any

import numpy as np

from standoff.checks.arrays import finite
from standoff.errors import StandoffError
from standoff.read_only import KeepsReadOnly
from standoff.typing import Array

# The compiled jets have room for basis functions up to this degree.
GREATEST_DEGREE = 9


@dataclass(frozen=True, eq=False)
class KnotVector(KeepsReadOnly):
    """A checked knot vector: `knots` (n + p + 1,) for n coefficients of degree p."""

    knots: Array
    degree: int

    @property
    def count(self) -> int:
        """Number of coefficients."""
        return len(self.knots) - self.degree - 1

    @property
    def domain(self) -> tuple[float, float]:
        """The interval on which the basis functions sum to one."""
        return float(self.knots[self.degree]), float(self.knots[self.count])

    @cached_property
    def breaks(self) -> Array:
        """Distinct knots from one end of the domain to the other, (spans + 1,)."""
        found = np.unique(self.knots[self.degree : self.count + 1])
        found.flags.writeable = False
        return found

    def multiplicity(self, knot: float) -> int:
        return int(np.count_nonzero(self.knots == knot))

    def rough(self) -> tuple[float, ...]:
        """Interior knots where continuity is below C2: of multiplicity above p - 2."""
        inside = self.breaks[1:-1]
        return tuple(float(t) for t in inside if self.multiplicity(t) > self.degree - 2)

    def span_of(self, t: float) -> int:
        """s with knots[s] <= t < knots[s + 1], clamped to the domain."""
        return _span(self.knots, self.degree, t)


def _span(knots: Sequence[float] | Array, degree: int, t: float) -> int:
    s = bisect_right(knots, t) - 1
    s = min(max(s, degree), len(knots) - degree - 2)
    while knots[s] == knots[s + 1]:
        s -= 1
    return s


def knot_vector(knots: Any, count: int, name: str, points: str) -> KnotVector:
    """A knot vector for `count` control points; the degree follows from the two counts.

    Raises ValueError: unsorted, not finite, counts that disagree, a degree outside 1 .. 9, too many
    equal knots, or an empty domain. `name` and `points` name the arguments.
    """
    t = finite(knots, name, (-1,))
    degree = len(t) - count - 1
    if not 1 <= degree <= GREATEST_DEGREE:
        raise StandoffError(
            f"{name} has {len(t)} knots for {count} {points}, so degree {degree} (knots - points "
            f"- 1): give {count + 2} to {count + GREATEST_DEGREE + 1} knots, for a degree of 1 to "
            f"{GREATEST_DEGREE}.",
            name,
            knots,
        )
    if count < degree + 1:
        raise StandoffError(
            f"{name} has {len(t)} knots for {count} {points}, so degree {degree}: a degree-{degree}"
            f" spline needs at least {degree + 1} {points}; give fewer knots or more points.",
            name,
            knots,
        )
    falling = np.flatnonzero(np.diff(t) < 0.0)
    if falling.size:
        i = int(falling[0])
        raise StandoffError(
            f"{name} is not sorted: knot {i} = {t[i]} is above knot {i + 1} = {t[i + 1]}; sort "
            "the knots in ascending order.",
            name,
            knots,
        )
    if t[degree] == t[count]:
        raise StandoffError(
            f"{name} has an empty domain: knots {degree} and {count} are both {t[degree]}; give "
            "different ones.",
            name,
            knots,
        )
    values, counts = np.unique(t, return_counts=True)
    for knot, times in zip(values, counts, strict=True):
        most = degree if t[degree] < knot < t[count] else degree + 1
        if times > most:
            where = "inside the domain (the spline would tear)" if most == degree else "at an end"
            raise StandoffError(
                f"{name}: knot {knot} occurs {times} times; at most {most} times {where} for "
                f"degree {degree}.",
                name,
                knots,
            )
    return KnotVector(t, degree)


def blossom(
    vector: KnotVector, coefficients: Array, span: int, arguments: Sequence[float]
) -> Array:
    """The polar form of one polynomial piece at `degree` arguments: one row of coefficients."""
    p, t = vector.degree, vector.knots
    rows = coefficients[span - p : span + 1]
    for step, argument in enumerate(arguments):
        low = t[span - p + 1 + step : span + 1]
        high = t[span + 1 : span + 1 + p - step]
        a = ((argument - low) / (high - low)).reshape((-1,) + (1,) * (rows.ndim - 1))
        rows = (1.0 - a) * rows[:-1] + a * rows[1:]
    return np.asarray(rows[0])


def bezier_spans(vector: KnotVector) -> list[tuple[int, Array]]:
    """For every span of the domain, its first coefficient and the matrix to its Bezier points.

    The matrices, (p + 1, p + 1), have no negative entries, so there is no cancellation.
    """
    p, t = vector.degree, vector.knots
    breaks = np.asarray(vector.breaks)
    spans = np.array([vector.span_of(low) for low in breaks[:-1].tolist()])
    # the blossom at p - j times the lower end and j times the upper one, of each j at once
    rows = np.broadcast_to(np.eye(p + 1), (len(spans), p + 1, p + 1, p + 1))
    for step in range(p):
        upper = step >= p - np.arange(p + 1)
        at = np.where(upper, breaks[1:, None], breaks[:-1, None])[..., None]
        low, high = (t[spans[:, None] + np.arange(k, k + p - step)] for k in (step + 1 - p, 1))
        a = ((at - low[:, None]) / (high - low)[:, None])[..., None]
        rows = (1.0 - a) * rows[..., :-1, :] + a * rows[..., 1:, :]
    return [(int(s) - p, matrix) for s, matrix in zip(spans, rows[..., 0, :], strict=True)]


def refine(vector: KnotVector, new: Sequence[float], name: str) -> tuple[KnotVector, Array]:
    """Insert knots inside the domain: the new vector and the matrix (n', n) of coefficients.

    Raises ValueError: a knot outside the open domain, or one that would then occur more than p
    times.
    """
    extra = finite(list(new), name, (-1,))
    first, last = vector.domain
    outside = extra[(extra <= first) | (extra >= last)]
    if outside.size:
        raise StandoffError(
            f"{name}: knot {outside[0]} is not inside the domain ({first}, {last}).",
            name,
            new,
        )
    knots = np.sort(np.concatenate([vector.knots, extra]))
    knot_vector(knots, vector.count + len(extra), name, "control points")
    return insertion(vector, extra.tolist())


def insertion(vector: KnotVector, new: Sequence[float]) -> tuple[KnotVector, Array]:
    """As `refine`, for knots that are known to be valid."""
    p, knots, rows = vector.degree, vector.knots.tolist(), list(np.eye(vector.count))
    for knot in new:
        s = _span(knots, p, knot)
        t = np.array(knots[s - p + 1 : s + p + 1])
        # Boehm's rule: every new coefficient lies between two old ones
        a = np.clip((knot - t[:p]) / (t[p:] - t[:p]), 0.0, 1.0)[:, None]
        old = np.array(rows[s - p : s + 1])
        rows[s - p + 1 : s] = a * old[1:] + (1.0 - a) * old[:-1]
        knots.insert(s + 1, knot)
    return KnotVector(np.array(knots), p), np.array(rows)


def elevate_knots(vector: KnotVector, times: int) -> tuple[KnotVector, Array]:
    """Raise the degree: the new vector and the matrix (n', n) of coefficients."""
    degree = vector.degree + times
    if times < 0 or degree > GREATEST_DEGREE:
        raise StandoffError(
            f"Degree {degree} asked of a spline of degree {vector.degree}: give a degree from "
            f"{vector.degree} to {GREATEST_DEGREE}."
        )
    clamped, unit = _clamped(vector)
    values, counts = np.unique(clamped.knots, return_counts=True)
    knots = np.repeat(values, counts + times)
    elevated = KnotVector(knots, degree)
    return elevated, _raised(clamped, elevated, degree) @ unit


def _clamped(vector: KnotVector) -> tuple[KnotVector, Array]:
    """The same spline on its domain with end knots of multiplicity p + 1."""
    p, (first, last) = vector.degree, vector.domain
    matrix = np.eye(vector.count)
    for end in (first, last):
        vector, more = insertion(vector, [end] * (p - vector.multiplicity(end)))
        matrix = more @ matrix
    # coefficient i is the blossom at knots i + 1 .. i + p: all first, or all last, at the ends
    low = int(np.searchsorted(vector.knots, first, side="right")) - p - 1
    high = int(np.searchsorted(vector.knots, last, side="left"))
    inside = vector.knots[low + p + 1 : high]
    knots = np.concatenate([np.full(p + 1, first), inside, np.full(p + 1, last)])
    return KnotVector(knots, p), matrix[low:high]


def _raised(old: KnotVector, new: KnotVector, degree: int) -> Array:
    """The matrix from the coefficients on `old` to those on the elevated `new`.

    A blossom of raised degree is the mean of the old one over all choices of its arguments.
    """
    unit = np.eye(old.count)
    rows = np.empty((new.count, old.count))
    for i in range(new.count):
        arguments = new.knots[i + 1 : i + 1 + degree]
        span = old.span_of(float(new.knots[i]))
        # in descending order no step extrapolates beyond its span, so no digits are lost
        chosen = list(combinations(arguments[::-1], old.degree))
        rows[i] = sum(blossom(old, unit, span, c) for c in chosen) / len(chosen)
    return rows
