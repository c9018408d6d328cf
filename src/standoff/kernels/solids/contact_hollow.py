"""Vertices past a hollow edge or vertex of the other solid, where a contact begins."""

from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.contact_front import is_near
from standoff.kernels.solids.contact_sets import NO_MINIMUM
from standoff.kernels.solids.patch import normal_of
from standoff.kernels.solids.planar_tolerances import AT_OPTIMUM
from standoff.kernels.solids.spatial_minimum import nearest
from standoff.kernels.solids.spatial_pieces import leaf_box, leaf_ints, leaf_jet, on_solid
from standoff.kernels.solids.spatial_progress import BOUND, MINIMUM_REALS, N_MINIMA, middle
from standoff.kernels.solids.spatial_tolerances import FELT_SPARE
from standoff.kernels.solids.stationary import is_held_inside


@kernel
def is_nearest(own, leaf, other, reach, counts):
    """Is nothing of a boundary nearer to a vertex of the other solid than `reach`?"""
    x, box = leaf_jet(own, leaf, 0.0, 0.0)[0], leaf_box(own, leaf)
    for k in range(other.own[S.N_LEAVES]):
        if not is_near(other, k, x, reach):
            continue
        part = leaf_box(other, k)
        start = (0.0, 0.0, *middle(part))
        q, distance = nearest(own, leaf, box, other, k, part, start, counts)
        if distance < reach and on_solid(other, k, q[2], q[3]):
            return False
    return True


@kernel
def leave_out_through(both, best, minima, counts):
    """Of a contact that begins, take out the pairs of a vertex and a hollow edge or vertex that is
    not the nearest of its boundary: between them the material ends."""
    a, b = both.a, both.b
    for i in range(int(best[N_MINIMA])):
        o = MINIMUM_REALS * i
        leaves, d = (int(minima[o + 1]), int(minima[o + 2])), minima[o]
        if d >= 0.0:
            continue
        q = (minima[o + 3], minima[o + 4], minima[o + 5], minima[o + 6])
        if not is_held_inside(a, b, both.fans, q, leaves, normal_of(minima, o), AT_OPTIMUM):
            continue
        reach = -d * (1.0 - FELT_SPARE)
        if a.own[leaf_ints(a, leaves[0]) + S.DIM] == 0:
            held = is_nearest(a, leaves[0], b, reach, counts)
        else:
            held = is_nearest(b, leaves[1], a, reach, counts)
        if not held:
            minima[o], minima[o + BOUND] = 0.0, NO_MINIMUM
