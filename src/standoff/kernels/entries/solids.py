"""The distance of two solids' boundaries as Python calls it."""

from math import inf

from numba import types

from standoff.kernels.compiler.decorators import entry, kernel, pointer, reals_on_stack
from standoff.kernels.compiler.entry import (
    BOOL,
    INT,
    INTS,
    READ,
    READ_ROWS,
    ROWS,
    WRITE,
    WRITE_INTS,
)
from standoff.kernels.pair.derivatives import write_gradient
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.local_side import on_one_side, tell_beside
from standoff.kernels.solids.spatial_minimum import nearest
from standoff.kernels.solids.spatial_pieces import along, leaf_box, leaf_jet, on_solid
from standoff.kernels.solids.spatial_progress import LEFT_REALS
from standoff.kernels.solids.spatial_search import search
from standoff.kernels.solids.spatial_self import (
    FOUND_REALS,
    JOINT_REALS,
    Joint,
    meet,
    near_leaves,
)
from standoff.kernels.values import Pose

# Packed boundary, then leaves and tree; pose in A's frame (R, p).
SOLID = types.Tuple((INTS, READ, INTS, READ))
STILL = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)


@kernel
def side_at(solid, pose, sense):
    ints, reals, own, numbers = solid
    R = (pose[0], pose[1], pose[2], pose[3], pose[4], pose[5], pose[6], pose[7], pose[8])
    placed = Pose(R, (pose[9], pose[10], pose[11]))
    return S.Side(
        pointer(ints, 0), pointer(reals, 0), pointer(own, 0), pointer(numbers, 0), placed, sense
    )


SOLIDS = types.Tuple((SOLID, SOLID))
# Work space, a heap's nodes and its keys.
ROOM = types.Tuple((WRITE, WRITE_INTS, WRITE))
# Of the work space: what a closing needs; the rest holds pairs of leaves.
CLOSING = 2048


@entry(SOLIDS, READ, INTS, WRITE, WRITE, ROOM, WRITE_INTS, work="solids")
def boundary_distance(solids, pose, senses, best, minima, room, counts):
    """Of two solids, B at a pose in A's frame, each seen from outside or inside (`senses`); `best`
    says how far and how to search."""
    a, b = side_at(solids[0], STILL, senses[0]), side_at(solids[1], pose, senses[1])
    work, nodes, keys = room
    limit = len(keys)
    heap = (pointer(keys, 0), pointer(nodes, 0), pointer(nodes, limit), limit)
    space = (pointer(work, CLOSING), (len(work) - CLOSING) // LEFT_REALS, pointer(work, 0))
    search(a, b, pointer(best, 0), pointer(minima, 0), heap, space, pointer(counts, 0))


@entry(SOLID, READ, INT, types.float64, types.float64, WRITE, work="solids")
def solid_point(solid, pose, leaf, u, v, out):
    """The jet of a leaf (18 numbers) into `out`."""
    jet = leaf_jet(side_at(solid, pose, S.OUTSIDE), leaf, u, v)
    for i in range(6):
        vector = jet[i]
        for k in range(3):
            out[3 * i + k] = vector[k]


@entry(SOLIDS, READ_ROWS, ROWS, work="solids")
def leaf_points(solids, rows, out):
    """Of each row (distance, leaves, parameters) the points of A and B, own frames, (n, 6)."""
    a, b = side_at(solids[0], STILL, S.OUTSIDE), side_at(solids[1], STILL, S.OUTSIDE)
    for i in range(len(rows)):
        x = leaf_jet(a, int(rows[i, 1]), rows[i, 3], rows[i, 4])[0]
        y = leaf_jet(b, int(rows[i, 2]), rows[i, 5], rows[i, 6])[0]
        for k in range(3):
            out[i, k], out[i, 3 + k] = x[k], y[k]


@entry(SOLIDS, READ, ROWS, WRITE_INTS, work="solids")
def nearest_in_leaves(solids, pose, rows, counts):
    """From the parameters of each row (distance, leaves, parameters) to those of a local minimum in
    the same leaves, and its distance; infinity where it is off a solid."""
    a, b = side_at(solids[0], STILL, S.OUTSIDE), side_at(solids[1], pose, S.OUTSIDE)
    for i in range(len(rows)):
        m, n = int(rows[i, 1]), int(rows[i, 2])
        start = (rows[i, 3], rows[i, 4], rows[i, 5], rows[i, 6])
        box_a, box_b = leaf_box(a, m), leaf_box(b, n)
        q, distance = nearest(a, m, box_a, b, n, box_b, start, pointer(counts, 0))
        for k in range(4):
            rows[i, 3 + k] = q[k]
        on_both = on_solid(a, m, q[0], q[1]) and on_solid(b, n, q[2], q[3])
        rows[i, 0] = distance if on_both else inf


@entry(SOLID, READ, INT, READ, WRITE, work="solids")
def part_extents(solid, axes, leaf, box, out):
    """Into out[:3] a part's middle point, own frame, and into out[3:6] how far it reaches from it
    along three axes (9 numbers) at most; `box` is the part's."""
    side = side_at(solid, STILL, S.OUTSIDE)
    h = (0.5 * (box[1] - box[0]), 0.5 * (box[3] - box[2]))
    jet = leaf_jet(side, leaf, 0.5 * (box[0] + box[1]), 0.5 * (box[2] + box[3]))
    for k in range(3):
        out[k] = jet[0][k]
        n = (axes[3 * k], axes[3 * k + 1], axes[3 * k + 2])
        out[3 + k] = along(side, leaf, jet, n, h)


@entry(SOLIDS, READ, INTS, INTS, READ, WRITE, WRITE, WRITE_INTS, work="solids")
def local_side(solids, pose, numbers, leaves, at, best, work, counts):
    """Into best[0] whether `on_one_side` holds, and into best[1:9] what `tell_beside` tells.
    numbers: B's leaf and the one of A whose potential is asked; at: the box of B's part, and both
    limits; leaves: those of A that are near."""
    still = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
    a, b = side_at(solids[0], still, S.OUTSIDE), side_at(solids[1], pose, S.OUTSIDE)
    part = S.Part(b, numbers[0], S.Box(at[0], at[1], at[2], at[3]))
    told = pointer(best, 0)
    limits = (at[4], at[5])
    held = on_one_side(
        a, part, numbers[1], leaves, limits, told, pointer(work, 0), pointer(counts, 0)
    )
    told[0] = 1.0 if held else 0.0
    tell_beside(a, part, numbers[1], at[5], told)


@entry(READ, BOOL, WRITE, work="solids")
def gradient(arms, flat, to):
    """The gradient of the distance, 12 numbers, from the normal, then the arms of both witness
    points about the solids' origins, world axes; of planar solids it stays in the plane."""
    n = (arms[0], arms[1], arms[2])
    arm_a, arm_b = (arms[3], arms[4], arms[5]), (arms[6], arms[7], arms[8])
    write_gradient(n, arm_a, arm_b, flat, pointer(to, 0))


@entry(SOLID, types.float64, WRITE_INTS, WRITE_INTS, work="solids")
def near_own_leaves(solid, within, stack, pairs):
    """List the pairs of a solid's leaves of faces whose boxes are within a length; pairs[-1]
    is how many there are, of which those that have room are listed."""
    side = side_at(solid, STILL, S.EITHER)
    most = (len(pairs) - 1) // 2
    pairs[-1] = near_leaves(side, within, pointer(stack, 0), pointer(pairs, 0), most)


@entry(SOLID, INTS, READ, WRITE, WRITE, WRITE, WRITE_INTS, work="solids")
def meet_own_leaves(solid, pairs, joint, best, work, found, counts):
    """Of each pair of a solid's leaves whether they meet away from the points of a joint."""
    side = side_at(solid, STILL, S.OUTSIDE)
    sides = reals_on_stack(2)
    sides[0], sides[1] = 0.0, 0.0
    spots = Joint(pointer(joint, 0), len(joint) // JOINT_REALS, sides)
    for k in range(len(pairs) // 2):
        out = pointer(found, FOUND_REALS * k)
        meet(side, pairs[2 * k], pairs[2 * k + 1], spots, pointer(best, 0), pointer(work, 0),
             pointer(counts, 0), out)  # fmt: skip
