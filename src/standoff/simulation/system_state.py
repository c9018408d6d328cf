"""What a system carries from tick to tick, as a value, and its energies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from standoff.errors import StandoffError
from standoff.kernels.dynamics import arrays as K
from standoff.kernels.state import arrays as T
from standoff.motion import Pose, Twist
from standoff.read_only import KeepsReadOnly
from standoff.simulation.coupler import VirtualCoupler
from standoff.simulation.coupler_state import CouplerState, packed_state, unpacked_state
from standoff.simulation.rigid_body import FREE
from standoff.simulation.solid_places import SolidContact, place_rows, solid_contact
from standoff.simulation.system import System
from standoff.typing import Array


class Energy(NamedTuple):
    """Energies of a system, each a number or an array of them.

    Attributes
    ----------
    kinetic : float or array
        Of the free bodies.
    potential : float or array
        Of the free bodies in the field of gravity, from the world's origin.
    stored : float or array
        In the springs of the contacts.
    dissipated : float or array
        Lost in the contacts since the start, by damping and friction.
    supplied : float or array
        Given by driven bodies and by a coupler's wrench on its tool since the start.
    shared : float or array
        What the springs of contacts with several spots hold more since the start by no work,
        because they were shared anew among them; less than zero where they hold less. These forces
        are no gradient of an energy, and this is what comes of that.
    """

    kinetic: Any
    potential: Any
    stored: Any
    dissipated: Any
    supplied: Any
    shared: Any = 0.0

    @property
    def mechanical(self) -> Any:
        """Kinetic, potential and stored."""
        return self.kinetic + self.potential + self.stored

    @property
    def balance(self) -> Any:
        """What no step of an exact method changes: mechanical plus dissipated less supplied and
        shared energy."""
        return self.mechanical + self.dissipated - self.supplied - self.shared


class Crossing(NamedTuple):
    """A pair whose bodies may have crossed within a tick, unseen by the contact at its ends.

    Attributes
    ----------
    pair : int
        Its number.
    time : float
        When the first such tick ended [time].
    ticks : int
        How many there were since the start.
    """

    pair: int
    time: float
    ticks: int


@dataclass(frozen=True, eq=False)
class SystemState(KeepsReadOnly):
    """A system at an instant: goes into a run and comes out of it, never changed.

    Attributes
    ----------
    system : System
    data : (n,) array
        Read-only, laid out in ``standoff.kernels.dynamics.arrays``.
    """

    system: System
    data: Array

    @property
    def time(self) -> float:
        """Time [s]."""
        return float(self.data[K.S_TIME])

    def pose(self, body: int) -> Pose:
        """Return the pose of a body's frame in the world."""
        rotation, position = positions(self.system, body, self.data[None])
        return Pose.from_checked(rotation[0], position[0])

    def twist(self, body: int) -> Twist:
        """Return the twist of a body's origin, world axes."""
        v, omega = velocities(self.system, body, self.data[None])
        return Twist(v[0], omega[0])

    def distance(self, pair: int) -> float:
        """Return the signed distance of a pair."""
        return float(distances(self.system, self.data[None])[0, pair])

    def contact(self, pair: int) -> SolidContact:
        """Return the places at which a pair with a solid touches, and what pushes there.

        Raises StandoffError: a pair of convex bodies; a state that keeps no places: one of a
        record, or a start.
        """
        if not self.system.of_solids[pair]:
            raise StandoffError(
                f"Pair {pair} is of convex bodies, which touch at their witness points: ask "
                "run.forces, run.spots and run.witness_points.",
                "pair",
                pair,
            )
        return solid_contact(*_kept(self, pair))

    @property
    def deepest(self) -> float:
        """The greatest depth of any pair since the start, length; 0 where none touched."""
        return float(self.data[K.S_DEEPEST])

    @property
    def uncertified(self) -> int:
        """How many answers of the trackers since the start were not certified, and in how many
        ticks a pair may have crossed (`crossings`): what is behind these is not known."""
        return int(self.data[K.S_UNCERTIFIED]) + sum(each.ticks for each in self.crossings)

    @property
    def crossings(self) -> tuple[Crossing, ...]:
        """The pairs whose bodies may have crossed within a tick since the start: they moved farther
        in it than both gaps prove them apart, and no contact at its end tells of it. Take a shorter
        step, or a stiffer contact."""
        counts = _pair_rows(self.system, self.data[None])[0, :, -2:]
        found = np.flatnonzero(counts[:, 0])
        return tuple(Crossing(int(k), float(counts[k, 1]), int(counts[k, 0])) for k in found)

    @property
    def jumps(self) -> int:
        """How many places of contact of solids have ended since the start while they were pressed,
        without another one in their stead: their force ended with them."""
        return int(self.data[K.S_JUMPS])

    @property
    def eased(self) -> int:
        """How many ticks since the start had a body whose friction, taken whole, would have thrown
        its slip back, and was taken in part: a step too long, or a slip speed too small, for what
        pressed there."""
        return int(self.data[K.S_EASED])

    @property
    def coupler(self) -> CouplerState | None:
        """The coupler's state; None where the system has none."""
        if self.system.coupler is None:
            return None
        return unpacked_state(self.data[coupler_at(self.system) :])

    def engage(self) -> SystemState:
        """Return the same state with its coupler engaged, its wrench growing from zero.

        Raises StandoffError: the system has no coupler.
        """
        own, state = self._coupled()
        return self._with(own, own.engage(state))

    def disengage(self) -> SystemState:
        """Return the same state with its coupler at rest until it is engaged again.

        Raises StandoffError: the system has no coupler.
        """
        own, state = self._coupled()
        return self._with(own, own.disengage(state))

    def _coupled(self) -> tuple[VirtualCoupler, CouplerState]:
        own, state = self.system.coupler, self.coupler
        if own is None or state is None:
            raise StandoffError(
                "The system has no coupler: give one with System(..., coupler=..., tool=...)."
            )
        return own, state

    def _with(self, own: VirtualCoupler, coupler: CouplerState) -> SystemState:
        kept = self.data[: coupler_at(self.system)]
        behind = self.data[state_length(self.system) :]
        data = np.concatenate([kept, packed_state(coupler, own.past), behind])
        data.flags.writeable = False
        return SystemState(self.system, data)

    def __repr__(self) -> str:
        return f"<SystemState at {self.time:g} s>"


def kept_places(state: SystemState, pair: int) -> Array:
    """(n, PLACE_REALS) places that a state keeps of a pair of solids, world."""
    return place_rows(*_kept(state, pair))


def _kept(state: SystemState, pair: int) -> tuple[Array, Pose]:
    """What a state keeps of a pair of solids, and where A is."""
    at = state_length(state.system)
    first, last = state.system.kept_starts()[pair : pair + 2]
    return state.data[at + first : at + last], state.pose(state.system.pairs[pair][0])


def state_length(system: System) -> int:
    """How many numbers a row of states has: all of a state except the polytopes that are kept."""
    own = system.coupler
    return coupler_at(system) + (0 if own is None else len(packed_state(own.start(), own.past)))


def coupler_at(system: System) -> int:
    """Where a coupler's state begins in a row of states: after all bodies and pairs."""
    return K.STATE_HEADER + K.N_BODY * len(system.bodies) + K.N_PAIR * len(system.pairs)


def _row(body: int) -> int:
    return K.STATE_HEADER + K.N_BODY * body


def _turns(body: int, rows: Array) -> Array:
    at = _row(body) + K.X_ROTATION
    return rows[:, at : at + 9].reshape(-1, 3, 3)


def _part(body: int, rows: Array, part: int) -> Array:
    at = _row(body) + part
    return rows[:, at : at + 3]


def positions(system: System, body: int, rows: Array) -> tuple[Array, Array]:
    """(n, 3, 3) rotations and (n, 3) positions of a body's frame, of rows of states."""
    rotations, at = _turns(body, rows), _part(body, rows, K.X_CENTRE)
    mass = system.bodies[body].mass_properties
    if system.bodies[body].kind == FREE and mass is not None:
        at = at - rotations @ mass.centre
    return rotations, at


def velocities(system: System, body: int, rows: Array) -> tuple[Array, Array]:
    """(n, 3) velocities of a body's origin and angular velocities, world, of rows of states."""
    v, spin = _part(body, rows, K.X_VELOCITY), _part(body, rows, K.X_SPIN)
    mass = system.bodies[body].mass_properties
    if system.bodies[body].kind != FREE or mass is None:
        return v, spin
    R = _turns(body, rows)
    inverse = np.linalg.inv(mass.inertia)
    omega = np.einsum("nij,jk,nlk,nl->ni", R, inverse, R, spin)
    return v - np.cross(omega, R @ mass.centre), omega


def momenta(body: int, rows: Array) -> Array:
    """(n, 3) angular momenta of a free body about its centre, world, of rows of states."""
    return _part(body, rows, K.X_SPIN)


def _pair_rows(system: System, rows: Array) -> Array:
    """(n, pairs, N_PAIR) of rows of states."""
    at = K.STATE_HEADER + K.N_BODY * len(system.bodies)
    return rows[:, at : coupler_at(system)].reshape(len(rows), len(system.pairs), K.N_PAIR)


def answers(system: System, rows: Array) -> Array:
    """(n, pairs, N_OUT) answers of the trackers."""
    return _pair_rows(system, rows)[:, :, T.N_STATE : T.N_STATE + T.N_OUT]


def distances(system: System, rows: Array) -> Array:
    """(n, pairs) signed distances, of rows of states."""
    return answers(system, rows)[:, :, T.DISTANCE]


def witness_points(system: System, rows: Array) -> tuple[Array, Array, Array]:
    """Points on A, on B and normals, (n, pairs, 3) each, world, of rows of states."""
    out = answers(system, rows)
    return (
        out[:, :, T.POINT_A : T.POINT_A + 3],
        out[:, :, T.POINT_B : T.POINT_B + 3],
        out[:, :, T.NORMAL : T.NORMAL + 3],
    )
