"""All contacts of a system: what each spot of each pair pushes, of convex bodies and solids."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from standoff.errors import StandoffError
from standoff.kernels.dynamics import arrays as K
from standoff.kernels.dynamics.solid_pairs import LOOKED_FOR
from standoff.kernels.solids import contact_places as P
from standoff.kernels.state import arrays as T
from standoff.read_only import KeepsReadOnly
from standoff.simulation.solid_places import ContactPlace, place_of
from standoff.simulation.system import System
from standoff.simulation.system_state import SystemState, answers, kept_places
from standoff.tracking.status import Status
from standoff.typing import Array, Ints

ONLY = 0
"""Key of the one place of a pair of convex bodies."""


FIRST_ROOM = 64
"""Spots of a state for which there is room at first."""

MOST_TOLD = 100_000_000
"""Numbers of contacts that one run may keep: 0.8 GB."""


class SpotForce(NamedTuple):
    """What a spot of a contact pushes.

    Attributes
    ----------
    point : (3,) array
        In the middle of the overlap, world.
    normal : (3,) array
        Unit, from A to B, world.
    depth : float
        Length.
    springs : float
        How many springs of the contact's stiffness act there.
    force : (3,) array
        On B, friction included, world.
    """

    point: Array
    normal: Array
    depth: float
    springs: float
    force: Array


class PairContact(NamedTuple):
    """A pair of bodies that touch, or nearly do.

    Attributes
    ----------
    pair : int
        Its number among the system's pairs.
    status : Status
        Of the tracker's answer.
    distance : float
        Signed, length.
    places : tuple of ContactPlace
        Of solids, all within eight depths, the deepest first; of convex bodies their witness
        points, with the key 0, within as much.
    spots : tuple of SpotForce
        All that push.
    """

    pair: int
    status: Status
    distance: float
    places: tuple[ContactPlace, ...]
    spots: tuple[SpotForce, ...]

    @property
    def force(self) -> Array:
        """Of all spots, on B, world (3,)."""
        total: Array = np.sum([np.zeros(3), *(spot.force for spot in self.spots)], axis=0)
        return total


@dataclass(frozen=True, eq=False)
class ContactRows(KeepsReadOnly):
    """Spots and places of many states, one behind the other.

    Attributes
    ----------
    spots : (n, N_TOLD) array
        As ``standoff.kernels.dynamics.arrays`` lays them out.
    spot_starts : (states + 1,) array of int
        Where those of each state begin.
    places : (m, 1 + PLACE_REALS) array
        The pair's number, then as ``standoff.kernels.solids.contact_places``, world.
    place_starts : (states + 1,) array of int
    """

    spots: Array
    spot_starts: Ints
    places: Array
    place_starts: Ints

    @classmethod
    def of(cls, spots: Sequence[Array], places: Sequence[Array]) -> ContactRows:
        """Of the rows of each state in turn."""
        parts = []
        for each, width in ((spots, K.N_TOLD), (places, 1 + P.PLACE_REALS)):
            parts.append(np.concatenate([np.zeros((0, width)), *each]))
            parts.append(np.cumsum([0, *(len(rows) for rows in each)]))
        for part in parts:
            part.flags.writeable = False
        return cls(*parts)

    def spots_of(self, row: int) -> Array:
        """Those of one state."""
        return self.spots[self.spot_starts[row] : self.spot_starts[row + 1]]

    def places_of(self, row: int) -> Array:
        """Those of one state."""
        return self.places[self.place_starts[row] : self.place_starts[row + 1]]


def no_room() -> Array:
    """What a run writes over that is asked for no contacts."""
    return np.zeros(K.TOLD_HEADER)


class ContactHistory:
    """Spots and places of one state after the other, as a run tells them.

    Attributes
    ----------
    room : array
        What the compiled loop writes the spots of a state to.
    """

    def __init__(self) -> None:
        self._spots: list[Array] = []
        self._places: list[Array] = []
        self._count = 0
        self.room = _room_for(FIRST_ROOM)
        self._asked = False

    def fits(self) -> bool:
        """Are the spots of the state told, all of them? If there was no room, there is now."""
        count = int(self.room[K.TOLD])
        if self._asked and count <= self.room[K.TOLD_ROOM]:
            return True
        if self._asked:
            self.room = _room_for(2 * count)
        self._asked = True
        return False

    def take(self, state: SystemState) -> None:
        """Keep the spots that were told of a state, and the places that it keeps.

        Raises StandoffError: there are too many of them.
        """
        count, self._asked = int(self.room[K.TOLD]), False
        spots = self.room[K.TOLD_HEADER : K.TOLD_HEADER + K.N_TOLD * count]
        self._spots.append(spots.reshape(count, K.N_TOLD).copy())
        self._places.append(places_of_solids(state))
        self._count += spots.size + self._places[-1].size
        if self._count > MOST_TOLD:
            raise StandoffError(
                f"The contacts of {len(self._spots)} records are more than {MOST_TOLD} numbers: "
                "record fewer ticks (every=...), or run in parts.",
                "contacts",
                True,
            )

    @property
    def rows(self) -> ContactRows:
        """All that was taken."""
        return ContactRows.of(self._spots, self._places)


def _room_for(spots: int) -> Array:
    room = np.zeros(K.TOLD_HEADER + K.N_TOLD * spots)
    room[K.TOLD_ROOM] = spots
    return room


def places_of_solids(state: SystemState) -> Array:
    """(n, 1 + PLACE_REALS) places of all pairs of solids of a state that keeps them: the pair's
    number, then each place, world."""
    found = [np.zeros((0, 1 + P.PLACE_REALS))]
    for pair, solid in enumerate(state.system.of_solids):
        if solid:
            rows = kept_places(state, pair)
            found.append(np.column_stack([np.full(len(rows), float(pair)), rows]))
    return np.concatenate(found)


def pair_contacts(
    system: System, row: Array, spots: Array, places: Array
) -> tuple[PairContact, ...]:
    """All pairs that touch or nearly do, in the system's order.

    Parameters
    ----------
    system : System
    row : (m,) array
        Of states.
    spots, places : arrays
        As in `ContactRows`, of this state.
    """
    told = answers(system, row[None])[0]
    known = (told[:, T.STATUS] != Status.FAR.value) & np.isfinite(told[:, T.DISTANCE])
    near = {k: _near(system, k, told[k]) for k in np.flatnonzero(known).tolist()}
    numbers = {int(k) for k in (*spots[:, K.U_PAIR], *places[:, 0])}
    numbers |= {pair for pair, place in near.items() if place is not None}
    found = []
    for pair in sorted(numbers):
        own = places[places[:, 0] == pair]
        only = near.get(pair)
        found_places = tuple(place_of(each[1:]) for each in own) if only is None else (only,)
        pushing = tuple(_spot_of(each) for each in spots[spots[:, K.U_PAIR] == pair])
        out = told[pair]
        status = Status(int(out[T.STATUS]))
        found.append(PairContact(pair, status, float(out[T.DISTANCE]), found_places, pushing))
    return tuple(found)


def _near(system: System, pair: int, out: Array) -> ContactPlace | None:
    """The witness points of convex bodies as a place, where they are as near as places of solids
    are looked for."""
    if system.of_solids[pair] or not out[T.DISTANCE] <= LOOKED_FOR * system.depth(pair):
        return None
    normal, a, b = (out[o : o + 3] for o in (T.NORMAL, T.POINT_A, T.POINT_B))
    return ContactPlace(ONLY, True, float(out[T.DISTANCE]), normal, a, b)


def _spot_of(row: Array) -> SpotForce:
    point, normal, force = (row[o : o + 3] for o in (K.U_POINT, K.U_NORMAL, K.U_FORCE))
    return SpotForce(point, normal, float(row[K.U_DEPTH]), float(row[K.U_SHARE]), force)
