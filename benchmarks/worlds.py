"""``python -m benchmarks.worlds``: a frame of worlds of 10 to 10^4 bodies, beside others.

The same bodies and motion for all: spheres and ellipsoids, about one near pair each, at one
density, in one volume, and over one huge floor. In turn, medians. Beside `so.World`:

* `tracker.run`'s frame, times the pairs that are open: what the narrow phase costs by itself;
* MuJoCo: `mj_collision` with a margin of the horizon, and then `mj_geomDistance` of its pairs;
* Coal: its own tree (DynamicAABBTree) with a distance for every pair that it names.

Options: --quick (to 1,000 bodies), --rest (10^4 bodies at rest).
"""

from __future__ import annotations

import contextlib
import statistics
import sys
import time
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import standoff as so

Array = NDArray[np.float64]
WITHIN = 0.2
H = 2e-3
SIZES = (10, 100, 1000, 10_000)
FRAMES = {10: 400, 100: 200, 1000: 60, 10_000: 12}
SAMPLED = 200
"""Pairs whose `tracker.run` is measured."""
AXES = ((0.3, 0.5, 0.4), (0.4, 0.4, 0.4), (0.5, 0.3, 0.2))


class Scene(NamedTuple):
    """Bodies by their semi-axes, and their poses in every frame (m, n, 4, 4)."""

    name: str
    axes: list[tuple[float, float, float]]
    path: Array
    floor: bool


def scene(name: str, n: int, frames: int) -> Scene:
    """Bodies that drift and turn; in one volume they are smaller the more there are."""
    rng = np.random.default_rng(n)
    scale = 1.0 if name != "volume" else (100.0 / n) ** (1.0 / 3.0)
    side = 1.55 * n ** (1.0 / 3.0) * scale
    axes = [tuple(scale * x for x in AXES[k % 3]) for k in range(n)]
    at = rng.uniform(-side / 2.0, side / 2.0, (n, 3))
    if name == "floor":
        at[:, 2] = rng.uniform(0.45, 0.65, n)
        at[:, :2] = rng.uniform(-0.6, 0.6, (n, 2)) * n**0.5
    speed = scale * rng.normal(size=(n, 3))
    if name == "floor":
        speed[:, 2] = 0.0
    turn = Rotation.from_rotvec(H * rng.normal(size=(n, 3))).as_matrix()
    poses = np.tile(np.eye(4), (n, 1, 1))
    poses[:, :3, :3] = Rotation.random(n, random_state=rng).as_matrix()
    path = np.empty((frames, n, 4, 4))
    for frame in path:
        at = at + H * speed
        poses[:, :3, :3] = turn @ poses[:, :3, :3]
        poses[:, :3, 3] = at
        frame[:] = poses
    return Scene(name, axes, path, name == "floor")


def timed(frames: int, frame: Callable[[int], Any]) -> float:
    """Median seconds of a frame, after the first two."""
    times = []
    for k in range(frames):
        begun = time.perf_counter()
        frame(k)
        times.append(time.perf_counter() - begun)
    return statistics.median(times[2:])


class Ours:
    """A world, frame by frame."""

    def __init__(self, given: Scene) -> None:
        known = {axes: so.shapes.ellipsoid(*axes) for axes in set(given.axes)}
        bodies: dict[str, Any] = {f"b{k}": known[axes] for k, axes in enumerate(given.axes)}
        fixed = {}
        if given.floor:
            bodies["floor"] = so.shapes.box((2000.0, 2000.0, 0.2))
            fixed = {"floor": (np.eye(3), [0.0, 0.0, -0.1])}
        self.world = so.World(bodies, within=WITHIN, fixed=fixed, dt=H)
        begun = time.perf_counter()
        self.state = self.world.start(given.path[0])
        self.started = time.perf_counter() - begun
        self.path = given.path
        self.open: list[int] = []

    def frame(self, k: int) -> float:
        self.state, self.answer = self.world.step(self.state, self.path[k])
        self.open.append(self.answer.counts.tracked)
        return self.answer.clearance


def narrow_cost(given: Scene, ours: Ours) -> float:
    """Seconds of `tracker.run` a frame, for as many pairs as the last frame tracked: of near ones,
    of which some are sampled."""
    pairs = ours.answer.pairs
    k = len(given.path) - 1
    total, frames = 0.0, min(40, k)
    for i, j in pairs.bodies[:SAMPLED].tolist():
        bodies = list(ours.world.bodies.values())
        tracker = so.Tracker(bodies[i], bodies[j], H)
        floor = np.eye(4)
        floor[2, 3] = -0.1
        paths = [
            given.path[k - frames : k + 1, x]
            if x < len(given.axes)
            else np.tile(floor, (frames + 1, 1, 1))
            for x in (i, j)
        ]
        state = tracker.start(paths[0][0], paths[1][0])
        times = []
        for _ in range(3):
            begun = time.perf_counter()
            tracker.run(state, paths[0][1:], paths[1][1:])
            times.append(time.perf_counter() - begun)
        total += min(times) / frames
    return total / max(1, min(SAMPLED, len(pairs))) * ours.answer.counts.tracked


class MuJoCo:
    """The same bodies as geoms of free bodies, with the horizon as their margin."""

    def __init__(self, given: Scene) -> None:
        import mujoco

        self.mujoco = mujoco
        spec = mujoco.MjSpec()
        spec.option.gravity = [0.0, 0.0, 0.0]
        for k, axes in enumerate(given.axes):
            body = spec.worldbody.add_body(name=f"b{k}", mocap=False)
            body.add_freejoint()
            body.add_geom(
                type=mujoco.mjtGeom.mjGEOM_ELLIPSOID, size=list(axes), margin=WITHIN, gap=WITHIN
            )
        if given.floor:
            spec.worldbody.add_geom(
                type=mujoco.mjtGeom.mjGEOM_BOX,
                size=[1000.0, 1000.0, 0.1],
                pos=[0.0, 0.0, -0.1],
                margin=WITHIN,
                gap=WITHIN,
            )
        spec.memory = 1 << 30
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        quats = Rotation.from_matrix(given.path[..., :3, :3].reshape(-1, 3, 3)).as_quat(
            scalar_first=True
        )
        self.q = np.concatenate(
            [given.path[..., :3, 3], quats.reshape(*given.path.shape[:2], 4)], axis=-1
        ).reshape(len(given.path), -1)
        self.pairs = 0

    def frame(self, k: int) -> float:
        mujoco, model, data = self.mujoco, self.model, self.data
        data.qpos[:] = self.q[k]
        mujoco.mj_kinematics(model, data)
        mujoco.mj_collision(model, data)
        return float(data.ncon)

    def with_distances(self, k: int) -> float:
        """And the distance of each pair of geoms that it found."""
        self.frame(k)
        mujoco, model, data = self.mujoco, self.model, self.data
        fromto = np.zeros(6)
        found = {tuple(pair) for pair in np.sort(data.contact.geom, axis=1).tolist()}
        self.pairs = len(found)
        least = WITHIN
        for a, b in found:
            least = min(least, mujoco.mj_geomDistance(model, data, a, b, WITHIN, fromto))
        return least


class Coal:
    """Its own tree, and its distance for every pair of it that is within the horizon."""

    def __init__(self, given: Scene) -> None:
        import coal

        self.coal = coal
        self.path = given.path
        shapes = [coal.Ellipsoid(*axes) for axes in given.axes]
        self.objects = [coal.CollisionObject(shape) for shape in shapes]
        if given.floor:
            self.objects.append(coal.CollisionObject(coal.Box(2000.0, 2000.0, 0.2)))
            self.objects[-1].setTransform(coal.Transform3s(np.eye(3), np.array([0, 0, -0.1])))
            self.objects[-1].computeAABB()
        self.n = len(given.axes)

    def frame(self, k: int) -> float:
        """All pairs whose boxes are near, by Python's sweep over its boxes: coal 3.0.3 hands no
        broad phase to Python that takes a callback of a distance."""
        coal = self.coal
        for body, pose in zip(self.objects, self.path[k], strict=False):
            body.setTransform(coal.Transform3s(pose[:3, :3], pose[:3, 3]))
            body.computeAABB()
        boxes = [body.getAABB() for body in self.objects]
        low = np.array([box.min_ for box in boxes])
        high = np.array([box.max_ for box in boxes]) + WITHIN
        order = np.argsort(low[:, 0])
        least, active = WITHIN, []
        request, result = coal.DistanceRequest(), coal.DistanceResult()
        for i in order.tolist():
            active = [j for j in active if high[j, 0] >= low[i, 0]]
            for j in active:
                if (low[i] <= high[j]).all() and (low[j] <= high[i]).all():
                    result.clear()
                    least = min(
                        least, coal.distance(self.objects[i], self.objects[j], request, result)
                    )
            active.append(i)
        return least


def row(given: Scene) -> str:
    """A line of the table."""
    n = len(given.axes)
    ours = Ours(given)
    frames = len(given.path)
    peers: dict[str, float] = {}
    mine = timed(frames, ours.frame)
    narrow = narrow_cost(given, ours)
    try:
        rival = MuJoCo(given)
        peers["mj_collision"] = timed(frames, rival.frame)
        peers["with distances"] = timed(frames, rival.with_distances)
        pairs = rival.pairs
    except ImportError:
        pairs = -1
    if n <= 1000:
        with contextlib.suppress(ImportError):
            peers["coal"] = timed(min(frames, 20), Coal(given).frame)
    near, counts = len(ours.answer.pairs), ours.answer.counts
    told = ", ".join(f"{name} {1e6 * s:.0f}" for name, s in peers.items())
    per_body = ours.state.nbytes / n
    return (
        f"{given.name:8} {n:6} bodies: {1e6 * mine:9.0f} us a frame (start {1e3 * ours.started:.1f}"
        f" ms), {near} near, {counts.open} open, {counts.bounded} by bounds, {counts.sought} sought"
        f"; narrow phase alone {1e6 * narrow:.0f} us, ratio {mine / max(narrow, 1e-9):.2f};"
        f" {per_body:.0f} B a body; {told} us ({pairs} pairs)"
    )


def rest() -> str:
    """Ten thousand bodies that do not move."""
    given = scene("density", 10_000, 3)
    ours = Ours(given)
    state = ours.state
    poses = given.path[0]
    times = []
    for _ in range(20):
        begun = time.perf_counter()
        state, _ = ours.world.step(state, poses)
        times.append(time.perf_counter() - begun)
    compared = []
    other = poses.copy()
    for _ in range(20):
        begun = time.perf_counter()
        np.array_equal(poses, other)
        compared.append(time.perf_counter() - begun)
    look, least = statistics.median(times), statistics.median(compared)
    return (
        f"at rest   10000 bodies: {1e6 * look:.0f} us a frame; comparing the poses alone "
        f"{1e6 * least:.0f} us"
    )


def main() -> None:
    """Print the table."""
    sizes = SIZES[:3] if "--quick" in sys.argv else SIZES
    for name in ("density", "volume", "floor"):
        for n in sizes:
            print(row(scene(name, n, FRAMES[n])), flush=True)
    if "--rest" in sys.argv or "--quick" not in sys.argv:
        print(rest())


if __name__ == "__main__":
    main()
