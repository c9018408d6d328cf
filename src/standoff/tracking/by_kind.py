"""Which tracker a pair gets: bodies that are no `Body` make their own."""

from __future__ import annotations

from typing import Any


class MadeByKind:
    """A base of the tracker of bodies: of what makes a tracker by itself, as solids do, which are
    above this layer, it makes that one (`Solid.tracked`)."""

    __slots__ = ()

    def __new__(cls, a: Any = None, b: Any = None, *given: Any, **options: Any) -> Any:
        for each in (a, b):
            if hasattr(each, "tracked"):
                return each.tracked(a, b, *given, **options)
        return super().__new__(cls)
