"""The one place from which a command's text goes to the terminal."""

from __future__ import annotations

import sys

from standoff.wording import printable


def tell(text: str, *, error: bool = False) -> None:
    """Write lines on stdout, or on stderr, at once.

    Titles, names and file names come from others: their control characters are shown as escapes.
    """
    print(printable(text, keep="\n"), file=sys.stderr if error else sys.stdout, flush=True)
