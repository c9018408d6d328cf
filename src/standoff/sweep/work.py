"""What shards are parts of: the rows of a job, or the cells of a proof."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from standoff.sweep.job import Job
from standoff.sweep.known_jobs import job_of
from standoff.sweep.proof.proof import Proof
from standoff.sweep.proof.summary import ProofSummary
from standoff.sweep.summary import Summary

Work = Job | Proof
Found = Summary | ProofSummary

BLOCK = 8192
"""Rows computed at once: their poses and answers, some 5 MB, stay near the processor, and what a
call costs by itself is shared by many."""


def nothing(work: Work) -> Any:
    """Return a summary of no shard."""
    if isinstance(work, Proof):
        return ProofSummary(work.most, len(work.job.parameters))
    return Summary(work.keep)


def summary_of(work: Work, facts: Mapping[str, Any]) -> Found:
    """Return the summary that a shard's file has as plain data."""
    if isinstance(work, Proof):
        return ProofSummary.from_facts(facts, work.most, len(work.job.parameters))
    return Summary.from_facts(facts, work.keep)


def computed(work: Work, k: int) -> Found:
    """Return what is kept of shard k."""
    return work.computed(k) if isinstance(work, Proof) else of_rows(work, *work.shard(k))


def of_rows(job: Job, first: int, end: int) -> Summary:
    """Return what is kept of rows first .. end - 1."""
    found = Summary(job.keep)
    for start in range(first, end, BLOCK):
        found.add_rows(job.answers(start, min(start + BLOCK, end)))
    return found


def try_one(work: Work, k: int) -> None:
    """Ask once of shard k, so that one process compiles what is not compiled yet."""
    first, _ = work.shard(k)
    if isinstance(work, Proof):
        work.box.look(work.first(k))
    else:
        work.answers(first, first + 1)


def manifest_counts(work: Work) -> dict[str, int]:
    """Return what a manifest tells of it first."""
    if isinstance(work, Proof):
        return {"shards": work.shards}
    return {"rows": work.rows, "shards": work.shards, "seed": work.seed}


Token = tuple[str, str, float | None]


def token_of(work: Work) -> Token:
    """Return what another process knows the work by: `work_of` takes it."""
    clearance = work.clearance if isinstance(work, Proof) else None
    job = work.job if isinstance(work, Proof) else work
    return str(job.file.absolute()), job.digest, clearance


_proofs: dict[Token, Proof] = {}


def work_of(token: Token) -> Work:
    """Return the work of a token, its job's file read once.

    Raises
    ------
    SceneError
        If it cannot be read here.
    StandoffError
        If it is another job here.
    """
    file, digest, clearance = token
    job = job_of(file, digest)
    if clearance is None:
        return job
    if token not in _proofs:
        _proofs[token] = Proof(job, clearance)
    return _proofs[token]
