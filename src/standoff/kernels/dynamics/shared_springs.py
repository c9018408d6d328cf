"""What the springs of a pair of solids hold more, from a tick to the next, by no work.

Where spots begin, end, come nearer to each other or press otherwise, they take other parts of the
springs (``kernels.solids.contact_places``). What is stored in them changes with that, and no force
has done it. Half way of a tick, all spots of its start are put in the place of all of its end: what
these hold there more is what sharing has given. So no spot need be told from another, and a spot
that keeps its part gives nothing, nor does one that begins or ends at the surface.
"""

from standoff.kernels.algebra.rigid import read_vector
from standoff.kernels.algebra.vectors import add, dot, rotate, rotate_back, sub
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.dynamics.contact_force import spring_of, stored_in
from standoff.kernels.solids.contact_frame import pose_at
from standoff.kernels.solids.contact_places import (
    F_BEFORE,
    F_SPOT,
    F_SPOTS,
    S_DEPTH,
    S_NORMAL,
    S_SHARE,
    SPOT_REALS,
)


@kernel
def closing_to(x, n, pose, other):
    """By how much B's point at x comes nearer along n as B goes from a pose to another one; all in
    A's frame."""
    own = rotate_back(pose.R, sub(x, pose.p))
    return dot(n, sub(x, add(rotate(other.R, own), other.p)))


@kernel
def held_half_way(stiffness, kept, first, count, pose, other):
    """What the springs of some spots of a pose hold half way to another one, energy."""
    held = 0.0
    for k in range(count):
        at = first + SPOT_REALS * k
        x, n = read_vector(kept, at), read_vector(kept, at + S_NORMAL)
        depth = kept[at + S_DEPTH] + 0.5 * closing_to(x, n, pose, other)
        if depth > 0.0:
            held += stored_in(spring_of(stiffness, kept[at + S_SHARE], depth), depth)
    return held


@kernel
def shared_since(stiffness, kept, count, before):
    """What sharing has given since a frame that had so many spots, and B at that pose, energy."""
    now = pose_at(kept)
    held = held_half_way(stiffness, kept, F_SPOT, int(kept[F_SPOTS]), now, before)
    return held - held_half_way(stiffness, kept, F_BEFORE, count, before, now)
