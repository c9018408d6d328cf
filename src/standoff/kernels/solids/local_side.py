"""Near a part of one boundary, is the other boundary on one side of a potential? So solids are
proven to touch that nothing moves apart: a pin that its hole holds all round."""

from math import inf

from standoff.kernels.algebra.vectors import axpy
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.spatial_bounds import proven
from standoff.kernels.solids.spatial_closing import (
    ALL_WAYS,
    FEW_BOXES,
    MOST_BOXES,
    MOST_PAIRS,
    PAIR_REALS,
    by_witness,
    nearest_of,
    no_pair,
    put_halves,
    put_pair,
)
from standoff.kernels.solids.spatial_pieces import (
    OUTSIDE_TRIM,
    ZERO,
    leaf_box,
    leaf_jet,
    natural,
    on_solid,
    reach_of,
    trim_state,
)
from standoff.kernels.solids.spatial_progress import OPEN, ROUNDING, middle
from standoff.kernels.solids.torus_potential import CIRCLE_OF, potential_jet

# Pairs of parts that are looked at for one pair of leaves.
MOST_LOOKS = 60
# A direction turns by no more than the arcsine of the way over the distance: a chord of no more
# than sqrt(2) times that.
CHORD = 1.4143


@kernel
def below_near(phi, most, near, pair, best, work, counts):
    """Is phi at most `most` at all points of A's part that are nearer than `near` to B's? With
    -inf: are all of them farther away?"""
    a, b = pair
    best[OPEN] = inf
    put_pair(work, 0, a.box, b.box, 0.0)
    count, looks = 1, 0
    while count > 0:
        count -= 1
        looks += 1
        o = PAIR_REALS * count
        pa = S.Part(a.side, a.leaf, S.Box(work[o], work[o + 1], work[o + 2], work[o + 3]))
        pb = S.Part(b.side, b.leaf, S.Box(work[o + 4], work[o + 5], work[o + 6], work[o + 7]))
        if no_pair(pa, pb, inf, best[ROUNDING], 0.0)[0] >= near:
            continue
        if trim_state(pa.side, pa.leaf, pa.box) == OUTSIDE_TRIM:
            continue
        if most > -inf and proven(phi, 1.0, most, pa, middle(pa.box), FEW_BOXES, counts):
            continue
        q, distance = nearest_of(pa, pb, counts)
        if distance >= near:
            at = (pa.leaf, pb.leaf, q)
            if by_witness(near, pa, pb, at, ALL_WAYS, FEW_BOXES, best, counts)[0] >= 0:
                continue
        elif on_solid(pa.side, pa.leaf, q[0], q[1]):
            x = leaf_jet(pa.side, pa.leaf, q[0], q[1])[0]
            if most == -inf or potential_jet(phi, x, 0.0)[0] > most:
                return False
        if looks >= MOST_LOOKS or count >= MOST_PAIRS - 2:
            return False
        count = put_halves(pa, pb, best, work, count, 0.0)
    return best[OPEN] == inf


@kernel
def on_one_side(a, b, over, leaves, limits, best, work, counts):
    """Is B's part nowhere below the potential of A's leaf `over` by more than limits[0], and are
    A's leaves nowhere above it by more, within limits[1] of the part? With `over` < 0: are they
    farther away than that?"""
    spare, near = limits
    phi = natural(a, max(over, 0))[1]
    most = spare
    if over < 0:
        most = -inf
    elif not proven(phi, -1.0, spare, b, middle(b.box), MOST_BOXES, counts):
        return False
    for k in range(len(leaves)):
        pa = S.Part(a, leaves[k], leaf_box(a, leaves[k]))
        if not below_near(phi, most, near, (pa, b), best, work, counts):
            return False
    return True


@kernel
def tell_beside(a, b, over, near, told):
    """Of the middle of B's part: into told[1:4] the point itself, moved to half of `near` above the
    potential of A's leaf `over`; into told[4:7] the potential's slope, into told[7] by how much it
    changes over the part, at most; into told[8] whether the middle is on B."""
    q = middle(b.box)
    x = leaf_jet(b.side, b.leaf, q[0], q[1])[0]
    slope, change = ZERO, 0.0
    if over >= 0:
        hu, hv = 0.5 * (b.box.u1 - b.box.u0), 0.5 * (b.box.v1 - b.box.v0)
        reach = reach_of(b.side, b.leaf, hu, hv) + near
        phi = natural(a, over)[1]
        value, slope, _, c1, c2 = potential_jet(phi, x, 0.0)
        if phi.kind == CIRCLE_OF:
            _, _, _, c1, c2 = potential_jet(phi, x, reach)
            change = (c1 + c2) * reach
        else:  # a direction from one point, or its part across an axis
            change = CHORD * c1 * reach if c1 * reach < 1.0 else inf
        x = axpy(max(0.5 * near - value, 0.0), slope, x)
    for k in range(3):
        told[1 + k], told[4 + k] = x[k], slope[k]
    told[7] = change
    told[8] = 1.0 if on_solid(b.side, b.leaf, q[0], q[1]) else 0.0
