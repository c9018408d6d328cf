"""How kernels are compiled: one place for the options of Numba.

`error_model="numpy"` lets a division by zero give inf or nan as in NumPy instead of raising in
the middle of a step. `small` asks LLVM to inline: measured in docs/spikes/dispatch.md, without
it a step takes 1.6 times as long.

With STANDOFF_BOUNDS_CHECK=1 in the environment every index of an array or a pointer is checked, at
several times the cost; see `bounds`. Checked and unchecked code are kept apart in the cache.
"""

import ctypes
import os

import numpy as np
from llvmlite import ir
from numba import config, njit, types
from numba.extending import intrinsic

from standoff.kernels.compiler import modules
from standoff.kernels.compiler.cache import ModuleCache
from standoff.kernels.compiler.entry import Entry

BOUNDS_CHECK = os.environ.get("STANDOFF_BOUNDS_CHECK", "0") not in ("", "0")

OPTIONS = {"nopython": True, "error_model": "numpy", "boundscheck": BOUNDS_CHECK or None}

# A product and a sum become one operation where the processor has it. That rounds once in place of
# twice, so an error bound that counts roundings (BOUND_ROUNDINGS) holds as it did; a b - b a need
# no longer be 0, which `uncontracted` kernels rely on. Without `forceinline` a kernel would take it
# from the caller that is compiled first, and round otherwise where others were compiled before.
CONTRACTED = {**OPTIONS, "fastmath": {"contract"}, "forceinline": False}


def kernel(function):
    """Compile what other kernels call."""
    return _part(function)


def uncontracted(function):
    """`kernel` in which each product is rounded before it is added: where exact zeros tell that a
    line touches a boundary, or that it has met a corner."""
    return _part(function, fastmath=False)


def small_uncontracted(function):
    """`small` and `uncontracted`: the same numbers to the last bit, however it is compiled."""
    return _part(function, fastmath=False, forceinline=not BOUNDS_CHECK)


def small(function):
    """Compile a kernel and inline it wherever it is called."""
    # Inlining is for speed alone; checked code would grow out of proportion by it.
    return _part(function, forceinline=not BOUNDS_CHECK)


def _part(function, **options):
    if config.DISABLE_JIT:
        return function
    options = {**CONTRACTED, **options}
    if not modules.AVAILABLE:
        del options["nopython"]  # njit sets it, and warns of what is told twice
        return njit(**options)(function)
    made = modules.Part(function, options, modules.PartCompiler)
    made.cache_of_calls = ModuleCache(function, called=True)
    return made


def shared(function):
    """Compile a large kernel, which several entries call, as a module of its own."""
    if config.DISABLE_JIT or not modules.AVAILABLE:
        return _part(function)
    made = modules.Part(function, CONTRACTED, modules.SharedCompiler)
    made.cache = ModuleCache(function)
    made.cache_of_calls = ModuleCache(function, called=True)
    return made


def entry(*signature, work, terse=False):
    """Compile what Python calls, with all below it as one module, for the types of `signature`.

    `work` names, for who waits, what it is needed for: a key of `notices.WORK`. Python's lock is
    released while it runs.
    """

    def decorate(function):
        if config.DISABLE_JIT:
            return function
        return Entry(function, CONTRACTED | {"nogil": True}, signature, work, terse)

    return decorate


# Three rows of ten Bernstein polynomials: NURBS have degrees up to 9.
STACK_REALS = 32
# The contact-regular form is 8 x 8.
MATRIX_REALS = 64
# The log of switches of a frame, and its counts (pair.events).
LOG_REALS = 320
COUNT_INTS = 16


if BOUNDS_CHECK:
    from standoff.kernels.compiler.checked_pointers import (
        CheckedArray,
        checked_address,
        checked_ahead,
        checked_pointer,
        checked_scratch,
        checked_stack,
    )

if config.DISABLE_JIT:

    def stack_reals():  # type: ignore[no-untyped-def]
        return pointer(np.full(STACK_REALS, np.nan), 0)

    def stack_matrix():  # type: ignore[no-untyped-def]
        return pointer(np.full(MATRIX_REALS, np.nan), 0)

    def stack_log():  # type: ignore[no-untyped-def]
        return pointer(np.full(LOG_REALS, np.nan), 0)

    def reals_on_stack(count):  # type: ignore[no-untyped-def]
        return pointer(np.full(count, np.nan), 0)

    def ints_on_stack(count):  # type: ignore[no-untyped-def]
        return pointer(np.zeros(count, dtype=np.int64), 0)

    def stack_counts():  # type: ignore[no-untyped-def]
        return pointer(np.zeros(COUNT_INTS, dtype=np.int64), 0)

    def _at(address, length, kind):  # type: ignore[no-untyped-def]
        return pointer(np.ctypeslib.as_array((kind * int(length)).from_address(int(address))), 0)

    def reals_at(address, length):  # type: ignore[no-untyped-def]
        return _at(address, length, ctypes.c_double)

    def ints_at(address, length):  # type: ignore[no-untyped-def]
        return _at(address, length, ctypes.c_int64)

    def pointer(array, offset):  # type: ignore[no-untyped-def]
        rest = array.view(np.ndarray).reshape(-1)[offset:]
        return rest.view(CheckedArray) if BOUNDS_CHECK else rest

    ahead = pointer

elif BOUNDS_CHECK:

    @intrinsic
    def stack_reals(typingctx):  # type: ignore[no-untyped-def]
        """STACK_REALS numbers of the caller's stack, NaN until they are set."""
        return checked_stack(STACK_REALS)

    @intrinsic
    def stack_matrix(typingctx):  # type: ignore[no-untyped-def]
        """MATRIX_REALS numbers of the caller's stack, NaN until they are set."""
        return checked_stack(MATRIX_REALS)

    @intrinsic
    def stack_log(typingctx):  # type: ignore[no-untyped-def]
        """LOG_REALS numbers of the caller's stack, NaN until they are set."""
        return checked_stack(LOG_REALS)

    @intrinsic
    def stack_counts(typingctx):  # type: ignore[no-untyped-def]
        """COUNT_INTS integers of the caller's stack, 0 until they are set."""
        return checked_stack(COUNT_INTS, types.int64)

    @intrinsic(prefer_literal=True)
    def reals_on_stack(typingctx, count):  # type: ignore[no-untyped-def]
        """`count` numbers, a constant, of the caller's stack, not yet set."""
        return checked_scratch(count, types.float64)

    @intrinsic(prefer_literal=True)
    def ints_on_stack(typingctx, count):  # type: ignore[no-untyped-def]
        """`count` integers, a constant, of the caller's stack, not yet set."""
        return checked_scratch(count, types.int64)

    @intrinsic
    def reals_at(typingctx, address, length):  # type: ignore[no-untyped-def]
        """A pointer to the numbers at an address."""
        return checked_address(address, length, types.float64)

    @intrinsic
    def ints_at(typingctx, address, length):  # type: ignore[no-untyped-def]
        """A pointer to the integers at an address."""
        return checked_address(address, length, types.int64)

    @kernel
    def pointer(array, offset):  # type: ignore[no-untyped-def]
        return checked_pointer(array, offset)

    @kernel
    def ahead(pointer, offset):  # type: ignore[no-untyped-def]
        return checked_ahead(pointer, offset)

else:

    def _stack(count, kind=types.float64):  # type: ignore[no-untyped-def]
        def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
            # `cgutils.alloca_once` would fill it with zeros
            with builder.goto_entry_block():
                block = builder.alloca(ir.ArrayType(context.get_data_type(kind), count))
            zero = ir.IntType(64)(0)
            return builder.gep(block, [zero, zero], inbounds=True)

        return types.CPointer(kind)(), codegen

    def _address(address, length, kind):  # type: ignore[no-untyped-def]
        def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
            return builder.inttoptr(args[0], context.get_value_type(signature.return_type))

        return types.CPointer(kind)(address, length), codegen

    @intrinsic
    def stack_reals(typingctx):  # type: ignore[no-untyped-def]
        """STACK_REALS numbers of the caller's stack, not yet set: no allocation, gone with it."""
        return _stack(STACK_REALS)

    @intrinsic
    def stack_matrix(typingctx):  # type: ignore[no-untyped-def]
        """MATRIX_REALS numbers of the caller's stack, not yet set."""
        return _stack(MATRIX_REALS)

    @intrinsic
    def stack_log(typingctx):  # type: ignore[no-untyped-def]
        """LOG_REALS numbers of the caller's stack, not yet set."""
        return _stack(LOG_REALS)

    @intrinsic
    def stack_counts(typingctx):  # type: ignore[no-untyped-def]
        """COUNT_INTS integers of the caller's stack, not yet set."""
        return _stack(COUNT_INTS, types.int64)

    def _scratch(count, kind):  # type: ignore[no-untyped-def]
        if not isinstance(count, types.IntegerLiteral):
            return None
        signature, codegen = _stack(count.literal_value, kind)
        return signature.return_type(count), codegen

    @intrinsic(prefer_literal=True)
    def reals_on_stack(typingctx, count):  # type: ignore[no-untyped-def]
        """`count` numbers, a constant, of the caller's stack, not yet set."""
        return _scratch(count, types.float64)

    @intrinsic(prefer_literal=True)
    def ints_on_stack(typingctx, count):  # type: ignore[no-untyped-def]
        """`count` integers, a constant, of the caller's stack, not yet set."""
        return _scratch(count, types.int64)

    @intrinsic
    def reals_at(typingctx, address, length):  # type: ignore[no-untyped-def]
        """A pointer to the `length` numbers at an address; who gave it keeps them alive."""
        return _address(address, length, types.float64)

    @intrinsic
    def ints_at(typingctx, address, length):  # type: ignore[no-untyped-def]
        """A pointer to the `length` integers at an address."""
        return _address(address, length, types.int64)

    @intrinsic
    def pointer(typingctx, array, offset):  # type: ignore[no-untyped-def]
        """The address of array[offset], to be indexed like the array itself.

        A compiled function takes an array as seven numbers and counts a reference to it at every
        call; a pointer is one number. Kernels below an entry get pointers: measured, a step takes
        half the time. The entry must keep the array alive until the last use.
        """

        def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
            view = context.make_array(signature.args[0])(context, builder, args[0])
            return builder.gep(view.data, [args[1]])

        return types.CPointer(array.dtype)(array, types.intp), codegen

    @intrinsic
    def ahead(typingctx, pointer, offset):  # type: ignore[no-untyped-def]
        """The pointer `offset` elements farther."""

        def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
            return builder.gep(args[0], [args[1]])

        return pointer(pointer, types.intp), codegen
