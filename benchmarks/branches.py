"""Branches that run in parallel, beside the minima that exist; what threads would save; the inside.

Run it with ``python -m benchmarks.branches``. Of the nine scenes of ``benchmarks.tracked_solids``
(30, 100 and 150 faces at three gaps, minima up to a tenth of the size beyond the gap): branches of
the tracker in each frame, minima by queries from nothing at some of the poses, and evaluations of
a frame (median) with and without them. Of six branches of the paper's law on two chains of balls:
the time of a frame in one thread and in two. Of a point that moves inside spatial bodies: that too.
"""

from __future__ import annotations

import argparse
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np

import standoff as so
from benchmarks.solids import drawn_steps, turned
from benchmarks.tracked_solids import GAPS, SPEEDS, STILL, sliding
from standoff.solids import SolidTracker
from standoff.solids.asked import DEFAULT
from standoff.solids.spatial.distance import spatial_distance
from standoff_studies.paper.nonconvex_runs import Branch, motion
from standoff_studies.paper.nonconvex_scene import PAIRS

INSIDE = {
    "box": so.shapes.box(1.0, 0.8, 0.6),
    "cylinder": so.shapes.cylinder(0.5, 1.0),
    "lens": so.shapes.lens(1.0, 0.45),
    "ellipsoid": so.shapes.ellipsoid(0.6, 0.5, 0.4),
}
REACH = 0.15
"""Of the point's way about the middle [length]."""


def scene(faces: int, gap: float, frames: int, every: int, rng: np.random.Generator) -> str:
    """Of one scene a line: see the table's head."""
    a, b = (turned(drawn_steps(faces, rng), 1.0) for _ in range(2))
    below = gap + 0.05 * (a.size + b.size)
    poses, spent = sliding(a, b, gap, SPEEDS[0], frames, rng), {}
    for minima in (below, None):
        tracker = SolidTracker(a, b, minima=minima)
        state = tracker.start(STILL, poses[0])
        _, answers = tracker.run(state, STILL, poses[1:])
        spent[minima] = np.median(answers.evaluations)
        if minima:
            ran = np.bincount(answers.minima.frame, minlength=len(answers))
    at = np.arange(0, len(ran), every)
    asked = DEFAULT._replace(minima=below)
    there = [len(spatial_distance(a, b, STILL, poses[k + 1], asked).minima) for k in at]
    fewer = int((ran[at] < there).sum())
    return (
        f"{faces:5d} {gap:6g} {np.median(ran):6.0f} {ran.max():5d} {np.median(there):9.0f} "
        f"{max(there):5d} {fewer:4d} of {len(at):3d} {spent[below]:7.0f} {spent[None]:7.0f}"
    )


def in_threads(frames: int) -> tuple[float, float]:
    """Microseconds of a frame of six printed trackers in one thread, and in two: medians."""
    branches = [Branch(pair, 0.0) for pair in range(len(PAIRS))]
    halves, rows, spent = (branches[::2], branches[1::2]), motion()[:frames], []

    def half(own: list[Branch], row: np.ndarray) -> None:
        for branch in own:
            branch.buffer.motion[:] = row
            branch.tracker.step_into(branch.buffer)

    for branch in branches:
        branch.step(rows[0])
    with ThreadPoolExecutor(1) as pool:
        for split in (False, True):
            times = []
            for row in rows:
                start = time.perf_counter()
                other = pool.submit(half, halves[1], row) if split else None
                half(halves[0] if split else branches, row)
                if other:
                    other.result()
                times.append(1e6 * (time.perf_counter() - start))
            spent.append(float(np.median(times)))
    return spent[0], spent[1]


def inside(name: str, body: so.Body, depth: str, frames: int) -> str:
    """Of a point that goes about the middle of a body a line: see the table's head."""
    angle = np.linspace(0.0, 6.0 * np.pi, frames + 1)
    way = np.array([np.cos(angle), np.sin(1.3 * angle), 0.5 * np.sin(0.7 * angle)]).T
    tracker = so.PointTracker(body, law=so.PredictorCorrector(depth=depth))
    state = tracker.start(REACH * way[0])
    times, minima, proven = [], [], 0
    for point in REACH * way[1:]:
        start = time.perf_counter()
        state, answer = tracker.step(state, point, locate=False)
        times.append(1e6 * (time.perf_counter() - start))
        minima.append(len(answer.minima))
        proven += answer.certified
    return (
        f"{name:10s} {depth:7s} {np.median(times):8.0f} {np.quantile(times, 0.99):8.0f} "
        f"{np.median(minima):8.0f} {max(minima):5d} {proven:6d} of {frames}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=500)
    parser.add_argument("--every", type=int, default=10, help="frames between queries")
    parser.add_argument("--faces", type=int, nargs="*", default=[30, 100, 150])
    given = parser.parse_args()
    print("faces gap; branches, most; minima, most; fewer; evaluations a frame with, without")
    for faces in given.faces:
        rng = np.random.default_rng(faces)
        for gap in GAPS:
            print(scene(faces, gap, given.frames, given.every, rng), flush=True)
    one, two = in_threads(given.frames)
    print(f"six branches of the paper's law: {one:.0f} us a frame, in two threads {two:.0f} us")
    print("inside     depth   us a frame, 99 %; minima, most; proven")
    for name, body in INSIDE.items():
        for depth in ("global", "local"):
            print(inside(name, body, depth, given.frames), flush=True)


if __name__ == "__main__":
    main()
