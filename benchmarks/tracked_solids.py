"""Frames of two solids that move, beside queries from nothing at the same poses, in one run.

Run it with ``python -m benchmarks.tracked_solids``. B slides along A at about a gap, by 2e-3 of the
size and 2 mrad a frame, and by a tenth of that. Times are of one thread, in microseconds: of a
frame in a run of one (`run`), which a loop would call; of a query from nothing; statuses of all.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter

import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.solids import drawn, posed
from standoff.solids import Solid, SolidTracker
from standoff.solids.spatial.distance import spatial_distance

GAPS = (0.1, 1e-2, 1e-3)
SPEEDS = (2e-3, 2e-4)
STILL = np.eye(4)


def sliding(
    a: Solid, b: Solid, gap: float, speed: float, frames: int, rng: np.random.Generator
) -> np.ndarray:
    """Poses of B (n, 4, 4)."""
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = posed(a, b, gap, rng)
    tracker = SolidTracker(a, b)
    state = tracker.start(STILL, pose)
    size = 0.5 * (a.size + b.size)
    poses, spin, drift = [pose], rng.normal(size=3), rng.normal(size=3)
    for _ in range(frames):
        found = state.proximity
        spin = 0.95 * spin + 0.3 * rng.normal(size=3)
        drift = 0.95 * drift + 0.3 * rng.normal(size=3)
        along = drift - found.normal * (drift @ found.normal)
        near = np.clip(0.5 * (gap - found.distance), -0.5 * speed * size, 0.5 * speed * size)
        move = speed * size * along / np.linalg.norm(along) + near * found.normal
        turn = Rotation.from_rotvec(speed * spin / np.linalg.norm(spin)).as_matrix()
        pose, last = np.eye(4), poses[-1]
        pose[:3, :3] = Rotation.from_matrix(turn @ last[:3, :3]).as_matrix()
        pose[:3, 3] = found.point_b + turn @ (last[:3, 3] - found.point_b) + move
        state, found = tracker.step(state, STILL, pose)
        if not np.isfinite(found.normal).all():
            break
        poses.append(pose)
    return np.array(poses)


def row(a: Solid, b: Solid, poses: np.ndarray, cold: int) -> str:
    """Of all frames one line: median, 99 %, 99.9 %, worst; then of a query from nothing."""
    tracker = SolidTracker(a, b)
    state = tracker.start(STILL, poses[0])
    _, all_at_once = tracker.run(state, STILL, poses[1:])
    start = time.perf_counter()
    tracker.run(state, STILL, poses[1:])
    mean = 1e6 * (time.perf_counter() - start) / (len(poses) - 1)
    times = []
    for pose in poses[1:]:
        start = time.perf_counter()
        state, _ = tracker.run(state, STILL, pose)
        times.append(1e6 * (time.perf_counter() - start))
    queries, worst = [], 0.0
    for k in np.linspace(1, len(poses) - 1, cold).astype(int):
        start = time.perf_counter()
        answer = spatial_distance(a, b, STILL, poses[k])
        queries.append(1e6 * (time.perf_counter() - start))
        worst = max(worst, abs(answer.distance - all_at_once.distance[k - 1]))
    told = Counter(status.name for status in all_at_once.status)
    share = ", ".join(f"{name} {100 * n / len(all_at_once):.1f} %" for name, n in told.items())
    quantiles = " ".join(f"{q:8.0f}" for q in np.quantile(times, [0.5, 0.99, 0.999, 1.0]))
    return (
        f"{mean:8.1f} {quantiles}  {np.median(queries):8.0f}  {worst:.0e}  {share}; "
        f"{all_at_once.restarts.sum()} from nothing, {all_at_once.rebuilds.sum()} made anew"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=2000)
    parser.add_argument("--faces", type=int, nargs="*", default=[30, 100, 150])
    parser.add_argument("--cold", type=int, default=50, help="queries from nothing")
    given = parser.parse_args()
    for faces in given.faces:
        rng = np.random.default_rng(faces)
        a, b = drawn(faces, rng), drawn(faces, rng)
        print(
            f"{a.boundary.n_faces} faces: speed, gap; us a frame: mean within a run; single ones, "
            "median, 99 %, 99.9 %, worst; a query; greatest difference"
        )
        for speed in SPEEDS:
            for gap in GAPS:
                poses = sliding(a, b, gap, speed, given.frames, rng)
                print(f"{speed:6g} {gap:6g} {row(a, b, poses, given.cold)}", flush=True)


if __name__ == "__main__":
    main()
