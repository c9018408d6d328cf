"""Where the arrays of a pair lie in memory, as one number for the kernels."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.bodies.packing import Ints

Pair = tuple[Ints, NDArray[np.float64], Ints, NDArray[np.float64]]


def packed(a: Body, b: Body) -> Pair:
    """What the kernels read from two bodies."""
    return a.ints, a.reals, b.ints, b.reals


class AddressTable:
    """Addresses and lengths of a pair's arrays and its options; it keeps them alive.

    One integer is read by a compiled function much faster than nine arrays.

    Parameters
    ----------
    arrays : tuple of arrays
        In the order of ``TABLE_...`` in ``standoff.kernels.entries.blocks``.

    Attributes
    ----------
    arrays : tuple of arrays
        As given.
    address : int
        Of the table.
    """

    __slots__ = ("_table", "address", "arrays")

    def __init__(self, arrays: tuple[NDArray[Any], ...]) -> None:
        self.arrays = arrays
        rows = [(x.ctypes.data, len(x)) for x in arrays]
        self._table = np.array(rows, dtype=np.int64)
        self.address: int = self._table.ctypes.data
