"""Tolerances of curves and surfaces, each with its unit and reason."""

from __future__ import annotations

from typing import Final

import numpy as np

SMOOTH_JOINT: Final = 1e-12
"""Ends closer than this part of the curve's extent, with tangents parallel to this sine, are one
smooth joint: roundoff of control points computed by trigonometry."""

SPARE_KNOT: Final = 1e-14
"""A knot is spare if the surface without it moves by no more than this part of its size, or if that
is more, of its distance from the origin: insertions, one after the other, round each control point
by a few 1e-16."""

SAME_WEIGHTS: Final = 1e-14
"""Weights that differ by less than this part of them are equal but for such rounding: the spline is
then kept polynomial."""

LIBRARY_ERROR: Final = 8 * float(np.finfo(np.float64).eps)
"""Relative error of an elementary function. NumPy promises 4 units in the last place at most; twice
that."""

CREST_ROUNDOFF: Final = 1e-15
"""A crest or a pole of a wave this near to an interval's end (radians, relative to 1 + the angle)
counts as inside: roundoff of its place."""

NARROWED: Final = 1e-2
"""What two sets share is sought with both widened by a tolerance, and by this part of it. An extent
that they truly share stays; that of a tangency or of a corner goes with the tolerance, at least
like its square root."""

KEPT_EXTENT: Final = 0.5
"""Part of an extent that must stay when the widening is NARROWED, for it to be one: between 1, of
what is truly shared, and 0.1, of a tangency."""

WIDENINGS: Final = (0.0, 1e-5, 1e-4, 1e-3)
"""The least widening, in parts of the tolerance, that shows all they share is taken: touching sides
are cut apart by roundoff."""

ROUND_SECTION: Final = 1e-12
"""A conic arc on a cylinder or cone is a section square to the axis when its tilt, its ellipticity
and its centre's offset are below this (relative to its radius, the tilt to its height): roundoff of
inverting the surface's map."""

WHOLE_TURN: Final = 1e-14
"""A pcurve closes round a periodic surface when its turn is 2 pi to this part: some dozen roundings
of u."""

PARALLEL_AXES: Final = 1e-14
"""Axes of a conic arc whose sine is below this are parallel: no plane has digits then."""

WHOLE_CONIC: Final = 1e-15
"""A conic arc may pass a whole turn, or fall short of one, by this part of it: roundoff of
computing its ends."""

DEPENDENT_COLUMNS: Final = 1e-30
"""Columns of a unit length whose volume (dimensionless) is below this are taken as dependent."""

SMALLEST_BOX: Final = 2.0**-26
"""A box this small (part of the domain's side) in which a formula still has no bound holds a pole,
or a point where the compiled jet loses all its digits, such as sin(u)/u at 0."""

CLOSED_CURVE: Final = 1e-12
"""A curve whose ends are nearer than this part of its size is closed if its tangents agree too."""

VANISHING_NORMAL: Final = 1e-8
"""|x_u x x_v| below this part of its greatest value over the patch is taken for no normal: its
direction has lost half of its digits."""

PROFILE_ROUNDOFF: Final = 1e-12
"""A profile may leave the x-z plane, or pass the axis, by this part of its size: roundoff."""

ALONG_PROFILE: Final = 1e-9
"""Sine of the angle between a profile and the direction it is moved along, below which the surface
has no normal."""

TIGHT_BOX: Final = 1e-4
"""A box is known well when no side may be moved inward by more than this part of its diagonal."""

BOX_MARGIN: Final = 8.0 * float(np.finfo(np.float64).eps)
"""Points of a box computed so are rounded by this (relative to the greatest number): some eps."""

STRAIGHT_PCURVE: Final = 1e-11
"""Curvature below this part of the greatest (dimensionless) is roundoff of a straight piece."""

INFLECTION: Final = 1e-15
"""A pcurve is cut where its bend changes sign, found to this (parameter units): roundoff at [0,
1]."""

ANGLE_ROUNDOFF: Final = 1e-15
"""Angles may pass a whole turn, or the ends of the convex part, by this (radians): roundoff of
computing them."""

CONE_ROUNDING: Final = 16.0 * float(np.finfo(np.float64).eps)
"""Radians by which a cone of normals is opened: the roundoff of angles between unit vectors, and of
an axis that is one but for some eps."""

VANISHED: Final = 1e-290
"""A vector as near to nothing as this (in whatever unit of length) comes from rounding an exact
zero outward, as of a side that is one point."""

NET_ROUNDING: Final = 64.0 * float(np.finfo(np.float64).eps)
"""Control points of a part of a Bezier patch are rounded by this (relative to the greatest number
of their net): twice nine levels of blossoms, two roundings each, and the sums of two matrix
products."""

SPAN_ROUNDING: Final = 4.0 * float(np.finfo(np.float64).eps)
"""Ends of a part of a span are moved outward by this (a fraction of the span): they are rounded
when they are brought to [0, 1]."""

ROUND_POLE: Final = 1e-12
"""A profile meets its axis squarely, so that its surface is smooth there, when it is inclined by no
more than this (a ratio of its derivatives): roundoff of its control points, or of an angle."""

LENGTH_ROUNDING: Final = 16.0 * float(np.finfo(np.float64).eps)
"""Singular values and lengths of mapped vectors are rounded by this (relative to the map's greatest
singular value): some eps each."""
