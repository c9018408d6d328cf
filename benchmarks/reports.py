"""Reports on assemblies: ten that are known in closed form, and how long a report takes.

Run it with ``python -m benchmarks.reports``; ``FILE ...`` are further assemblies, ``--only``
chooses some. Assemblies of 10, 100 and 400 different parts, and of 400 copies of two, are pins in
bored blocks, written as STEP. Times are of ``standoff clearance FILE --min 0.1`` as a process of
its own, user and system time, in seconds: the first reading, and the least of three that find them
in the store; beside OpenCASCADE's distances pair by pair, of up to ``--most`` pairs, scaled to all.
It fails where a verdict or a gap is not that of the closed form.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from itertools import combinations, islice
from pathlib import Path
from typing import Any, NamedTuple

from benchmarks.cad_gaps import between
from standoff.cad.instances import at_place, step_instances

COMMAND = "import sys; from standoff.cli import main; sys.exit(main())"
LEAST = 0.1
READINGS = 3
EXACT = 1e-9
"""Of 1 mm: what a proven gap may differ from its closed form by, beside rounding of the file."""
SIDE, TALL, APART = 10.0, 8.0, 0.5
"""Of a block: its width and height, and how far it is from the next one."""


class Use(NamedTuple):
    """A part of an assembly: its name, its shape, where it is moved."""

    name: str
    shape: Any
    at: tuple[float, float, float] = (0.0, 0.0, 0.0)


class Known(NamedTuple):
    """An assembly, and the verdict and gap of some of its pairs."""

    name: str
    uses: list[Use]
    pairs: dict[frozenset[str], tuple[str, float]]


def cylinder(radius: float, low: float, high: float, way: str = "z", y: float = 0.0) -> Any:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    along = {"x": (1.0, 0.0, 0.0), "z": (0.0, 0.0, 1.0)}[way]
    start = gp_Pnt(low * along[0], y, low * along[2])
    return BRepPrimAPI_MakeCylinder(gp_Ax2(start, gp_Dir(*along)), radius, high - low).Shape()


def cone(low: float, high: float, height: float) -> Any:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCone

    return BRepPrimAPI_MakeCone(low, high, height).Shape()


def box(*sides: float) -> Any:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.gp import gp_Pnt

    return BRepPrimAPI_MakeBox(gp_Pnt(*(-0.5 * side for side in sides)), *sides).Shape()


def ball(radius: float) -> Any:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeSphere

    return BRepPrimAPI_MakeSphere(radius).Shape()


def ring(radius: float, tube: float, way: tuple[float, float, float]) -> Any:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeTorus
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    return BRepPrimAPI_MakeTorus(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(*way)), radius, tube).Shape()


def cut(one: Any, other: Any) -> Any:
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut

    return BRepAlgoAPI_Cut(one, other).Shape()


def tube(inner: float, outer: float, low: float, high: float) -> Any:
    return cut(cylinder(outer, low, high), cylinder(inner, low - 1.0, high + 1.0))


def in_closed_form() -> Iterator[Known]:
    """Ten assemblies."""
    bush, pair = tube(3.0, 5.0, 0.0, 10.0), frozenset
    pin = cylinder(2.95, 0.0, 10.0)
    yield Known("pin flush", [Use("a", bush), Use("b", pin)], {pair("ab"): ("APART", 0.05)})
    stack = [Use("a", box(20, 20, 2)), Use("b", box(10, 10, 2), (0, 0, 2)), Use("c", ball(3))]
    stack[2] = stack[2]._replace(at=(0.0, 0.0, 6.03))
    yield Known("stack", stack, {pair("ab"): ("TOUCHING", 0.0), pair("bc"): ("APART", 0.03)})
    pressed = cylinder(3.025, 0.0, 10.0)
    told = {pair("ab"): ("OVERLAPPING", -0.025)}
    yield Known("press fit", [Use("a", bush), Use("b", pressed)], told)
    aside = Use("b", cylinder(2.9, -2.0, 12.0), (0.04, 0.0, 0.0))
    yield Known("eccentric", [Use("a", bush), aside], {pair("ab"): ("APART", 0.06)})
    rod, around = cylinder(3.95, -10.0, 10.0), ring(5.0, 1.0, (0, 0, 1))
    yield Known("o-ring", [Use("a", rod), Use("b", around)], {pair("ab"): ("APART", 0.05)})
    seat, plug = cut(cylinder(8.0, 0.0, 10.0), cone(3.0, 5.0, 10.0)), cone(3.0, 5.0, 10.0)
    lift = 0.3 * math.sin(math.atan2(2.0, 10.0))
    taper = [Use("a", seat), Use("b", plug, (0.0, 0.0, 0.3))]
    yield Known("taper", taper, {pair("ab"): ("APART", lift)})
    crossed = [Use("a", cylinder(2.0, -10.0, 10.0)), Use("b", cylinder(3.0, -9.0, 9.0, "x", 5.07))]
    yield Known("crossed", crossed, {pair("ab"): ("APART", 0.07)})
    room = [Use("a", cut(box(10, 10, 10), box(8, 8, 8))), Use("b", box(7.9, 7.9, 7.9))]
    yield Known("in a cavity", room, {pair("ab"): ("APART", 0.05)})
    links = [Use("a", ring(5.0, 2.46, (0, 0, 1))), Use("b", ring(5.0, 2.46, (1, 0, 0)), (0, 5, 0))]
    yield Known("links", links, {pair("ab"): ("APART", 0.08)})
    nest = [Use("abc"[k], tube(2.0 + k, 2.98 + k, 0.0, 6.0)) for k in range(3)]
    told = {pair("ab"): ("APART", 0.02), pair("bc"): ("APART", 0.02)}
    yield Known("nested tubes", nest, told)


def pins(cells: int, different: bool) -> Known:
    """Pins in bored blocks, in rows: all of other sizes, or copies of two."""
    uses, told, made = [], {}, None
    for k in range(cells):
        bore, play = (2.0 + 0.005 * k, 0.02 + 0.001 * k) if different else (2.0, 0.05)
        if made is None or different:
            block = cut(box(SIDE, SIDE, TALL), cylinder(bore, -TALL, TALL))
            made = block, cylinder(bore - play, -0.5 * TALL, TALL)
        at = (k % 20 * (SIDE + APART), k // 20 * (SIDE + APART), 0.0)
        names = f"block {k}", f"pin {k}"
        uses += [Use(name, shape, at) for name, shape in zip(names, made, strict=True)]
        if play < LEAST:
            told[frozenset(names)] = ("APART", play)
    return Known(f"{2 * cells} {'different' if different else 'copies'}", uses, told)


def write_assembly(path: Path, uses: list[Use]) -> None:
    from OCP.gp import gp_Trsf, gp_Vec
    from OCP.Message import Message, Message_Gravity
    from OCP.STEPCAFControl import STEPCAFControl_Writer
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDataStd import TDataStd_Name
    from OCP.TDocStd import TDocStd_Document
    from OCP.TopLoc import TopLoc_Location
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    for printer in Message.DefaultMessenger_s().Printers():
        printer.SetTraceLevel(Message_Gravity.Message_Fail)
    document = TDocStd_Document(TCollection_ExtendedString("made"))
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    root = shapes.NewShape()
    parts: dict[int, Any] = {}
    for use in uses:
        part = parts.setdefault(id(use.shape), None) or shapes.AddShape(use.shape, False)
        parts[id(use.shape)] = part
        at = gp_Trsf()
        at.SetTranslation(gp_Vec(*use.at))
        label = shapes.AddComponent(root, part, TopLoc_Location(at))
        TDataStd_Name.Set_s(label, TCollection_ExtendedString(use.name))
    shapes.UpdateAssemblies()
    writer = STEPCAFControl_Writer()
    writer.SetNameMode(True)
    writer.Transfer(document)
    writer.Write(str(path))


def reported(file: Path, store: Path) -> tuple[dict[str, Any], float, float]:
    """A report, and its processor and wall time, s."""
    given = ["clearance", str(file), "--min", f"{LEAST:g}", "--json"]
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-c", COMMAND, *given],
        capture_output=True,
        text=True,
        env={**os.environ, "STANDOFF_CACHE_DIR": str(store)},
        check=False,
    )
    wall, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode not in (0, 3):
        raise SystemExit(done.stderr)
    spent = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
    return json.loads(done.stdout), spent, wall


def wrong(known: Known, facts: dict[str, Any]) -> list[str]:
    """What differs from the closed form."""
    rows = {frozenset(row["names"]): row for row in facts["pairs"]}
    found = []
    for names, (verdict, gap) in known.pairs.items():
        row = rows[names]
        off = max(row["lower_bound"] - gap, gap - row["upper_bound"])
        near = abs(row["distance"] - gap) <= EXACT or verdict == "OVERLAPPING"
        if row["verdict"] != verdict or off > EXACT or not near:
            told = [row[name] for name in ("verdict", "lower_bound", "distance", "upper_bound")]
            found.append(f"{known.name}, {sorted(names)}: {told} for {verdict} {gap:g}")
    more = [sorted(n) for n, row in rows.items() if n not in known.pairs and row["failure"]]
    return found + [f"{known.name}, {names}: no failure is expected" for names in more]


def their_time(file: Path, most: int) -> float:
    """What OpenCASCADE's distances of all pairs take, s, by those of `most` of them."""
    found = step_instances(file, "mm")[0]
    shapes = [at_place(each) for each in found]
    count = len(shapes) * (len(shapes) - 1) // 2
    start = time.process_time()
    asked = [between(*pair) for pair in islice(combinations(shapes, 2), most)]
    return (time.process_time() - start) * count / len(asked)


def row(file: Path, known: Known | None, store: Path, most: int) -> tuple[str, list[str]]:
    facts, first, _ = reported(file, store)
    again = [reported(file, store) for _ in range(READINGS)]
    faults = [] if known is None else wrong(known, facts) + wrong(known, again[-1][0])
    n = facts["bodies"]
    cells = [file.stem, n, n * (n - 1) // 2, len(facts["pairs"])]
    times = (first, min(x[1] for x in again), min(x[2] for x in again), their_time(file, most))
    return "| " + " | ".join([*map(str, cells), *(f"{t:.2f}" for t in times)]) + " |", faults


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", type=Path, nargs="*")
    parser.add_argument("--only", default="", help="names of made assemblies that hold this")
    parser.add_argument("--most", type=int, default=500, help="pairs that OpenCASCADE gets")
    given = parser.parse_args()
    made = [*in_closed_form(), pins(5, True), pins(50, True), pins(200, True), pins(200, False)]
    heads = ("assembly", "parts", "pairs", "near", "first s", "again s", "again, wall s", "OCCT s")
    print("| " + " | ".join(heads) + " |\n" + "|---" * len(heads) + "|")
    faults = []
    with tempfile.TemporaryDirectory() as folder:
        store = Path(folder) / "store"
        todo: list[tuple[Path, Known | None]] = [(file, None) for file in given.files]
        for known in made:
            if given.only in known.name:
                todo.append((Path(folder) / f"{known.name}.step", known))
                write_assembly(todo[-1][0], known.uses)
        for file, expected in todo:
            line, found = row(file, expected, store, given.most)
            print(line, flush=True)
            faults += found
    print("\n".join(faults) or "All verdicts and gaps are those of the closed forms.")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
