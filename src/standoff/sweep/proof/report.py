"""The report of a proof as plain data."""

from __future__ import annotations

from typing import Any, NamedTuple

from standoff.robots.proof import Verdict
from standoff.sweep.code import code_facts
from standoff.sweep.digests import digest_of
from standoff.sweep.proof.proof import Proof
from standoff.sweep.proof.summary import Places, ProofSummary


class ProofReport(NamedTuple):
    """What was shown of a box of parameters.

    Attributes
    ----------
    proof : Proof
    found : ProofSummary
        Of the whole box.
    """

    proof: Proof
    found: ProofSummary

    @property
    def holds(self) -> bool:
        """Is the clearance proven in the whole box?"""
        return self.found.verdict is Verdict.PROVEN


def proof_facts(report: ProofReport, most: int | None = None) -> dict[str, Any]:
    """Return the report as plain data that JSON can hold.

    Parameters
    ----------
    report : ProofReport
    most : int, optional
        Places of each list that are in it; all of them if not given.
    """
    proof, found = report.proof, report.found
    job = proof.job
    facts = found.facts()
    for name in ("nearest", "counterexamples", "open"):
        facts[name] = _listed(proof, facts[name]["count"], getattr(found, name).places, most)
    for key in ("count", "all_listed"):
        del facts["nearest"][key]  # it is one place
    return {
        "format": "standoff sweep proof",
        "version": 1,
        "title": job.title,
        "length_unit": job.subject.length_unit,
        **job.subject.reported(),
        "job_sha256": proof.digest,
        "code_sha256": digest_of(code_facts()),
        "parameters": {p.name: p.facts() for p in job.parameters},
        "clearance": proof.clearance,
        "finest": proof.box.finest,
        "holds": report.holds,
        **facts,
    }


def _listed(proof: Proof, count: int, places: Places, most: int | None) -> dict[str, Any]:
    """Places with each parameter's numbers under its name."""
    some = places.at(slice(most))
    facts: dict[str, Any] = some.facts()
    names = proof.job.columns
    for key, column in (("numbers", some.numbers), ("half", some.half)):
        del facts[key]
        facts["parameters" if key == "numbers" else "half_sides"] = {
            name: column[:, k].tolist() for k, name in enumerate(names)
        }
    return {"count": count, "all_listed": count == len(some.distance), **facts}
