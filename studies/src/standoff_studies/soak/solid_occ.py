"""OpenCASCADE's ``BRepExtrema_DistShapeShape`` beside the library and the closed forms.

The shapes are made by OpenCASCADE itself from the outlines of `solid_parts`. It has no sign: while
the boundaries are apart, and neither solid is inside the other, its distance is compared.
"""

from __future__ import annotations

import time
from typing import Any, NamedTuple

from standoff_studies.soak.solid_judge import truths
from standoff_studies.soak.solid_outlines import Arc, Array, Outline, Segment
from standoff_studies.soak.solid_poses import Known
from standoff_studies.soak.solid_truth import Swept, Truth, Turned

AGREED = 1e-6
"""Length: OpenCASCADE's own tolerance is 1e-7."""
PARTS = ("bolt", "plate", "bracket", "channel", "ring", "drum", "brick")


class Comparison(NamedTuple):
    """Counts over poses apart: the library, and OpenCASCADE, off the closed form; seconds of
    both."""

    poses: int = 0
    library: int = 0
    occ: int = 0
    library_time: float = 0.0
    occ_time: float = 0.0

    def plus(self, other: Comparison) -> Comparison:
        sums = [a + b for a, b in zip(self, other, strict=True)]
        return Comparison(*(int(n) for n in sums[:3]), *sums[3:])

    def __str__(self) -> str:
        each = 1e3 / max(self.poses, 1)
        return (
            f"{self.poses:,} poses apart beside OpenCASCADE: {self.library} answers of the library "
            f"and {self.occ} of OpenCASCADE are off by more than {AGREED:g}; "
            f"{each * self.library_time:.2f} and {each * self.occ_time:.1f} ms"
        )


def shape_of(truth: Truth) -> Any:
    """OpenCASCADE's shape of a solid that is turned or swept.

    Raises
    ------
    ImportError
        Without OpenCASCADE: ``pip install cadquery-ocp-novtk``.
    TypeError
        Another solid.
    """
    from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism, BRepPrimAPI_MakeRevol, BRepPrimAPI_MakeTorus
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Vec

    if isinstance(truth, Turned):
        first = truth.outline.pieces[0]
        if isinstance(first, Arc) and first.full:
            return BRepPrimAPI_MakeTorus(float(first.centre[0]), first.radius).Shape()
        axis = gp_Ax1(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(0.0, 0.0, 1.0))
        return BRepPrimAPI_MakeRevol(_face(truth.outline, turned=True), axis).Shape()
    if isinstance(truth, Swept):
        along = gp_Vec(0.0, 0.0, truth.high - truth.low)
        return BRepPrimAPI_MakePrism(_face(truth.outline, height=truth.low), along).Shape()
    raise TypeError(f"{type(truth).__name__} is neither turned nor swept.")


def _face(outline: Outline, *, turned: bool = False, height: float = 0.0) -> Any:
    """A face in the plane y = 0, or at a height; a full circle is a hole."""
    from OCP.BRepBuilderAPI import (
        BRepBuilderAPI_MakeEdge,
        BRepBuilderAPI_MakeFace,
        BRepBuilderAPI_MakePolygon,
        BRepBuilderAPI_MakeWire,
    )
    from OCP.gp import gp_Ax2, gp_Circ, gp_Dir, gp_Pnt
    from OCP.TopoDS import TopoDS

    corners = BRepBuilderAPI_MakePolygon()
    for segment in (*outline.pieces, *outline.closing):
        if isinstance(segment, Segment):
            x, y = (float(c) for c in segment.p)
            corners.Add(gp_Pnt(x, 0.0, y) if turned else gp_Pnt(x, y, height))
    corners.Close()
    face = BRepBuilderAPI_MakeFace(corners.Wire())
    for arc in outline.pieces:
        if isinstance(arc, Arc):
            middle = gp_Pnt(float(arc.centre[0]), float(arc.centre[1]), height)
            circle = gp_Circ(gp_Ax2(middle, gp_Dir(0.0, 0.0, 1.0)), arc.radius)
            wire = BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(circle).Edge()).Wire()
            # the name of the static method depends on the version
            cast = getattr(TopoDS, "Wire_s", None) or TopoDS.Wire
            face.Add(cast(wire.Reversed()))
    return face.Face()


def placed(shape: Any, pose: Array) -> Any:
    """A shape at a pose."""
    from OCP.gp import gp_Trsf
    from OCP.TopLoc import TopLoc_Location

    move = gp_Trsf()
    move.SetValues(*(float(x) for x in pose[:3].ravel()))
    return shape.Located(TopLoc_Location(move))


def compared(
    a: Known, b: Known, solids: tuple[Any, Any], poses: tuple[Array, Array], ask: Any
) -> Comparison:
    """The poses that are apart."""
    from OCP.BRepExtrema import BRepExtrema_DistShapeShape

    shapes = shape_of(a.part.truth), shape_of(b.part.truth)
    found = Comparison()
    for pose_a, pose_b, true, inside, _ in truths(a, b, *poses):
        if inside or not true.upper > AGREED:
            continue
        first, second = placed(shapes[0], pose_a), placed(shapes[1], pose_b)
        begun = time.perf_counter()
        told = ask(*solids, pose_a, pose_b).distance
        between = time.perf_counter()
        distance = BRepExtrema_DistShapeShape(first, second).Value()
        ended = time.perf_counter()
        off = [not abs(d - float(true.upper)) <= AGREED for d in (told, distance)]
        found = found.plus(Comparison(1, off[0], off[1], between - begun, ended - between))
    return found
