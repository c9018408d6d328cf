"""A report as one page of HTML, which needs no other file."""

from __future__ import annotations

import base64
import io
import math
from collections.abc import Iterable
from dataclasses import replace
from html import escape
from typing import Any

import numpy as np

from standoff.bodies.plain_data import without_roundoff
from standoff.clearance.assembly import AssemblyFile, Source
from standoff.clearance.facts import body_text
from standoff.clearance.matrix import matrix_figure
from standoff.clearance.picture import numbered_rows, world_figure
from standoff.clearance.report import (
    COMMON,
    Instants,
    PairRow,
    Report,
    Wanted,
    bound_texts,
    common_text,
    gap_text,
    nearest_of,
    no_clearance,
    report_on,
    undecided,
    within_tolerance,
)
from standoff.motion import Pose
from standoff.tracking.proximity import shown_size
from standoff.typing import Array
from standoff.version import __version__
from standoff.wording import at_least, counted, printable

POLICY = (
    '<meta http-equiv="Content-Security-Policy" content="default-src \'none\'; '
    "style-src 'unsafe-inline'; img-src data:\">"
)
"""In the page itself: it loads nothing."""

STYLE = """
body { font-family: system-ui, sans-serif; margin: 2rem auto; max-width: 72rem; padding: 0 1rem;
  color: #1a1a1a; background: #fff; line-height: 1.4; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.15rem; margin-top: 2rem; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: 0.9rem; }
th, td { text-align: left; padding: 0.3rem 0.7rem; border-bottom: 1px solid #ddd;
  vertical-align: top; white-space: nowrap; }
td.number, th.number { text-align: right; }
td.note { white-space: normal; min-width: 14rem; }
.mark { padding: 0.1rem 0.45rem; border-radius: 0.3rem; font-weight: 600; font-size: 0.8rem; }
.OVERLAPPING, .CONTAINED { background: #D55E00; color: #fff; } .UNDECIDED { background: #CC79A7; }
.TOUCHING { background: #E69F00; } .APART { background: #CFE8F7; }
.fails { background: #FDF1E7; } .summary { font-size: 1.05rem; }
img { max-width: 100%; height: auto; } footer { color: #666; margin-top: 2rem; font-size: 0.85rem; }
"""


def page_of(scene: Source, report: Report, looked: Instants) -> str:
    """Return the page.

    Parameters
    ----------
    scene : Scene or AssemblyFile
    report : Report
    looked : Instants
        When the bodies were looked at. Over several frames the picture shows them at the instant
        of the worst pair.
    """
    at, shown = _pictured(scene, report, looked)
    poses = _poses(scene, report, at)
    unit = scene.length_unit
    if report.world.model.solids.any and report.world.dimension == 3:
        from standoff.clearance.assembly_picture import assembly_figure

        colours = scene.colours if isinstance(scene, AssemblyFile) else {}
        picture = assembly_figure(shown, poses, unit, colours)
    else:
        picture = world_figure(shown, poses, unit)
    heading = "The parts" if isinstance(scene, AssemblyFile) else f"The bodies at {at:g} s"
    first = (heading, "the worst pairs numbered", picture)
    figures = [
        first,
        ("All pairs", "as a matrix", matrix_figure(report, scene.title, unit)),
    ]
    title = escape(printable(scene.title))
    kind = "assembly" if isinstance(scene, AssemblyFile) else "scene"
    parts = [
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">{POLICY}',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f"<title>Clearance: {title}</title><style>{STYLE}</style></head><body>",
        f"<h1>Clearance: {title}</h1>",
        _summary(scene, report, looked),
        _table(report, unit, timed=looked.frames > 1),
        _fits(report, unit),
        *(_picture(heading, told, figure) for heading, told, figure in figures),
        f"<footer>Standoff {__version__}, {kind} {escape(printable(scene.file.name))}. The bounds "
        f"are proven; lengths are in {_unit_told(unit, kind)}.</footer></body></html>",
    ]
    return "\n".join(parts) + "\n"


def _unit_told(unit: str, kind: str) -> str:
    return escape(unit) if unit else f"the {kind}'s unit"


def _pictured(scene: Source, report: Report, looked: Instants) -> tuple[float, Report]:
    """The instant of the picture, and the report on it: over several frames that of the worst pair
    of which a body moves."""
    if looked.frames == 1 or isinstance(scene, AssemblyFile):
        return looked.start, report
    moving = {name for name, motion in scene.motions.items() if motion.kind != "fixed"}
    worst = [row for row in report.rows if moving & set(row.names)] or report.rows
    at = worst[0].nearest.time if worst else looked.start
    answer = report.world.distances(scene.poses(report.world, at))
    now = report_on(report.world, nearest_of(answer, at), {}, Wanted())
    rows = sorted(now.rows, key=lambda row: bool(worst) and row.names != worst[0].names)
    return at, replace(now, rows=tuple(rows))


def _poses(scene: Source, report: Report, time: float) -> dict[str, Pose]:
    moving = scene.poses(report.world, time)
    return moving | report.world.fixed_poses


def _summary(scene: Source, report: Report, looked: Instants) -> str:
    unit = escape(scene.length_unit)
    if isinstance(scene, AssemblyFile):
        when = "at rest"
    elif looked.frames == 1:
        when = f"at {looked.start:g} s"
    else:
        when = (
            f"in {counted(looked.frames, 'frame')} from {looked.start:g} s to {looked.end:g} s "
            "(of the time between them nothing is said)"
        )
    verdicts = ", ".join(
        f'{n} <span class="mark {verdict.name}">{verdict.name}</span>'
        for verdict, n in report.tally().items()
        if n
    )
    lines = [
        f"{counted(len(report.world.bodies), 'body', 'bodies')}, {when}: {verdicts}.",
        f"Proven for all pairs: a clearance of {at_least(report.clearance)} {unit}."
        if report.clearance > -math.inf
        else f"No clearance is proven for all pairs: {escape(printable(no_clearance(report)))}.",
    ]
    if report.clearance > -math.inf and undecided(report):
        lines.append(f"But {escape(printable(undecided(report)))}.")
    if report.failures:
        failing = counted(len(report.failures), "pair")
        what = "is" if len(report.failures) == 1 else "are"
        lines.append(f"<strong>{failing} {what} not proven to keep what is asked.</strong>")
    elif report.least is not None:
        lines.append(
            f"Every pair is proven to keep {at_least(report.least)} {unit}, or is allowed not to."
        )
    if any(row.common is not None for row in report.rows):
        lines.append(f"The {COMMON}.")
    if within_tolerance(report, unit):
        lines.append(f"Of these {within_tolerance(report, unit)}.")
    if not report.certified:
        lines.append("<strong>Some answers are not certified.</strong> Their bounds hold.")
        lines += [f"{status.name}: {escape(status.advice)}" for status in report.statuses]
    return '<p class="summary">' + "<br>".join(lines) + "</p>"


def _table(report: Report, unit: str, *, timed: bool) -> str:
    label = escape(f" ({unit})" if unit else "")
    heads = ["", "verdict", "bodies", f"gap{label}", "proven between", "closest points"]
    volumes = any(row.common is not None for row in report.rows)
    cubed = escape(f" ({unit}³)" if unit else "")
    heads += [f"common{cubed}"] if volumes else []
    heads += ["at (s)"] if timed else []
    heads.append("note")
    numbers = {"gap" + label, "common" + cubed}
    head = "".join(
        f'<th class="number">{h}</th>' if h in numbers else f"<th>{h}</th>" for h in heads
    )
    numbered = len(numbered_rows(report)) if not timed else 0
    body = "\n".join(
        _row(row, str(k) if k <= numbered else "", timed=timed, volumes=volumes)
        for k, row in enumerate(report.rows, 1)
    )
    far = ""
    if report.far:
        count = counted(len(report.far), "more pair")
        bound = f"{at_least(report.least_far)} {escape(unit)}"
        far = f"<p>{count}, proven to be {bound} or more apart.</p>"
    missed = "".join(
        f"<p>{escape(' - '.join(each.names))}: {escape(each.failure)}</p>"
        for each in report.far
        if each.failure
    )
    return (
        f'<h2>Near pairs</h2><div class="wide"><table><tr>{head}</tr>\n{body}</table></div>'
        f"{far}{missed}"
    )


def _row(row: PairRow, number: str, *, timed: bool, volumes: bool) -> str:
    answer = row.answer
    size = shown_size(answer)
    lower, upper = bound_texts(row)
    bodies = "<br>".join(escape(text) for text in body_text(row))
    points = "<br>".join(_point(point, size) for point in (answer.point_a, answer.point_b))
    notes = [row.failure]
    if row.fit is not None:
        notes.append(f"allowed {row.fit.allowance()}: {row.fit.reason}")
    if row.nearest.uncertified:
        told = ", ".join(status.name for status in row.nearest.statuses)
        notes.append(f"not certified: {told or answer.status.name}")
    cells = [
        f"<td>{number}</td>",
        f'<td><span class="mark {row.verdict.name}">{row.verdict.name}</span></td>',
        f"<td>{bodies}</td>",
        f'<td class="number">{gap_text(answer)}</td>',
        f"<td>≥ {lower}<br>≤ {upper}</td>",
        f"<td>{points}</td>",
        *([f'<td class="number">{common_text(row)}</td>'] if volumes else []),
        *([f'<td class="number">{row.nearest.time:.6g}</td>'] if timed else []),
        f'<td class="note">{escape(printable("; ".join(filter(None, notes))))}</td>',
    ]
    mark = ' class="fails"' if row.failure else ""
    return f"<tr{mark}>{''.join(cells)}</tr>"


def _point(point: Array, size: float) -> str:
    return "(" + ", ".join(f"{x:.6g}" for x in np.asarray(without_roundoff(point, size))) + ")"


def _fits(report: Report, unit: str) -> str:
    if not report.fits:
        return ""
    rows = "".join(
        f"<tr{'' if note.holds else ' class=' + chr(34) + 'fails' + chr(34)}>"
        + _cells(
            [
                f"{note.fit.a} - {note.fit.b}",
                note.fit.allowance(unit),
                note.fit.reason,
                note.note or "as allowed",
            ]
        )
        + "</tr>"
        for note in report.fits
    )
    head = "<tr><th>bodies</th><th>allowed</th><th>reason</th><th>found</th></tr>"
    return f'<h2>Fits that are meant</h2><div class="wide"><table>{head}{rows}</table></div>'


def _cells(texts: Iterable[str]) -> str:
    return "".join(f"<td>{escape(printable(text))}</td>" for text in texts)


def _picture(heading: str, told: str, figure: Any) -> str:
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png")
    data = base64.b64encode(buffer.getvalue()).decode()
    alt = escape(f"{heading}, {told}")
    return f'<h2>{escape(heading)}</h2><img alt="{alt}" src="data:image/png;base64,{data}">'
