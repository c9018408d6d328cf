"""Rigid bodies solved by SciPy's adaptive methods: charts of rotation vectors, and true rotations.

Within a leg of the solution, a body has turned by exp(f) from the rotation at which the leg began,
and the method integrates the rotation vector f, whose rate is J_r(f)⁻¹ w. A body that has turned
far ends the leg; the next one begins with f = 0 at the rotation reached. So there is no constraint
to keep, and the singularity of the chart, at a full turn, stays far away.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import scipy

from standoff.errors import StandoffError
from standoff.kernels.dynamics import arrays as K
from standoff.read_only import KeepsReadOnly
from standoff.simulation.adaptive_legs import Legs, SystemEvent
from standoff.simulation.loaded_bodies import POWERS, Features, LoadedBodies
from standoff.simulation.packed_system import driven_row
from standoff.simulation.rigid_body import DRIVEN, FREE
from standoff.simulation.system import System
from standoff.simulation.system_run import SystemRun
from standoff.simulation.tolerances import CHART_SERIES
from standoff.typing import Array

CHART: Final = 1.5
"""Radians: a body that has turned farther begins a new chart, as the chart ends at a full turn."""

TURN, CENTRE, VELOCITY, SPIN = 0, 3, 6, 9
WIDTH = 12
"""A free body's part of what is integrated; the energies (POWERS) come after all of them."""


@dataclass(frozen=True, eq=False)
class SystemSolution(KeepsReadOnly):
    """Bodies over time, at the steps that the method chose.

    Attributes
    ----------
    run : SystemRun
        The states at these steps: poses, velocities, distances, forces and energies, as of an
        operator's run.
    events : tuple of SystemEvent
        In order of time.
    evaluations : int
        Of the right-hand side.
    """

    run: SystemRun
    events: tuple[SystemEvent, ...]
    evaluations: int

    def __repr__(self) -> str:
        return (
            f"<SystemSolution of {len(self.run.times)} steps to {self.run.times[-1]:g} s, "
            f"{len(self.events)} events, {self.evaluations} evaluations>"
        )


def solve_bodies(
    system: System, end: float, options: dict[str, Any], allow_overlap: bool
) -> SystemSolution:
    """Solve a system's motion from its bodies' own poses and twists, at time 0."""
    if system.coupler is not None:
        raise StandoffError(
            "The system has a coupler, whose wrench is held from reading to reading: an Operator "
            "follows that, an adaptive method does not.",
            "system",
            system,
        )
    if any(system.of_solids):
        raise StandoffError(
            "The system has a pair with a Solid, whose places of contact go on from tick to tick: "
            "an Operator follows them, an adaptive method, whose evaluations go back and forth, "
            "does not.",
            "system",
            system,
        )
    legs = _Bodies(system, float(options["max_step"]), allow_overlap)
    found = legs.solve(0.0, np.zeros(WIDTH * len(legs.free) + len(POWERS)), end, options)
    states = np.array(found.states)
    accounts = np.array(legs.accounts)
    for array in (states, accounts):
        array.flags.writeable = False
    return SystemSolution(SystemRun(system, states, accounts), found.events, legs.evaluations)


class _Bodies(Legs):
    """A system of rigid bodies."""

    def __init__(self, system: System, dt: float, allow_overlap: bool) -> None:
        self.system = system
        self.bodies = LoadedBodies(system, dt, allow_overlap)
        self.data = self.bodies.data
        self.free = [k for k, body in enumerate(system.bodies) if body.kind == FREE]
        self.masses = [system.bodies[k].mass_properties for k in self.free]
        self.inverses = [np.linalg.inv(m.inertia) for m in self.masses if m is not None]
        self.turns = [np.eye(3)] * len(self.free)
        self.accounts: list[Array] = []
        self.so_far = np.zeros(2)
        self.fresh = True

    def begun(self, t: float, y: Array) -> Array:
        """The state in charts about the rotations that it has."""
        if self.fresh:
            y = self._first()
            self.fresh = False
        else:
            self.turns = [
                self._rotation(k, y[WIDTH * k : WIDTH * k + 3]) for k in range(len(self.free))
            ]
        begun = y.copy()
        for k in range(len(self.free)):
            begun[WIDTH * k : WIDTH * k + 3] = 0.0
        return begun

    def _first(self) -> Array:
        parts = []
        for k, number in enumerate(self.free):
            row = self.data[K.body_row(number) :]
            self.turns[k] = row[K.X_ROTATION : K.X_ROTATION + 9].reshape(3, 3).copy()
            parts += [np.zeros(3), row[K.X_CENTRE : K.X_SPIN + 3]]
        return np.concatenate([*parts, np.zeros(len(POWERS))])

    def _rotation(self, k: int, f: Array) -> Array:
        turned = scipy.spatial.transform.Rotation.from_rotvec(f).as_matrix()
        R = self.turns[k] @ turned
        # its roundoff alone, so that many charts do not add it up
        return np.asarray(0.5 * R @ (3.0 * np.eye(3) - R.T @ R))

    def place(self, t: float, y: Array) -> Array:
        """Put the bodies where a state has them, track their pairs, and return the loads."""
        for number, body in enumerate(self.system.bodies):
            if body.kind == DRIVEN:
                o = K.body_row(number)
                self.data[o : o + K.N_DRIVEN] = driven_row(body, t)
        for k, number in enumerate(self.free):
            o, part = K.body_row(number), y[WIDTH * k : WIDTH * (k + 1)]
            self.data[o : o + 9] = self._rotation(k, part[:3]).ravel()
            self.data[o + K.X_CENTRE : o + K.X_SPIN + 3] = part[CENTRE:]
        return self.bodies.load(t)

    def slope(self, t: float, y: Array) -> Array:
        self.evaluations += 1
        loads = self.place(t, y)
        rates = np.empty_like(y)
        for k, number in enumerate(self.free):
            part, mass = y[WIDTH * k : WIDTH * (k + 1)], self.masses[k]
            assert mass is not None
            o = K.body_row(number)
            R = self.data[o : o + 9].reshape(3, 3)
            own = self.bodies.on_body(number)
            rate = rates[WIDTH * k : WIDTH * (k + 1)]
            rate[TURN:CENTRE] = chart_rate(part[:3], self.inverses[k] @ (R.T @ part[SPIN:]))
            rate[CENTRE:VELOCITY] = part[VELOCITY:SPIN]
            rate[VELOCITY:SPIN] = self.system.gravity + own[:3] / mass.mass
            rate[SPIN:] = own[3:]
        rates[-len(POWERS) :] = loads[-len(POWERS) :]
        return rates

    def distances(self, t: float, y: Array) -> list[float]:
        self.place(t, y)
        return self.bodies.distances()

    def features(self, t: float, y: Array) -> Features:
        self.place(t, y)
        return self.bodies.features()

    def ends(self) -> list[Callable[[float, Array], float]]:
        return [_left(k) for k in range(len(self.free))]

    def kept(self, t: float, y: Array) -> Array:
        """A row of the record, which has only the steps, not what was tried between them."""
        counts = slice(K.S_DEEPEST, K.S_UNCERTIFIED + 1)
        self.data[counts] = self.so_far
        self.place(t, y)
        self.so_far = self.data[counts].copy()
        row = self.data.copy()
        row[list(POWERS)] = y[-len(POWERS) :]
        self.accounts.append(self.bodies.account.copy())
        return row


def _left(k: int) -> Callable[[float, Array], float]:
    """What is left of a body's chart."""

    def left(t: float, y: Array) -> float:
        f = y[WIDTH * k : WIDTH * k + 3]
        return CHART - float(np.sqrt(f @ f))

    return left


def chart_rate(f: Array, w: Array) -> Array:
    """J_r(f)⁻¹ w: the rate of f where exp(f) turns at the body rate w; less than a full turn."""
    square = float(f @ f)
    half = 0.5 * np.sqrt(square)
    near = half < CHART_SERIES
    b = 1.0 / 12.0 + square / 720.0 if near else (1.0 - half / np.tan(half)) / square
    c = np.cross(f, w)
    return np.asarray(w + 0.5 * c + b * np.cross(f, c))
