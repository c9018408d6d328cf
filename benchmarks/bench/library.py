"""The library's own contenders: every way to ask it, with the poses (4, 4) read in the time."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

import standoff as so
from benchmarks.bench.contender import Contender, Found, asked
from benchmarks.bench.motion import DT, Frames, Pair
from benchmarks.compiled_runs import compiled_run as runs_compiled
from standoff.kernels.state import arrays as rows
from standoff_studies.paper.law_accuracy import LAWS, Followed

Array = NDArray[np.float64]

STEP = "tracker.step"
STEP_INTO = "tracker.step_into"
RUN = "tracker.run"
COMPILED = "compiled run"
COLD = "so.distance, cold"
OURS = (STEP, STEP_INTO, RUN, COLD)
"""Those that the library is judged by."""
WARM = ("one warm Newton step", "two warm Newton steps")
"""Laws without a prediction and without the certificate's demand."""


def of_proximity(answer: so.Proximity) -> Found:
    """An answer of the library as the table compares it."""
    return Found(
        answer.distance, answer.point_a, answer.point_b, answer.distance - answer.lower_bound
    )


def of_row(row: Array) -> Found:
    """The same of an answer as the kernels write it."""
    a, b = rows.POINT_A, rows.POINT_B
    gap = row[rows.DISTANCE] - row[rows.LOWER_BOUND]
    return Found(float(row[rows.DISTANCE]), row[a : a + 3], row[b : b + 3], float(gap))


def begun(
    pair: Pair, frames: Frames, law: Followed | None = None
) -> tuple[so.Tracker, so.TrackerState]:
    """A tracker of a pair and its state at the start."""
    tracker = so.Tracker(pair.a.body, pair.b.body, DT, **({"law": law.law} if law else {}))
    first = frames.poses_a[0], frames.poses_b[0], frames.twists_a[0], frames.twists_b[0]
    return tracker, tracker.start(*first)


def steps(pair: Pair, frames: Frames) -> Contender:
    """A call from Python a frame, state and answer as values."""
    tracker, begin = begun(pair, frames)
    answers: list[so.Proximity] = []
    columns = list(
        zip(frames.poses_a, frames.poses_b, frames.twists_a, frames.twists_b, strict=True)
    )

    def run(count: int) -> None:
        answers.clear()
        state = begin
        for pose_a, pose_b, twist_a, twist_b in columns[1 : count + 1]:
            state, answer = tracker.step(state, pose_a, pose_b, twist_a, twist_b)
            answers.append(answer)

    most = len(columns) - 1
    return Contender(STEP, run, lambda k: of_proximity(answers[k - 1]), most, memory_of(pair))


def steps_in_place(pair: Pair, frames: Frames) -> Contender:
    """A call from Python a frame, on arrays that are written again and again."""
    tracker, begin = begun(pair, frames)
    columns = list(
        zip(frames.poses_a, frames.poses_b, frames.twists_a, frames.twists_b, strict=True)
    )
    kept: dict[int, Found] = {}

    def run(count: int, keep: bool = False) -> None:
        buffer, step_into = tracker.buffer(begin), tracker.step_into
        for pose_a, pose_b, twist_a, twist_b in columns[1 : count + 1]:
            step_into(buffer, pose_a, pose_b, twist_a, twist_b)
            if keep:
                kept[len(kept) + 1] = of_proximity(buffer.proximity())

    def found(k: int) -> Found:
        if not kept:
            run(len(columns) - 1, keep=True)
        return kept[k]

    return Contender(STEP_INTO, run, found, len(columns) - 1, memory_of(pair))


def motions_of(frames: Frames, first: int, last: int, passes: int = 1) -> Array:
    """Frames as the compiled run reads them, (n, 36), each ``passes`` times."""
    found = np.empty((last - first, passes, rows.N_MOTION))
    for at, poses in ((rows.POSE_A, frames.poses_a), (rows.POSE_B, frames.poses_b)):
        count = last - first
        found[:, :, at : at + 9] = poses[first:last, :3, :3].reshape(count, 1, 9)
        found[:, :, at + 9 : at + 12] = poses[first:last, None, :3, 3]
    found[:, :, rows.TWIST_A : rows.TWIST_A + 6] = frames.twists_a[first:last, None]
    found[:, :, rows.TWIST_B : rows.TWIST_B + 6] = frames.twists_b[first:last, None]
    return found.reshape(-1, rows.N_MOTION)


def runs(pair: Pair, frames: Frames) -> Contender:
    """All frames in one call from Python."""
    tracker, begin = begun(pair, frames)
    answers: list[so.tracking.Answers] = []

    def run(count: int) -> None:
        part = slice(1, count + 1)
        poses, twists = (frames.poses_a, frames.poses_b), (frames.twists_a, frames.twists_b)
        _, found = tracker.run(begin, *(p[part] for p in poses), *(t[part] for t in twists))
        answers[:] = [found]

    most = len(frames.poses_a) - 1
    return Contender(RUN, run, lambda k: of_proximity(answers[0][k - 1]), most, memory_of(pair))


def compiled_run(pair: Pair, frames: Frames, law: str) -> Contender:
    """All frames in one compiled loop of a law by its name in the studies."""
    followed = LAWS[law]
    tracker, begin = begun(pair, frames, followed)
    passes, most = followed.passes, len(frames.poses_a) - 1
    outs = np.empty((most * passes, rows.N_OUT))

    @lru_cache(maxsize=4)
    def loop(count: int) -> tuple[Callable[[], None], Array]:
        motions = motions_of(frames, 1, count + 1, passes)
        return runs_compiled(tracker, begin, motions, np.full(len(motions), DT))

    def run(count: int) -> None:
        once, answers = loop(count)
        once()
        outs[: len(answers)] = answers

    return Contender(
        f"{COMPILED}, {law}", run, lambda k: of_row(outs[k * passes - 1]), most, memory_of(pair)
    )


def cold(pair: Pair, frames: Frames) -> Contender:
    """A query without any state."""
    a, b = pair.a.body, pair.b.body

    def ask(pose_a: Array, pose_b: Array) -> so.Proximity:
        return so.distance(a, b, pose_a, pose_b)

    return asked(COLD, frames.pairs, ask, of_proximity, memory_of(pair))


def memory_of(pair: Pair) -> int:
    """Bytes of both bodies as the kernels read them."""
    return sum(s.body.ints.nbytes + s.body.reals.nbytes for s in (pair.a, pair.b))


def ours(pair: Pair, frames: Frames) -> list[Contender]:
    """All contenders of the library on a pair."""
    found = [steps(pair, frames), steps_in_place(pair, frames), runs(pair, frames)]
    found.append(cold(pair, frames))
    if "laws" in pair.more:
        found += [compiled_run(pair, frames, law) for law in WARM]
    return found
