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
    __getattr__, __dir__ = on_demand(
        __name__,
        {
            "standoff.geometry.curves": ("ConicArc", "Curve", "Line", "RationalBezier"),
            "standoff.geometry.ellipsoid_patches": ("ellipsoid_octants", "ellipsoid_patches"),
            "standoff.geometry.exact_pcurves": ("pcurve_of",),
            "standoff.geometry.formulas": ("FormulaCurve", "FormulaError", "FormulaSurface"),
            "standoff.geometry.nurbs": ("BezierPatch", "NurbsSurface"),
            "standoff.geometry.nurbs_curves": ("NurbsCurve",),
            "standoff.geometry.nurbs_pcurves": ("NurbsPcurve",),
            "standoff.geometry.patch_bounds": ("PatchBounds",),
            "standoff.geometry.pcurves": ("Pcurve",),
            "standoff.geometry.superellipsoids": ("SuperellipsoidPole", "SuperellipsoidSide"),
            "standoff.geometry.surface_curves": ("SurfaceCurve",),
            "standoff.geometry.quadrics": ("Cone", "Cylinder", "Plane", "Sphere"),
            "standoff.geometry.surfaces": ("Surface",),
            "standoff.geometry.swept": ("Extrusion", "Revolution"),
            "standoff.geometry.torus": ("Torus",),
        },
    )

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
