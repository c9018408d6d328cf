"""``python -m benchmarks.many_poses``: what many poses cost, and a frame whose normal is read.

`so.distances` beside the kernels it calls, threads, single precision, refused rows; and one frame
with its distance and normal by `Tracker.step` and by `Tracker.step_into`; and a frame of each of
4096 states. In turn, medians.
"""

from __future__ import annotations

import statistics
import time
import warnings
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import standoff as so
from standoff.errors import RefusedRowsWarning
from standoff.kernels.entries import batch
from standoff.kernels.state import arrays as K

ROWS = 100_000
FRAMES = 2000
STATES = 4096
ROUNDS = 5
EACH, TOGETHER = "step, one state after another", "step_many"
STEP, INTO = "step, distance and normal", "step_into, distance and buffer.normal"


def drawn(n: int) -> NDArray[np.float64]:
    """Random poses, about a tenth of which let the bodies overlap."""
    rng = np.random.default_rng(0)
    poses = np.tile(np.eye(4), (n, 1, 1))
    poses[:, :3, :3] = Rotation.random(n, random_state=rng).as_matrix()
    poses[:, :3, 3] = rng.uniform(-2.0, 2.0, size=(n, 3))
    return poses


def along(n: int) -> NDArray[np.float64]:
    """Poses of a motion: 2 mrad and a thousandth of the size from row to row."""
    poses = np.tile(np.eye(4), (n, 1, 1))
    angles = 2e-3 * np.arange(n)
    poses[:, :3, :3] = Rotation.from_rotvec(np.outer(angles, [0.0, 0.0, 1.0])).as_matrix()
    poses[:, 0, 3], poses[:, 1, 3] = 1.6 * np.cos(angles), 1.6 * np.sin(angles)
    return poses


def taken(calls: dict[str, Callable[[], object]]) -> dict[str, float]:
    """Seconds of each call, medians of rounds in turn."""
    times: dict[str, list[float]] = {name: [] for name in calls}
    for call in calls.values():
        call()
    for _ in range(ROUNDS):
        for name, call in calls.items():
            begun = time.perf_counter()
            call()
            times[name].append(time.perf_counter() - begun)
    return {name: statistics.median(found) for name, found in times.items()}


def read_frames() -> dict[str, Callable[[], object]]:
    """Frames of two ellipsoids, each with new poses, whose distance and normal are read."""
    tracker = so.Tracker(so.shapes.ellipsoid(0.52, 1.04, 0.89), so.shapes.ellipsoid(0.15, 0.3, 0.2))
    rest, still, twist = np.eye(4), np.zeros(6), np.array([0.0, 2.0, 0.0, 0.0, 0.0, 2.0])
    poses = list(along(FRAMES))
    begin = tracker.start(rest, poses[0], still, twist)

    def step() -> float:
        state, total, one = begin, 0.0, tracker.step
        for pose in poses:
            state, answer = one(state, rest, pose, still, twist)
            total += answer.distance * answer.normal[0]
        return total

    def step_into() -> float:
        buffer, total, one = tracker.buffer(begin), 0.0, tracker.step_into
        for pose in poses:
            total += one(buffer, rest, pose, still, twist) * buffer.normal[0]
        return total

    def as_object() -> float:
        buffer, total, one = tracker.buffer(begin), 0.0, tracker.step_into
        for pose in poses:
            total += one(buffer, rest, pose, still, twist) * buffer.proximity().normal[0]
        return total

    if not step() == step_into() == as_object():
        raise RuntimeError("a frame in place answers otherwise")
    return {STEP: step, INTO: step_into, "step_into, proximity().normal": as_object}


def many_states() -> dict[str, Callable[[], object]]:
    """Frames of many states of one tracker, lens and ellipsoid, each moved by a thousandth."""
    tracker = so.Tracker(so.shapes.lens(1.0, 0.45), so.shapes.ellipsoid(0.15, 0.30, 0.20))
    rest, poses = np.eye(4), drawn(STATES)
    way = poses[:, :3, 3] / np.linalg.norm(poses[:, :3, 3], axis=1)[:, None]
    poses[:, :3, 3] = way * np.linspace(1.5, 2.0, STATES)[:, None]
    states, moved = tracker.start_many(rest, poses), poses.copy()
    moved[:, :3, 3] += 1e-3
    alone = [states[k] for k in range(STATES)]

    def one_by_one() -> object:
        return [tracker.step(x, rest, pose) for x, pose in zip(alone, moved, strict=True)]

    return {
        EACH: one_by_one,
        TOGETHER: lambda: tracker.step_many(states, rest, moved),
        f"{TOGETHER}, two workers": lambda: tracker.step_many(states, rest, moved, workers=2),
        "so.distances of the same rows": lambda: so.distances(tracker.a, tracker.b, rest, moved),
    }


def main() -> None:
    """Print microseconds a row, and ratios."""
    warnings.simplefilter("ignore", RefusedRowsWarning)
    a, b = so.shapes.lens(1.0, 0.45), so.shapes.ellipsoid(0.15, 0.30, 0.20)
    rest, random, motion = np.eye(4)[None], drawn(ROWS), along(ROWS)
    single, singles, wrong = random.astype(np.float32), motion.astype(np.float32), 1.01 * random
    tracker = so.Tracker(a, b)
    rows, done = np.empty((ROWS, K.N_OUT)), np.zeros(ROWS, dtype=np.int64)
    table, which = tracker.table.numbers.ravel(), np.zeros(1, dtype=np.int64)
    begin = tracker.start(rest[0], motion[0])
    found = taken(
        {
            "cold kernel": lambda: batch.starts(table, which, rest, random, 0, ROWS, rows, done),
            "so.distances": lambda: so.distances(a, b, rest, random),
            "so.distances, two workers": lambda: so.distances(a, b, rest, random, workers=2),
            "tracker.run": lambda: tracker.run(begin, rest, motion[1:]),
            "so.distances, warm": lambda: so.distances(a, b, rest, motion, warm=True),
            "so.distances, float32": lambda: so.distances(a, b, rest, single),
            "so.distances, warm, float32": lambda: so.distances(a, b, rest, singles, warm=True),
            "tracker.run, float32": lambda: tracker.run(begin, rest, singles[1:]),
            "refused rows": lambda: so.distances(a, b, rest, wrong),
        }
    )
    for name, seconds in found.items():
        print(f"{name}: {1e6 * seconds / ROWS:.2f} us a row")
    for one, other in (
        ("so.distances", "cold kernel"),
        ("so.distances", "so.distances, two workers"),
        ("so.distances, warm", "tracker.run"),
        ("so.distances, float32", "so.distances"),
        ("so.distances, warm, float32", "so.distances, warm"),
        ("tracker.run, float32", "tracker.run"),
    ):
        print(f"{one} over {other}: {found[one] / found[other]:.2f}")
    found = taken(read_frames())
    for name, seconds in found.items():
        print(f"{name}: {1e6 * seconds / FRAMES:.2f} us a frame")
    print(f"{INTO} over {STEP}: {found[INTO] / found[STEP]:.2f}")
    found = taken(many_states())
    for name, seconds in found.items():
        print(f"{name}: {1e6 * seconds / STATES:.2f} us a row")
    print(f"{EACH} over {TOGETHER}: {found[EACH] / found[TOGETHER]:.2f}")


if __name__ == "__main__":
    main()
