"""What a sweep will take, from some of its rows."""

from __future__ import annotations

import os
import time
from typing import NamedTuple

from standoff.checks.numbers import whole_number
from standoff.sweep.job import Job, check_job
from standoff.sweep.shard import text_of_shard
from standoff.sweep.summary import MOST_UNCERTIFIED, Summary

PROBES, PROBE_ROWS = 8, 1024
"""Places of the sweep that are looked at, evenly apart, and rows at each."""


class Estimate(NamedTuple):
    """What a sweep will take.

    Attributes
    ----------
    rows, shards : int
    tried : int
        Rows that were computed for it.
    row_seconds : float
        Time of a row on one processor, s.
    processes : int
        Workers that have a processor of their own.
    seconds : float
        Time of the whole, s.
    size : int
        Bytes of all files, about.
    uncertified : int
        Of the rows that were tried.
    """

    rows: int
    shards: int
    tried: int
    row_seconds: float
    processes: int
    seconds: float
    size: int
    uncertified: int


def estimated(job: Job, workers: int = 1) -> Estimate:
    """Compute some thousand rows, and tell what all of them will take; writes nothing.

    Raises TypeError, ValueError: no job, or a number of workers that is not positive.

    Parameters
    ----------
    job : Job
    workers : int
        As of `run_sweep`.
    """
    check_job(job)
    whole_number(workers, "workers")
    starts = sorted({job.rows * k // PROBES for k in range(PROBES)})
    job.answers(0, 1)  # compiles, where that is still to be done
    found, began = Summary(job.keep), time.perf_counter()
    for first, next_first in zip(starts, [*starts[1:], job.rows], strict=True):
        end = min(first + PROBE_ROWS, next_first)
        found.add_rows(job.answers(first, end))
    each = (time.perf_counter() - began) / found.rows
    processes = max(1, min(workers, os.cpu_count() or 1, job.shards))
    # With as many workers as shards, the longest worker counts.
    rounds = -(-job.shards // processes)
    longest = min(job.rows, rounds * job.shard_rows)
    return Estimate(
        rows=job.rows,
        shards=job.shards,
        tried=found.rows,
        row_seconds=each,
        processes=processes,
        seconds=each * longest,
        size=_size(job, found),
        uncertified=found.uncertified.count,
    )


def _size(job: Job, found: Summary) -> int:
    """Bytes of all shards: each has its lists as long as the share of such rows makes them."""
    empty = len(text_of_shard(job, "0" * 64, 0, Summary(job.keep)))
    listed = len(found.worst.row) + len(found.below.rows.row) + len(found.uncertified.rows.row)
    text = len(text_of_shard(job, "0" * 64, 0, found))
    row = (text - empty) / max(1, listed)
    shard = min(job.shard_rows, job.rows)
    shares = (
        (found.below.count, job.keep.most_below),
        (found.uncertified.count, MOST_UNCERTIFIED),
    )
    rows = min(shard, job.keep.worst) + sum(
        min(shard * count // found.rows, most) for count, most in shares
    )
    return int(job.shards * (empty + row * rows))
