"""Seeded random poses of separated pairs, near and far, generic and degenerate."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from standoff_studies.oracles import HalfSpace, Placed, Shape

from .bounds import overlap, pair_size
from .exact_pairs import exact_pair, random_normal, random_rotation

Array = NDArray[Any]
Kind = Literal["exact", "feature", "free", "close"]

FREE_SPAN = 3.0
"""Free placements put the bounding balls up to this many sizes apart."""
SHARES: dict[Kind, float] = {"exact": 0.4, "feature": 0.25, "free": 0.15, "close": 0.2}
"""Default shares of the kinds of poses."""


@dataclass(frozen=True)
class DrawnPose:
    """Two placed bodies, how they were drawn, and their distance where it is known."""

    a: Placed
    b: Placed
    kind: Kind
    distance: float | None

    @property
    def pose_a(self) -> tuple[Array, Array]:
        return self.a.rotation, self.a.position

    @property
    def pose_b(self) -> tuple[Array, Array]:
        return self.b.rotation, self.b.position


def rotation_about(axis: Array, angle: float) -> Array:
    """Return the rotation by ``angle`` about a unit axis; exact for tiny angles."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * cross + 2 * np.sin(angle / 2) ** 2 * (cross @ cross)


def feature_normal(shape: Shape, rotation: Array, rng: np.random.Generator) -> Array | None:
    """Return a world normal of a random flat or straight feature, or None if there is none."""
    normals = shape.special_normals(rng)
    if len(normals) == 0:
        return None
    n = rotation @ normals[rng.integers(len(normals))]
    return n / np.linalg.norm(n)


def size_of(a: Shape, b: Shape) -> float:
    """Return the greater finite diameter of two shapes."""
    unplaced = [Placed(shape, np.eye(3), np.zeros(3)) for shape in (a, b)]
    return pair_size(*unplaced)


def _constructed(a: Shape, b: Shape, gap: float, kind: Kind, rng: np.random.Generator) -> DrawnPose:
    """Draw an exact pair; of kind "feature" its normal is that of a flat or straight feature."""
    planar = a.dimension == b.dimension == 2
    first, second = random_rotation(rng, planar), random_rotation(rng, planar)
    normal = None
    if kind == "feature":
        options = [feature_normal(a, first, rng), feature_normal(b, second, rng)]
        options = [options[0], None if options[1] is None else -options[1]]
        known = [option for option in options if option is not None]
        normal = known[rng.integers(len(known))] if known else None
    place = rng.normal(size=3) * size_of(a, b)
    if planar:
        place[2] = 0.0
    pair = exact_pair(
        a, b, gap, rng, normal=normal, rotation_a=first, rotation_b=second, position_a=place
    )
    return DrawnPose(pair.a, pair.b, kind, pair.distance)


def _free(a: Shape, b: Shape, size: float, close: bool, rng: np.random.Generator) -> DrawnPose:
    """Draw free placements until they are separated; ``close`` lets bounding balls overlap."""
    planar = a.dimension == b.dimension == 2
    reach = a.bounding_radius + b.bounding_radius
    while True:
        apart = reach * rng.uniform(0, 1) if close else reach + size * rng.uniform(0, FREE_SPAN)
        first, second = random_rotation(rng, planar), random_rotation(rng, planar)
        place = rng.normal(size=3) * size * np.array([1, 1, 0 if planar else 1])
        body_a = Placed(a, first, place)
        body_b = Placed(b, second, place + apart * random_normal(rng, planar))
        if not close:
            return DrawnPose(body_a, body_b, "free", None)
        if not overlap(body_a, body_b):
            return DrawnPose(body_a, body_b, "close", None)


def draw_poses(
    a: Shape,
    b: Shape,
    count: int,
    seed: int,
    *,
    gaps: tuple[float, float] = (1e-4, 2.0),
    shares: dict[Kind, float] | None = None,
) -> Iterator[DrawnPose]:
    """Yield ``count`` separated random poses.

    Parameters
    ----------
    gaps
        Range of the log-uniform gaps of the constructed poses, over the pair's size.
    shares
        Shares of the kinds: "exact" (random normal), "feature" (normal of a flat face, a
        straight edge or a generator: often not unique), "free" (anywhere, bounding balls
        apart), "close" (anywhere within the bounding balls, kept if separated).
    """
    rng = np.random.default_rng(seed)
    chosen = SHARES if shares is None else shares
    if isinstance(a, HalfSpace) or isinstance(b, HalfSpace):
        chosen = {kind: share for kind, share in chosen.items() if kind in ("exact", "feature")}
    kinds: list[Kind] = list(chosen)
    weights = np.array([chosen[kind] for kind in kinds])
    size = size_of(a, b)
    low, high = np.log(gaps)
    for _ in range(count):
        kind = kinds[rng.choice(len(kinds), p=weights / weights.sum())]
        if kind in ("exact", "feature"):
            yield _constructed(a, b, size * float(np.exp(rng.uniform(low, high))), kind, rng)
        else:
            yield _free(a, b, size, kind == "close", rng)


def tilted_pair(a: Shape, b: Shape, tilt: float, gap: float, rng: np.random.Generator) -> DrawnPose:
    """Return B above A's +z side, its -z side tilted by ``tilt`` radians, ``gap`` between them.

    The separation along A's z is ``gap``; a random heading of B and a random offset within a
    quarter of the sizes keep the sides facing. The distance is ``gap`` for tilt 0 and where
    the lowest point of B lies above A's side; it is not filled in. A random common rotation.
    """
    common = random_rotation(rng)
    heading = rotation_about(np.array([0.0, 0.0, 1.0]), rng.uniform(0, 2 * np.pi))
    angle = rng.uniform(0, 2 * np.pi)
    axis = np.array([np.cos(angle), np.sin(angle), 0.0])
    inner = rotation_about(axis, tilt) @ heading
    reach = 0.25 * min(a.bounding_radius, b.bounding_radius)
    top = a.support([0.0, 0.0, 1.0])[0]
    bottom = Placed(b, inner, np.zeros(3)).support([0.0, 0.0, -1.0])[0]
    shift = np.array([*rng.uniform(-reach, reach, 2), top + bottom + gap])
    rotation = common @ inner
    return DrawnPose(
        Placed(a, common, np.zeros(3)), Placed(b, rotation, common @ shift), "feature", None
    )
