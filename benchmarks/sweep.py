"""Rows a second of a sweep, with one process and with two, beside `so.distances` on the same rows.

Run from the repository's root: ``python -m benchmarks.sweep [--rows 1000000] [--kind sobol]``,
on a busy machine with ``--cpu``; with ``--cluster`` beside two workers of a local cluster of Dask.
The pair is two ellipsoids, most of them apart; rounds of all take turns, and the best of each
counts. Of the sweeps only the time of their shards is taken, without starting the processes. With
``--cluster`` the files of all runs are compared too: they are the same bytes.
"""

from __future__ import annotations

import argparse
import hashlib
import tempfile
import time
from collections.abc import Callable
from contextlib import ExitStack
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


SHARDS, SHARDS_ON_CLUSTER = 6, 24
"""A first one for each process, and some to be timed: of 10⁵ rows and more, so that what a shard
costs by itself, some 7 ms, is as little beside them as it is in earnest. More of them where two
kinds of two workers are compared, of which one may wait for the last shard of the other."""


def plain(job: Job, *, cpu: bool, with_poses: bool) -> float:
    """Time of the distances alone, or with the making of their poses, s a row."""
    taken = 0.0
    clock = time.process_time if cpu else time.perf_counter
    for first in range(0, job.rows, BLOCK):
        numbers = job.numbers(first, min(first + BLOCK, job.rows))
        began = clock()
        poses = job.poses(numbers)
        if not with_poses:
            began = clock()
        distances(*job.bodies, *poses)
        taken += clock() - began
    return taken / job.rows


digests: set[str] = set()
"""Of the files of all runs."""


def digest_of_files(folder: Path) -> str:
    """SHA-256 of all files and their names."""
    found = hashlib.sha256()
    for file in sorted(folder.rglob("*.json")):
        found.update(file.name.encode() + b"\0" + file.read_bytes())
    return found.hexdigest()


def swept(job: Job, workers: int, *, cpu: bool = False, cluster: str | None = None) -> float:
    """Time of a sweep, from its first shard on, s a row; with a cluster, `workers` are its own."""
    seen: list[tuple[float, int]] = []
    clock = time.process_time if cpu else time.perf_counter
    with tempfile.TemporaryDirectory() as folder:
        run_sweep(
            job,
            Path(folder),
            workers=workers if cluster is None else 1,
            cluster=cluster,
            progress=lambda done, _: seen.append((clock(), done)),
        )
        digests.add(digest_of_files(Path(folder)))
    # With several processes the first shards end together: from then on all of them work.
    start = 0 if workers == 1 else workers
    (began, before), (ended, after) = seen[start], seen[-1]
    return (ended - began) / (after - before)


def local_cluster(held: ExitStack) -> str:
    """Start a cluster of two processes of one thread each; returns its address."""
    from distributed import LocalCluster

    cluster = held.enter_context(
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, protocol="tcp")
    )
    return str(cluster.scheduler_address)


def runs_of(job: Job, *, cpu: bool, cluster: str | None) -> dict[str, Callable[[], float]]:
    """What is timed, by name."""
    runs = {
        "so.distances": lambda: plain(job, cpu=cpu, with_poses=False),
        "with their poses": lambda: plain(job, cpu=cpu, with_poses=True),
        "sweep, 1 process": lambda: swept(job, 1, cpu=cpu),
    }
    if not cpu:
        runs["sweep, 2 processes"] = lambda: swept(job, 2)
    if cluster is not None:
        runs["sweep, Dask, 2 workers"] = lambda: swept(job, 2, cluster=cluster)
    return runs


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rows", type=int, default=1_000_000)
    parser.add_argument("--kind", default="sobol")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--cpu", action="store_true", help="time of the processor; one process")
    parser.add_argument("--cluster", action="store_true", help="a local cluster of Dask as well")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as name, ExitStack() as held:
        folder = Path(name)
        (folder / "scene.toml").write_text(SCENE, encoding="utf-8")
        shard = max(1, given.rows // (SHARDS_ON_CLUSTER if given.cluster else SHARDS))
        text = JOB.format(kind=given.kind, rows=given.rows, shard=shard)
        (folder / "job.toml").write_text(text, encoding="utf-8")
        job = load_job(folder / "job.toml")
        job.answers(0, 1)
        runs = runs_of(job, cpu=given.cpu, cluster=local_cluster(held) if given.cluster else None)
        best = dict.fromkeys(runs, float("inf"))
        for _ in range(given.rounds):
            for told, run in runs.items():
                best[told] = min(best[told], run())
        for told, seconds in best.items():
            share = seconds / best["so.distances"]
            print(
                f"{told:22} {seconds * 1e6:6.2f} µs a row, {1 / seconds:9.0f} rows/s, {share:.2f}"
            )
        if given.cluster:
            ratio = best["sweep, 2 processes"] / best["sweep, Dask, 2 workers"]
            same = "the same" if len(digests) == 1 else "NOT the same"
            print(f"Dask has {ratio:.0%} of the rows/s of two processes; all wrote {same} bytes")


if __name__ == "__main__":
    main()
