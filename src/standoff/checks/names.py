"""Words that a user gives: one of those known, or the one that was most likely meant."""

from __future__ import annotations

import difflib
from collections.abc import Collection, Iterable
from typing import Any

from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError
from standoff.wording import printable

NEAREST_CUTOFF = 0.5
"""Least likeness (difflib ratio, 0 to 1) at which a known name is suggested for an unknown one.

Half catches swapped, missing and doubled letters in short keys, and stays silent on a word that
has nothing to do with any known key.
"""


def choice(value: Any, name: str, known: Collection[str]) -> str:
    """Read one of some words; the error lists them and says the nearest one."""
    # an array would be compared element by element
    if isinstance(value, str) and value in known:
        return value
    hint = did_you_mean(value, known) if isinstance(value, str) else ""
    raise StandoffError(f"{name} = {shown(value)}: give {one_of(known)}.{hint}", name, value)


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return the sentence that suggests a known name, with a space before it, or nothing."""
    likely = nearest(name, known)
    return f" Did you mean '{likely}'?" if likely is not None else ""


def nearest(name: str, known: Iterable[str], cutoff: float = NEAREST_CUTOFF) -> str | None:
    """Return the known name most like `name`, or None if none is like it."""
    folded = {candidate.casefold(): candidate for candidate in known}
    found = difflib.get_close_matches(name.casefold(), folded, n=1, cutoff=cutoff)
    return folded[found[0]] if found else None


def one_of(names: Iterable[str]) -> str:
    """Return names as a sentence lists them: ``'a', 'b' or 'c'``."""
    quoted = [f"'{printable(name)}'" for name in names]
    return " or ".join(filter(None, [", ".join(quoted[:-1]), *quoted[-1:]]))
