"""The worst frame of very many, with contact and switching, against the median.

A box and an ellipsoid whose distance swings through 0, frame by frame by ``tracker.step_into``.
The worst frames are run again from the state before them: only what takes long again is the
frame's own doing; the rest was the machine's.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import standoff as so
from benchmarks.bench.library import motions_of
from benchmarks.bench.motion import DT, Pair, all_pairs, motion
from standoff.kernels.pair import events as logs
from standoff.kernels.state import arrays as rows

Array = NDArray[np.float64]

PAIR = "box, ellipsoid"
CENTRE, SWING = 0.62, 0.1
"""The distance of the centres, and how far it swings, over that of the pair in the table."""
PERIOD = 1700
"""Frames of one swing."""
TOLD = 5
"""So many of the worst are told."""
AGAIN = 7
"""So often each of them is run again; the least is the frame's own time."""
BLOCK = 20_000
"""Frames whose poses are made at once."""


@dataclass(frozen=True)
class Slow:
    """A frame, its time in the run and its least time when run again, s, and its answer's row."""

    frame: int
    seconds: float
    again: float
    out: Array


def _frames(pair: Pair, first: int, count: int) -> Array:
    """Motions (count, 36) of a swinging distance, from a frame number on."""
    whole = motion(pair.far, first + count)
    k = np.arange(first + count + 1)
    angle = 2 * np.pi * k / PERIOD
    share = CENTRE + SWING * np.sin(angle)
    rate = SWING * 2 * np.pi / PERIOD / DT * np.cos(angle)
    centre = whole.poses_b[:, :3, 3].copy()
    whole.twists_b[:, :3] = share[:, None] * whole.twists_b[:, :3] + rate[:, None] * centre
    whole.poses_b[:, :3, 3] = share[:, None] * centre
    return motions_of(whole, first, first + count)


class _Stepping:
    """One frame at a time by ``step_into``."""

    def __init__(self, tracker: so.Tracker, begin: so.TrackerState) -> None:
        self.tracker = tracker
        self.buffer = tracker.buffer(begin)

    def __call__(self, motion: Array) -> float:
        """The time of a frame, s; what the buffer holds goes on by it."""
        buffer, step_into = self.buffer, self.tracker.step_into
        buffer.pose_a[:] = motion[rows.POSE_A : rows.POSE_A + 12]
        buffer.pose_b[:] = motion[rows.POSE_B : rows.POSE_B + 12]
        buffer.twist_a[:] = motion[rows.TWIST_A : rows.TWIST_A + 6]
        buffer.twist_b[:] = motion[rows.TWIST_B : rows.TWIST_B + 6]
        begun = time.perf_counter()
        step_into(buffer)
        return time.perf_counter() - begun

    def again(self, state: Array, motion: Array) -> float:
        """The same from a given state."""
        self.buffer.state[:] = state
        return self(motion)


def _told(slow: Slow, median: float) -> str:
    status = so.Status(int(slow.out[rows.STATUS])).name
    counts = slow.out[rows.OUT_COUNTS :].astype(int)
    named = ", ".join(
        f"{name.lower()} {counts[getattr(logs, name)]}"
        for name in ("EVALUATIONS", "EVENTS", "RESTARTS")
    )
    return (
        f"| {slow.frame} | {1e6 * slow.seconds:.1f} | {1e6 * slow.again:.1f} "
        f"| {slow.again / median:.1f} | {status} | {slow.out[rows.DISTANCE]:.3g} | {named} |"
    )


def worst_frames(count: int) -> str:
    """The worst of ``count`` frames as Markdown."""
    pair = next(p for p in all_pairs() if p.name == PAIR)
    tracker = so.Tracker(pair.a.body, pair.b.body, DT)
    begin = _begun(tracker, _frames(pair, 0, 1)[0])
    step, other = _Stepping(tracker, begin), _Stepping(tracker, begin)
    times = np.empty(count)
    slowest: list[Slow] = []
    for first in range(0, count, BLOCK):
        length = min(BLOCK, count - first)
        # the motion repeats itself: angles stay small
        motions = _frames(pair, 1, BLOCK)[:length]
        before = np.empty((length, rows.N_STATE))
        for k in range(length):
            before[k] = step.buffer.state
            times[first + k] = step(motions[k])
        for k in np.argsort(times[first : first + length])[-TOLD:]:
            least = min(other.again(before[k], motions[k]) for _ in range(AGAIN))
            found = Slow(first + int(k), times[first + k], least, other.buffer.out.copy())
            slowest = sorted([*slowest, found], key=lambda s: -s.again)[:TOLD]
    median = float(np.median(times))
    told = [
        f"{count} frames of {PAIR}, the distance swinging through 0: median {1e6 * median:.2f} µs, "
        f"greatest {1e6 * times.max():.1f} µs as it ran.",
        "",
        "| frame | as it ran, µs | run again, µs | over the median | status | distance | counts |",
        "|---|---|---|---|---|---|---|",
        *(_told(slow, median) for slow in slowest),
    ]
    return "\n".join(told)


def _begun(tracker: so.Tracker, row: Array) -> so.TrackerState:
    poses = [row[at : at + 12] for at in (rows.POSE_A, rows.POSE_B)]
    placed = [(p[:9].reshape(3, 3), p[9:]) for p in poses]
    twists = [row[at : at + 6] for at in (rows.TWIST_A, rows.TWIST_B)]
    return tracker.start(*placed, *twists)
