"""Calls of compiled formulas by their addresses: surfaces and curves that users bring.

An address is below 2^53 and so exact in the float64 where the packed body keeps it.
"""

import ctypes

import numpy as np
from llvmlite import ir
from numba import config, types
from numba.core import cgutils
from numba.extending import intrinsic

VECTOR = types.UniTuple(types.float64, 3)


def _rows(context, builder, first, count):
    number = ir.IntType(64)
    items = [builder.load(builder.gep(first, [number(k)])) for k in range(3 * count)]
    rows = [context.make_tuple(builder, VECTOR, items[k : k + 3]) for k in range(0, 3 * count, 3)]
    return context.make_tuple(builder, types.UniTuple(VECTOR, count), rows)


def _called(parameters, count):
    """Code that calls void f(double..., double *out) at an address and reads `count` vectors."""

    def codegen(context, builder, signature, arguments):
        double = ir.DoubleType()
        out = cgutils.alloca_once(builder, ir.ArrayType(double, 3 * count))
        first = builder.gep(out, [ir.IntType(64)(0), ir.IntType(64)(0)], inbounds=True)
        kind = ir.FunctionType(ir.VoidType(), [double] * parameters + [first.type])
        builder.call(builder.inttoptr(arguments[0], kind.as_pointer()), [*arguments[1:], first])
        return _rows(context, builder, first, count)

    return codegen


if config.DISABLE_JIT:

    def _call(address, parameters, count):
        out = np.zeros(3 * count)
        double, pointer = ctypes.c_double, ctypes.POINTER(ctypes.c_double)
        kind = ctypes.CFUNCTYPE(None, *([double] * len(parameters)), pointer)
        kind(address)(*parameters, out.ctypes.data_as(pointer))
        return tuple(tuple(float(x) for x in row) for row in out.reshape(count, 3))

    def formula_jet(address, u, v):
        return _call(address, (u, v), 6)

    def formula_curve_jet(address, t):
        return _call(address, (t,), 3)

else:

    @intrinsic
    def formula_jet(typing_context, address, u, v):
        """(x, x_u, x_v, x_uu, x_uv, x_vv) from void f(double u, double v, double out[18])."""
        double = types.float64
        return types.UniTuple(VECTOR, 6)(types.int64, double, double), _called(2, 6)

    @intrinsic
    def formula_curve_jet(typing_context, address, t):
        """(x, x_t, x_tt) from void f(double t, double out[9])."""
        return types.UniTuple(VECTOR, 3)(types.int64, types.float64), _called(1, 3)
