"""What has gone past a hollow edge or vertex of the other solid, or past an end of one, where a
contact begins."""

from standoff.kernels.algebra.vectors import dot, rotate_back
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.contact_ends import dim_of
from standoff.kernels.solids.contact_front import is_near
from standoff.kernels.solids.contact_sets import NO_MINIMUM
from standoff.kernels.solids.hollow import beside_edge, held_at_hollow, held_by
from standoff.kernels.solids.patch import normal_of
from standoff.kernels.solids.planar_tolerances import AT_OPTIMUM
from standoff.kernels.solids.spatial_minimum import nearest
from standoff.kernels.solids.spatial_pieces import leaf_box, leaf_jet, on_solid
from standoff.kernels.solids.spatial_progress import BOUND, MINIMUM_REALS, N_MINIMA, middle
from standoff.kernels.solids.spatial_tolerances import FELT_SPARE


@kernel
def is_nearest(own, leaf, at, other, reach, counts):
    """Is nothing of a boundary nearer to a point of the other solid's leaf, at its parameters, than
    `reach`?"""
    x, box = leaf_jet(own, leaf, at[0], at[1])[0], S.Box(at[0], at[0], at[1], at[1])
    for k in range(other.own[S.N_LEAVES]):
        if not is_near(other, k, x, reach):
            continue
        part = leaf_box(other, k)
        start = (at[0], at[1], *middle(part))
        q, distance = nearest(own, leaf, box, other, k, part, start, counts)
        if distance < reach and on_solid(other, k, q[2], q[3]):
            return False
    return True


@kernel
def is_within(side, other, q, leaves, n, reach, counts):
    """Is there nothing but material between what is held at a hollow edge or vertex, of `side`, and
    that? A point that has gone past it has the rest of that boundary farther away; of an edge that
    has gone past an end of one that end is inside, as deep as it is under the faces beside the
    edge. All but n, A's frame, in the order of the two."""
    if dim_of(side, leaves[0]) == 0 or dim_of(other, leaves[1]) == 1:
        return is_nearest(side, leaves[0], (q[0], q[1]), other, reach, counts)
    own, least = rotate_back(side.pose.R, n), 1.0
    for k in range(2):
        least = min(least, abs(dot(beside_edge(side, leaves[0], q[0], k), own)))
    return is_nearest(other, leaves[1], (q[2], q[3]), side, least * reach, counts)


@kernel
def leave_out_through(both, best, minima, counts):
    """Of a contact that begins, take out the pairs at a hollow edge or vertex between which the
    material ends."""
    a, b, fans = both.a, both.b, both.fans
    for i in range(int(best[N_MINIMA])):
        o = MINIMUM_REALS * i
        leaves, d = (int(minima[o + 1]), int(minima[o + 2])), minima[o]
        if d >= 0.0:
            continue
        q, n = (minima[o + 3], minima[o + 4], minima[o + 5], minima[o + 6]), normal_of(minima, o)
        if held_at_hollow(a, b, fans, q, leaves, n, AT_OPTIMUM) == 0:
            continue
        reach = -d * (1.0 - FELT_SPARE)
        if held_by(a, b, fans, q, leaves, n, AT_OPTIMUM) > 0:
            held = is_within(a, b, q, leaves, n, reach, counts)
        else:
            at, back = (q[2], q[3], q[0], q[1]), (leaves[1], leaves[0])
            held = is_within(b, a, at, back, n, reach, counts)
        if not held:
            minima[o], minima[o + BOUND] = 0.0, NO_MINIMUM
