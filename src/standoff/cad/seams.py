"""Faces that close on themselves where the library's charts do not: they are cut in two.

On a cylinder or cone, and about the axis of a torus or a surface of revolution, u is an angle and
needs no seam. Round the tube of a torus, and on splines that close, OpenCASCADE's divider cuts the
face at the seam and opposite; area and volume are compared afterwards.
"""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np

from standoff.cad.opencascade import cast, coordinates, explored, forward
from standoff.cad.surfaces import basis_surface
from standoff.cad.tolerances import WHOLE_PROFILE
from standoff.geometry.curves import FULL_TURN

ANGULAR_U = ("CylindricalSurface", "ConicalSurface", "SphericalSurface")


def without_seams(solid: Any) -> tuple[Any, int, list[int]]:
    """The solid with such faces cut, how many they were, and of which of its faces, counted from 1,
    those of the result are parts."""
    faces = list(explored(solid, "face"))
    closed = [face for face in faces if _must_be_cut(face)]
    if not closed:
        return solid, 0, list(range(1, len(faces) + 1))
    from OCP.ShapeBuild import ShapeBuild_ReShape
    from OCP.ShapeUpgrade import ShapeUpgrade_ClosedFaceDivide

    context = ShapeBuild_ReShape()
    for face in closed:
        divider = ShapeUpgrade_ClosedFaceDivide(face)
        divider.SetContext(context)
        # with surfaces as they are it fails on swept splines that close, and ends the process
        divider.SetSurfaceSegmentMode(_kind(face).startswith("SurfaceOf"))
        divider.Perform()
        result = divider.Result()
        if not result.IsSame(face):
            context.Replace(face, result)
    numbers = [n for n, face in enumerate(faces, 1) for _ in explored(context.Apply(face), "face")]
    return _mended(solid, context.Apply(solid)), len(closed), numbers


def without_corners(solid: Any) -> tuple[Any, list[int]] | None:
    """The solid with edges and faces divided by OpenCASCADE where their curves and surfaces are not
    C1, and of which of its faces, counted from 1, those of the result are parts; None where nothing
    is divided, or what comes of it is no solid."""
    from OCP.GeomAbs import GeomAbs_C1
    from OCP.ShapeUpgrade import ShapeUpgrade_ShapeDivideContinuity

    divider = ShapeUpgrade_ShapeDivideContinuity(solid)
    divider.SetBoundaryCriterion(GeomAbs_C1)
    divider.SetPCurveCriterion(GeomAbs_C1)
    divider.SetSurfaceCriterion(GeomAbs_C1)
    divider.Perform()
    result = divider.Result()
    if result.ShapeType() != solid.ShapeType() or result.IsSame(solid):
        return None
    context = divider.GetContext()
    faces = enumerate(explored(solid, "face"), 1)
    numbers = [n for n, face in faces for _ in explored(context.Apply(face), "face")]
    return cast("solid", result), numbers


def _mended(solid: Any, divided: Any) -> Any:
    """The divided solid as one that OpenCASCADE's check finds to be right, if that found the whole
    one so: next to a tube that ends at its seam the divider leaves an edge's trimming curve on the
    far side of the neighbour's period."""
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.ShapeFix import ShapeFix_Shape

    if BRepCheck_Analyzer(divided).IsValid() or not BRepCheck_Analyzer(solid).IsValid():
        return cast("solid", divided)
    fix = ShapeFix_Shape(divided)
    fix.Perform()
    same = len(list(explored(fix.Shape(), "face"))) == len(list(explored(divided, "face")))
    return cast("solid", fix.Shape() if same else divided)


def once(face: Any) -> list[Any]:
    """The edges that a face has once, collapsed ones included, in the order of its wires."""
    edges = _bounding(face)
    double = {hash(edge) for edge in seams(face)}
    return [edge for edge in edges if hash(edge) not in double]


def seams(face: Any) -> list[Any]:
    """The edges that a face has twice, one of each pair. An edge of two faces that share their
    surface has two trimming curves on it as well, and is none."""
    from OCP.BRep import BRep_Tool

    edges = [edge for edge in _bounding(face) if not BRep_Tool.Degenerated_s(edge)]
    times = Counter(hash(edge) for edge in edges)
    return [edge for edge in edges if times[hash(edge)] == 2 and forward(edge)]


def _bounding(face: Any) -> list[Any]:
    """The edges of a face's wires, without those that lie inside it."""
    from OCP.TopAbs import TopAbs_EXTERNAL, TopAbs_INTERNAL

    inner = (TopAbs_INTERNAL, TopAbs_EXTERNAL)
    wires = explored(face, "wire")
    return [e for wire in wires for e in explored(wire, "edge") if e.Orientation() not in inner]


def _kind(face: Any) -> str:
    from OCP.BRep import BRep_Tool

    name: str = basis_surface(BRep_Tool.Surface_s(face)).DynamicType().Name()
    return name.removeprefix("Geom_")


def _must_be_cut(face: Any) -> bool:
    from OCP.BRep import BRep_Tool

    geometry, kind = basis_surface(BRep_Tool.Surface_s(face)), _kind(face)
    if kind in ANGULAR_U:
        return False
    for edge in seams(face):
        flat = BRep_Tool.CurveOnSurface_s(edge, face, 0.0, 0.0)
        first, last = BRep_Tool.Range_s(edge, face)
        ends = np.array([coordinates(flat.Value(t)) for t in (first, last)])
        along_v = abs(ends[1, 1] - ends[0, 1]) >= abs(ends[1, 0] - ends[0, 0])
        if not (along_v and _angular(geometry, kind)):
            return True
    return False


def _angular(geometry: Any, kind: str) -> bool:
    """Is its u an angle that needs no seam?"""
    if kind in ("ToroidalSurface", "SurfaceOfRevolution"):
        return True
    if kind != "SurfaceOfLinearExtrusion":
        return False
    profile = geometry.BasisCurve()
    while profile.DynamicType().Name() == "Geom_TrimmedCurve":
        profile = profile.BasisCurve()
    round_ = profile.DynamicType().Name() in ("Geom_Circle", "Geom_Ellipse")
    u0, u1, _, _ = geometry.Bounds()
    return round_ and abs(u1 - u0 - FULL_TURN) < WHOLE_PROFILE * FULL_TURN
