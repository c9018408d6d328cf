"""An arm of seven joints among 20 obstacles: time of a call with Jacobian rows, beside others.

``python -m benchmarks.robots --speed``. One scene of spheres, capsules, cylinders and boxes in
Pinocchio and in MuJoCo; a smooth motion sampled at 1 kHz. At each sample every contender answers
once, in an order that turns, so that a busy machine is busy for all of them.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import coal
import mujoco
import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

import standoff as so
from benchmarks.robots import ALLOWED, FAR, changed, rates

Array = NDArray[np.float64]
JOINTS, OBSTACLES = 7, 20
LENGTH = 0.15
"""Of a link, m."""
RATE = 1000.0
"""Samples, 1/s; a call that takes longer than 1 / RATE misses its time."""
HORIZON = 0.1
"""Of the contenders that look at near pairs only, m."""
JUDGED = 20
"""Samples whose rows are judged by central differences."""
APART = 1e-3
"""Pairs nearer than this, or in overlap, are not judged: others' normals have no sense there, m."""


class Geom(NamedTuple):
    """A geometry: the joint that carries it (-1: the world), kind, half sizes and placement."""

    name: str
    joint: int
    kind: str
    half: tuple[float, ...]
    placement: pin.SE3


class Answer(NamedTuple):
    """Distances (k,) and rows (k, 7) of the pairs (k, 2) by the geometries' numbers."""

    pairs: NDArray[np.int64]
    distance: Array
    rows: Array


def geoms_of(rng: np.random.Generator) -> list[Geom]:
    """Seven capsules and cylinders and a ball at the tip, and the obstacles around them."""
    middle, tip = (pin.SE3(np.eye(3), np.array([0.0, 0.0, z])) for z in (0.5 * LENGTH, LENGTH))
    kinds = [("capsule", "cylinder")[k % 2] for k in range(JOINTS)]
    found = [
        Geom(f"link {k}", k, kind, (0.04, 0.4 * LENGTH), middle) for k, kind in enumerate(kinds)
    ]
    found.append(Geom("tip", JOINTS - 1, "sphere", (0.05,), tip))
    for k in range(OBSTACLES):
        away = rng.normal(size=3)
        at = rng.uniform(0.45, 1.1) * away / np.linalg.norm(away)
        turn = pin.exp3(rng.normal(size=3))
        kind, half = (
            ("sphere", (float(rng.uniform(0.03, 0.1)),)),
            ("capsule", (float(rng.uniform(0.02, 0.05)), float(rng.uniform(0.03, 0.15)))),
            ("box", tuple(rng.uniform(0.03, 0.1, 3).tolist())),
            ("cylinder", (float(rng.uniform(0.03, 0.08)), float(rng.uniform(0.03, 0.15)))),
        )[k % 4]
        found.append(Geom(f"obstacle {k}", -1, kind, half, pin.SE3(turn, at)))
    return found


def pairs_of(geoms: Sequence[Geom]) -> list[tuple[int, int]]:
    """All but those of obstacles, and of links that are one or two joints apart."""
    return [
        (i, j)
        for j in range(len(geoms))
        for i in range(j)
        if geoms[i].joint >= 0 and (geoms[j].joint < 0 or geoms[j].joint - geoms[i].joint > 2)
    ]


def axis(joint: int) -> str:
    """Joints turn about z and y in turn."""
    return "zy"[joint % 2]


def coal_shape(geom: Geom) -> Any:
    if geom.kind == "box":
        return coal.Box(*(2.0 * x for x in geom.half))
    if geom.kind == "sphere":
        return coal.Sphere(*geom.half)
    made = {"capsule": coal.Capsule, "cylinder": coal.Cylinder}[geom.kind]
    return made(geom.half[0], 2.0 * geom.half[1])


def pinocchio_models(geoms: Sequence[Geom]) -> tuple[Any, Any]:
    """The arm and its geometries with its pairs, in their order."""
    model, geometry, joint = pin.Model(), pin.GeometryModel(), 0
    for k in range(JOINTS):
        kind = {"z": pin.JointModelRZ, "y": pin.JointModelRY}[axis(k)]()
        at = pin.SE3(np.eye(3), np.array([0.0, 0.0, LENGTH if k else 0.0]))
        joint = model.addJoint(joint, kind, at, f"joint {k}")
    for geom in geoms:
        shape = coal_shape(geom)
        made = pin.GeometryObject(geom.name, geom.joint + 1, geom.placement, shape)
        geometry.addGeometryObject(made)
    for i, j in sorted(pairs_of(geoms)):
        geometry.addCollisionPair(pin.CollisionPair(i, j))
    return model, geometry


def mjcf(geoms: Sequence[Geom]) -> str:
    """The same in MuJoCo's words; links are nested bodies."""

    def text(numbers: Any) -> str:
        return " ".join(map(repr, np.asarray(numbers, dtype=float).tolist()))

    def one(geom: Geom) -> str:
        quat = pin.Quaternion(geom.placement.rotation).coeffs()
        return (
            f'<geom name="{geom.name}" type="{geom.kind}" size="{text(geom.half)}" '
            f'pos="{text(geom.placement.translation)}" quat="{text(np.roll(quat, 1))}"/>'
        )

    inner = ""
    for k in reversed(range(JOINTS)):
        shapes = "".join(one(geom) for geom in geoms if geom.joint == k)
        way = {"z": "0 0 1", "y": "0 1 0"}[axis(k)]
        at = f"0 0 {LENGTH if k else 0.0}"
        inner = f'<body pos="{at}"><joint axis="{way}"/>{shapes}{inner}</body>'
    still = "".join(one(geom) for geom in geoms if geom.joint < 0)
    return f"<mujoco><worldbody>{still}{inner}</worldbody></mujoco>"


class Cold:
    """Ours from nothing."""

    def __init__(self, robot: so.Robot) -> None:
        self.robot = robot

    def __call__(self, q: Array) -> Answer:
        rows = self.robot.distances(q)
        return Answer(rows.bodies, rows.distance, rows.jacobian)


class Warm:
    """Ours from the sample before."""

    def __init__(self, robot: so.Robot) -> None:
        self.robot = robot
        self.state: Any = None

    def __call__(self, q: Array) -> Answer:
        if self.state is None:
            self.state = self.robot.start(q)
        self.state, rows = self.robot.step(self.state, q)
        return Answer(rows.bodies, rows.distance, rows.jacobian)


class PinocchioCoal:
    """``computeDistances`` and ``computeJointJacobians``; the rows of all pairs at once."""

    def __init__(self, geoms: Sequence[Geom]) -> None:
        self.model, self.geometry = pinocchio_models(geoms)
        self.data, self.places = self.model.createData(), self.geometry.createData()
        self.pairs = np.array(sorted(pairs_of(geoms)))
        # the last row is of what stands still
        above = np.concatenate([np.tri(JOINTS), np.zeros((1, JOINTS))])
        moves = above[[geom.joint for geom in geoms]]
        self.signs = moves[self.pairs[:, 1]] - moves[self.pairs[:, 0]]

    def __call__(self, q: Array) -> Answer:
        pin.computeDistances(self.model, self.data, self.geometry, self.places, q)
        screws = pin.computeJointJacobians(self.model, self.data, q)
        found = [
            (x.min_distance, x.getNearestPoint1(), x.getNearestPoint2(), x.normal)
            for x in self.places.distanceResults
        ]
        distance, first, second, normal = (np.array(x) for x in zip(*found, strict=True))
        moment = np.cross(0.5 * (first + second), normal)
        rows = (np.concatenate([normal, moment], axis=1) @ screws) * self.signs
        return Answer(self.pairs, distance, rows)


class Mujoco:
    """``mj_geomDistance`` of each pair, and ``mj_jac`` of each point that moves."""

    def __init__(self, geoms: Sequence[Geom], horizon: float = FAR) -> None:
        self.model = mujoco.MjModel.from_xml_string(mjcf(geoms))
        self.data, self.horizon = mujoco.MjData(self.model), horizon
        numbers = [self.model.geom(geom.name).id for geom in geoms]
        bodies = self.model.geom_bodyid.tolist()
        self.pairs = [
            (i, j, numbers[i], numbers[j], bodies[numbers[i]], bodies[numbers[j]])
            for i, j in sorted(pairs_of(geoms))
        ]

    def __call__(self, q: Array) -> Answer:
        model, data = self.model, self.data
        data.qpos[:] = q
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        ends, ahead, behind = np.empty(6), np.empty((3, JOINTS)), np.empty((3, JOINTS))
        pairs, distances, rows = [], [], []
        for i, j, first, second, body_a, body_b in self.pairs:
            d = mujoco.mj_geomDistance(model, data, first, second, self.horizon, ends)
            if d >= self.horizon:
                continue
            normal = (ends[3:] - ends[:3]) / d
            mujoco.mj_jac(model, data, behind, None, ends[:3], body_a)
            row = -(normal @ behind)
            if body_b:
                mujoco.mj_jac(model, data, ahead, None, ends[3:], body_b)
                row += normal @ ahead
            pairs.append((i, j))
            distances.append(d)
            rows.append(row)
        shape = (len(pairs), JOINTS)
        return Answer(np.array(pairs), np.array(distances), np.array(rows).reshape(shape))


def contenders(geoms: Sequence[Geom]) -> dict[str, Any]:
    """All by name: of all pairs, and of those within the horizon."""
    every = so.Robot.from_pinocchio(*pinocchio_models(geoms))
    near = so.Robot.from_pinocchio(*pinocchio_models(geoms), within=HORIZON)
    return {
        "Standoff, distances": Cold(every),
        "Standoff, step": Warm(every),
        "Pinocchio + Coal": PinocchioCoal(geoms),
        "MuJoCo": Mujoco(geoms),
        f"Standoff, distances, within {HORIZON} m": Cold(near),
        f"Standoff, step, within {HORIZON} m": Warm(near),
        f"MuJoCo, within {HORIZON} m": Mujoco(geoms, HORIZON),
    }


def motion(rng: np.random.Generator, samples: int) -> Array:
    """(samples, 7): each joint swings by its own period, at about 1 rad/s at most."""
    t = np.arange(samples)[:, None] / RATE
    middle, speed = rng.uniform(-1.5, 1.5, JOINTS), rng.uniform(0.5, 1.5, JOINTS)
    return np.asarray(middle + np.sin(speed * t + rng.uniform(0.0, 6.0, JOINTS)) * 0.8)


def timed(ask: dict[str, Any], path: Array) -> dict[str, Array]:
    """Seconds of each contender at each sample, the order turned by one each time."""
    names = list(ask)
    found = {name: np.empty(len(path)) for name in names}
    for name in names:
        for q in path[:3]:
            ask[name](q)
    for k, q in enumerate(path):
        turn = k % len(names)
        for name in names[turn:] + names[:turn]:
            begun = time.perf_counter()
            ask[name](q)
            found[name][k] = time.perf_counter() - begun
    return found


class Errors(NamedTuple):
    """Greatest errors: of distances outside the proven bounds, m, and of rows relative to 1."""

    distance: float
    row: float


def judged(ask: dict[str, Any], robot: so.Robot, path: Array) -> dict[str, Errors]:
    """Distances by our proven bounds, rows by central differences, at some of the samples."""
    worst = {name: Errors(0.0, 0.0) for name in ask}
    for q in path[:: max(1, len(path) // JUDGED)]:
        truth, (rate, ends) = robot.distances(q), rates(robot, q)
        order = {tuple(pair): k for k, pair in enumerate(truth.bodies.tolist())}
        for name, contender in ask.items():
            found = contender(q)
            at = np.array([order[tuple(pair)] for pair in found.pairs.tolist()], dtype=int)
            apart = truth.distance[at] > APART
            low, high = truth.lower_bound[at], truth.upper_bound[at]
            out = np.maximum(low - found.distance, found.distance - high)[apart]
            off = np.abs(found.rows - rate[at])
            off[~apart] = 0.0
            for k, dof in np.argwhere(off > ALLOWED).tolist():
                if not truth.flag(at[k]).smooth or changed(truth, int(at[k]), ends[dof]):
                    off[k, dof] = 0.0
            before = worst[name]
            worst[name] = Errors(
                max(before.distance, float(out.max(initial=0.0))),
                max(before.row, float(off.max(initial=0.0))),
            )
    return worst


def speed_lines(samples: int = 1000, seed: int = 0) -> Iterator[str]:
    """The table of times."""
    rng = np.random.default_rng(seed)
    geoms = geoms_of(rng)
    path, ask = motion(rng, samples), contenders(geoms)
    times = timed(ask, path)
    robot = so.Robot.from_pinocchio(*pinocchio_models(geoms))
    errors = judged(ask, robot, path)
    yield (
        f"{JOINTS} joints, {len(geoms) - OBSTACLES} geometries and {OBSTACLES} obstacles, "
        f"{len(pairs_of(geoms))} pairs, {samples} samples of a motion at 1 kHz"
    )
    yield (
        "| contender | median, ms | 99 %, ms | calls above 1 ms | rows a call "
        "| distance outside the proven bounds, m | row's error |"
    )
    yield "|---" * 7 + "|"
    for name, seconds in times.items():
        late = 100.0 * float(np.mean(seconds > 1.0 / RATE))
        yield (
            f"| {name} | {1e3 * np.median(seconds):.3f} | {1e3 * np.quantile(seconds, 0.99):.3f} "
            f"| {late:.1f} % | {len(ask[name](path[-1]).pairs)} "
            f"| {errors[name].distance:.1e} | {errors[name].row:.1e} |"
        )
