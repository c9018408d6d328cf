"""Loops that may take long: how far they are is said on stderr, as what the compiler does."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from typing import TypeVar

from standoff.kernels.compiler.notices import say

Item = TypeVar("Item")

FIRST_WORD = 2.0
"""Seconds, a time to wait, without a word: about as long as nobody wonders."""

BETWEEN_WORDS = 10.0
"""Seconds from one word to the next: often enough to see that it goes on, and when it will end."""


def told(items: Sequence[Item], doing: str) -> Iterator[Item]:
    """Yield the items, and say now and then how many are done, once it takes long.

    Parameters
    ----------
    items : sequence
    doing : str
        What is done with them, such as "proving patches".
    """
    due = time.monotonic() + FIRST_WORD
    for done, item in enumerate(items):
        if time.monotonic() >= due:
            say(f"{doing}: {done} of {len(items)}")
            due = time.monotonic() + BETWEEN_WORDS
        yield item
