"""How far a rotation moves what it turns."""

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.tolerances import ROTATION

# The norm of R1 - R0, two rotations, is the root of half the sum of its squares; each may be off
# orthonormal by ROTATION in every entry of R' R, which is less than 3 ROTATION of its norm, and may
# be the product of two such. It is never more than the root of the whole sum.
HALF_ROOT = 0.7071067811865476
OFF_ROTATION = 12.0 * ROTATION


@kernel
def turn_norm(squares):
    """At most how far a point at distance 1 goes, by the sum of the squares of R1 - R0."""
    norm = sqrt(squares)
    return min(norm, HALF_ROOT * norm + OFF_ROTATION)
