"""How kernels are compiled: one place for the options of Numba.

`error_model="numpy"` lets a division by zero give inf or nan as in NumPy instead of raising in
the middle of a step. `small` asks LLVM to inline: measured in docs/spikes/dispatch.md, without
it a step takes 1.6 times as long.
"""

import numpy as np
from llvmlite import ir
from numba import config, njit, types
from numba.core import cgutils
from numba.extending import intrinsic

kernel = njit(cache=True, error_model="numpy")
small = njit(cache=True, error_model="numpy", forceinline=True)


@intrinsic
def _pointer(typingctx, array, offset):  # type: ignore[no-untyped-def]
    def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
        view = context.make_array(signature.args[0])(context, builder, args[0])
        return builder.gep(view.data, [args[1]])

    return types.CPointer(array.dtype)(array, types.intp), codegen


# Three rows of ten Bernstein polynomials: NURBS have degrees up to 9.
STACK_REALS = 32


if config.DISABLE_JIT:

    def stack_reals():  # type: ignore[no-untyped-def]
        return np.zeros(STACK_REALS)

    def pointer(array, offset):  # type: ignore[no-untyped-def]
        return array[offset:]

else:

    @intrinsic
    def stack_reals(typingctx):  # type: ignore[no-untyped-def]
        """STACK_REALS numbers of the caller's stack, not yet set: no allocation, gone with it."""

        def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
            block = cgutils.alloca_once(builder, ir.ArrayType(ir.DoubleType(), STACK_REALS))
            zero = ir.IntType(64)(0)
            return builder.gep(block, [zero, zero], inbounds=True)

        return types.CPointer(types.float64)(), codegen

    @small
    def pointer(array, offset):
        """The address of array[offset], to be indexed like the array itself.

        A compiled function takes an array as seven numbers and counts a reference to it at every
        call; a pointer is one number. Kernels below an entry get pointers: measured, a step takes
        half the time. The entry must keep the array alive until the last use.
        """
        return _pointer(array, offset)
