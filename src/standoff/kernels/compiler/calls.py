"""A compiled frame called by its address, by another that was compiled before it.

The frame is an `Entry` of one address (of a record of addresses) and a time; called is the code
below its Python wrapper, by Numba's own convention: results and errors through pointers.
"""

from typing import Any

from llvmlite import ir
from numba import config, types
from numba.core import cgutils
from numba.extending import intrinsic

from standoff.kernels.compiler import modules
from standoff.kernels.compiler.decorators import BOUNDS_CHECK

CAN_CALL = modules.AVAILABLE and not config.DISABLE_JIT and not BOUNDS_CHECK
"""Checked pointers are no addresses, and Python has none."""

if CAN_CALL:

    @intrinsic
    def address_of(typingctx: Any, pointer: Any) -> Any:
        """Of what a pointer points to."""

        def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            return builder.ptrtoint(args[0], ir.IntType(64))

        return types.int64(pointer), codegen

    @intrinsic
    def call_frame(typingctx: Any, frame: Any, record: Any, h: Any) -> Any:
        """What the frame at an address returns; 0 where it failed."""

        def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            number, byte = ir.IntType(64), ir.IntType(8).as_pointer()
            result = cgutils.alloca_once_value(builder, number(0))
            error = cgutils.alloca_once_value(builder, ir.Constant(byte, None))
            kind = ir.FunctionType(
                ir.IntType(32),
                [number.as_pointer(), byte.as_pointer(), number, ir.DoubleType()],
            )
            called = builder.inttoptr(args[0], kind.as_pointer())
            builder.call(called, [result, error, args[1], args[2]])
            return builder.load(result)

        return types.int64(types.int64, types.int64, types.float64), codegen

else:

    def address_of(pointer):  # type: ignore[no-untyped-def]
        return 0

    def call_frame(frame, record, h):  # type: ignore[no-untyped-def]
        return 0

    if not config.DISABLE_JIT:
        from standoff.kernels.compiler.decorators import small

        address_of, call_frame = small(address_of), small(call_frame)


def address_in_memory(entry: Any) -> int:
    """Where the machine code of an `Entry` that is ready lies, for `call_frame`; 0 where that
    cannot be called."""
    if not CAN_CALL:
        return 0
    made = entry.overloads[entry.signature]
    return int(made.library.get_pointer_to_function(made.fndesc.llvm_func_name))
