"""Objects that belong to one run of one process: a loop's thread, a device's connection."""

from __future__ import annotations

from typing import NoReturn, SupportsIndex

from standoff.errors import StandoffTypeError


class BoundToRun:
    """A base of objects that hold a thread, a lock or a connection: they are not copied or stored.

    Raises StandoffTypeError: by ``copy.copy``, ``copy.deepcopy`` and ``pickle``.
    """

    def __reduce_ex__(self, protocol: SupportsIndex) -> NoReturn:
        name = type(self).__name__
        raise StandoffTypeError(
            f"A {name} belongs to one run in one process and cannot be copied or pickled: keep "
            f"what it was made from, and make another {name} where it is needed."
        )
