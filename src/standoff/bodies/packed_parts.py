"""Vertices, edges and faces, packed: what boundaries and bodies are made of.

The kernels call a formula by its address, which is stored in the packed body and is valid in this
process only. Sending a body to another process, or computing a digest that is the same in every
process, needs to find these numbers among the others. Addresses are integers above 2^32, so in
practice no length is mistaken for one.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING, Any

import numpy as np

from standoff.bodies.made_parts import MadeParts
from standoff.bodies.packing import Assembled, pack
from standoff.bodies.topology import Edge, Face
from standoff.read_only import KeepsReadOnly
from standoff.typing import Array, Ints
from standoff.wording import counted, printable

if TYPE_CHECKING:
    from standoff.geometry.formulas.compiled import Formula


@dataclass(frozen=True, eq=False, repr=False)
class PackedParts(KeepsReadOnly):
    """Packed parts; the attributes are those of `Boundary`."""

    name: str
    vertex_points: Array
    edge_parts: Sequence[Edge]
    face_parts: Sequence[Face]
    radius: float
    dimension: int
    ints: Ints
    reals: Array
    size: float

    @property
    def digest(self) -> str:
        """SHA-256 of the packed body, hexadecimal: the same on every machine."""
        formulas = formulas_of(self.edge_parts, self.face_parts)
        addresses = [f.address for f in formulas]
        reals = readdressed(self.reals, addresses, [0.0] * len(addresses))
        packed = hashlib.sha256()
        for array, kind in ((self.ints, "<i8"), (reals, "<f8")):
            packed.update(array.size.to_bytes(8, "little"))
            packed.update(array.astype(kind).tobytes())
        for formula in formulas:
            packed.update(repr(formula.expressions).encode())
        return packed.hexdigest()

    def __getstate__(self) -> Any:
        formulas = formulas_of(self.edge_parts, self.face_parts)
        return super().__getstate__(), [f.address for f in formulas]

    def __setstate__(self, stored: Any) -> None:
        state, old = stored
        super().__setstate__(state)
        # formulas are compiled again in another process, at other addresses
        new = [f.address for f in formulas_of(self.edge_parts, self.face_parts)]
        object.__setattr__(self, "reals", readdressed(self.reals, old, new))

    @property
    def bounded(self) -> bool:
        return isfinite(self.size)

    @property
    def n_faces(self) -> int:
        return len(self.face_parts)

    @property
    def n_edges(self) -> int:
        return len(self.edge_parts)

    @property
    def n_vertices(self) -> int:
        return len(self.vertex_points)

    def __repr__(self) -> str:
        faces, edges = counted(self.n_faces, "face"), counted(self.n_edges, "edge")
        parts = f"{faces}, {edges}, {counted(self.n_vertices, 'vertex', 'vertices')}"
        skin = f", radius {self.radius:g}" if self.radius else ""
        return f"<{type(self).__name__} {printable(self.name)}: {parts}{skin}, size {self.size:g}>"


def packed_parts(parts: Assembled) -> PackedParts:
    """Packed parts whose senses, box and kinds of edges need not be known yet; their size is 0."""
    nothing = np.zeros(3)
    ints, reals = pack(parts, [], (nothing, nothing), 0.0, 0.0)
    vertices, edges, faces = parts.vertices, tuple(parts.edges), tuple(parts.faces)
    return PackedParts("", vertices, edges, faces, 0.0, parts.dimension, ints, reals, 0.0)


def formulas_of(edges: Iterable[Edge], faces: Iterable[Face]) -> list[Formula]:
    """The formulas of a body's parts, in the order of the parts."""
    if isinstance(edges, MadeParts) and isinstance(faces, MadeParts):
        return []  # planes and lines, which are not made for this
    found = [f for edge in edges for f in edge.curve.formulas]
    return found + [f for face in faces for chart in face.charts for f in chart.formulas]


def readdressed(reals: Array, old: Sequence[float], new: Sequence[float]) -> Array:
    """A read-only copy of a packed body's numbers with other addresses."""
    changed = reals.copy()
    for before, after in dict(zip(old, new, strict=True)).items():
        changed[reals == before] = after
    changed.flags.writeable = False
    return changed
