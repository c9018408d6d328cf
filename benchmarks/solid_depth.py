"""Frames of two solids that overlap, beside queries from nothing at the same poses, in one run.

Run it with ``python -m benchmarks.solid_depth``. B slides along A, pressed into it by about a
depth, by 2e-3 of the size and 2 mrad a frame, and by a tenth of that. Times are of one thread, in
microseconds: of each frame as `tracker.step` makes it, with its answer, and of queries from
nothing; how many places frames tell, which share of queries proves a shift that parts the solids,
and the greatest difference of the deepest place from the query's, of the size.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

from benchmarks.solids import drawn
from benchmarks.tracked_solids import SPEEDS, STILL, sliding
from standoff.solids import Solid, SolidTracker
from standoff.solids.asked import DEFAULT
from standoff.solids.spatial.distance import spatial_distance
from standoff.tracking.status import Status

DEPTHS = (1e-2, 1e-3, 1e-4)
MINIMA = 0.02


def row(a: Solid, b: Solid, depth: float, speed: float, given: argparse.Namespace) -> str:
    """Of all frames one line; see the module."""
    size = 0.5 * (a.size + b.size)
    rng = np.random.default_rng(given.seed)
    poses = sliding(a, b, depth * size, speed, given.frames, rng, pressed=True)
    tracker = SolidTracker(a, b, minima=MINIMA * size)
    state = tracker.start(STILL, poses[0])
    times, told = [], []
    for pose in poses[1:]:
        start = time.perf_counter()
        state, answer = tracker.step(state, STILL, pose)
        times.append(1e6 * (time.perf_counter() - start))
        told.append(answer)
    met = np.array([each.status is Status.OVERLAPPING for each in told])
    queries, parted, worst = [], 0, 0.0
    chosen = np.flatnonzero(met)[:: max(1, int(met.sum()) // given.cold)]
    for k in chosen:
        start = time.perf_counter()
        cold = spatial_distance(a, b, None, poses[k + 1], DEFAULT._replace(minima=MINIMA * size))
        queries.append(1e6 * (time.perf_counter() - start))
        parted += cold.overlap is not None and cold.overlap.parting is not None
        worst = max(worst, abs(cold.minima[0].distance - told[k].minima[0].distance) / size)
    found = np.array(times)[met]
    places = [sum(m.distance < 0.0 for m in each.minima) for each in told if each.overlap]
    return (
        f"{a.boundary.n_faces:4d} faces, speed {speed:.0e}, depth {depth:.0e}: {met.sum()} of "
        f"{len(told)} overlap, {np.median(places):.0f} places; frame {np.median(found):.0f} "
        f"{np.quantile(found, 0.99):.0f} {np.quantile(found, 0.999):.0f}, query "
        f"{np.median(queries):.0f} {max(queries):.0f} us; {parted} of {len(chosen)} parted; "
        f"{worst:.0e}"
    )


def main() -> None:
    read = argparse.ArgumentParser(description="Frames of two solids that overlap.")
    read.add_argument("--faces", type=int, nargs="*", default=[30, 100])
    read.add_argument("--frames", type=int, default=400)
    read.add_argument("--cold", type=int, default=20)
    read.add_argument("--seed", type=int, default=1)
    given = read.parse_args()
    for faces in given.faces:
        rng = np.random.default_rng(given.seed)
        a, b = drawn(faces, rng), drawn(faces, rng)
        for speed in SPEEDS:
            for depth in DEPTHS:
                print(row(a, b, depth, speed, given), flush=True)


if __name__ == "__main__":
    main()
