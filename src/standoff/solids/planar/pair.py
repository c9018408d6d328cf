"""Two planar solids at their poses."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple, Protocol

from standoff.bodies.features import Feature
from standoff.geometry.curves import Curve
from standoff.solids.planar.loops import Loop
from standoff.solids.planar.outline import PlanarOutline
from standoff.solids.planar.tolerances import BOUND_ROUNDED
from standoff.typing import Array


class PlanarShape(Protocol):
    """What a query needs of a planar solid."""

    @property
    def outline(self) -> PlanarOutline: ...

    @property
    def loops(self) -> Sequence[Loop]: ...

    @property
    def edges(self) -> Sequence[Curve]: ...

    @property
    def slack(self) -> float: ...

    @property
    def size(self) -> float: ...

    def feature_at(self, leaf: int, t: float) -> tuple[Feature, tuple[float, ...]]: ...


class PlanarPair(NamedTuple):
    """A pair at its poses, and how its answer is to be proven."""

    a: PlanarShape
    b: PlanarShape
    poses: Array  # (24,)
    tolerance: float
    extent: float
    budget: int

    @property
    def roundoff(self) -> float:
        """Of one bound, length."""
        return BOUND_ROUNDED * self.extent

    @property
    def slack(self) -> float:
        """Of both solids, length."""
        return self.a.slack + self.b.slack

    @property
    def size(self) -> float:
        """Of the larger one, length."""
        return max(self.a.size, self.b.size)

    def world(self, point: Any) -> Array:
        """A point (x, y) of A's frame in world axes, (3,)."""
        return self.turned(point) + self.poses[9:12]

    def turned(self, vector: Any) -> Array:
        """A vector (x, y) of A's frame in world axes, (3,)."""
        R = self.poses[:9].reshape(3, 3)
        image: Array = R[:, 0] * vector[0] + R[:, 1] * vector[1]
        return image
