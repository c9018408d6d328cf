"""Which two bodies each row of a batch is of: the same two in all, or a list of bodies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from standoff.bodies.body import Body
from standoff.errors import StandoffError
from standoff.tracking.inputs import check_body, check_pair
from standoff.typing import Ints
from standoff.wording import counted, short_name


class RowPairs(NamedTuple):
    """The pairs of bodies of some rows.

    Attributes
    ----------
    pairs : tuple of (Body, Body)
        Each once, in the order of their first rows.
    which : (n,) array of int, or (1,) for all rows
        The number of each row's.
    """

    pairs: tuple[tuple[Body, Body], ...]
    which: Ints

    @property
    def several(self) -> bool:
        """Are rows of different pairs?"""
        return len(self.pairs) > 1

    @property
    def planar(self) -> bool:
        """Do all stay in z = 0?"""
        return is_planar(self.pairs[0])

    @property
    def shown(self) -> str:
        """The bodies, as a repr names them."""
        if self.several:
            return counted(len(self.pairs), "pair") + " of bodies"
        return " and ".join(short_name(body.name) for body in self.pairs[0])

    def groups(self) -> list[tuple[int, Ints]]:
        """The number of each pair and its rows, increasing; of lists of bodies."""
        order = np.argsort(self.which, kind="stable")
        ends = np.searchsorted(self.which[order], np.arange(1, len(self.pairs)))
        return list(enumerate(np.split(order, ends)))

    def of(self, row: int) -> tuple[Body, Body]:
        """The bodies of a row."""
        return self.pairs[int(self.which[0 if len(self.which) == 1 else row])]


def is_planar(pair: tuple[Body, Body]) -> bool:
    """Is one of two bodies planar?"""
    return pair[0].dimension == 2 or pair[1].dimension == 2


def row_pairs(a: Any, b: Any) -> RowPairs:
    """The pairs of two bodies, or of lists of n bodies, one for each row.

    Raises TypeError: something that is no body. Raises ValueError: lists of different lengths, or
    empty ones; bodies that cannot be a pair; some pairs planar and some spatial.
    """
    lists = [list(given) if is_list(given) else None for given in (a, b)]
    if lists[0] is None and lists[1] is None:
        check_pair(a, b)
        return RowPairs(((a, b),), np.zeros(1, dtype=np.int64))
    n = max(len(each) for each in lists if each is not None)
    for name, each in zip("ab", lists, strict=True):
        if (each is not None and len(each) != n) or not n:
            raise StandoffError(
                f"{name} has {counted(len(each or ()), 'body', 'bodies')}: give one for each row, "
                f"{n or 'at least one'}, or one body for all.",
                name,
            )
    given = [[each] * n if own is None else own for each, own in zip((a, b), lists, strict=True)]
    return _grouped(given)


def is_list(given: Any) -> bool:
    """Is it a sequence of bodies, and not one?"""
    return isinstance(given, Sequence) and not isinstance(given, (str, bytes))


def _grouped(given: Sequence[Sequence[Any]]) -> RowPairs:
    numbers: dict[tuple[int, int], int] = {}
    which = np.empty(len(given[0]), dtype=np.int64)
    pairs: list[tuple[Body, Body]] = []
    for k, pair in enumerate(zip(*given, strict=True)):
        key = id(pair[0]), id(pair[1])
        if key not in numbers:
            _check(pair, k)
            numbers[key] = len(pairs)
            pairs.append(pair)
        which[k] = numbers[key]
    for j, each in enumerate(pairs):
        if is_planar(each) != is_planar(pairs[0]):
            k = int(np.flatnonzero(which == j)[0])
            kind = "planar" if is_planar(each) else "spatial"
            raise StandoffError(
                f"The bodies of row {k} are {kind}, those of row 0 are not: ask for them in two "
                "calls.",
                "a",
            )
    return RowPairs(tuple(pairs), which)


def _check(pair: tuple[Any, Any], row: int) -> None:
    """Check the bodies of a row; an error names it."""
    try:
        for body in pair:
            check_body(body)
        check_pair(*pair)
    except StandoffError as error:
        told = f"The bodies of row {row}: {error}"
        raise type(error)(told, error.argument, error.value) from error
