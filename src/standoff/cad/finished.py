"""A solid of a CAD file as its instances share it, and as the store has it."""

from __future__ import annotations

import io
import pickle
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

from standoff.cad import store

if TYPE_CHECKING:
    from standoff.bodies.body import Body
    from standoff.bodies.boundary import Boundary
    from standoff.solids import Solid


class _Writer(pickle.Pickler):
    """Of a solid, without the shape that it is of."""

    def __init__(self, stream: io.BytesIO, shape: Any) -> None:
        super().__init__(stream)
        self.shape = shape

    def persistent_id(self, part: Any) -> str | None:
        """A name in the shape's place."""
        return "shape" if part is self.shape else None


class _FieldReader(pickle.Unpickler):
    """Of what `_Writer` wrote, for the same shape."""

    def __init__(self, content: bytes, shape: Any) -> None:
        super().__init__(io.BytesIO(content))
        self.shape = shape

    def persistent_load(self, name: str) -> Any:
        """The shape."""
        return self.shape


def _solid_written(solid: Solid) -> bytes:
    stream = io.BytesIO()
    _Writer(stream, solid.given).dump(solid)
    return stream.getvalue()


class FinishedArrays(NamedTuple):
    """What was made, as it goes to the store, and from one process to another: the report, whether
    there is no shape, the shape, and the solid of one that is not convex."""

    report: Any
    refused: bool
    shape: bytes
    solid: bytes | None


def packed(report: Any, shape: Boundary | Body | None, solid: Solid | None) -> FinishedArrays:
    """The shape is None where the part was refused."""
    written = None if solid is None else _solid_written(solid)
    return FinishedArrays(report, shape is None, pickle.dumps(shape), written)


class Finished:
    """A solid of a file, as its instances share it; shape and solid are unpickled when they are
    first asked for.

    Attributes
    ----------
    report : PartReport
    refused : bool
        Is there no shape?
    """

    def __init__(
        self, packed: FinishedArrays, key: str, made: tuple[Any, Any] | None = None
    ) -> None:
        self.report, self.refused, self._shape, self._solid = packed
        self._key = f"{key}-solid"
        if made is not None:  # by this process
            self.__dict__["_both"], self._shape, self._solid = made, b"", None

    @property
    def shape(self) -> Boundary | Body:
        """Of one that is not refused."""
        return self._both[0]

    @cached_property
    def solid(self) -> Solid:
        """The shape as a `Solid`; the store has that of a convex one once it was asked for."""
        return self._both[1] or self._solid_of(self.shape)

    @cached_property
    def _both(self) -> tuple[Boundary | Body, Solid | None]:
        """The shape, and the solid where it is not convex."""
        shape: Boundary | Body = pickle.loads(self._shape)
        return shape, None if self.report.convex else self._solid_of(shape)

    def _solid_of(self, shape: Boundary | Body) -> Solid:
        from standoff.solids.spatial.solid import solid_of

        content = self._solid or store.taken(self._key)
        if content is not None:
            found: Solid = _FieldReader(content, shape).load()
            return found
        made = solid_of(shape)
        store.put(self._key, _solid_written(made))
        store.trim()
        return made


def stored(key: str) -> Finished | None:
    """What the store has of a solid."""
    content = store.taken(key)
    if content is None:
        return None
    report, refused, shape = pickle.loads(content)
    return Finished(FinishedArrays(report, refused, shape, None), key)


def keep(packed: FinishedArrays, key: str) -> None:
    """Put a solid into the store."""
    store.put(key, pickle.dumps(packed[:3]))
    if packed.solid is not None:
        store.put(f"{key}-solid", packed.solid)
