"""A pair of bodies and a law as the compiled frames reach them: by address."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.kernels.entries import laws
from standoff.tracking.inputs import check_pair
from standoff.tracking.law_options import Law
from standoff.tracking.laws import DEFAULT_LAW, PaperLaw, PredictorCorrector
from standoff.tracking.options import resolved_options, with_frames
from standoff.tracking.row_pairs import RowPairs
from standoff.tracking.specialised import address_of, smooth_frame_of
from standoff.typing import Array, Ints

Pair = tuple[Ints, NDArray[np.float64], Ints, NDArray[np.float64]]

ANY_TIME = 1.0
"""A frame time [s]: the default law does not depend on it."""

PAIRS = 64
"""Number of pairs kept at hand, with their bodies: the ones used last."""


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
    numbers : (k, 2) array of int
        The table: addresses and lengths.
    address : int
        Of the table.
    """

    __slots__ = ("address", "arrays", "numbers")

    def __init__(self, arrays: tuple[NDArray[Any], ...]) -> None:
        self.arrays = arrays
        rows = [(x.ctypes.data, len(x)) for x in arrays]
        self.numbers = np.array(rows, dtype=np.int64)
        self.address: int = self.numbers.ctypes.data


class AddressTables:
    """The tables of rows that need not be of the same two bodies; it keeps them alive.

    Attributes
    ----------
    tables : sequence of AddressTable
        One of each pair.
    which : (n,) array of int, or (1,) for all rows
        The number of each row's.
    numbers : (k,) array of int
        All tables, one behind the other.
    """

    __slots__ = ("numbers", "tables", "which")

    def __init__(self, tables: Sequence[AddressTable], which: NDArray[np.int64]) -> None:
        self.tables, self.which = tuple(tables), which
        self.numbers = np.concatenate([table.numbers.ravel() for table in tables])


class Reached:
    """A pair and its law; its frames are compiled. A copy, or a pickle's, finds its own addresses.

    Attributes
    ----------
    a, b : Body
    law : Law
        With the defaults that depend on the frame time filled in.
    options : array
        As the kernels read it, with the addresses of its frames.
    table : AddressTable
        Where these and the bodies lie.
    address : int
        Of the table.
    """

    __slots__ = ("_given", "a", "address", "b", "law", "options", "table")

    def __init__(self, a: Body, b: Body, law: Law, dt: float, specialise: bool | None) -> None:
        self._given = a, b, law, dt, specialise
        self.a, self.b = a, b
        self.law, options = resolved_options(law, dt)
        if isinstance(law, PaperLaw):
            from standoff.kernels.entries import paper_laws

            self.options = with_frames(options, own=address_of(paper_laws.paper))
        else:
            smooth = address_of(smooth_frame_of(a, b, specialise))
            self.options = with_frames(options, smooth, address_of(laws.predicted))
        self.table = table_of(a, b, self.options)
        self.address = self.table.address

    def __reduce__(self) -> Any:
        # in another process the bodies' formulas, and all arrays, have other addresses
        return reach, self._given


def reach(a: Body, b: Body, law: Law, dt: float, specialise: bool | None) -> Reached:
    """A pair with its law for a frame time, s."""
    if law is DEFAULT_LAW:
        return _usual(a, b, dt, specialise)
    return Reached(a, b, law, dt, specialise)


@lru_cache(maxsize=PAIRS)
def _usual(a: Body, b: Body, dt: float, specialise: bool | None) -> Reached:
    return Reached(a, b, DEFAULT_LAW, dt, specialise)


def table_of(a: Body, b: Body, options: Array) -> AddressTable:
    """Where two bodies and options lie."""
    return AddressTable((*packed(a, b), options))


@lru_cache(maxsize=PAIRS)
def cold_table(a: Body, b: Body, within: float | None = None) -> AddressTable:
    """Where two bodies lie, with the default law's options: for starts, which call no frame.

    `within` is the horizon, length.

    Raises TypeError, ValueError: they cannot be a pair.
    """
    check_pair(a, b)
    law = DEFAULT_LAW if within is None else PredictorCorrector(within=within)
    return table_of(a, b, resolved_options(law, ANY_TIME)[1])


def cold_tables(of: RowPairs, within: float | None = None) -> AddressTables:
    """`cold_table` of each pair of some rows, which are checked to be pairs."""
    return AddressTables([cold_table(a, b, within) for a, b in of.pairs], of.which)
