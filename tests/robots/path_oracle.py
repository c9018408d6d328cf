"""Distances along joint paths by another way: kinematics with SciPy's rotations at many times at
once, and closed forms for spheres, capsules, half-spaces, and for rings beside spheres.

Nothing of it is the library's but the joints and the sizes of the bodies.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

import standoff as so
from families.solid_shapes import ring
from robots.trees import TreeRobot, drawn_axis, drawn_pose, robot_of


@lru_cache
def made_ring(circle: float, radius: float) -> Any:
    """A ring as a solid: it is made in seconds."""
    return ring(circle, radius)


class Simple(NamedTuple):
    """A segment with a radius; of half-length 0 a point; or a half-space below a plane; or a circle
    about z with a radius around it, a torus."""

    radius: float
    half: float = 0.0
    normal: Any = None
    offset: float = 0.0
    circle: float = 0.0

    def body(self) -> Any:
        if self.circle:
            return made_ring(self.circle, self.radius)
        if self.normal is not None:
            return so.shapes.halfspace(self.normal, self.offset)
        if self.half == 0.0:
            return so.shapes.sphere(self.radius)
        return so.shapes.capsule(radius=self.radius, length=2.0 * self.half)


def drawn_simple(rng: np.random.Generator) -> Simple:
    return Simple(rng.uniform(0.02, 0.1), 0.0 if rng.random() < 0.3 else rng.uniform(0.02, 0.25))


class Judged(NamedTuple):
    """A robot and the same once more, as the oracle knows it."""

    robot: TreeRobot
    geoms: list[tuple[int, Simple, np.ndarray]]
    fixed: list[tuple[Simple, np.ndarray]]
    pairs: list[tuple[int, int]]


def drawn_judged(
    rng: np.random.Generator, joints: int, spread: float = 0.35, rings: int = 0
) -> Judged:
    """A random tree of hinges and slides with spheres and capsules; with rings as solids there are
    no capsules, and each ring is a piece of the world that some of the spheres may go through."""
    kinds = [int(k) for k in rng.choice([1, 1, 1, 2], joints)]
    parents = [int(rng.integers(-1, j)) if rng.random() < 0.25 else j - 1 for j in range(joints)]
    geoms = [(j, drawn_simple(rng), drawn_pose(rng, 0.2)) for j in range(joints)]
    fixed = [(drawn_simple(rng), drawn_pose(rng, 0.9)) for _ in range(4)]
    if rings:
        geoms = [(j, Simple(rng.uniform(0.02, 0.07)), pose) for j, _, pose in geoms]
        fixed = [
            (Simple(0.03, circle=float(rng.choice([0.15, 0.35]))), drawn_pose(rng, 0.5))
            for _ in range(rings)
        ]
    if rng.random() < 0.5:
        fixed.append((Simple(0.0, 0.0, [0.0, 0.0, 1.0], -rng.uniform(0.3, 1.0)), np.eye(4)))
    names = [f"g{k}" for k in range(joints)] + [f"f{k}" for k in range(len(fixed))]
    robot = robot_of(
        kinds,
        parents,
        [drawn_pose(rng, spread) for _ in range(joints)],
        [drawn_axis(rng) for _ in range(joints)],
        [(j, simple.body(), pose) for j, simple, pose in geoms],
        fixed={f"f{k}": (simple.body(), pose) for k, (simple, pose) in enumerate(fixed)},
        ignore=[(f"g{j}", f"g{p}") for j, p in enumerate(parents) if p >= 0],
    )
    number = {name: k for k, name in enumerate(names)}
    pairs = [(number[a], number[b]) for a, b in robot.world.pairs()]
    return Judged(robot, geoms, fixed, pairs)


def links_at(robot: TreeRobot, q: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """(rotations (m, 3, 3), origins (m, 3)) of each joint's moved frame at (m, nq)."""
    found: list[tuple[np.ndarray, np.ndarray]] = []
    joints = robot.joints
    for j, parent in enumerate(joints.parents.tolist()):
        turn = np.broadcast_to(np.eye(3), (len(q), 3, 3)) if parent < 0 else found[parent][0]
        shift = np.zeros((len(q), 3)) if parent < 0 else found[parent][1]
        place, number = joints.placements[j], q[:, joints.q_at[j]]
        shift = shift + turn @ place[:3, 3]
        turn = turn @ place[:3, :3]
        if joints.kinds[j] == 1:
            turn = turn @ Rotation.from_rotvec(number[:, None] * joints.axes[j]).as_matrix()
        else:
            shift = shift + (turn @ joints.axes[j]) * number[:, None]
        found.append((turn, shift))
    return found


def least_distances(judged: Judged, q: np.ndarray) -> np.ndarray:
    """(m, n pairs): signed distances at configurations."""
    links = links_at(judged.robot, q)
    m = len(q)
    ends = []
    for joint, simple, pose in judged.geoms:
        turn, shift = links[joint]
        centre = shift + turn @ pose[:3, 3]
        arm = (turn @ pose[:3, 2]) * simple.half
        ends.append((centre - arm, centre + arm))
    for simple, pose in judged.fixed:
        arm = pose[:3, 2] * (simple.half or simple.circle)
        ends.append(tuple(np.tile(pose[:3, 3] + s * arm, (m, 1)) for s in (-1.0, 1.0)))
    simples = [simple for _, simple, _ in judged.geoms] + [simple for simple, _ in judged.fixed]
    return np.stack(
        [_between(ends[i], simples[i], ends[j], simples[j]) for i, j in judged.pairs], 1
    )


def _between(a: Any, of_a: Simple, b: Any, of_b: Simple) -> np.ndarray:
    if of_a.normal is not None or of_a.circle:
        a, of_a, b, of_b = b, of_b, a, of_a
    if of_b.circle:
        return _to_ring(a[0], *b, of_b) - of_a.radius
    if of_b.normal is not None:
        heights = [end @ np.asarray(of_b.normal) - of_b.offset for end in a]
        return np.minimum(*heights) - of_a.radius
    return segments_apart(*a, *b) - of_a.radius - of_b.radius


def _to_ring(p: Any, low: Any, high: Any, ring: Simple) -> np.ndarray:
    """(m,) signed distances of points from a torus, about the line from low to high."""
    middle, axis = 0.5 * (low + high), high - low
    axis = axis / np.linalg.norm(axis, axis=1)[:, None]
    along = np.einsum("mi,mi->m", p - middle, axis)
    across = np.linalg.norm(p - middle - along[:, None] * axis, axis=1)
    return np.hypot(across - ring.circle, along) - ring.radius


def segments_apart(a0: Any, a1: Any, b0: Any, b1: Any) -> np.ndarray:
    """(m,) distances of segments: the least of the four ends' and of the lines' where these are
    nearest inside of both."""
    best = np.minimum.reduce(
        [
            _to_segment(a0, b0, b1),
            _to_segment(a1, b0, b1),
            _to_segment(b0, a0, a1),
            _to_segment(b1, a0, a1),
        ]
    )
    u, v, w = a1 - a0, b1 - b0, a0 - b0
    uu, vv, uv = (np.einsum("mi,mi->m", x, y) for x, y in ((u, u), (v, v), (u, v)))
    uw, vw = (np.einsum("mi,mi->m", x, w) for x in (u, v))
    det = uu * vv - uv * uv
    crossing = det > 1e-12 * uu * vv
    safe = np.where(crossing, det, 1.0)
    s, t = (uv * vw - vv * uw) / safe, (uu * vw - uv * uw) / safe
    inside = crossing & (s > 0) & (s < 1) & (t > 0) & (t < 1)
    gap = np.linalg.norm(w + s[:, None] * u - t[:, None] * v, axis=1)
    return np.where(inside, np.minimum(best, gap), best)


def _to_segment(p: Any, a: Any, b: Any) -> np.ndarray:
    along = b - a
    size = np.einsum("mi,mi->m", along, along)
    t = np.einsum("mi,mi->m", p - a, along) / np.where(size > 0.0, size, 1.0)
    return np.linalg.norm(p - a - np.clip(t, 0.0, 1.0)[:, None] * along, axis=1)
