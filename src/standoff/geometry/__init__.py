"""Geometry: surfaces, curves and their trimming curves, validated and immutable."""

from typing import TYPE_CHECKING

from standoff.on_demand import on_demand

if TYPE_CHECKING:
    from standoff.geometry.curves import ConicArc, Curve, Line, RationalBezier
    from standoff.geometry.ellipsoid_patches import ellipsoid_octants, ellipsoid_patches
    from standoff.geometry.exact_pcurves import pcurve_of
    from standoff.geometry.formulas import FormulaCurve, FormulaError, FormulaSurface
    from standoff.geometry.nurbs import BezierPatch, NurbsSurface
    from standoff.geometry.nurbs_curves import NurbsCurve
    from standoff.geometry.nurbs_pcurves import NurbsPcurve
    from standoff.geometry.patch_bounds import PatchBounds
    from standoff.geometry.pcurves import Pcurve
    from standoff.geometry.quadrics import Cone, Cylinder, Plane, Sphere
    from standoff.geometry.superellipsoids import SuperellipsoidPole, SuperellipsoidSide
    from standoff.geometry.surface_curves import SurfaceCurve
    from standoff.geometry.surfaces import Surface
    from standoff.geometry.swept import Extrusion, Revolution
    from standoff.geometry.torus import Torus
else:
    __getattr__, __dir__ = on_demand(__name__)

__all__ = [
    "BezierPatch",
    "Cone",
    "ConicArc",
    "Curve",
    "Cylinder",
    "Extrusion",
    "FormulaCurve",
    "FormulaError",
    "FormulaSurface",
    "Line",
    "NurbsCurve",
    "NurbsPcurve",
    "NurbsSurface",
    "PatchBounds",
    "Pcurve",
    "Plane",
    "RationalBezier",
    "Revolution",
    "Sphere",
    "SuperellipsoidPole",
    "SuperellipsoidSide",
    "Surface",
    "SurfaceCurve",
    "Torus",
    "ellipsoid_octants",
    "ellipsoid_patches",
    "pcurve_of",
]
