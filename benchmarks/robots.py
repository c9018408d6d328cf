"""``python -m benchmarks.robots``: which robots load, and their distances and rows beside others.

``--models``: the robots that packages bring along, and what became of their geometries.
``--distances N``: at N random configurations of each of several robots of exact shapes, against
Coal and MuJoCo, where a pair is apart. MuJoCo is given the poses of the geometries.
``--gradients N``: rows against central differences of our own distances at N configurations.
``--speed``: an arm of seven joints among 20 obstacles, see `benchmarks.robot_speed`.

Needs the extras ``pinocchio`` and ``mujoco``.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import standoff as so
from standoff.errors import of_extra
from standoff.robots.report import EXACT, HULL

with of_extra("MuJoCo", "mujoco"):
    import mujoco
with of_extra("Pinocchio", "pinocchio"):
    import pinocchio as pin

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "robots"))
import robot_models

Array = NDArray[np.float64]
COMPARED = ("allegro right", "romeo", "panda", "laikago", "quadruped", "a1")
"""Robots of exact shapes whose distances are compared."""
DIFFERENTIATED = ("panda", "laikago", "romeo", "allegro right", "quadruped")
STATED = 1e-6
"""What Coal (``gjk_tolerance``) and MuJoCo (``ccd_tolerance``) state of their distances, m."""
EVERY_JOINT = "tests: every joint"
"""The MJCF model of the tests with every kind of joint and exact geometry."""
TESTDATA: dict[str, tuple[str, ...]] = {
    "mujoco/testdata/model.xml": (),
    "mujoco/testdata/model.xml, its height field skipped": ("world/0",),
}
"""The model that MuJoCo's package has, and what of it is skipped."""
LONGEST_REFUSAL = 250
"""Characters of a refusal in the table."""
FAR = 10.0
"""Beyond any pair of these robots, m: MuJoCo's horizon."""
H = 1e-5
"""Step of the central differences, rad or m."""
NEAR = 0.3
"""Of pairs no farther apart rows are differentiated, m."""
LEAST_TURN = 0.9
"""Least cosine between the normals at both ends of a difference: below, the feature changed."""
ALLOWED = 1e-7
"""By how much a row may differ from differences, relative to 1."""


class Model(NamedTuple):
    """A row of the table of models."""

    name: str
    nv: int
    became: dict[str, int]
    kinds: dict[str, int]
    gap: float
    pairs: int
    refused: str


def loaded(name: str) -> so.Robot:
    """A robot by its name, or by its file among those of example-robot-data."""
    if name in robot_models.EXACT:
        robot: so.Robot = robot_models.exact_robot(name)
        return robot
    if name == EVERY_JOINT:
        return so.Robot.from_mujoco(mujoco.MjModel.from_xml_string(robot_models.MJCF))
    if name in TESTDATA:
        path = Path(mujoco.__file__).parent / "testdata" / "model.xml"
        return so.Robot.from_mujoco(path, meshes="hull", skip=TESTDATA[name])
    path = robot_models.ROBOTS / name
    try:
        return so.Robot.from_urdf(path, mimic=True, meshes="hull")
    except so.StandoffError as error:
        if "mimic" not in str(error):
            raise
        # Pinocchio does not read joints that mimic one of another branch
        return so.Robot.from_urdf(path, mimic=False, meshes="hull")


def names_of_models() -> tuple[str, ...]:
    """All robots of the table: every URDF file of example-robot-data, and those of MuJoCo."""
    files = sorted(robot_models.ROBOTS.rglob("*.urdf"))
    known = (path.relative_to(robot_models.ROBOTS).as_posix() for path in files)
    return (*known, EVERY_JOINT, *TESTDATA)


def model_row(name: str) -> Model:
    """What became of one robot; a refusal is told, not raised."""
    try:
        robot = loaded(name)
    except (so.StandoffError, FileNotFoundError) as error:
        said = " ".join(str(error).replace(f"{robot_models.ROBOTS}/", "").split())
        short = said if len(said) <= LONGEST_REFUSAL else said[:LONGEST_REFUSAL] + " ..."
        return Model(name, 0, {}, {}, 0.0, 0, short)
    geoms = robot.report().geoms
    gaps = [geom.gap for geom in geoms if geom.became == HULL]
    return Model(
        name,
        robot.nv,
        dict(Counter(geom.became for geom in geoms)),
        dict(Counter(geom.kind for geom in geoms)),
        max(gaps, default=0.0),
        len(robot.pairs),
        "",
    )


def model_lines(rows: Sequence[Model]) -> list[str]:
    """The table of models, and its sums."""
    lines = [
        "| model | nv | exact | hulls | left out | kinds | greatest gap of a hull, m | pairs |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        if row.refused:
            lines.append(f"| {row.name} | refused: {row.refused} | | | | | | |")
            continue
        out = {k: n for k, n in row.became.items() if k not in (EXACT, HULL)}
        kinds = ", ".join(f"{n} {kind}" for kind, n in sorted(row.kinds.items()))
        said = ", ".join(f"{n} {what}" for what, n in out.items()) or "0"
        exact, hulls = row.became.get(EXACT, 0), row.became.get(HULL, 0)
        lines.append(
            f"| {row.name} | {row.nv} | {exact} | {hulls} | {said} | {kinds} | {row.gap:.2g} "
            f"| {row.pairs} |"
        )
    taken = [row for row in rows if not row.refused]
    exact, hulls = (sum(row.became.get(what, 0) for row in taken) for what in (EXACT, HULL))
    lines.append(
        f"\n{len(taken)} of {len(rows)} load: {exact} exact geometries, {hulls} hulls, "
        f"{sum(row.pairs for row in taken)} pairs"
    )
    return lines


class Coal:
    """Coal's distances of a URDF robot's pairs, by one call of Pinocchio."""

    def __init__(self, name: str, pairs: Sequence[tuple[str, str]]) -> None:
        path = str(robot_models.urdf(name))
        self.model = pin.buildModelFromUrdf(path, mimic=True)
        geometry = pin.buildGeomFromUrdf(self.model, path, pin.GeometryType.COLLISION)
        for a, b in pairs:
            i, j = geometry.getGeometryId(a), geometry.getGeometryId(b)
            geometry.addCollisionPair(pin.CollisionPair(i, j))
        self.geometry = geometry
        self.data, self.places = self.model.createData(), geometry.createData()
        self.count = len(pairs)

    def distances(self, q: Array) -> Array:
        """(k,) in the order of the pairs."""
        pin.computeDistances(self.model, self.data, self.geometry, self.places, q)
        return np.array([found.min_distance for found in self.places.distanceResults])


class Mujoco:
    """MuJoCo's distances of a URDF robot's pairs: its geometries in a world, at given poses."""

    def __init__(self, robot: so.Robot, pairs: NDArray[np.int64], shapes: Sequence[Any]) -> None:
        text = "".join(geom_text(shape) for shape in shapes)
        self.model = mujoco.MjModel.from_xml_string(
            f"<mujoco><worldbody>{text}</worldbody></mujoco>"
        )
        self.data, self.robot = mujoco.MjData(self.model), robot
        self.pairs = pairs.tolist()

    def distances(self, q: Array) -> Array:
        """(k,) in the order of the pairs."""
        poses = self.robot.poses(q)
        self.data.geom_xpos[:] = poses[:, :3, 3]
        self.data.geom_xmat[:] = poses[:, :3, :3].reshape(-1, 9)
        ask, model, data = mujoco.mj_geomDistance, self.model, self.data
        return np.array([ask(model, data, i, j, FAR, None) for i, j in self.pairs])


def geom_text(shape: Any) -> str:
    """A geometry of MuJoCo from a kind and sizes of `read_shape`."""
    *size, swept = shape.size
    if swept:
        raise ValueError("MuJoCo has no swept shapes")
    if shape.kind == "box":
        half = [0.5 * x for x in size]
    elif shape.kind in ("sphere", "cylinder", "capsule"):
        half = [size[0], *(0.5 * x for x in size[1:])]
    else:
        raise ValueError(f"no size of a {shape.kind} is known here")
    return f'<geom type="{shape.kind}" size="{" ".join(map(repr, half))}"/>'


class Compared(NamedTuple):
    """Distances of one robot beside others, lengths."""

    name: str
    configurations: int
    distances: int
    uncertified: int
    gap: float
    worst: dict[str, float]
    beyond: dict[str, int]
    outside: dict[str, float]


def peers_of(name: str, robot: so.Robot, bodies: NDArray[np.int64]) -> dict[str, Any]:
    """Coal and MuJoCo over the same pairs."""
    from standoff.robots.pinocchio_shapes import read_shape

    names = robot.geoms.names
    theirs = Coal(name, [(names[i], names[j]) for i, j in bodies.tolist()])
    objects = theirs.geometry.geometryObjects
    shapes = [read_shape(objects[theirs.geometry.getGeometryId(n)].geometry) for n in names]
    return {"Coal": theirs, "MuJoCo": Mujoco(robot, bodies, shapes)}


def compared(name: str, count: int, seed: int = 0) -> Compared:
    """Distances of one robot at so many random configurations."""
    robot, rng = loaded(name), np.random.default_rng(seed)
    bodies = robot.distances(robot_models.drawn(robot, rng)).bodies
    peers = peers_of(name, robot, bodies)
    worst, outside = dict.fromkeys(peers, 0.0), dict.fromkeys(peers, 0.0)
    beyond = dict.fromkeys(peers, 0)
    number, uncertified, gap = 0, 0, 0.0
    for _ in range(count):
        q = robot_models.drawn(robot, rng)
        rows = robot.distances(q)
        apart = rows.distance > 0.0
        number += int(apart.sum())
        uncertified += int((~rows.certified).sum())
        gap = max(gap, float((rows.upper_bound - rows.lower_bound)[apart].max(initial=0.0)))
        for peer, asked in peers.items():
            theirs = asked.distances(q)
            off = np.abs(theirs - rows.distance)[apart]
            out = np.maximum(rows.lower_bound - theirs, theirs - rows.upper_bound)[apart]
            worst[peer] = max(worst[peer], float(off.max(initial=0.0)))
            outside[peer] = max(outside[peer], float(out.max(initial=0.0)))
            beyond[peer] += int((off > STATED).sum())
    return Compared(name, count, number, uncertified, gap, worst, beyond, outside)


def compared_line(row: Compared) -> str:
    """One row of the table of distances."""
    cells = [
        f"{row.worst[peer]:.1e} | {row.beyond[peer]} | {row.outside[peer]:.1e}"
        for peer in ("Coal", "MuJoCo")
    ]
    return (
        f"| {row.name} | {row.configurations} | {row.distances} | {row.uncertified} "
        f"| {row.gap:.1e} | {' | '.join(cells)} |"
    )


def compared_lines(count: int) -> Iterator[str]:
    """The table of distances."""
    theirs = "{0}: greatest difference, m | differ by > 1e-6 | outside our proven bounds by, m"
    yield (
        "| robot | configurations | distances apart | not certified | our greatest gap, m "
        f"| {theirs.format('Coal')} | {theirs.format('MuJoCo')} |"
    )
    yield "|---" * 11 + "|"
    for name in COMPARED:
        yield compared_line(compared(name, count))


class Differentiated(NamedTuple):
    """Rows of one robot against differences; errors relative to 1 or the rate."""

    name: str
    configurations: int
    entries: int
    worst: float
    beyond: int
    changed: int


def rates(robot: so.Robot, q: Array) -> tuple[Array, list[tuple[Any, Any]]]:
    """(k, nv) central differences of all distances, and the rows at both ends of each."""
    ends = []
    for way in H * np.eye(robot.nv):
        ahead, behind = (
            robot.distances(robot.kinematics.check(robot.kinematics.integrate(q, s * way)))
            for s in (1.0, -1.0)
        )
        ends.append((ahead, behind))
    found = [(ahead.distance - behind.distance) / (2.0 * H) for ahead, behind in ends]
    return np.array(found).T, ends


def changed(rows: Any, k: int, ends: tuple[Any, Any]) -> bool:
    """Does pair k touch by other features, or from another side, at either end?"""
    here = rows[k].pair
    far, near = (end[k].pair for end in ends)
    features = {(x.feature_a, x.feature_b) for x in (here, far, near)}
    return len(features) > 1 or bool(far.normal @ near.normal < LEAST_TURN)


def differentiated(name: str, count: int, seed: int = 1) -> Differentiated:
    """Smooth rows of one robot at so many random configurations against differences."""
    robot, rng = loaded(name), np.random.default_rng(seed)
    entries, worst, beyond, excluded, smooth = 0, 0.0, 0, 0, so.tracking.Smoothness.SMOOTH
    for _ in range(count):
        q = robot_models.drawn(robot, rng)
        rows = robot.distances(q)
        near = np.flatnonzero((rows.distance <= NEAR) & rows.certified).tolist()
        kept = [k for k in near if rows.flag(k).smoothness is smooth]
        rate, ends = rates(robot, q)
        off = np.abs(rate - rows.jacobian) / np.maximum(1.0, np.abs(rate))
        for k in kept:
            for dof in range(robot.nv):
                error = float(off[k, dof])
                # a row that agrees needs no look at its features
                if error > ALLOWED and changed(rows, k, ends[dof]):
                    excluded += 1
                    continue
                entries, worst = entries + 1, max(worst, error)
                beyond += error > ALLOWED
    return Differentiated(name, count, entries, worst, beyond, excluded)


def differentiated_lines(count: int) -> Iterator[str]:
    """The table of rows; the configurations are shared among the robots."""
    yield (
        "| robot | configurations | entries | greatest relative error | above 1e-7 "
        "| left out: the feature changes within the difference |"
    )
    yield "|---" * 6 + "|"
    each = -(-count // len(DIFFERENTIATED))
    for name in DIFFERENTIATED:
        row = differentiated(name, each)
        yield (
            f"| {row.name} | {row.configurations} | {row.entries} | {row.worst:.1e} "
            f"| {row.beyond} | {row.changed} |"
        )


def main(given: Sequence[str] | None = None) -> None:
    """Print the tables that are asked for."""
    reader = argparse.ArgumentParser(description="Robots: models, distances, rows and times.")
    reader.add_argument("--models", action="store_true", help="the table of models")
    reader.add_argument("--distances", type=int, metavar="N", help="configurations of each robot")
    reader.add_argument("--gradients", type=int, metavar="N", help="configurations in all")
    reader.add_argument("--speed", action="store_true", help="an arm among 20 obstacles")
    asked = reader.parse_args(given)
    parts: list[Iterator[str]] = []
    if asked.models:
        parts.append(iter(model_lines([model_row(name) for name in names_of_models()])))
    if asked.distances:
        parts.append(compared_lines(asked.distances))
    if asked.gradients:
        parts.append(differentiated_lines(asked.gradients))
    if asked.speed:
        from benchmarks.robot_speed import speed_lines

        parts.append(speed_lines())
    if not parts:
        reader.error("give --models, --distances N, --gradients N or --speed")
    for part in parts:
        begun = time.perf_counter()
        for line in part:
            print(line, flush=True)
        print(f"({time.perf_counter() - begun:.0f} s)\n", flush=True)


if __name__ == "__main__":
    main()
