"""Configurations over time with bounds of the joints' speeds: waypoints, or a function."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from standoff.checks.arrays import finite, numbers
from standoff.checks.numbers import number
from standoff.errors import StandoffError
from standoff.read_only import KeepsReadOnly
from standoff.robots.certify_tolerances import SPEED_SLACK
from standoff.robots.kinematics import Kinematics
from standoff.robots.motions import Motions
from standoff.typing import Array, Ints

FIRST_LOOKS = 65
"""Instants at which a function is tried before the proof begins: its limits and its speeds."""


class JointPath(KeepsReadOnly, ABC):
    """Configurations over time, with bounds of the joints' speeds and accelerations.

    Attributes
    ----------
    breaks : (n + 1,) array
        Times at which a piece begins, and the end [s].
    """

    breaks: Array

    @property
    def start(self) -> float:
        """Where it begins [s]."""
        return float(self.breaks[0])

    @property
    def end(self) -> float:
        """Where it ends [s]."""
        return float(self.breaks[-1])

    @abstractmethod
    def at(self, times: Array) -> Array:
        """(m, nq): configurations."""

    @abstractmethod
    def speeds(self, first: Array, last: Array, pieces: Ints) -> tuple[Array, Array | None]:
        """Greatest joint speeds and accelerations (m, nv), each within an interval of one piece.

        None: the accelerations are not bounded.
        """

    def extremes(self) -> Array:
        """Times among which each joint is as far as it gets; of a function, some (m,)."""
        return self.breaks

    @property
    @abstractmethod
    def piece_speeds(self) -> Array:
        """(n, nv): the greatest joint speeds in each piece."""


class StraightPath(JointPath):
    """Waypoints, and between two of them a motion at a constant velocity of the package's own.

    It is ``integrate`` from one waypoint along the ``difference`` to the next: of hinges and
    slides a line in q. Pinocchio's free and planar joints go along a screw and an arc, as their
    velocities are in axes that turn; MuJoCo's free joints along a line.

    Parameters
    ----------
    waypoints : (n, nq) array
        At least two.
    kinematics : Kinematics
    times : (n,) array, optional
        Increasing [s]; 0, 1, 2, ... if not given.
    """

    def __init__(self, waypoints: Any, kinematics: Kinematics, times: Any = None) -> None:
        points = _waypoints(waypoints, kinematics)
        self.waypoints = points
        self.breaks = _times(times, len(points))
        spans = np.diff(self.breaks)
        self._kinematics = kinematics
        self._plain = kinematics.nq == kinematics.nv
        if self._plain:
            ways = np.diff(points, axis=0)
        else:
            pairs = pairwise(points)
            ways = np.array([kinematics.difference(p, q) for p, q in pairs])
        self._ways = ways
        with np.errstate(over="ignore", divide="ignore"):
            self._speeds = np.abs(ways) / spans[:, None]
        if not np.isfinite(self._speeds).all():
            k = int(np.argmax(~np.isfinite(self._speeds).all(axis=1)))
            raise StandoffError(
                f"times {self.breaks[k]!r} and {self.breaks[k + 1]!r} are too near to each other "
                f"for the way from waypoint {k} to {k + 1}.",
                "times",
                times,
            )

    def at(self, times: Array) -> Array:
        k = np.clip(np.searchsorted(self.breaks, times, side="right") - 1, 0, len(self._ways) - 1)
        span = self.breaks[k + 1] - self.breaks[k]
        part = (times - self.breaks[k]) / span
        if self._plain:
            found: Array = self.waypoints[k] + part[:, None] * self._ways[k]
            return found
        integrate = self._kinematics.integrate
        return np.array(
            [
                integrate(self.waypoints[i], s * self._ways[i])
                for i, s in zip(k.tolist(), part.tolist(), strict=True)
            ]
        ).reshape(len(times), -1)

    def speeds(self, first: Array, last: Array, pieces: Ints) -> tuple[Array, Array | None]:
        found = self._speeds[pieces]
        return found, np.zeros_like(found)

    @property
    def piece_speeds(self) -> Array:
        return self._speeds


class FunctionPath(NamedTuple):
    """A function of time that returns configurations, with the greatest speeds of its joints.

    The proof is only as good as these: where one is too small, it may be wrong. They are checked
    between the instants that are looked at.

    Attributes
    ----------
    function : callable
        From a time [s] to a configuration (nq,).
    duration : float
        [s]
    speed : (nv,) array, or number for all
        Greatest sizes of the numbers of the package's velocity v, by which its ``integrate`` goes:
        they are not dq/dt. Of a ball joint those of its turning; of Pinocchio's free and planar
        joints in the axes that turn with them.
    acceleration : (nv,) array, or number for all, optional
        Greatest derivatives of these velocities: with them fewer steps are needed.
    start : float
        Time at which it begins [s].
    """

    function: Callable[[float], Any]
    duration: float
    speed: Any
    acceleration: Any = None
    start: float = 0.0


class BoundedFunctionPath(JointPath):
    """A `FunctionPath` of a robot, read."""

    def __init__(self, given: FunctionPath, kinematics: Kinematics) -> None:
        begin, nv = number(given.start, "start"), kinematics.nv
        self.breaks = _times([begin, begin + number(given.duration, "duration")], 2, "duration")
        self._function, self._kinematics = given.function, kinematics
        self._speed = _limits(given.speed, "speed", nv)
        most = given.acceleration
        self._acceleration = None if most is None else _limits(most, "acceleration", nv)

    def at(self, times: Array) -> Array:
        found = [self._kinematics.check(self._function(t)) for t in times.tolist()]
        return np.array(found, dtype=float).reshape(len(times), self._kinematics.nq)

    def speeds(self, first: Array, last: Array, pieces: Ints) -> tuple[Array, Array | None]:
        shape = len(first), len(self._speed)
        if self._acceleration is None:
            return np.broadcast_to(self._speed, shape), None
        return np.broadcast_to(self._speed, shape), np.broadcast_to(self._acceleration, shape)

    def extremes(self) -> Array:
        return np.linspace(self.start, self.end, FIRST_LOOKS)

    @property
    def piece_speeds(self) -> Array:
        return self._speed[None]

    def check_speeds(self, times: Array, q: Array, motions: Motions) -> None:
        """Refuse configurations at increasing times that are farther apart than the speeds allow.

        Each motion is looked at by itself, and by its length where its velocity has several
        numbers: in axes that turn, one number's part of the way is not its speed's.

        Raises StandoffError.
        """
        if len(times) < 2:
            return
        speeds = motions.rates(self._speed[None])[:, : motions.size]
        spans = np.diff(times)[:, None]
        differences = [self._kinematics.difference(a, b) for a, b in pairwise(q)]
        ways = motions.least_ways(q, np.array(differences))
        size = np.abs(q).max(axis=1, initial=0.0)[:-1, None]
        excess = ways - speeds * spans
        wrong = excess > SPEED_SLACK * (1.0 + speeds * spans + size)
        if wrong.any():
            k = int(np.argmax(wrong.any(axis=1)))
            j = int(np.argmax(excess[k]))
            at, count = int(motions.v_at[j]), int(motions.v_count[j])
            which = f"velocity {at}" if count == 1 else f"velocity {at} to {at + count - 1}"
            raise StandoffError(
                f"path: {which} is {ways[k, j] / spans[k, 0]:.6g} between {times[k]!r} and "
                f"{times[k + 1]!r} s, but its greatest speed is given as {speeds[0, j]:.6g}: no "
                "proof would hold.",
                "speed",
                self._speed,
            )


def _waypoints(given: Any, kinematics: Kinematics) -> Array:
    points = numbers(given, "path", None)
    if points.ndim != 2 or points.shape[1] != kinematics.nq:
        raise StandoffError(
            f"path has the shape {points.shape}: give waypoints (n, {kinematics.nq}), one row of "
            f"the robot's {kinematics.nq} joint positions each.",
            "path",
            given,
        )
    if len(points) < 2:
        raise StandoffError(
            f"path has {len(points)} waypoint: give two or more; of one configuration ask "
            "robot.clearance(q).",
            "path",
            given,
        )
    found = np.empty_like(points)
    for k, point in enumerate(points):
        try:
            found[k] = kinematics.check(point)
        except StandoffError as error:
            raise type(error)(f"Waypoint {k}: {error}", "path", point) from error
    found.flags.writeable = False
    return found


def _times(given: Any, n: int, name: str = "times") -> Array:
    times = np.arange(float(n)) if given is None else np.array(finite(given, name, (-1,)))
    if len(times) != n:
        raise StandoffError(f"times are {len(times)}: give one of each of {n} waypoints.", name)
    if not (np.diff(times) > 0.0).all():
        k = int(np.argmin(np.diff(times)))
        raise StandoffError(
            f"{name}: {float(times[k + 1])!r} comes after {float(times[k])!r} [s]; give "
            "increasing times.",
            name,
            given,
        )
    times.flags.writeable = False
    return times


def _limits(given: Any, name: str, nv: int) -> Array:
    found = numbers(given, name, None)
    if found.ndim == 0:
        found = np.full(nv, float(found))
    found = np.array(finite(found, name, (nv,)))
    if (found < 0.0).any():
        raise StandoffError(f"{name} = {found}: give sizes, zero or more.", name, given)
    found.flags.writeable = False
    return found
