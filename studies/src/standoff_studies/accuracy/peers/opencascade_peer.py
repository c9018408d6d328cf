"""OpenCASCADE: ``BRepExtrema_DistShapeShape`` on boundary representations, for NURBS pairs."""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff.geometry.ellipsoid_patches import ellipsoid_patches
from standoff.geometry.nurbs import BezierPatch
from standoff_studies.accuracy.peers.answer import (
    NOTHING,
    Peer,
    PeerAnswer,
    Pose,
    Query,
    by_points,
    once_a_solid,
    require,
)
from standoff_studies.accuracy.solids import Solid

NURBS = "NURBS ellipsoid"
SEWING = 1e-6
"""Tolerance (length) at which the patches are joined to a shell; they meet to roundoff."""
DEGENERATE = 1e-9
"""Length below which an edge of a patch would count as collapsed; none does."""


@once_a_solid
def cascade_shape(solid: Solid) -> Any:
    """Return OpenCASCADE's shape; None where there is none here."""
    primitives = require("OCP.BRepPrimAPI")
    gp = require("OCP.gp")
    lengths = solid.lengths

    def axes(height: float) -> Any:
        return gp.gp_Ax2(gp.gp_Pnt(0.0, 0.0, -height / 2), gp.gp_Dir(0.0, 0.0, 1.0))

    match solid.kind.name:
        case "NURBS ellipsoid":
            return _shell(ellipsoid_patches(*lengths))
        case "sphere":
            return primitives.BRepPrimAPI_MakeSphere(*lengths).Solid()
        case "cylinder":
            return primitives.BRepPrimAPI_MakeCylinder(axes(lengths[1]), *lengths).Solid()
        case "cone":
            radius, height = lengths
            return primitives.BRepPrimAPI_MakeCone(axes(height), radius, 0.0, height).Solid()
        case "box":
            corner = gp.gp_Pnt(*(-length / 2 for length in lengths))
            return primitives.BRepPrimAPI_MakeBox(corner, *lengths).Solid()
    return None


def _shell(patches: tuple[BezierPatch, ...]) -> Any:
    builder = require("OCP.BRepBuilderAPI")
    sewing = builder.BRepBuilderAPI_Sewing(SEWING)
    for patch in patches:
        surface = bezier_surface(patch)
        sewing.Add(builder.BRepBuilderAPI_MakeFace(surface, DEGENERATE).Face())
    sewing.Perform()
    return sewing.SewedShape()


def bezier_surface(patch: BezierPatch) -> Any:
    """Return a patch as OpenCASCADE's surface."""
    bezier = require("OCP.Geom").Geom_BezierSurface
    arrays, point = require("OCP.collections"), require("OCP.gp").gp_Pnt
    n, m = patch.weights.shape
    poles, weights = arrays.Array2_gp_Pnt(1, n, 1, m), arrays.Array2_double(1, n, 1, m)
    for i, j in np.ndindex(n, m):
        poles.SetValue(i + 1, j + 1, point(*map(float, patch.control_points[i, j])))
        weights.SetValue(i + 1, j + 1, float(patch.weights[i, j]))
    return bezier(poles, weights)


def transform_of(pose: Pose) -> Any:
    """Return OpenCASCADE's transform of a pose (R, p)."""
    transform = require("OCP.gp").gp_Trsf()
    rotation, position = pose
    transform.SetValues(*map(float, np.column_stack([rotation, position]).ravel()))
    return transform


def placed(shape: Any, pose: Pose) -> Any:
    """Return the shape at a pose (R, p)."""
    return shape.Moved(require("OCP.TopLoc").TopLoc_Location(transform_of(pose)))


class OpenCascade(Peer):
    """BRepExtrema at its defaults, for pairs with a NURBS body; gaps only."""

    name = "OpenCASCADE"
    package = "cadquery-ocp-novtk"
    overlaps = False

    def query(self, a: Solid, b: Solid) -> Query | None:
        """It reports no normal: that is the direction between its points."""
        extrema = require("OCP.BRepExtrema").BRepExtrema_DistShapeShape
        if NURBS not in (a.kind.name, b.kind.name):
            return None
        shape_a, shape_b = cascade_shape(a), cascade_shape(b)
        if shape_a is None or shape_b is None:
            return None

        def query(pose_a: Pose, pose_b: Pose) -> PeerAnswer:
            found = extrema(placed(shape_a, pose_a), placed(shape_b, pose_b))
            if not found.IsDone() or found.NbSolution() == 0:
                return NOTHING
            points = [np.array(p.Coord()) for p in (found.PointOnShape1(1), found.PointOnShape2(1))]
            return by_points(float(found.Value()), *points)

        return query
