"""What changes between two times, found by halving the time between them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol, TypeVar


class AnswerAtTime(Protocol):
    """An answer at a time."""

    @property
    def time(self) -> float: ...


K = TypeVar("K", bound=AnswerAtTime)
S = TypeVar("S")

Found = tuple[S | None, bool]
"""A change that was found otherwise, or None; and whether one was found that is not proven."""


def of_mode(low: Any, high: Any) -> bool:
    """Have two answers different modes?"""
    return bool(low.mode != high.mode)


def changes(
    low: K,
    high: K,
    look: Callable[[float, K, K], K],
    resolution: float,
    change: Callable[[K, K], S],
    otherwise: Callable[[K, K], Found[S]] | None = None,
    tries: int = 0,
    changed: Callable[[K, K], bool] = of_mode,
) -> list[S]:
    """Return the changes between two answers, in order of time.

    What comes and goes between two answers that are alike is not seen.

    Parameters
    ----------
    low, high : AnswerAtTime
        The answers at the earlier and the later time.
    look : callable
        The answer at a time between, given that time and the two around it.
    resolution : float
        Time [s] to which a change is located: two answers as near are one change.
    change : callable
        What is told of a change, of the last answer before it and the first one after it.
    otherwise : callable, optional
        Finds the one change between two answers faster than by halving, where it can.
    tries : int
        How often in a row `otherwise` may find what is not proven; then halving goes on alone.
    changed : callable
        Is there a change between an earlier and a later answer? By default one of their mode.
    """
    if not changed(low, high):
        return []
    middle = 0.5 * (low.time + high.time)
    if high.time - low.time <= resolution or not low.time < middle < high.time:
        return [change(low, high)]
    if otherwise is not None and tries:
        found, failed = otherwise(low, high)
        if found is not None:
            return [found]
        tries -= failed
    between = look(middle, low, high)
    more = look, resolution, change, otherwise, tries, changed
    return [*changes(low, between, *more), *changes(between, high, *more)]
