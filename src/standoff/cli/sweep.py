"""``standoff sweep``: distances at very many poses; totals, a histogram and the worst rows."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from standoff.checks.real_numbers import shown
from standoff.cli.errors import CommandError, ExitCode, MissingExtra, WriteError
from standoff.cli.facts import json_text
from standoff.cli.output import (
    PLOT_ENDINGS,
    check_target,
    kind_of_picture,
    make_folder,
    write_whole,
)
from standoff.cli.progress import progress_bar
from standoff.cli.summary import line
from standoff.cli.sweep_arguments import SweepCommand
from standoff.cli.sweep_lines import (
    FIRST_ROWS,
    TIMES,
    estimate_lines,
    grouped,
    named,
    parameters_line,
    report_lines,
    row_facts,
    row_lines,
    scaled,
)
from standoff.cli.terminal import tell
from standoff.errors import StandoffError
from standoff.sweep.estimate import estimated
from standoff.sweep.folder import REPORT, FolderError
from standoff.sweep.job import Job
from standoff.sweep.proof.estimate import ProofEstimate, estimated_proof
from standoff.sweep.proof.proof import Proof
from standoff.sweep.proof.report import ProofReport, proof_facts
from standoff.sweep.proof.summary import Kind, Places
from standoff.sweep.reading import load_job
from standoff.sweep.report import Report, report_facts
from standoff.sweep.run import run_proof, run_sweep
from standoff.tracking.answers import PROVEN
from standoff.tracking.pair_plot import plot as pair_figure
from standoff.wording import at_least, counted

JSON_ROWS = 10
"""Rows of each list that ``--json`` prints; report.json has all."""


def run_sweep_command(command: SweepCommand) -> int:
    """Run a sweep, or go on with it; the exit code says whether all rows keep what is asked.

    Raises SceneError, CommandError: the job, an option or the folder is not usable. Raises
    WriteError: a file could not be written.
    """
    _check(command)
    job = load_job(command.job)
    _check_page(command)
    _check_plot(command, job)
    try:
        if command.prove is not None:
            return _prove(command, asked_proof(command, job))
        if command.row is not None:
            return _row(command, job, command.row)
        if command.estimate:
            return _estimate(command, job)
        return _sweep(command, job)
    except FolderError as error:
        raise CommandError(f"-o {error}") from error
    except KeyboardInterrupt:
        tell("standoff: interrupted; the same command goes on where it was", error=True)
        return ExitCode.INTERRUPTED
    except (StandoffError, ModuleNotFoundError) as error:
        raise CommandError(f"{command.job}: {error}") from error


def _check(command: SweepCommand) -> None:
    check_proof_options(command)
    if command.workers < 1:
        raise CommandError(f"--workers: must be 1 or more, got {command.workers}")
    if command.cluster is not None and command.workers != 1:
        raise CommandError("--cluster and --workers: the cluster has its own; leave --workers out")
    alone = "--estimate" if command.estimate else "--row"
    if command.estimate and command.row is not None:
        raise CommandError("--estimate and --row: give one of them")
    if command.estimate or command.row is not None:
        if command.output is not None:
            raise CommandError(f"-o: {alone} writes nothing; leave it out")
    elif command.output is None or not command.output.name:
        raise CommandError("-o: name the folder for shards and report, such as: -o swept")


def _check_page(command: SweepCommand) -> None:
    """Refuse a page that could not be made or written afterwards."""
    if command.page is None:
        return
    if command.estimate or command.row is not None:
        alone = "--estimate" if command.estimate else "--row"
        raise CommandError(f"--page: is of a whole sweep, and {alone} is not; leave it out")
    check_target(command.page, "--page", (".html",))
    try:
        import standoff.sweep.page  # noqa: F401
    except ModuleNotFoundError as error:
        raise MissingExtra(str(error.name), "plot") from error


def _check_plot(command: SweepCommand, job: Job) -> None:
    """Refuse a picture that could not be drawn or written afterwards."""
    if command.plot is None:
        return
    if command.estimate:
        raise CommandError("--plot: --estimate writes nothing; leave it out")
    check_target(command.plot, "--plot", PLOT_ENDINGS)
    if command.row is None and job.keep.bins is None:
        raise CommandError(
            f"--plot: {command.job} keeps no histogram; add to [keep] a line such as: "
            "histogram = { from = 0.0, to = 1.0, bins = 50 }"
        )
    try:
        import standoff.sweep.plot  # noqa: F401
    except ModuleNotFoundError as error:
        raise MissingExtra(str(error.name), "plot") from error


def _draw(command: SweepCommand, figure: Any) -> None:
    target = command.plot
    assert target is not None  # else nothing is drawn
    ending = kind_of_picture(target)
    write_whole({target: lambda file: figure.savefig(file, format=ending)})


def _row(command: SweepCommand, job: Job, row: int) -> int:
    if not 0 <= row < job.rows:
        raise CommandError(f"--row: the job has rows 0 to {job.rows - 1}, got {row}")
    found = job.alone(row)
    if command.plot is not None:
        if found.nearest is None:
            raise CommandError(f"--plot: row {row} has no pair within the horizon to be drawn")
        _draw(command, pair_figure(*found.shapes, found.nearest, unit=job.subject.length_unit))
    if command.json:
        tell(json_text(row_facts(job, row, found)))
    else:
        tell("\n".join(row_lines(job, row, found)))
    certified = bool(PROVEN[found.rows.status[0]])
    return ExitCode.DONE if certified else ExitCode.NOT_CERTIFIED


def _estimate(command: SweepCommand, job: Job) -> int:
    found = estimated(job, command.workers)
    if command.json:
        tell(json_text(found._asdict()))
    else:
        tell("\n".join(estimate_lines(job, found)))
    return ExitCode.DONE


def _prove(command: SweepCommand, proof: Proof) -> int:
    if command.estimate:
        return tell_proof_estimate(command, proof)
    report, folder = _carried_out(command, "proving", partial(run_proof, proof))
    return tell_proof(command, report, folder)


def _carried_out(command: SweepCommand, doing: str, run: Callable[..., Any]) -> tuple[Any, Path]:
    """The report of a run, and its folder; whatever ends it early is told."""
    folder = command.output
    assert folder is not None  # as `_check` has seen
    make_folder(folder, "-o")
    try:
        with progress_bar(doing) as progress:
            report = run(
                folder,
                workers=command.workers,
                cluster=command.cluster,
                progress=progress,
                tell=lambda line: tell(f"standoff: {line}", error=True),
            )
    except OSError as error:
        raise WriteError(
            f"{folder}: {error}; what is whole stays: the same command goes on from there"
        ) from error
    return report, folder


def _sweep(command: SweepCommand, job: Job) -> int:
    report, folder = _carried_out(command, "sweeping", partial(run_sweep, job))
    if command.plot is not None:
        from standoff.sweep.plot import histogram_figure

        _draw(command, histogram_figure(report))
    if command.page is not None:
        from standoff.sweep.page import page_of

        page = page_of(report)
        write_whole({command.page: lambda file: file.write(page.encode("utf-8"))})
    _print(command, report, folder)
    return ExitCode.DONE if report.holds else ExitCode.NOT_CERTIFIED


def _print(command: SweepCommand, report: Report, folder: Path) -> None:
    files = [str(file) for file in (command.plot, command.page) if file is not None]
    if command.json:
        facts = report_facts(report, JSON_ROWS) | {"folder": str(folder)}
        tell(json_text(facts | ({"files": files} if files else {})))
    else:
        tell("\n".join([*report_lines(report, folder), *(line("wrote", file) for file in files)]))


# ``standoff sweep --prove``: a clearance over the whole box of parameters.

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
