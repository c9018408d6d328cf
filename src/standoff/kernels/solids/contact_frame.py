"""One frame of a contact: what B has moved since the last one, the common normals now, and the
places that they tell."""

from typing import Any, NamedTuple

from standoff.kernels.algebra.rigid import read_rotation, read_vector
from standoff.kernels.compiler.decorators import ahead, kernel
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.contact_ends import is_pressed
from standoff.kernels.solids.contact_front import find_contacts, keep_ends, look_again
from standoff.kernels.solids.contact_hollow import leave_out_through
from standoff.kernels.solids.contact_places import (
    F_MADE,
    F_POSE,
    Asked,
    goes_missing,
    kept_front,
    moved_lately,
    tell_places,
)
from standoff.kernels.solids.front_branches import MERGED_REALS, MOST_MERGED
from standoff.kernels.solids.front_frame import FARTHEST_GONE, motion_between
from standoff.kernels.solids.front_rows import GONE, N_ROWS
from standoff.kernels.solids.minima_sets import MOST_SETS, SET_REALS
from standoff.kernels.solids.spatial_boxes import node_reach
from standoff.kernels.solids.spatial_progress import ABOVE, BEST_REALS, MINIMUM_REALS, SIZE
from standoff.kernels.values import Pose

# Common normals that a frame may come to.
MOST_NORMALS = 2048
# A frame's room: what it is asked, the common normals, sets of them with which are felt, and which
# branches have merged.
AT_NORMALS = BEST_REALS
AT_SETS = AT_NORMALS + MINIMUM_REALS * MOST_NORMALS
AT_MERGED = AT_SETS + SET_REALS * (MOST_SETS + 4)
CONTACT_ROOM = AT_MERGED + MERGED_REALS * MOST_MERGED
# Of the length up to which places are looked for: how far B may move in the frames in one of which
# Newton's method is tried again. Eight depths are that length in a simulation: half a depth.
UNSEEN_FOR = 1.0 / 16.0


class Choices(NamedTuple):
    """What a route chooses: the length within which spots share a spring; how much of the length up
    to which places are looked for is for their patches alone; of how many frames in one, 4 at
    most, Newton's method is tried again where it came to none; for how many rows of the front
    there is room in what is kept; and how deep a place may be that is felt though nobody knows
    where it has come from, length."""

    shared: Any
    wider: Any
    retried: Any
    rows: Any
    deepest: Any


@kernel
def pose_at(kept):
    """Of B in A's frame, in the frame before."""
    return Pose(read_rotation(kept, F_POSE), read_vector(kept, F_POSE + 9))


@kernel
def contact_frame(both, kept, choices, room, counts):
    """The places of two solids, B where it is now, into what is kept of them, from what was; how
    many. `room` begins with what is asked."""
    best, minima, sets = room, ahead(room, AT_NORMALS), ahead(room, AT_SETS)
    step, radius, b = 0.0, node_reach(both.b, 0), both.b
    if kept[F_MADE] > 0.0:
        last = S.Side(b.ints, b.reals, b.own, b.numbers, pose_at(kept), b.sense)
        step, radius = motion_between(last, b, best[SIZE])
    front = kept_front(kept, choices.rows, ahead(room, AT_MERGED))
    front.store[GONE] += step
    if front.store[GONE] > FARTHEST_GONE * best[SIZE]:
        front.store[N_ROWS], front.store[GONE] = 0.0, 0.0
    retried = choices.retried
    if step * retried > UNSEEN_FOR * best[ABOVE]:
        retried = 1
    find_contacts(both, front, radius, retried, best, minima, counts)
    lately = moved_lately(kept, step, choices.retried)
    asked = Asked(lately, choices.deepest, choices.shared, choices.wider, b.pose)
    if kept[F_MADE] == 0.0:
        leave_out_through(both, best, minima, counts)
    elif goes_missing(kept, asked, best, minima):
        look_again(both, front, radius, best, minima, counts)
    if is_pressed(best, minima):
        keep_ends(both, front, best, minima, counts)
    n = tell_places(both, front, asked, best, minima, sets, kept)
    for i in range(9):
        kept[F_POSE + i] = b.pose.R[i]
    for i in range(3):
        kept[F_POSE + 9 + i] = b.pose.p[i]
    return n
