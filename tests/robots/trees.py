"""Random trees of joints with their own forward kinematics: robots of no package.

The kinematics are written down once more, joint by joint with SciPy's rotations, as an oracle.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

import standoff as so
from standoff.robots.geoms import Geoms
from standoff.robots.joints import JointKind, Joints

WIDTH_Q = {0: 0, 1: 1, 2: 1, 3: 4, 4: 7, 5: 2}
WIDTH_V = {0: 0, 1: 1, 2: 1, 3: 3, 4: 6, 5: 1}


class TreeKinematics:
    """Forward kinematics of a tree, one joint after the other."""

    def __init__(self, joints: Joints, geoms: Geoms) -> None:
        self.joints, self.geoms = joints, geoms
        self.nq = sum(WIDTH_Q[k] for k in joints.kinds.tolist())
        self.nv = sum(WIDTH_V[k] for k in joints.kinds.tolist())

    def check(self, q: Any) -> np.ndarray:
        q = np.asarray(q, dtype=float)
        if q.shape != (self.nq,):
            raise so.StandoffError(f"q has the shape {q.shape}: give {self.nq} numbers.", "q", q)
        if not np.isfinite(q).all():
            raise so.StandoffError("q has a NaN or infinite number.", "q", q)
        return q

    def motion(self, j: int, q: np.ndarray) -> np.ndarray:
        kind, at = int(self.joints.kinds[j]), int(self.joints.q_at[j])
        axis, pose = self.joints.axes[j], np.eye(4)
        number = self.joints.ratios[j] * q[at] + self.joints.offsets[j] if kind else 0.0
        if kind == JointKind.HINGE:
            pose[:3, :3] = Rotation.from_rotvec(number * axis).as_matrix()
        elif kind == JointKind.SLIDE:
            pose[:3, 3] = number * axis
        elif kind == JointKind.CONTINUOUS:
            angle = np.arctan2(q[at + 1], q[at])
            pose[:3, :3] = Rotation.from_rotvec(angle * axis).as_matrix()
        elif kind == JointKind.BALL:
            pose[:3, :3] = self.turn(q[at : at + 4]).as_matrix()
        elif kind == JointKind.FREE:
            pose[:3, 3] = q[at : at + 3]
            pose[:3, :3] = self.turn(q[at + 3 : at + 7]).as_matrix()
        return pose

    def turn(self, q: np.ndarray) -> Rotation:
        return Rotation.from_quat(q, scalar_first=self.joints.scalar_first)

    def links(self, q: np.ndarray) -> list[np.ndarray]:
        found: list[np.ndarray] = []
        for j, parent in enumerate(self.joints.parents.tolist()):
            before = np.eye(4) if parent < 0 else found[parent]
            found.append(before @ self.joints.placements[j] @ self.motion(j, q))
        return found

    def poses(self, q: np.ndarray) -> np.ndarray:
        links = self.links(q)
        moving = self.geoms.moving.tolist()
        return np.array(
            [links[self.geoms.joints[k]] @ self.geoms.placements[k] for k in moving]
        ).reshape(-1, 4, 4)

    def integrate(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        found = np.array(q)
        for j, kind in enumerate(self.joints.kinds.tolist()):
            at, of = int(self.joints.q_at[j]), int(self.joints.v_at[j])
            if kind in (JointKind.HINGE, JointKind.SLIDE):
                found[at] += v[of]
            elif kind == JointKind.CONTINUOUS:
                angle = np.arctan2(q[at + 1], q[at]) + v[of]
                found[at : at + 2] = np.cos(angle), np.sin(angle)
            elif kind:
                skip = 3 if kind == JointKind.FREE else 0
                found[at : at + skip] += v[of : of + skip]
                part = slice(at + skip, at + skip + 4)
                turn = self.turn(q[part]) * Rotation.from_rotvec(v[of + skip : of + skip + 3])
                found[part] = turn.as_quat(scalar_first=self.joints.scalar_first)
        return found

    def difference(self, q0: np.ndarray, q1: np.ndarray) -> np.ndarray:
        found = np.zeros(self.nv)
        for j, kind in enumerate(self.joints.kinds.tolist()):
            at, of = int(self.joints.q_at[j]), int(self.joints.v_at[j])
            if kind in (JointKind.HINGE, JointKind.SLIDE):
                found[of] = q1[at] - q0[at]
            elif kind == JointKind.CONTINUOUS:
                turn = np.arctan2(q1[at + 1], q1[at]) - np.arctan2(q0[at + 1], q0[at])
                found[of] = (turn + np.pi) % (2.0 * np.pi) - np.pi
            elif kind:
                skip = 3 if kind == JointKind.FREE else 0
                found[of : of + skip] = q1[at : at + skip] - q0[at : at + skip]
                part = slice(at + skip, at + skip + 4)
                way = (self.turn(q0[part]).inv() * self.turn(q1[part])).as_rotvec()
                found[of + skip : of + skip + 3] = way
        return found


@dataclass
class TreeRobot:
    """What of a robot the proofs read."""

    joints: Joints
    geoms: Geoms
    world: so.World
    kinematics: TreeKinematics

    @property
    def nq(self) -> int:
        return self.kinematics.nq

    @property
    def nv(self) -> int:
        return self.kinematics.nv

    @property
    def lower(self) -> np.ndarray:
        return self.joints.lower

    @property
    def upper(self) -> np.ndarray:
        return self.joints.upper

    def certify(self, *given: Any, **options: Any) -> Any:
        from standoff.robots.certify import certify

        return certify(self, *given, **options)

    def certify_box(self, *given: Any, **options: Any) -> Any:
        from standoff.robots.boxes import certify_box

        return certify_box(self, *given, **options)


def robot_of(
    kinds: list[int],
    parents: list[int],
    placements: Any,
    axes: Any,
    geoms: list[tuple[int, Any, Any]],
    *,
    fixed: dict[str, tuple[Any, Any]] | None = None,
    limit: float = np.inf,
    ignore: list[tuple[str, str]] | None = None,
    ratios: Any = None,
    scalar_first: bool = True,
) -> TreeRobot:
    """A robot of joints, geoms (joint, body, placement) named g0, g1, ..., and fixed bodies."""
    nj = len(kinds)
    q_at = np.concatenate([[0], np.cumsum([WIDTH_Q[k] for k in kinds])])
    v_at = np.concatenate([[0], np.cumsum([WIDTH_V[k] for k in kinds])])
    nq = int(q_at[-1])
    most = np.full(nq, np.inf)
    for k, at in zip(kinds, q_at.tolist(), strict=False):
        if k in (1, 2):
            most[at] = limit
    joints = Joints(
        tuple(f"j{k}" for k in range(nj)),
        np.array(kinds),
        np.array(parents),
        np.array(placements, dtype=float).reshape(-1, 4, 4),
        np.array(axes, dtype=float).reshape(-1, 3),
        q_at[:-1].astype(int),
        v_at[:-1].astype(int),
        np.ones(nj) if ratios is None else np.array(ratios, dtype=float),
        np.zeros(nj),
        -most,
        most,
        scalar_first,
    )
    fixed = fixed or {}
    names = [f"g{k}" for k in range(len(geoms))] + list(fixed)
    where = [p for _, _, p in geoms] + [pose for _, pose in fixed.values()]
    bodies = [body for _, body, _ in geoms] + [body for body, _ in fixed.values()]
    arrays = Geoms(
        tuple(names),
        tuple(f"link{j}" for j, _, _ in geoms) + tuple(fixed),
        np.array([j for j, _, _ in geoms] + [-1] * len(fixed)),
        np.array([so.Pose.of(p).matrix for p in where]).reshape(-1, 4, 4),
        tuple(bodies),
    )
    world = so.World(
        dict(zip(names, bodies, strict=True)),
        fixed={name: pose for name, (_, pose) in fixed.items()},
        ignore=ignore or [],
    )
    return TreeRobot(joints, arrays, world, TreeKinematics(joints, arrays))


def drawn_pose(rng: np.random.Generator, size: float) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, :3] = Rotation.random(random_state=rng).as_matrix()
    pose[:3, 3] = rng.uniform(-size, size, 3)
    return pose


def drawn_body(rng: np.random.Generator, size: float = 0.3) -> so.Body:
    """A sphere, capsule, box, cylinder, ellipsoid or lens."""
    a, b, c = rng.uniform(0.1 * size, size, 3)
    kind = int(rng.integers(6))
    if kind == 0:
        return so.shapes.sphere(a)
    if kind == 1:
        return so.shapes.capsule(radius=0.3 * a, length=b)
    if kind == 2:
        return so.shapes.box((a, b, c))
    if kind == 3:
        return so.shapes.cylinder(radius=0.5 * a, height=b)
    if kind == 4:
        return so.shapes.ellipsoid(0.5 * a, 0.5 * b, 0.5 * c)
    return so.shapes.lens(radius=a, offset=0.4 * a)


def drawn_axis(rng: np.random.Generator) -> np.ndarray:
    """A unit vector; half of them along x, y or z."""
    if rng.random() < 0.5:
        return np.eye(3)[rng.integers(3)] * rng.choice([-1.0, 1.0])
    axis = rng.normal(size=3)
    return axis / np.linalg.norm(axis)


def drawn_robot(
    rng: np.random.Generator, nj: int, kinds: tuple[int, ...] = (1, 1, 1, 2), fixed: int = 2
) -> TreeRobot:
    """A random tree with a geom or two on each joint, and fixed bodies; a floor in some."""
    of = [int(k) for k in rng.choice(kinds, nj)]
    parents = [int(rng.integers(-1, j)) if rng.random() < 0.4 else j - 1 for j in range(nj)]
    carriers = [j for j in range(nj) for _ in range(int(rng.integers(1, 3)))]
    geoms = [(j, drawn_body(rng), drawn_pose(rng, 0.3)) for j in carriers]
    still = {f"f{k}": (drawn_body(rng), drawn_pose(rng, 1.5)) for k in range(fixed)}
    if rng.random() < 0.3:
        still["floor"] = (so.shapes.halfspace([0.0, 0.0, 1.0], -2.0), np.eye(4))
    return robot_of(
        of,
        parents,
        [drawn_pose(rng, 0.4) for _ in range(nj)],
        [drawn_axis(rng) for _ in range(nj)],
        geoms,
        fixed=still,
        scalar_first=bool(rng.random() < 0.5),
    )


def drawn_q(rng: np.random.Generator, robot: TreeRobot, size: float = 1.5) -> np.ndarray:
    v = rng.uniform(-size, size, robot.nv)
    return robot.kinematics.integrate(neutral(robot), v)


def neutral(robot: TreeRobot) -> np.ndarray:
    q = np.zeros(robot.nq)
    for j, kind in enumerate(robot.joints.kinds.tolist()):
        at = int(robot.joints.q_at[j])
        if kind == JointKind.CONTINUOUS:
            q[at] = 1.0
        if kind in (JointKind.BALL, JointKind.FREE):
            at += 3 if kind == JointKind.FREE else 0
            q[at if robot.joints.scalar_first else at + 3] = 1.0
    return q
