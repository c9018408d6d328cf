"""``standoff check``: what a body's checks at construction found."""

from __future__ import annotations

from collections import Counter
from dataclasses import asdict
from math import degrees
from pathlib import Path
from typing import Any, BinaryIO

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from standoff import __version__
from standoff.bodies.body import Body
from standoff.bodies.report import BodyReport, BoundaryReport, DihedralAngle
from standoff.cli.arguments import CheckCommand
from standoff.cli.check_cad import no_cad_file
from standoff.cli.errors import ExitCode, MissingExtra
from standoff.cli.facts import json_text
from standoff.cli.output import Writer, kind_of_picture, picture_targets, write_whole
from standoff.cli.part_file import check_meshes
from standoff.cli.subject import CheckedSubject, subjects
from standoff.cli.terminal import tell
from standoff.solids.planar.solid import PlanarSolid
from standoff.solids.spatial.solid import Solid
from standoff.wording import counted, printable
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


def _files(found: list[CheckedSubject], plot: Path | None) -> dict[Path, Writer]:
    targets = picture_targets(plot, [subject.name for subject in found])
    return {
        target: _writer(subject, kind_of_picture(target))
        for target, subject in zip(targets, found, strict=plot is not None)
    }


def _writer(subject: CheckedSubject, ending: str) -> Writer:
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


def _json(found: list[CheckedSubject], files: list[Path]) -> str:
    facts = [_facts(subject) for subject in found]
    written = {"files": [str(path) for path in files]}
    if len(facts) == 1:
        return json_text({"standoff": __version__} | facts[0] | written)
    return json_text({"standoff": __version__, "bodies": facts} | written)


def _is_planar_solid(shape: Any) -> bool:
    return is_solid(shape) and dimension_of_shape(shape) == 2


def _facts(subject: CheckedSubject) -> dict[str, Any]:
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


def _table(subject: CheckedSubject) -> Table:
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


# What the checks of a body found, as rows of a table.

METHODS = {
    "theorem": "by theorem",
    "bernstein": "by Bernstein bounds over the whole patch",
    "interval": "by interval bounds over the whole patch",
}
"""How the convexity of a patch was proven, in words."""

Rows = list[tuple[str, str]]


def solid_rows(solid: Solid, unit: str) -> Rows:
    """Return (what, found) pairs of a solid that need not be convex; `unit` labels lengths."""
    report = solid.check()
    assert isinstance(report, BoundaryReport)
    kinds = Counter(kind.value for kind in solid.boundary.edge_kinds)
    edges = ", ".join(f"{count} {kind}" for kind, count in sorted(kinds.items()))
    charts = "" if report.charts == report.faces else f", in {counted(report.charts, 'chart')}"
    cavities = len(report.cavities)
    return [
        ("dimension", "3, spatial"),
        ("convex", "no: a Solid"),
        ("faces", f"{report.faces}{charts}"),
        ("edges", f"{report.edges}: {edges}" if edges else "0"),
        ("vertices", str(report.vertices)),
        ("size", f"{report.size:.9g} {unit}"),
        ("volume", f"{report.volume:.9g} {unit}³, to {report.volume_error:.2g}"),
        ("area", f"{report.area:.9g} {unit}²"),
        ("shells", f"{len(report.shells)}, {counted(cavities, 'cavity', 'cavities')}"),
        (
            "sewing residual",
            f"{report.sewing_residual:.3g} {unit}, accepted up to "
            f"{report.sewing_tolerance:.3g} {unit}",
        ),
        ("slack", f"{report.slack:.3g} {unit}, taken off the certified lower bound"),
        *(("boundary", line) for line in solid.self_intersections.lines(unit)),
        *(("note", note) for note in report.notes),
    ]


def planar_rows(solid: PlanarSolid, unit: str) -> Rows:
    """Return (what, found) pairs of a planar solid; `unit` labels lengths."""
    kinds = Counter(solid.kinds)
    vertices = ", ".join(f"{count} {kind}" for kind, count in sorted(kinds.items()))
    holes = len(solid.loops) - 1
    after = f" {unit}" if unit else ""
    return [
        ("dimension", "2, planar"),
        ("loops", f"{len(solid.loops)}, {counted(holes, 'hole')}"),
        ("edges", str(solid.n_edges)),
        ("vertices", f"{solid.n_edges}: {vertices}"),
        ("size", f"{solid.size:.9g}{after}"),
        ("area", f"{solid.area:.9g}{after and after + '²'}, to {solid.area_error:.2g}"),
        ("slack", f"{solid.slack:.3g}{after}, taken off the certified lower bound"),
    ]


def report_rows(body: Body, unit: str) -> Rows:
    """Return (what, found) pairs; `unit` labels lengths."""
    report = body.check()
    smooth = f", {report.smooth_edges} of them smooth" if report.smooth_edges else ""
    skin = f"{body.radius:.9g} {unit}, swept over the core" if body.radius else "none"
    charts = "" if report.charts == report.faces else f", in {counted(report.charts, 'chart')}"
    return [
        ("dimension", "2, planar" if report.dimension == 2 else "3, spatial"),
        ("faces", f"{report.faces}{charts}"),
        ("edges", f"{report.edges}{smooth}"),
        ("vertices", str(report.vertices)),
        ("size", f"{report.size:.9g} {unit}" if body.bounded else "unbounded"),
        ("radius", skin),
        ("closed", "yes" if report.closed else "no: it is unbounded"),
        ("normals", "outward" if report.outward else "not all outward"),
        *_patch_rows(report, unit),
        *_angle_rows(report),
        *_slack_rows(body, report, unit),
        *(("note", note) for note in report.notes),
    ]


def _patch_rows(report: BodyReport, unit: str) -> Rows:
    """Which patches are proven convex, how, and where the worst of them may dent."""
    rows: Rows = []
    groups = Counter((patch.surface, patch.method) for patch in report.patches)
    for k, ((surface, method), count) in enumerate(groups.items()):
        kind = "convex patches" if report.dimension == 3 else "convex curves"
        rows.append((kind if k == 0 else "", f"{count} {surface} {METHODS[method]}"))
    inside = sum(patch.hemisphere for patch in report.patches)
    if report.patches and report.dimension == 3:
        count = len(report.patches)
        rows.append(
            (
                "hemispheres",
                f"normals of {inside} of {counted(count, 'patch', 'patches')} fit an open one",
            )
        )
    dented = [patch for patch in report.patches if patch.defect > 0.0]
    if dented:
        worst = max(dented, key=lambda patch: patch.defect)
        u, v = worst.place
        place = f"face {worst.face} at u = {u:.4g}, v = {v:.4g}"
        rows.append(("worst patch", f"{place}: may dent by {worst.defect:.3g} {unit}"))
    return rows


def _angle_rows(report: BodyReport) -> Rows:
    if report.sharpest is None or report.flattest is None:
        return []
    sharpest, flattest = _angle(report.sharpest), _angle(report.flattest)
    return [("sharpest edge", f"{sharpest} (sampled)"), ("flattest edge", f"{flattest} (sampled)")]


def _angle(angle: DihedralAngle) -> str:
    where = f"edge {angle.edge} at t = {angle.parameter:.4g}"
    return f"{degrees(angle.angle):.6g}° inside, {where}"


def _slack_rows(body: Body, report: BodyReport, unit: str) -> Rows:
    """What was found against what is accepted, and what the certificate subtracts for it."""
    if not body.bounded:
        return []
    return [
        (
            "convexity defect",
            f"{report.convexity_defect:.3g} {unit}, accepted up to "
            f"{report.convexity_tolerance:.3g} {unit}",
        ),
        (
            "sewing residual",
            f"{report.sewing_residual:.3g} {unit}, accepted up to "
            f"{report.sewing_tolerance:.3g} {unit}",
        ),
        ("slack", f"{report.slack:.3g} {unit}, taken off the certified lower bound"),
        ("coordinates' roundoff", f"{report.coordinate_roundoff:.3g} {unit}, always accepted"),
    ]
