"""Jobs that a worker has read: of a process, or of the threads of one on a cluster."""

from __future__ import annotations

import threading

from standoff.errors import StandoffError
from standoff.sweep.job import Job
from standoff.sweep.reading import load_job

_jobs: dict[tuple[str, str], Job] = {}
_reading = threading.Lock()
"""Threads share what one of them has read."""


def job_of(file: str, digest: str) -> Job:
    """Return the job of a file, read once.

    Parameters
    ----------
    file : str
    digest : str
        What the job's is where the sweep was started.

    Raises
    ------
    SceneError
        If it cannot be read here.
    StandoffError
        If it is another job here.
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
