"""The table as Markdown, Parquet and a plot."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, BinaryIO

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from benchmarks.bench import goals
from benchmarks.bench.race import Row
from standoff.whole_files import write_whole

MICRO = 1e6
FLOOR = 1e-17
"""Errors of 0 are drawn here."""
COLUMNS = 2
"""Plots side by side: what a phone still shows."""
LETTERS = 12
"""Points of the plot's letters."""
COLOURS = {"Coal": "C1", "MuJoCo": "C2", "python-fcl": "C3", "OpenCASCADE": "C4", "SciPy": "C5"}


def number(value: float, digits: int = 2) -> str:
    """A number in few digits; a dash where there is none."""
    if not math.isfinite(value):
        return "–"
    return f"{value:.{digits}g}" if value else "0"


def table(rows: list[Row], doubts: dict[str, float]) -> list[str]:
    """A table for each pair."""
    told: list[str] = []
    for pair, doubt in doubts.items():
        told += [
            f"### {pair}",
            "",
            f"Support functions that share no code with the library agree with the truth to "
            f"{doubt:.1e} of the size.",
            "",
            "| contender | median, µs | least | quartiles | greatest | distance error "
            "| witness error | gap of the certificate | memory, bytes | frames |",
            "|---|---|---|---|---|---|---|---|---|---|",
        ]
        told += [_line(row) for row in rows if row.pair == pair]
        told.append("")
    return told


def _line(row: Row) -> str:
    if row.missing:
        return f"| {row.contender} | missing: {row.missing} | | | | | | | | |"
    least, lower, upper, most = (number(MICRO * x, 3) for x in row.spread)
    errors = " | ".join(number(x) for x in (row.distance_error, row.witness_error, row.gap))
    return (
        f"| {row.contender} | **{number(MICRO * row.median, 3)}** | {least} | {lower} to {upper} "
        f"| {most} | {errors} | {row.memory or '–'} | {row.frames} |"
    )


def markdown(header: list[str], rows: list[Row], doubts: dict[str, float]) -> str:
    """The whole page."""
    told = [
        "# Times and errors beside other packages",
        "",
        *header,
        "",
        "## Goals",
        "",
        *goals.lines(rows),
        "",
        "## All pairs",
        "",
        "Times are of one frame, the setting of its poses included; errors are the greatest found, "
        "over the size (the greater diameter).",
        "",
        *table(rows, doubts),
    ]
    return "\n".join(told).rstrip() + "\n"


def parquet(rows: list[Row], facts: dict[str, str]) -> pa.Table:
    """A row for each contender, pair and round; machine and versions as metadata."""
    columns: dict[str, list[Any]] = {
        name: []
        for name in (
            *("pair", "contender", "round", "seconds"),
            *("distance_error", "witness_error", "gap", "memory", "frames", "missing"),
        )
    }
    for row in rows:
        for number_of, seconds in enumerate(row.times or (np.nan,)):
            values = (row.pair, row.contender, number_of, seconds)
            values += (row.distance_error, row.witness_error, row.gap)
            values += (row.memory, row.frames, row.missing)
            for column, value in zip(columns.values(), values, strict=True):
                column.append(value)
    return pa.table(columns).replace_schema_metadata(facts)


def colour_of(contender: str) -> str:
    """One colour a package; the library's is the first."""
    return next((c for name, c in COLOURS.items() if contender.startswith(name)), "C0")


def package_of(contender: str) -> str:
    return next((name for name in COLOURS if contender.startswith(name)), "Standoff")


def drawn(rows: list[Row]) -> plt.Figure:
    """Time and witness error of every contender, a plot for each pair that a peer takes part in."""
    with_peers = {row.pair for row in rows if row.times and package_of(row.contender) != "Standoff"}
    pairs = [pair for pair in dict.fromkeys(row.pair for row in rows) if pair in with_peers]
    height = math.ceil(len(pairs) / COLUMNS)
    figure, axes = plt.subplots(
        height, COLUMNS, figsize=(9, 3.2 * height + 0.6), sharex=True, sharey=True, squeeze=False
    )
    for axis, pair in zip(axes.flat, pairs, strict=False):
        _draw_pair(axis, pair, [row for row in rows if row.pair == pair and row.times])
    for axis in list(axes.flat)[len(pairs) :]:
        axis.set_visible(False)
    for axis in list(axes.flat)[max(len(pairs) - COLUMNS, 0) : len(pairs)]:
        axis.set_xlabel("time of a frame, µs", fontsize=LETTERS)
        axis.tick_params(labelbottom=True)
    for axis in axes[:, 0]:
        axis.set_ylabel("error of witness points / size", fontsize=LETTERS)
    for name, colour in {"Standoff": "C0", **COLOURS}.items():
        axes[0, 0].plot([], [], "o", color=colour, label=name)
    names = axes[0, 0].get_legend_handles_labels()
    figure.legend(*names, loc="lower center", ncols=3, fontsize=LETTERS)
    figure.tight_layout(rect=(0.0, 0.8 / (3.2 * height + 0.6), 1.0, 1.0))
    return figure


def _draw_pair(axis: plt.Axes, pair: str, rows: list[Row]) -> None:
    axis.set_title(pair, fontsize=LETTERS + 1)
    axis.set(xscale="log", yscale="log")
    axis.grid(alpha=0.3)
    axis.tick_params(labelsize=LETTERS - 1)
    for row in rows:
        if not math.isfinite(row.witness_error):
            continue
        at = MICRO * row.median, max(row.witness_error, FLOOR)
        reach = [[at[0] - MICRO * row.spread[0]], [MICRO * row.spread[3] - at[0]]]
        colour = colour_of(row.contender)
        axis.errorbar(*at, xerr=reach, fmt="o", color=colour, markersize=7, alpha=0.8)


def write(folder: Path, text: str, rows: list[Row], facts: dict[str, str]) -> list[Path]:
    """Write table, plot and Parquet whole, or none of them; returns their names."""
    folder.mkdir(parents=True, exist_ok=True)
    figure = drawn(rows)
    kept = parquet(rows, facts)

    def draw(file: BinaryIO) -> None:
        figure.savefig(file, format="png", dpi=130)

    files = {
        folder / "bench.md": lambda file: file.write(text.encode()),
        folder / "bench.png": draw,
        folder / "bench.parquet": lambda file: pq.write_table(kept, file),
    }
    write_whole(files)
    plt.close(figure)
    return list(files)
