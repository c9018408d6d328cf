"""``standoff check``: what a body's checks at construction found."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from standoff import __version__
from standoff.bodies.body import Body
from standoff.cli.arguments import CheckCommand
from standoff.cli.errors import ExitCode
from standoff.cli.facts import json_text
from standoff.cli.subject import Subject, subjects

WIDTH = 100
"""Characters of a table where stdout is no terminal, such as a file."""


def run_check(command: CheckCommand) -> int:
    """Tell what is known about each body.

    Raises
    ------
    SceneError, CommandError
        If the scene, shape or file is not usable, which includes a body that is refused.
    """
    found = subjects(command.what, command.body)
    if command.json:
        print(_json(found))
    else:
        console = Console(highlight=False)
        if not console.is_terminal:
            console = Console(width=WIDTH, highlight=False)
        for subject in found:
            console.print(_table(subject))
    return ExitCode.DONE


def _json(found: list[Subject]) -> str:
    facts = [_facts(subject) for subject in found]
    if len(facts) == 1:
        return json_text({"standoff": __version__} | facts[0])
    return json_text({"standoff": __version__, "bodies": facts})


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
