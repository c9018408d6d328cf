"""Every array in an object, however deep, and whether it may be written."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

PLAIN = (str, bytes, int, float, complex, bool, type(None), type, np.generic)


def writable(value: object) -> dict[str, bool]:
    """Return, by its place, whether each array in a value may be written."""
    return dict(_walk(value, "", set()))


def _walk(value: Any, place: str, seen: set[int]) -> Iterator[tuple[str, bool]]:
    if isinstance(value, PLAIN) or id(value) in seen:
        return
    if isinstance(value, np.ndarray):
        yield place, bool(value.flags.writeable)
        return
    seen.add(id(value))
    for name, part in _parts(value):
        yield from _walk(part, f"{place}{name}", seen)


def _parts(value: Any) -> Iterator[tuple[str, Any]]:
    if isinstance(value, dict):
        yield from ((f"[{key!r}]", part) for key, part in value.items())
    elif isinstance(value, list | tuple | frozenset | set):
        yield from ((f"[{k}]", part) for k, part in enumerate(value))
    elif type(value).__module__.startswith("standoff"):
        slots = [n for c in type(value).__mro__ for n in getattr(c, "__slots__", ())]
        names = [*getattr(value, "__dict__", ()), *slots]
        yield from ((f".{n}", getattr(value, n)) for n in names if hasattr(value, n))
