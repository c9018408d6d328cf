"""Typesetting of captions and statements: the index of f_u is lowered, 3e-14 becomes a power."""

from __future__ import annotations

import re
from collections.abc import Iterator

# One letter with a short index; words joined by underscores, such as max_gain, are names in code.
INDEXED = r"(?<![\w.])(?P<letter>[A-Za-zΑ-Ωα-ω])_(?P<index>[A-Za-z]{1,3}|\d{1,2})(?![\w(])"
POWER = r"(?<![\w.])(?:(?P<factor>\d+(?:\.\d+)?))e(?P<exponent>[+-]?\d{1,3})(?![\w.]*\w)"
MARKED = re.compile(f"{INDEXED}|{POWER}")


def pieces(text: str) -> Iterator[tuple[str, str]]:
    """Return a text in pieces, each with its typesetting: "sub", "sup", or "" for normal."""
    end = 0
    for found in MARKED.finditer(text):
        yield text[end : found.start()], ""
        if found["letter"]:
            yield found["letter"], ""
            yield found["index"], "sub"
        else:
            yield from _power(found["factor"], int(found["exponent"]))
        end = found.end()
    yield text[end:], ""


def stop(why: str) -> str:
    """Return what separates a measurement from its reason, which may begin in lower case."""
    return ";" if why[:1].islower() else "."


def _power(factor: str, exponent: int) -> Iterator[tuple[str, str]]:
    """A number with a power of ten: 3·10⁻⁹, 10⁻⁹, or 0 or 3 if no power is needed."""
    if float(factor) == 0.0 or exponent == 0:
        yield factor if float(factor) else "0", ""
        return
    yield "10" if factor == "1" else f"{factor}·10", ""
    yield str(exponent).replace("-", "\N{MINUS SIGN}"), "sup"
