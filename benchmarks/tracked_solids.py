"""Frames of two solids that move, beside queries from nothing at the same poses, in one run.

Run it with ``python -m benchmarks.tracked_solids``. B slides along A at about a gap, by 2e-3 of the
size and 2 mrad a frame, and by a tenth of that. Times are of one thread, in microseconds: of a
frame in a run with its answers; of a frame by itself, as the least of three runs; of a query from
nothing, and of OpenCASCADE's (``--theirs 5``, which takes seconds each); statuses of all. With
``--minima 0.1`` frames and queries tell all local minima up to a tenth of the size beyond the gap.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.cad_gaps import their_distance
from benchmarks.solids import drawn_steps, posed, turned
from standoff.solids import Solid, SolidTracker
from standoff.solids.asked import DEADLINE, DEFAULT
from standoff.solids.spatial.distance import spatial_distance
from standoff.solids.tracked.front import room_for
from standoff.tracking.status import Status

GAPS = (0.1, 1e-2, 1e-3)
SPEEDS = (2e-3, 2e-4)
STILL = np.eye(4)
REPEATS = 3


class Turned:
    """A drawn turned part, and the same as a shape of OpenCASCADE."""

    def __init__(self, faces: int, rng: np.random.Generator, with_theirs: bool) -> None:
        steps = drawn_steps(faces, rng)
        self.shape = turned(steps, 1.0)
        self.theirs = revolved(steps, 1.0) if with_theirs else None


def revolved(steps: list[tuple[float, float]], top: float) -> Any:
    """The profile of a turned part, turned by OpenCASCADE."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakePolygon
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeRevol
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt

    outline = BRepBuilderAPI_MakePolygon()
    outline.Add(gp_Pnt(0.0, 0.0, steps[0][0]))
    for (low, radius), high in zip(steps, [h for h, _ in steps[1:]] + [top], strict=True):
        outline.Add(gp_Pnt(radius, 0.0, low))
        outline.Add(gp_Pnt(radius, 0.0, high))
    outline.Add(gp_Pnt(0.0, 0.0, top))
    outline.Close()
    face = BRepBuilderAPI_MakeFace(outline.Wire()).Face()
    return BRepPrimAPI_MakeRevol(face, gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))).Shape()


def sliding(
    a: Solid,
    b: Solid,
    gap: float,
    speed: float,
    frames: int,
    rng: np.random.Generator,
    pressed: bool = False,
) -> np.ndarray:
    """Poses of B (n, 4, 4); `pressed`: it goes on from the gap to as much of a depth."""
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = posed(a, b, gap, rng)
    tracker = SolidTracker(a, b)
    state = tracker.start(STILL, pose)
    size = 0.5 * (a.size + b.size)
    gap = -gap if pressed else gap
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


def by_themselves(tracker: SolidTracker, poses: np.ndarray) -> np.ndarray:
    """Microseconds of each frame, one call of the compiled loop each, without its answer."""
    relative = np.concatenate([poses[:, :3, :3].reshape(-1, 9), poses[:, :3, 3]], axis=1)
    found = []
    for _ in range(REPEATS):
        front = tracker.start(STILL, poses[0]).front
        assert front is not None, "the solids meet at the start"
        frames, told, times = tracker.frames(front), room_for(1), []
        for k in range(1, len(relative)):
            start = time.perf_counter()
            frames.go(relative[k : k + 1], told)
            times.append(1e6 * (time.perf_counter() - start))
        found.append(times)
    return np.min(found, axis=0)


def row(
    pair: tuple[Turned, Turned], poses: np.ndarray, gap: float, given: argparse.Namespace
) -> str:
    """Of all frames one line; see `main`."""
    a, b = pair[0].shape, pair[1].shape
    below = gap + 0.5 * given.minima * (a.size + b.size) if given.minima else None
    tracker = SolidTracker(a, b, deadline=given.deadline, minima=below)
    asked = DEFAULT._replace(minima=below)
    state = tracker.start(STILL, poses[0])
    means = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        _, answers = tracker.run(state, STILL, poses[1:])
        means.append(1e6 * (time.perf_counter() - start) / (len(poses) - 1))
    apart = np.flatnonzero(answers.status == Status.OVERLAPPING)
    times = by_themselves(tracker, poses[: apart[0] + 1] if len(apart) else poses)
    queries, others, worst = [], [], 0.0
    for k in np.linspace(1, len(poses) - 1, given.cold).astype(int):
        start = time.perf_counter()
        answer = spatial_distance(a, b, STILL, poses[k], asked)
        queries.append(1e6 * (time.perf_counter() - start))
        worst = max(worst, abs(answer.distance - answers.distance[k - 1]))
    for k in np.linspace(1, len(poses) - 1, given.theirs).astype(int):
        start = time.perf_counter()
        their_distance(*pair, (poses[k, :3, :3], poses[k, :3, 3]))
        others.append(1e6 * (time.perf_counter() - start))
    told = Counter(status.name for status in answers.status)
    share = ", ".join(f"{name} {100 * n / len(answers):.1f} %" for name, n in told.items())
    quantiles = " ".join(f"{q:7.0f}" for q in np.quantile(times, [0.5, 0.99, 0.999, 1.0]))
    other = f"{np.median(others):9.0f}" if others else "        -"
    return (
        f"{min(means):7.1f} {quantiles}  {np.median(queries):7.0f} {other}  {worst:.0e}  {share}; "
        f"{answers.restarts.sum()} from nothing, {answers.rebuilds.sum()} made anew"
        + (f"; {len(answers.minima.frame) / len(answers):.1f} minima" if below else "")
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=2000)
    parser.add_argument("--faces", type=int, nargs="*", default=[30, 100, 150])
    parser.add_argument("--cold", type=int, default=50, help="queries from nothing")
    parser.add_argument("--theirs", type=int, default=0, help="queries of OpenCASCADE")
    parser.add_argument("--deadline", type=int, default=DEADLINE, help="evaluations of a frame")
    parser.add_argument("--minima", type=float, default=0.0, help="beyond the gap, of the size")
    given = parser.parse_args()
    for faces in given.faces:
        rng = np.random.default_rng(faces)
        pair = Turned(faces, rng, given.theirs > 0), Turned(faces, rng, given.theirs > 0)
        a, b = pair[0].shape, pair[1].shape
        print(
            f"{a.boundary.n_faces} faces: speed, gap; us a frame: mean within a run; by themselves "
            "median, 99 %, 99.9 %, worst; a query; OpenCASCADE's; greatest difference"
        )
        for speed in SPEEDS:
            for gap in GAPS:
                poses = sliding(a, b, gap, speed, given.frames, rng)
                line = row(pair, poses, gap, given)
                print(f"{speed:6g} {gap:6g} {line}", flush=True)


if __name__ == "__main__":
    main()
