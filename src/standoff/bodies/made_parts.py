"""Parts of a boundary that are made when somebody asks for one, and kept."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Sequence
from typing import Any, TypeVar, overload

from standoff.read_only import KeepsReadOnly

Part = TypeVar("Part")


class MadeParts(KeepsReadOnly, Sequence[Part]):
    """A sequence whose items are made from arrays at their first use; each is one object.

    They are planes and lines: none is a compiled formula. What has been made is stored with them,
    so that what was one object stays one.
    """

    def __init__(self, source: Any) -> None:
        self.source = source
        self._made: dict[int, Part] = {}

    @abstractmethod
    def make(self, number: int) -> Part:
        """Make the part of a number."""

    @overload
    def __getitem__(self, index: int) -> Part: ...

    @overload
    def __getitem__(self, index: slice) -> tuple[Part, ...]: ...

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return tuple(self[k] for k in range(*index.indices(len(self))))
        number = range(len(self))[index]
        part = self._made.get(number)
        if part is None:
            # of two threads that make one at the same time, both get the first
            part = self._made.setdefault(number, self.make(number))
        return part

    def __iter__(self) -> Iterator[Part]:
        return (self[k] for k in range(len(self)))
