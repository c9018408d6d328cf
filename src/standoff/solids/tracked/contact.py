"""What is kept of two solids that overlap, from frame to frame: their places, and the front of
pairs of pieces that may hold some."""

from __future__ import annotations

import threading
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.kernels.entries.solid_contact import follow_contact
from standoff.kernels.solids import contact_places as P
from standoff.kernels.solids import spatial_progress as C
from standoff.kernels.solids.contact_frame import (
    AT_MERGED,
    AT_NORMALS,
    AT_SETS,
    CONTACT_ROOM,
    MOST_NORMALS,
)
from standoff.kernels.solids.contact_front import CONTACT_REALS
from standoff.kernels.solids.contact_sets import NO_MINIMUM
from standoff.kernels.solids.front_branches import BRANCH_REALS
from standoff.kernels.solids.front_rows import N_BRANCHES, N_ROWS, NEXT_BRANCH
from standoff.kernels.solids.minima_sets import SET_REALS
from standoff.solids.spatial.contact import SignedMinima, signed_told
from standoff.solids.spatial.minimum import Sought, started
from standoff.solids.spatial.pair import PlacedPair
from standoff.solids.spatial.stationary import fans_of
from standoff.solids.tracked.front import Front, merged_of

Array = NDArray[np.float64]


class Places(NamedTuple):
    """What a frame of a contact tells.

    Attributes
    ----------
    signed : the minima of the signed distance.
    felt : (m,) array of bool: has each come from above 0?
    kept : the contact after the frame.
    merged : (n, 3) array of int
        As `Frames.merged` of the front.
    """

    signed: SignedMinima
    felt: NDArray[np.bool_]
    kept: Array
    merged: NDArray[np.int64]


@lru_cache(maxsize=8)
def _room(thread: int) -> tuple[Array, Array]:
    del thread
    return np.zeros(P.KEPT_REALS), np.empty(CONTACT_ROOM)


def begun(before: Array, front: Front) -> Array:
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


def front_after(front: Front, contact: Array, row: Array) -> Front:
    """The front after a frame of contact, with points of both boundaries as a row of minima has
    them: its rows stay as they are, and the branches are those of the contact."""
    best, store = front.best.copy(), front.store.copy()
    best[C.LEAF_A : C.AT + 4] = row[1:7]
    own = contact[P.F_STORE :]
    for k in (N_BRANCHES, NEXT_BRANCH):
        store[k] = own[k]
    n = BRANCH_REALS * int(own[N_BRANCHES])
    branches = contact[P.F_BRANCHES : P.F_BRANCHES + n].copy()
    for array in (best, store, branches):
        array.flags.writeable = False
    return front._replace(best=best, store=store, branches=branches, contact=contact)


def followed(pair: PlacedPair, sought: Sought, contact: Array) -> Places:
    """The frame after a contact, which stays as it is."""
    kept, room = _room(threading.get_ident())
    kept[: len(contact)] = contact
    best, _ = started(sought, pair.size, float(np.linalg.norm(pair.relative[9:])))
    room[: C.BEST_REALS] = best[: C.BEST_REALS]
    room[C.MOST_MINIMA] = MOST_NORMALS
    counts = np.zeros(8, dtype=np.int64)
    solids: Any = (pair.a.packed, pair.b.packed), pair.relative
    fans = fans_of(pair.a), fans_of(pair.b)
    n = int(follow_contact(*solids, fans, kept, room, np.array([sought.patch]), counts))
    rows = room[AT_NORMALS:AT_SETS]
    signed = signed_told(room, rows, room[AT_SETS : AT_SETS + SET_REALS * n], counts)
    bound = signed.rows[:, C.BOUND]
    spots = bound < NO_MINIMUM
    bound[spots] = P.SPOT - bound[spots]
    felt = kept[P.F_AT : P.F_AT + P.PLACE_REALS * n].reshape(-1, P.PLACE_REALS)[:, P.P_FELT] > 0.0
    after = kept[: P.F_ROWS + CONTACT_REALS * int(kept[P.F_STORE + N_ROWS])].copy()
    after.flags.writeable = False
    return Places(signed, felt, after, merged_of(kept[P.F_STORE :], room[AT_MERGED:]))
