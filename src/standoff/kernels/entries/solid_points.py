"""Points and solids, as Python calls them: on which side of a boundary, and how deep inside."""

from numba import types

from standoff.kernels.compiler.decorators import entry, kernel, pointer
from standoff.kernels.compiler.entry import INT, READ, READ_ROWS, REAL, WRITE, WRITE_INTS
from standoff.kernels.entries.solids import CLOSING, ROOM, SOLID, STILL, side_at
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.point_depth import (
    Known,
    Probe,
    depth_beside,
    outwards,
    seen_from,
    side_by,
)
from standoff.kernels.solids.spatial_progress import LEFT_REALS


@entry(SOLID, READ, INT, REAL, REAL, work="solids")
def outward_at(solid, normals, leaf, u, v):
    """As `outwards` of a leaf; normals: those of the vertices."""
    return outwards(side_at(solid, STILL, S.OUTSIDE), pointer(normals, 0), leaf, u, v)


@entry(SOLID, READ, READ_ROWS, READ, work="solids")
def side_beside(solid, normals, rows, point):
    """+1: a point is outside, by rows of its nearest pairs, whose second leaf is the solid's; -1:
    inside; 0: none of them tells."""
    x = (point[0], point[1], point[2])
    seen = seen_from(side_at(solid, STILL, S.OUTSIDE), x)
    told = 0.0
    for k in range(len(rows)):
        row = pointer(rows, rows.shape[1] * k)
        if told == 0.0:
            told = side_by(seen, pointer(normals, 0), int(row[2]), row[5], row[6])
    return told


# The origin as a solid, and the normals of both solids' vertices.
BESIDE = types.Tuple((SOLID, READ, READ))


@kernel
def heap_and_space(room):
    work, nodes, keys = room
    most = len(keys)
    heap = (pointer(keys, 0), pointer(nodes, 0), pointer(nodes, most), most)
    return heap, (pointer(work, CLOSING), (len(work) - CLOSING) // LEFT_REALS, pointer(work, 0))


# What a search fills, and what is told.
LISTS = types.Tuple((WRITE, WRITE, WRITE))


@entry(SOLID, SOLID, READ, READ, LISTS, ROOM, WRITE_INTS, work="solids")
def point_depth(solid, point, normals, asked, lists, room, counts):
    """`depth_beside` of a point asked[:3] into lists[2]: side, depth, nearest point. Then in
    `asked`: how far the boundary is known to be at most; the solid's size; what bounds are computed
    and proven to, of a size; and how many evaluations are allowed. `point`: the origin as a
    solid."""
    x = (asked[0], asked[1], asked[2])
    heap, space = heap_and_space(room)
    own = side_at(point, STILL, S.EITHER)
    found = pointer(lists[0], 0), pointer(lists[1], 0)
    probe = Probe(own, asked[5], asked[6], asked[7], found, heap, space, pointer(counts, 0))
    at = pointer(normals, 0)
    # no other solid asks where its points of reference are
    known = Known(side_at(solid, STILL, S.OUTSIDE), at, at, 0, asked[4])
    side, depth, nearest = depth_beside(known, x, asked[3], probe)
    out = lists[2]
    out[0], out[1] = side, depth
    for k in range(3):
        out[2 + k] = nearest[k]
