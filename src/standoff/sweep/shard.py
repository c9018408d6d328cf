"""One shard: computed, written as text with checksums, and read again."""

from __future__ import annotations

import json
from typing import Any

from standoff.sweep.job import Job, digest_of
from standoff.sweep.summary import Summary

FORMAT, VERSION = "standoff sweep shard", 1

BLOCK = 8192
"""Rows computed at once: their poses and answers, some 5 MB, stay near the processor, and what a
call costs by itself is shared by many."""


class NotThisShard(Exception):
    """A shard's file that is damaged, or belongs to something else; the message says why."""


def computed(job: Job, k: int) -> Summary:
    """Return what is kept of the rows of shard k."""
    return of_rows(job, *job.shard(k))


def of_rows(job: Job, first: int, end: int) -> Summary:
    """Return what is kept of rows first .. end - 1."""
    found = Summary(job.keep)
    for start in range(first, end, BLOCK):
        found.add_rows(job.answers(start, min(start + BLOCK, end)))
    return found


def text_of_shard(job: Job, code: str, k: int, found: Summary) -> str:
    """Return the text of a shard's file: the same for the same job and code.

    Parameters
    ----------
    job : Job
    code : str
        Digest of what computed it.
    k : int
        Number of the shard.
    found : Summary
    """
    first, end = job.shard(k)
    facts: dict[str, Any] = {
        "format": FORMAT,
        "version": VERSION,
        "job": job.digest,
        "code": code,
        "shard": k,
        "first": first,
        "end": end,
        **found.facts(),
    }
    text = json.dumps(facts | {"sha256": digest_of(facts)}, allow_nan=False)
    return f"{text}\n"


def read_shard(job: Job, code: str, k: int, text: bytes) -> Summary:
    """Return what a shard's file holds.

    Raises
    ------
    NotThisShard
        If it is damaged, or is not this shard of this job by this code.
    """
    try:
        facts = json.loads(text)
        own = facts.pop("sha256")
    except (ValueError, KeyError, AttributeError, TypeError) as error:
        raise NotThisShard("it is not a whole file") from error
    if digest_of(facts) != own:
        raise NotThisShard("its content is not what its checksum says")
    first, end = job.shard(k)
    for key, value in (
        *(("format", FORMAT), ("version", VERSION), ("job", job.digest), ("code", code)),
        *(("shard", k), ("first", first), ("end", end)),
    ):
        if facts.get(key) != value:
            raise NotThisShard(f"its {key} is {facts.get(key)!r}, not {value!r}")
    return Summary.from_facts(facts, job.keep)
