"""What `dir` and tab completion show of an object: what its users are meant to find."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

Class = TypeVar("Class", bound=type)


def hides(*names: str) -> Callable[[Class], Class]:
    """A class decorator: `dir` of an object leaves these names out.

    They are there for other modules of the library, so they have no underscore; a user has no use
    for them.
    """
    hidden = frozenset(names)

    def decorate(cls: Class) -> Class:
        def shown(self: object) -> list[str]:
            return [name for name in object.__dir__(self) if name not in hidden]

        cls.__dir__ = shown  # type: ignore[method-assign, assignment]
        return cls

    return decorate
