"""``python -m benchmarks.robot_limits``: limits of inverse kinematics, ours beside theirs.

* mink: a seven-joint arm among twenty obstacles goes to random targets, with mink's own limit and
  with `so.robots.MinkLimit`, the same pairs, 5 mm, gain and horizon. Mink divides the right side
  by dt although its unknown is the way of a step, so its own limit holds back only in the last
  step; it is also run with the gain that undoes this (gain x dt).
* Pink: two arms of balls, capsules and ellipsoids change sides, as in its kukas_self_collision,
  with `SelfCollisionBarrier` and with `so.robots.PinkBarrier`.
* mj_geomDistance against the proven bound: random convex meshes, centimetres to decimetres apart,
  as in mujoco#3383.

The least true distance is the exact one, looked for after every step over the same pairs.
Options: --quick (a fifth of the targets).
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Callable
from typing import Any, NamedTuple

import coal
import mink
import mujoco
import numpy as np
import pink
import pinocchio as pin
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import standoff as so
from standoff.robots import MinkLimit, PinkBarrier

Array = NDArray[np.float64]
MINIMUM = 5e-3
WITHIN = 0.1
DT = 1e-2
SPEED = 1.5
"""Greatest speed of a joint, rad/s."""


class Row(NamedTuple):
    """One run: the time of a step, what it came to, and how often."""

    name: str
    median: float
    least: float
    below: int
    overlaps: int
    unsolved: int
    steps: int


def told(rows: list[Row]) -> None:
    print("| | a step, µs | least distance, mm | below the minimum | in overlap | no solution |")
    print("|---|---|---|---|---|---|")
    for row in rows:
        print(
            f"| {row.name} | {1e6 * row.median:.0f} | {1e3 * row.least:.2f} | "
            f"{row.below} of {row.steps} | {row.overlaps} | {row.unsolved} |",
            flush=True,
        )


def arm_among_obstacles(rng: np.random.Generator) -> Any:
    """Seven hinges with capsules and ellipsoids; twenty fixed obstacles around them."""
    kinds = ("ellipsoid", "capsule", "box", "sphere", "cylinder")
    obstacles = ""
    while obstacles.count("<geom") < 20:
        at = rng.uniform([-0.9, -0.9, 0.0], [0.9, 0.9, 1.3])
        if np.hypot(*at[:2]) < 0.35:
            continue
        size, turn = rng.uniform(0.03, 0.1, 3), rng.uniform(-180.0, 180.0, 3)
        kind = kinds[obstacles.count("<geom") % 5]
        obstacles += (
            f'<geom name="o{obstacles.count("<geom")}" type="{kind}" size="{_text(size)}" '
            f'pos="{_text(at)}" euler="{_text(turn)}"/>'
        )
    body, close = "", ""
    for k, axis in enumerate(("0 0 1", "0 1 0") * 3 + ("0 0 1",)):
        shape = ("capsule", "0.05 0.07") if k % 2 else ("ellipsoid", "0.06 0.05 0.12")
        body += (
            f'<body pos="0 0 {0.1 if k == 0 else 0.18}">'
            f'<joint name="j{k}" axis="{axis}" range="-160 160"/>'
            f'<geom name="g{k}" type="{shape[0]}" size="{shape[1]}" pos="0 0 0.09"/>'
        )
        close += "</body>"
    tip = '<site name="tip" pos="0 0 0.2"/>'
    # mink passes by pairs of the world and its children: hence the pedestal
    return mujoco.MjModel.from_xml_string(
        f'<mujoco><worldbody>{obstacles}<body name="pedestal">{body}{tip}{close}</body>'
        "</worldbody></mujoco>"
    )


def _text(numbers: Any) -> str:
    return " ".join(f"{x:.4f}" for x in numbers)


def start_of(robot: so.Robot, rng: np.random.Generator) -> Array:
    """A configuration that keeps the minimum."""
    while True:
        q = rng.uniform(robot.lower, robot.upper)
        if robot.clearance(q).lower_bound > 2.0 * MINIMUM:
            return q


def with_mink(name: str, model: Any, robot: so.Robot, limit: Any, targets: int) -> Row:
    """Random targets, one after the other, a second and a half each."""
    rng = np.random.default_rng(7)
    speeds = mink.VelocityLimit(model, {f"j{k}": SPEED for k in range(7)})
    limits = [mink.ConfigurationLimit(model), speeds, *([limit] if limit is not None else [])]
    task = mink.FrameTask("tip", "site", position_cost=1.0, orientation_cost=0.0, lm_damping=1e-4)
    times, found = [], []
    unsolved = 0
    for _ in range(targets):
        state = mink.Configuration(model, q=start_of(robot, rng))
        task.set_target(mink.SE3.from_translation(rng.uniform([-0.8, -0.8, 0.1], [0.8, 0.8, 1.2])))
        for _ in range(150):
            begun = time.perf_counter()
            try:
                v = mink.solve_ik(state, [task], DT, "daqp", damping=1e-6, limits=limits)
            except mink.NoSolutionFound:
                v, unsolved = np.zeros(model.nv), unsolved + 1
            times.append(time.perf_counter() - begun)
            state.integrate_inplace(v, DT)
            found.append(robot.clearance(state.q).distance)
    return row_of(name, times, found, unsolved, MINIMUM)


def row_of(name: str, times: list[float], found: list[float], unsolved: int, minimum: float) -> Row:
    least = np.array(found)
    # a tenth of a millimetre is what the curvature within a step may take
    below = int((least < minimum - 1e-4).sum())
    overlaps = int((least < 0.0).sum())
    median = statistics.median(times)
    return Row(name, median, float(least.min()), below, overlaps, unsolved, len(found))


def mink_table(targets: int) -> None:
    model = arm_among_obstacles(np.random.default_rng(3))
    robot = so.Robot.from_mujoco(model)
    geoms = [model.geom(k).name for k in range(model.ngeom)]
    own: Callable[[float], Any] = lambda gain: mink.CollisionAvoidanceLimit(  # noqa: E731
        model,
        [(geoms, geoms)],
        gain=gain,
        minimum_distance_from_collisions=MINIMUM,
        collision_detection_distance=WITHIN,
    )
    pairs = len(own(0.5).geom_id_pairs)
    ours = MinkLimit(robot, MINIMUM, gain=0.5, within=WITHIN)
    print(f"\nmink, a seven-joint arm, twenty obstacles, {len(robot.pairs)} pairs (mink: {pairs})")
    told(
        [
            with_mink("no limit", model, robot, None, targets),
            with_mink("mink's", model, robot, own(0.5), targets),
            with_mink("mink's, gain x dt", model, robot, own(0.5 * DT), targets),
            with_mink("ours", model, robot, ours, targets),
        ]
    )


def two_arms() -> tuple[pin.Model, pin.GeometryModel]:
    """Two arms of seven hinges, with an ellipsoid on each link."""
    model, geometry = pin.Model(), pin.GeometryModel()
    for side, y in (("left", 0.2), ("right", -0.2)):
        joint, at = 0, pin.SE3(np.eye(3), np.array([0.0, y, 0.15]))
        for k in range(7):
            kind = pin.JointModelRY() if k % 2 else pin.JointModelRZ()
            limits = [np.full(1, x) for x in (50.0, 2.0, -2.8, 2.8)]
            joint = model.addJoint(joint, kind, at, f"{side}_{k}", *limits)
            at = pin.SE3(np.eye(3), np.array([0.0, 0.0, 0.2]))
            middle = pin.SE3(np.eye(3), np.array([0.0, 0.0, 0.1]))
            shape = coal.Ellipsoid(0.07, 0.06, 0.12)
            geometry.addGeometryObject(pin.GeometryObject(f"{side}_{k}", joint, 0, middle, shape))
        model.addFrame(pin.Frame(f"{side}_tip", joint, 0, at, pin.FrameType.OP_FRAME))
    for i in range(geometry.ngeoms):
        for j in range(i + 1, geometry.ngeoms):
            apart = (i < 7) != (j < 7)
            if apart or j - i > 2:
                geometry.addCollisionPair(pin.CollisionPair(i, j))
    return model, geometry


def with_pink(name: str, models: Any, robot: so.Robot, barrier: Any, turns: int) -> Row:
    """The tips change sides, at 50 Hz."""
    model, geometry = models
    q = np.array([0.0, 0.6, 0.0, 1.0, 0.0, 0.8, 0.0] * 2)
    state = pink.Configuration(
        model,
        model.createData(),
        q,
        collision_model=geometry,
        collision_data=geometry.createData(),
    )
    tips = [
        pink.tasks.FrameTask(f"{side}_tip", position_cost=50.0, orientation_cost=0.0)
        for side in ("left", "right")
    ]
    tasks = [*tips, pink.tasks.PostureTask(cost=1e-3)]
    for task in tasks:
        task.set_target_from_configuration(state)
    first, second = np.array([0.39, 0.39, 0.6]), np.array([0.39, -0.39, 0.6])
    times, found, unsolved = [], [], 0
    for t in np.arange(0.0, turns * 2.0 * np.pi, 0.02):
        part = 0.5 * (1.0 + np.cos(t))
        goals = (part * first + (1 - part) * second, part * second + (1 - part) * first)
        for tip, goal in zip(tips, goals, strict=True):
            tip.transform_target_to_world.translation[:] = goal
        begun = time.perf_counter()
        try:
            v = pink.solve_ik(
                state,
                tasks,
                0.02,
                solver="daqp",
                barriers=[barrier] if barrier is not None else [],
                damping=1e-6,
                safety_break=False,
            )
        except pink.exceptions.NoSolutionFound:
            v, unsolved = np.zeros(model.nv), unsolved + 1
        times.append(time.perf_counter() - begun)
        state.integrate_inplace(v, 0.02)
        found.append(robot.clearance(state.q).distance)
    return row_of(name, times, found, unsolved, 0.02)


def pink_table(turns: int) -> None:
    models = two_arms()
    robot = so.Robot.from_pinocchio(*models)
    n = len(robot.pairs)
    print(f"\nPink, two arms of seven joints change sides, {n} pairs, 20 mm")
    own = pink.barriers.SelfCollisionBarrier(n, gain=20.0, d_min=0.02)
    few = pink.barriers.SelfCollisionBarrier(20, gain=20.0, d_min=0.02)
    ours = PinkBarrier(robot, 0.02, n_pairs=20, gain=20.0, within=0.3)
    told(
        [
            with_pink("no barrier", models, robot, None, turns),
            with_pink("Pink's, all pairs", models, robot, own, turns),
            with_pink("Pink's, 20 nearest", models, robot, few, turns),
            with_pink("ours, 20 nearest", models, robot, ours, turns),
        ]
    )


def meshes_table(count: int) -> None:
    """mj_geomDistance of random hulls, judged by proven bounds."""
    rng = np.random.default_rng(3383)
    low, high, zero, worst, loose = 0, 0, 0, 0.0, 0.0
    models = max(1, count // 100)
    for _ in range(models):
        points = [rng.normal(size=(rng.integers(8, 40), 3)) * rng.uniform(0.02, 0.1) for _ in "ab"]
        assets = "".join(
            f'<mesh name="{n}" vertex="{_text(p.ravel())}"/>'
            for n, p in zip("ab", points, strict=True)
        )
        bodies = "".join(
            f'<body><freejoint/><geom name="{n}" type="mesh" mesh="{n}"/></body>' for n in "ab"
        )
        model = mujoco.MjModel.from_xml_string(
            f"<mujoco><asset>{assets}</asset><worldbody>{bodies}</worldbody></mujoco>"
        )
        data, robot = mujoco.MjData(model), so.Robot.from_mujoco(model, meshes="hull")
        fromto = np.zeros(6)
        done = 0
        while done < 100:
            turns = Rotation.random(2, rng=rng).as_quat(scalar_first=True)
            way = rng.normal(size=3)
            at = way / np.linalg.norm(way) * rng.uniform(0.1, 0.9)
            data.qpos[:] = np.concatenate([np.zeros(3), turns[0], at, turns[1]])
            row = robot.distances(data.qpos)[0]
            if not 0.01 < row.distance < 0.5:
                continue
            done += 1
            mujoco.mj_kinematics(model, data)
            told = mujoco.mj_geomDistance(model, data, 0, 1, 10.0, fromto)
            zero += told == 0.0
            low += told < row.lower_bound - 1e-6
            high += told > row.upper_bound + 1e-6
            worst = max(worst, row.lower_bound - told, told - row.upper_bound)
            loose = max(loose, row.upper_bound - row.lower_bound)
    print(
        f"\nmj_geomDistance {mujoco.__version__}, {100 * models} pairs of convex meshes 1 to 50 cm "
        f"apart: {zero} exactly zero, {low} below the proven bound by more than 1e-6, {high} above "
        f"it, farthest off {worst:.1e} m; our bounds are at most {loose:.1e} m apart",
        flush=True,
    )


def main() -> None:
    """Print the tables."""
    quick = "--quick" in sys.argv
    mink_table(8 if quick else 40)
    pink_table(1 if quick else 3)
    meshes_table(600 if quick else 3000)


if __name__ == "__main__":
    main()
