"""A boundary: a closed, oriented B-rep of faces of any curvature, packed."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from math import isfinite
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.addresses import formulas_of, readdressed
from standoff.bodies.packing import Assembled, Ints, pack
from standoff.bodies.report import BodyReport, BoundaryReport
from standoff.bodies.topology import Edge, Face
from standoff.checks.arrays import finite
from standoff.errors import StandoffError
from standoff.geometry.surfaces import Surface
from standoff.geometry.validation import Array
from standoff.kernels.body import layout as L
from standoff.read_only import KeepsReadOnly
from standoff.wording import counted, printable

if TYPE_CHECKING:
    from standoff.bodies.assembly import Joined


class EdgeKind(StrEnum):
    """How the faces of an edge meet, seen from the material."""

    CONVEX = "convex"
    REFLEX = "reflex"
    SMOOTH = "smooth"
    MIXED = "mixed"
    """Convex somewhere along it and reflex elsewhere."""


@dataclass(frozen=True, eq=False)
class Boundary(KeepsReadOnly):
    """The boundary of a solid, in its own frame: closed, facing outward, packed.

    Its faces may bend either way and have holes; edges may be convex or reflex; shells inside the
    outer one are cavities. Make one with `from_brep` or `from_patches`. A `Body` is a boundary that
    is proven convex.

    Attributes
    ----------
    name : str
    vertex_points : (n, 3) array
        Body frame.
    edge_parts : tuple of Edge
    face_parts : tuple of Face
    radius : float
        Of the ball swept over the core, length; 0 but for bodies.
    dimension : int
        3; 2 for a planar body.
    ints, reals : array
        Packed, as ``standoff.kernels.body.layout`` says.
    report : BoundaryReport
    size : float
        Diagonal of the box around it, length.
    """

    name: str
    vertex_points: Array
    edge_parts: tuple[Edge, ...]
    face_parts: tuple[Face, ...]
    radius: float
    dimension: int
    ints: Ints
    reals: Array
    report: BoundaryReport | BodyReport
    size: float

    @staticmethod
    def from_brep(
        vertices: Any = (),
        edges: Sequence[Edge] = (),
        faces: Sequence[Face] = (),
        *,
        senses: Sequence[int | None] | None = None,
        tolerance: float | None = None,
        name: str = "boundary",
    ) -> Boundary:
        """A boundary from its vertices, edges and faces, whichever way round its loops are given.

        Where a face is follows from its loops: on the inside of the outermost and the outside of
        the others. Which way out is follows from its neighbours and from the volume enclosed.

        Parameters
        ----------
        vertices : (n, 3) array_like
            Points, body frame.
        edges : sequence of Edge
            Curves with their vertices; each joins two faces.
        faces : sequence of Face
            Surfaces with their loops.
        senses : sequence of +1, -1 or None, optional
            For every face whether x_u × x_v of its charts points outward. Only a face of several
            charts with a loop needs it, as both sides of the loop may be meant: by default it is
            the side where outside is where it bulges.
        tolerance : float, optional
            How far curves may be from their vertices and surfaces, length; 1e-9 of the size by
            default.

        Returns
        -------
        Boundary

        Raises
        ------
        BodyError
            An open shell, an edge of more than two faces, a surface with one side only, no volume,
            shells beside each other, or one inside another that faces the same way.
        TypeError
            Edges or faces that are no list.
        ValueError
            NaN, infinite, negative or wrongly shaped numbers.
        """
        from standoff.bodies.closing import joined_parts

        return _made(name, joined_parts(vertices, edges, faces, senses, tolerance))

    @staticmethod
    def from_patches(
        patches: Sequence[Surface], *, tolerance: float | None = None, name: str = "boundary"
    ) -> Boundary:
        """A boundary from patches that close one shell or several: their sides are sewn together.

        Parameters
        ----------
        patches : sequence of Surface
            As for ``Body.from_patches``, of any curvature.
        tolerance : float, optional
            How far joined sides may be apart, length; 1e-9 of the size by default.

        Returns
        -------
        Boundary

        Raises
        ------
        BodyError
            As `from_brep`, and as ``Body.from_patches`` where sides match none or several.
        """
        from standoff.bodies.closing import joined_patches

        return _made(name, joined_patches(patches, tolerance))

    def contains(self, points: Any) -> NDArray[np.bool_]:
        """Which points are inside or on the boundary.

        Parameters
        ----------
        points : (n, 3) array_like
            Body frame, length.

        Returns
        -------
        (n,) array of bool

        Raises
        ------
        StandoffError
            A wrong shape, a number that is not finite; a point of which rays do not tell it; a body
            that is planar, not bounded, without faces, or rounded.
        """
        from standoff.bodies.crossings import Crossings

        if not (self.face_parts and self.bounded and self.radius == 0.0):
            raise StandoffError(
                f"{self!r} is not a solid with faces of its own: ask for the distance of a point."
            )
        given = finite(points, "points", (-1, 3))
        rays = Crossings(self)
        return np.array([rays.inside(point) for point in given], dtype=bool)

    def check(self) -> BoundaryReport | BodyReport:
        """What construction found and turned."""
        return self.report

    @property
    def edge_kinds(self) -> tuple[EdgeKind, ...]:
        """Of every edge, sampled along it."""
        at = int(self.ints[L.EDGES]) + L.EDGE_FLAGS
        flags = self.ints[at : at + L.EDGE_STRIDE * self.n_edges : L.EDGE_STRIDE]
        return tuple(_kind(int(flag)) for flag in flags)

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


def boundary_of(parts: Assembled) -> Boundary:
    """A boundary of parts whose senses, box and edges' kinds are not known yet."""
    nothing = np.zeros(3)
    ints, reals = pack(parts, [], (nothing, nothing), 0.0, 0.0)
    report = BoundaryReport(faces=len(parts.faces), edges=len(parts.edges))
    vertices, edges, faces = parts.vertices, tuple(parts.edges), tuple(parts.faces)
    return Boundary("", vertices, edges, faces, 0.0, parts.dimension, ints, reals, report, 0.0)


def _made(name: str, joined: Joined) -> Boundary:
    from standoff.bodies.closing import close

    parts, ints, reals, report = close(joined)
    vertices, edges, faces = parts.vertices, tuple(parts.edges), tuple(parts.faces)
    size = report.size
    return Boundary(name, vertices, edges, faces, 0.0, parts.dimension, ints, reals, report, size)


def _kind(flags: int) -> EdgeKind:
    if flags & L.SMOOTH:
        return EdgeKind.SMOOTH
    if flags & L.MIXED:
        return EdgeKind.MIXED
    return EdgeKind.REFLEX if flags & L.REFLEX else EdgeKind.CONVEX
