"""The table of CAD parts in a folder: ``python -m benchmarks.cad_parts FOLDER``.

With ``--files`` a row for each file: its parts and faces, what they miss each other by, and the
processor time of OpenCASCADE's own reading, of ours, and of ours that finds the parts in the store,
in seconds, with all packages loaded and kernels compiled.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

from benchmarks.reports import box, cut, cylinder
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


def file_row(name: str, read: tuple[tuple[PartReport, ...], tuple[float, ...]]) -> str:
    reports, times = read
    kinds: Counter[str] = Counter()
    for report in reports:
        kinds.update(report.faces)
    made = [report for report in reports if not report.refused]
    told = ", ".join(f"{n} {kind}" for kind, n in kinds.most_common())
    slack = f"{max(report.slack for report in made):.1e}" if made else "-"
    shown = [f"{len(made)} of {len(reports)}", told, slack, *(f"{t:.2f}" for t in times)]
    return "| " + " | ".join([name, *shown]) + " |"


def _timed(path: str, heal: bool) -> tuple[tuple[PartReport, ...], tuple[float, ...]] | str:
    """A file's reports, and the processor times of three readings."""
    times, reports = [time.process_time()], ()
    try:
        their_reading(path)
        times.append(time.process_time())
        for _ in range(2):
            reports = reports_of(path, heal=heal)
            times.append(time.process_time())
    except (ValueError, RuntimeError) as error:
        return str(error)
    return reports, tuple(after - before for before, after in pairwise(times))


def their_reading(path: str) -> None:
    """OpenCASCADE's, with all shapes made."""
    if path.lower().endswith((".brep", ".rle")):
        from OCP.BRep import BRep_Builder
        from OCP.BRepTools import BRepTools
        from OCP.TopoDS import TopoDS_Shape

        BRepTools.Read_s(TopoDS_Shape(), path, BRep_Builder())
        return
    from OCP.STEPControl import STEPControl_Reader

    reader = STEPControl_Reader()
    reader.ReadFile(path)
    reader.TransferRoots()


def _read(path: str, heal: bool) -> tuple[PartReport, ...] | str:
    try:
        return reports_of(path, heal=heal)
    except (ValueError, RuntimeError) as error:
        return str(error)


def warm_up() -> None:
    """Load what a first reading loads."""
    from OCP.BRepTools import BRepTools

    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "bored.brep"
        assert BRepTools.Write_s(cut(box(4, 4, 4), cylinder(1.0, -4.0, 4.0)), str(file))
        reports_of(file)


def read_files(folder: Path, reading: Callable[..., Any], heal: bool) -> Iterator[tuple[str, Any]]:
    """Of each CAD file its name, and what was read of it or why nothing was."""
    context = multiprocessing.get_context("spawn")
    pool = context.Pool(1, warm_up)
    for file in sorted(f for f in folder.rglob("*") if f.suffix.lower() in ENDINGS):
        waiting = pool.apply_async(reading, (str(file), heal))
        try:
            found = waiting.get(LIMIT)
        except multiprocessing.TimeoutError:
            pool.terminate()
            pool = context.Pool(1, warm_up)
            found = f"took more than {LIMIT:g} s"
        yield file.name, found
    pool.terminate()


def tell(*lines: str) -> None:
    sys.stdout.write("\n".join(lines) + "\n")
    sys.stdout.flush()


def heading(*names: str) -> None:
    tell("| " + " | ".join(names) + " |", "|---" * len(names) + "|")


def parts_told(folder: Path, heal: bool) -> None:
    heading("file", "part", "faces", "slack / size", "tolerance", "volume error", "s", "verdict")
    made = total = 0
    for name, found in read_files(folder, _read, heal):
        if isinstance(found, str):
            total += 1
            tell(f"| {name} | - | - | - | - | - | - | refused: {found} |")
            continue
        for report in found:
            made, total = made + int(not report.refused), total + 1
            tell(row(name, report))
    tell("", f"{made} of {total} different solids made" + ("" if heal else " unhealed"))


def files_told(folder: Path, heal: bool) -> None:
    heading("file", "made", "faces", "slack", "OCCT s", "first s", "again s")
    whole = total = 0
    for name, found in read_files(folder, _timed, heal):
        total += 1
        if isinstance(found, str):
            tell(f"| {name} | - | refused: {found} | - | - | - | - |")
            continue
        whole += int(all(not report.refused for report in found[0]))
        tell(file_row(name, found))
    tell("", f"{whole} of {total} files whole")


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--heal", action="store_true", help="let OpenCASCADE repair shapes")
    parser.add_argument("--files", action="store_true", help="a row a file, with times of reading")
    given = parser.parse_args(arguments)
    if given.files:
        with tempfile.TemporaryDirectory() as folder:
            os.environ[store.FOLDER] = folder
            files_told(given.folder, given.heal)
        return 0
    os.environ[store.SIZE] = "0"  # parts are made, not found
    parts_told(given.folder, given.heal)
    return 0


if __name__ == "__main__":
    sys.exit(main())
