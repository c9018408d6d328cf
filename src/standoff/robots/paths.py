"""Joint paths: waypoints straight in q, a spline in q, or a function with its greatest speeds."""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.robots.certify_tolerances import SPEED_SLACK
from standoff.robots.kinematics import Kinematics
from standoff.robots.path_kinds import BoundedFunctionPath, FunctionPath, JointPath, StraightPath
from standoff.typing import Array, Ints


def joint_path(path: Any, kinematics: Kinematics, times: Any = None) -> JointPath:
    """Read what may be a path.

    Raises StandoffError: waypoints of another size, fewer than two, NaN; a function without its
    greatest speeds.
    """
    if isinstance(path, JointPath):
        return path
    if is_spline(path):
        if times is not None:
            raise StandoffError("times: a spline has its own.", "times", times)
        return SplinePath(path, kinematics)
    if isinstance(path, FunctionPath):
        if times is not None:
            raise StandoffError("times: a function has its own.", "times", times)
        return BoundedFunctionPath(path, kinematics)
    if callable(path):
        raise StandoffTypeError(
            f"path = {shown(path)}: of a function, or of a spline that is no PPoly, BPoly or "
            "BSpline of SciPy, the greatest speeds must be known; give "
            "so.robots.FunctionPath(function, duration, speed).",
            "path",
            path,
        )
    return StraightPath(path, kinematics, times)


__all__ = ["BoundedFunctionPath", "FunctionPath", "JointPath", "joint_path"]


# Splines in q as joint paths.


class SplinePath(JointPath):
    """A piecewise polynomial of SciPy: ``CubicSpline``, ``PchipInterpolator``, ``BSpline``, ...

    Only of robots whose joints are hinges and slides. It is read by its class, from the first to
    the last of its knots, whatever it says of times beyond them.

    Parameters
    ----------
    spline : PPoly, BPoly or BSpline
        From times to configurations (nq,).
    kinematics : Kinematics
    """

    def __init__(self, spline: Any, kinematics: Kinematics) -> None:
        if kinematics.nq != kinematics.nv:
            raise StandoffError(
                "A spline in q leaves the unit quaternions of ball joints and free joints: give "
                "waypoints, or a function with its greatest speeds.",
                "path",
                spline,
            )
        x, c = _read(spline)
        if c.ndim != 3 or c.shape[2] != kinematics.nq:
            raise StandoffError(
                f"The spline's values have the shape {tuple(c.shape[2:])}: give one of "
                f"({kinematics.nq},), a number for each of the robot's joint positions.",
                "path",
                spline,
            )
        apart = np.diff(x) > 0.0
        self.breaks = np.append(x[:-1][apart], x[-1])
        self._c = np.ascontiguousarray(c[:, apart])
        if not (np.isfinite(self._c).all() and np.isfinite(self.breaks).all()):
            raise StandoffError("The spline has a NaN or infinite number.", "path", spline)
        _check_jumps(self.breaks, self._c, spline)
        self._piece_speeds = self._bounds(
            self.breaks[:-1], self.breaks[1:], np.arange(len(self.breaks) - 1), 1
        )

    def at(self, times: Array) -> Array:
        k = np.clip(np.searchsorted(self.breaks, times, side="right") - 1, 0, self._c.shape[1] - 1)
        return _horner(self._c[:, k], (times - self.breaks[k])[:, None])

    def speeds(self, first: Array, last: Array, pieces: Ints) -> tuple[Array, Array | None]:
        return self._bounds(first, last, pieces, 1), self._bounds(first, last, pieces, 2)

    def extremes(self) -> Array:
        from scipy.interpolate import PPoly

        turns = PPoly(self._c, self.breaks).derivative().roots(False, False)
        found = [np.asarray(each, dtype=float) for each in np.asarray(turns, dtype=object).flat]
        every = np.concatenate([self.breaks, *found])
        kept: Array = every[np.isfinite(every)]  # nan: a joint that stands still from there on
        return kept

    @property
    def piece_speeds(self) -> Array:
        return self._piece_speeds

    def _bounds(self, first: Array, last: Array, pieces: Ints, order: int) -> Array:
        """Greatest size of a derivative: its value in the middle, and all higher ones from there.

        A polynomial's Taylor series ends, so that the sum of the sizes of its terms is a bound.
        """
        half = 0.5 * (last - first)[:, None]
        u = (0.5 * (first + last) - self.breaks[pieces])[:, None]
        c, factor = self._c[:, pieces], np.ones(half.shape)
        total = np.zeros((len(pieces), self._c.shape[2]))
        for _ in range(order):
            c = _derived(c)
        for k in range(1, len(c) + 1):
            total += np.abs(_horner(c, u)) * factor
            c = _derived(c)
            factor = factor * half / k
        return total * (1.0 + SPEED_SLACK)


def is_spline(path: Any) -> bool:
    """Is it of a class that `SplinePath` reads?"""
    from scipy.interpolate import BPoly, BSpline, PPoly

    return isinstance(path, PPoly | BPoly | BSpline)


def _read(spline: Any) -> tuple[Array, Array]:
    """Knots (n + 1,), which do not fall, and coefficients by powers of the time from the knot
    before, the highest first (k + 1, n, nq).

    Raises StandoffError: complex numbers, knots that fall.
    """
    from scipy.interpolate import BPoly, BSpline, PPoly

    if np.iscomplexobj(spline.c):
        raise StandoffError(
            f"The spline's coefficients are of {spline.c.dtype}: give real ones.", "path", spline
        )
    x = np.asarray(spline.t if isinstance(spline, BSpline) else spline.x, dtype=float)
    falls = np.flatnonzero(np.diff(x) < 0.0)
    if len(falls):
        k = int(falls[0])
        raise StandoffError(
            f"The spline's times fall, from {float(x[k])!r} to {float(x[k + 1])!r}: give one whose "
            "times rise.",
            "path",
            spline,
        )
    if isinstance(spline, BSpline):
        return _powers(x, np.asarray(spline.c, dtype=float), int(spline.k))
    powers = PPoly.from_bernstein_basis(spline) if isinstance(spline, BPoly) else spline
    return x, np.asarray(powers.c, dtype=float)


def _powers(t: Array, c: Array, k: int) -> tuple[Array, Array]:
    """A B-spline's knots, and its coefficients by powers.

    By de Boor's algorithm in each piece alone: where knots are repeated the spline may be without
    derivatives, or even jump, and the pieces are polynomials still.
    """
    at = k + np.flatnonzero(np.diff(t[k : len(t) - k]) > 0.0)
    rest = (1,) * (c.ndim - 1)
    rows, factor = [], 1.0
    points = [c[at - k + j] for j in range(k + 1)]  # of the m-th derivative, of degree k - m
    for m in range(k + 1):
        value, p = list(points), k - m
        for r in range(1, p + 1):
            for j in range(p, r - 1, -1):
                left, right = t[at - p + j], t[at + 1 + j - r]
                part = ((t[at] - left) / (right - left)).reshape(-1, *rest)
                value[j] = (1.0 - part) * value[j - 1] + part * value[j]
        rows.append(value[p] / factor)
        factor *= m + 1.0
        spans = [(t[at + 1 + j] - t[at - p + 1 + j]).reshape(-1, *rest) for j in range(p)]
        points = [p * (points[j + 1] - points[j]) / spans[j] for j in range(p)]
    return np.append(t[at], t[at[-1:] + 1]), np.stack(rows[::-1])


def _derived(c: Array) -> Array:
    """The derivative of polynomials whose highest coefficients come first."""
    powers = np.arange(len(c) - 1, 0, -1.0)
    return c[:-1] * powers.reshape(-1, *[1] * (c.ndim - 1))


def _horner(c: Array, u: Array) -> Array:
    found = np.zeros(np.broadcast_shapes(c.shape[1:], u.shape))
    for row in c:
        found = found * u + row
    return found


def _check_jumps(breaks: Array, c: Array, spline: Any) -> None:
    """Refuse a spline that jumps: between the two values no motion is given."""
    ends = _horner(c, np.diff(breaks)[:, None])[:-1]
    jumps = np.abs(ends - c[-1, 1:])
    size = 1.0 + np.abs(c[-1]).max(initial=0.0)
    if jumps.size and jumps.max() > SPEED_SLACK * size:
        k = int(np.argmax(jumps.max(axis=1)))
        raise StandoffError(
            f"The spline jumps by {jumps[k].max():.3g} at {float(breaks[k + 1])!r} s: give one "
            "that is continuous.",
            "path",
            spline,
        )
