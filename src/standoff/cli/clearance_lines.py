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
from standoff.clearance.facts import in_cavity
from standoff.clearance.report import Looked, Report, Row, bound_texts, gap_text, no_clearance
from standoff.clearance.verdicts import Verdict
from standoff.cli.summary import line, time_text, vector_text
from standoff.cli.terminal import tell
from standoff.tracking.proximity import shown_size
from standoff.wording import at_least, counted, printable

WIDTH = 120
"""Characters of a table where stdout is not a terminal, such as a file."""

FIRST_ROWS = 40
"""How many near pairs are listed; all of them with ``--verbose`` and in ``--json``."""

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
    scene: Source, report: Report, looked: Looked, written: Sequence[Path], *, verbose: bool = False
) -> None:
    """Print a report: what was looked at, the table of near pairs, and what follows from it."""
    tell("\n".join(_head(scene, report, looked)))
    if report.rows:
        console = Console(highlight=False)
        if not console.is_terminal:
            console = Console(width=WIDTH, highlight=False)
        shown = report.rows if verbose else report.rows[:FIRST_ROWS]
        console.print(_table(shown, scene.length_unit, timed=looked.frames > 1))
    tell("\n".join(_tail(scene, report, looked, written, verbose=verbose)))


def _head(scene: Source, report: Report, looked: Looked) -> list[str]:
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


def _table(rows: Sequence[Row], unit: str, *, timed: bool) -> Table:
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    table.add_column("verdict")
    table.add_column("bodies", overflow="fold")
    table.add_column(f"gap ({unit})" if unit else "gap", justify="right")
    table.add_column("proven", justify="right")
    table.add_column("closest points")
    if timed:
        table.add_column("at")
    for row in rows:
        cells = [
            Text(row.verdict.name, style=STYLES[row.verdict]),
            Text("\n".join(body_text(row))),
            Text(gap_text(row.answer)),
            Text(_proven(row)),
            Text(_points(row)),
        ]
        table.add_row(*cells, *([time_text(row.nearest.time)] if timed else []))
    return table


def body_text(row: Row) -> list[str]:
    """Return the names of the two bodies, each with that of its piece, and which is in a cavity."""
    answer, within = row.answer, in_cavity(row)
    return [
        printable(" ".join(filter(None, each))) + (", in a cavity" if each[0] == within else "")
        for each in zip(answer.names, answer.pieces, strict=True)
    ]


def _proven(row: Row) -> str:
    lower, upper = bound_texts(row)
    return f"≥ {lower}\n≤ {upper}"


def _points(row: Row) -> str:
    answer, size = row.answer, shown_size(row.answer)
    return "\n".join(
        vector_text(point, size, POINT_DIGITS) for point in (answer.point_a, answer.point_b)
    )


def _tail(
    scene: Source, report: Report, looked: Looked, written: Sequence[Path], *, verbose: bool
) -> list[str]:
    unit = scene.length_unit
    lines = []
    hidden = 0 if verbose else max(0, len(report.rows) - FIRST_ROWS)
    if hidden:
        least = min(row.nearest.lower_bound for row in report.rows[FIRST_ROWS:])
        lines.append(
            line("not listed", f"{counted(hidden, 'pair')}, {at_least(least)} {unit} or more")
        )
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
    lines += _certified(report, looked)
    for k, (names, failure) in enumerate(report.failures):
        lines.append(line("fails" if k == 0 else "", f"{' - '.join(names)}: {failure}"))
    if not report.failures and report.least is not None:
        lines.append(line("keeps", f"{at_least(report.least)} {unit} in every pair, proven"))
    for k, note in enumerate(report.fits):
        fit = note.fit
        said = f"; {note.note}" if note.note else ""
        text = f"{fit.a} - {fit.b}, {fit.allowance(unit)} ({fit.reason}){said}"
        lines.append(line("allowed" if k == 0 else "", text))
    return [*lines, *(line("wrote" if k == 0 else "", str(p)) for k, p in enumerate(written))]


def _certified(report: Report, looked: Looked) -> list[str]:
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
