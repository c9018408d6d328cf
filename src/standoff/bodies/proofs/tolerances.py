"""Tolerances of the proofs of convexity, each with its unit and reason."""

from __future__ import annotations

from typing import Final

CURVATURE_ROUNDING: Final = 1e-14
"""Curvature found below minus this, 1 / size, is not rounding: the patch is not convex."""

PROVEN_DEFECT: Final = 1e-12
"""Greatest defect of a convex patch, as a fraction of its size or, if that is more, of its distance
from the origin: rounding of control points bends a patch of degree 9 by some 1e-13."""

NEARLY_FLAT: Final = 1e-9
"""A patch whose curvature is below this everywhere, 1 / size, may be flat, which is then tried."""

STRAIGHT_TURN: Final = 1e-10
"""Greatest angle (radians) between the normals of a patch and of the plane or ruled surface that it
is up to rounding, times its distance from the origin in sizes if that is above 1: a few roundings
over a narrow span."""

HEIGHT_ROUNDING: Final = 1e-14
"""Heights of coefficients above minus this, relative to the longest, count as zero: singular
corners."""

BEND_ROUNDOFF: Final = 1e-12
"""Curvature times the patch's diameter within this of zero (dimensionless) is roundoff of the
formula's own coefficients, not a bend: such a patch is convex, with its bound as defect."""

FEW_OPERATIONS: Final = 1e-14
"""Relative roundoff of the last few operations of a bound, by which it is widened: a few dozen
roundings, far more than there are."""

QUOTIENT_ROUNDOFF: Final = 1e-15
"""Relative roundoff of one quotient of bounds, by which it is widened: four roundings."""

TIGHT_JACOBIAN: Final = 0.25
"""The bound of a box is tight if J varies over it by at most this fraction of itself."""

FLAT_TURN: Final = 1e-13
"""A patch whose normals turn by less than this over a box (radians) is flat there."""

NORMAL_ROUNDING: Final = 1e-15
"""Normals of coefficients (of T) shorter than this fraction of the longest are rounding."""

ORTHONORMAL_FRAME: Final = 1e-6
"""The metric in a box's own frame differs from the identity by less than this (dimensionless),
unless the place is singular and its tangents have lost their digits."""

FLAT_PROFILE: Final = 1e-9
"""A mean curvature below this fraction of the second derivatives, by arc length, is roundoff: the
profile is flat."""

WHOLE_ARCS: Final = 1e-15
"""A range may exceed a whole number of arcs by this fraction of it and still be cut into that many:
roundoff of its ends."""

LEAST_COSINE: Final = 1e-9
"""Normals whose cosine to the axis is smaller do not count as inside the hemisphere. Two poles at
float64's pi / 2 and -pi / 2 fit in one by 6e-17, which is useless."""

DOMAIN_ROUNDINGS: Final = 2
"""A side of the domain within this many roundings (units in its last place) of a multiple of pi /
12 is taken as exactly that."""

NEARLY_COLLAPSED: Final = 1e-9
"""Sides longer than this fraction of their distance to the patch's middle are not collapsed and not
examined further."""

ZERO_BOUND: Final = 1e-290
"""A bound as near to zero as this (in any unit) comes from rounding an exact zero outward."""

SMALLEST_SIGN_BOX: Final = 2.0**-20
"""Least fraction of the domain's side of a box evaluated for one sign: a sign still undecided there
is zero, or practically zero, somewhere."""

COLLAPSED_SIDE: Final = 1e-9
"""Points of a side closer together than this fraction of the patch's size are one point (a pole):
as close as curves and vertices of a body must meet. The distance moved counts as a dent."""

SMOOTH_POLE: Final = 4.0
"""A pole is smooth, not a sharp apex, if it is so up to this many times the rounding (length) of
the control points: rounding alone moves the ring around a pole out of its plane."""

ROUNDED_POINTS: Final = 1e-14
"""Control points off a plane or line by less than this fraction of the size, or of the distance
from the origin if that is more, are off by rounding: elevation, knots and maps leave some 1e-15."""
