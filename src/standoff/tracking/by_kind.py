"""Which tracker a pair gets: bodies that are no `Body` make their own."""

from __future__ import annotations

from typing import Any, Protocol, runtime_checkable


@runtime_checkable
class Tracked(Protocol):
    """What is no `Body`, and makes a tracker with another by itself: a solid."""

    def tracked(self, a: Any, b: Any, *given: Any, **options: Any) -> Any:
        """A tracker of A and B, one of which is this one, with the options of its kind."""
        ...


class MadeByKind:
    """A base of the tracker of bodies: of solids, which are above this layer, it makes another."""

    __slots__ = ()

    def __new__(cls, a: Any = None, b: Any = None, *given: Any, **options: Any) -> Any:
        makers = [each for each in (a, b) if isinstance(each, Tracked)]
        if makers:
            return makers[0].tracked(a, b, *given, **options)
        return super().__new__(cls)
