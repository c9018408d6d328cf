"""Tolerances of the proofs of convexity, each with its unit and reason."""

from __future__ import annotations

from typing import Final

CURVATURE_ROUNDING: Final = 1e-14
"""Curvature found below minus this, 1 / size, is no rounding: the patch is not convex."""

PROVEN_DEFECT: Final = 1e-12
"""A convex patch has no greater defect, as a part of its size or, if that is more, of its distance
from the origin: rounding of control points bends a patch of degree 9 by some 1e-13."""

NEARLY_FLAT: Final = 1e-9
"""Curvature below this, 1 / size, everywhere: the patch may be flat, which is then tried."""

STRAIGHT_TURN: Final = 1e-10
"""Radians between normals of a patch and of the plane or straight lines it is but for rounding, if
it lies more than its size from the origin times that: a few roundings over a narrow span."""

HEIGHT_ROUNDING: Final = 1e-14
"""Heights of coefficients above this, relative to the longest, count as zero: singular corners."""

BEND_ROUNDOFF: Final = 1e-12
"""Curvature times the patch's diameter within this of zero (dimensionless) is roundoff of the
formula's own coefficients, not a bend: such a patch is convex, with its bound as defect."""

FEW_OPERATIONS: Final = 1e-14
"""Relative roundoff of the last few operations of a bound, by which it is widened: some dozen
roundings, far more than there are."""

QUOTIENT_ROUNDOFF: Final = 1e-15
"""Relative roundoff of one quotient of bounds, by which it is widened: four roundings."""

TIGHT_JACOBIAN: Final = 0.25
"""J strays by no more than this part of itself over a box whose bound is tight."""

FLAT_TURN: Final = 1e-13
"""Radians: a patch whose normals turn by less over a box is flat there."""

NORMAL_ROUNDING: Final = 1e-15
"""Normals of coefficients (of T) shorter than this part of the longest are rounding."""

ORTHONORMAL_FRAME: Final = 1e-6
"""The metric in a box's own frame misses the identity by less than this (dimensionless), or the
frame is of a singular place, whose tangents have lost their digits."""

FLAT_PROFILE: Final = 1e-9
"""A mean curvature below this part of the second derivatives, by arc length, is roundoff: flat."""

WHOLE_ARCS: Final = 1e-15
"""A range may pass a whole number of arcs by this part of it and still be cut into that many:
roundoff of its ends."""

LEAST_COSINE: Final = 1e-9
"""Cosine to the axis: normals nearer to 90 degrees from it do not count as inside the hemisphere.
Two poles at float64's pi / 2 and -pi / 2 fit one by 6e-17, which serves nothing."""

DOMAIN_ROUNDINGS: Final = 2
"""A side of the domain within this many roundings (units in its last place) of a multiple of pi /
12 stands for it."""

NEARLY_COLLAPSED: Final = 1e-9
"""Sides longer than this part of their distance to the patch's middle are not looked at further."""

ZERO_BOUND: Final = 1e-290
"""A bound as near to zero as this (in whatever unit) comes from rounding an exact zero outward."""

SMALLEST_SIGN_BOX: Final = 2.0**-20
"""Least part of the domain's side of a box evaluated for one sign: beyond, a sign that is still
open is zero, or as good as zero, somewhere."""

COLLAPSED_SIDE: Final = 1e-9
"""Points of a side closer together than this part of the patch's size are one point (a pole): as
close as curves and vertices of a body must meet. What is moved counts as a dent."""

SMOOTH_POLE: Final = 4.0
"""A pole is smooth, not a sharp apex, where it is so but for this many times the rounding (length)
of the control points: rounding alone leaves the ring round a pole out of plane."""

ROUNDED_POINTS: Final = 1e-14
"""Control points off a plane or line by less than this part of the size, or if that is more of the
distance from the origin, are rounded: elevation, knots and maps leave some 1e-15."""
