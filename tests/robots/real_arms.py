"""Paths of real arms, and an oracle that shares nothing with the library but the robot's file.

Of a URDF file Pinocchio has the places, and Coal the distances of shapes and of the meshes' hulls;
of a file that MuJoCo reads, it has both. What stands around is given to each by itself.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from typing import NamedTuple

import coal
import mujoco
import numpy as np
import pinocchio as pin
from robot_models import ROBOTS, drawn, urdf

import standoff as so
from standoff.robots.proof import PathProof, Verdict

SRDF = {
    "panda": "panda_description/srdf/panda.srdf",
    "ur5": "ur_description/srdf/ur5.srdf",
    "xarm7": "xarm_description/srdf/xarm7.srdf",
    "kinova": "kinova_description/srdf/kinova.srdf",
    "baxter": "baxter_description/srdf/baxter_manipulation.srdf",
}
"""Arms of a URDF file, and what their SRDF file lets out."""

MUJOCO = "panda in MuJoCo"
ARMS = (*SRDF, MUJOCO)

ACCURACY = 5e-6
"""Of Coal's and MuJoCo's distances while apart, m: each states 1e-6, Coal's were 3e-6 off here."""

FAR = 10.0
"""Beyond any pair of these arms, m: MuJoCo's horizon."""

AROUND = {
    "pole": ("capsule", (0.04, 1.2), (0.45, 0.35, 0.6)),
    "ball": ("sphere", (0.12,), (-0.35, 0.45, 0.5)),
    "crate": ("box", (0.3, 0.2, 0.4), (0.3, -0.6, 0.2)),
}
"""What stands around an arm: kind, radius and length or sides, and where, m."""


TOUCHING = [("world", "panda_link1"), ("panda_link1", "panda_link3")]
"""Links of the panda whose shapes always touch; MuJoCo knows no SRDF."""


class Arm(NamedTuple):
    """A robot, and the distances of its pairs by other packages.

    Attributes
    ----------
    robot : so.Robot
    pairs : list of (str, str)
        That the oracle judges: all that the robot watches.
    oracle : callable
        (m, n pairs) distances at configurations (m, nq); where pairs overlap at most 0.
    between : callable
        (q0, q1, s) to the configuration at the part s of the way between two.
    """

    robot: so.Robot
    pairs: list[tuple[str, str]]
    oracle: Callable[[np.ndarray], np.ndarray]
    between: Callable[[np.ndarray, np.ndarray, float], np.ndarray]

    def path(self, rng: np.random.Generator) -> np.ndarray:
        """(2 to 4, nq) waypoints within the limits."""
        robot = self.robot
        points = [drawn(robot, rng)]
        for _ in range(int(rng.integers(1, 4))):
            q = robot.kinematics.integrate(points[-1], rng.uniform(-0.6, 0.6, robot.nv))
            points.append(robot.kinematics.check(np.clip(q, robot.lower, robot.upper)))
        return np.array(points)

    def along(self, points: np.ndarray, times: np.ndarray) -> np.ndarray:
        """(m, nq): a path at times; its waypoints are at 0, 1, 2, ..."""
        first = np.minimum(times.astype(int), len(points) - 2)
        each = zip(first.tolist(), (times - first).tolist(), strict=True)
        return np.array([self.between(points[k], points[k + 1], s) for k, s in each])


class Samples(NamedTuple):
    """The least of all distances at many times of a path."""

    times: np.ndarray
    least: np.ndarray


def sampled(arm: Arm, points: np.ndarray, count: int) -> Samples:
    """What the oracle has of a path."""
    times = np.linspace(0.0, len(points) - 1.0, count)
    return Samples(times, arm.oracle(arm.along(points, times)).min(axis=1))


def wrong_in(proof: PathProof, arm: Arm, points: np.ndarray, samples: Samples) -> str:
    """What of a proof the samples speak against; empty if nothing."""
    times, least = samples
    above = proof.steps.clearance(times) - least
    if np.nanmax(above, initial=-np.inf) > ACCURACY:
        return f"{np.nanmax(above)} more is proven than there is"
    if proof.verdict is Verdict.PROVEN:
        kept = max(proof.clearance, proof.proven)
        return "" if least.min() >= kept - ACCURACY else f"{least.min()} is less than {kept}"
    before = float(least[times < proof.time].min(initial=np.inf))
    if before < proof.clearance - ACCURACY:
        return f"{before} before {proof.time}"
    if proof.verdict is Verdict.VIOLATED:
        (there,) = arm.oracle(arm.along(points, np.array([proof.latest])))
        theirs = there[arm.pairs.index(proof.witness.names)]
        if theirs >= proof.clearance + ACCURACY:
            return f"{proof.witness} at {proof.latest} are {theirs} apart"
    return ""


@cache
def arm(name: str) -> Arm:
    """One of `ARMS` among what stands around."""
    if name == MUJOCO:
        return _of_mujoco()
    obstacles = {what: (_body(*of[:2]), _placed(of[2])) for what, of in AROUND.items()}
    srdf = ROBOTS / SRDF[name]
    robot = so.Robot.from_urdf(urdf(name), srdf, mimic=True, meshes="hull", obstacles=obstacles)
    pairs = list(robot.pairs)
    oracle = _PinocchioAndCoal(name, pairs)
    return Arm(robot, pairs, oracle, partial(pin.interpolate, oracle.model))


def _placed(at: tuple[float, float, float]) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, 3] = at
    return pose


def _body(kind: str, size: tuple[float, ...]) -> so.Body:
    if kind == "capsule":
        return so.shapes.capsule(*size)
    return so.shapes.sphere(*size) if kind == "sphere" else so.shapes.box(size)


class _PinocchioAndCoal:
    """Distances at many configurations, all of a configuration in one call."""

    def __init__(self, name: str, pairs: list[tuple[str, str]]) -> None:
        path = str(urdf(name))
        self.model = pin.buildModelFromUrdf(path, mimic=True)
        geometry = pin.buildGeomFromUrdf(
            self.model, path, pin.GeometryType.COLLISION, package_dirs=[str(ROBOTS.parent.parent)]
        )
        for each in geometry.geometryObjects:
            if isinstance(each.geometry, coal.BVHModelBase):
                each.geometry.buildConvexHull(False, "Qt")
                each.geometry = each.geometry.convex
        for what, (kind, size, at) in AROUND.items():
            shape = {"capsule": coal.Capsule, "sphere": coal.Sphere, "box": coal.Box}[kind](*size)
            place = pin.SE3(np.eye(3), np.array(at))
            geometry.addGeometryObject(pin.GeometryObject(what, 0, 0, place, shape))
        for a, b in pairs:
            numbers = geometry.getGeometryId(a), geometry.getGeometryId(b)
            geometry.addCollisionPair(pin.CollisionPair(*numbers))
        self.geometry, self.count = geometry, len(pairs)
        self.data, self.places = self.model.createData(), geometry.createData()

    def __call__(self, q: np.ndarray) -> np.ndarray:
        found = np.empty((len(q), self.count))
        for row, each in zip(found, q, strict=True):
            pin.computeDistances(self.model, self.data, self.geometry, self.places, each)
            row[:] = [result.min_distance for result in self.places.distanceResults]
        return found


def _of_mujoco() -> Arm:
    """The panda of spheres and cylinders as MuJoCo reads its file."""
    spec = mujoco.MjSpec.from_file(str(urdf("panda")))
    kinds = {
        "capsule": (mujoco.mjtGeom.mjGEOM_CAPSULE, lambda r, length: (r, length / 2, 0)),
        "sphere": (mujoco.mjtGeom.mjGEOM_SPHERE, lambda r: (r, 0, 0)),
        "box": (mujoco.mjtGeom.mjGEOM_BOX, lambda *sides: [side / 2 for side in sides]),
    }
    for what, (kind, size, at) in AROUND.items():
        of, half = kinds[kind]
        spec.worldbody.add_body(pos=at).add_geom(name=what, type=of, size=half(*size))
    for a, b in TOUCHING:
        spec.add_exclude(bodyname1=a, bodyname2=b)
    model = spec.compile()
    robot = so.Robot.from_mujoco(model)
    data = mujoco.MjData(model)
    names = {each.name: k for k, each in enumerate(robot.report().geoms)}
    numbers = [(names[a], names[b]) for a, b in robot.pairs]

    def oracle(q: np.ndarray) -> np.ndarray:
        found = np.empty((len(q), len(numbers)))
        for row, each in zip(found, q, strict=True):
            data.qpos[:] = each
            mujoco.mj_kinematics(model, data)
            row[:] = [mujoco.mj_geomDistance(model, data, i, j, FAR, None) for i, j in numbers]
        return found

    return Arm(robot, list(robot.pairs), oracle, lambda a, b, s: a + s * (b - a))
