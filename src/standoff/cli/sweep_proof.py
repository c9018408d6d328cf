"""``standoff sweep --prove``: a clearance over the whole box of parameters."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from standoff.checks.real_numbers import shown
from standoff.cli.errors import CommandError, ExitCode
from standoff.cli.facts import json_text
from standoff.cli.summary import line
from standoff.cli.sweep_arguments import SweepCommand
from standoff.cli.sweep_lines import (
    FIRST_ROWS,
    TIMES,
    grouped,
    named,
    parameters_line,
    scaled,
)
from standoff.cli.terminal import tell
from standoff.sweep.folder import REPORT
from standoff.sweep.job import Job
from standoff.sweep.proof.estimate import ProofEstimate, estimated_proof
from standoff.sweep.proof.proof import Proof
from standoff.sweep.proof.report import ProofReport, proof_facts
from standoff.sweep.proof.summary import Kind, Places
from standoff.wording import at_least, counted

ASKED = "clearance="
JSON_PLACES = 10
"""Places of each list that ``--json`` prints; report.json has all."""


def clearance_of(text: str) -> float:
    """Return the length that ``--prove`` names.

    Raises CommandError.
    """
    told = f"--prove: give the length that is to be kept, such as: --prove {ASKED}0.005"
    if not text.startswith(ASKED):
        raise CommandError(f"{told}; got {shown(text)}")
    try:
        clearance = float(text.removeprefix(ASKED))
    except ValueError:
        raise CommandError(f"{told}; got {shown(text)}") from None
    if not math.isfinite(clearance) or clearance < 0.0:
        raise CommandError(f"{told}; a length is zero or above, got {shown(text)}")
    return clearance


def check_proof_options(command: SweepCommand) -> None:
    """Refuse what does not go with ``--prove``, before the job is read.

    Raises CommandError.
    """
    if command.prove is None:
        return
    clearance_of(command.prove)
    if command.row is not None:
        raise CommandError("--row and --prove: a proof has no rows; give one of them")
    if command.page is not None:
        raise CommandError("--page: shows rows, and a proof has none; leave it out")
    if command.plot is not None:
        raise CommandError(
            "--plot: draws the histogram of rows, and a proof has none; leave it out"
        )


def asked_proof(command: SweepCommand, job: Job) -> Proof:
    """Return the proof that a command asks for."""
    assert command.prove is not None  # else there is none
    return Proof(job, clearance_of(command.prove))


def tell_proof_estimate(command: SweepCommand, proof: Proof) -> int:
    """Tell what a proof will take at most."""
    found = estimated_proof(proof, command.workers)
    tell(json_text(found._asdict()) if command.json else "\n".join(_estimate_lines(proof, found)))
    return ExitCode.DONE


def tell_proof(command: SweepCommand, report: ProofReport, folder: Path) -> int:
    """Tell what was shown; the exit code says whether the clearance is proven everywhere."""
    if command.json:
        facts: dict[str, Any] = proof_facts(report, JSON_PLACES) | {"folder": str(folder)}
        tell(json_text(facts))
    else:
        tell("\n".join(proof_lines(report, folder)))
    return ExitCode.DONE if report.holds else ExitCode.NOT_CERTIFIED


def _head(proof: Proof) -> list[str]:
    job, unit = proof.job, proof.job.subject.length_unit
    return [
        line("prove", f"{job.title}: {job.subject.name}, clearance {proof.clearance:g} {unit}"),
        parameters_line(job),
    ]


def proof_lines(report: ProofReport, folder: Path) -> list[str]:
    """Return the lines that sum up a proof."""
    proof, found = report.proof, report.found
    unit = proof.job.subject.length_unit
    lines = [
        *_head(proof),
        line("verdict", f"{found.verdict.name}: {_advice(report)}"),
        *(line(kind.name.lower(), _share(report, kind)) for kind in Kind),
    ]
    if math.isfinite(found.bound):
        lines.append(line("bound", f"nowhere nearer than {at_least(found.bound)} {unit}; proven"))
    missed = "" if not found.uncertified else f", {grouped(found.uncertified)} not certified"
    lines.append(line("queries", f"{grouped(found.queries)}{missed}"))
    lines += _places(proof, "nearest", found.nearest.places)
    lines += _places(proof, "nearer", found.counterexamples.places)
    if not found.counterexamples.count:
        lines += _places(proof, "open", found.open.places)
    return [*lines, line("wrote", str(folder / REPORT))]


def _advice(report: ProofReport) -> str:
    found = report.found
    if report.holds:
        return "the clearance is kept everywhere in the box"
    if found.counterexamples.count:
        places = counted(found.counterexamples.count, "place")
        return f"{places} were found that are nearer; the first are below"
    return (
        "neither is proven: allow more queries or a smaller 'finest' in [prove], or ask for a "
        "little less"
    )


def _share(report: ProofReport, kind: Kind) -> str:
    found = report.found
    cells = counted(found.number(kind), "cell")
    return f"{100.0 * float(found.share(kind)):.6g} % of the box, {cells}"


def _places(proof: Proof, name: str, places: Places) -> list[str]:
    unit = proof.job.subject.length_unit
    lines = []
    for k in range(min(FIRST_ROWS, len(places.distance))):
        distance, bound = float(places.distance[k]), float(places.bound[k])
        told = f"{distance:.6g} {unit} at {named(proof.job, places.numbers[k])}"
        if name == "open" and not math.isfinite(distance):
            told = f"not asked, around {named(proof.job, places.numbers[k])}"
        elif name == "open":
            told += f", {at_least(bound)} {unit} proven around it"
        lines.append(line(name if k == 0 else "", told))
    return lines


def _estimate_lines(proof: Proof, found: ProofEstimate) -> list[str]:
    processes = counted(found.processes, "process", "processes")
    tried = counted(found.tried, "query", "queries", grouped)
    shown = f"{100.0 * found.proven:.3g} % proven, {100.0 * found.violated:.3g} % violated"
    return [
        *_head(proof),
        line("shards", f"{found.shards}"),
        line("tried", f"{tried}, {found.query_seconds * 1e6:.3g} µs each"),
        line("after these", f"{shown} of the box"),
        line("time", f"at most {scaled(found.seconds, TIMES, 's')} with {processes}"),
    ]
