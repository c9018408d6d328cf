"""The record of a run of a system."""

from __future__ import annotations

from dataclasses import dataclass

from standoff.checks.numbers import whole_number
from standoff.errors import StandoffError
from standoff.kernels.dynamics import arrays as K
from standoff.kernels.entries import simulation as E
from standoff.read_only import KeepsReadOnly
from standoff.simulation import system_state as S
from standoff.simulation.coupler_run import CouplerRun, coupler_run
from standoff.simulation.pair_contacts import ContactRows, PairContact, pair_contacts
from standoff.simulation.system import System
from standoff.simulation.system_state import Crossing, Energy, SystemState
from standoff.tracking.rows import AnswerRows
from standoff.typing import Array


@dataclass(frozen=True, eq=False)
class SystemRun(KeepsReadOnly):
    """States of a system at even times, the first and the last among them.

    Attributes
    ----------
    system : System
    states : (n, m) array
        A row each, laid out in ``standoff.kernels.dynamics.arrays``.
    accounts : (n, k) array
        Energies and contacts of each, laid out in ``standoff.kernels.entries.simulation``.
    last : SystemState, optional
        The last one as the run left it, with what pairs in penetration have kept of their proofs.
    told : ContactRows, optional
        Spots and places of all records, of a run that was asked for its contacts.
    """

    system: System
    states: Array
    accounts: Array
    last: SystemState | None = None
    told: ContactRows | None = None

    @property
    def times(self) -> Array:
        """(n,) times [s]."""
        return self.states[:, K.S_TIME]

    @property
    def final(self) -> SystemState:
        """The last state."""
        return self.state(len(self.states) - 1) if self.last is None else self.last

    def state(self, row: int) -> SystemState:
        """Return a state of the record, from which a run can continue; rows below 0 count from the
        end.

        Raises StandoffError: no row of the record.
        """
        data = self.states[self._checked(row)].copy()
        data.flags.writeable = False
        return SystemState(self.system, data)

    def rotations(self, body: int) -> Array:
        """Return the rotations of a body's frame, (n, 3, 3)."""
        return S.positions(self.system, body, self.states)[0]

    def positions(self, body: int) -> Array:
        """Return the positions of a body's origin, (n, 3)."""
        return S.positions(self.system, body, self.states)[1]

    def velocities(self, body: int) -> Array:
        """Return the velocities of a body's origin, (n, 3), world axes."""
        return S.velocities(self.system, body, self.states)[0]

    def angular_velocities(self, body: int) -> Array:
        """Return the angular velocities of a body, (n, 3), world axes."""
        return S.velocities(self.system, body, self.states)[1]

    def angular_momenta(self, body: int) -> Array:
        """Return the angular momenta of a free body about its centre of mass, (n, 3), world."""
        return S.momenta(body, self.states)

    @property
    def distances(self) -> Array:
        """(n, pairs) signed distances, less than zero in overlap."""
        return S.distances(self.system, self.states)

    @property
    def witness_points(self) -> tuple[Array, Array, Array]:
        """Points on A, on B, and normals from A to B, each (n, pairs, 3), world."""
        return S.witness_points(self.system, self.states)

    def answers(self, pair: int) -> AnswerRows:
        """Return the tracker's answers of a pair by name, n rows: features, parameters, bounds."""
        return AnswerRows(S.answers(self.system, self.states)[:, pair])

    @property
    def forces(self) -> Array:
        """(n, pairs, 3) forces of the contacts on the second body of each pair, world."""
        return self._touches()[:, :, K.T_FORCE : K.T_FORCE + 3]

    @property
    def spots(self) -> Array:
        """(n, pairs) numbers of spots at which the pairs touch."""
        return self._touches()[:, :, K.T_SPOTS].astype(int)

    def contacts(self, row: int) -> tuple[PairContact, ...]:
        """Return all contacts of a record: pairs that touch or nearly do, with all their places and
        what each spot pushes. Rows below 0 count from the end.

        Raises StandoffError: a run that was not asked for them; no row of the record.
        """
        if self.told is None:
            raise StandoffError(
                "This run has kept no contacts: operator.run(..., contacts=True) keeps those of "
                "each record."
            )
        own = self._checked(row)
        spots, places = self.told.spots_of(own), self.told.places_of(own)
        return pair_contacts(self.system, self.states[own], spots, places)

    @property
    def energy(self) -> Energy:
        """Energies, (n,) arrays."""
        return Energy(
            self.accounts[:, E.A_KINETIC],
            self.accounts[:, E.A_POTENTIAL],
            self.accounts[:, E.A_STORED],
            self.states[:, K.S_LOST],
            self.states[:, K.S_GIVEN],
            self.states[:, K.S_SHARED],
        )

    @property
    def coupler(self) -> CouplerRun | None:
        """What the coupler did; None where the system has none."""
        if self.system.coupler is None:
            return None
        return coupler_run(self.states[:, S.coupler_at(self.system) :], self.accounts[:, -1])

    @property
    def deepest(self) -> float:
        """As of the last state: `SystemState.deepest`."""
        return self.final.deepest

    @property
    def uncertified(self) -> int:
        """As of the last state: `SystemState.uncertified`."""
        return self.final.uncertified

    @property
    def crossings(self) -> tuple[Crossing, ...]:
        """As of the last state: `SystemState.crossings`."""
        return self.final.crossings

    @property
    def jumps(self) -> int:
        """As of the last state: `SystemState.jumps`."""
        return self.final.jumps

    @property
    def eased(self) -> int:
        """As of the last state: `SystemState.eased`."""
        return self.final.eased

    def _checked(self, row: int) -> int:
        """A row of the record, from 0 on."""
        count = len(self.states)
        return whole_number(row, "row", -count, count - 1) % count

    def _touches(self) -> Array:
        shape = (len(self.accounts), len(self.system.pairs), K.N_TOUCH)
        pairs = slice(E.ACCOUNT_HEADER, E.ACCOUNT_HEADER + K.N_TOUCH * len(self.system.pairs))
        return self.accounts[:, pairs].reshape(shape)

    def __repr__(self) -> str:
        return (
            f"<SystemRun of {len(self.states)} states to {self.times[-1]:g} s, deepest "
            f"{self.deepest:.3g}, {self.uncertified} uncertified>"
        )


def account_width(system: System) -> int:
    """How many numbers a row of accounts has."""
    pairs = K.N_TOUCH * len(system.pairs)
    return E.ACCOUNT_HEADER + pairs + (system.coupler is not None)
