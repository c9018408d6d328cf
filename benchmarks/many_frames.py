"""Frames of many pairs of ellipsoids, in lanes and one by one: a part of `benchmarks.lanes`.

The compiled loop of `Tracker.step_many` from one block of memory to another, and frames of a world
of different ellipsoids. One by one they are made where there is a horizon, which nothing is beyond:
to look at it is a small part of such a frame.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import standoff as so
from benchmarks.many_poses import taken
from standoff.kernels.entries import tracker as kernels
from standoff.kernels.pair.polytope_layout import N_POLYTOPE
from standoff.kernels.state import arrays as K
from standoff.tracking.threads import in_parts

Array = NDArray[np.float64]
SIZES = (32, 1_000, 10_000, 100_000)
STARTED = 1_000
"""States that are started one by one; more are copies."""
BEYOND_ALL = so.PredictorCorrector(within=1e6)
WAY = 1e-3
SIDE = 10
"""Bodies along each side of the world."""


class Rows:
    """The compiled loop over n states, with what it reads and writes."""

    def __init__(self, tracker: so.Tracker, poses: Array, n: int) -> None:
        self.table = tracker.table
        few = tracker.start_many(np.eye(4), poses)
        self.old = np.resize(few.blocks, (n, K.N_BLOCK))
        self.kept = np.zeros((n, N_POLYTOPE))
        self.new, self.own = np.empty_like(self.old), np.zeros_like(self.kept)
        self.poses = np.resize(poses, (n, 4, 4))
        self.poses[:, :3, 3] += WAY
        self.rest, self.steps = np.tile(np.eye(4), (n, 1, 1)), np.full(n, 1e-3)
        self.none = np.full((n, 1), K.NOT_GIVEN)

    def run(self, workers: int = 1) -> None:
        given = self.rest, self.poses, self.none, self.none, self.steps
        records = self.old, self.kept, self.new, self.own

        def part(first: int, end: int) -> None:
            kernels.value_of_each(self.table.address, *given, (first, end), records)

        in_parts(part, len(self.new), workers)


def drawn(n: int, reach: tuple[float, float]) -> Array:
    """Random poses (n, 4, 4) at distances in a range from the origin."""
    rng = np.random.default_rng(1)
    poses = np.tile(np.eye(4), (n, 1, 1))
    poses[:, :3, :3] = Rotation.random(n, random_state=rng).as_matrix()
    way = rng.normal(size=(n, 3))
    poses[:, :3, 3] = way * (rng.uniform(*reach, size=n) / np.linalg.norm(way, axis=1))[:, None]
    return poses


def of_states(name: str, axes: Any) -> Iterator[str]:
    """Lines about the frames of many states of one pair."""
    a, b = (so.shapes.ellipsoid(*x) for x in axes)
    reach = 1.05 * (max(axes[0]) + max(axes[1])), 4.0
    for n in SIZES:
        poses = drawn(min(n, STARTED), reach)
        lanes = Rows(so.Tracker(a, b), poses, n)
        single = Rows(so.Tracker(a, b, law=BEYOND_ALL), poses, n)
        found = taken({"lanes": lanes.run, "two": partial(lanes.run, 2), "one": single.run})
        miss = abs(lanes.new[:, K.DISTANCE] - single.new[:, K.DISTANCE]).max() / (a.size + b.size)
        yield (
            f"frames of {name}, {n:,} states: {1e9 * found['lanes'] / n:.0f} ns in lanes, "
            f"{1e9 * found['one'] / n:.0f} ns one by one ({found['one'] / found['lanes']:.2f} "
            f"times), two threads {found['lanes'] / found['two']:.2f} times, distances differ by "
            f"{miss:.1e} of the size"
        )


def of_a_world(shapes: Mapping[str, Any]) -> str:
    """A line about a world of different ellipsoids, all of which are apart."""
    axes = [tuple(0.5 * y for y in x) for pair in shapes.values() for x in pair]
    made = [so.shapes.ellipsoid(*x) for x in axes]
    n, rng = SIDE**3, np.random.default_rng(1)
    poses = drawn(n, (1.0, 1.0))
    grid = np.stack(np.meshgrid(*[np.arange(SIDE)] * 3), -1).reshape(-1, 3)
    poses[:, :3, 3] = 1.1 * grid
    ways = 2e-3 * rng.normal(size=(n, 3))
    path = [poses]
    for _ in range(20):
        path.append(path[-1].copy())
        path[-1][:, :3, 3] += 0.05 * ways
    world = so.World({f"b{k}": made[k % len(made)] for k in range(n)}, within=0.35, dt=2e-3)
    begun, _ = world.step(world.start(path[0]), path[1])

    def frames() -> int:
        state, near = begun, 0
        for one in path[2:]:
            state, answer = world.step(state, one)
            near += len(answer.pairs)
        return near

    seconds, near = taken({"all": frames})["all"], frames()
    return (
        f"a world of {n:,} different ellipsoids: {1e6 * seconds / near:.2f} us for each of "
        f"{near / (len(path) - 2):.0f} near pairs, all of the frame counted"
    )


def told(shapes: Mapping[str, Any]) -> Iterator[str]:
    """Lines for a reader."""
    for name, axes in shapes.items():
        yield from of_states(name, axes)
    yield of_a_world(shapes)
