"""The ratios that are aimed at, and what was measured of them in this run."""

from __future__ import annotations

from dataclasses import dataclass

from benchmarks.bench import library
from benchmarks.bench.peers import coal, coal_mesh, opencascade
from benchmarks.bench.race import Row

BEFORE = "python -m benchmarks.regression BEFORE AFTER"
"""The command that measures a ratio against another commit."""
WORST = "python -m benchmarks.bench --worst 1000000"
ELLIPSOIDS = "ellipsoids"
NURBS = "NURBS of degree 4"
AGAINST_BEFORE = (
    ("smooth quadric step, full answer", "1/3"),
    ("general frame (lens; box and ellipsoid, with switches)", "1/2"),
    ("NURBS pair, degree 3", "1/4"),
    ("cold query", "1/2"),
    ("a frame in penetration, ellipsoids", "1/5"),
    ("a frame in penetration, boxes", "1"),
)
"""Work, and the ratio to the commit before that is aimed at, at most."""
REACHED = 1e-5
"""How far the triangles of a body may lie from its surface, over the size: a pair's distance may be
off by twice that."""


@dataclass(frozen=True)
class Goal:
    """Work against other work on a pair, and the greatest ratio of their times; inf: none."""

    pair: str
    work: str
    against: str
    most: float


GOALS = (
    *(
        Goal(ELLIPSOIDS, work, against, most)
        for against, limits in (
            (f"{coal.DISTANCE}, default", (1.0, 0.35, 0.2)),
            (f"{coal.GUESS}, default", (2.0, 0.7, 0.4)),
        )
        for work, most in zip((library.STEP, library.STEP_INTO, library.RUN), limits, strict=True)
    ),
    *(
        Goal(NURBS, work, against, float("inf"))
        for work in (library.COLD, library.STEP)
        for against in (opencascade.SURFACES, opencascade.SHAPES)
    ),
)


def lines(rows: list[Row]) -> list[str]:
    """The table of goals as Markdown."""
    known = {(row.pair, row.contender): row for row in rows}
    told = ["| work | against | goal | measured | |", "|---|---|---|---|---|"]
    for goal in GOALS:
        own, other = (known.get((goal.pair, name)) for name in (goal.work, goal.against))
        work = f"{goal.pair}: {goal.work}"
        if own is None or other is None or not own.times or not other.times:
            told.append(f"| {work} | {goal.against} | {_limit(goal.most)} | not measured | |")
            continue
        ratio = own.median / other.median
        told.append(
            f"| {work} | {goal.against} | {_limit(goal.most)} | {ratio:.3g} "
            f"| {_verdict(ratio, goal.most)} |"
        )
    told += _mesh(known)
    told += [
        f"| {work} | the commit before | ≤ {most} | `{BEFORE}` | |" for work, most in AGAINST_BEFORE
    ]
    told.append(f"| worst frame of 10⁶ | its own median | the number | `{WORST}` | |")
    return told


def _limit(most: float) -> str:
    return "the ratio" if most == float("inf") else f"≤ {most:g}"


def _verdict(ratio: float, most: float) -> str:
    return "" if most == float("inf") else "met" if ratio <= most else "**not met**"


def _mesh(known: dict[tuple[str, str], Row]) -> list[str]:
    """Against the coarsest mesh of both bodies that is right to 1e-5 of the size."""
    own = known.get((ELLIPSOIDS, library.STEP))
    meshes = [known.get((ELLIPSOIDS, coal_mesh.name_of(x))) for x in coal_mesh.FINENESS]
    fit = [row for row in meshes if row is not None and row.distance_error <= 2.0 * REACHED]
    if own is None or not fit:
        return ["| curved body at 1e-5 | Coal on a mesh | ≤ 1/10 time | no mesh reached it | |"]
    mesh = min(fit, key=lambda row: row.memory)
    told = []
    for work, ratio, most in (
        ("time of `tracker.step`", own.median / mesh.median, 1e-1),
        ("memory", own.memory / mesh.memory, 1e-3),
    ):
        told.append(
            f"| curved body at 1e-5: {work} | {mesh.contender} | ≤ {most:g} | {ratio:.3g} "
            f"| {_verdict(ratio, most)} |"
        )
    return told
