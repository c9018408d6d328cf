"""Plain data of the soak's files: written, and checked before use."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

from standoff.checks.real_numbers import shown
from standoff.nesting import JSON, text_problem
from standoff.whole_files import Writer

Facts = dict[str, Any]


def read_facts(file: Path) -> Facts:
    """Return the object in a JSON file.

    Raises
    ------
    OSError
        It cannot be read.
    ValueError
        It is not JSON, not an object, nested too deeply, or has numbers that are not finite.
    """
    content = file.read_text(encoding="utf-8")
    problem = text_problem(content, JSON)
    if problem:
        raise ValueError(f"it {problem}")
    return mapping(json.loads(content, parse_constant=_refused, parse_float=_finite), "it")


def written(facts: Facts) -> Writer:
    """Return a function that writes such an object to a file."""
    content = json.dumps(facts, indent=1, allow_nan=False).encode()
    return lambda file: file.write(content)


def _refused(text: str) -> float:
    raise ValueError(f"{text} is not a number that these files hold")


def _finite(text: str) -> float:
    value = float(text)
    return value if math.isfinite(value) else _refused(text)


def entry(facts: Facts, name: str) -> Any:
    """Return an entry; raise ValueError if there is none."""
    if name not in facts:
        raise ValueError(f"'{name}' is missing")
    return facts[name]


def number(value: Any, what: str) -> float:
    """Return a number, also "inf" or "nan" by name; raise ValueError if it is not one."""
    known = isinstance(value, int | float) and not isinstance(value, bool)
    if not known and value not in ("inf", "-inf", "nan"):
        raise ValueError(f"{what} is {shown(value)}, not a number")
    return float(value)


def numbers(values: Any, what: str, count: int | None = None) -> list[float]:
    """Return a given count of numbers; raise ValueError if they are not numbers."""
    if not isinstance(values, list) or (count is not None and len(values) != count):
        raise ValueError(f"{what} is not a list of {'' if count is None else f'{count} '}numbers")
    return [number(value, what) for value in values]


def text(value: Any, what: str) -> str:
    """Return a string that is not empty; raise ValueError if it is not one."""
    if not isinstance(value, str) or not value.strip():
        raise ValueError(f"{what} is {shown(value)}, not a text")
    return value


def mapping(value: Any, what: str) -> Facts:
    """Return an object; raise ValueError if it is not one."""
    if not isinstance(value, dict):
        raise ValueError(f"{what} is {shown(value)}, not an object")
    return value


def rows(value: Any, what: str, length: int) -> list[list[Any]]:
    """Return a list of lists of equal length; raise ValueError if it is not one."""
    if not isinstance(value, list):
        raise ValueError(f"{what} is {shown(value)}, not a list")
    for row in value:
        if not isinstance(row, list) or len(row) != length:
            raise ValueError(f"{what} holds {shown(row)}, not a list of {length}")
    return value
