"""Distances of pairs of CAD parts by gap: shares of each status, and times beside OpenCASCADE's.

Run it with ``python -m benchmarks.cad_gaps FILE FILE ...``: each file's part of most faces that can
be read is paired with the next one's. Times are of one thread, with closing, in milliseconds.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

import standoff as so
from standoff.cad.instances import Instance, at_place, brep_instances, step_instances
from standoff.cad.making import made_part
from standoff.solids import Solid

Pose = tuple[np.ndarray, np.ndarray]
GAPS = (1.0, 0.1, 1e-2, 1e-3, 1e-6)
"""Fractions of the greater part's size."""
NEAR = 0.2
"""A pose's gap may differ from the one that is asked for by this fraction of it."""
MOST_MOVES = 30


@dataclass(frozen=True)
class Loaded:
    """A part, and OpenCASCADE's own."""

    name: str
    shape: Any
    theirs: Any
    size: float
    faces: int


def loaded(path: Path) -> Loaded | None:
    """A file's readable part of most faces."""
    brep = path.suffix.lower() in (".brep", ".rle")
    found: list[Instance] = brep_instances(path) if brep else step_instances(path, "mm")[0]
    best = None
    for instance in found:
        made = made_part(instance.shape, instance.name, False)
        count = sum(made.report.faces.values())
        if made.shape is not None and (best is None or count > best.faces):
            best = Loaded(path.name, Solid(made.shape), instance.shape, made.report.size, count)
    return best


def drawn_turn(rng: np.random.Generator) -> np.ndarray:
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q if np.linalg.det(q) > 0.0 else -q


def posed(a: Loaded, b: Loaded, gap: float, rng: np.random.Generator) -> Pose | None:
    """A drawn pose of b about `gap` from a; None where moving along the normal does not find it."""
    turn, way = drawn_turn(rng), rng.normal(size=3)
    move = way / np.linalg.norm(way) * (a.size + b.size)
    for _ in range(MOST_MOVES):
        answer = so.distance(a.shape, b.shape, None, (turn, move))
        if answer.distance > 0.0 and abs(answer.distance - gap) <= NEAR * gap:
            return turn, move
        if not np.isfinite(answer.normal).all():
            return None
        move = move + (gap - answer.distance) * np.asarray(answer.normal)
    return None


def between(one: Any, other: Any) -> float:
    """OpenCASCADE's distance of its shapes."""
    from OCP.BRepExtrema import BRepExtrema_DistShapeShape

    return float(BRepExtrema_DistShapeShape(one, other).Value())


def their_distance(a: Any, b: Any, pose: Pose) -> float:
    """Of two whose `theirs` are shapes of OpenCASCADE."""
    return between(a.theirs, at_place(Instance("", b.theirs, np.column_stack(pose), None)))


def timed(function: Callable[..., Any], *given: Any) -> tuple[Any, float]:
    start = time.perf_counter()
    value = function(*given)
    return value, 1e3 * (time.perf_counter() - start)


def row(pairs: list[tuple[Loaded, Loaded]], share: float, poses: int, theirs: int) -> str:
    rng = np.random.default_rng(0)
    ours, others, statuses, off, none = [], [], Counter(), 0.0, 0
    for a, b in pairs:
        size = max(a.size, b.size)
        for k in range(poses):
            pose = posed(a, b, share * size, rng)
            if pose is None:
                none += 1
                continue
            answer, spent = timed(so.distance, a.shape, b.shape, None, pose)
            ours.append(spent)
            statuses[answer.status.name] += 1
            if k < theirs:
                value, spent = timed(their_distance, a, b, pose)
                others.append(spent)
                off = max(off, abs(value - answer.distance) / size)
    told = ", ".join(f"{name} {100 * n / len(ours):.1f} %" for name, n in statuses.most_common())
    cells = [
        f"{share:g}",
        f"{len(ours)}",
        told,
        f"{np.median(ours):.2f}",
        f"{np.quantile(ours, 0.99):.1f}",
        f"{np.median(others):.0f}",
        f"{np.quantile(others, 0.99):.0f}",
        f"{off:.1e}",
        f"{none}",
    ]
    return "| " + " | ".join(cells) + " |"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", type=Path, nargs="+")
    parser.add_argument("--poses", type=int, default=10)
    parser.add_argument("--theirs", type=int, default=3, help="poses that OpenCASCADE gets too")
    given = parser.parse_args()
    parts = [part for file in given.files if (part := loaded(file)) is not None]
    for part in parts:
        print(f"{part.name}: {part.faces} faces")
    pairs = list(pairwise(parts))
    so.distance(parts[0].shape, parts[1].shape, None, (np.eye(3), (2e3, 0.0, 0.0)))
    heads = ("gap / size", "poses", "statuses", "median ms", "99 %", "OCCT median ms", "99 %")
    print("| " + " | ".join((*heads, "off / size", "no pose")) + " |")
    print("|---" * (len(heads) + 2) + "|")
    for share in GAPS:
        print(row(pairs, share, given.poses, given.theirs), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
