"""A half-space beside a solid: a square of its plane, as large as the solid needs.

The nearest points of a bounded solid and a half-space are a point of the solid and its foot on the
plane, whether the solid is above the plane, meets it, or is below. So a square that holds the feet
of all points of a ball round the solid is as good as the plane, however deep the solid is. Its
sides are powers of two, so that few squares are made.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.bodies.boundary import Boundary
from standoff.bodies.features import Feature
from standoff.bodies.shapes.polyhedra import box
from standoff.bodies.tessellation import chart_row
from standoff.errors import StandoffError
from standoff.kernels.body import layout as L
from standoff.motion.pose import Pose
from standoff.solids.spatial.leaves import Leaf
from standoff.solids.spatial.minimum import leaf_jet_of
from standoff.solids.spatial.solid_model import SolidModel
from standoff.solids.spatial.tolerances import SPOT_SPARE
from standoff.solids.spatial.tree import packed_leaves
from standoff.typing import Array

HALF_SIDE = 1.25
"""Radii of the ball round the solid that half of a side is at least: points beside the solid at
which a common ball is sought are up to 1.06 of them from its middle."""

TOP = 5
"""The face of a box whose normal is z."""


class HalfSpace(SolidModel):
    """A half-space, which gets a boundary only beside a bounded solid."""

    def __init__(self, body: Body) -> None:
        self._given = self.boundary = body
        self._origins = {}
        surface = body.face_parts[0].charts[0]
        x, y, _ = surface.linear.T
        outward = float(body.reals[int(chart_row(body, 0)[L.CHART_REALS]) + L.OUTWARD])
        normal = outward * np.cross(x, y)
        normal = normal / np.linalg.norm(normal)
        along = x / np.linalg.norm(x)
        self.axes = np.column_stack([along, np.cross(normal, along), normal])
        """Right-handed, the third outward, own frame."""
        self.origin = surface.shift + body.radius * normal
        """A point of the plane, moved out by the radius."""
        self._back = np.linalg.inv(surface.linear)

    @property
    def bounded(self) -> bool:
        """False."""
        return False

    def parameters_at(self, point: Array) -> tuple[float, float]:
        """(u, v) of a point of the plane, own frame."""
        u, v, _ = self._back @ (point - self.origin)
        return float(u), float(v)


class Square(NamedTuple):
    """A square of the plane z = 0 as the face of a box below it, of which only that is searched."""

    boundary: Boundary
    own: NDArray[np.int64]
    numbers: Array
    leaves: list[Leaf]


@lru_cache(maxsize=64)
def _square(half: float) -> Square:
    """Of a half side, length."""
    thick = 0.25 * half
    below = box((2.0 * half, 2.0 * half, thick)).transformed((np.eye(3), [0, 0, -0.5 * thick]))
    packed = packed_leaves(below, (TOP,))
    return Square(below, packed.own, packed.numbers, packed.leaves)


class HalfSpaceBeside(SolidModel):
    """The part of a half-space's plane beside a ball; its centre in the half-space's frame."""

    def __init__(self, whole: HalfSpace, centre: Array, radius: float) -> None:
        half = float(2.0 ** np.ceil(np.log2(HALF_SIDE * radius)))
        square = _square(half)
        self.boundary, self.own, self.numbers, self.leaves = square
        self.edges_sampled = ()
        self.vertex_normals = None
        self.vertex_fans = None
        self.references = np.zeros((0, 3))
        self._given, self._origins = whole.boundary, {}
        self._whole, self._half = whole, half
        up = whole.axes[:, 2]
        self._foot = centre - ((centre - whole.origin) @ up) * up

    @property
    def size(self) -> float:
        """Diagonal of the square."""
        return float(np.sqrt(8.0)) * self._half

    def placed(self, pose: Pose) -> tuple[Array, Array]:
        """(rotation, shift) of the square, from the half-space's pose."""
        turn = np.asarray(pose.rotation)
        return turn @ self._whole.axes, turn @ self._foot + np.asarray(pose.translation)

    def feature_of(self, leaf: int) -> Feature:
        """Its only face."""
        return Feature("face", 0)

    def parameters_of(self, leaf: int, values: Array) -> tuple[float, ...]:
        """(u, v) of the half-space's own face."""
        point = leaf_jet_of(self.packed, leaf, float(values[0]), float(values[1]))[0]
        return self._whole.parameters_at(self._whole.axes @ point + self._foot)

    def part_told(self, feature: Feature) -> Feature:
        """The box's face."""
        return Feature("face", TOP)

    def may_hold(self, point: Array) -> bool:
        """Its box has no end."""
        return True

    @property
    def has_end(self) -> bool:
        """False."""
        return False

    def heights(self, ways: Array) -> Array:
        """0 along its normal, else without end."""
        return np.where(ways[:, 2] >= 1.0 - SPOT_SPARE, 0.0, np.inf)


def of_pair(own: SolidModel, pose: Pose, other: SolidModel, pose_other: Pose) -> SolidModel:
    """A solid as it is; a half-space as the part of its plane beside the other solid.

    Raises StandoffError: two half-spaces.
    """
    if not isinstance(own, HalfSpace):
        return own
    if isinstance(other, HalfSpace):
        raise StandoffError(
            "Two half-spaces: they always meet, or are parallel; one of a pair must be bounded.",
            "b",
            other,
        )
    centre, radius = other.ball_round()
    world = np.asarray(pose_other.rotation) @ centre + np.asarray(pose_other.translation)
    inside = (world - np.asarray(pose.translation)) @ np.asarray(pose.rotation)
    return HalfSpaceBeside(own, inside, radius)


def size_together(a: Any, b: Any) -> float:
    """Both sizes of a pair of solids, of which the tolerance is a part; of a half-space that of the
    greatest square beside the other, length."""
    if isinstance(a, HalfSpace) or isinstance(b, HalfSpace):
        own = b.size if isinstance(a, HalfSpace) else a.size
        # the ball's radius is at most half the diagonal of a box that may be turned
        return float(own * (1.0 + np.sqrt(8.0) * HALF_SIDE * np.sqrt(3.0)))
    return float(a.size + b.size)
