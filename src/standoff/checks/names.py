"""The known name that a misspelt one was most likely meant to be."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

NEAREST_CUTOFF = 0.5
"""Least likeness (difflib ratio, 0 to 1) at which a known name is suggested for an unknown one.

Half catches swapped, missing and doubled letters in short keys, and stays silent on a word that
has nothing to do with any known key.
"""


def nearest(name: str, known: Iterable[str], cutoff: float = NEAREST_CUTOFF) -> str | None:
    """Return the known name most like `name`, or None when none is like it."""
    folded = {candidate.casefold(): candidate for candidate in known}
    found = difflib.get_close_matches(name.casefold(), folded, n=1, cutoff=cutoff)
    return folded[found[0]] if found else None
