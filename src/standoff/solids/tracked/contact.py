"""What is kept of two solids that overlap, from frame to frame: their places, and the front of
pairs of pieces that may hold some."""

from __future__ import annotations

import threading
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.kernels.entries.solid_contact import (
    DEPTH,
    FIRST,
    N_PLACES,
    PARTING,
    TOLD_REALS,
    follow_contact,
)
from standoff.kernels.solids import contact_places as P
from standoff.kernels.solids import spatial_progress as C
from standoff.kernels.solids.contact_frame import AT_MERGED, AT_NORMALS, AT_SETS, CONTACT_ROOM
from standoff.kernels.solids.contact_front import CONTACT_REALS
from standoff.kernels.solids.front_branches import BRANCH_REALS
from standoff.kernels.solids.front_rows import N_BRANCHES, N_ROWS, NEXT_BRANCH, STORE_REALS
from standoff.kernels.solids.minima_sets import SET_REALS
from standoff.solids.spatial.contact import SignedMinima, signed_told
from standoff.solids.spatial.minimum import MOST_TIES, new_scratch
from standoff.solids.spatial.points import POINT
from standoff.solids.spatial.sides import vertex_normals_of
from standoff.solids.spatial.solid_model import SolidModel
from standoff.solids.spatial.stationary import fans_of
from standoff.solids.tracked.front import MOST_BRANCHES, KeptFront, merged_of
from standoff.typing import Array

N_COUNTS = 16


class ContactPlaces(NamedTuple):
    """What a frame of a contact tells.

    Attributes
    ----------
    signed : the minima of the signed distance.
    felt : (m,) array of bool: has each come from above 0?
    depth : no translation shorter than this parts the solids.
    parting : (3,) array; one that does, A's frame.
    """

    signed: SignedMinima
    felt: NDArray[np.bool_]
    depth: float
    parting: Array


class ContactWork(NamedTuple):
    """Arrays that frames of a contact write to."""

    kept: Array
    room: Array
    store: Array
    branches: Array
    told: Array
    probe: tuple[Array, Array, Any]
    counts: NDArray[np.int64]


def new_contact_room() -> ContactWork:
    """Arrays for one who keeps them from frame to frame."""
    return ContactWork(
        np.zeros(P.KEPT_REALS),
        np.empty(CONTACT_ROOM),
        np.zeros(STORE_REALS),
        np.empty(BRANCH_REALS * MOST_BRANCHES),
        np.zeros(TOLD_REALS),
        (np.zeros(C.BEST_REALS), np.empty(C.MINIMUM_REALS * MOST_TIES), new_scratch()),
        np.zeros(N_COUNTS, dtype=np.int64),
    )


@lru_cache(maxsize=8)
def _room(thread: int) -> ContactWork:
    del thread
    return new_contact_room()


def begun(before: Array, front: KeptFront) -> Array:
    """A contact before its first frame, of solids that did not overlap with B at a pose (12,) in
    A's frame: no place is felt that is deeper than B has moved since. Its branches are those of the
    front, as many as there is room for."""
    kept = np.zeros(P.F_ROWS)
    kept[P.F_MADE] = 1.0
    kept[P.F_POSE : P.F_POSE + 12] = before
    n = min(int(front.store[N_BRANCHES]), P.MOST_PLACES)
    kept[P.F_STORE + N_BRANCHES], kept[P.F_STORE + NEXT_BRANCH] = n, front.born
    kept[P.F_BRANCHES : P.F_BRANCHES + BRANCH_REALS * n] = front.branches[: BRANCH_REALS * n]
    return kept


def unknown(born: int) -> Array:
    """A contact before its first frame, of solids of which nothing is known: all places are felt.
    `born`: how many branches there have been."""
    kept = np.zeros(P.F_ROWS)
    kept[P.F_STORE + NEXT_BRANCH] = born
    return kept


class ContactFrames:
    """Frames of two solids that overlap, one after the other from a front with a contact on, which
    stays as it is.

    told : what the last one told, as ``kernels.entries.solid_contact`` lays it out.
    """

    def __init__(
        self, solids: tuple[SolidModel, SolidModel], front: KeptFront, asked: Array,
        room: ContactWork | None = None,
    ) -> None:  # fmt: skip
        assert front.contact is not None
        a, b = solids
        self.solids, self.fans, self.asked = (a.packed, b.packed), (fans_of(a), fans_of(b)), asked
        self.beside = POINT, vertex_normals_of(a).ravel(), vertex_normals_of(b).ravel()
        self.front, self.best = front, front.best.copy()
        self.work = work = room or _room(threading.get_ident())
        self.told = work.told
        work.kept[: len(front.contact)] = front.contact
        work.store[:] = front.store
        work.branches[: len(front.branches)] = front.branches

    def call(self, pose: Array) -> tuple[Any, ...]:
        """What the kernel is called with for a frame with B at a pose (12,) in A's frame."""
        work = self.work
        kept = work.kept, work.room, self.best, work.store, work.branches, work.told
        return (
            self.solids, pose, self.beside, self.fans, kept, self.asked, work.probe, work.counts,
        )  # fmt: skip

    def go(self, pose: Array) -> bool:
        """A frame with B at a pose (12,) in A's frame; is it proven that the solids overlap?"""
        follow_contact(*self.call(pose))
        return bool(self.told[FIRST] >= 0.0)

    def places(self) -> ContactPlaces:
        """What the last frame found."""
        kept, room, told, n = self.work.kept, self.work.room, self.told, int(self.told[N_PLACES])
        sets = room[AT_SETS : AT_SETS + SET_REALS * n]
        signed = signed_told(room, room[AT_NORMALS:AT_SETS], sets, self.work.counts)
        rows = kept[P.F_AT : P.F_AT + P.PLACE_REALS * n].reshape(-1, P.PLACE_REALS)
        parting = told[PARTING : PARTING + 3].copy()
        return ContactPlaces(signed, rows[:, P.P_FELT] > 0.0, float(told[DEPTH]), parting)

    def merged(self) -> NDArray[np.int64]:
        """Of the last frame, as `Frames.merged` of the front."""
        return merged_of(self.work.kept[P.F_STORE :], self.work.room[AT_MERGED:])

    def kept(self) -> KeptFront:
        """The front after the last frame in which the solids overlap: its rows stay as they are,
        and the branches are those of the contact."""
        kept, store = self.work.kept, self.work.store.copy()
        contact = kept[: P.F_ROWS + CONTACT_REALS * int(kept[P.F_STORE + N_ROWS])].copy()
        branches = self.work.branches[: BRANCH_REALS * int(store[N_BRANCHES])].copy()
        best = self.best.copy()
        for array in (best, store, branches, contact):
            array.flags.writeable = False
        return self.front._replace(best=best, store=store, branches=branches, contact=contact)
