"""A system in the user's coordinates, solved by SciPy's adaptive methods, with events."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final, NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from standoff.errors import StandoffError, StandoffTypeError
from standoff.geometry.validation import finite
from standoff.motion import Twist, inputs
from standoff.read_only import KeepsReadOnly
from standoff.real_numbers import shown
from standoff.simulation.generalised_system import GeneralisedSystem
from standoff.simulation.tolerances import EVENT_INSTANT
from standoff.tracking import PredictorCorrector, Proximity, Tracker
from standoff.tracking.choices import positive_number

Array = NDArray[np.float64]

METHODS: Final = ("RK23", "RK45", "DOP853", "Radau", "BDF", "LSODA")


MOST_EVENTS: Final = 10_000
"""Contacts and releases of one solution: bodies that settle touch ever more often."""


class SystemEvent(NamedTuple):
    """Something that happened at an instant.

    Attributes
    ----------
    time : float
        [s]
    kind : str
        "contact", "release" or "switch".
    pair : int
    source, target : str
        Features of A and B before and after a switch; empty for the others.
    """

    time: float
    kind: str
    pair: int
    source: str = ""
    target: str = ""


@dataclass(frozen=True, eq=False)
class Solution(KeepsReadOnly):
    """Coordinates over time, at the steps that the method chose.

    Attributes
    ----------
    times : (m,) array
    theta, rate : (m, n) arrays
    distances : (m, pairs) array
        Signed.
    events : tuple of SystemEvent
        In order of time.
    evaluations : int
        Of the right-hand side.
    """

    times: Array
    theta: Array
    rate: Array
    distances: Array
    events: tuple[SystemEvent, ...]
    evaluations: int

    def __repr__(self) -> str:
        return (
            f"<Solution of {len(self.times)} steps to {self.times[-1]:g} s, "
            f"{len(self.events)} events, {self.evaluations} evaluations>"
        )


def solve(
    system: GeneralisedSystem,
    theta: Any,
    rate: Any,
    duration: float,
    *,
    method: str = "DOP853",
    tolerance: float = 1e-9,
    max_step: float | None = None,
) -> Solution:
    """Solve a system's equations of motion from θ and θ' at time 0.

    At every evaluation the witness points are tracked to roundoff at the coordinates asked for,
    so they are a function of θ and no part of the error that the method controls. The solution is
    stopped where a pair touches or parts, and goes on from there: the force has a kink there.

    Parameters
    ----------
    system : GeneralisedSystem
    theta, rate : (n,) array_like
        Where it starts.
    duration : float
        [time], positive.
    method : str
        One of SciPy's: "RK23", "RK45", "DOP853", "Radau", "BDF", "LSODA".
    tolerance : float
        Relative and absolute tolerance of θ and θ' in a step, positive.
    max_step : float, optional
        Longest step [time], a hundredth of the duration if not given: a contact that begins and
        ends within one step is not seen.

    Returns
    -------
    Solution

    Raises
    ------
    StandoffTypeError
        No system.
    StandoffError
        Wrong shapes and numbers; an unknown method; an M(θ) that is singular; a step that the
        method could not make.
    """
    if not isinstance(system, GeneralisedSystem):
        raise StandoffTypeError(
            f"system is {shown(system)}: give a GeneralisedSystem.", "system", system
        )
    first = finite(theta, "theta", (-1,))
    second = finite(rate, "rate", (len(first),))
    end = positive_number(duration, "duration")
    inputs.word(method, "method", METHODS)
    allowed = positive_number(tolerance, "tolerance")
    longest = 0.01 * end if max_step is None else positive_number(max_step, "max_step")
    options = {"method": method, "rtol": allowed, "atol": allowed, "max_step": longest}
    return _Solver(system, len(first)).solve(np.concatenate([first, second]), end, options)


class _Solver:
    """The trackers' warm starts, and what is collected on the way."""

    def __init__(self, system: GeneralisedSystem, n: int) -> None:
        self.system, self.n = system, n
        law = PredictorCorrector(predictor="none", depth="local")
        self.trackers = [
            Tracker(system.bodies[a], system.bodies[b], law=law) for a, b in system.pairs
        ]
        self.warm: list[Any] = [None] * len(self.trackers)
        self.evaluations = 0

    def answers(self, y: Array) -> list[Proximity]:
        """The pairs' witness points at a state."""
        theta, rate = y[: self.n], y[self.n :]
        poses = self.system.poses(theta)
        twists = [Twist.of(J @ rate) for J in self.system.jacobians(theta)]
        found = []
        for k, (tracker, (a, b)) in enumerate(zip(self.trackers, self.system.pairs, strict=True)):
            given = poses[a], poses[b], twists[a], twists[b]
            if self.warm[k] is None:
                self.warm[k] = tracker.start(*given)
                found.append(self.warm[k].proximity)
            else:
                self.warm[k], answer = tracker.step(self.warm[k], *given)
                found.append(answer)
        return found

    def slope(self, t: float, y: Array) -> Array:
        self.evaluations += 1
        theta, rate = y[: self.n], y[self.n :]
        turning = self.system.acceleration(t, theta, rate, self.answers(y))
        return np.concatenate([rate, turning])

    def solve(self, y: Array, end: float, options: dict[str, Any]) -> Solution:
        times, states, events = [0.0], [y], []
        t, inside = 0.0, [answer.distance < 0.0 for answer in self.answers(y)]
        while t < end:
            crossing = [self._crossing(k, within) for k, within in enumerate(inside)]
            part = scipy.integrate.solve_ivp(
                self.slope, (t, end), y, events=crossing, dense_output=True, **options
            )
            if not part.success:
                raise StandoffError(
                    f"{options['method']} failed at {part.t[-1]:g} s: {part.message}"
                )
            events += self._switches(part)
            times += list(part.t[1:])
            states += list(part.y.T[1:])
            t, y = float(part.t[-1]), part.y[:, -1]
            for k, found in enumerate(part.t_events):
                if len(found):
                    kind = "release" if inside[k] else "contact"
                    events.append(SystemEvent(float(found[-1]), kind, k))
                    inside[k] = not inside[k]
            if len(events) > MOST_EVENTS:
                raise StandoffError(
                    f"more than {MOST_EVENTS} contacts, releases and switches until {t:g} s: give "
                    "the contact more damping, or a shorter duration.",
                    "duration",
                )
        rows = np.array(states)
        distances = np.array([[a.distance for a in self.answers(row)] for row in rows])
        ordered = tuple(sorted(events, key=lambda event: event.time))
        theta, rate = rows[:, : self.n], rows[:, self.n :]
        return Solution(np.array(times), theta, rate, distances, ordered, self.evaluations)

    def _crossing(self, pair: int, inside: bool) -> Any:
        """Where a pair that is apart touches, or one that touches parts."""

        def distance(t: float, y: Array) -> float:
            return self.answers(y)[pair].distance

        distance.terminal = True  # type: ignore[attr-defined]
        distance.direction = 1.0 if inside else -1.0  # type: ignore[attr-defined]
        return distance

    def _features(self, y: Array) -> list[tuple[str, str]]:
        return [(str(answer.feature_a), str(answer.feature_b)) for answer in self.answers(y)]

    def _switches(self, part: Any) -> list[SystemEvent]:
        """Changes of features between the steps, each located by halving."""
        found = []
        before = self._features(part.y[:, 0])
        for start, end in zip(part.t[:-1], part.t[1:], strict=True):
            after = self._features(part.sol(end))
            for pair, (old, new) in enumerate(zip(before, after, strict=True)):
                if old != new:
                    at = self._located(part.sol, pair, old, (float(start), float(end)))
                    found.append(SystemEvent(at, "switch", pair, " ".join(old), " ".join(new)))
            before = after
        return found

    def _located(
        self, states: Any, pair: int, old: tuple[str, str], between: tuple[float, float]
    ) -> float:
        low, high = between
        while high - low > EVENT_INSTANT * max(1.0, high):
            middle = 0.5 * (low + high)
            if not low < middle < high:
                break
            same = self._features(states(middle))[pair] == old
            low, high = (middle, high) if same else (low, middle)
        return high
