"""What two threads share without a lock, and the system's clocks, for compiled loops.

Loads and stores are LLVM's atomic ones, with the order that each name says: plain ones may be
merged, moved out of a loop, or seen by another core in another order. All take an array in C order
and the place of an element among all of its elements.

Functions of the system are called by an address that the caller gives, not by a name: code that
names a function which a system does not have could not even be loaded there.
"""

import ctypes

from llvmlite import ir
from numba import config, types
from numba.extending import intrinsic

WORD = 8  # bytes: of every element, and its alignment

if config.DISABLE_JIT:
    # Python's own lock orders what its threads do.

    def load_acquired(array, index):  # type: ignore[no-untyped-def]
        return array.reshape(-1)[index]

    def load_relaxed(array, index):  # type: ignore[no-untyped-def]
        return array.reshape(-1)[index]

    def store_released(array, index, value):  # type: ignore[no-untyped-def]
        array.reshape(-1)[index] = value

    def store_relaxed(array, index, value):  # type: ignore[no-untyped-def]
        array.reshape(-1)[index] = value

    def fence_acquired():  # type: ignore[no-untyped-def]
        return 0

    def fence_released():  # type: ignore[no-untyped-def]
        return 0

    def clock_into(address, clock, moment):  # type: ignore[no-untyped-def]
        ask = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_int, ctypes.c_void_p)(int(address))
        return ask(clock, moment.ctypes.data)

    def sleep_until(address, clock, flags, moment):  # type: ignore[no-untyped-def]
        kinds = (ctypes.c_int, ctypes.c_int, ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p)
        return ctypes.CFUNCTYPE(*kinds)(int(address))(clock, flags, moment.ctypes.data, None)

else:

    def _element(context, builder, kind, array, index):  # type: ignore[no-untyped-def]
        view = context.make_array(kind)(context, builder, array)
        return builder.gep(view.data, [index])

    def _load(array, index, order):  # type: ignore[no-untyped-def]
        def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
            at = _element(context, builder, signature.args[0], args[0], args[1])
            return builder.load_atomic(at, order, WORD)

        return array.dtype(array, types.intp), codegen

    def _store(array, index, value, order):  # type: ignore[no-untyped-def]
        def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
            at = _element(context, builder, signature.args[0], args[0], args[1])
            builder.store_atomic(args[2], at, order, WORD)
            return context.get_dummy_value()

        return types.void(array, types.intp, array.dtype), codegen

    def _fence(order):  # type: ignore[no-untyped-def]
        def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
            builder.fence(order)
            return ir.IntType(64)(0)

        return types.int64(), codegen

    def _called(context, builder, address, kinds, values):  # type: ignore[no-untyped-def]
        function = ir.FunctionType(ir.IntType(32), kinds)
        return builder.call(builder.inttoptr(address, function.as_pointer()), values)

    @intrinsic
    def load_acquired(typingctx, array, index):  # type: ignore[no-untyped-def]
        """An element; what is loaded after it is at least as new."""
        return _load(array, index, "acquire")

    @intrinsic
    def load_relaxed(typingctx, array, index):  # type: ignore[no-untyped-def]
        """An element, whole, in no order with others."""
        return _load(array, index, "monotonic")

    @intrinsic
    def store_released(typingctx, array, index, value):  # type: ignore[no-untyped-def]
        """Set an element; whoever sees it sees all that was stored before it."""
        return _store(array, index, value, "release")

    @intrinsic
    def store_relaxed(typingctx, array, index, value):  # type: ignore[no-untyped-def]
        """Set an element, whole, in no order with others."""
        return _store(array, index, value, "monotonic")

    @intrinsic
    def fence_acquired(typingctx):  # type: ignore[no-untyped-def]
        """What is loaded after it is at least as new as what was loaded before it."""
        return _fence("acquire")

    @intrinsic
    def fence_released(typingctx):  # type: ignore[no-untyped-def]
        """Whoever sees what is stored after it sees what was stored before it."""
        return _fence("release")

    @intrinsic
    def clock_into(typingctx, address, clock, moment):  # type: ignore[no-untyped-def]
        """POSIX clock_gettime at an address: seconds and nanoseconds into two integers."""

        def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
            word = ir.IntType(32)
            at = context.make_array(signature.args[2])(context, builder, args[2]).data
            number = builder.trunc(args[1], word)
            return _called(context, builder, args[0], [word, at.type], [number, at])

        return types.int32(types.int64, types.int64, moment), codegen

    @intrinsic
    def sleep_until(typingctx, address, clock, flags, moment):  # type: ignore[no-untyped-def]
        """POSIX clock_nanosleep at an address, to the moment in two integers."""

        def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
            word = ir.IntType(32)
            at = context.make_array(signature.args[3])(context, builder, args[3]).data
            numbers = [builder.trunc(given, word) for given in args[1:3]]
            kinds = [word, word, at.type, at.type]
            values = [*numbers, at, ir.Constant(at.type, None)]
            return _called(context, builder, args[0], kinds, values)

        return types.int32(types.int64, types.int64, types.int64, moment), codegen
