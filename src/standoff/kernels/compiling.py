"""How kernels are compiled: one place for the options of Numba.

`error_model="numpy"` lets a division by zero give inf or nan as in NumPy instead of raising in
the middle of a step. `small` asks LLVM to inline: measured in docs/spikes/dispatch.md, without
it a step takes 1.6 times as long.

With STANDOFF_BOUNDS_CHECK=1 in the environment every index of an array or a pointer is checked, at
several times the cost; see `bounds`. It then keeps machine code only where NUMBA_CACHE_DIR says, so
that checked and unchecked code never share a cache.
"""

import os

import numpy as np
from llvmlite import ir
from numba import config, njit, types
from numba.core import cgutils
from numba.extending import intrinsic

BOUNDS_CHECK = os.environ.get("STANDOFF_BOUNDS_CHECK", "0") not in ("", "0")

CACHED = not BOUNDS_CHECK or bool(config.CACHE_DIR)

kernel = njit(cache=CACHED, error_model="numpy", boundscheck=BOUNDS_CHECK or None)
# Inlining is for speed alone; checked code would grow out of proportion by it.
small = njit(
    cache=CACHED,
    error_model="numpy",
    boundscheck=BOUNDS_CHECK or None,
    forceinline=not BOUNDS_CHECK,
)


@intrinsic
def _pointer(typingctx, array, offset):  # type: ignore[no-untyped-def]
    def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
        view = context.make_array(signature.args[0])(context, builder, args[0])
        return builder.gep(view.data, [args[1]])

    return types.CPointer(array.dtype)(array, types.intp), codegen


# Three rows of ten Bernstein polynomials: NURBS have degrees up to 9.
STACK_REALS = 32


if BOUNDS_CHECK:
    from standoff.kernels.bounds import CheckedArray, checked_pointer, checked_stack

if config.DISABLE_JIT:

    def stack_reals():  # type: ignore[no-untyped-def]
        return pointer(np.full(STACK_REALS, np.nan), 0)

    def pointer(array, offset):  # type: ignore[no-untyped-def]
        rest = array.view(np.ndarray)[offset:]
        return rest.view(CheckedArray) if BOUNDS_CHECK else rest

elif BOUNDS_CHECK:

    @intrinsic
    def stack_reals(typingctx):  # type: ignore[no-untyped-def]
        """STACK_REALS numbers of the caller's stack, NaN until they are set."""
        return checked_stack(STACK_REALS)

    @kernel
    def pointer(array, offset):  # type: ignore[no-untyped-def]
        return checked_pointer(array, offset)

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
