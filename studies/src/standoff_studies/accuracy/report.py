"""The report as a page of Markdown tables and as Parquet."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import isnan
from typing import BinaryIO

from standoff_studies.accuracy.measuring import OURS, WRONG, Row, columns
from standoff_studies.accuracy.summary import Summary, misses, summarised

NOTHING = "–"
MOST_MISSES = 20
"""Rows of the table of misses."""


@dataclass(frozen=True)
class Run:
    """What was measured: the command, its numbers, and the versions of all engines."""

    command: str
    cases: int
    seed: int
    versions: Mapping[str, str]
    rows: Sequence[Row]


def number(value: float) -> str:
    """Return an error with one digit: more digits would differ from machine to machine."""
    return NOTHING if isnan(value) else f"{value:.0e}".replace("e-0", "e-").replace("e+0", "e+")


def level_name(level: float) -> str:
    """Return 'gap 1e-6' or 'depth 1e-6'."""
    value = "1" if abs(level) == 1 else number(abs(level))
    return f"gap {value}" if level > 0 else f"depth {value}"


def side(row: Row) -> str:
    """Return whether a row belongs to the gaps or to the depths."""
    return "gaps" if row.level > 0 else "depths"


def pair_name(row: Row) -> str:
    """Return the pair's name in the catalogue's order."""
    return f"{row.shape_1} – {row.shape_2}"


def table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a Markdown table."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"


ENGINE_HEADER = (
    "engine",
    "cases at",
    "pairs",
    "cases",
    "distance",
    "witness points",
    "normal",
    "certified",
    "wrong",
    "not least",
    "no answer",
)
PAIR_HEADER = (
    "pair",
    "gaps: distance",
    "witness",
    "normal",
    "depths: distance",
    "witness",
    "normal",
    "certified",
    "wrong",
)


LEVEL_HEADER = ("pair", "distance", "witness points", "normal", "certified", "wrong")


def engine_rows(rows: Sequence[Row], by_level: bool = True) -> list[list[str]]:
    """Return one row per engine and level (or side): errors median / worst, and counts."""

    def where(row: Row) -> tuple[str, str]:
        return row.engine, level_name(row.level) if by_level else side(row)

    paired: dict[tuple[str, str], set[str]] = {}
    for row in rows:
        paired.setdefault(where(row), set()).add(pair_name(row))
    sums = summarised(rows, where)
    engines = list(dict.fromkeys(engine for engine, _ in sums))
    levels = list(dict.fromkeys(level for _, level in sums))
    ordered = [(e, level) for e in engines for level in levels if (e, level) in sums]
    return [[*key, str(len(paired[key])), *_counts(sums[key])] for key in ordered]


def _counts(found: Summary) -> list[str]:
    both = zip(found.median, found.worst, strict=True)
    certified = NOTHING if found.certified is None else str(found.certified)
    return [
        str(found.cases),
        *(f"{number(middle)} / {number(worst)}" for middle, worst in both),
        certified,
        str(found.wrong),
        str(found.deeper),
        str(found.nothing),
    ]


def level_rows(rows: Sequence[Row], level: float) -> list[list[str]]:
    """Return our errors of every pair at one gap or depth: median / worst, and counts."""
    ours = [row for row in rows if row.engine == OURS and row.level == level]
    lines = []
    for name, found in summarised(ours, pair_name).items():
        _, distance, witness, normal, certified, *_ = _counts(found)
        wrong = found.wrong + found.deeper + found.nothing
        proven = f"{certified} of {found.cases}"
        lines.append([name, distance, witness, normal, proven, str(wrong)])
    return lines


def pair_rows(rows: Sequence[Row]) -> list[list[str]]:
    """Return our worst errors of every pair."""
    ours = [row for row in rows if row.engine == OURS]
    sums = summarised(ours, lambda row: (pair_name(row), side(row)))
    totals = summarised(ours, pair_name)
    lines = []
    for name, total in totals.items():
        line = [name]
        for which in ("gaps", "depths"):
            found = sums.get((name, which))
            line += [NOTHING] * 3 if found is None else [number(worst) for worst in found.worst]
        wrong = total.wrong + total.deeper + total.nothing
        lines.append([*line, f"{total.certified} of {total.cases}", str(wrong)])
    return lines


def peer_rows(rows: Sequence[Row], engines: Sequence[str]) -> list[list[str]]:
    """Return the worst distance error of every pair by engine, gaps / depths."""
    sums = summarised(rows, lambda row: (pair_name(row), row.engine, side(row)))
    peered = dict.fromkeys(pair_name(row) for row in rows if row.engine != OURS)

    def cell(pair: str, engine: str) -> str:
        sides = [sums.get((pair, engine, which)) for which in ("gaps", "depths")]
        if sides == [None, None]:
            return NOTHING
        return " / ".join(NOTHING if s is None else number(s.worst[0]) for s in sides)

    return [[pair, *(cell(pair, engine) for engine in engines)] for pair in peered]


def miss_rows(rows: Sequence[Row]) -> list[list[str]]:
    """Return our answers that are farthest from a target."""
    return [
        [
            pair_name(row),
            level_name(row.level),
            str(row.case),
            row.contact,
            number(row.stiffness / row.size),
            number(row.distance_error),
            number(row.witness_error),
            number(row.normal_error),
            row.status,
        ]
        for row in misses(row for row in rows if row.engine == OURS)[:MOST_MISSES]
    ]


MISS_HEADER = (
    "pair",
    "at",
    "case",
    "support sets",
    "stiffness",
    "distance",
    "witness",
    "normal",
    "status",
)


def page(run: Run) -> str:
    """Return the tables as Markdown."""
    engines = list(dict.fromkeys(row.engine for row in run.rows))
    versions = ", ".join(f"{name} {version}" for name, version in run.versions.items())
    missed = misses(row for row in run.rows if row.engine == OURS)
    parts = [
        f"Made by `{run.command}`: {run.cases} cases of a pair at each gap and depth, seed "
        f"{run.seed}. {versions}.\n",
        "## By engine\n",
        "Errors median / worst.\n",
        table(ENGINE_HEADER, engine_rows(run.rows)),
        "## By pair\n",
        "Standoff's worst errors of all gaps and of all depths; gaps.md and depths.md have median "
        "and worst at each. *wrong* counts also answers that are not the least depth, or none.\n",
        table(PAIR_HEADER, pair_rows(run.rows)),
        "## Beyond the targets\n",
        f"{len(missed)} answers of Standoff miss a target (distance 1e-12, witness points 1e-9, "
        f"normal 1e-9){'; the worst:' if missed else '.'}\n",
        table(MISS_HEADER, miss_rows(run.rows)) if missed else "",
    ]
    if len(engines) > 1:
        parts += [
            "## Beside others\n",
            "Worst error of the distance, gaps / depths.\n",
            table(("pair", *engines), peer_rows(run.rows, engines)),
        ]
    return "\n".join(part for part in parts if part)


def levels_page(run: Run, which: str) -> str:
    """Return our errors of every pair at each of the "gaps" or "depths" as a separate page."""
    levels = list(dict.fromkeys(row.level for row in run.rows if side(row) == which))
    one = which.removesuffix("s")
    parts = [
        f"# Errors of every pair at each {one}\n",
        f"Made by `{run.command}` with Standoff {run.versions[OURS]}: errors of Standoff, median / "
        f"worst of {run.cases} cases, over the pair's size, normals in rad. *wrong* counts also "
        "answers that are not the least depth, or none.\n",
    ]
    for level in levels:
        heading = level_name(level).capitalize()
        parts += [f"## {heading}\n", table(LEVEL_HEADER, level_rows(run.rows, level))]
    return "\n".join(parts)


def facts(run: Run) -> dict[str, object]:
    """Return the report as plain data."""

    def plain(found: Summary) -> dict[str, object]:
        return {
            "cases": found.cases,
            "median": list(found.median),
            "worst": list(found.worst),
            "certified": found.certified,
            "wrong": found.wrong,
            "not_least": found.deeper,
            "no_answer": found.nothing,
        }

    engines = summarised(run.rows, lambda row: (row.engine, row.level))
    pairs = summarised(run.rows, lambda row: (row.engine, pair_name(row), row.level))
    return {
        "command": run.command,
        "cases": run.cases,
        "seed": run.seed,
        "versions": dict(run.versions),
        "wrong_beyond": WRONG,
        "engines": [
            {"engine": engine, "level": level, **plain(found)}
            for (engine, level), found in engines.items()
        ],
        "pairs": [
            {"engine": engine, "pair": pair, "level": level, **plain(found)}
            for (engine, pair, level), found in pairs.items()
        ],
    }


def write_page(file: BinaryIO, run: Run) -> None:
    """Write the tables."""
    file.write(page(run).encode())


def write_levels(file: BinaryIO, run: Run, which: str) -> None:
    """Write the tables of every gap, or of every depth."""
    file.write(levels_page(run, which).encode())


def write_parquet(file: BinaryIO, run: Run) -> None:
    """Write one row per case and engine; the run's numbers are the file's metadata."""
    import pyarrow as pa
    from pyarrow import parquet

    kept = {
        "command": run.command,
        "cases": str(run.cases),
        "seed": str(run.seed),
        "versions": json.dumps(dict(run.versions)),
    }
    parquet.write_table(pa.table(columns(run.rows)).replace_schema_metadata(kept), file)
