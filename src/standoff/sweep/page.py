"""The report of a sweep as one page of HTML, which needs no other file; worst rows are drawn."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterable, Iterator, Sequence
from html import escape
from typing import Any

from standoff.clearance.page import POLICY, STYLE
from standoff.sweep.job import Job
from standoff.sweep.plot import histogram_figure
from standoff.sweep.report import Report, numbers_of
from standoff.sweep.rows import Rows
from standoff.sweep.subjects.subject import Alone
from standoff.sweep.summary import Listed, Spread
from standoff.tracking.pair_plot import plot as pair_figure
from standoff.tracking.status import BY_NUMBER
from standoff.version import __version__
from standoff.wording import at_least, counted, printable

DRAWN = 12
"""Worst rows that are drawn: a screen or two of pictures, each of some tenths of a second."""

MOST_ROWS = 100
"""Rows of a table; report.json has all that the job keeps."""

DPI = 72
"""Of a small picture: half a screen's resolution, some 20 kB each."""

OWN_STYLE = """
.rows { display: grid; grid-template-columns: repeat(auto-fill, minmax(20rem, 1fr)); gap: 1rem; }
figure { margin: 0; border: 1px solid #ddd; border-radius: 0.3rem; padding: 0.5rem; }
figcaption { font-size: 0.85rem; }
.bad { color: #B34700; font-weight: 600; }
"""


def page_of(report: Report) -> str:
    """Return the page.

    Raises ModuleNotFoundError if matplotlib is not installed.
    """
    job = report.job
    title = _plain(job.title)
    parts = [
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">{POLICY}',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f"<title>Sweep: {title}</title><style>{STYLE}{OWN_STYLE}</style></head><body>",
        f"<h1>Sweep: {title}</h1>",
        _summary(report),
        _totals(report),
        _histogram(report),
        _pictures(report),
        _worst(report),
        _below(report),
        _uncertified(report),
        f"<footer>Standoff {__version__}, job {_plain(job.file.name)}. Any row can be computed "
        f"again: <code>standoff sweep {_plain(job.file.name)} --row NUMBER</code></footer>"
        "</body></html>",
    ]
    return "\n".join(part for part in parts if part) + "\n"


def _plain(text: str) -> str:
    return escape(printable(text))


def _grouped(number: int) -> str:
    return f"{number:,}".replace(",", "\u202f")


def _length(number: float, unit: str) -> str:
    return f"{at_least(number)} {escape(unit)}".rstrip()


def _summary(report: Report) -> str:
    job, found = report.job, report.found
    unit = job.subject.length_unit
    seed = "" if job.kind in ("grid", "file") else f", seed {job.seed}"
    ways = ", ".join(f"{_plain(p.name)} ({_plain(p.told)})" for p in job.parameters)
    lines = [
        f"{_plain(job.subject.name)}: {counted(found.rows, 'row', write=_grouped)} "
        f"({job.kind}{seed}).",
        f"From row to row change: {ways}.",
    ]
    if found.uncertified.count:
        told = counted(found.uncertified.count, "row is", "rows are")
        lines.append(f'<span class="bad">{told} not certified</span>: listed below.')
    else:
        lines.append("Rows that are not certified: 0.")
    if job.keep.below is not None:
        least = _length(job.keep.below, unit)
        if found.below.count:
            told = counted(found.below.count, "row is", "rows are")
            lines.append(f'<span class="bad">{told} not proven to be {least} apart.</span>')
        else:
            lines.append(f"Every row is proven to be {least} or more apart.")
    return '<p class="summary">' + "<br>".join(lines) + "</p>"


def _totals(report: Report) -> str:
    found, unit = report.found, report.job.subject.length_unit
    statuses = [
        [status.name, _grouped(n), "yes" if status.certified else "no", escape(status.advice)]
        for status, n in zip(BY_NUMBER, found.statuses.tolist(), strict=True)
        if n
    ]
    spreads = [
        [name, *_spread(spread, unit)]
        for name, spread in (("distance", found.distance), ("lower bound", found.lower_bound))
    ]
    return (
        "<h2>Totals</h2>"
        + _table(["", "least", "in row", "greatest", "in row", "mean", "rows"], spreads, numbers=7)
        + "<p></p>"
        + _table(["status", "rows", "certified", "what it means"], statuses, notes=1)
    )


def _spread(spread: Spread, unit: str) -> list[str]:
    if not spread.count:
        return ["none", "", "", "", "", "0"]
    return [
        *(_length(spread.least, unit), str(spread.least_row)),
        *(_length(spread.most, unit), str(spread.most_row)),
        *(f"{spread.sum / spread.count:.6g} {escape(unit)}".rstrip(), _grouped(spread.count)),
    ]


def _table(
    heads: Sequence[str], rows: Iterable[Sequence[str]], numbers: int = 0, notes: int = 0
) -> str:
    """A table of cells that are HTML; the columns after the first up to `numbers` are numbers, the
    last `notes` are sentences."""

    def of_column(k: int) -> str:
        if 0 < k < numbers:
            return ' class="number"'
        return ' class="note"' if k >= len(heads) - notes else ""

    head = "".join(f"<th{of_column(k)}>{name}</th>" for k, name in enumerate(heads))
    body = "\n".join(
        "<tr>" + "".join(f"<td{of_column(k)}>{cell}</td>" for k, cell in enumerate(row)) + "</tr>"
        for row in rows
    )
    return f'<div class="wide"><table><tr>{head}</tr>\n{body}</table></div>'


def _image(figure: Any, alt: str, dpi: int | None = None) -> str:
    buffer = io.BytesIO()
    look = {} if dpi is None else {"dpi": dpi, "bbox_inches": "tight", "pad_inches": 0.05}
    figure.savefig(buffer, format="png", **look)
    data = base64.b64encode(buffer.getvalue()).decode()
    return f'<img alt="{alt}" src="data:image/png;base64,{data}">'


def _histogram(report: Report) -> str:
    if report.job.keep.bins is None:
        return "<h2>Histogram</h2><p>The job keeps none.</p>"
    image = _image(histogram_figure(report), "rows by distance, on a logarithmic axis")
    return f"<h2>Histogram</h2>{image}"


def _pictures(report: Report) -> str:
    """The worst rows, each drawn with its nearest pair and the witness points."""
    job, worst = report.job, report.found.worst
    shown = []
    for k, row in enumerate(worst.row[:DRAWN].tolist()):
        found = job.alone(row)
        assert found.nearest is not None  # a row without a distance is no worst row
        unit = job.subject.length_unit
        a, b = (_plain(name) for name in _names(found))
        told = f"row {row}: {_length(float(worst.distance[k]), unit)}, A {a}, B {b}"
        figure = pair_figure(*found.shapes, found.nearest, unit=unit)
        shown.append(
            f"<figure>{_image(figure, told, DPI)}<figcaption>{told}, "
            f"{BY_NUMBER[int(worst.status[k])].name}</figcaption></figure>"
        )
    if not shown:
        return "<h2>Worst rows</h2><p>No row has a distance.</p>"
    return f'<h2>Worst rows, drawn</h2><div class="rows">{"".join(shown)}</div>'


def _names(found: Alone) -> Iterator[str]:
    """Names of a row's two bodies, each with that of its nearest piece."""
    pieces = getattr(found.nearest, "pieces", ("", ""))
    for name, piece in zip(found.names, pieces, strict=True):
        yield f"{name} ({piece})" if piece else name


def _worst(report: Report) -> str:
    worst = report.found.worst
    if not len(worst.row):
        return ""
    return f"<h2>Worst rows, listed</h2>{_rows(report.job, worst)}"


def _rows(job: Job, rows: Rows) -> str:
    """A table of rows with their parameters."""
    unit = job.subject.length_unit
    label = escape(f" ({unit})" if unit else "")
    first = rows.at(slice(MOST_ROWS))
    numbers = numbers_of(job, first.row.tolist())
    pairs = [job.subject.pair_names(k) for k in first.pair.tolist()]
    several = any(pair is not None for pair in pairs)
    units = [unit if p.is_length else p.unit for p in job.parameters for _ in p.columns]
    heads = ["row", f"distance{label}", f"lower bound{label}"]
    heads += [
        _plain(f"{name} ({own})" if own else name)
        for name, own in zip(job.columns, units, strict=True)
    ]
    heads += ["status", *(["nearest pair"] if several else [])]
    body = []
    for k, row in enumerate(first.row.tolist()):
        cells = [str(row), at_least(first.distance[k]), at_least(first.lower_bound[k])]
        cells += [f"{number:.6g}" for number in numbers[k].tolist()]
        cells.append(BY_NUMBER[int(first.status[k])].name)
        pair = pairs[k]
        cells += [_plain(" to ".join(pair)) if pair else "none near"] if several else []
        body.append(cells)
    more = len(rows.row) - len(body)
    told = f"<p>report.json lists {counted(more, 'more row')}.</p>" if more else ""
    return _table(heads, body, numbers=3 + len(job.columns)) + told


def _below(report: Report) -> str:
    job = report.job
    if job.keep.below is None:
        return ""
    least = _length(job.keep.below, job.subject.length_unit)
    return _listed(job, f"Rows not proven to be {least} apart", report.found.below)


def _listed(job: Job, heading: str, listed: Listed) -> str:
    if not listed.count:
        return f"<h2>{heading}</h2><p>None.</p>"
    told = counted(listed.count, "row")
    if listed.count > len(listed.rows.row):
        told += f", of which report.json lists the first {len(listed.rows.row)}"
    return f"<h2>{heading}</h2><p>{told}, in their order:</p>{_rows(job, listed.rows)}"


def _uncertified(report: Report) -> str:
    listed = report.found.uncertified
    return _listed(report.job, "Rows that are not certified", listed)
