"""Search for a least value, best first: the part that may hold the least is split first.

Each part of what is searched has a bound: nothing in it is less. Splitting sharpens the bounds,
until none is below a goal, or the budget is spent.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from enum import Enum
from heapq import heappop, heappush
from typing import Generic, NamedTuple, TypeVar

T = TypeVar("T")


class Ending(Enum):
    """Why a search ended."""

    GOAL = "No part's bound is below the goal."
    CLOSED = "What is below the goal is in parts that can no longer be split."
    SPENT = "As many parts were split as allowed."

    @property
    def sentence(self) -> str:
        """The reason in words."""
        return self.value


class SearchPart(NamedTuple, Generic[T]):
    """A part of what is searched.

    Attributes
    ----------
    bound : float
        Nothing in the part is less.
    body : object
        The part itself.
    seen : float
        A value that was met in it; inf or nan where none was.
    closed : bool
        May it no longer be split?
    """

    bound: float
    body: T
    seen: float = math.inf
    closed: bool = False


class SearchOutcome(NamedTuple, Generic[T]):
    """What a search has come to.

    Attributes
    ----------
    ending : Ending
    least : float
        The least bound of all parts: nothing searched is less. inf where there are no parts.
    found : float
        The least value that was met; inf where none was.
    place : object or None
        The part in which it was met first.
    open, closed : list of SearchPart
        What is left, and what could no longer be split.
    splits : int
        How many parts were split.
    """

    ending: Ending
    least: float
    found: float
    place: T | None
    open: list[SearchPart[T]]
    closed: list[SearchPart[T]]
    splits: int


def best_first(
    parts: Iterable[SearchPart[T]],
    split: Callable[[list[SearchPart[T]]], Iterable[SearchPart[T]]],
    goal: Callable[[float], float],
    most: Callable[[float], float],
    batch: int = 1,
) -> SearchOutcome[T]:
    """Split the parts with the least bounds until none is below a goal.

    Parameters
    ----------
    parts : iterable of SearchPart
        What is searched; of equal bounds the one that came first is split first.
    split : function
        From the parts that are to be split, the least first, to the parts that they are made of.
    goal : function
        From the least value met so far to the bound that is enough. A search that has met what it
        was looking for is ended by -inf.
    most : function
        From the least value met so far to the most parts that may be split.
    batch : int
        Parts that are split at once.
    """
    queue: list[tuple[float, int, SearchPart[T]]] = []
    closed: list[SearchPart[T]] = []
    found, place, number, splits = math.inf, None, 0, 0

    def look(new: Iterable[SearchPart[T]]) -> None:
        nonlocal found, place, number
        for part in new:
            if part.seen < found:
                found, place = part.seen, part.body
            if part.closed:
                closed.append(part)
            else:
                heappush(queue, (part.bound, number, part))
            number += 1

    look(parts)
    while queue and queue[0][0] < goal(found) and splits < most(found):
        chosen = [heappop(queue)[2] for _ in range(min(batch, len(queue)))]
        splits += len(chosen)
        look(split(chosen))
    left = [part for _, _, part in queue]
    least = min((part.bound for part in left + closed), default=math.inf)
    if least >= goal(found):
        ending = Ending.GOAL
    else:
        ending = Ending.SPENT if queue and queue[0][0] < goal(found) else Ending.CLOSED
    return SearchOutcome(ending, least, found, place, left, closed, splits)
