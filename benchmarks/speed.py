"""Speed of an ellipsoid pair: compiled loop, calls from Python, Coal in the same run, and starts.

Run with ``python -m benchmarks.speed``. All contenders get the same frames, 1 ms apart, in turn,
several times over; what is printed is the median of the runs with the least and the greatest,
beside the greatest witness error. Poses are ready in the form that each contender takes, and no
answer is read during the timing. Then the time to a first result in a fresh process, with an
empty and with a filled cache of compiled code.
"""

from __future__ import annotations

import gc
import os
import platform
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import version
from typing import Any

import numpy as np
from numpy.typing import NDArray

import standoff as so
from benchmarks.compiled_runs import compiled_run
from benchmarks.peers import coal_request
from standoff.kernels.state import arrays as rows
from standoff_studies.paper.law_accuracy import A, B, two_ellipsoids

Array = NDArray[np.float64]

STEP = 1e-3
"""Frame time, s."""
FRAMES = 2000
RUNS = 9
LOOPS = 20
"""The compiled loop passes so many times over the frames in one run: one pass is too short."""
COLD_FRAMES = 400
"""Frames of one run of cold queries."""
WARM_STARTS = 7
COLD = "so.distance (cold)"
SEMI_AXES = ((0.52, 1.04, 0.89), (0.76, 0.52, 0.95))

FIRST_RESULT = """
import time
begun = time.perf_counter()
import numpy as np
import standoff as so
imported = time.perf_counter()
a, b = so.shapes.ellipsoid(0.52, 1.04, 0.89), so.shapes.ellipsoid(0.76, 0.52, 0.95)
place = np.eye(4)
place[0, 3] = 2.3
so.distance(a, b, np.eye(4), place)
answered = time.perf_counter()
tracker = so.Tracker(a, b)
twist = np.zeros(3), np.array([0.0, 0.0, 1.0])
state = tracker.start(np.eye(4), place, None, twist)
tracker.step(state, np.eye(4), place, None, twist)
stepped = time.perf_counter()
print(imported - begun, answered - begun, stepped - begun)
"""


@dataclass(frozen=True)
class Frames:
    """The motion in every form that a contender takes; row 0 is the start."""

    poses: list[tuple[so.Pose, so.Pose]]
    twists: list[tuple[so.Twist, so.Twist]]
    matrices: list[tuple[Array, Array]]
    pairs: list[tuple[tuple[Array, Array], tuple[Array, Array]]]
    flat_a: Array
    flat_b: Array
    twist_a: Array
    twist_b: Array


def flat(pose: so.Pose) -> Array:
    return np.concatenate([pose.rotation.ravel(), pose.translation])


def make_frames() -> Frames:
    placements = [two_ellipsoids(STEP * k) for k in range(FRAMES + 1)]
    poses = [(a[0], b[0]) for a, b in placements]
    twists = [(a[1], b[1]) for a, b in placements]
    return Frames(
        poses,
        twists,
        [(a.matrix, b.matrix) for a, b in poses],
        [((a.v, a.omega), (b.v, b.omega)) for a, b in twists],
        np.array([flat(a) for a, _ in poses]),
        np.array([flat(b) for _, b in poses]),
        np.array([np.concatenate([a.v, a.omega]) for a, _ in twists]),
        np.array([np.concatenate([b.v, b.omega]) for _, b in twists]),
    )


@dataclass(frozen=True)
class Contender:
    """``run()`` answers ``count`` frames; ``witnesses(k)`` are the points of frame k (untimed)."""

    name: str
    count: int
    run: Callable[[], None]
    witnesses: Callable[[int], tuple[Array, Array]]
    keeps: Any = None
    """What must live as long: Coal's functor does not own its shapes."""


def _points(answer: so.Proximity) -> tuple[Array, Array]:
    return answer.point_a, answer.point_b


def compiled_loop(frames: Frames, a: so.Body = A, b: so.Body = B) -> Contender:
    tracker = so.Tracker(a, b, dt=STEP)
    begin = tracker.start(*frames.poses[0], *frames.twists[0])
    motions = np.hstack([frames.flat_a, frames.flat_b, frames.twist_a, frames.twist_b])[1:]
    once, outs = compiled_run(tracker, begin, motions, np.full(FRAMES, STEP))

    def run() -> None:
        for _ in range(LOOPS):
            once()

    def witnesses(k: int) -> tuple[Array, Array]:
        row = outs[k - 1]
        return row[rows.POINT_A : rows.POINT_A + 3], row[rows.POINT_B : rows.POINT_B + 3]

    return Contender("compiled loop, a step", LOOPS * FRAMES, run, witnesses)


def python_steps(
    frames: Frames,
    name: str,
    poses: list[Any],
    twists: list[Any],
    a: so.Body = A,
    b: so.Body = B,
) -> Contender:
    tracker = so.Tracker(a, b, dt=STEP)
    begin = tracker.start(*frames.poses[0], *frames.twists[0])
    answers: list[so.Proximity] = []

    def run() -> None:
        answers.clear()
        state = begin
        for (pose_a, pose_b), (twist_a, twist_b) in zip(poses[1:], twists[1:], strict=True):
            state, answer = tracker.step(state, pose_a, pose_b, twist_a, twist_b)
            answers.append(answer)

    return Contender(name, FRAMES, run, lambda k: _points(answers[k - 1]))


def steps_in_place(frames: Frames) -> Contender:
    tracker = so.Tracker(A, B, dt=STEP)
    begin = tracker.start(*frames.poses[0], *frames.twists[0])
    kept: dict[int, tuple[Array, Array]] = {}

    def run(keep: bool = False) -> None:
        buffer = tracker.buffer(begin)
        step_into = tracker.step_into
        columns = frames.flat_a, frames.flat_b, frames.twist_a, frames.twist_b
        for k, (pose_a, pose_b, twist_a, twist_b) in enumerate(zip(*columns, strict=True)):
            if k == 0:
                continue
            buffer.pose_a[:], buffer.pose_b[:] = pose_a, pose_b
            buffer.twist_a[:], buffer.twist_b[:] = twist_a, twist_b
            step_into(buffer)
            if keep:
                kept[k] = _points(buffer.proximity())

    def witnesses(k: int) -> tuple[Array, Array]:
        if not kept:
            run(keep=True)
        return kept[k]

    return Contender("Tracker.step_into", FRAMES, run, witnesses)


def cold_queries(frames: Frames, a: so.Body = A, b: so.Body = B) -> Contender:
    chosen = frames.matrices[1 :: FRAMES // COLD_FRAMES]

    def run() -> None:
        for pose_a, pose_b in chosen:
            so.distance(a, b, pose_a, pose_b)

    def witnesses(k: int) -> tuple[Array, Array]:
        return _points(so.distance(a, b, *frames.matrices[k]))

    return Contender(COLD, len(chosen), run, witnesses)


def coal_queries(frames: Frames, name: str, tight: bool, guess: bool) -> Contender:
    """Coal's functor; ``guess`` starts each query from the last one's direction."""
    import coal

    shapes = [coal.Ellipsoid(*axes) for axes in SEMI_AXES]
    places = [
        tuple(coal.Transform3s(p.rotation, p.translation) for p in row) for row in frames.poses
    ]
    query = coal.ComputeDistance(*shapes)
    request, result = coal_request(tight), coal.DistanceResult()
    if guess:
        request.gjk_initial_guess = coal.GJKInitialGuess.CachedGuess

    def ask(place_a: Any, place_b: Any) -> None:
        result.clear()
        query(place_a, place_b, request, result)
        if guess:
            request.updateGuess(result)

    def run() -> None:
        for place_a, place_b in places[1:]:
            ask(place_a, place_b)

    def witnesses(k: int) -> tuple[Array, Array]:
        ask(*places[k - 1])
        ask(*places[k])
        return np.array(result.getNearestPoint1()), np.array(result.getNearestPoint2())

    return Contender(name, FRAMES, run, witnesses, keeps=shapes)


def contenders(frames: Frames) -> list[Contender]:
    return [
        compiled_loop(frames),
        steps_in_place(frames),
        python_steps(frames, "Tracker.step, arrays", frames.matrices, frames.pairs),
        python_steps(frames, "Tracker.step, Pose and Twist", frames.poses, frames.twists),
        cold_queries(frames),
        coal_queries(frames, "Coal, default", tight=False, guess=False),
        coal_queries(frames, "Coal, default, cached guess", tight=False, guess=True),
        coal_queries(frames, "Coal, tight", tight=True, guess=False),
        coal_queries(frames, "Coal, tight, cached guess", tight=True, guess=True),
    ]


def timed(contender: Contender) -> float:
    """Return the time of one frame, µs, in one run."""
    gc.collect()
    gc.disable()
    try:
        begun = time.perf_counter()
        contender.run()
        return 1e6 * (time.perf_counter() - begun) / contender.count
    finally:
        gc.enable()


def accuracy(contender: Contender, truth: dict[int, so.Proximity]) -> float:
    """Return the greatest witness error (length) over the frames of ``truth``."""
    worst = 0.0
    for k, known in truth.items():
        for found, expected in zip(contender.witnesses(k), _points(known), strict=True):
            worst = max(worst, float(np.linalg.norm(found - expected)))
    return worst


def race(runs: int = RUNS) -> None:
    """Time all contenders in turn and print a table."""
    frames = make_frames()
    chosen = contenders(frames)
    truth = {k: so.distance(A, B, *frames.poses[k]) for k in range(1, FRAMES + 1, 10)}
    errors = []
    for c in chosen:
        c.run()  # compiled and warm before the race, and its answers are there
        errors.append(accuracy(c, truth))
    times = np.array([[timed(c) for c in chosen] for _ in range(runs)])
    print(f"{'µs a frame, two ellipsoids':32s}{'median':>9s}{'min':>9s}{'max':>9s}   witness error")
    for c, column, error in zip(chosen, times.T, errors, strict=True):
        low, middle, high = column.min(), np.median(column), column.max()
        against = "(the reference)" if c.name == COLD else f"{error:.1e}"
        print(f"{c.name:32s}{middle:9.2f}{low:9.2f}{high:9.2f}   {against}")


def first_result(cache: str) -> tuple[Array, float]:
    """Return (import, first distance, first step) and the whole process's time, s."""
    environment = {**os.environ, "NUMBA_CACHE_DIR": cache}
    begun = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-c", FIRST_RESULT],
        env=environment,
        check=True,
        capture_output=True,
        text=True,
    )
    return np.array([float(x) for x in done.stdout.split()]), time.perf_counter() - begun


def starts(warm: int = WARM_STARTS) -> None:
    """Time the first result of a fresh process, once on an empty cache, then on the filled one."""
    with tempfile.TemporaryDirectory() as cache:
        empty, whole = first_result(cache)
        print(f"{'s, fresh process':24s}{'import':>9s}{'distance':>10s}{'step':>9s}{'process':>9s}")
        print(f"{'empty cache':24s}{empty[0]:9.2f}{empty[1]:10.2f}{empty[2]:9.2f}{whole:9.2f}")
        found = [first_result(cache) for _ in range(warm)]
    table = np.array([[*inner, outer] for inner, outer in found])
    for name, row in (
        ("filled cache, median", np.median(table, axis=0)),
        ("filled cache, min", table.min(axis=0)),
        ("filled cache, max", table.max(axis=0)),
    ):
        print(f"{name:24s}{row[0]:9.2f}{row[1]:10.2f}{row[2]:9.2f}{row[3]:9.2f}")


def main() -> None:
    versions = ", ".join(f"{name} {version(name)}" for name in ("numpy", "numba", "coal"))
    print(f"{platform.machine()}, Python {platform.python_version()}, {versions}; {RUNS} runs")
    race()
    print()
    starts()


if __name__ == "__main__":
    main()
