"""Search for a least value, best first: the part that may hold the least is split first.

Each part of what is searched has a bound: nothing in it is less. Splitting sharpens the bounds,
until none is below a goal, or what may be spent is spent.
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
    CLOSED = "What is below the goal is in parts that cannot be split any more."
    SPENT = "As many parts were split as may be."

    @property
    def sentence(self) -> str:
        """The reason in words."""
        return self.value


class Part(NamedTuple, Generic[T]):
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
        Is it not to be split any more?
    """

    bound: float
    body: T
    seen: float = math.inf
    closed: bool = False


class Searched(NamedTuple, Generic[T]):
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
    open, closed : list of Part
        What is left, and what was not to be split any more.
    splits : int
        How many parts were split.
    """

    ending: Ending
    least: float
    found: float
    place: T | None
    open: list[Part[T]]
    closed: list[Part[T]]
    splits: int


def best_first(
    parts: Iterable[Part[T]],
    split: Callable[[list[Part[T]]], Iterable[Part[T]]],
    goal: Callable[[float], float],
    most: Callable[[float], float],
    batch: int = 1,
) -> Searched[T]:
    """Split the parts with the least bounds until none is below a goal.

    Parameters
    ----------
    parts : iterable of Part
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
    queue: list[tuple[float, int, Part[T]]] = []
    closed: list[Part[T]] = []
    found, place, number, splits = math.inf, None, 0, 0

    def look(new: Iterable[Part[T]]) -> None:
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
    return Searched(ending, least, found, place, left, closed, splits)
