"""A solid's boundary with its leaves, their tree, and what is known of it."""

from __future__ import annotations

from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.bodies.boundary import Boundary
from standoff.bodies.features import Feature
from standoff.bodies.report import BodyReport, BoundaryReport
from standoff.errors import StandoffError
from standoff.geometry.validation import Array
from standoff.solids.spatial.leaves import Leaf
from standoff.solids.spatial.tolerances import MASS_TOLERANCE
from standoff.solids.spatial.tree import packed_leaves
from standoff.wording import printable


class SolidModel:
    """What the search reads of a solid; its arguments are those of `Solid`, and so are its errors.

    Attributes
    ----------
    boundary : Boundary
    own, numbers : arrays
        Its leaves and their tree, as ``kernels.solids.spatial_layout`` lays them out.
    leaves : list of Leaf
    edges_sampled : tuple of int
        The edges whose kind (convex, reflex, smooth) is not proven, but only sampled. A sharp one
        of them is searched from both sides, so that its kind does not matter.
    references, vertex_normals : what is found out only once it is asked for.
    """

    def __init__(
        self,
        boundary: Boundary,
        *,
        volume: float | None = None,
        area: float | None = None,
        relative: float = 1e-6,
    ) -> None:
        if not isinstance(boundary, Boundary):
            raise StandoffError(
                f"Solid of {boundary!r}: give a Boundary or a Body.", "boundary", boundary
            )
        whole = boundary.dimension == 3 and boundary.bounded and boundary.face_parts
        if not whole or boundary.radius != 0.0:
            raise StandoffError(
                f"{boundary!r} is not a bounded, unrounded body with faces in space: a Solid "
                "encloses a volume.",
                "boundary",
                boundary,
            )
        self.boundary = boundary
        self._compare("volume", volume, relative)
        self._compare("area", area, relative)
        self.own, self.numbers, self.leaves, self.edges_sampled = packed_leaves(boundary)
        self.references: Array | None = None
        self.vertex_normals: dict[int, Array | None] = {}

    def _compare(self, name: str, given: float | None, relative: float) -> None:
        if given is None:
            return
        found = getattr(self.report, name, None)
        if found is None:
            found = getattr(self.mass, name)
        if not abs(found - given) <= relative * abs(given):
            raise StandoffError(
                f"{self.boundary!r} has the {name} {found:.9g}, not {given:.9g}: a face may be "
                "missing, or cover another part of its surface.",
                name,
                given,
            )

    @cached_property
    def mass(self) -> Any:
        """Volume and area of a `Body`, which its report does not hold."""
        from standoff.bodies.enclosed import enclosed_by

        return enclosed_by(self.boundary, range(self.boundary.n_faces), MASS_TOLERANCE)

    @property
    def name(self) -> str:
        return self.boundary.name

    @property
    def dimension(self) -> int:
        """3."""
        return 3

    @property
    def bounded(self) -> bool:
        """True."""
        return True

    @property
    def size(self) -> float:
        """Diagonal of the box around it, length."""
        return self.boundary.size

    @property
    def report(self) -> BoundaryReport | BodyReport:
        """What the checks at construction found, as `check` returns it."""
        return self.boundary.report

    def check(self) -> BoundaryReport | BodyReport:
        """What the checks at construction found."""
        return self.boundary.report

    @property
    def slack(self) -> float:
        """How far the boundary may be from the one that was given, length."""
        return float(self.report.slack)

    @property
    def packed(self) -> tuple[NDArray[np.int64], Array, NDArray[np.int64], Array]:
        """What the kernels read."""
        return self.boundary.ints, self.boundary.reals, self.own, self.numbers

    def feature_of(self, leaf: int) -> Feature:
        """The face, edge or vertex of a leaf."""
        part: Leaf = self.leaves[leaf]
        first = (0, self.boundary.n_faces, self.boundary.n_faces + self.boundary.n_edges)
        names = ("face", "edge", "vertex")
        return Feature(names[2 - part.dim], part.feature - first[2 - part.dim])

    def __repr__(self) -> str:
        b = self.boundary
        return (
            f"<{type(self).__name__} {printable(self.name)}: {b.n_faces} faces, {b.n_edges} edges, "
            f"{b.n_vertices} vertices, {len(self.leaves)} leaves, size {b.size:g}>"
        )


def as_model(given: Any) -> SolidModel:
    """A `Solid` as it is, a `Boundary` or `Body` as a solid."""
    if isinstance(given, SolidModel):
        return given
    if isinstance(given, Boundary | Body):
        return _made_once(given)
    raise StandoffError(f"{given!r} is no Solid, Boundary or Body.", "solid", given)


@lru_cache(maxsize=64)
def _made_once(boundary: Boundary) -> SolidModel:
    """A body is asked again and again, and its leaves take a second."""
    return SolidModel(boundary)
