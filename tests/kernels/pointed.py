"""Arrays that kernels take as pointers, as they do below an entry.

A kernel that a test calls with them uses the modules that all entries call, which `standoff warmup`
has compiled. With plain arrays all these would be compiled again, for a minute or more.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import config, types
from numba.extending import NativeValue, typeof_impl, unbox
from numba.np import numpy_support

from standoff.kernels.compiler.decorators import BOUNDS_CHECK

PLAIN = bool(config.DISABLE_JIT) or BOUNDS_CHECK
"""Plain Python has no pointers, and checked ones know how far they reach."""


class Pointed(np.ndarray):
    """An array of one dimension without gaps, which compiled code takes as a pointer."""


def pointed(array: np.ndarray) -> np.ndarray:
    """The same memory."""
    assert array.ndim == 1
    assert array.flags.c_contiguous
    return array if PLAIN else array.view(Pointed)


@typeof_impl.register(Pointed)
def _type_of(array: Pointed, context: Any) -> types.CPointer:
    return types.CPointer(numpy_support.from_dtype(array.dtype))


@unbox(types.CPointer)
def _address_of(kind: types.CPointer, value: Any, c: Any) -> NativeValue:
    holder = c.pyapi.object_getattr_string(value, "ctypes")
    address = c.pyapi.object_getattr_string(holder, "data")
    number = c.pyapi.long_as_voidptr(address)
    c.pyapi.decref(address)
    c.pyapi.decref(holder)
    return NativeValue(c.builder.bitcast(number, c.context.get_value_type(kind)))
