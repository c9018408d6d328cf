"""Systems solved by SciPy's adaptive methods, with events: in your coordinates, or of bodies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, overload

import numpy as np

from standoff.checks.arrays import finite
from standoff.checks.names import choice
from standoff.checks.numbers import positive, yes_or_no
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.kernels.dynamics import arrays as K
from standoff.motion import Pose, Twist
from standoff.read_only import KeepsReadOnly
from standoff.simulation.adaptive_bodies import SystemSolution, solve_bodies
from standoff.simulation.adaptive_legs import METHODS, Legs
from standoff.simulation.adaptive_legs import SystemEvent as SystemEvent
from standoff.simulation.generalised_system import GeneralisedSystem
from standoff.simulation.loaded_bodies import Features, LoadedBodies
from standoff.simulation.system import System
from standoff.typing import Array


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


@overload
def solve(
    system: GeneralisedSystem,
    theta: Any,
    rate: Any,
    duration: float,
    *,
    method: str = ...,
    tolerance: float = ...,
    max_step: float | None = ...,
) -> Solution: ...


@overload
def solve(
    system: System,
    *,
    duration: float,
    method: str = ...,
    tolerance: float = ...,
    max_step: float | None = ...,
    allow_overlap: bool = ...,
) -> SystemSolution: ...


def solve(
    system: GeneralisedSystem | System,
    theta: Any = None,
    rate: Any = None,
    duration: float | None = None,
    *,
    method: str = "DOP853",
    tolerance: float = 1e-9,
    max_step: float | None = None,
    allow_overlap: bool = False,
) -> Solution | SystemSolution:
    """Solve a system's equations of motion from time 0.

    At every evaluation the witness points are tracked to roundoff at the coordinates asked for, so
    they are a function of these and not part of the error that the method controls. The solution is
    stopped where a pair touches or separates, and continues from there: the force has a kink there.

    Free bodies turn in charts of rotation vectors, about the rotation at which a leg began; after a
    turn of 1.5 rad the next leg begins, so their rotations stay rotations.

    Raises StandoffTypeError: no system. Raises StandoffError: wrong shapes and numbers; an unknown
    method; an M(θ) that is singular; bodies that overlap at the start; a step that the method could
    not make.

    Parameters
    ----------
    system : GeneralisedSystem or System
        In your own coordinates, or of rigid bodies, which start at their own poses and twists.
    theta, rate : (n,) array_like
        Where a GeneralisedSystem starts; not for a System.
    duration : float
        [time], positive.
    method : str
        One of SciPy's: "RK23", "RK45", "DOP853", "Radau", "BDF", "LSODA".
    tolerance : float
        Relative and absolute tolerance of the state in a step, positive.
    max_step : float, optional
        Longest step [time], a hundredth of the duration if not given: a contact that begins and
        ends within one step is missed.
    allow_overlap : bool
        For a System: start even if bodies overlap.

    Returns
    -------
    Solution, or SystemSolution of a System
    """
    if not isinstance(system, GeneralisedSystem | System):
        raise StandoffTypeError(
            f"system is {shown(system)}: give a GeneralisedSystem or a System.", "system", system
        )
    end = positive(duration, "duration")
    choice(method, "method", METHODS)
    allowed = positive(tolerance, "tolerance")
    overlap = yes_or_no(allow_overlap, "allow_overlap")
    longest = 0.01 * end if max_step is None else positive(max_step, "max_step")
    options = {"method": method, "rtol": allowed, "atol": allowed, "max_step": longest}
    if isinstance(system, System):
        for name, given in (("theta", theta), ("rate", rate)):
            if given is not None:
                raise StandoffError(
                    f"{name} = {shown(given)} belongs to a GeneralisedSystem; the bodies of a "
                    "System start at their own poses and twists: leave it out.",
                    name,
                    given,
                )
        return solve_bodies(system, end, options, overlap)
    first = finite(theta, "theta", (-1,))
    second = finite(rate, "rate", (len(first),))
    legs = _Generalised(system, first, second, longest)
    found = legs.solve(0.0, np.concatenate([first, second]), end, options)
    rows = np.array(found.states)
    distances = np.array([legs.distances(0.0, row) for row in rows])
    n = len(first)
    return Solution(
        found.times, rows[:, :n], rows[:, n:], distances, found.events, legs.evaluations
    )


class _Generalised(Legs):
    """A system in the user's coordinates: the state is (θ, θ')."""

    def __init__(self, system: GeneralisedSystem, first: Array, rate: Array, dt: float) -> None:
        self.system, self.n = system, len(first)
        motion = list(zip(*self._motion(first, rate), strict=True))
        placed = System.placed(system.bodies, system.contact, system.pairs, motion)
        self.bodies = LoadedBodies(placed, dt, allow_overlap=True)

    def _motion(self, theta: Array, rate: Array) -> tuple[list[Pose], list[Twist]]:
        """Poses and twists of the bodies."""
        return self.system.poses(theta), [Twist.of(J @ rate) for J in self.system.jacobians(theta)]

    def place(self, t: float, y: Array) -> None:
        """Put the bodies where a state has them, and track their pairs."""
        poses, twists = self._motion(y[: self.n], y[self.n :])
        for k, (pose, twist) in enumerate(zip(poses, twists, strict=True)):
            o = K.body_row(k)
            numbers = pose.rotation.ravel(), pose.translation, twist.v, twist.omega
            self.bodies.data[o : o + K.N_BODY] = np.concatenate(numbers)
        self.bodies.load(t)

    def slope(self, t: float, y: Array) -> Array:
        self.evaluations += 1
        self.place(t, y)
        theta, rate = y[: self.n], y[self.n :]
        wrenches = [self.bodies.on_body(k) for k in range(len(self.system.bodies))]
        return np.concatenate([rate, self.system.acceleration(t, theta, rate, wrenches)])

    def distances(self, t: float, y: Array) -> list[float]:
        self.place(t, y)
        return self.bodies.distances()

    def features(self, t: float, y: Array) -> Features:
        self.place(t, y)
        return self.bodies.features()
