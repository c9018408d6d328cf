"""Geometry: surfaces, curves and their trimming curves, validated and immutable."""

from standoff.geometry.curves import ConicArc, Curve, Line, RationalBezier
from standoff.geometry.ellipsoid_patches import ellipsoid_octants, ellipsoid_patches
from standoff.geometry.formulas import FormulaCurve, FormulaError, FormulaSurface
from standoff.geometry.nurbs import BezierPatch, NurbsSurface
from standoff.geometry.nurbs_curves import NurbsCurve
from standoff.geometry.nurbs_pcurves import NurbsPcurve
from standoff.geometry.pcurves import Pcurve, pcurve_of
from standoff.geometry.superellipsoids import SuperellipsoidPole, SuperellipsoidSide
from standoff.geometry.surface_curves import SurfaceCurve
from standoff.geometry.surfaces import Cone, Cylinder, Plane, Sphere, Surface
from standoff.geometry.swept import Extrusion, Revolution
from standoff.geometry.torus import Torus

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
