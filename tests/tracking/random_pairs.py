"""Random pairs of bodies at random poses, and motions of them, for property tests."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

import standoff as so
from families import shapes
from families.shapes import Maker
from oracles.exact_pairs import random_normal, random_rotation
from oracles.poses import Kind, draw_poses
from standoff.motion import ConstantTwist

Array = NDArray[np.float64]

SPATIAL: tuple[Maker, ...] = (
    shapes.ellipsoid,
    shapes.lens,
    shapes.thin_lens,
    shapes.box,
    shapes.cylinder,
    shapes.cone,
    shapes.capsule,
    shapes.cap,
    shapes.polytope,
)
SHARES: dict[Kind, float] = {"exact": 0.4, "feature": 0.3, "free": 0.3}
NEAR_AND_FAR = (1e-4, 2.0)
"""Gaps of constructed poses, over the size."""
APART = (0.2, 2.0)
"""Gaps that the motions below do not close in a tenth of a second."""
SPEED = 0.2
"""Speed of a body's origin, sizes a second."""
SPIN = 0.5
"""Angular velocity, rad/s."""


@dataclass(frozen=True)
class Pair:
    """Two bodies at separated poses. ``size`` is finite also with a half-space."""

    label: str
    a: so.Body = field(repr=False)
    b: so.Body = field(repr=False)
    pose_a: so.Pose = field(repr=False)
    pose_b: so.Pose = field(repr=False)
    seed: int = field(repr=False)

    @property
    def size(self) -> float:
        return sum(body.size for body in (self.a, self.b) if body.bounded)

    @property
    def planar(self) -> bool:
        return self.a.dimension == 2 or self.b.dimension == 2

    def rng(self) -> np.random.Generator:
        """A generator for what else a test draws, the same each time."""
        return np.random.default_rng([self.seed, 1])

    def rigid_motion(self, shift: float) -> so.Pose:
        """A random pose ``shift`` sizes from the origin, in the plane for planar pairs."""
        rng = self.rng()
        rotation = random_rotation(rng, self.planar)
        return so.Pose(rotation, shift * self.size * random_normal(rng, self.planar))

    def paths(self) -> tuple[ConstantTwist, ConstantTwist, ConstantTwist]:
        """Slow random motions that begin at the poses, and one of a frame of reference.

        A half-space only shifts: its turn would sweep far away.
        """
        rng = self.rng()
        found = []
        poses = self.pose_a, self.pose_b, self.rigid_motion(1.0)
        for pose, bounded in zip(poses, (self.a.bounded, self.b.bounded, True), strict=True):
            v = SPEED * self.size * random_normal(rng, self.planar)
            omega = np.array([0, 0, 1.0]) if self.planar else random_normal(rng)
            omega = SPIN * omega if bounded else np.zeros(3)
            found.append(ConstantTwist(pose, so.Twist(v, omega)))
        return found[0], found[1], found[2]


def draw_pair(first: Maker, second: Maker, seed: int, gaps: tuple[float, float]) -> Pair:
    rng = np.random.default_rng(seed)
    one, two = first(rng), second(rng)
    planar = one.body.dimension == 2 or two.body.dimension == 2
    shares: dict[Kind, float] = {"exact": 1.0} if planar else SHARES
    poses = draw_poses(
        one.shape, two.shape, 1, int(rng.integers(1 << 31)), gaps=gaps, shares=shares
    )
    drawn = next(poses)
    label = f"{first.__name__}, {second.__name__}, seed {seed}, {drawn.kind}"
    return Pair(label, one.body, two.body, so.Pose(*drawn.pose_a), so.Pose(*drawn.pose_b), seed)


def pairs(
    gaps: tuple[float, float] = NEAR_AND_FAR, *, unbounded: bool = True
) -> st.SearchStrategy[Pair]:
    """Spatial pairs of every kind, with a half-space at times, and planar pairs."""
    makers = st.sampled_from(SPATIAL)
    couples = [
        st.tuples(makers, makers),
        st.tuples(makers, makers),
        st.tuples(makers, st.just(shapes.point)),
        st.tuples(st.just(shapes.loop), st.sampled_from((shapes.loop, shapes.planar_point))),
    ]
    if unbounded:
        couples.append(st.tuples(makers, st.just(shapes.half_space)))
    seeds = st.integers(0, 2**32 - 1)
    return st.builds(lambda couple, seed: draw_pair(*couple, seed, gaps), st.one_of(couples), seeds)
