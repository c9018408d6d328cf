"""Intervals of time of single pairs, and what is proven of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from standoff.robots.proof import How, Names, Span, Steps
from standoff.typing import Array, Ints


class Intervals(NamedTuple):
    """Intervals of time of single pairs that are not proven yet: n rows.

    Attributes
    ----------
    pairs : (n,) array of int
    first, last : (n,) arrays
        Its ends [s].
    pieces : (n, 2) array of int
        The first of the path's pieces that it has a part in, and the one behind the last.
    before, after : (n, 5) arrays
        At its ends the certified distance's lower bound, upper bound, and normal; nan where it has
        not been asked.
    near : (n,) array
        The pair is no farther apart anywhere in it, as far as is known [length].
    """

    pairs: Ints
    first: Array
    last: Array
    pieces: Ints
    before: Array
    after: Array
    near: Array

    def some(self, which: Any) -> Intervals:
        """Some of the rows."""
        return Intervals(*(each[which] for each in self))


def lowest(before: Array, after: Array, sag: Array) -> Array:
    """(n,): the least of (1-λ) L0 + λ L1 - λ(1-λ) S for λ in [0, 1]; -inf where an end is not
    positive, as beside it nothing is proven."""
    least = np.minimum(before, after)
    with np.errstate(invalid="ignore", divide="ignore"):
        dip = before - (sag + before - after) ** 2 / (4.0 * sag)
        found = np.where(sag > np.abs(before - after), dip, least)
    return np.where((least > 0.0) & np.isfinite(sag), found, -np.inf)


def joined(parts: Sequence[Intervals]) -> Intervals:
    """All rows."""
    return Intervals(*(np.concatenate(each) for each in zip(*parts, strict=True)))


def spans_of(some: Intervals, names: Sequence[Names], end: float) -> tuple[Span, ...]:
    """Intervals up to an end; those of two bodies that follow each other are one."""
    found: list[Span] = []
    owners = [names[pair] for pair in some.pairs.tolist()]
    for own, first, last in sorted(
        zip(owners, some.first.tolist(), some.last.tolist(), strict=True)
    ):
        if found and found[-1].names == own and first <= found[-1].end:
            found[-1] = found[-1]._replace(end=max(min(last, end), found[-1].end))
        else:
            found.append(Span(first, min(last, end), own))
    return tuple(sorted(found))


def steps_of(proven: Sequence[tuple[Intervals, Array, How]], names: Sequence[Names]) -> Steps:
    """The steps of a proof: intervals, their bounds, and what proved them."""
    rows = [(some, bound, how) for some, bound, how in proven if len(bound)]
    if not rows:
        none = np.zeros(0)
        return Steps(none, none, none.astype(int), none, none.astype(int), tuple(names))
    some, bounds, hows = zip(*rows, strict=True)
    every = joined(some)
    how = np.repeat([each.value for each in hows], [len(each.pairs) for each in some])
    order = np.argsort(every.first, kind="stable")
    found = Steps(
        start=every.first[order],
        end=every.last[order],
        pair=every.pairs[order],
        bound=np.concatenate(bounds)[order],
        how=how[order],
        names=tuple(names),
    )
    for array in found[:5]:
        array.flags.writeable = False
    return found
