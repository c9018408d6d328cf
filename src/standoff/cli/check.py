"""``standoff check``: what a body's checks at construction found."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any, BinaryIO

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from standoff import __version__
from standoff.bodies.body import Body
from standoff.cli.arguments import CheckCommand
from standoff.cli.body_report import planar_rows, report_rows, solid_rows
from standoff.cli.check_cad import no_cad_file
from standoff.cli.errors import ExitCode, MissingExtra
from standoff.cli.facts import json_text
from standoff.cli.output import Writer, kind_of_picture, picture_targets, write_whole
from standoff.cli.part_file import check_meshes
from standoff.cli.subject import Subject, subjects
from standoff.cli.terminal import tell
from standoff.wording import printable
from standoff.world.shapes import boundary_of, dimension_of_shape, is_solid

WIDTH = 100
"""Characters of a table where stdout is not a terminal, such as a file."""


def run_check(command: CheckCommand) -> int:
    """Report what is known about each body.

    Raises SceneError, CommandError if the scene, shape or file is not usable, which includes a body
    that is refused. Raises WriteError if a picture could not be written.
    """
    no_cad_file(command.what, command.cad)
    check_meshes(Path(command.what), command.meshes)
    found = subjects(command)
    files = _files(found, command.plot)
    write_whole(files)
    if command.json:
        tell(_json(found, list(files)))
    else:
        console = Console(highlight=False)
        if not console.is_terminal:
            console = Console(width=WIDTH, highlight=False)
        for subject in found:
            console.print(_table(subject))
        for target in files:
            tell(f"wrote {target}")
    return ExitCode.DONE


def _files(found: list[Subject], plot: Path | None) -> dict[Path, Writer]:
    targets = picture_targets(plot, [subject.name for subject in found])
    return {
        target: _writer(subject, kind_of_picture(target))
        for target, subject in zip(targets, found, strict=plot is not None)
    }


def _writer(subject: Subject, ending: str) -> Writer:
    try:
        from standoff.bodies.drawing.body_picture import draw_body
    except ModuleNotFoundError as error:
        raise MissingExtra(str(error.name)) from error

    def write(file: BinaryIO) -> None:
        if _is_planar_solid(subject.body):
            subject.body.plot(unit=subject.unit).savefig(file, format=ending)
            return
        body = boundary_of(subject.body)
        draw_body(body, body.check(), subject.name, subject.unit).savefig(file, format=ending)

    return write


def _json(found: list[Subject], files: list[Path]) -> str:
    facts = [_facts(subject) for subject in found]
    written = {"files": [str(path) for path in files]}
    if len(facts) == 1:
        return json_text({"standoff": __version__} | facts[0] | written)
    return json_text({"standoff": __version__, "bodies": facts} | written)


def _is_planar_solid(shape: Any) -> bool:
    return is_solid(shape) and dimension_of_shape(shape) == 2


def _facts(subject: Subject) -> dict[str, Any]:
    body = boundary_of(subject.body)
    if _is_planar_solid(body):
        return {
            "body": subject.name,
            "shape": body.name,
            "convex": False,
            "length_unit": subject.unit,
            "report": {"dimension": 2, "loops": len(body.loops), "edges": body.n_edges}
            | {key: getattr(body, key) for key in ("size", "area", "area_error", "slack")},
            "notes": list(subject.notes),
        }
    return {
        "body": subject.name,
        "shape": body.name,
        "convex": isinstance(body, Body),
        "length_unit": subject.unit,
        "radius": body.radius,
        "digest": body.digest,
        "report": asdict(body.check()),
        "notes": list(subject.notes),
    }


def _table(subject: Subject) -> Table:
    body = subject.body
    table = Table(
        "what",
        "found",
        title=Text(printable(f"{subject.name}: {body.name}")),
        title_justify="left",
        box=SIMPLE_HEAD,
        pad_edge=False,
    )
    rows_of = report_rows if isinstance(body, Body) else solid_rows
    rows = (planar_rows if _is_planar_solid(body) else rows_of)(body, subject.unit)
    rows += [("file", note) for note in subject.notes]
    for what, found in rows:
        table.add_row(what, Text(printable(found)))  # as text: in markup "[unit]" is a style
    return table
