"""What is proven of two pieces of boundary in an overlap: that a shift of B parts them."""

from standoff.kernels.algebra.vectors import scale
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.contact_minimum import moved_side
from standoff.kernels.solids.spatial_closing import MOST_BOXES, closed_to
from standoff.kernels.solids.spatial_pieces import leaf_box
from standoff.kernels.solids.spatial_progress import LEAF_A, LEAF_B, MET, TOLERANCE

# Tolerances by which two pieces are apart after the shift, and how much of that is proven.
PARTED_BY, PROVEN_APART = 8.0, 2.0


@kernel
def parts_pieces(a, b, leaves, spot, best, minima, counts):
    """The length by which B is moved along n; no two points of both leaves then meet. 0: not
    proven. spot: parameters of a minimum of the signed distance, n, and the distance."""
    q, n, d = spot
    far = PARTED_BY * best[TOLERANCE]
    moved = moved_side(b, scale(far - d, n))
    pa = S.Part(a, leaves[0], leaf_box(a, leaves[0]))
    pb = S.Part(moved, leaves[1], leaf_box(b, leaves[1]))
    best[LEAF_A], best[LEAF_B], best[MET] = leaves[0], leaves[1], 0.0
    goal = PROVEN_APART * best[TOLERANCE]
    way, _ = closed_to(goal, -1, (pa, pb, q, far), MOST_BOXES, best, minima, counts)
    return far - d if way >= 0 else 0.0
