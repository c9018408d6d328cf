"""``standoff paper``: the figures of the paper, their data and the report."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from standoff import __version__
from standoff.cli.errors import CommandError, ExitCode
from standoff.cli.facts import json_text
from standoff.cli.output import check_target, make_folder, write_whole
from standoff.cli.terminal import tell
from standoff_studies.paper.catalogue import CATALOGUE, UnknownFigure, chosen
from standoff_studies.paper.figure import Entry
from standoff_studies.paper.progress import figures_bar
from standoff_studies.paper.verdicts import Verdict, counted

if TYPE_CHECKING:
    from standoff_studies.paper.making import Made
    from standoff_studies.paper.options import PaperOptions

JOBS = 2
"""Default number of processes: each needs half a gigabyte, and a laptop can spare two."""

REPORT = "report.html"


def run_paper(command: PaperOptions) -> int:
    """Make figures, write their files and the report, and print a summary.

    Raises
    ------
    CommandError
        If a key, the number of processes or the folder cannot be used.
    WriteError
        If the report could not be written.
    """
    if command.list:
        tell(_listing(command))
        return ExitCode.DONE
    try:
        entries = chosen(command.keys)
    except UnknownFigure as error:
        raise CommandError(str(error)) from error
    jobs = JOBS if command.jobs is None else command.jobs
    if jobs < 1:
        raise CommandError(f"--jobs {jobs}: give 1 or more")
    _make_folder(command.output)
    started = time.perf_counter()
    made = _make(entries, command, jobs)
    if made is None:
        return ExitCode.INTERRUPTED
    report = _report(made, command.output)
    seconds = time.perf_counter() - started
    if command.json:
        tell(_json(made, report, seconds))
    else:
        _print(made, report, seconds)
    for one in made:
        if one.error:
            tell(f"standoff: figure {one.entry.key} failed: {one.error}", error=True)
    if any(one.unwritten for one in made):
        return ExitCode.NOT_WRITTEN
    return ExitCode.FAILED if any(one.error for one in made) else ExitCode.DONE


def _listing(command: PaperOptions) -> str:
    if command.json:
        return json_text({"standoff": __version__, "figures": [e._asdict() for e in CATALOGUE]})
    wide = max((len(entry.key) for entry in CATALOGUE), default=0)
    return "\n".join(f"{entry.key:<{wide}}  {entry.title}" for entry in CATALOGUE)


def _make_folder(folder: Path) -> None:
    make_folder(folder, "-o")
    check_target(folder / REPORT, "-o", [".html"])


def _make(entries: Sequence[Entry], command: PaperOptions, jobs: int) -> list[Made] | None:
    """Make the figures; None if it was interrupted, with a message about what is complete."""
    from standoff_studies.paper.processes import Order, make_all

    complete: list[str] = []
    with figures_bar(len(entries)) as show:

        def note(entry: Entry, result: Made | None) -> None:
            if result is not None and not result.error:
                complete.append(entry.key)
            show(entry, result)

        try:
            return make_all(entries, Order(command.output, not command.no_animations), jobs, note)
        except KeyboardInterrupt:
            pass
    written = (
        f"complete in {command.output}: {', '.join(complete)}" if complete else "none complete"
    )
    tell(f"standoff: interrupted; figures {written}; no report was written", error=True)
    return None


def _report(made: Sequence[Made], folder: Path) -> Path:
    from standoff_studies.paper.report import report_html

    text = report_html(made, of=len(CATALOGUE))
    target = folder / REPORT
    write_whole({target: lambda file: file.write(text.encode())})
    return target


def _json(made: Sequence[Made], report: Path, seconds: float) -> str:
    return json_text(
        {
            "standoff": __version__,
            "seconds": seconds,
            "report": str(report),
            "statements": _verdicts(made),
            "failed": [one.entry.key for one in made if one.error],
            "figures": [_facts(one) for one in made],
        }
    )


def _facts(one: Made) -> dict[str, Any]:
    return {
        "key": one.entry.key,
        "title": one.entry.title,
        "chapter": one.entry.chapter,
        "seconds": one.seconds,
        "error": one.error or None,
        "files": [str(path) for path in one.files],
        "statements": [s._asdict() | {"verdict": Verdict.of(s).key} for s in one.statements],
    }


def _verdicts(made: Sequence[Made]) -> dict[str, int]:
    counts = counted(statement for one in made for statement in one.statements)
    return {verdict.key: count for verdict, count in counts.items()}


def _print(made: Sequence[Made], report: Path, seconds: float) -> None:
    console = Console(highlight=False)
    table = Table(box=SIMPLE_HEAD, pad_edge=False, show_footer=True)
    sums = _verdicts(made)
    table.add_column("figure", footer="all")
    table.add_column("shows")
    headings = ("hold", "not", "open", "true", "own")
    for heading, count in zip(headings, sums.values(), strict=True):
        table.add_column(heading, str(count), justify="right")
    table.add_column("s", f"{seconds:.1f}", justify="right")
    for one in made:
        counts = [str(n) if n else "" for n in _verdicts([one]).values()]
        shows = f"{one.entry.title} (failed)" if one.error else one.entry.title
        table.add_row(one.entry.key, shows, *counts, f"{one.seconds:.1f}")
    console.print(table)
    tell(
        "hold, not: what the paper states, measured; open: no verdict; true: true by "
        "construction; own: the paper states nothing"
    )
    tell(f"wrote {report}, and {sum(len(one.files) for one in made)} files beside it")
