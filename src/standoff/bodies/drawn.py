"""What pictures ask of a body: `Body` draws itself by them, so they do not import it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from standoff.bodies.packing import Ints
from standoff.bodies.report import BodyReport
from standoff.bodies.topology import Edge, Face
from standoff.geometry.validation import Array


class Faced(Protocol):
    """A `Boundary`, as far as its packed charts are read."""

    @property
    def dimension(self) -> int: ...
    @property
    def ints(self) -> Ints: ...
    @property
    def reals(self) -> Array: ...
    @property
    def edge_parts(self) -> Sequence[Edge]: ...
    @property
    def face_parts(self) -> Sequence[Face]: ...
    @property
    def n_faces(self) -> int: ...
    @property
    def n_edges(self) -> int: ...


class Drawn(Faced, Protocol):
    """A `Body`, as far as it is drawn."""

    @property
    def name(self) -> str: ...
    @property
    def radius(self) -> float: ...
    @property
    def vertex_points(self) -> Array: ...
    @property
    def n_vertices(self) -> int: ...
    @property
    def bounded(self) -> bool: ...

    def check(self) -> BodyReport:
        """What construction found and turned."""
