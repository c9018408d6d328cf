"""A boundary: a closed, oriented B-rep of faces of any curvature, packed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.packed_parts import PackedParts
from standoff.bodies.report import BodyReport, BoundaryReport
from standoff.bodies.topology import Edge, Face
from standoff.checks.arrays import finite
from standoff.errors import StandoffError
from standoff.geometry.surfaces import Surface
from standoff.kernels.body import layout as L

if TYPE_CHECKING:
    from standoff.bodies.assembly import Joined


class EdgeKind(StrEnum):
    """How the faces of an edge meet, seen from the material."""

    CONVEX = "convex"
    REFLEX = "reflex"
    SMOOTH = "smooth"
    MIXED = "mixed"
    """Convex in some places along it and reflex in others."""


@dataclass(frozen=True, eq=False, repr=False)
class Boundary(PackedParts):
    """The boundary of a solid, in its own frame: closed, facing outward, packed.

    Its faces may bend either way and have holes; edges may be convex or reflex; shells inside the
    outer one are cavities. Make one with `from_brep` or `from_patches`. A `Body` is a boundary that
    is proven convex.

    Attributes
    ----------
    name : str
    vertex_points : (n, 3) array
        Body frame.
    edge_parts : sequence of Edge
    face_parts : sequence of Face
    radius : float
        Of the ball swept over the core, length; 0 unless it is a `Body`.
    dimension : int
        3; 2 for a planar `Body`.
    ints, reals : array
        The packed boundary that the kernels read, laid out as in ``standoff.kernels.body.layout``.
    size : float
        Diagonal of the box around it, length.
    report : BoundaryReport
    """

    report: BoundaryReport | BodyReport

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

        Its loops determine where a face is: inside the outermost and outside the others. Its
        neighbours and the enclosed volume determine which side of it is outside.

        Raises BodyError: an open shell, an edge of more than two faces, a surface with only one
        side, no volume, shells beside each other, or one inside another that faces the same way.
        Raises TypeError: edges or faces that are not a list. Raises ValueError: NaN, infinite,
        negative or wrongly shaped numbers.

        Parameters
        ----------
        vertices : (n, 3) array_like
            Points, body frame.
        edges : sequence of Edge
            Curves with their vertices; each joins two faces.
        faces : sequence of Face
            Surfaces with their loops.
        senses : sequence of +1, -1 or None, optional
            For every face whether x_u × x_v of its charts points outward. It is needed only for a
            face of several charts with a loop, because either side of the loop may be meant: by
            default, the side that bulges outward.
        tolerance : float, optional
            How far curves may be from their vertices and surfaces, length; 1e-9 of the size by
            default.

        Returns
        -------
        Boundary
        """
        from standoff.bodies.assembly import joined_parts

        joined = joined_parts(vertices, edges, faces, tolerance, closed=True, senses=senses)
        return made_boundary(name, joined)

    @staticmethod
    def from_patches(
        patches: Sequence[Surface], *, tolerance: float | None = None, name: str = "boundary"
    ) -> Boundary:
        """A boundary from patches that close one or more shells: their sides are sewn together.

        Raises BodyError as for `from_brep`, and sides that match none or several, as in
        ``Body.from_patches``.

        Parameters
        ----------
        patches : sequence of Surface
            As for ``Body.from_patches``, of any curvature.
        tolerance : float, optional
            How far joined sides may be apart, length; 1e-9 of the size by default.

        Returns
        -------
        Boundary
        """
        from standoff.bodies.closing import joined_patches

        return made_boundary(name, joined_patches(patches, tolerance))

    def contains(self, points: Any) -> NDArray[np.bool_]:
        """Which points are inside or on the boundary.

        Raises StandoffError: a wrong shape, or a number that is not finite; a point for which no
        ray decides; a body that is planar, unbounded, without faces, or rounded.

        Parameters
        ----------
        points : (n, 3) array_like
            Body frame, length.

        Returns
        -------
        (n,) array of bool
        """
        from standoff.bodies.crossings import Crossings

        if not (self.face_parts and self.bounded and self.radius == 0.0):
            raise StandoffError(
                f"{self!r} is not a bounded, unrounded solid with faces: use so.points instead."
            )
        given = finite(points, "points", (-1, 3))
        rays = Crossings(self)
        return np.array([rays.inside(point) for point in given], dtype=bool)

    def check(self) -> BoundaryReport | BodyReport:
        """What construction found and turned."""
        return self.report

    @property
    def edge_kinds(self) -> tuple[EdgeKind, ...]:
        """The kind of every edge, sampled along it."""
        at = int(self.ints[L.EDGES]) + L.EDGE_FLAGS
        flags = self.ints[at : at + L.EDGE_STRIDE * self.n_edges : L.EDGE_STRIDE]
        return tuple(_kind(int(flag)) for flag in flags)


def made_boundary(name: str, joined: Joined) -> Boundary:
    """A boundary from joined parts; raises as `Boundary.from_brep` does."""
    from standoff.bodies.closing import close

    parts, ints, reals, report = close(joined)
    vertices, edges, faces = parts.vertices, tuple(parts.edges), tuple(parts.faces)
    size = report.size
    return Boundary(name, vertices, edges, faces, 0.0, parts.dimension, ints, reals, size, report)


def _kind(flags: int) -> EdgeKind:
    if flags & L.SMOOTH:
        return EdgeKind.SMOOTH
    if flags & L.MIXED:
        return EdgeKind.MIXED
    return EdgeKind.REFLEX if flags & L.REFLEX else EdgeKind.CONVEX
