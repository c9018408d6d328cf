"""``python -m standoff_studies.soak.solid_trims``: random parts of constructive geometry, read from
files of OpenCASCADE, and their points and distances judged by OpenCASCADE.

Each part is one or two cuts, unions or intersections of boxes, wedges, cylinders, cones, balls and
tori. Half of them are turned anyhow, half by quarters at places of a lattice, where seams, poles
and trims meet. It is read as it is, through BREP or through STEP. Of each point OpenCASCADE's
classifier says on which side it is, and its extrema how far; of some balls and boxes the distance.
Where OpenCASCADE's distance is greater than ours, it has missed a nearer place if ours is on its
boundary. The exit code is 1 where the library is wrong; refused parts are counted by their reasons.
"""

from __future__ import annotations

import os
import re
import tempfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np

import standoff as so
from standoff.cad import store
from standoff.errors import StandoffError
from standoff.kernels.body import layout as L
from standoff_studies.soak import blocks
from standoff_studies.soak.solid_outlines import Array

AGREED = 1e-6
"""Length, of parts of about 1: OpenCASCADE's own tolerance is 1e-7, and it may add up."""
POINTS, BY_VERTICES, DISTANCES = 100, 40, 10
"""Of each part."""
BOXES = 12
"""Small ones, from which distances are asked."""
KINDS = ("box", "wedge", "cylinder", "cone", "ball", "torus")
OPERATIONS = ("cut", "fuse", "common")
ROUTES = ("as it is", "brep", "step")


@dataclass
class Judged:
    """Counts of what was drawn, and of what was found wrong."""

    parts: int = 0
    void: int = 0
    refused: Counter[str] = field(default_factory=Counter)
    points: int = 0
    distances: int = 0
    sides: int = 0
    far: int = 0
    unproven: int = 0
    missed: int = 0

    def plus(self, other: Judged) -> Judged:
        """Both, count by count."""
        own, more = vars(self), vars(other)
        return Judged(**{name: own[name] + more[name] for name in own})

    @property
    def sound(self) -> bool:
        """Was nothing wrong?"""
        return not (self.sides or self.far)

    def __str__(self) -> str:
        why = "; ".join(f"{n} {reason}" for reason, n in self.refused.most_common())
        return (
            f"{self.parts:,} parts ({self.void} more drawn were empty, or invalid by OpenCASCADE), "
            f"{self.refused.total()} refused ({why}); {self.points:,} points and "
            f"{self.distances:,} distances: {self.sides} on the wrong side, {self.far} wrong by "
            f"more than {AGREED:g}, {self.unproven} with wider bounds; OpenCASCADE missed a nearer "
            f"place {self.missed} times"
        )


def _placement(rng: np.random.Generator, lattice: bool) -> Any:
    from OCP.gp import gp_Quaternion, gp_Trsf, gp_Vec

    if lattice:
        q = np.zeros(4)
        q[rng.integers(4)], q[rng.integers(4)] = 1.0, 1.0
        shift = rng.integers(-2, 3, 3) * 0.25
    else:
        q, shift = rng.normal(size=4), rng.uniform(-0.5, 0.5, 3)
    motion = gp_Trsf()
    motion.SetRotation(gp_Quaternion(*(q / np.linalg.norm(q)).tolist()))
    motion.SetTranslationPart(gp_Vec(*shift.tolist()))
    return motion


def primitive(kind: str, rng: np.random.Generator, lattice: bool) -> Any:
    """A shape of a kind about the origin, moved at random."""
    from OCP import BRepPrimAPI as made_by
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    a, b, c = rng.uniform(0.2, 1.0, 3).tolist()
    if lattice:
        a, b, c = (rng.integers(1, 5, 3) * 0.25).tolist()
    axes = gp_Ax2(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(0.0, 0.0, 1.0))
    if kind == "box":
        shape = made_by.BRepPrimAPI_MakeBox(gp_Pnt(-a, -b, -c), 2.0 * a, 2.0 * b, 2.0 * c).Shape()
    elif kind == "wedge":
        shape = made_by.BRepPrimAPI_MakeWedge(axes, 2.0 * a, 2.0 * b, 2.0 * c, 0.7 * a).Shape()
    elif kind == "cylinder":
        shape = made_by.BRepPrimAPI_MakeCylinder(axes, a, 2.0 * c).Shape()
    elif kind == "cone":
        shape = made_by.BRepPrimAPI_MakeCone(axes, a, rng.choice([0.0, 0.5 * a]), 2.0 * c).Shape()
    elif kind == "ball":
        shape = made_by.BRepPrimAPI_MakeSphere(axes, a).Shape()
    else:
        shape = made_by.BRepPrimAPI_MakeTorus(axes, a, 0.4 * a).Shape()
    return BRepBuilderAPI_Transform(shape, _placement(rng, lattice), True).Shape()


def part_of(rng: np.random.Generator) -> Any:
    """The greatest solid of a random part; None where there is none that OpenCASCADE takes for
    valid."""
    from OCP import BRepAlgoAPI
    from OCP.BRepCheck import BRepCheck_Analyzer

    from standoff.cad.measures import volume_of
    from standoff.cad.opencascade import explored

    lattice = bool(rng.integers(2))
    shape = primitive(str(rng.choice(KINDS)), rng, lattice)
    for _ in range(int(rng.integers(1, 3))):
        other = primitive(str(rng.choice(KINDS)), rng, lattice)
        named = str(rng.choice(OPERATIONS)).capitalize()
        made = getattr(BRepAlgoAPI, f"BRepAlgoAPI_{named}")(shape, other)
        solids = list(explored(made.Shape(), "solid")) if made.IsDone() else []
        if not solids:
            return None
        shape = max(solids, key=volume_of)
    valid = BRepCheck_Analyzer(shape).IsValid() and volume_of(shape) > AGREED
    return shape if valid else None


def read_through(shape: Any, route: str) -> tuple[Any, Any]:
    """The solid of a shape, through a file or not, and the shape that OpenCASCADE reads there: its
    STEP files do not always hold what was written."""
    if route == "as it is":
        return so.cad.from_shape(shape)[0].solid, shape
    with tempfile.TemporaryDirectory() as folder:
        file = str(Path(folder) / f"part.{route}")
        if route == "brep":
            from OCP.BRep import BRep_Builder
            from OCP.BRepTools import BRepTools
            from OCP.TopoDS import TopoDS_Shape

            BRepTools.Write_s(shape, file)
            again = TopoDS_Shape()
            BRepTools.Read_s(again, file, BRep_Builder())
        else:
            from OCP.Message import Message, Message_Gravity
            from OCP.STEPControl import (
                STEPControl_Reader,
                STEPControl_StepModelType,
                STEPControl_Writer,
            )

            for printer in Message.DefaultMessenger_s().Printers():
                printer.SetTraceLevel(Message_Gravity.Message_Fail)
            writer = STEPControl_Writer()
            writer.Transfer(shape, STEPControl_StepModelType.STEPControl_AsIs)
            writer.Write(file)
            reader = STEPControl_Reader()
            reader.ReadFile(file)
            reader.TransferRoots()
            again = reader.OneShape()
        return so.cad.read_cad(file)[0].solid, again


def between(one: Any, other: Any) -> float:
    """OpenCASCADE's distance; nan where it gives none."""
    from OCP.BRepExtrema import BRepExtrema_DistShapeShape

    try:
        found = BRepExtrema_DistShapeShape(one, other)
        return float(found.Value()) if found.IsDone() else float("nan")
    except Exception as error:
        # its exceptions have no common class in Python
        if not type(error).__module__.startswith("OCP"):
            raise
        return float("nan")


def vertex(point: Array) -> Any:
    """A point as a shape."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeVertex
    from OCP.gp import gp_Pnt

    return BRepBuilderAPI_MakeVertex(gp_Pnt(*np.asarray(point).tolist())).Vertex()


def on_boundary(shape: Any, point: Array, room: float) -> bool:
    """Is a point on a part's boundary, by OpenCASCADE's extrema or its classifier? Beside narrow
    notches the first take points that are on a face for off it."""
    from OCP.BRepClass3d import BRepClass3d, BRepClass3d_SolidClassifier
    from OCP.gp import gp_Pnt
    from OCP.TopAbs import TopAbs_ON

    from standoff.cad.opencascade import explored

    shells = list(explored(shape, "shell")) or [BRepClass3d.OuterShell_s(shape)]
    if min(between(vertex(point), shell) for shell in shells) <= room:
        return True
    classifier = BRepClass3d_SolidClassifier(shape)
    classifier.Perform(gp_Pnt(*np.asarray(point).tolist()), room)
    return bool(classifier.State() == TopAbs_ON)


def judge_points(shape: Any, solid: Any, points: Array, seen: Judged) -> Iterator[str]:
    """Sides and distances of points of a part; lines of those that are wrong."""
    from OCP.BRepClass3d import BRepClass3d, BRepClass3d_SolidClassifier
    from OCP.gp import gp_Pnt
    from OCP.TopAbs import TopAbs_IN, TopAbs_OUT

    from standoff.cad.opencascade import explored

    classifier = BRepClass3d_SolidClassifier(shape)
    shells = list(explored(shape, "shell")) or [BRepClass3d.OuterShell_s(shape)]
    told = solid.signed_distance(points)
    for k, point in enumerate(points):
        seen.points += 1
        own = float(told.distance[k])
        seen.unproven += not told.converged[k]
        classifier.Perform(gp_Pnt(*point.tolist()), 1e-9)
        state = {TopAbs_IN: -1.0, TopAbs_OUT: 1.0}.get(classifier.State(), 0.0)
        true = np.nanmin([between(vertex(point), shell) for shell in shells])
        room = AGREED + solid.slack
        if own * state < 0.0 and min(abs(own), true) > room:
            seen.sides += 1
            yield f"side of {point.tolist()}: {own!r}, by OpenCASCADE {state * true!r}"
        elif abs(abs(own) - true) > room:
            away = float(np.linalg.norm(told.nearest[k] - point))
            missed = abs(own) < true and abs(away - abs(own)) <= room
            missed = missed and on_boundary(shape, told.nearest[k], room)
            seen.missed += missed
            seen.far += not missed
            if not missed:
                yield f"distance of {point.tolist()}: {own!r}, by OpenCASCADE {true!r}"


@cache
def _box(number: int) -> tuple[Array, Any]:
    """Half the sides of a small box, and the box: made once, which takes longer than a distance."""
    half = np.random.default_rng(number).uniform(0.05, 0.3, 3)
    return half, so.shapes.box(tuple(2.0 * half))


def judge_distances(
    shape: Any, solid: Any, rng: np.random.Generator, seen: Judged
) -> Iterator[str]:
    """Distances to small boxes beside a part; lines of those that are wrong."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.gp import gp_Pnt

    places = rng.uniform(-2.0, 2.0, (DISTANCES, 3))
    for k, place in zip(rng.integers(BOXES, size=DISTANCES).tolist(), places, strict=True):
        sides, box = _box(k)
        low, high = (place - sides).tolist(), (place + sides).tolist()
        true = between(shape, BRepPrimAPI_MakeBox(gp_Pnt(*low), gp_Pnt(*high)).Shape())
        pose = np.eye(4)
        pose[:3, 3] = place
        own = so.distance(solid, box, np.eye(4), pose)
        seen.distances += 1
        room = AGREED + own.slack
        apart = 0.0 if own.status is so.Status.CONTAINED else max(own.distance, 0.0)
        if abs(apart - true) <= room:
            continue
        missed = 0.0 < apart < true and on_boundary(shape, own.point_a, room)
        seen.missed += missed
        seen.far += not missed
        if not missed:
            yield f"box {sides.tolist()} at {place.tolist()}: {own!r}, by OpenCASCADE {true!r}"


def by_vertices(solid: Any, rng: np.random.Generator) -> Array:
    """Points (n, 3) about vertices, whose sides the faces' corners there decide."""
    vertices = np.array(solid.boundary.vertex_points).reshape(-1, 3)
    if not len(vertices):
        return vertices
    ways = rng.normal(size=(BY_VERTICES, 3))
    ways *= solid.size * 10.0 ** rng.uniform(-4.0, -0.5, (BY_VERTICES, 1))
    near: Array = vertices[rng.integers(len(vertices), size=BY_VERTICES)] + ways
    return near


def judge_part(number: int, seed: int) -> tuple[Judged, list[str]]:
    """One part with its points and distances."""
    rng = np.random.default_rng([seed, number, 3])
    seen, shape = Judged(parts=1), part_of(rng)
    while shape is None:
        seen.void += 1
        shape = part_of(rng)
    route = ROUTES[number % len(ROUTES)]
    try:
        solid, shape = read_through(shape, route)
        reals = solid.boundary.reals
        middle, half = reals[L.BOX_CENTRE : L.BOX_CENTRE + 3], reals[L.BOX_HALF : L.BOX_HALF + 3]
        points = middle + 1.3 * half * rng.uniform(-1.0, 1.0, (POINTS, 3))
        lines = [*judge_points(shape, solid, points, seen)]
        lines += judge_distances(shape, solid, rng, seen)
        lines += judge_points(shape, solid, by_vertices(solid, rng), seen)
    except StandoffError as error:
        reason = re.sub(r"^.*refused\. ", "", str(error))
        seen.refused[re.sub(r"-?\d[\d.e+-]*", "#", reason)[:120]] += 1
        lines = [f"refused: {error}"]
    return seen, [f"part {number} ({route}): {line}" for line in lines]


def main() -> int:
    """Read the options, run, and tell; 1 if the library was wrong."""
    parser = blocks.options(__doc__, "parts", 1_000, 1)
    given = parser.parse_args()
    os.environ[store.SIZE] = "0"  # parts are made, not found
    found = blocks.run(given, 1, partial(judge_part, seed=given.seed))
    return 0 if found is None or found.sound else 1


if __name__ == "__main__":
    raise SystemExit(main())
