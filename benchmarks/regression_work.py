"""The work that `benchmarks.regression` times on each commit: a script, run with that commit's src.

Prints JSON: rows of a name, a time in the unit that the name ends with, and the answer in full.
"""

from __future__ import annotations

import gc
import json
import resource
import time
from collections.abc import Callable
from typing import Any

import numpy as np

begun = resource.getrusage(resource.RUSAGE_SELF)

import standoff as so  # noqa: E402 - what is imported and compiled is timed too

DT = 1e-3
"""Frame time, s."""
TURN, SHIFT = 2e-3, 1e-3
"""Motion of B between two frames, rad and size: what a 1 kHz loop moves by at most."""
FRAMES = 1500
REPEATS = 5
"""The least of so many is the time: what disturbs a run only adds to it."""
Rows = list[tuple[str, float, str]]


def pairs() -> dict[str, tuple[so.Body, so.Body, float]]:
    """Bodies, and how far apart their centres are."""
    tool = so.shapes.ellipsoid(0.15, 0.30, 0.20)
    ball = so.shapes.ellipsoid(0.52, 1.04, 0.89)
    egg = so.shapes.superellipsoid(0.5, 0.7, 0.9, 0.6, 1.3)
    return {
        "ellipsoids": (ball, tool, 1.7),
        "lens, ellipsoid": (so.shapes.lens(1.0, 0.45), tool, 1.6),
        "box, ellipsoid": (so.shapes.box(1.0, 0.7, 0.5), tool, 1.3),
        "boxes": (so.shapes.box(1.0, 0.7, 0.5), so.shapes.box(0.3, 0.4, 0.5), 1.4),
        "superellipsoid, capsule": (egg, so.shapes.capsule(0.2, 0.5), 1.6),
        "ellipsoids in contact": (ball, tool, 0.5),
        "boxes in contact": (so.shapes.box(1.0, 0.7, 0.5), so.shapes.box(0.3, 0.4, 0.5), 0.5),
    }


def motion(far: float, frames: int) -> tuple[np.ndarray, np.ndarray]:
    """B's poses (n, 4, 4) and twists (n, 6): round A, turning and rocking."""
    k = np.arange(frames)
    angle = TURN * k
    poses = np.tile(np.eye(4), (frames, 1, 1))
    poses[:, 0, 0] = poses[:, 1, 1] = np.cos(angle)
    poses[:, 1, 0], poses[:, 0, 1] = np.sin(angle), -np.sin(angle)
    poses[:, 0, 3], poses[:, 1, 3] = far * np.cos(angle), far * np.sin(angle)
    poses[:, 2, 3] = 0.05 * np.sin(SHIFT * k)
    rate = TURN / DT
    twists = np.zeros((frames, 6))
    twists[:, 0], twists[:, 1] = -rate * poses[:, 1, 3], rate * poses[:, 0, 3]
    twists[:, 2] = 0.05 * SHIFT / DT * np.cos(SHIFT * k)
    twists[:, 5] = rate
    return poses, twists


def least(work: Callable[[], Any], count: int) -> float:
    """Time of one of `count`, s."""
    work()
    found = []
    gc.disable()
    for _ in range(REPEATS):
        start = time.perf_counter()
        work()
        found.append((time.perf_counter() - start) / count)
    gc.enable()
    return min(found)


def compiled_frames(tracker: so.Tracker, poses: np.ndarray, twists: np.ndarray) -> Rows:
    """A frame of a compiled run, without Python."""
    from benchmarks.compiled_runs import compiled_run

    rest = np.eye(4)
    begin = tracker.start(rest, poses[0], np.zeros(6), twists[0])
    count = len(poses) - 1
    at_rest = np.r_[np.eye(3).ravel(), np.zeros(3)]
    moving = np.concatenate([poses[1:, :3, :3].reshape(count, 9), poses[1:, :3, 3]], axis=1)
    still = np.zeros((count, 6))
    motions = np.hstack([np.tile(at_rest, (count, 1)), moving, still, twists[1:]])
    run, outs = compiled_run(tracker, begin, motions, np.full(count, DT))
    time_of_one = least(run, count)
    return [("a compiled frame, ns", 1e9 * time_of_one, repr(outs[:, :13].sum()))]


def python_steps(tracker: so.Tracker, poses: np.ndarray, twists: np.ndarray) -> Rows:
    rest, still = np.eye(4), np.zeros(6)
    begin = tracker.start(rest, poses[0], still, twists[0])
    told = []

    def run() -> None:
        state = begin
        for pose, twist in zip(poses[1:], twists[1:], strict=True):
            state, answer = tracker.step(state, rest, pose, still, twist)
        told.append(answer.distance)

    return [("Tracker.step, us", 1e6 * least(run, len(poses) - 1), repr(told[-1]))]


def cold_queries(a: so.Body, b: so.Body, poses: np.ndarray) -> Rows:
    rest = np.eye(4)
    chosen = poses[:: len(poses) // 40]
    told = []

    def run() -> None:
        told.append(sum(so.distance(a, b, rest, pose).distance for pose in chosen))

    return [("so.distance, us", 1e6 * least(run, len(chosen)), repr(told[-1]))]


def processor_time() -> float:
    """Of this process since it began to import, s."""
    now = resource.getrusage(resource.RUSAGE_SELF)
    return now.ru_utime + now.ru_stime - begun.ru_utime - begun.ru_stime


def main() -> None:
    rows: Rows = []
    spent = 0.0
    for name, (a, b, far) in pairs().items():
        frames = FRAMES // 10 if "contact" in name else FRAMES
        poses, twists = motion(far, frames)
        tracker = so.Tracker(a, b, DT)
        spent = spent or processor_time()
        found = compiled_frames(tracker, poses, twists)
        found += python_steps(tracker, poses, twists) + cold_queries(a, b, poses)
        rows += [(f"{name}: {what}", taken, answer) for what, taken, answer in found]
    print(json.dumps([*rows, ("compile, s of processor", spent, "")]))


if __name__ == "__main__":
    main()
