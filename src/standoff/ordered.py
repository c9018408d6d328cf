"""Choices that can be counted in arrays."""

from __future__ import annotations

from enum import Enum
from typing import Any


class Ordered(Enum):
    """An enumeration in the order of its values.

    For ``numpy.unique``, which sorts: the order itself means nothing.
    """

    def __lt__(self, other: Any) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        less: bool = self._value_ < other._value_
        return less
