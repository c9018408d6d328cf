"""Geometry: surfaces, curves and their trimming curves, validated and immutable."""

from standoff.geometry.curves import ConicArc, Curve, Line, RationalBezier
from standoff.geometry.formulas import FormulaCurve, FormulaError, FormulaSurface
from standoff.geometry.pcurves import NurbsPcurve, Pcurve, SurfaceCurve, pcurve_of
from standoff.geometry.surfaces import Cone, Cylinder, Plane, Sphere, Surface

__all__ = [
    "Cone",
    "ConicArc",
    "Curve",
    "Cylinder",
    "FormulaCurve",
    "FormulaError",
    "FormulaSurface",
    "Line",
    "NurbsPcurve",
    "Pcurve",
    "Plane",
    "RationalBezier",
    "Sphere",
    "Surface",
    "SurfaceCurve",
    "pcurve_of",
]
