"""Bodies that Python hands over as arrays, as kernels read them."""

from standoff.kernels.compiler.decorators import kernel, pointer
from standoff.kernels.values import Pair


@kernel
def pair_pointers(pair):
    return Pair(pointer(pair[0], 0), pointer(pair[1], 0), pointer(pair[2], 0), pointer(pair[3], 0))
