"""Pointers that check every index: what `decorators.pointer` gives under STANDOFF_BOUNDS_CHECK=1.

Numba's own check (NUMBA_BOUNDSCHECK) sees arrays only, and lets -1 mean the last element. These
know how many elements lie ahead of them, and refuse any index below 0 or beyond. docs/fuzzing.md
says how the library is run with them. In plain Python (NUMBA_DISABLE_JIT=1) the same check is a
kind of array, and the error has the line at fault in its traceback.
"""

import operator

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.errors import TypingError
from numba.extending import intrinsic, models, overload, register_model

BEYOND = "kernel index out of range (index, elements)"


class CheckedArray(np.ndarray):
    """A 1-D array that refuses indices below 0 or beyond its end."""

    def _check(self, index):
        if index < 0 or index >= len(self):
            raise IndexError(BEYOND, int(index), len(self))

    def __getitem__(self, index):
        self._check(index)
        return super().__getitem__(index).item()

    def __setitem__(self, index, value):
        self._check(index)
        super().__setitem__(index, value)


class CheckedPointer(types.Type):
    """A pointer with the number of elements from it to the end of its array."""

    def __init__(self, dtype):
        self.dtype = dtype
        super().__init__(name=f"CheckedPointer({dtype})")


@register_model(CheckedPointer)
class _CheckedPointerModel(models.StructModel):
    def __init__(self, manager, kind):
        members = [("data", types.CPointer(kind.dtype)), ("length", types.intp)]
        super().__init__(manager, kind, members)


@intrinsic
def checked_pointer(typingctx, array, offset):
    """The pointer to element `offset` of an array in C order; `offset` is not checked."""
    if not isinstance(array, types.Array) or array.layout != "C":
        raise TypingError(f"a pointer to {array}: give an array in C order")
    kind = CheckedPointer(array.dtype)

    def codegen(context, builder, signature, args):
        view = context.make_array(signature.args[0])(context, builder, args[0])
        size = view.nitems
        out = cgutils.create_struct_proxy(kind)(context, builder)
        out.data = builder.gep(view.data, [args[1]])
        out.length = builder.sub(size, args[1])
        return out._getvalue()

    return kind(array, types.intp), codegen


@intrinsic
def checked_ahead(typingctx, pointer, offset):
    """The pointer `offset` elements farther; `offset` is not checked."""

    def codegen(context, builder, signature, args):
        old = cgutils.create_struct_proxy(signature.args[0])(context, builder, args[0])
        out = cgutils.create_struct_proxy(signature.return_type)(context, builder)
        out.data = builder.gep(old.data, [args[1]])
        out.length = builder.sub(old.length, args[1])
        return out._getvalue()

    return pointer(pointer, types.intp), codegen


def checked_stack(count, of=types.float64):
    """Signature and code of an intrinsic: `count` NaN, or zeros of a whole type, on the caller's
    stack, as a pointer."""
    kind = CheckedPointer(of)
    unset = np.nan if of is types.float64 else 0

    def codegen(context, builder, signature, args):
        shape = ir.ArrayType(context.get_data_type(of), count)
        block = cgutils.alloca_once(builder, shape)
        builder.store(ir.Constant(shape, [unset] * count), block)
        zero = ir.IntType(64)(0)
        out = cgutils.create_struct_proxy(kind)(context, builder)
        out.data = builder.gep(block, [zero, zero], inbounds=True)
        out.length = ir.IntType(64)(count)
        return out._getvalue()

    return kind(), codegen


def checked_scratch(count, of):
    """Signature and code of an intrinsic: a constant count of numbers on the caller's stack."""
    if not isinstance(count, types.IntegerLiteral):
        return None
    kind, length = CheckedPointer(of), count.literal_value

    def codegen(context, builder, signature, args):
        with builder.goto_entry_block():
            block = builder.alloca(ir.ArrayType(context.get_data_type(of), length))
        zero = ir.IntType(64)(0)
        out = cgutils.create_struct_proxy(kind)(context, builder)
        out.data = builder.gep(block, [zero, zero], inbounds=True)
        out.length = ir.IntType(64)(length)
        return out._getvalue()

    return kind(count), codegen


def checked_address(address, length, of):
    """Signature and code of an intrinsic: the pointer to `length` elements at an address."""
    kind = CheckedPointer(of)

    def codegen(context, builder, signature, args):
        out = cgutils.create_struct_proxy(kind)(context, builder)
        out.data = builder.inttoptr(args[0], context.get_value_type(types.CPointer(of)))
        out.length = args[1]
        return out._getvalue()

    return kind(address, length), codegen


@intrinsic
def _length(typingctx, pointer):
    def codegen(context, builder, signature, args):
        return cgutils.create_struct_proxy(signature.args[0])(context, builder, args[0]).length

    return types.intp(pointer), codegen


@intrinsic
def _load(typingctx, pointer, index):
    def codegen(context, builder, signature, args):
        data = cgutils.create_struct_proxy(signature.args[0])(context, builder, args[0]).data
        return builder.load(builder.gep(data, [args[1]]))

    return pointer.dtype(pointer, types.intp), codegen


@intrinsic
def _store(typingctx, pointer, index, value):
    def codegen(context, builder, signature, args):
        data = cgutils.create_struct_proxy(signature.args[0])(context, builder, args[0]).data
        builder.store(args[2], builder.gep(data, [args[1]]))

    return types.void(pointer, types.intp, pointer.dtype), codegen


@overload(operator.getitem)
def _getitem(pointer, index):
    if isinstance(pointer, CheckedPointer) and isinstance(index, types.Integer):

        def get(pointer, index):
            if index < 0 or index >= _length(pointer):
                raise IndexError(BEYOND, index, _length(pointer))
            return _load(pointer, index)

        return get
    return None


@overload(operator.setitem)
def _setitem(pointer, index, value):
    if isinstance(pointer, CheckedPointer) and isinstance(index, types.Integer):

        def put(pointer, index, value):
            if index < 0 or index >= _length(pointer):
                raise IndexError(BEYOND, index, _length(pointer))
            _store(pointer, index, value)

        return put
    return None
