"""Planar solids as Python calls them: the distance of two, points, and what crosses."""

from numba import types

from standoff.kernels.algebra.rigid import relative_pose
from standoff.kernels.compiler.decorators import entry, kernel, pointer
from standoff.kernels.compiler.entry import INTS, READ, READ_ROWS, ROWS, WRITE, WRITE_INTS
from standoff.kernels.solids.planar_crossings import clash
from standoff.kernels.solids.planar_layout import Outline
from standoff.kernels.solids.planar_overlap import largest_ball, seeded
from standoff.kernels.solids.planar_points import nearest_boundary, winding
from standoff.kernels.solids.planar_search import Queue, Sought, seek

# Reals of the curves, leaves, integers of leaves, nodes, integers of nodes.
OUTLINE = types.Tuple((READ, READ, INTS, READ, INTS))
# Rows, heap, found.
QUEUE = types.Tuple((WRITE, WRITE_INTS, WRITE))
NUMBERS = types.UniTuple(types.float64, 6)


@kernel
def outline_at(arrays, c, s, p, q):
    reals, leaves, leaf_ints, nodes, node_ints = arrays
    return Outline(
        pointer(reals, 0),
        pointer(leaves, 0),
        pointer(leaf_ints, 0),
        pointer(nodes, 0),
        pointer(node_ints, 0),
        c,
        s,
        p,
        q,
    )


@kernel
def queue_at(arrays, most_found):
    rows, heap, found = arrays
    return Queue(pointer(rows, 0), pointer(heap, 0), len(heap), pointer(found, 0), most_found)


@kernel
def pair_of(a, b, poses):
    """Both outlines in A's frame."""
    at = pointer(poses, 0)
    pose = relative_pose(at, pointer(poses, 12))
    c, s = pose.R[0], pose.R[3]
    return outline_at(a, 1.0, 0.0, 0.0, 0.0), outline_at(b, c, s, pose.p[0], pose.p[1])


@entry(OUTLINE, OUTLINE, READ, NUMBERS, types.int64, QUEUE, WRITE_INTS, work="planar")
def nearest(a, b, poses, sought, budget, queue, counts):
    """(how it ended, proven, least found, pairs kept) at poses (24 numbers); `found` in A's frame;
    `sought` holds the fields of `Sought`."""
    first, second = pair_of(a, b, poses)
    asked = Sought(sought[0], sought[1], sought[2], sought[3], sought[4], sought[5])
    kept = queue_at(queue, len(queue[2]) // 12)
    return seek(first, second, asked, kept, pointer(counts, 0), budget)


@entry(OUTLINE, OUTLINE, READ, NUMBERS, types.int64, types.int64, QUEUE, work="planar")
def common_ball(a, b, poses, sought, n_found, budget, queue):
    """(x, y, proven radius, squares) in A's frame; `sought` is (x, y, half) of the square that is
    searched, tolerance, extent, part."""
    first, second = pair_of(a, b, poses)
    kept = queue_at(queue, len(queue[2]) // 12)
    x, y, half, tolerance, extent, part = sought
    best = seeded(first, second, kept, n_found, tolerance, extent)
    square = (x, y, half)
    best, made = largest_ball(first, second, square, best, kept, part, budget, (tolerance, extent))
    return best.x, best.y, best.radius, made


@entry(OUTLINE, READ_ROWS, types.float64, types.float64, WRITE, WRITE_INTS, ROWS, work="planar")
def points(a, at, tolerance, extent, distances, inside, feet):
    """Of points (n, 2): distances from the boundary, whether inside, and the rows (proven distance,
    foot point, leaf, parameter)."""
    outline = outline_at(a, 1.0, 0.0, 0.0, 0.0)
    for k in range(len(at)):
        x, y = at[k, 0], at[k, 1]
        near = nearest_boundary(outline, x, y, tolerance, extent)
        distances[k] = near.distance
        inside[k] = winding(outline, x, y, extent) > 0
        feet[k, 0] = near.lower
        feet[k, 1] = near.x
        feet[k, 2] = near.y
        feet[k, 3] = near.leaf
        feet[k, 4] = near.t


@entry(OUTLINE, types.float64, types.int64, work="planar")
def self_crossing(a, touch, budget):
    """(what was found, x, y, leaf, leaf) where a boundary is nearer to itself than `touch`."""
    return clash(outline_at(a, 1.0, 0.0, 0.0, 0.0), touch, budget)
