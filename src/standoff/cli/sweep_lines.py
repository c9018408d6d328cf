"""What ``standoff sweep`` prints for a reader at a terminal."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from standoff.cli.summary import MARGIN, line, share_text, vector_text
from standoff.sweep.estimate import Estimate
from standoff.sweep.folder import REPORT
from standoff.sweep.job import Job
from standoff.sweep.report import Report, numbers_of
from standoff.sweep.rows import Rows
from standoff.sweep.subjects.subject import Alone
from standoff.sweep.summary import Listed, Spread
from standoff.tracking.proximity import shown_size
from standoff.tracking.status import BY_NUMBER
from standoff.typing import Array
from standoff.wording import at_least, counted, printable

FIRST_ROWS = 5
"""Worst rows that are printed; the report has all that the job keeps."""

BAR = 40
"""Characters of the longest bar of the histogram."""

MOST_BARS = 24
"""Bins that are printed: more are put together, a whole number in each."""

TIMES = ((86400.0, "d"), (3600.0, "h"), (60.0, "min"))
SIZES = ((1e9, "GB"), (1e6, "MB"), (1e3, "kB"))


def grouped(number: int) -> str:
    """Return a number with its digits in groups of three."""
    return f"{number:,}".replace(",", " ")


def parameters_line(job: Job) -> str:
    """Return the line of what a job changes."""
    ways = ", ".join(f"{p.name} ({p.told})" for p in job.parameters)
    return line("parameters", ways)


def _head(job: Job) -> list[str]:
    seed = "" if job.kind in ("grid", "file") else f", seed {job.seed}"
    return [
        line("sweep", f"{job.title}: {job.subject.name}"),
        parameters_line(job),
        line("rows", f"{grouped(job.rows)}, {job.kind}{seed}"),
    ]


def report_lines(report: Report, folder: Path) -> list[str]:
    """Return the lines that sum up a sweep."""
    job, found = report.job, report.found
    unit = job.subject.length_unit
    statuses = zip(BY_NUMBER, found.statuses.tolist(), strict=True)
    told = ", ".join(f"{grouped(n)} {status.name}" for status, n in statuses if n)
    lines = [
        *_head(job),
        line("status", told),
        line("certified", _certified(report)),
        line("distance", _spread(found.distance, unit)),
        line("lower bound", _spread(found.lower_bound, unit)),
        *_histogram(report),
        *_worst(job, found.worst),
    ]
    if job.keep.below is not None:
        lines.append(line("below", _below(found.below, job.keep.below, unit)))
    return [*lines, line("wrote", str(folder / REPORT))]


def _certified(report: Report) -> str:
    found = report.found
    told = f"{grouped(found.certified)} of {counted(found.rows, 'row', write=grouped)}, "
    told += share_text(found.certified, found.rows)
    missed = found.uncertified
    if missed.count:
        first = ", ".join(map(str, missed.rows.row[:FIRST_ROWS].tolist()))
        told += f"; not certified: {first}{', ...' if missed.count > FIRST_ROWS else ''}"
    return told


def _spread(spread: Spread, unit: str) -> str:
    if not spread.count:
        return "none"
    mean = spread.sum / spread.count
    return (
        f"{at_least(spread.least)} {unit} (row {spread.least_row}) to {at_least(spread.most)} "
        f"{unit} (row {spread.most_row}), mean {mean:.6g} {unit}"
    )


def _histogram(report: Report) -> list[str]:
    bins = report.job.keep.bins
    if bins is None:
        return []
    # A divisor of the number of bins, so that all bars are of equally wide ones.
    together = next(
        n for n in range(-(-bins.number // MOST_BARS), bins.number + 1) if bins.number % n == 0
    )
    counts = report.found.bins.reshape(-1, together).sum(axis=1)
    edges = bins.edges[::together]
    under, over, without = report.found.outside.tolist()
    rows = [(f"below {bins.low:g}", under)]
    rows += [(f"{low:.6g} ...", n) for low, n in zip(edges[:-1], counts.tolist(), strict=True)]
    rows += [(f"{bins.high:g} and more", over)]
    rows += [("no distance", without)] if without else []
    most = max(n for _, n in rows) or 1
    width = max(len(name) for name, _ in rows)
    return [
        line(
            "histogram" if k == 0 else "",
            f"{name:>{width}} {'█' * round(BAR * n / most):<{BAR}} {grouped(n)}".rstrip(),
        )
        for k, (name, n) in enumerate(rows)
    ]


def _worst(job: Job, rows: Rows) -> list[str]:
    first = rows.at(slice(FIRST_ROWS))
    numbers = numbers_of(job, first.row.tolist())
    unit = job.subject.length_unit
    lines = []
    for k, (row, distance) in enumerate(zip(first.row.tolist(), first.distance, strict=True)):
        status = BY_NUMBER[int(first.status[k])].name
        pair = job.subject.pair_names(int(first.pair[k]))
        between = "" if pair is None else f", {pair[0]} to {pair[1]}"
        text = f"row {row}: {distance:.6g} {unit}{between}, {status}, {named(job, numbers[k])}"
        lines.append(line("worst" if k == 0 else "", text))
    return lines


def named(job: Job, numbers: Array) -> str:
    """Return a row's numbers, each behind its parameter's name."""
    pairs = zip(job.columns, numbers.tolist(), strict=True)
    return ", ".join(f"{name} {number:.6g}" for name, number in pairs)


def _below(below: Listed, length: float, unit: str) -> str:
    if not below.count:
        return f"no row: all are proven to be {at_least(length)} {unit} or more apart"
    rows = counted(below.count, "row is", "rows are")
    told = f"{rows} not proven to be {length:g} {unit} apart"
    listed = len(below.rows.row)
    return told if listed == below.count else f"{told}; the report lists the first {listed}"


def row_facts(job: Job, row: int, found: Alone) -> dict[str, Any]:
    """Return one row as plain data."""
    numbers = job.numbers(row, row + 1)[0].tolist()
    facts: dict[str, Any] = {"row": row}
    facts["parameters"] = dict(zip(job.columns, numbers, strict=True))
    nearest: dict[str, Any] = {} if found.nearest is None else found.nearest.as_dict()
    rows = found.rows.facts()
    whole = {key: rows[key][0] for key in ("distance", "lower_bound", "status")}
    return facts | found.state | nearest | whole


def row_lines(job: Job, row: int, found: Alone) -> list[str]:
    """Return the lines for one row."""
    numbers, unit = job.numbers(row, row + 1)[0], job.subject.length_unit
    lines = [line("sweep", job.title), line("row", f"{row} of {job.rows}")]
    at = 0
    for p in job.parameters:
        values = " ".join(f"{x:.17g}" for x in numbers[at : at + p.width].tolist())
        at += p.width
        own = f" {unit if p.is_length else p.unit}".rstrip()
        lines.append(line(p.name, f"{values}{own}, {p.told}"))
    for name, numbers in found.state.items():
        lines.append(line(name, " ".join(f"{x:.17g}" for x in numbers)))
    for name, pose in found.poses:
        rows = [" ".join(f"{x:.9g}" for x in part) for part in pose[:3].tolist()]
        lines += _labelled(f"pose {name}", rows)
    return lines + _answer(found, unit)


def _labelled(label: str, texts: list[str]) -> list[str]:
    """Lines under one label, which has a line of its own where it is longer than labels are."""
    if len(label) < MARGIN:
        return [line(label if k == 0 else "", text) for k, text in enumerate(texts)]
    return [printable(label), *(line("", text) for text in texts)]


def _answer(found: Alone, unit: str) -> list[str]:
    """The lines of a row's distance: of all its pairs, and of the nearest."""
    rows, answer = found.rows, found.nearest
    status = BY_NUMBER[int(rows.status[0])]
    ended = line("status", f"{status.name}: {status.advice}")
    bound = line("lower bound", f"{rows.lower_bound[0]:.17g} {unit}")
    if answer is None:
        return [bound, ended]
    (a, b), size = found.names, shown_size(answer)
    return [
        line("distance", f"{rows.distance[0]:.17g} {unit}"),
        bound,
        line("upper bound", f"{answer.upper_bound:.17g} {unit}"),
        line("points", f"{vector_text(answer.point_a, size)} {unit} on {a}, {answer.feature_a}"),
        line("", f"{vector_text(answer.point_b, size)} {unit} on {b}, {answer.feature_b}"),
        line("normal", f"{vector_text(answer.normal, 1.0)} from {a} to {b}"),
        ended,
    ]


def estimate_lines(job: Job, found: Estimate) -> list[str]:
    """Return the lines of what a sweep will take."""
    processes = counted(found.processes, "process", "processes")
    lines = [
        *_head(job),
        line(
            "shards", f"{grouped(found.shards)} of {counted(job.shard_rows, 'row', write=grouped)}"
        ),
        line("tried", f"{counted(found.tried, 'row')}, {found.row_seconds * 1e6:.3g} µs each"),
        line("time", f"{scaled(found.seconds, TIMES, 's')} with {processes}"),
        line("disk", f"{scaled(found.size, SIZES, 'B')} in shards"),
    ]
    if found.uncertified:
        lines.append(line("certified", f"{found.uncertified} of the tried rows are not"))
    return lines


def scaled(number: float, units: tuple[tuple[float, str], ...], smallest: str) -> str:
    """Return a number in the largest of some units that it reaches."""
    for size, unit in units:
        if number >= size:
            return f"{number / size:.3g} {unit}"
    return f"{number:.3g} {smallest}"
