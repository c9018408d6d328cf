"""Rows a second of a sweep, with one process and with two, beside `so.distances` on the same rows.

Run from the repository's root: ``python -m benchmarks.sweep [--rows 1000000] [--kind sobol]``.
The pair is two ellipsoids, most of them apart; rounds of the three take turns, and the best of each
counts. Of the sweeps only the time of their shards is taken, without starting the processes.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path

from standoff import distances
from standoff.sweep.job import Job
from standoff.sweep.reading import load_job
from standoff.sweep.run import run_sweep

SCENE = """version = 1
[bodies.a]
shape = "ellipsoid"
semi_axes = [0.3, 0.2, 0.1]
[bodies.b]
shape = "ellipsoid"
semi_axes = [0.2, 0.25, 0.15]
[pair]
a = "a"
b = "b"
"""

JOB = """version = 1
scene = "scene.toml"
[parameters.x]
moves = "b"
what = "x"
from = -1.0
to = 1.0
[parameters.y]
moves = "b"
what = "y"
from = -1.0
to = 1.0
[parameters.z]
moves = "b"
what = "z"
from = -1.0
to = 1.0
[parameters.any]
moves = "b"
rotation = "uniform"
[sampler]
kind = "{kind}"
rows = {rows}
[keep]
below = 0.01
histogram = {{ from = 0.0, to = 2.0, bins = 100 }}
[shards]
rows = {shard}
"""

BLOCK = 8192
"""Rows of a call of `so.distances`: many more, and memory is what is measured."""


def plain(job: Job) -> float:
    """Time of the distances alone, their poses made before, s a row."""
    taken = 0.0
    for first in range(0, job.rows, BLOCK):
        end = min(first + BLOCK, job.rows)
        poses = job.poses(job.numbers(first, end))

        began = time.perf_counter()
        distances(*job.bodies, *poses)
        taken += time.perf_counter() - began
    return taken / job.rows


def swept(job: Job, workers: int) -> float:
    """Time of a sweep, from its first shard on, s a row."""
    seen: list[tuple[float, int]] = []
    with tempfile.TemporaryDirectory() as folder:
        run_sweep(
            job,
            Path(folder),
            workers=workers,
            progress=lambda done, _: seen.append((time.perf_counter(), done)),
        )
    # With several processes the first shards end together: from then on all of them work.
    start = 0 if workers == 1 else workers
    (began, before), (ended, after) = seen[start], seen[-1]
    return (ended - began) / (after - before)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rows", type=int, default=1_000_000)
    parser.add_argument("--kind", default="sobol")
    parser.add_argument("--rounds", type=int, default=3)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "scene.toml").write_text(SCENE, encoding="utf-8")
        text = JOB.format(kind=given.kind, rows=given.rows, shard=max(1, given.rows // 20))
        (folder / "job.toml").write_text(text, encoding="utf-8")
        job = load_job(folder / "job.toml")
        job.distances(0, 1)
        best = dict.fromkeys(("so.distances", "sweep, 1 process", "sweep, 2 processes"), 1e9)
        for _ in range(given.rounds):
            for told, seconds in zip(best, (plain(job), swept(job, 1), swept(job, 2)), strict=True):
                best[told] = min(best[told], seconds)
        for told, seconds in best.items():
            share = seconds / best["so.distances"]
            print(
                f"{told:20} {seconds * 1e6:6.2f} µs a row, {1 / seconds:9.0f} rows/s, {share:.2f}"
            )


if __name__ == "__main__":
    main()
