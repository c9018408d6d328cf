"""Keywords and attributes that have changed their names: the old one raises an error that says the
new one."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import wraps
from typing import ParamSpec, TypeVar

from standoff.errors import StandoffTypeError

P = ParamSpec("P")
R = TypeVar("R")


def renamed(**new: str) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Refuse keywords of version 0.1 with what to write now.

    Parameters
    ----------
    new : str
        By old keyword, what stands for it now, as a user writes it: ``length="height=..."``.
        Several may be one keyword now.

    Returns
    -------
    callable
        A decorator; what it returns raises StandoffTypeError at an old keyword.
    """

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        @wraps(function)
        def checked(*args: P.args, **kwargs: P.kwargs) -> R:
            old = [name for name in new if name in kwargs]
            if old:
                name, now = function.__name__, dict.fromkeys(new[each] for each in old)
                said = old_spelling(
                    f"{name}({', '.join(f'{each}=...' for each in old)})",
                    f"{name}({', '.join(now)})",
                )
                raise StandoffTypeError(said, old[0], kwargs[old[0]])
            return function(*args, **kwargs)

        return checked

    return decorate


def no_attribute(owner: object, name: str, new: Mapping[str, str]) -> AttributeError:
    """The error for an attribute that an object has not; `new` has those of 0.1, by old name."""
    kind = type(owner).__name__
    if name in new:
        return AttributeError(old_spelling(f"{kind}.{name}", f"{kind}.{new[name]}"))
    return AttributeError(f"{kind!r} object has no attribute {name!r}")


def old_spelling(old: str, new: str) -> str:
    """The sentence that refuses a spelling of version 0.1."""
    return f"{old} is the spelling of version 0.1: write {new}."
