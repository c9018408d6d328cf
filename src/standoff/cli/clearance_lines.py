"""The report of ``standoff clearance`` for a reader at a terminal."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from standoff.clearance.assembly import AssemblyFile, Source
from standoff.clearance.facts import body_text
from standoff.clearance.report import (
    COMMON,
    Far,
    Instants,
    PairRow,
    Report,
    bound_texts,
    common_text,
    gap_text,
    no_clearance,
    within_tolerance,
)
from standoff.clearance.verdicts import Verdict
from standoff.cli.summary import line, time_text, vector_text
from standoff.cli.terminal import tell
from standoff.tracking.proximity import shown_size
from standoff.wording import at_least, counted, printable

WIDTH = 120
"""Characters of a table where stdout is not a terminal, such as a file."""

POINT_DIGITS = 5
"""Of the closest points; those in ``--json`` have all."""

STYLES = {
    Verdict.OVERLAPPING: "bold red",
    Verdict.CONTAINED: "bold red",
    Verdict.UNDECIDED: "bold magenta",
    Verdict.TOUCHING: "yellow",
    Verdict.APART: "",
}
"""Of the verdicts, in rich's words."""


def print_report(
    scene: Source, report: Report, looked: Instants, written: Sequence[Path], listed: int | None
) -> None:
    """Print a report: what was looked at, the table of near pairs, of them only the first `listed`
    where that is given, else with all that are far, and what follows from it."""
    tell("\n".join(_head(scene, report, looked)))
    far = report.far if listed is None else ()
    if report.rows or far:
        console = Console(highlight=False)
        if not console.is_terminal:
            console = Console(width=WIDTH, highlight=False)
        rows = report.rows[:listed]
        console.print(_table(rows, far, scene.length_unit, timed=looked.frames > 1))
    tell("\n".join(_tail(scene, report, looked, written, listed)))


def _head(scene: Source, report: Report, looked: Instants) -> list[str]:
    world = report.world
    count = len(report.rows) + len(report.far)
    lines = [
        line(
            "assembly" if isinstance(scene, AssemblyFile) else "scene",
            f"{scene.title}: {counted(len(world.bodies), 'body', 'bodies')}, "
            f"{counted(count, 'pair')} count{'s' if count == 1 else ''}",
        ),
        *(line("", note) for note in scene.notes),
    ]
    if isinstance(scene, AssemblyFile):
        return lines
    if looked.frames == 1:
        return [*lines, line("time", time_text(looked.start))]
    span = f"{time_text(looked.start)} to {time_text(looked.end)}"
    return [
        *lines,
        line("frames", f"{looked.frames} from {span}; of the time between them nothing is said"),
    ]


def _table(rows: Sequence[PairRow], far: Sequence[Far], unit: str, *, timed: bool) -> Table:
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    table.add_column("verdict")
    table.add_column("bodies", overflow="fold")
    table.add_column(f"gap ({unit})" if unit else "gap", justify="right")
    table.add_column("proven", justify="right")
    table.add_column("closest points")
    if timed:
        table.add_column("at")
    volumes = any(row.common is not None for row in rows)
    if volumes:
        table.add_column(f"common ({unit}³)" if unit else "common", justify="right")
    for row in rows:
        cells = [
            Text(row.verdict.name, style=STYLES[row.verdict]),
            Text("\n".join(body_text(row))),
            Text(gap_text(row.answer)),
            Text(_proven(row)),
            Text(_points(row)),
        ]
        more = [time_text(row.nearest.time)] if timed else []
        table.add_row(*cells, *more, *([common_text(row)] if volumes else []))
    for each in far:
        names = "\n".join(map(printable, each.names))
        table.add_row(Verdict.APART.name, Text(names), "", f"≥ {at_least(each.bound)}")
    return table


def _proven(row: PairRow) -> str:
    lower, upper = bound_texts(row)
    return f"≥ {lower}\n≤ {upper}"


def _points(row: PairRow) -> str:
    answer, size = row.answer, shown_size(row.answer)
    return "\n".join(
        vector_text(point, size, POINT_DIGITS) for point in (answer.point_a, answer.point_b)
    )


def _tail(
    scene: Source, report: Report, looked: Instants, written: Sequence[Path], listed: int | None
) -> list[str]:
    unit = scene.length_unit
    lines = []
    hidden = () if listed is None else report.rows[listed:]
    if hidden:
        least = min(row.nearest.lower_bound for row in hidden)
        told = f"{counted(len(hidden), 'pair')}, {at_least(least)} {unit} or more"
        lines.append(line("not listed", told))
    if report.far:
        count, bound = counted(len(report.far), "pair"), f"{at_least(report.least_far)} {unit}"
        lines.append(line("far", f"{count}, proven to be {bound} or more apart"))
    told = ", ".join(f"{n} {verdict.name}" for verdict, n in report.tally().items() if n)
    lines.append(line("verdicts", told or "no pair counts"))
    told = f"{at_least(report.clearance)} {unit}, proven for all pairs"
    lines.append(
        line(
            "clearance",
            told if report.clearance > -math.inf else f"none is proven: {no_clearance(report)}",
        )
    )
    if any(row.common is not None for row in report.rows):
        lines.append(line("common", COMMON))
    lines += _certified(report, looked)
    for k, (names, failure) in enumerate(report.failures):
        lines.append(line("fails" if k == 0 else "", f"{' - '.join(names)}: {failure}"))
    if not report.failures and report.least is not None:
        lines.append(line("keeps", f"{at_least(report.least)} {unit} in every pair, proven"))
    if within_tolerance(report, unit):
        lines.append(line("keeps" if report.failures else "", within_tolerance(report, unit)))
    for k, note in enumerate(report.fits):
        fit = note.fit
        said = f"; {note.note}" if note.note else ""
        text = f"{fit.a} - {fit.b}, {fit.allowance(unit)} ({fit.reason}){said}"
        lines.append(line("allowed" if k == 0 else "", text))
    return [*lines, *(line("wrote" if k == 0 else "", str(p)) for k, p in enumerate(written))]


def _certified(report: Report, looked: Instants) -> list[str]:
    if report.certified:
        return []
    lines = []
    for row in report.rows:
        missed = row.nearest.uncertified
        if missed:
            frames = f" in {counted(missed, 'frame')}" if looked.frames > 1 else ""
            pair = " - ".join(row.names)
            status = ", ".join(status.name for status in row.nearest.statuses)
            lines.append(f"{pair}: {status}{frames}")
    lines += [f"{status.name}: {status.advice}" for status in report.statuses]
    return [line("not certified" if k == 0 else "", text) for k, text in enumerate(lines)]
