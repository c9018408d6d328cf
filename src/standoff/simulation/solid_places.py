"""The places of contact of two solids, as a state of a system has them."""

from __future__ import annotations

from typing import NamedTuple

from standoff.errors import StandoffError
from standoff.kernels.solids import contact_places as P
from standoff.motion import Pose
from standoff.typing import Array


class ContactSpot(NamedTuple):
    """Where two solids push each other.

    Attributes
    ----------
    point : (3,) array
        In the middle of the overlap, world.
    normal : (3,) array
        Unit, from A to B, world.
    depth : float
        Length.
    springs : float
        How many springs of the contact's stiffness act there, 0 to 1.
    """

    point: Array
    normal: Array
    depth: float
    springs: float


class ContactPlace(NamedTuple):
    """A local minimum of the signed distance of two solids.

    Attributes
    ----------
    key : int
        The same for as long as the place lives.
    felt : bool
        Has its distance come from above 0? One that is not pushes nothing: it is another way out of
        a region in which the solids overlap (docs/solid-simulation.md).
    distance : float
        Signed, length.
    normal : (3,) array
        Unit, from A to B, world.
    point_a, point_b : (3,) array
        On each boundary, world.
    """

    key: int
    felt: bool
    distance: float
    normal: Array
    point_a: Array
    point_b: Array


class SolidContact(NamedTuple):
    """A pair of solids in a state.

    Attributes
    ----------
    places : tuple of ContactPlace
        The deepest first; up to eight depths apart.
    spots : tuple of ContactSpot
        What pushes, of all places that are felt.
    complete : bool
        Was there room and time for all places?
    """

    places: tuple[ContactPlace, ...]
    spots: tuple[ContactSpot, ...]
    complete: bool


def solid_contact(kept: Array, pose: Pose) -> SolidContact:
    """What is kept of a pair of solids, with A at a pose in the world.

    Raises StandoffError: nothing is kept yet.
    """
    places = tuple(place_of(row) for row in place_rows(kept, pose))
    R, p = pose.rotation, pose.translation
    spots = []
    for k in range(int(kept[P.F_SPOTS])):
        row = kept[P.F_SPOT + P.SPOT_REALS * k :]
        point, n = R @ row[:3] + p, R @ row[P.S_NORMAL : P.S_NORMAL + 3]
        spots.append(ContactSpot(point, n, float(row[P.S_DEPTH]), float(row[P.S_SHARE])))
    return SolidContact(places, tuple(spots), bool(kept[P.F_LOST] == 0.0))


def place_of(row: Array) -> ContactPlace:
    """A place of its row."""
    told = int(row[P.P_KEY]), bool(row[P.P_FELT]), float(row[P.P_DISTANCE])
    n, a, b = (row[o : o + 3] for o in (P.P_NORMAL, P.P_A, P.P_B))
    return ContactPlace(*told, n, a, b)


def place_rows(kept: Array, pose: Pose) -> Array:
    """(n, PLACE_REALS) places that are kept of a pair of solids, with A at a pose in the world.

    Raises StandoffError: nothing is kept yet.
    """
    if not len(kept) or kept[P.F_MADE] == 0.0:
        raise StandoffError(
            "This state has no places of contact: a start has none before its first tick, and "
            "records of a run keep none. Ask run.final, or a state from operator.step."
        )
    count = int(kept[P.F_PLACES])
    rows = kept[P.F_AT : P.F_AT + P.PLACE_REALS * count].reshape(count, P.PLACE_REALS).copy()
    for at, shift in ((P.P_NORMAL, 0.0), (P.P_A, pose.translation), (P.P_B, pose.translation)):
        rows[:, at : at + 3] = rows[:, at : at + 3] @ pose.rotation.T + shift
    return rows
