"""What a call from Python costs without twists, beside Coal and beside the compiled work alone.

``python -m benchmarks.from_python`` prints ratios with the goal of each; ``--quick`` takes half a
minute, ``--before COMMIT`` adds the rows that are held against another commit (some minutes: both
compile their kernels). Poses are arrays (4, 4), new in each frame. All contenders of a row
take turns, and a ratio is the median of those of each round.

More than half of Coal's time is making transforms of both poses. Where one body is at rest its
transform is made once, beforehand; the library is given the same array in each frame.

At a gap the pose of one ellipsoid is shifted along the normal until the distance is the gap in
every frame: contact, where frames are dearer, is never met.
"""

from __future__ import annotations

import argparse
import os
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

import standoff as so
from benchmarks import regression
from benchmarks.bench import limits
from benchmarks.bench.contender import Array, Contender, Found, Missing, asked, timed
from benchmarks.bench.library import COLD, memory_of, of_proximity
from benchmarks.bench.motion import DT, Frames, Pair, all_pairs, motion
from benchmarks.bench.peers import coal
from benchmarks.bench.report import number
from benchmarks.bench.truth import doubt, errors, truths
from standoff_studies.accuracy.peers.coal_peer import coal_shape

GAPS = (0.01, 0.1, 1.0, 10.0)
"""Between the ellipsoids, over the size (the greater diameter)."""
NUDGE = 1e-5
"""Of central differences, length and rad."""
HELD = 4
"""Shifts of a pose along its normal until the gap is there: each squares what it is off by."""
STEP, STEP_INTO = "tracker.step", "tracker.step_into"
ALONE = "its own compiled query"
STARTED = "so.Tracker(...) with start"
GRADIENT, OVERLAP_FRAME = "answer.gradient", "the frame itself"
GUESS, DISTANCE = f"{coal.GUESS}, default", f"{coal.DISTANCE}, default"


@dataclass(frozen=True)
class Goal:
    """Work against other work, and the greatest ratio of their times that is aimed at."""

    work: str
    against: str
    most: float


GOALS = (
    Goal(STEP, GUESS, 1.0),
    Goal(STEP_INTO, GUESS, 0.5),
    Goal(COLD, DISTANCE, 2.0),
    Goal(COLD, ALONE, 1.5),
    Goal(STARTED, ALONE, 2.0),
)
"""Of two ellipsoids, at every gap."""
IN_OVERLAP = Goal(GRADIENT, OVERLAP_FRAME, 1.0)
AGAINST_BEFORE = {
    "box, ellipsoid on an edge: a frame of Tracker.run, us": 0.5,
    "five bodies on a plane: a tick of Operator.run, us": 0.6,
}
"""Work of `regression_work`, and the goal of its ratio."""
NAMED = "on a"
"""A text that the names of both hold, and those of no pair."""


@dataclass(frozen=True)
class Effort:
    """How long a row may take."""

    frames: int = 400
    rounds: int = 9


QUICK = Effort(frames=60, rounds=3)


@dataclass(frozen=True)
class Line:
    """A row of the table: times of the work and of what it is held against, s, round by round."""

    title: str
    goal: Goal
    times: tuple[float, ...] = ()
    against: tuple[float, ...] = ()
    error: float = np.nan  # of the work's distance, over the size
    other_error: float = np.nan
    missing: str = ""
    ratios: Array = field(init=False)

    def __post_init__(self) -> None:
        found = np.array(self.times) / np.array(self.against)
        object.__setattr__(self, "ratios", found)

    @property
    def ratio(self) -> float:
        return float(np.median(self.ratios))


def held(pair: Pair, frames: Frames, gap: float) -> Frames:
    """The frames with B shifted so that the distance is the gap (length) in each."""
    poses = frames.poses_b.copy()
    for pose_a, pose_b in zip(frames.poses_a, poses, strict=True):
        for _ in range(HELD):
            found = so.distance(pair.a.body, pair.b.body, pose_a, pose_b)
            pose_b[:3, 3] += (gap - found.distance) * found.normal
    return Frames(frames.poses_a, poses, frames.twists_a, frames.twists_b)


def begun(pair: Pair, frames: Frames) -> tuple[so.Tracker, so.TrackerState]:
    """A tracker of a pair and its state at the start, without twists."""
    tracker = so.Tracker(pair.a.body, pair.b.body, DT)
    return tracker, tracker.start(*frames.pairs[0])


def steps(pair: Pair, frames: Frames) -> Contender:
    """State and answer as values."""
    tracker, begin = begun(pair, frames)
    answers: list[so.Proximity] = []

    def run(count: int) -> None:
        answers.clear()
        state, step = begin, tracker.step
        for pose_a, pose_b in frames.pairs[1 : count + 1]:
            state, answer = step(state, pose_a, pose_b)
            answers.append(answer)

    def found(k: int) -> Found:
        return of_proximity(answers[k - 1])

    return Contender(STEP, run, found, len(frames.pairs) - 1, memory_of(pair))


def steps_in_place(pair: Pair, frames: Frames) -> Contender:
    """On arrays that are written again and again."""
    tracker, begin = begun(pair, frames)

    def run(count: int) -> None:
        buffer, step_into = tracker.buffer(begin), tracker.step_into
        for pose_a, pose_b in frames.pairs[1 : count + 1]:
            step_into(buffer, pose_a, pose_b)

    @lru_cache(maxsize=1)
    def kept() -> list[so.Proximity]:
        buffer, answers = tracker.buffer(begin), []
        for pose_a, pose_b in frames.pairs[1:]:
            tracker.step_into(buffer, pose_a, pose_b)
            answers.append(buffer.proximity())
        return answers

    def found(k: int) -> Found:
        return of_proximity(kept()[k - 1])

    return Contender(STEP_INTO, run, found, len(frames.pairs) - 1, memory_of(pair))


def cold(pair: Pair, frames: Frames) -> Contender:
    a, b = pair.a.body, pair.b.body
    return asked(COLD, frames.pairs, lambda x, y: so.distance(a, b, x, y), of_proximity)


def started(pair: Pair, frames: Frames) -> Contender:
    """A tracker made for each query, of bodies that are known."""
    a, b = pair.a.body, pair.b.body

    def ask(pose_a: Array, pose_b: Array) -> so.Proximity:
        return so.Tracker(a, b, DT).start(pose_a, pose_b).proximity

    return asked(STARTED, frames.pairs, ask, of_proximity)


def compiled(pair: Pair, frames: Frames) -> Contender:
    """Cold queries in one compiled loop: the time of one without Python."""
    a, b = pair.a.body, pair.b.body
    answers: list[so.tracking.Distances] = []

    def run(count: int) -> None:
        part = slice(1, count + 1)
        answers[:] = [so.distances(a, b, frames.poses_a[part], frames.poses_b[part])]

    def found(k: int) -> Found:
        return of_proximity(answers[0][k - 1])

    return Contender(ALONE, run, found, len(frames.pairs) - 1, memory_of(pair))


def seen_from_a(frames: Frames) -> Frames:
    """The same motion with A at rest, in one array for all frames. The twists are not asked."""
    count = len(frames.poses_a)
    poses = np.linalg.inv(frames.poses_a) @ frames.poses_b
    still = np.broadcast_to(np.eye(4), (count, 4, 4))
    return OneAtRest(still, poses, frames.twists_a, frames.twists_b)


class OneAtRest(Frames):
    """Frames that hand out A's pose as the same array each time."""

    @cached_property
    def pairs(self) -> list[tuple[Array, Array]]:
        rest = np.eye(4)
        return [(rest, pose) for pose in self.poses_b]


def contenders(pair: Pair, frames: Frames) -> tuple[list[Contender], list[Missing]]:
    """Ours, and Coal's if it is installed."""
    ours = [make(pair, frames) for make in (steps, steps_in_place, cold, started, compiled)]
    rest = isinstance(frames, OneAtRest)
    try:
        shapes = coal_shape(pair.a), coal_shape(pair.b)
        theirs = [
            coal.by_functor(GUESS, frames, shapes, False, at_rest=rest),
            coal.by_function(DISTANCE, frames, shapes, at_rest=rest),
        ]
    except ImportError as error:
        return ours, [Missing(name, str(error)) for name in (GUESS, DISTANCE)]
    return [*ours, *theirs], []


def raced(all_of: Sequence[Contender], count: int, rounds: int) -> dict[str, tuple[float, ...]]:
    """The times of one frame of all contenders in turn, s, by name."""
    for contender in all_of:
        contender.run(count)
    times = [[timed(contender, count) for contender in all_of] for _ in range(rounds)]
    return {
        c.name: tuple(column) for c, column in zip(all_of, zip(*times, strict=True), strict=True)
    }


def lines_at(pair: Pair, frames: Frames, title: str, effort: Effort) -> list[Line]:
    """A row for each goal of two ellipsoids."""
    count = len(frames.pairs) - 1
    able, missing = contenders(pair, frames)
    times = raced(able, count, effort.rounds)
    known = truths(pair, frames, count)
    off = {c.name: errors(pair, c, known)[0] for c in able}
    worst = max(doubt(pair, frames, k, truth) for k, truth in known.items())
    for name in (COLD, STARTED, ALONE):  # the truth itself: what the support functions show of it
        off[name] = max(off[name], worst)
    why = {m.name: m.why for m in missing}
    return [
        Line(title, goal, missing=why[goal.against])
        if goal.against in why
        else Line(
            title,
            goal,
            times[goal.work],
            times[goal.against],
            off[goal.work],
            off[goal.against],
        )
        for goal in GOALS
    ]


def gradient_error(pair: Pair, frames: Frames, answer: so.Proximity, k: int) -> float:
    """The greatest error of frame k's gradient, a length per length or radian, over the size, by
    central differences of cold queries."""
    by_difference = np.empty(12)
    for column in range(12):
        signed = []
        for sign in (1.0, -1.0):
            poses = [pose.copy() for pose in frames.pairs[k]]
            moved, way = poses[column // 6], sign * NUDGE * np.eye(3)[column % 3]
            if column % 6 < 3:
                moved[:3, 3] += way
            else:
                moved[:3, :3] = Rotation.from_rotvec(way).as_matrix() @ moved[:3, :3]
            signed.append(so.distance(pair.a.body, pair.b.body, *poses).distance)
        by_difference[column] = (signed[0] - signed[1]) / (2.0 * NUDGE)
    return float(np.abs(answer.gradient - by_difference).max()) / pair.size


def in_overlap(pair: Pair, frames: Frames, effort: Effort) -> Line:
    """The gradient of an answer in contact, beside the frame that gave it: each asked once."""
    frame = steps(pair, frames)
    tracker, begin = begun(pair, frames)
    answers: list[so.Proximity] = []

    def run(count: int) -> float:
        answers.clear()
        state = begin
        for pose_a, pose_b in frames.pairs[1 : count + 1]:
            state, answer = tracker.step(state, pose_a, pose_b)
            answers.append(answer)
        start = time.perf_counter()
        for answer in answers:
            _ = answer.gradient
        return time.perf_counter() - start

    count = len(frames.pairs) - 1
    gradient = Contender(GRADIENT, run, frame.found, count)
    times = raced([frame, gradient], count, effort.rounds)
    known = truths(pair, frames, count)
    run(count)
    return Line(
        pair.name,
        IN_OVERLAP,
        times[GRADIENT],
        times[frame.name],
        max(gradient_error(pair, frames, answers[k - 1], k) for k in list(known)[:3]),
        errors(pair, frame, known)[0],
    )


def against_before(commit: str, rounds: int) -> list[Line]:
    """The rows that are held against another commit; this one is what HEAD names."""
    with ExitStack() as stack:
        scratch = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        before = stack.enter_context(regression.checked_out(commit, scratch / "before"))
        after = stack.enter_context(regression.checked_out("HEAD", scratch / "after"))
        found = regression.compared((before, after), scratch, rounds, named=NAMED)
    lines = []
    for row in found:
        same = "same answers" if row.same_answer else "**other answers**"
        work, _, what = row.name.partition(": ")
        goal = Goal(what.removesuffix(", us"), f"{commit}, {same}", AGAINST_BEFORE[row.name])
        lines.append(Line(work, goal, _seconds(row.after), _seconds(row.before)))
    return lines


def _seconds(micro: Sequence[float]) -> tuple[float, ...]:
    return tuple(1e-6 * x for x in micro)


def table(lines: Sequence[Line]) -> list[str]:
    """As Markdown."""
    told = [
        "| bodies | work | against | goal | ratio | least to greatest | µs | against, µs "
        "| distance error | of the other | |",
        "|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    for line in lines:
        goal = line.goal
        begin = f"| {line.title} | `{goal.work}` | {goal.against} | ≤ {goal.most:g} "
        if line.missing:
            told.append(f"{begin}| missing: {line.missing} | | | | | | |")
            continue
        times = (number(1e6 * float(np.median(x)), 3) for x in (line.times, line.against))
        verdict = "met" if line.ratio <= goal.most else "**not met**"
        told.append(
            f"{begin}| **{line.ratio:.3g}** | {line.ratios.min():.3g} to {line.ratios.max():.3g} "
            f"| {' | '.join(times)} | {number(line.error)} | {number(line.other_error)} "
            f"| {verdict} |"
        )
    return told


def lines_of(effort: Effort, gaps: Sequence[float] = GAPS) -> Iterator[Line]:
    """All rows but those against another commit, as they are measured."""
    pairs = {pair.name: pair for pair in all_pairs()}
    pair = pairs["ellipsoids"]
    moving = motion(pair.far, effort.frames)
    yield from lines_at(pair, moving, "ellipsoids, in motion", effort)
    yield from lines_at(pair, seen_from_a(moving), "ellipsoids, one at rest", effort)
    for gap in gaps:
        still = held(pair, moving, gap * pair.size)
        yield from lines_at(pair, still, f"ellipsoids, gap {gap:g} sizes", effort)
    deep = pairs["ellipsoids in penetration"]
    yield in_overlap(deep, motion(deep.far, effort.frames), effort)


def main(given: Sequence[str] | None = None) -> None:
    reader = argparse.ArgumentParser(description="Calls from Python without twists.")
    reader.add_argument("--quick", action="store_true", help="few frames: half a minute")
    reader.add_argument("--before", metavar="COMMIT", help="the rows against another commit too")
    asked_for = reader.parse_args(given)
    effort = QUICK if asked_for.quick else Effort()
    print(f"{limits.processor()}, load {os.getloadavg()[0]:.1f}, {effort.rounds} rounds in turn\n")
    lines = list(lines_of(effort))
    if asked_for.before:
        lines += against_before(asked_for.before, effort.rounds)
    print("\n".join(table(lines)))
    if not asked_for.before:
        works = " and ".join(name.rpartition(", us")[0] for name in AGAINST_BEFORE)
        print(f"\nNot measured, for want of --before COMMIT: {works}.")


if __name__ == "__main__":
    main()
