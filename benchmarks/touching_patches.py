"""Patches of convex bodies beside their witness sets: microseconds at the same poses.

Run with ``python -m benchmarks.touching_patches --frames 2000``. Each pair rocks by 2e-3 rad about
level, so that all of its corners stay within the gap that is asked. Medians of ``answer.patch``,
``answer.witness_set`` and ``tracker.step``, one call each per frame, and of ``answers.patches`` and
``tracker.run`` a frame's share of the shortest of a few calls; and the greatest leap of a corner
over the frame's motion.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from functools import partial
from itertools import pairwise
from time import perf_counter
from typing import Any

import numpy as np

import standoff as so

HOME = so.Pose.identity()
TILT, GAP = 2e-3, 2e-2
"""rad, length"""
REPEATS = 7
SLAB, BOX, CAN = so.shapes.box(4, 4, 1), so.shapes.box(1, 1, 1), so.shapes.cylinder(0.5, 2)
CAPSULE, ROUNDED = so.shapes.capsule(0.2, 1), so.shapes.box(1, 1, 1, rounding=0.1)
LYING = (np.pi / 2, 0, 0)
PAIRS = {
    "box on a slab": (SLAB, BOX, so.Pose(np.eye(3), [0.2, 0.1, 1.1])),
    "box over a rim": (SLAB, BOX, so.Pose(np.eye(3), [1.8, 0.0, 1.1])),
    "box across a box": (BOX, BOX, so.Pose.exp([0, 0, 0.5], [0.1, 0.05, 1.1])),
    "rounded boxes": (ROUNDED, ROUNDED, so.Pose.exp([0, 0, 0.3], [0.2, 0.1, 1.1])),
    "standing cylinder": (SLAB, CAN, so.Pose(np.eye(3), [0, 0, 1.6])),
    "lying cylinder": (SLAB, CAN, so.Pose.exp(LYING, [0, 0, 1.1])),
    "cylinders side by side": (CAN, CAN, so.Pose(np.eye(3), [1.1, 0, 0.3])),
    "capsules side by side": (CAPSULE, CAPSULE, so.Pose(np.eye(3), [0.5, 0, 0.3])),
    "ball": (SLAB, so.shapes.sphere(0.3), so.Pose(np.eye(3), [0.1, 0.2, 0.9])),
}


def rocking(pose: so.Pose, count: int) -> list[so.Pose]:
    """B tilts to all sides about a pose."""
    k = 2.0 * np.pi * np.arange(count) / count
    turns = TILT * np.column_stack([np.sin(7 * k), np.sin(5 * k + 1), np.sin(3 * k + 2)])
    return [so.Pose(pose.rotation @ so.Pose.exp(turn).rotation, pose.translation) for turn in turns]


def median(calls: list[Callable[[], Any]]) -> float:
    """Microseconds of one call."""
    taken = []
    for call in calls:
        begun = perf_counter()
        call()
        taken.append(perf_counter() - begun)
    return 1e6 * float(np.median(taken))


def shortest(call: Callable[[], Any], count: int) -> float:
    """Microseconds of a frame."""
    taken = []
    for _ in range(REPEATS):
        begun = perf_counter()
        call()
        taken.append(perf_counter() - begun)
    return 1e6 * min(taken) / count


def leap(patches: so.tracking.Patches, poses: list[so.Pose]) -> float:
    """The greatest way of a corner in a frame over the frame's motion, of lengths of 1; inf
    where their number changes."""
    most = 0.0
    for (p, q), (a, b) in zip(pairwise(patches), pairwise(poses), strict=True):
        if len(p) != len(q):
            return np.inf
        away = np.linalg.norm(p.points_a - q.points_a, axis=1)
        moved = np.linalg.norm(b.translation - a.translation)
        moved += np.linalg.norm(b.rotation - a.rotation)
        most = max(most, float(away.max() / moved))
    return most


def told(name: str, a: so.Body, b: so.Body, poses: list[so.Pose]) -> str:
    """The line of one pair."""
    count, tracker = len(poses), so.Tracker(a, b)
    start = tracker.start(HOME, poses[0])
    _, answers = tracker.run(start, HOME, poses)
    each = list(answers)
    patches = answers.patches(GAP)
    few = each[:: max(1, count // 200)]
    each[0].witness_set()
    numbers = (
        median([partial(answer.patch, GAP) for answer in each]),
        median([answer.witness_set for answer in few]),
        median([partial(tracker.step, start, HOME, pose) for pose in poses]),
        shortest(lambda: answers.patches(GAP), count),
        shortest(lambda: tracker.run(start, HOME, poses), count),
    )
    pairs = "-".join(str(n) for n in sorted(set(patches.count.tolist())))
    columns = " ".join(f"{number:11.1f}" for number in numbers)
    return f"{name:24s} {pairs:>5s} {columns} {leap(patches, poses):6.2f}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=2000)
    count = parser.parse_args().frames
    heads = ("patch", "witness set", "step", "patches", "run")
    print(f"{'pair':24s} pairs", *(f"{head:>11s}" for head in heads), "  leap")
    for name, (a, b, pose) in PAIRS.items():
        print(told(name, a, b, rocking(pose, count)), flush=True)


if __name__ == "__main__":
    main()
