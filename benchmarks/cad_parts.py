"""The table of CAD parts in a folder: ``python -m benchmarks.cad_parts FOLDER``.

With ``--files`` a row for each file: its parts and faces, what they miss each other by, and the
processor time of OpenCASCADE's own reading, of ours, and of ours that finds the parts in the store,
in seconds, with all packages loaded and kernels compiled. ``--by N`` begins a table for each folder
N levels down, such as the repositories of owners, with a row of sums.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import groupby, pairwise
from pathlib import Path
from typing import Any

from benchmarks.reports import box, cut, cylinder
from standoff.cad import PartReport, reports_of, store
from standoff.cad.files import ENDINGS

LIMIT = 600.0
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


def file_row(file: Path, reports: Sequence[PartReport], times: Sequence[float]) -> str:
    made = [report for report in reports if not report.refused]
    slack = f"{max(report.slack for report in made):.1e}" if made else "-"
    for report in reports:
        if report.refused:
            slack += f"; refused: {report.refused}"
    kinds = ", ".join(f"{n} {kind}" for kind, n in _kinds_of(reports).most_common())
    count = f"{len(made)}" if len(made) == len(reports) else f"{len(made)} of {len(reports)}"
    return _line(_named(file), count, kinds or "-", slack, *(f"{t:.2f}" for t in times))


def _kinds_of(reports: Iterable[PartReport]) -> Counter[str]:
    kinds: Counter[str] = Counter()
    for report in reports:
        kinds.update(report.faces)
    return kinds


def _named(file: Path) -> str:
    """A file's name, and its folder, which a table may break at its slashes."""
    folder = "".join(f"{part}/<wbr>" for part in file.parts[:-1])
    return f"`{file.name}`" + (f" {folder}" if folder else "")


def _line(*cells: str) -> str:
    return "| " + " | ".join(cells) + " |"


def _timed(path: str, heal: bool) -> tuple[tuple[PartReport, ...], tuple[float, ...]] | str:
    """A file's reports, and the processor times of three readings, with a store of its own: some
    files share parts."""
    times, reports = [time.process_time()], ()
    with tempfile.TemporaryDirectory() as kept:
        os.environ[store.FOLDER] = kept
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


def read_files(folder: Path, reading: Callable[..., Any], heal: bool) -> Iterator[tuple[Path, Any]]:
    """Of each CAD file its path within the folder, and what was read of it or why nothing was."""
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
        yield file.relative_to(folder), found
    pool.terminate()


def tell(*lines: str) -> None:
    sys.stdout.write("\n".join(lines) + "\n")
    sys.stdout.flush()


def heading(*names: str) -> None:
    tell("| " + " | ".join(names) + " |", "|---" * len(names) + "|")


def parts_told(folder: Path, heal: bool) -> None:
    heading("file", "part", "faces", "slack / size", "tolerance", "volume error", "s", "verdict")
    made = total = 0
    for file, found in read_files(folder, _read, heal):
        if isinstance(found, str):
            total += 1
            tell(f"| {file.name} | - | - | - | - | - | - | refused: {found} |")
            continue
        for report in found:
            made, total = made + int(not report.refused), total + 1
            tell(row(file.name, report))
    tell("", f"{made} of {total} different solids made" + ("" if heal else " unhealed"))


def files_told(folder: Path, heal: bool, by: int) -> None:
    """A table of the files in each folder `by` levels down, and one of their sums."""

    def group_of(found: tuple[Path, Any]) -> tuple[str, ...]:
        return found[0].parts[: min(by, len(found[0].parts) - 1)]

    found = read_files(folder, _timed, heal)
    sums = [_group_told(group, files) for group, files in groupby(found, group_of)]
    tell("")
    heading("folder", "files", "whole", "parts", "faces", "OCCT s", "first s", "again s")
    tell(*sums)


def _group_told(group: tuple[str, ...], files: Iterable[tuple[Path, Any]]) -> str:
    """Tells the rows of a folder's files; the row of their sums."""
    if group:
        tell("", f"### {'/'.join(group)}", "")
    heading("file", "parts", "faces", "slack", "OCCT s", "first s", "again s")
    count, spent = Counter[str](), [0.0, 0.0, 0.0]
    for path, read in files:
        file = path.relative_to(Path(*group))
        count["files"] += 1
        if isinstance(read, str):
            tell(_line(_named(file), "-", "-", read, "-", "-", "-"))
            continue
        reports, times = read
        count["whole"] += all(not report.refused for report in reports)
        count["parts"] += len(reports)
        count["faces"] += _kinds_of(reports).total()
        spent = [before + more for before, more in zip(spent, times, strict=True)]
        tell(file_row(file, reports, times))
    counted = (f"{count[name]}" for name in ("files", "whole", "parts", "faces"))
    return _line("/".join(group), *counted, *(f"{seconds:.1f}" for seconds in spent))


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--heal", action="store_true", help="let OpenCASCADE repair shapes")
    parser.add_argument("--files", action="store_true", help="a row a file, with times of reading")
    parser.add_argument("--by", type=int, default=0, help="a table for each folder so many down")
    given = parser.parse_args(arguments)
    if given.files:
        files_told(given.folder, given.heal, given.by)
        return 0
    os.environ[store.SIZE] = "0"  # parts are made, not found
    parts_told(given.folder, given.heal)
    return 0


if __name__ == "__main__":
    sys.exit(main())
