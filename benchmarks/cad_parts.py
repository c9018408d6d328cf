"""The table of CAD parts in a folder: python -m benchmarks.cad_parts FOLDER."""

from __future__ import annotations

import argparse
import multiprocessing
import os
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from standoff.cad import PartReport, reports_of, store
from standoff.cad.files import ENDINGS

LIMIT = 120.0
"""Seconds that a file may take."""


def row(file: str, report: PartReport) -> str:
    kinds = ", ".join(f"{n} {kind}" for kind, n in sorted(report.faces.items()))
    if report.refused:
        verdict = f"refused: {report.refused}"
    else:
        verdict = "convex" if report.convex else "not convex"
        if report.healed:
            verdict += ", healed"
    slack = f"{report.slack / report.size:.1e}" if report.size else "-"
    tolerance = f"{report.tolerance:.1e}"
    return (
        f"| {file} | {report.name} | {kinds} | {slack} | {tolerance} | {report.volume_error:.0e} | "
        f"{report.seconds:.2f} | {verdict} |"
    )


def _read(path: str, heal: bool) -> tuple[PartReport, ...] | str:
    try:
        return reports_of(path, heal=heal)
    except (ValueError, RuntimeError) as error:
        return str(error)


def table(folder: Path, heal: bool = False) -> Iterator[tuple[str, int, int]]:
    """Rows of the table; of each how many solids it stands for, and how many were made first."""
    head = (
        "| file | part | faces | slack / size | file's tolerance | volume error | s | verdict |",
        "|---|---|---|---|---|---|---|---|",
    )
    yield head[0], 0, 0
    yield head[1], 0, 0
    files = sorted(f for f in folder.rglob("*") if f.suffix.lower() in ENDINGS)
    context = multiprocessing.get_context("spawn")
    pool = context.Pool(1)
    for file in files:
        waiting = pool.apply_async(_read, (str(file), heal))
        try:
            found = waiting.get(LIMIT)
        except multiprocessing.TimeoutError:
            pool.terminate()
            pool = context.Pool(1)
            found = f"took more than {LIMIT:g} s"
        if isinstance(found, str):
            yield f"| {file.name} | - | - | - | - | - | - | refused: {found} |", 0, 1
            continue
        for report in found:
            yield row(file.name, report), int(not report.refused), 1
    pool.terminate()


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--heal", action="store_true", help="let OpenCASCADE repair shapes")
    given = parser.parse_args(arguments)
    os.environ[store.SIZE] = "0"  # parts are made, not found
    made = total = 0
    for line, one, count in table(given.folder, given.heal):
        sys.stdout.write(line + "\n")
        sys.stdout.flush()
        made, total = made + one, total + count
    share = f"{made} of {total} different solids made" + ("" if given.heal else " unhealed")
    sys.stdout.write(f"\n{share}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
