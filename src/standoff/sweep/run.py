"""A sweep run, or gone on with: shards computed by processes, then merged in their order."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from standoff.checks.numbers import whole_number
from standoff.errors import StandoffError
from standoff.progress import Progress
from standoff.sweep.cluster import made_on_cluster
from standoff.sweep.folder import (
    REPORT,
    indented,
    kept_shard,
    locked,
    make_shard,
    missing_shards,
    prepare,
    put_text,
    refuse_others,
    shard_file,
)
from standoff.sweep.job import Job, check_job
from standoff.sweep.known_works import work_of
from standoff.sweep.proof.proof import Proof, check_proof
from standoff.sweep.proof.report import ProofReport, proof_facts
from standoff.sweep.report import Report, report_facts
from standoff.sweep.shard import NotThisShard
from standoff.sweep.work import ShardWork, Token
from standoff.whole_files import file_name
from standoff.worker_processes import result_of, worker_processes

Tell = Callable[[str], None]

AHEAD = 2
"""Shards per process that are handed out before they are asked for."""


def run_sweep(
    job: Job,
    folder: str | Path,
    *,
    workers: int = 1,
    cluster: str | None = None,
    progress: Progress | None = None,
    tell: Tell = lambda line: None,
) -> Report:
    """Compute a sweep's shards that are not in a folder yet, and write the report.

    Stopped at any moment, it goes on where it was when it is run again. The files of the folder
    are the same, byte for byte, for any number of workers and of stops.

    Parameters
    ----------
    job : Job
    folder : str or Path
        Made if it is not there.
    workers : int
        Processes that share the shards.
    cluster : str, optional
        Address of Dask's scheduler, whose workers share them in place of processes.
    progress : callable, optional
        Called with the rows done and the rows in all.
    tell : callable
        Called with a line about each file that could not be used.

    Returns
    -------
    Report

    Raises
    ------
    TypeError, ValueError
        No job, no name of a folder, or a number of workers that is not positive.
    FolderError
        If another run holds the folder, or it holds something else, or another job.
    OSError
        If a file cannot be written, as on a full disk, or the cluster is lost; whole shards stay.
    ModuleNotFoundError
        If a cluster is named and Dask is not installed.
    """
    check_job(job)
    with _all_made(job, folder, workers, cluster, progress, tell) as (where, found):
        report = Report(job, found)
        put_text(where / REPORT, indented(report_facts(report)))
        return report


def run_proof(
    proof: Proof,
    folder: str | Path,
    *,
    workers: int = 1,
    cluster: str | None = None,
    progress: Progress | None = None,
    tell: Tell = lambda line: None,
) -> ProofReport:
    """Search a box of parameters part by part, or go on with it, and write the report.

    Raises TypeError, ValueError, FolderError, OSError, ModuleNotFoundError as of `run_sweep`.

    Parameters
    ----------
    proof : Proof
    folder, workers, cluster, tell
        As of `run_sweep`.
    progress : callable, optional
        Called with the parts done and the parts in all.

    Returns
    -------
    ProofReport
    """
    check_proof(proof)
    with _all_made(proof, folder, workers, cluster, progress, tell) as (where, found):
        report = ProofReport(proof, found)
        put_text(where / REPORT, indented(proof_facts(report)))
        return report


@contextmanager
def _all_made(
    work: ShardWork,
    folder: str | Path,
    workers: int,
    cluster: str | None,
    progress: Progress | None,
    tell: Tell,
) -> Iterator[tuple[Path, Any]]:
    """The folder, locked, and what is kept of all shards, once all are made."""
    whole_number(workers, "workers")
    folder = file_name(folder)
    folder.mkdir(parents=True, exist_ok=True)
    refuse_others(folder)
    with locked(folder):
        prepare(folder, work)
        missing = missing_shards(work, folder, tell)
        done = work.rows - sum(_length(work, k) for k in missing)
        if progress is not None:
            progress(done, work.rows)
        if cluster is None:
            made = _made(work, folder, missing, workers)
        else:
            made = made_on_cluster(work, folder, missing, cluster)
        for k in made:
            done += _length(work, k)
            if progress is not None:
                progress(done, work.rows)
        yield folder, merged(work, folder)


def merged(work: ShardWork, folder: Path) -> Any:
    """Return what is kept of all rows, from the files of all shards.

    Raises StandoffError if one is missing, or is not what was written.
    """
    found = work.nothing()
    for k in range(work.shards):
        try:
            part = kept_shard(work, folder, k)
        except NotThisShard as error:
            raise StandoffError(
                f"{shard_file(folder, k)} was changed: {error}", "folder"
            ) from error
        if part is None:
            raise StandoffError(f"{shard_file(folder, k)} was removed: run it again", "folder")
        found.add(part)
    return found


def _length(work: ShardWork, k: int) -> int:
    first, end = work.shard(k)
    return end - first


def _made(work: ShardWork, folder: Path, missing: Sequence[int], workers: int) -> Iterator[int]:
    """Make shards; yields each one's number when it is there."""
    if workers == 1 or len(missing) < 2:
        for k in missing:
            yield make_shard(work, folder, k)
        return
    # Here, so that one process compiles what is not compiled yet.
    work.try_one(missing[0])
    given = work.token, os.path.abspath(folder)
    with worker_processes(min(workers, len(missing))) as pool:
        left, running = list(reversed(missing)), set[Future[int]]()
        while left or running:
            while left and len(running) < AHEAD * workers:
                running.add(pool.submit(_work, *given, left.pop()))
            ended, running = wait(running, return_when=FIRST_COMPLETED)
            for each in ended:
                yield result_of(each)  # of one that was given up there is no file


def _work(token: Token, folder: str, k: int) -> int:
    return make_shard(work_of(token), Path(folder), k)
