"""Tolerances of curves and surfaces, each with its unit and reason."""

from __future__ import annotations

from typing import Final

import numpy as np

SMOOTH_JOINT: Final = 1e-12
"""Ends closer than this fraction of the curve's extent, with tangents parallel to this sine, are a
smooth joint: roundoff of control points computed by trigonometry."""

SPARE_KNOT: Final = 1e-14
"""A knot is redundant if the surface without it moves by at most this fraction of its size, or of
its distance from the origin if that is more: repeated insertions round each control point by a few
1e-16."""

SAME_WEIGHTS: Final = 1e-14
"""Weights that differ by less than this fraction of them are equal up to rounding: the spline is
then kept polynomial."""

LIBRARY_ERROR: Final = 8 * float(np.finfo(np.float64).eps)
"""Relative error of an elementary function: twice the 4 units in the last place that NumPy
promises."""

CREST_ROUNDOFF: Final = 1e-15
"""A crest or a pole of a periodic function this near to an interval's end (radians, relative to 1 +
the angle) counts as inside: the roundoff of its place."""

NARROWED: Final = 1e-2
"""The intersection of two sets is computed with both widened by a tolerance, and by this fraction
of it. A real common extent stays; that of a tangency or a corner shrinks with the tolerance, at
least like its square root."""

KEPT_EXTENT: Final = 0.5
"""Fraction of an extent that must remain when the widening is NARROWED for it to be real: between
1, for a real common extent, and 0.1, for a tangency."""

WIDENINGS: Final = (0.0, 1e-5, 1e-4, 1e-3)
"""Widenings, each a fraction of the tolerance, of which the least that shows the whole intersection
is used: touching sides are separated by roundoff."""

ROUND_SECTION: Final = 1e-12
"""A conic arc on a cylinder or cone is a section perpendicular to the axis if its tilt, its
ellipticity and its centre's offset are below this (relative to its radius, the tilt to its height):
the roundoff of inverting the surface's map."""

WHOLE_TURN: Final = 1e-14
"""A pcurve closes around a periodic surface if its turn is 2 pi to within this fraction: a few
dozen roundings of u."""

PARALLEL_AXES: Final = 1e-14
"""Axes of a conic arc whose sine is below this are parallel: their plane has no correct digits."""

WHOLE_CONIC: Final = 1e-15
"""A conic arc may exceed a whole turn, or fall short of one, by this fraction of it: the roundoff
of computing its ends."""

DEPENDENT_COLUMNS: Final = 1e-30
"""Columns of unit length whose volume (dimensionless) is below this count as dependent."""

SMALLEST_BOX: Final = 2.0**-26
"""A box this small (fraction of the domain's side) in which a formula still has no bound contains a
pole, or a point where the compiled jet loses all its digits, such as sin(u)/u at 0."""

CLOSED_CURVE: Final = 1e-12
"""A curve whose ends are nearer than this fraction of its size is closed if its tangents agree
too."""

VANISHING_NORMAL: Final = 1e-8
"""If |x_u x x_v| is below this fraction of its greatest value over the patch, there is no normal:
its direction has lost half of its digits."""

PROFILE_ROUNDOFF: Final = 1e-12
"""A profile may leave the x-z plane, or cross the axis, by this fraction of its size: roundoff."""

ALONG_PROFILE: Final = 1e-9
"""Sine of the angle between a profile and the direction of extrusion below which the surface has no
normal."""

TIGHT_BOX: Final = 1e-4
"""A box is tight enough if no side could be moved inward by more than this fraction of its
diagonal."""

BOX_MARGIN: Final = 8.0 * float(np.finfo(np.float64).eps)
"""Computed points of a box are rounded by this (relative to the greatest number): a few eps."""

STRAIGHT_PCURVE: Final = 1e-11
"""Curvature below this fraction of the greatest (dimensionless) is the roundoff of a straight
piece."""

INFLECTION_ROUNDOFF: Final = 64.0 * float(np.finfo(np.float64).eps)
"""Derivatives of a trimming curve are rounded by this fraction of what control points of its size
allow: sums of ten products, and the conversion from a spline's spans."""

INFLECTION: Final = 1e-15
"""A pcurve is cut where its curvature changes sign, computed to this (parameter units): roundoff in
[0, 1]."""

ANGLE_ROUNDOFF: Final = 1e-15
"""Angles may exceed a whole turn, or the ends of the convex part, by this (radians): the roundoff
of computing them."""

CONE_ROUNDING: Final = 16.0 * float(np.finfo(np.float64).eps)
"""Radians by which a cone of normals is widened: the roundoff of angles between unit vectors, and
of an axis whose length is 1 up to a few eps."""

VANISHED: Final = 1e-290
"""A vector as near to zero as this (in any unit of length) comes from rounding an exact zero
outward, for instance of a side that is a single point."""

NET_ROUNDING: Final = 64.0 * float(np.finfo(np.float64).eps)
"""Control points of a part of a Bezier patch are rounded by this (relative to the greatest number
of their net): in each of two directions nine levels of basis functions, two roundings each, their
sums of at most ten products, and the sum of a matrix product."""

POLYNOMIAL_WEIGHTS: Final = 8.0 * float(np.finfo(np.float64).eps)
"""Weights of a polynomial spline are one number up to this fraction, where inserted knots have
rounded them."""

SPAN_ROUNDING: Final = 4.0 * float(np.finfo(np.float64).eps)
"""Ends of a part of a span are moved outward by this (a fraction of the span): they are rounded
when they are mapped to [0, 1]."""

ROUND_POLE: Final = 1e-12
"""A profile meets its axis at a right angle, so that its surface is smooth there, if it is inclined
by no more than this (a ratio of its derivatives): the roundoff of its control points, or of an
angle."""

LENGTH_ROUNDING: Final = 16.0 * float(np.finfo(np.float64).eps)
"""Singular values and lengths of mapped vectors are rounded by this (relative to the map's greatest
singular value): a few eps each."""
