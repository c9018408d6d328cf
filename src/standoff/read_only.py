"""Arrays that cannot be written, and stay so when they are stored and copied."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np


class KeepsReadOnly:
    """A base of objects whose read-only arrays stay so in their pickles and deep copies.

    NumPy forgets it when an array is stored; and to Numba a writable array has another type, for
    which it would compile the kernels once more. Arrays are found in the object's attributes, also
    within lists, tuples and dictionaries; objects within it take care of their own.
    """

    __slots__ = ()

    def __getstate__(self) -> Any:
        # With the same arrays named once more: pickles and copies keep what is one object one.
        state = object.__getstate__(self)
        return state, list(locked(state))

    def __setstate__(self, stored: Any) -> None:
        state, locked = stored
        # Of an object with slots, the state is a pair: its dictionary and its slots.
        for part in state if isinstance(state, tuple) else (state,):
            for name, value in (part or {}).items():
                object.__setattr__(self, name, value)
        for array in locked:
            array.flags.writeable = False


def locked(value: Any) -> Iterator[np.ndarray[Any, Any]]:
    """The read-only arrays in a value."""
    if isinstance(value, np.ndarray):
        if not value.flags.writeable:
            yield value
    elif isinstance(value, dict):
        yield from locked(tuple(value.values()))
    elif isinstance(value, list | tuple):
        for item in value:
            yield from locked(item)
