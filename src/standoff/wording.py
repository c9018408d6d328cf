"""Words in lines of results: numbers with their nouns, bounds rounded to their safe side, names cut
to fit, and others' text that a terminal would obey."""

from __future__ import annotations

import json
import math
import re
import unicodedata
from collections.abc import Callable
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal

NAME_SHOWN = 20
"""Longest name of a body that the line of an answer or a recording repeats, in characters."""

_PERHAPS_HIDDEN = re.compile(r"[^\x20-\x7e]")


def printable(text: str, keep: str = "") -> str:
    """Return text with only visible characters that no terminal obeys; the others become escapes.

    A terminal obeys control characters, C0, DEL and C1 alike: they move the cursor, set the
    window's title and clear the screen. Format characters turn what is read around them, and lone
    surrogates, of file names, cannot be written at all.

    Parameters
    ----------
    text : str
        From a scene, a file or a device, or with a piece of it.
    keep : str
        Control characters of our own, such as the ends of lines.
    """
    if text.isprintable():
        return text
    return _PERHAPS_HIDDEN.sub(lambda found: _seen(found[0], keep), text)


def printable_json(text: str) -> str:
    """Return JSON that says the same, with only visible characters."""

    def seen(found: re.Match[str]) -> str:
        letter = found[0]
        return json.dumps(letter)[1:-1] if _hidden(letter) and letter != "\n" else letter

    return _PERHAPS_HIDDEN.sub(seen, text)


def _seen(letter: str, keep: str) -> str:
    if letter in keep or not _hidden(letter):
        return letter
    return letter.encode("unicode_escape").decode()


def _hidden(letter: str) -> bool:
    # Spaces of other widths are no more than spaces, though Python escapes them too.
    return not letter.isprintable() and unicodedata.category(letter) != "Zs"


def short_name(name: str) -> str:
    """Return a body's name as it stands in a line with others."""
    name = printable(name)
    return name if len(name) <= NAME_SHOWN else name[: NAME_SHOWN - 1] + "…"


def counted(
    number: int, one: str, many: str = "", write: Callable[[int], str] = "{}".format
) -> str:
    """Return a number, as `write` writes it, with its noun: "1 frame" and "2 frames"."""
    return f"{write(number)} {one if number == 1 else many or one + 's'}"


MOST_DIGITS = 15
"""Digits that a double returns as they were read."""

HAIR_DIGITS = 3
"""A number is less than a rounder one by a hair if so many more digits do not tell them apart."""


def at_least(bound: float, digits: int = 6) -> str:
    """Return a lower bound, or a gap, as a text that is never more than it.

    Parameters
    ----------
    bound : float
    digits : int
        Significant ones. A number that is less than a rounder one by a hair has twice as many:
        0.299999999997, where six digits would be 0.299999.
    """
    return _rounded(bound, digits, ROUND_FLOOR)


def at_most(bound: float, digits: int = 6) -> str:
    """Return an upper bound as a text that is never less than it; `digits` as of `at_least`."""
    return _rounded(bound, digits, ROUND_CEILING)


def _rounded(bound: float, digits: int, way: str) -> str:
    nearest = f"{bound + 0.0:.{digits}g}"  # a zero without a sign
    if not math.isfinite(bound):
        return nearest
    exact = Decimal(repr(float(bound)))  # as JSON writes it
    if Context(prec=digits, rounding=way).plus(exact) == Decimal(nearest):
        return nearest
    hair = float(nearest) == float(f"{bound:.{digits + HAIR_DIGITS}g}")
    places = min(2 * digits, MOST_DIGITS) if hair else digits
    return f"{float(Context(prec=places, rounding=way).plus(exact)):.{places}g}"
