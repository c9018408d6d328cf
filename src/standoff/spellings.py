"""Names that are not there: the nearest one that is, and what has changed its name since 0.1."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterable, Mapping
from functools import wraps
from typing import ParamSpec, TypeVar

from standoff.errors import StandoffTypeError
from standoff.real_numbers import shown

NEAREST_CUTOFF = 0.5
"""Least likeness (difflib ratio, 0 to 1) at which a known name is suggested for an unknown one.

Half catches swapped, missing and doubled letters in short keys, and stays silent on a word that
has nothing to do with any known key.
"""

LONGEST = 60
"""Longest piece of a misspelt command that is repeated, in characters."""

P = ParamSpec("P")
R = TypeVar("R")


def nearest(name: str, known: Iterable[str], cutoff: float = NEAREST_CUTOFF) -> str | None:
    """Return the known name most like `name`, or None when none is like it."""
    folded = {candidate.casefold(): candidate for candidate in known}
    found = difflib.get_close_matches(name.casefold(), folded, n=1, cutoff=cutoff)
    return folded[found[0]] if found else None


def unknown_command(name: str, known: Iterable[str]) -> str:
    """Return the sentence that refuses a command, with the nearest one that there is."""
    likely = nearest(name, known)
    said = f"did you mean '{likely}'? " if likely is not None else ""
    return f"unknown command {shown(name, LONGEST)}; {said}standoff --help lists the commands"


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
