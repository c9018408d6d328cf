"""``standoff check``: what a body's checks at construction found."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from standoff import __version__
from standoff.bodies.body import Body
from standoff.cli.arguments import CheckCommand
from standoff.cli.errors import CommandError, ExitCode
from standoff.cli.facts import json_text
from standoff.cli.output import Writer, check_target, write_whole
from standoff.cli.subject import Subject, subjects

PLOT_ENDINGS = (".png", ".svg", ".pdf")

WIDTH = 100
"""Characters of a table where stdout is no terminal, such as a file."""


def run_check(command: CheckCommand) -> int:
    """Tell what is known about each body.

    Raises
    ------
    SceneError, CommandError
        If the scene, shape or file is not usable, which includes a body that is refused.
    WriteError
        If a picture could not be written.
    """
    found = subjects(command.what, command.body)
    targets = [_target(command.plot, subject, found) for subject in found]
    files = _files(found, targets)
    write_whole(files)
    if command.json:
        print(_json(found, list(files)))
    else:
        console = Console(highlight=False)
        if not console.is_terminal:
            console = Console(width=WIDTH, highlight=False)
        for subject in found:
            console.print(_table(subject))
        for target in files:
            print(f"wrote {target}")
    return ExitCode.DONE


def _target(plot: Path | None, subject: Subject, found: list[Subject]) -> Path | None:
    """The picture of one body: as the option names it, or with the body's name at its end."""
    if plot is None or len(found) == 1:
        return plot
    plain = "".join(
        letter if letter.isalnum() or letter in "-_" else "_" for letter in subject.name
    )
    return plot.with_name(f"{plot.stem}-{plain}{plot.suffix}")


def _files(found: list[Subject], targets: list[Path | None]) -> dict[Path, Writer]:
    files: dict[Path, Writer] = {}
    for subject, target in zip(found, targets, strict=True):
        if target is None:
            continue
        check_target(target, "--plot", PLOT_ENDINGS)
        if target in files:
            raise CommandError(
                f"--plot {target}: two bodies would be drawn to this file; pick one with --body"
            )
        files[target] = _writer(subject, target.suffix.lower().removeprefix("."))
    return files


def _writer(subject: Subject, ending: str) -> Writer:
    from standoff.cli.body_picture import write_body

    return lambda path: write_body(path, ending, subject.body, subject.name, subject.unit)


def _json(found: list[Subject], files: list[Path]) -> str:
    facts = [_facts(subject) for subject in found]
    written = {"files": [str(path) for path in files]}
    if len(facts) == 1:
        return json_text({"standoff": __version__} | facts[0] | written)
    return json_text({"standoff": __version__, "bodies": facts} | written)


def _facts(subject: Subject) -> dict[str, Any]:
    body = subject.body
    return {
        "body": subject.name,
        "shape": body.name,
        "length_unit": subject.unit,
        "radius": body.radius,
        "digest": body.digest,
        "report": asdict(body.check()),
    }


def _table(subject: Subject) -> Table:
    body = subject.body
    table = Table(
        "what",
        "found",
        title=f"{subject.name}: {body.name}",
        title_justify="left",
        box=SIMPLE_HEAD,
        pad_edge=False,
    )
    for what, found in _rows(body, subject.unit):
        table.add_row(what, found)
    return table


def _rows(body: Body, unit: str) -> list[tuple[str, str]]:
    report = body.check()
    smooth = f" ({report.smooth_edges} smooth)" if report.smooth_edges else ""
    skin = f"{body.radius:.9g} {unit}, swept over the core" if body.radius else "none"
    return [
        ("dimension", "2, planar" if report.dimension == 2 else "3, spatial"),
        ("faces", f"{report.faces}, in {_many(report.charts, 'chart')}"),
        ("edges", f"{report.edges}{smooth}"),
        ("vertices", str(report.vertices)),
        ("size", f"{report.size:.9g} {unit}" if body.bounded else "unbounded"),
        ("radius", skin),
        ("convexity defect", f"{report.convexity_defect:.3g} {unit}"),
        *(("note", note) for note in report.notes),
    ]


def _many(count: int, noun: str) -> str:
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"
