"""A solid's boundary with its leaves, their tree, and what is known of it."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple
from weakref import WeakValueDictionary

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.bodies.boundary import Boundary
from standoff.bodies.features import Feature
from standoff.bodies.report import BodyReport, BoundaryReport
from standoff.checks.numbers import positive
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.torus_potential import TORUS_THROUGH
from standoff.motion.pose import Pose
from standoff.read_only import KeepsReadOnly
from standoff.solids.spatial.tolerances import MASS_TOLERANCE
from standoff.solids.spatial.tree import packed_leaves
from standoff.typing import Array
from standoff.wording import printable

if TYPE_CHECKING:
    from standoff.bodies.rounding.parts import Origin


_models: WeakValueDictionary[int, SolidModel] = WeakValueDictionary()
"""The solids that there are, by the identity of the boundaries that they were made of and keep."""


def known_model(boundary: Boundary) -> SolidModel | None:
    """The `Solid` of a boundary that somebody has."""
    return _models.get(id(boundary))


class LeafTable(NamedTuple):
    """The leaves of a solid.

    parts : the face, edge or vertex that each is of.
    feature : the number of that.
    chart : (n, 2) the same, and the number of its chart.
    dim : of how many parameters it is.
    plane : is it of a plane? What is parallel to one is near it all over, and the strips and
        corners beside a plane are as near at their ends only.
    ends : (n, 4) of its parameters.
    """

    parts: list[Feature]
    feature: NDArray[np.int64]
    chart: NDArray[np.int64]
    dim: NDArray[np.int64]
    plane: NDArray[np.bool_]
    ends: Array


class SolidModel(KeepsReadOnly):
    """What the search reads of a solid; its arguments are those of `Solid`, and so are its errors.

    Attributes
    ----------
    boundary : Boundary
        Of a body with a radius the one that is swept, whose faces, edges and vertices are not the
        body's own: `feature_of` and `parameters_of` tell the body's, `part_of` the boundary's.
    own, numbers : arrays
        Its leaves and their tree, as ``kernels.solids.spatial_layout`` lays them out.
    leaves : list of Leaf
    edges_sampled : tuple of int
        The edges whose kind (convex, reflex, smooth) is not proven, but only sampled. A sharp one
        of them is searched from both sides, so that its kind does not matter.
    references, vertex_normals, vertex_fans : what is found out only once it is asked for.
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
                f"Solid of {shown(boundary)}: give a Boundary or a Body.", "boundary", boundary
            )
        volume = None if volume is None else positive(volume, "volume")
        area = None if area is None else positive(area, "area")
        relative = positive(relative, "relative")
        check_solid(boundary)
        self._given = boundary
        self._origins: dict[Feature, Origin] = {}
        if isinstance(boundary, Body) and boundary.radius:
            from standoff.bodies.rounding.build import rounded_boundary

            boundary, self._origins = rounded_boundary(boundary)
        self.boundary = boundary
        self._compare("volume", volume, relative)
        self._compare("area", area, relative)
        self.own, self.numbers, self.leaves, self.edges_sampled = packed_leaves(boundary)
        self.references: Array | None = None
        self.vertex_normals: Array | None = None
        self.vertex_fans: Any = None

    def _register(self) -> None:
        """Let others find it by its boundary, now that it is checked."""
        _models[id(self._given)] = self

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

    @cached_property
    def rays(self) -> Any:
        """Rays that decide whether a point is inside where nothing nearer does (`Crossings`)."""
        from standoff.bodies.crossings import Crossings

        return Crossings(self.boundary)

    @property
    def name(self) -> str:
        return self._given.name

    @property
    def given(self) -> Boundary:
        """What it was made of, whose faces, edges and vertices answers name: a boundary or body."""
        return self._given

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
        rounded = self._given is not self.boundary
        return float(self.report.slack + (self._given.report.slack if rounded else 0.0))

    @property
    def packed(self) -> tuple[NDArray[np.int64], Array, NDArray[np.int64], Array]:
        """What the kernels read."""
        return self.boundary.ints, self.boundary.reals, self.own, self.numbers

    @cached_property
    def leaf_table(self) -> LeafTable:
        """Its leaves in arrays."""
        first = (0, self.boundary.n_faces, self.boundary.n_faces + self.boundary.n_edges)
        names = ("face", "edge", "vertex")
        parts = [
            Feature(names[2 - leaf.dim], leaf.feature - first[2 - leaf.dim]) for leaf in self.leaves
        ]
        return LeafTable(
            parts,
            np.array([leaf.feature for leaf in self.leaves]),
            np.array([(leaf.feature, leaf.chart) for leaf in self.leaves]),
            np.array([leaf.dim for leaf in self.leaves]),
            np.array([leaf.dim == 2 and leaf.kind == TORUS_THROUGH for leaf in self.leaves]),
            np.array([leaf.reals[:4] for leaf in self.leaves]),
        )

    def part_of(self, leaf: int) -> Feature:
        """The face, edge or vertex of the boundary that a leaf is of."""
        return self.leaf_table.parts[leaf]

    @cached_property
    def _cavity_parts(self) -> frozenset[Feature]:
        report = getattr(self.boundary, "report", None)
        if not isinstance(report, BoundaryReport):
            return frozenset()
        faces = {f for k in report.cavities for f in report.shells[k]}
        edges = {j for f in faces for j, _ in self.boundary.face_parts[f].loop}
        ends = [self.boundary.edge_parts[j] for j in edges]
        vertices = {v for edge in ends for v in (edge.first, edge.last) if v is not None}
        named = (("face", faces), ("edge", edges), ("vertex", vertices))
        return frozenset(Feature(kind, k) for kind, numbers in named for k in numbers)

    def in_cavity(self, feature: Feature) -> bool:
        """Is a face, edge or vertex on the wall of a cavity?"""
        return feature in self._cavity_parts

    def feature_of(self, leaf: int) -> Feature:
        """The face, edge or vertex of a leaf; of a body with a radius that of its core."""
        part = self.part_of(leaf)
        return self._origins[part].feature if self._origins else part

    @property
    def is_rounded(self) -> bool:
        """Are its features and parameters told as those of the core of a body with a radius?"""
        return bool(self._origins)

    def parameters_of(self, leaf: int, values: Array) -> tuple[float, ...]:
        """(u, v) of a face, (t,) of an edge, () of a vertex, from a leaf's own; of a body with a
        radius those of its core."""
        if self._origins:
            return self._origins[self.part_of(leaf)].parameters(values)
        return tuple(float(x) for x in values[: self.leaves[leaf].dim])

    def part_told(self, feature: Feature) -> Feature:
        """A part of the boundary that `feature_of` tells as a feature."""
        told = (part for part, origin in self._origins.items() if origin.feature == feature)
        return next(told, feature)

    def placed(self, pose: Pose) -> tuple[Array, Array]:
        """(rotation, shift) of its boundary's frame in the world."""
        return np.asarray(pose.rotation), np.asarray(pose.translation)

    def may_hold(self, point: Array) -> bool:
        """Is a point, own frame, in the box at the root of the tree?"""
        o = int(self.own[S.R_NODES])
        node = self.numbers[o : o + S.NODE_REALS]
        axes = node[S.AXES : S.AXES + 9].reshape(3, 3)
        away = np.abs(axes @ (point - node[S.CENTRE : S.CENTRE + 3]))
        return bool((away <= node[S.HALF : S.HALF + 3]).all())

    def ball_round(self) -> tuple[Array, float]:
        """(centre, radius) of a ball round it, own frame, length."""
        o = int(self.own[S.R_NODES])
        node = self.numbers[o : o + S.NODE_REALS]
        return node[S.CENTRE : S.CENTRE + 3], float(np.linalg.norm(node[S.HALF : S.HALF + 3]))

    @property
    def has_end(self) -> bool:
        """Is it no half-space?"""
        return True

    @cached_property
    def _boxes(self) -> tuple[Array, Array]:
        """Of its leaves: centres (n, 3), and half the sides of boxes around them (n, 3, 3)."""
        arms = [leaf.half[:, None] * leaf.axes for leaf in self.leaves]
        return np.array([leaf.centre for leaf in self.leaves]), np.array(arms)

    def heights(self, ways: Array) -> Array:
        """How far it reaches along unit vectors (n, 3), own frame, at most, lengths (n,)."""
        centres, arms = self._boxes
        reach = np.abs(arms.reshape(-1, 3) @ ways.T).reshape(len(arms), 3, -1).sum(axis=1)
        return np.asarray((centres @ ways.T + reach).max(axis=0))

    def __repr__(self) -> str:
        b = self.boundary
        return (
            f"<{type(self).__name__} {printable(self.name)}: {b.n_faces} faces, {b.n_edges} edges, "
            f"{b.n_vertices} vertices, {len(self.leaves)} leaves, size {b.size:g}>"
        )


def check_solid(boundary: Boundary) -> None:
    """Raise StandoffError for what encloses no volume, or not all of it."""
    if boundary.dimension != 3:
        why = "is planar: a Solid encloses a volume; so.PlanarSolid takes it"
    elif not boundary.bounded:
        why = "is not bounded: give it to so.solids.distance or a world as it is"
    elif not (boundary.face_parts or boundary.radius):
        why = (
            "has no volume: a radius makes it a ball or a capsule, and signed_distance of a solid "
            "tells how far points are"
        )
    else:
        return
    raise StandoffError(f"{boundary!r} {why}.", "boundary", boundary)
