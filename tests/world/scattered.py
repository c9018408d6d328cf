"""Worlds of bodies of many kinds, their motion, and what queries of all pairs find."""

import itertools
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

import standoff as so

SHAPES = (
    so.shapes.ellipsoid(0.3, 0.5, 0.7),
    so.shapes.box((0.5, 0.6, 0.4)),
    so.shapes.sphere(0.4),
    so.shapes.cylinder(0.3, 0.8),
    so.shapes.capsule(0.2, 0.6),
    so.shapes.lens(0.6, 0.25),
    so.shapes.point(),
)
SIDE = 3.0


def poses_of(rng: np.random.Generator, n: int, side: float = SIDE) -> np.ndarray:
    """Drawn poses in a cube of twice that side."""
    poses = np.tile(np.eye(4), (n, 1, 1))
    poses[:, :3, :3] = Rotation.random(n, random_state=rng).as_matrix()
    poses[:, :3, 3] = rng.uniform(-side, side, (n, 3))
    return poses


def bodies_of(rng: np.random.Generator, n: int, compounds: int) -> dict[str, object]:
    """n convex bodies, some compounds, and a floor."""
    found: dict[str, object] = {f"b{k}": SHAPES[k % len(SHAPES)] for k in range(n)}
    turned = poses_of(rng, 1, 0.5)[0]
    hand = so.compound(
        {
            "palm": SHAPES[1],
            "finger": (SHAPES[4], turned),
            "tip": (SHAPES[2], (np.eye(3), [1.0, 0, 0])),
        }
    )
    return found | {f"c{k}": hand for k in range(compounds)} | {"floor": so.shapes.halfspace()}


class Motion:
    """Bodies that fly through a cube and turn; now and then some jump, or all pause."""

    def __init__(self, rng: np.random.Generator, n: int) -> None:
        self.rng = rng
        self.poses = poses_of(rng, n)
        self.speed = 2.0 * rng.normal(size=(n, 3))
        self.spin = 3.0 * rng.normal(size=(n, 3))

    def step(self, h: float) -> np.ndarray:
        self.poses = self.poses.copy()
        at = self.poses[:, :3, 3]
        at += h * self.speed
        self.speed = np.where(np.abs(at) > SIDE, -np.sign(at) * np.abs(self.speed), self.speed)
        turn = Rotation.from_rotvec(self.spin * h).as_matrix()
        self.poses[:, :3, :3] = turn @ self.poses[:, :3, :3]
        return self.poses

    def jump(self, which: list[int]) -> np.ndarray:
        self.poses = self.poses.copy()
        self.poses[which] = poses_of(self.rng, len(which))
        return self.poses


class Truth(NamedTuple):
    """Of a pair of bodies: the answer of its nearest pieces, and their names."""

    answer: so.Proximity
    pieces: tuple[str, str]


def placed_pieces(body: object, pose: np.ndarray) -> list[tuple[str, so.Body, np.ndarray]]:
    """(name, body, world pose) of each piece."""
    if isinstance(body, so.Compound):
        found = []
        for name, piece in body.pieces.items():
            local = np.eye(4)
            local[:3, :3], local[:3, 3] = piece.pose.rotation, piece.pose.translation
            found.append((name, piece.body, pose @ local))
        return found
    return [("", body, pose)]


def truth_of(world: so.World, poses: np.ndarray) -> dict[tuple[str, str], Truth]:
    """Cold queries of all pairs of pieces, the least of each pair of bodies."""
    at = dict(zip(world.moving, poses, strict=True))
    at |= dict(zip(world.fixed, world.model.poses_of_fixed, strict=True))
    found = {}
    for a, b in world.pairs():
        each = [
            Truth(so.distance(x, y, pose_x, pose_y), (part_x, part_y))
            for (part_x, x, pose_x), (part_y, y, pose_y) in itertools.product(
                placed_pieces(world.bodies[a], at[a]), placed_pieces(world.bodies[b], at[b])
            )
        ]
        found[a, b] = min(each, key=lambda truth: truth.answer.distance)
    return found


def check(answer, truth: dict[tuple[str, str], Truth], within: float) -> int:
    """Compare every pair with the truth; returns how many are near."""
    near = 0
    for names, (true, _) in truth.items():
        found = answer[names]
        assert found.lower_bound <= true.upper_bound + 1e-12, (names, found, true)
        if true.distance <= within:
            near += 1
            assert not found.far, (names, true)
            # a depth that is proven to be the least is so to 1e-3
            off = 1e-9 if true.distance >= 0.0 else 1e-3 * true.depth + 1e-9
            assert abs(found.distance - true.distance) <= off, (names, found, true)
        else:
            assert found.far or found.distance > within - 1e-9, (names, found, true)
    least = min(true.distance for true, _ in truth.values())
    assert answer.clearance <= min(least, within) + 1e-12
    assert answer.clearance >= min(least, within) - 1e-6 - 1e-3 * max(0.0, -least)
    assert len(answer.pairs) == near
    if near:
        assert answer.closest is not None
        assert answer.closest.distance <= least + 1e-9 + 1e-3 * max(0.0, -least)
    return near
