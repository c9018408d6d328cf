"""Jobs and proofs that a worker has read: of a process, or of the threads of one on a cluster."""

from __future__ import annotations

import threading

from standoff.errors import StandoffError
from standoff.sweep.job import Job
from standoff.sweep.proof.proof import Proof
from standoff.sweep.reading import load_job
from standoff.sweep.work import ShardWork, Token

_jobs: dict[tuple[str, str], Job] = {}
_proofs: dict[Token, Proof] = {}
_reading = threading.Lock()
"""Threads share what one of them has read."""


def job_of(file: str, digest: str) -> Job:
    """Return the job of a file, read once.

    Raises SceneError if it cannot be read here. Raises StandoffError if it is another job here.

    Parameters
    ----------
    file : str
    digest : str
        What the job's is where the sweep was started.
    """
    with _reading:
        job = _jobs.get((file, digest))
        if job is None:
            job = load_job(file)
            if job.digest != digest:
                raise StandoffError(
                    f"a worker finds another job in {file}: it was changed while the sweep began, "
                    "or is not the same on all machines; put that right and run it again",
                    "job",
                )
            _jobs[file, digest] = job
    return job


def work_of(token: Token) -> ShardWork:
    """Return the work of a token, its job's file read once.

    Raises SceneError, StandoffError as of `job_of`.
    """
    file, digest, clearance = token  # a cluster may send it as a plain tuple
    job = job_of(file, digest)
    if clearance is None:
        return job
    if token not in _proofs:
        _proofs[token] = Proof(job, clearance)
    return _proofs[token]
