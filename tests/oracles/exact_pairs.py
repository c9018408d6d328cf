"""Pairs of bodies whose distance, witness points and normal are known by construction.

With support points s(n): ``x = s_A(n)``, ``y = x + g n``, ``p_B = y - R_B s_B(-n)``. The poses
are rounded to float64 first and everything else follows from the rounded poses in extended
precision (where the platform has it), so the truth belongs to the poses that are handed out. The
support of the linear image ``R X`` is exact for any matrix, so the rounding of R does no harm.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from standoff_studies.oracles import HalfSpace, Placed, Shape

Array = NDArray[Any]
Pose = tuple[Array, Array]

FLAT = 1e-12
"""Loss of support value, over the size, up to which a vertex belongs to a flat face."""


@dataclass(frozen=True)
class ExactPair:
    """Two placed bodies and the truth about them, in world.

    ``pose_a``, ``pose_b`` are ``(R, p)``; ``normal`` is from A to B. ``unique`` tells whether
    one body at least touches its supporting plane in a single point, which makes the witnesses
    unique; else they are one pair of several.
    """

    a: Placed
    b: Placed
    distance: float
    point_a: Array
    point_b: Array
    normal: Array
    unique: bool

    @property
    def pose_a(self) -> Pose:
        return self.a.rotation, self.a.position

    @property
    def pose_b(self) -> Pose:
        return self.b.rotation, self.b.position


def random_rotation(rng: np.random.Generator, planar: bool = False) -> Array:
    """Return a uniformly random rotation matrix (about z only if ``planar``)."""
    if planar:
        angle = rng.uniform(0, 2 * np.pi)
        c, s = np.cos(angle), np.sin(angle)
        return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    q = rng.normal(size=4)
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def random_normal(rng: np.random.Generator, planar: bool = False) -> Array:
    """Return a uniformly random unit vector (in z = 0 if ``planar``)."""
    n = rng.normal(size=3)
    if planar:
        n[2] = 0.0
    return n / np.linalg.norm(n)


def _support(body: Placed, normal: Array, rng: np.random.Generator) -> tuple[Array, bool]:
    """Return R s(n) in extended precision, anywhere in a flat support set, and uniqueness."""
    rotation = body.rotation.astype(np.longdouble)
    inner = normal.astype(np.longdouble) @ rotation
    if isinstance(body.shape, HalfSpace):
        spot = np.array([*rng.uniform(-1, 1, 2), 0.0], dtype=np.longdouble)
        return rotation @ spot, False
    several = body.shape.maximisers(inner.astype(float), FLAT)
    if len(several) == 1:
        return rotation @ body.shape.support(inner)[1], True
    share = rng.dirichlet(np.ones(len(several))).astype(np.longdouble)
    return rotation @ ((share / share.sum()) @ several.astype(np.longdouble)), False


def exact_pair(
    a: Shape,
    b: Shape,
    gap: float,
    rng: np.random.Generator,
    *,
    normal: ArrayLike | None = None,
    rotation_a: ArrayLike | None = None,
    rotation_b: ArrayLike | None = None,
    position_a: ArrayLike = (0.0, 0.0, 0.0),
) -> ExactPair:
    """Return two bodies exactly ``gap`` apart (up to the rounding of B's position).

    Random rotations and a random normal unless given (planar shapes: in the plane; half-spaces:
    the normal is that of the plane). ``distance`` is the truth at the rounded poses and differs
    from ``gap`` by a few roundings of the size.
    """
    planar = a.dimension == b.dimension == 2
    first, second = random_rotation(rng, planar), random_rotation(rng, planar)
    first = first if rotation_a is None else np.asarray(rotation_a, dtype=float)
    second = second if rotation_b is None else np.asarray(rotation_b, dtype=float)
    n = random_normal(rng, planar) if normal is None else np.asarray(normal, dtype=float)
    if isinstance(a, HalfSpace):
        n = first[:, 2]
    elif isinstance(b, HalfSpace):
        n = -second[:, 2]
    n = n.astype(np.longdouble)
    n = n / np.sqrt((n * n).sum())
    body_a = Placed(a, first, position_a)
    arm_a, unique_a = _support(body_a, n, rng)
    arm_b, unique_b = _support(Placed(b, second, np.zeros(3)), -n, rng)
    position_b = (body_a.position + arm_a + gap * n - arm_b).astype(float)
    between = (position_b.astype(np.longdouble) - body_a.position) + (arm_b - arm_a)
    point_a = (arm_a + body_a.position).astype(float)
    point_b = (arm_b + position_b).astype(float)
    return ExactPair(
        body_a,
        Placed(b, second, position_b),
        float(between @ n),
        point_a,
        point_b,
        n.astype(float),
        unique_a or unique_b,
    )
