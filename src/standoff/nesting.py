"""How deep lists and tables may lie in one another in the files that are read.

Parsers and what walks their results call themselves once a level, and where that ends depends on
the interpreter: at its recursion limit, at one of its C stack, or in a crash. A limit of our own
ends it sooner, with the same message everywhere.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from standoff.checks.real_numbers import shown

DEEPEST_NESTING = 50
"""Most lists and tables in one another. A scene needs seven: bodies, one body, its patches, one
patch, and a net's list of rows of points; twenty of a parser's frames for each stay far below any
interpreter's limit."""

ESCAPE = r"\\(?:.|\Z)"
TOML = re.compile(
    rf'"""(?:{ESCAPE}|[^\\])*?(?:"{{3,5}}|\Z)'
    r"|'''.*?(?:'{3,5}|\Z)"
    rf'|"(?:{ESCAPE}|[^"\\\n])*"?'
    r"|'[^'\n]*'?"
    r"|#[^\n]*"
    r"|(?P<open>[\[{])|(?P<close>[\]}])",
    re.DOTALL,
)
JSON = re.compile(rf'"(?:{ESCAPE}|[^"\\])*"?|(?P<open>[\[{{])|(?P<close>[\]}}])', re.DOTALL)
"""Strings and comments of the format, in which brackets do not count, and the brackets that do.
An unterminated string extends to the end, so that the time depends only on the length."""

SHOWN = 20
"""Characters that a message repeats of the place."""


def text_problem(text: str, form: re.Pattern[str]) -> str:
    """Return what is wrong where brackets are nested beyond `DEEPEST_NESTING`; else "".

    Parameters
    ----------
    text : str
        What is to be parsed; it need not be valid.
    form : pattern
        `TOML` or `JSON`.
    """
    opened: list[int] = []
    for token in form.finditer(text):
        if token["open"]:
            opened.append(token.start())
            if len(opened) > DEEPEST_NESTING:
                line = text.count("\n", 0, token.start()) + 1
                place = text[max(0, token.end() - SHOWN) : token.end()]
                return _problem(f", {shown(place + '…')} on line {line}")
        elif token["close"] and opened:
            opened.pop()
    return ""


def value_problem(value: Any) -> tuple[str, list[str]]:
    """Return what is wrong with a value nested beyond `DEEPEST_NESTING`, and the keys on the way
    there; else "" and none."""
    below: list[Iterator[tuple[str, Any]]] = [iter([("", value)])]
    keys: list[str] = []
    while below:
        found = next(below[-1], None)
        if found is None:
            below.pop()
            del keys[-1:]
            continue
        key, part = found
        if isinstance(part, dict | list | tuple):
            if len(below) > DEEPEST_NESTING:
                return _problem(""), [k for k in (*keys[1:], key) if k]
            keys.append(key)
            below.append(_parts(part))
    return "", []


def _parts(value: Any) -> Iterator[tuple[str, Any]]:
    if isinstance(value, dict):
        return ((str(key), part) for key, part in value.items())
    return (("", part) for part in value)


def _problem(place: str) -> str:
    return (
        f"holds lists or tables nested too deeply, more than {DEEPEST_NESTING} in one another"
        f"{place}; take them apart"
    )
