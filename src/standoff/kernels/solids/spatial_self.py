"""Where a solid's boundary may meet itself: pairs of its own leaves whose boxes are near, and
whether the parts of such a pair meet away from where their faces are joined.

Nothing is asked of normals here, as rule 3 of ``docs/closing.md`` does: of a boundary that crosses
itself no normal tells anything.
"""

from typing import Any, NamedTuple

from standoff.kernels.algebra.vectors import dot, sub
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.crossing_planes import planes_apart
from standoff.kernels.solids.spatial_boxes import gap_of, node_reach
from standoff.kernels.solids.spatial_closing import (
    ALL_WAYS,
    MOST_PAIRS,
    PAIR_REALS,
    by_own_surface,
    by_witness,
    nearest_of,
    no_pair,
    put_halves,
    put_pair,
    split,
    widths,
)
from standoff.kernels.solids.spatial_pieces import (
    OUTSIDE_TRIM,
    leaf_box,
    leaf_ints,
    leaf_jet,
    natural,
    outward_normal,
    trim_state,
)
from standoff.kernels.solids.spatial_progress import (
    BUDGET,
    LEAST,
    N_OPEN,
    ROUNDING,
    SIZE,
    TOLERANCE,
    ball_round,
    evaluations,
    middle,
    on_both,
)
from standoff.kernels.solids.spatial_search import node_ints
from standoff.kernels.solids.spatial_tolerances import MAY_REACH
from standoff.kernels.solids.torus_potential import potential_jet

# What is found of a pair of leaves: proven apart, met, proven apart but beside their joint, open.
APART, MET, BESIDE, OPEN = 0, 1, 2, 3
# What is written of a pair: which of them, the distance of the points found, their parameters.
FOUND_REALS = 6
# What a point of a joint holds: x, y, z, and the radius round it that is left out.
JOINT_REALS = 4
# Which part of a pair is cut.
NEITHER, FIRST, OTHER = 0, 1, 2
# Boxes that a potential is bounded over, of one part: it is cut again if they do not do.
FEW_BOXES = 4


class Joint(NamedTuple):
    """Points of the edges and vertices that two faces have in common, and on which side of each
    face's surface the other was found to be."""

    points: Any
    count: Any
    sides: Any


@kernel
def near_leaves(side, within, stack, pairs, most):
    """List the pairs of leaves of faces, own frame, whose boxes are not farther apart than a
    length; how many there are, of which at most `most` are listed."""
    stack[0], stack[1] = 0, 0
    count, found = 1, 0
    while count > 0:
        count -= 1
        i, j = stack[2 * count], stack[2 * count + 1]
        if i != j and gap_of(side, i, side, j) > within:
            continue
        ri, rj = node_ints(side, i), node_ints(side, j)
        leaf_i, leaf_j = side.own[ri + 2], side.own[rj + 2]
        if leaf_i >= 0 and leaf_j >= 0:
            if is_of_face(side, leaf_i) and is_of_face(side, leaf_j):
                if found < most:
                    pairs[2 * found] = min(leaf_i, leaf_j)
                    pairs[2 * found + 1] = max(leaf_i, leaf_j)
                found += 1
            continue
        if i == j:
            count = put_nodes(stack, count, side.own[ri], side.own[ri])
            count = put_nodes(stack, count, side.own[ri + 1], side.own[ri + 1])
            count = put_nodes(stack, count, side.own[ri], side.own[ri + 1])
        elif leaf_j >= 0 or (leaf_i < 0 and node_reach(side, i) >= node_reach(side, j)):
            count = put_nodes(stack, count, side.own[ri], j)
            count = put_nodes(stack, count, side.own[ri + 1], j)
        else:
            count = put_nodes(stack, count, i, side.own[rj])
            count = put_nodes(stack, count, i, side.own[rj + 1])
    return found


@kernel
def put_nodes(stack, count, i, j):
    stack[2 * count], stack[2 * count + 1] = i, j
    return count + 1


@kernel
def is_of_face(side, leaf):
    return side.own[leaf_ints(side, leaf) + S.DIM] == 2


@kernel
def beyond_joint(joint, x):
    """How far a point is outside of all balls round a joint, length; below 0 inside one."""
    least = 1e300
    for k in range(joint.count):
        o = JOINT_REALS * k
        dx, dy, dz = joint.points[o] - x[0], joint.points[o + 1] - x[1], joint.points[o + 2] - x[2]
        least = min(least, (dx * dx + dy * dy + dz * dz) ** 0.5 - joint.points[o + 3])
    return least


@kernel
def is_beside(joint, part):
    """Is a part proven to be in one of the balls round a joint?"""
    if joint.count == 0:
        return False
    x, radius = ball_round(part)
    return beyond_joint(joint, x) + radius <= 0.0


@kernel
def seen_from(part, sense):
    """The part, with the side from which it is seen."""
    side = part.side
    seen = S.Side(side.ints, side.reals, side.own, side.numbers, side.pose, sense)
    return S.Part(seen, part.leaf, part.box)


@kernel
def facing(part, other):
    """The part, seen from where another part's middle is: outside its surface, or inside."""
    u, v = middle(other.box)
    there = leaf_jet(other.side, other.leaf, u, v)[0]
    outside = seen_from(part, S.OUTSIDE)
    known, phi = natural(outside.side, part.leaf)
    if known:
        height = potential_jet(phi, there, 0.0)[0]
    else:
        u, v = middle(part.box)
        jet = leaf_jet(part.side, part.leaf, u, v)
        height = dot(outward_normal(outside.side, part.leaf, jet), sub(there, jet[0]))
    return outside if height >= 0.0 else seen_from(part, S.INSIDE)


@kernel
def away_from_joint(joint, a, b, q):
    x = leaf_jet(a.side, a.leaf, q[0], q[1])[0]
    y = leaf_jet(b.side, b.leaf, q[2], q[3])[0]
    return beyond_joint(joint, x) > 0.0 and beyond_joint(joint, y) > 0.0


@kernel
def reaches_joint(joint, part):
    """May a part reach into one of the balls round a joint?"""
    if joint.count == 0:
        return False
    x, radius = ball_round(part)
    return beyond_joint(joint, x) <= radius


@kernel
def one_surface(a, b, near):
    """Do two parts seem to lie in one surface, whose potential then tells nothing of them?"""
    known, phi = natural(a.side, a.leaf)
    if not known:
        return False
    box = b.box
    for k in range(3):
        u, v = middle(box)
        if k > 0:
            u, v = (box.u0, box.v0) if k == 1 else (box.u1, box.v1)
        if abs(potential_jet(phi, leaf_jet(b.side, b.leaf, u, v)[0], 0.0)[0]) > near:
            return False
    return True


@kernel
def beyond_surface(goal, a, b, counts):
    """Is one of two parts proven to be farther than `goal` from all of the other's surface?"""
    if by_own_surface(goal, a, b, middle(b.box), FEW_BOXES, counts):
        return True
    return by_own_surface(goal, b, a, middle(a.box), FEW_BOXES, counts)


@kernel
def on_one_side(least, a, b, sides, counts):
    """Is one of two parts proven to be on one side of all of the other's surface, up to a length
    that it may reach beyond it?

    All parts of two faces have to be on the same side: if two of them touch a surface from either
    side, the face may pass through it from one to the other. `sides` keeps which it is.
    """
    for k in range(2):
        of, other = (a, b) if k == 0 else (b, a)
        sense = int(sides[k]) if sides[k] > 0.0 else of.side.sense
        seen = seen_from(of, sense)
        if by_own_surface(-least, seen, other, middle(other.box), FEW_BOXES, counts):
            sides[k] = sense
            return True
    return False


@kernel
def part_to_cut(a, b, near_a, near_b):
    """Which of two parts is to be cut: one near to the joint, if the other's whole surface is
    known; neither, if the longer one is to be."""
    if near_b and natural(a.side, a.leaf)[0]:
        return OTHER
    if near_a and natural(b.side, b.leaf)[0]:
        return FIRST
    return NEITHER


@kernel
def put_parts(a, b, which, best, work, count):
    """Cut one of two parts in two, by default the longer one; the new count of pairs."""
    if which == NEITHER:
        return put_halves(a, b, best, work, count, 0.0)
    cut = a if which == FIRST else b
    wide_u, wide_v = widths(cut.side, cut.leaf, cut.box)
    first, second = split(cut.box, wide_u >= wide_v)
    if which == FIRST:
        put_pair(work, count, first, b.box, 0.0)
        put_pair(work, count + 1, second, b.box, 0.0)
    else:
        put_pair(work, count, a.box, first, 0.0)
        put_pair(work, count + 1, a.box, second, 0.0)
    return count + 2


@kernel
def found_apart(a, b, goal, joint, best, counts):
    """Are two parts proven by potentials to be apart, or, with a joint, not to cross?"""
    a, b = facing(a, b), facing(b, a)
    if beyond_surface(goal, a, b, counts):
        return True
    if joint.count > 0 and on_one_side(MAY_REACH * best[LEAST], a, b, joint.sides, counts):
        return True
    return planes_apart(a, b, best[SIZE])


@kernel
def state_of(a, b, goal, lies, joint, best, counts):
    """What is known of two parts before their nearest points are sought; OPEN: nothing."""
    counts[0] += 1
    if no_pair(a, b, goal, best[ROUNDING], 0.0)[0] >= goal:
        return APART
    if is_beside(joint, a) or is_beside(joint, b):
        return BESIDE
    if (
        trim_state(a.side, a.leaf, a.box) == OUTSIDE_TRIM
        or trim_state(b.side, b.leaf, b.box) == OUTSIDE_TRIM
    ):
        return APART
    return APART if not lies and found_apart(a, b, goal, joint, best, counts) else OPEN


@kernel
def state_by_points(a, b, goal, joint, best, counts, out):
    """The same from their nearest points, which are written into `out` where they meet."""
    q, distance = nearest_of(a, b, counts)
    if distance <= best[LEAST] and on_both(a, b, q) and away_from_joint(joint, a, b, q):
        out[1] = distance
        for k in range(4):
            out[2 + k] = q[k]
        return MET
    a, b = facing(a, b), facing(b, a)
    at = (a.leaf, b.leaf, q)
    if distance >= goal and by_witness(goal, a, b, at, ALL_WAYS, FEW_BOXES, best, counts)[0] >= 0:
        return APART
    return OPEN


@kernel
def meet(side, leaf_a, leaf_b, joint, best, work, counts, out):
    """Do two leaves meet away from their joint? Writes what is found into `out`.

    They meet where points of both are nearer than best[LEAST]. Parts are cut in two until they are
    proven to be farther apart than that less best[TOLERANCE], not to cross, or to lie in the balls
    round the joint."""
    start, opened = evaluations(counts), best[N_OPEN]
    goal = best[LEAST] - best[TOLERANCE] + best[ROUNDING]
    whole_a = S.Part(side, leaf_a, leaf_box(side, leaf_a))
    whole_b = S.Part(side, leaf_b, leaf_box(side, leaf_b))
    put_pair(work, 0, whole_a.box, whole_b.box, 0.0)
    lies = one_surface(whole_a, whole_b, best[LEAST])
    count = 1
    out[0] = APART
    while count > 0:
        count -= 1
        o = PAIR_REALS * count
        a = S.Part(side, leaf_a, S.Box(work[o], work[o + 1], work[o + 2], work[o + 3]))
        b = S.Part(side, leaf_b, S.Box(work[o + 4], work[o + 5], work[o + 6], work[o + 7]))
        state = state_of(a, b, goal, lies, joint, best, counts)
        near_a, near_b = reaches_joint(joint, a), reaches_joint(joint, b)
        if state == OPEN and not (near_a and near_b):
            state = state_by_points(a, b, goal, joint, best, counts, out)
        if state == BESIDE:
            out[0] = BESIDE
        if state == OPEN and (
            evaluations(counts) - start > best[BUDGET] or count >= MOST_PAIRS - 2
        ):
            out[0] = OPEN
            return
        if state == MET:
            out[0] = MET
            return
        if state == OPEN:
            which = NEITHER if lies else part_to_cut(a, b, near_a, near_b)
            count = put_parts(a, b, which, best, work, count)
    if best[N_OPEN] > opened:
        out[0] = OPEN
