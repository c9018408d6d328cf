"""Faces that close on themselves where the library's charts do not: they are cut in two.

On a cylinder or cone, and about the axis of a torus or a surface of revolution, u is an angle and
needs no seam. Round the tube of a torus, and on splines that close, OpenCASCADE's divider cuts the
face at the seam and opposite; area and volume are compared afterwards.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff.cad.opencascade import cast, coordinates, explored
from standoff.geometry.curves import FULL_TURN

ANGULAR_U = ("CylindricalSurface", "ConicalSurface", "SphericalSurface")


def without_seams(solid: Any) -> tuple[Any, int]:
    """The solid with such faces cut, and how many they were."""
    closed = [face for face in explored(solid, "face") if _must_be_cut(face)]
    if not closed:
        return solid, 0
    from OCP.ShapeBuild import ShapeBuild_ReShape
    from OCP.ShapeUpgrade import ShapeUpgrade_ClosedFaceDivide

    context = ShapeBuild_ReShape()
    for face in closed:
        divider = ShapeUpgrade_ClosedFaceDivide(face)
        divider.SetContext(context)
        divider.SetSurfaceSegmentMode(False)
        divider.Perform()
        result = divider.Result()
        if not result.IsSame(face):
            context.Replace(face, result)
    return cast("solid", context.Apply(solid)), len(closed)


def _must_be_cut(face: Any) -> bool:
    from OCP.BRep import BRep_Tool

    geometry = BRep_Tool.Surface_s(face)
    while geometry.DynamicType().Name() == "Geom_RectangularTrimmedSurface":
        geometry = geometry.BasisSurface()
    kind = geometry.DynamicType().Name().removeprefix("Geom_")
    if kind in ANGULAR_U:
        return False
    for edge in explored(face, "edge"):
        if BRep_Tool.Degenerated_s(edge) or not BRep_Tool.IsClosed_s(edge, face):
            continue
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
    return round_ and abs(u1 - u0 - FULL_TURN) < 1e-9 * FULL_TURN
