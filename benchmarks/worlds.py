"""``python -m benchmarks.worlds``: a frame of worlds of 10 to 10^4 bodies, beside others.

The same bodies and motion for all: spheres and ellipsoids, about one near pair each, at one
density, in one volume, and over one huge floor; and boxes in Broadmark's three kinds of scenes
(`world_scenes`). Medians of frames, in turn. Beside `so.World`:

* `tracker.run` of the pairs that the world tracked, over the same frames, the start not counted;
* MuJoCo: `mj_collision` with a margin of the horizon, and then `mj_geomDistance` of its pairs;
* Coal: a distance for every pair of its boxes that is near;
* python-fcl's manager and ipctk's LBVH, where they are installed: the pairs alone.

Pairs named for each that is truly within the horizon, and memory, stand beside the times.

Options: --quick (to 1,000 bodies, fewer frames), --rest (10^4 bodies at rest, alone).
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np

import standoff as so
from benchmarks.world_peers import FLOOR, WITHIN, Coal, Lbvh, MuJoCo, PythonFcl
from benchmarks.world_scenes import BROADMARK, DRIFTING, H, Scene, scene
from standoff.kernels.world import arrays as W

SIZES = (10, 100, 1000, 10_000)
FRAMES = {10: 400, 100: 200, 1000: 60, 10_000: 12}
QUICK = {10: 100, 100: 60, 1000: 24}
SAMPLED = 150
"""Pairs whose `tracker.run` is measured."""
LAST = 40
"""Frames over which the world and `tracker.run` are compared, at most: the last ones."""
SLOW = 1000
"""Bodies from which on peers that move bodies from Python are left out."""
PEERS: dict[str, Any] = {"coal": Coal, "python-fcl": PythonFcl, "lbvh": Lbvh}


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
        make = so.shapes.ellipsoid
        known = {
            axes: so.shapes.box(tuple(2.0 * x for x in axes)) if given.boxes else make(*axes)
            for axes in set(given.axes)
        }
        bodies: dict[str, Any] = {f"b{k}": known[axes] for k, axes in enumerate(given.axes)}
        fixed = {}
        if given.floor:
            bodies["floor"] = so.shapes.box(tuple(FLOOR[0]))
            fixed = {"floor": (np.eye(3), FLOOR[1])}
        self.given = given
        self.world = so.World(bodies, within=WITHIN, fixed=fixed, dt=H)
        begun = time.perf_counter()
        self.state = self.world.start(given.path[0])
        self.started = time.perf_counter() - begun
        self.kept = self.state
        self.first = max(1, len(given.path) - LAST)

    def frame(self, k: int) -> float:
        self.state, self.answer = self.world.step(self.state, self.given.path[k])
        if k == self.first - 1:
            self.kept = self.state
        return self.answer.clearance

    def tracked(self) -> list[tuple[int, int]]:
        """The pairs that were asked in the last frame."""
        ints = self.state.ints
        asked = ints[ints[:, W.I_FRAME] == self.state.frame]
        return [(int(i), int(j)) for i, j in asked[:, [W.I_A, W.I_B]]]

    def again(self) -> float:
        """Mean seconds of a frame: the last frames, from a state that was kept."""
        state, path = self.kept, self.given.path[self.first :]
        begun = time.perf_counter()
        for poses in path:
            state, answer = self.world.step(state, poses)
            answer.clearance  # noqa: B018
        return (time.perf_counter() - begun) / len(path)


class Narrow:
    """`tracker.run` over the last frames of some of the pairs that were asked."""

    def __init__(self, ours: Ours) -> None:
        given, bodies = ours.given, list(ours.world.bodies.values())
        pairs = ours.tracked()
        chosen = pairs[:: max(1, len(pairs) // SAMPLED)]
        self.share = len(pairs) / max(1, len(chosen))
        self.frames = len(given.path) - ours.first
        floor = np.eye(4)
        floor[:3, 3] = FLOOR[1]
        still = np.tile(floor, (self.frames + 1, 1, 1))
        last = given.path[ours.first - 1 :]
        self.runs = []
        for i, j in chosen:
            a, b = (last[:, x] if x < len(given.axes) else still for x in (i, j))
            tracker = so.Tracker(bodies[i], bodies[j], H)
            self.runs.append((tracker, tracker.start(a[0], b[0]), a[1:], b[1:]))

    def again(self) -> float:
        """Mean seconds of a frame of all pairs."""
        begun = time.perf_counter()
        for tracker, state, a, b in self.runs:
            tracker.run(state, a, b)
        return (time.perf_counter() - begun) / self.frames * self.share


def overhead(ours: Ours) -> tuple[float, float]:
    """Seconds of a frame of the narrow phase alone, and how much more the world takes: in turn."""
    narrow = Narrow(ours)
    if not narrow.runs:
        return 0.0, float("nan")
    turns = [(ours.again(), narrow.again()) for _ in range(5)]
    alone = statistics.median(turn[1] for turn in turns)
    return alone, statistics.median(world / one for world, one in turns)


def beside(given: Scene) -> dict[str, tuple[float, int]]:
    """Of each peer that is there, seconds of a frame and the pairs it named."""
    found: dict[str, tuple[float, int]] = {}
    frames, n = len(given.path), len(given.axes)
    try:
        rival = MuJoCo(given)
        found["mj_collision"] = timed(frames, rival.frame), 0
        seconds = timed(frames, rival.with_distances)
        found["with distances"] = seconds, rival.pairs
    except ImportError:
        pass
    for name, peer in PEERS.items():
        if n > SLOW and name != "lbvh":
            continue
        try:
            made = peer(given)
        except ImportError:
            continue
        found[name] = timed(min(frames, 12), made.frame), made.pairs
    return found


def row(given: Scene) -> str:
    """A line of the table."""
    n, frames = len(given.axes), len(given.path)
    ours = Ours(given)
    mine = timed(frames, ours.frame)
    narrow, ratio = overhead(ours)
    near, counts, state = len(ours.answer.pairs), ours.answer.counts, ours.state
    asked = counts.tracked + counts.started
    per = max(near, 1)
    of_pairs = state.ints.nbytes + state.known.nbytes + sum(page.nbytes for page in state.pages)
    peers = "; ".join(
        f"{name} {1e6 * s:.0f}" + (f" ({pairs / per:.2f})" if pairs else "")
        for name, (s, pairs) in beside(given).items()
    )
    return (
        f"{given.name:9} {n:6} bodies: {1e6 * mine:8.0f} us a frame (start "
        f"{1e3 * ours.started:.1f} ms), {near} near, {asked / per:.2f} asked and "
        f"{len(state.ints) / per:.2f} in the table for each; tracker.run {1e6 * narrow:.0f}, ratio "
        f"{ratio:.2f}; {(state.nbytes - of_pairs) / n:.0f} B a body, "
        f"{of_pairs / max(1, len(state.ints)):.0f} B a pair in the table; {peers}"
    )


def rest(n: int = 10_000) -> str:
    """Bodies that do not move."""
    given = scene("density", n, 3)
    ours = Ours(given)
    state, poses = ours.state, given.path[0]
    other, looked, compared = poses.copy(), [], []
    for _ in range(20):
        begun = time.perf_counter()
        state, _ = ours.world.step(state, poses)
        looked.append(time.perf_counter() - begun)
        begun = time.perf_counter()
        np.array_equal(poses, other)
        compared.append(time.perf_counter() - begun)
    return (
        f"at rest   {n} bodies: {1e6 * statistics.median(looked):.0f} us a frame; comparing the "
        f"poses alone {1e6 * statistics.median(compared):.0f} us"
    )


def main() -> None:
    """Print the table."""
    quick = "--quick" in sys.argv
    if "--rest" not in sys.argv:
        for name in (*DRIFTING, *BROADMARK):
            for n in SIZES[:3] if quick else SIZES:
                print(row(scene(name, n, (QUICK if quick else FRAMES)[n])), flush=True)
    print(rest())


if __name__ == "__main__":
    main()
