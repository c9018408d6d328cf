"""A simulation that a page shows: a run that has kept its contacts, or a system that is stepped."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from standoff.errors import StandoffError
from standoff.kernels.dynamics import arrays as K
from standoff.simulation.operator import Operator
from standoff.simulation.pair_contacts import PairContact
from standoff.simulation.rigid_body import FREE
from standoff.simulation.system import System
from standoff.simulation.system_run import SystemRun
from standoff.simulation.system_state import Energy, SystemState
from standoff.typing import Array
from standoff.wording import counted


class Simulated(NamedTuple):
    """What is shown of a simulation.

    Attributes
    ----------
    what : SystemRun or (Operator, SystemState)
        A run with its contacts is played; a state is stepped.
    title : str
        A line for the reader.
    unit : str
        Label of lengths.
    names : tuple of str
        Of the bodies, in the system's order.
    """

    what: SystemRun | tuple[Operator, SystemState]
    title: str
    unit: str
    names: tuple[str, ...]

    @property
    def system(self) -> System:
        """The bodies."""
        return self.what.system if isinstance(self.what, SystemRun) else self.what[0].system

    def pair_names(self, pair: int) -> tuple[str, str]:
        """Names of a pair's bodies."""
        a, b = self.system.pairs[pair]
        return self.names[a], self.names[b]


def simulated(what: SystemRun | tuple[Operator, SystemState]) -> Simulated:
    """Return a simulation from Python, its bodies by their own names.

    Raises StandoffError: a run that has kept no contacts.
    """
    run = what if isinstance(what, SystemRun) else None
    if run is not None and run.told is None:
        raise StandoffError(
            "This run has kept no contacts, which the page draws: make it with "
            "operator.run(..., contacts=True), or show the operator, so.view(operator).",
            "what",
            what,
        )
    system = run.system if run is not None else what[0].system  # type: ignore[index]
    own = [body.body.name for body in system.bodies]
    names = [f"{name} {k}" if own.count(name) > 1 else name for k, name in enumerate(own)]
    return Simulated(what, counted(len(names), "body", "bodies"), "", tuple(names))


class Instant(NamedTuple):
    """A record of a run as a page shows it.

    Attributes
    ----------
    time : float
        [s]
    poses : (n, 4, 4) array
        Of all bodies.
    contacts : tuple of PairContact
    distance : float
        Of the closest pair, signed [length]; inf where there is none.
    energy : Energy
    deepest : float
        Since the start [length].
    uncertified : int
        Answers since the start that were not certified.
    total, greatest : float
        Of the forces of all spots, each without its direction [force].
    """

    time: float
    poses: Array
    contacts: tuple[PairContact, ...]
    distance: float
    energy: Energy
    deepest: float
    uncertified: int
    total: float
    greatest: float


def instant_of(run: SystemRun, row: int) -> Instant:
    """Return a record of a run that has kept its contacts."""
    state = run.state(row)
    contacts = run.contacts(row)
    forces = [float(np.linalg.norm(spot.force)) for each in contacts for spot in each.spots]
    energy = Energy(*(float(values[row]) for values in run.energy))
    return Instant(
        state.time,
        np.array([state.pose(k).matrix for k in range(len(run.system.bodies))]),
        contacts,
        float(run.distances[row].min(initial=np.inf)),
        energy,
        state.deepest,
        state.uncertified,
        sum(forces),
        max(forces, default=0.0),
    )


@dataclass(frozen=True, eq=False)
class SimulationCourse:
    """A run as it is played.

    Attributes
    ----------
    run : SystemRun
    time : (n,) array [s]
    total, greatest : (n,) arrays
        As of `Instant` [force].
    """

    run: SystemRun
    time: Array
    total: Array
    greatest: Array


def course_of(run: SystemRun) -> SimulationCourse:
    """Return a run, which has kept its contacts, as it is played."""
    assert run.told is not None
    forces = np.linalg.norm(run.told.spots[:, K.U_FORCE : K.U_FORCE + 3], axis=1)
    rows = np.repeat(np.arange(len(run.states)), np.diff(run.told.spot_starts))
    greatest = np.zeros(len(run.states))
    np.maximum.at(greatest, rows, forces)
    total = np.bincount(rows, forces, minlength=len(run.states)).astype(float)
    return SimulationCourse(run, run.times, total, greatest)


def usual_force(system: System, seen: Sequence[float] | Array) -> float:
    """Return the force that an arrow's length is made for: the weight of the heaviest free body;
    without gravity the greatest of those that were seen, 1 if there is none."""
    masses = [b.mass_properties.mass for b in system.bodies if b.kind == FREE and b.mass_properties]
    weight = float(np.linalg.norm(system.gravity)) * max(masses)
    return weight or float(np.max(seen, initial=0.0)) or 1.0
