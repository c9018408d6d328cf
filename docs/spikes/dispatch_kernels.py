"""Kernels of the dispatch spike: jets, the candidates' ways to call them, the step.

A jet is (x, x_u, x_v, x_uu, x_uv, x_vv), six 3-tuples. Measured by dispatch.py.
"""

import json
import math
import os
from collections import namedtuple

import numpy as np
from llvmlite import ir
from numba import carray, njit, types
from numba.core import cgutils
from numba.extending import intrinsic

OPTIONS = json.loads(os.environ.get("SPIKE_OPTIONS", "{}"))
POINTER = types.CPointer(types.float64)
PLANE, SPHERE, CYLINDER, USER = range(4)


def jit(function):
    return njit(cache=True, **OPTIONS)(function)


def inlined(function):
    return njit(cache=True, **({"forceinline": True} | OPTIONS))(function)


# --- jets of the kinds: canonical form behind an affine map of 12 numbers, extras after it ------


@inlined
def linear(m, o, p):
    return (
        m[o] * p[0] + m[o + 1] * p[1] + m[o + 2] * p[2],
        m[o + 3] * p[0] + m[o + 4] * p[1] + m[o + 5] * p[2],
        m[o + 6] * p[0] + m[o + 7] * p[1] + m[o + 8] * p[2],
    )


@inlined
def affine(m, o, jet):
    x = linear(m, o, jet[0])
    x = (x[0] + m[o + 9], x[1] + m[o + 10], x[2] + m[o + 11])
    xu, xv = linear(m, o, jet[1]), linear(m, o, jet[2])
    return x, xu, xv, linear(m, o, jet[3]), linear(m, o, jet[4]), linear(m, o, jet[5])


@inlined
def jet_plane(data, o, u, v):
    zero = (0.0, 0.0, 0.0)
    return affine(data, o, ((u, v, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), zero, zero, zero))


@inlined
def jet_sphere(data, o, u, v):
    w = 1.0 / math.sqrt(1.0 + u * u + v * v)
    w3 = w * w * w
    w5 = 3.0 * w3 * w * w
    wu, wv, wuu, wuv, wvv = -u * w3, -v * w3, u * u * w5 - w3, u * v * w5, v * v * w5 - w3
    return affine(data, o, (
        (u * w, v * w, w),
        (u * wu + w, v * wu, wu), (u * wv, v * wv + w, wv),
        (u * wuu + 2.0 * wu, v * wuu, wuu),
        (u * wuv + wv, v * wuv + wu, wuv),
        (u * wvv, v * wvv + 2.0 * wv, wvv),
    ))  # fmt: skip


@inlined
def jet_cylinder(data, o, u, v):
    c, s, zero = math.cos(u), math.sin(u), (0.0, 0.0, 0.0)
    return affine(data, o, ((c, s, v), (-s, c, 0.0), (0.0, 0.0, 1.0), (-c, -s, 0.0), zero, zero))


@inlined
def jet_user(data, o, u, v):  # stands for code printed by SymPy; two extras: the curvatures
    a, b, zero = data[o + 12], data[o + 13], 0.0
    return affine(data, o, (
        (u, v, -0.5 * (a * u * u + b * v * v) - 0.05 * u * u * v * v),
        (1.0, zero, -a * u - 0.1 * u * v * v), (zero, 1.0, -b * v - 0.1 * u * u * v),
        (zero, zero, -a - 0.1 * v * v), (zero, zero, -0.2 * u * v), (zero, zero, -b - 0.1 * u * u),
    ))  # fmt: skip


def make_torus(radius):
    @inlined
    def jet_torus(data, o, u, v):
        cu, su, cv, sv = math.cos(u), math.sin(u), math.cos(v), math.sin(v)
        w = radius + cv
        return affine(data, o, (
            (w * cu, w * su, sv), (-w * su, w * cu, 0.0), (-sv * cu, -sv * su, cv),
            (-w * cu, -w * su, 0.0), (sv * su, -sv * cu, 0.0), (-cv * cu, -cv * su, -sv),
        ))  # fmt: skip

    return jet_torus


# --- the candidates' jets ------------------------------------------------------------------------


@inlined
def jet_chain(kind, data, o, u, v):  # (a); a user's function must be compiled in
    if kind == SPHERE:
        return jet_sphere(data, o, u, v)
    if kind == PLANE:
        return jet_plane(data, o, u, v)
    if kind == CYLINDER:
        return jet_cylinder(data, o, u, v)
    return jet_user(data, o, u, v)


T4, T5, T6, T7, T8, T9, T10 = (make_torus(float(r)) for r in range(4, 11))


@inlined
def jet_long(kind, data, o, u, v):  # (a) with seven more kinds, to see how compile time grows
    if kind == 4:
        return T4(data, o, u, v)
    if kind == 5:
        return T5(data, o, u, v)
    if kind == 6:
        return T6(data, o, u, v)
    if kind == 7:
        return T7(data, o, u, v)
    if kind == 8:
        return T8(data, o, u, v)
    if kind == 9:
        return T9(data, o, u, v)
    if kind == 10:
        return T10(data, o, u, v)
    return jet_chain(kind, data, o, u, v)


@intrinsic
def jet_at(typing_context, address, data, o, u, v):
    """Call the C function at `address` as f(u, v, data + o, out); out is 18 doubles of stack."""
    vector = types.UniTuple(types.float64, 3)
    jet_type = types.UniTuple(vector, 6)

    def codegen(context, builder, signature, arguments):
        target, array, offset, pu, pv = arguments
        double, index = ir.DoubleType(), ir.IntType(64)
        out = cgutils.alloca_once(builder, ir.ArrayType(double, 18))
        first = builder.gep(out, [index(0), index(0)], inbounds=True)
        base = context.make_array(signature.args[1])(context, builder, array).data
        kind = ir.FunctionType(ir.VoidType(), [double, double, base.type, first.type])
        call = builder.inttoptr(target, kind.as_pointer())
        builder.call(call, [pu, pv, builder.gep(base, [offset]), first])
        item = [builder.load(builder.gep(first, [index(i)])) for i in range(18)]
        rows = [context.make_tuple(builder, vector, item[i : i + 3]) for i in range(0, 18, 3)]
        return context.make_tuple(builder, jet_type, rows)

    return jet_type(types.int64, data, types.int64, types.float64, types.float64), codegen


@intrinsic
def jet_at_into(typing_context, address, data, o, u, v, out):
    """The same, writing in a given array instead of the stack."""

    def codegen(context, builder, signature, arguments):
        target, array, offset, pu, pv, buffer = arguments
        double = ir.DoubleType()
        base = context.make_array(signature.args[1])(context, builder, array).data
        first = context.make_array(signature.args[5])(context, builder, buffer).data
        kind = ir.FunctionType(ir.VoidType(), [double, double, base.type, first.type])
        call = builder.inttoptr(target, kind.as_pointer())
        builder.call(call, [pu, pv, builder.gep(base, [offset]), first])
        return context.get_dummy_value()

    f8 = types.float64
    return types.void(types.int64, data, types.int64, f8, f8, out), codegen


@inlined
def jet_hybrid(kind, table, data, o, u, v):  # (d)
    if kind == SPHERE:
        return jet_sphere(data, o, u, v)
    if kind == PLANE:
        return jet_plane(data, o, u, v)
    if kind == CYLINDER:
        return jet_cylinder(data, o, u, v)
    return jet_at(table[kind], data, o, u, v)


@jit
def jet_long_called(kind, data, o, u, v):
    return jet_long(kind, data, o, u, v)


@jit
def jet_hybrid_called(kind, table, data, o, u, v):
    return jet_hybrid(kind, table, data, o, u, v)


@inlined
def store(jet, out):
    for i, row in enumerate(jet):
        out[3 * i], out[3 * i + 1], out[3 * i + 2] = row


@inlined
def jet_chain_into(kind, data, o, u, v, out):
    if kind == SPHERE:
        store(jet_sphere(data, o, u, v), out)
    elif kind == PLANE:
        store(jet_plane(data, o, u, v), out)
    elif kind == CYLINDER:
        store(jet_cylinder(data, o, u, v), out)
    else:
        store(jet_user(data, o, u, v), out)


@inlined
def from_array(a):
    return (
        (a[0], a[1], a[2]), (a[3], a[4], a[5]), (a[6], a[7], a[8]),
        (a[9], a[10], a[11]), (a[12], a[13], a[14]), (a[15], a[16], a[17]),
    )  # fmt: skip


# --- the step: relative pose, H, g, LDLᵀ ---------------------------------------------------------


@inlined
def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def solve(a00, a10, a11, a20, a21, a22, a30, a31, a32, a33, b):
    l10, l20, l30 = a10 / a00, a20 / a00, a30 / a00
    d1 = a11 - l10 * a10
    m21, m31 = a21 - l20 * a10, a31 - l30 * a10
    l21, l31 = m21 / d1, m31 / d1
    d2 = a22 - l20 * a20 - l21 * m21
    m32 = a32 - l30 * a20 - l31 * m21
    l32 = m32 / d2
    d3 = a33 - l30 * a30 - l31 * m31 - l32 * m32
    y1 = b[1] - l10 * b[0]
    y2 = b[2] - l20 * b[0] - l21 * y1
    x3 = (b[3] - l30 * b[0] - l31 * y1 - l32 * y2) / d3
    x2 = y2 / d2 - l32 * x3
    x1 = y1 / d1 - l21 * x2 - l31 * x3
    return b[0] / a00 - l10 * x1 - l20 * x2 - l30 * x3, x1, x2, x3


@inlined
def advance(jf, jh, pose, k, q):
    """One Newton step of E = |x_f - x_h|²/2; B moves along x so that nothing is loop-invariant."""
    x, fu, fv, fuu, fuv, fvv = jf
    y, hu, hv, huu, huv, hvv = affine(pose, 0, jh)
    r = (x[0] - y[0] - 2e-4 * (k & 1023), x[1] - y[1], x[2] - y[2])
    g = (-dot(fu, r), -dot(fv, r), dot(hu, r), dot(hv, r))
    s = solve(
        dot(fu, fu) + dot(r, fuu), dot(fu, fv) + dot(r, fuv), dot(fv, fv) + dot(r, fvv),
        -dot(hu, fu), -dot(hu, fv), dot(hu, hu) - dot(r, huu),
        -dot(hv, fu), -dot(hv, fv), dot(hu, hv) - dot(r, huv), dot(hv, hv) - dot(r, hvv), g,
    )  # fmt: skip
    return (q[0] + s[0], q[1] + s[1], q[2] + s[2], q[3] + s[3]), 0.5 * dot(r, r)


# --- tables of functions for (b), (c), (d) -------------------------------------------------------

C_JET = types.void(types.float64, types.float64, POINTER, POINTER)
VIEW = types.float64[::1]
JET = types.UniTuple(types.UniTuple(types.float64, 3), 6)
FIRST_CLASS = JET(VIEW, types.int64, types.float64, types.float64)


def c_plane(u, v, p, out):
    store(jet_plane(carray(p, 12), 0, u, v), carray(out, 18))


def c_sphere(u, v, p, out):
    store(jet_sphere(carray(p, 12), 0, u, v), carray(out, 18))


def c_cylinder(u, v, p, out):
    store(jet_cylinder(carray(p, 12), 0, u, v), carray(out, 18))


def c_user(u, v, p, out):
    store(jet_user(carray(p, 14), 0, u, v), carray(out, 18))


def f_plane(data, o, u, v):
    return jet_plane(data, o, u, v)


def f_sphere(data, o, u, v):
    return jet_sphere(data, o, u, v)


def f_cylinder(data, o, u, v):
    return jet_cylinder(data, o, u, v)


def f_user(data, o, u, v):
    return jet_user(data, o, u, v)


# --- the cost of a call from Python --------------------------------------------------------------

Model = namedtuple("Model", "kinds offsets data table edges loops vertices fans")


@jit
def pair_step(kinds, offsets, data, table, pose, q):
    jf = jet_hybrid(kinds[1], table, data, offsets[1], q[0], q[1])
    jh = jet_hybrid(kinds[5], table, data, offsets[5], q[2], q[3])
    return advance(jf, jh, pose, 0, (q[0], q[1], q[2], q[3]))


@jit
def nothing(n):
    return n


@jit
def four_return(a, b, pose, q):
    jf = jet_sphere(a, 14, q[0], q[1])
    jh = jet_sphere(b, 70, q[2], q[3])
    return advance(jf, jh, pose, 0, (q[0], q[1], q[2], q[3]))


@jit
def four_write(a, b, pose, q):
    p, q[4] = four_return(a, b, pose, q)
    q[0], q[1], q[2], q[3] = p


@jit
def packed_return(z):  # pose, q, energy, surfaces in one array
    q = (z[12], z[13], z[14], z[15])
    return advance(jet_sphere(z, 31, q[0], q[1]), jet_sphere(z, 87, q[2], q[3]), z, 0, q)


@jit
def packed_write(z):
    p, z[16] = packed_return(z)
    z[12], z[13], z[14], z[15] = p


@jit
def model_return(m, pose, q):
    return pair_step(m.kinds, m.offsets, m.data, m.table, pose, q)


@jit
def model_write(m, pose, q):
    p, q[4] = pair_step(m.kinds, m.offsets, m.data, m.table, pose, q)
    q[0], q[1], q[2], q[3] = p


@jit
def eight_write(kinds, offsets, data, table, edges, loops, pose, q):
    p, q[4] = pair_step(kinds, offsets, data, table, pose, q)
    q[0], q[1], q[2], q[3] = p


@intrinsic
def doubles_at(typing_context, address):
    def codegen(context, builder, signature, arguments):
        return builder.inttoptr(arguments[0], ir.DoubleType().as_pointer())

    return POINTER(types.int64), codegen


@jit
def address_write(address):  # the packed array by its address: what unboxing an array costs
    packed_write(carray(doubles_at(address), 129))


def scene():
    """Surfaces 0..3 face up (kinds 0..3), 4..7 face down; B lies above A."""
    up = np.diag([1.0, 0.8, 0.9])
    axis_up = np.array([[0.0, 0.9, 0.0], [0.0, 0.0, 1.0], [0.7, 0.0, 0.0]])
    flip = np.diag([1.0, 1.0, -1.0])
    maps = [up, up, axis_up, up]
    rows = [np.r_[m.ravel(), 0.1, 0.0, 0.0, 0.6, 0.9] for m in maps + [flip @ m for m in maps]]
    a = 0.2
    turn = [math.cos(a), -math.sin(a), 0.0, math.sin(a), math.cos(a), 0.0, 0.0, 0.0, 1.0]
    return {
        "kinds": np.array([0, 1, 2, 3] * 2),
        "offsets": np.arange(0, 8 * 14, 14),
        "data": np.concatenate(rows),
        "pose": np.array([*turn, 0.2, 0.1, 2.5]),
    }
