"""Patches of many answers of two convex bodies."""

from math import inf, nan

from standoff.kernels.algebra.corners import CORNER_REALS, ROW, outside
from standoff.kernels.algebra.rigid import read_rotation, read_vector, relative_pose
from standoff.kernels.algebra.vectors import add, axpy, rotate, rotate_back, sub
from standoff.kernels.body import layout as L
from standoff.kernels.compiler.decorators import (
    ahead,
    entry,
    ints_on_stack,
    kernel,
    pointer,
    reals_on_stack,
)
from standoff.kernels.compiler.entry import INT, INTS, PAIR, READ, READ_ROWS, REAL, ROWS, WRITE
from standoff.kernels.entries.derivatives import place_of
from standoff.kernels.entries.pointers import pair_pointers
from standoff.kernels.patches.choice import (
    ALL_CORNERS,
    MOST_CORNERS,
    PATCH_REALS,
    chosen,
    extent,
    put_corner,
    put_in_turn,
)
from standoff.kernels.patches.places import (
    ALL_PLACES,
    PLACE_REALS,
    POINT_A,
    POINT_B,
    write_place,
)
from standoff.kernels.patches.region import Sides, asked_of, seen_along, spots
from standoff.kernels.patches.seen import (
    N_COUNTS,
    PARTS,
    POINT_REALS,
    SEGMENT_REALS,
    Room,
    room_reals,
)
from standoff.kernels.patches.tolerances import OWN_REACH
from standoff.kernels.state.arrays import DISTANCE, FAR, NORMAL, POSE_A, POSE_B, STATUS
from standoff.kernels.state.arrays import POINT_A as ANSWER_A
from standoff.kernels.state.arrays import POINT_B as ANSWER_B
from standoff.kernels.values import side_of


@entry(INTS, INTS, work="patches")
def patch_room(ints_a, ints_b):
    """How many numbers the room of a pair has."""
    a, b = room_reals(pointer(ints_a, 0)), room_reals(pointer(ints_b, 0))
    return ALL_PLACES + a + b


@kernel
def room_at(ints, reals, counts):
    """A body's room in the numbers from `reals` on."""
    edges = ints[L.N_EDGES]
    points = ahead(reals, 2 * PARTS * SEGMENT_REALS * edges)
    faces = ahead(points, POINT_REALS * (ints[L.N_VERTICES] + PARTS * edges))
    return Room(counts, reals, points, faces)


@kernel
def sides_of(pair, pose, n, x, y, reals, counts):
    """Both bodies as they are seen along n, with their rooms in the numbers from `reals` on."""
    a, b = seen_along(pair, pose, n, x, y)
    room_a = room_at(pair.ints_a, reals, counts[0])
    room_b = room_at(pair.ints_b, ahead(reals, room_reals(pair.ints_a)), counts[1])
    return Sides(a, b, room_a, room_b)


@kernel
def with_own(corners, n, places, count, sides, one):
    """With the witness points themselves, which are written as one more place, if they are outside
    of a patch that has room, and no places on a rim stand for them; how many corners."""
    if n > 0:
        level = sides.room_a.counts[2] + sides.room_b.counts[2] > 0
        least = max(one, OWN_REACH * extent(corners, n))
        if n == MOST_CORNERS or level or outside(corners, n, 0.0, 0.0) <= least:
            return n
    return put_corner(corners, n, places, count)


@kernel
def turned_points(pose, last):
    """The kept points of B, in A's frame."""
    return (
        add(rotate(pose.R, read_vector(last, 4)), pose.p),
        add(rotate(pose.R, read_vector(last, 10)), pose.p),
        add(rotate(pose.R, read_vector(last, 16)), pose.p),
        add(rotate(pose.R, read_vector(last, 22)), pose.p),
    )


@kernel
def write_patch(corners, m, places, pose, last):
    """Write the places of corners into a patch."""
    last[0] = m
    for i in range(m):
        at = PLACE_REALS * int(corners[CORNER_REALS * i + ROW])
        y = rotate_back(pose.R, sub(read_vector(places, at + POINT_B), pose.p))
        for j in range(3):
            last[1 + 6 * i + j], last[4 + 6 * i + j] = places[at + POINT_A + j], y[j]


@kernel
def patch_at(pair, answer, poses, wider, reals, last):
    """Write the patch of an answer into `last`, which holds that of the frame before, none with
    last[0] = 0; to `reals` what is found on the way."""
    pose = relative_pose(ahead(poses, POSE_A), ahead(poses, POSE_B))
    Ra, pa = read_rotation(poses, POSE_A), read_vector(poses, POSE_A + 9)
    n = rotate_back(Ra, read_vector(answer, NORMAL))
    x = rotate_back(Ra, sub(read_vector(answer, ANSWER_A), pa))
    y = rotate_back(Ra, sub(read_vector(answer, ANSWER_B), pa))
    asked = asked_of(pair, answer[DISTANCE], wider)
    core_x = axpy(-pair.reals_a[L.RADIUS], n, x)
    core_y = axpy(pair.reals_b[L.RADIUS], n, y)
    counts = ints_on_stack(N_COUNTS), ints_on_stack(N_COUNTS)  # they last as long as this frame
    sides = sides_of(pair, pose, n, core_x, core_y, ahead(reals, ALL_PLACES), counts)
    place = place_of(answer)
    count = spots(sides, (side_of(place, 0), side_of(place, 1)), reals, asked)
    corners = reals_on_stack(ALL_CORNERS)
    turned = turned_points(pose, last)
    m = chosen(corners, reals, count, last, turned, asked.one)
    write_place(reals, count, (0.0, 0.0, 0.0), x, y)
    m = with_own(corners, m, reals, count, sides, asked.one)
    put_in_turn(corners, m, reals, last, turned)
    write_patch(corners, m, reals, pose, last)


@kernel
def tell(last, poses, out):
    """Write a patch into an answer's row: how many pairs, and their points in world axes."""
    m = int(last[0])
    out[0] = m
    for i in range(MOST_CORNERS):
        for side in range(2):
            o, p = 1 + 6 * i + 3 * side, POSE_B if side else POSE_A
            R, shift = read_rotation(poses, p), read_vector(poses, p + 9)
            x = add(rotate(R, read_vector(last, o)), shift)
            for j in range(3):
                out[o + j] = x[j] if i < m else nan


@entry(PAIR, READ_ROWS, READ_ROWS, REAL, INT, READ, WRITE, ROWS, work="patches")
def patches(pair, answers, poses, wider, keeping, before, room, outs):
    """Patches of the first rows of answers (n, N_OUT) at poses (n, 24) into outs (n, PATCH_REALS).

    With `keeping` each frame goes on with the corners of the one before, the first with those of
    `before` (PATCH_REALS), points of A in A's frame and of B in B's. A row without a distance has
    no pairs, and is passed over. `room` is as long as `patch_room` says.
    """
    pointers, reals = pair_pointers(pair), pointer(room, 0)
    rows, motions = answers.reshape(answers.size), poses.reshape(poses.size)
    to = outs.reshape(outs.size)
    none, last = reals_on_stack(PATCH_REALS), reals_on_stack(PATCH_REALS)
    for k in range(PATCH_REALS):
        none[k], last[k] = 0.0, before[k]
    for k in range(len(answers)):
        row, pose = (
            ahead(pointer(rows, 0), answers.shape[1] * k),
            ahead(pointer(motions, 0), 24 * k),
        )
        out = ahead(pointer(to, 0), PATCH_REALS * k)
        if row[STATUS] == FAR or not abs(row[DISTANCE]) < inf:
            tell(none, pose, out)
            continue
        if not keeping:
            last[0] = before[0] if k == 0 else 0.0
        patch_at(pointers, row, pose, wider, reals, last)
        tell(last, pose, out)
