"""The report of a sweep as plain data."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from standoff.sweep.code import code_facts
from standoff.sweep.digests import digest_of
from standoff.sweep.job import Job
from standoff.sweep.rows import Rows
from standoff.sweep.summary import Listed, Summary
from standoff.typing import Array


class Report(NamedTuple):
    """What a sweep found.

    Attributes
    ----------
    job : Job
    found : Summary
        Of all rows.
    """

    job: Job
    found: Summary

    @property
    def certified(self) -> bool:
        """Is every row's answer proven?"""
        return self.found.uncertified.count == 0

    @property
    def holds(self) -> bool:
        """Are all answers proven, and all rows as far apart as the job asks?"""
        return self.certified and self.found.below.count == 0


def report_facts(report: Report, most: int | None = None) -> dict[str, Any]:
    """Return the report as plain data that JSON can hold.

    Parameters
    ----------
    report : Report
    most : int, optional
        Rows of each list that are in it; all of them if not given.
    """
    job, found = report.job, report.found
    facts = found.facts()
    distance = facts["distance"]
    distance["mean"] = distance["sum"] / distance["count"] if distance["count"] else None
    if job.keep.bins is not None:
        facts["histogram"] = {"edges": job.keep.bins.edges.tolist(), **facts["histogram"]}
    facts["worst"] = listed_facts(job, found.worst.at(slice(most)))
    for key, listed in (("below", found.below), ("uncertified", found.uncertified)):
        if key in facts:
            facts[key] = _capped(job, listed, most)
    if job.keep.below is not None:
        facts["below"] = {"length": job.keep.below, **facts["below"]}
    return {
        "format": "standoff sweep report",
        "version": 1,
        "title": job.title,
        "length_unit": job.subject.length_unit,
        **job.subject.reported(),
        "job_sha256": job.digest,
        "code_sha256": digest_of(code_facts()),
        "sampler": job.kind,
        "seed": job.seed,
        "parameters": {p.name: {**p.facts(), "columns": p.columns} for p in job.parameters},
        "holds": report.holds,
        **facts,
    }


def _capped(job: Job, listed: Listed, most: int | None) -> dict[str, Any]:
    rows = listed.rows.at(slice(most))
    all_listed = listed.count == len(rows.row)
    return {"count": listed.count, "all_listed": all_listed, **listed_facts(job, rows)}


def listed_facts(job: Job, rows: Rows) -> dict[str, Any]:
    """Return rows as plain data with their parameters, computed from their numbers; of several
    pairs, with the names of the nearest."""
    numbers = numbers_of(job, rows.row.tolist())
    columns = {name: numbers[:, k].tolist() for k, name in enumerate(job.columns)}
    facts = rows.facts()
    if "pair" in facts:
        facts["pair"] = [job.subject.pair_names(number) for number in facts["pair"]]
    return {**facts, "parameters": columns}


def numbers_of(job: Job, rows: Sequence[int]) -> Array:
    """Return the parameters of some rows, shape (n, columns), each computed by itself."""
    found = np.empty((len(rows), len(job.columns)))
    # In their order: a file is then read once.
    for k in np.argsort(np.array(rows, dtype=np.int64), kind="stable").tolist():
        found[k] = job.numbers(rows[k], rows[k] + 1)[0]
    return found
