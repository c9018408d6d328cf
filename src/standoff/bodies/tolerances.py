"""Tolerances of building bodies, each with its unit and reason; those of proofs stand beside them.

The Voronoi regions have their own, in ``voronoi/tolerances.py``.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from standoff.geometry.validation import Array
from standoff.kernels.tolerances import EPS

COORDINATE_ROUNDINGS: Final = 16.0
"""Roundings (eps) of the greatest coordinate by which parts may always miss each other: points of
a curve and of a surface carry three or four each. The certificate takes as many off every bound."""

FAR_OFF: Final = 1e3
"""Greatest coordinate over extent above which a hull is taken about the vertices' middle [no unit]:
below it the facets' normals lose no more than three digits, within COPLANAR_FACETS."""

JOIN_TOLERANCE: Final = 1e-9
"""Endpoints of curves and their vertices must agree to this fraction of the body's size."""

WIDE_ANGLE: Final = 1e-6
"""A face's angle at a vertex of 180 degrees less this (radians) counts as wide."""

SINGULAR_CORNER: Final = 1e-12
"""Tangents at a corner whose sine is below this are one direction: the chart is singular there."""

CHART_RIM: Final = 1e-3
"""A chart sees a point whose depth (cosine from its centre) is above this."""

COLLAPSED_TANGENT: Final = 1e-11
"""A tangent shorter than this part of the other has collapsed: its direction is roundoff."""

INWARD_STEP: Final = 1e-3
"""How far towards the middle of the domain (part of the way) the sign of a collapsed side's normal
is taken: off the side's roundoff, and before anything turns."""

VOLUME_END: Final = 1e-6
"""Relative, where refinement of a volume ends that is reported with what it may be off."""

BOX_REACH: Final = 1e-3
"""A boundary's box may reach past its points by this part of its size."""

SAME_CROSSING: Final = 1e-12
"""A point whose ray meets a face this near, as a part of the size and the greatest coordinate, is
on it; crossings as near to each other are one: some thousand roundings."""

CROSSING_STEP: Final = 1e-14
"""A step of the search for a crossing below this part of its rectangle's sides is the last."""

LEAF_MARGIN: Final = 1e-9
"""A crossing may pass its rectangle by this part of the sides: it is then found in two."""

SIGN_OF_VOLUME: Final = 1e-2
"""Relative, where refinement of a volume ends whose sign alone is asked."""

VOLUME_ROUNDINGS: Final = 64.0
"""Roundings (eps of the sum of the parts' magnitudes) that a volume enclosed may be off by."""

ROUNDOFF: Final = 1e-14
"""A residual or defect below this part of the size is the roundoff of evaluating the same point
twice: the certificate's own allowance covers it."""

CONVEXITY_TOLERANCE: Final = 1e-6
"""Convexity defect accepted, as a part of the body's size, when nothing else is said: distances of
such a body are certified to a millionth of it."""

TURN_ROUNDOFF: Final = 3e-14
"""A turn (radians) below this is the roundoff of two normals that are the same."""

LEAST_AXIS: Final = 1e-6
"""Normals of one vertex or edge that come nearer to a half-space's rim (cosine) bound nothing."""

SMOOTH_ANGLE: Final = 1e-7
"""Dihedral angles below this (sine) make an edge smooth (G1)."""

TURN_NOISE: Final = 1e-13
"""A turn (radians) is refined where it may change what is found by more than its roundoff."""

SAMPLED_DEFECT: Final = 1e-9
"""A sampled point may rise above a sampled tangent plane by this fraction of the body's size more
than was proven: the roundoff of building it."""

SIMILARITY_TOLERANCE: Final = 1e-12
"""A linear map is a similarity (keeps spheres) when its singular values agree to this ratio."""

SINGULAR_MAP: Final = 1e-14
"""Least over greatest singular value (a ratio) of a map that keeps a body's volume: below, its
inverse, by which pcurves are found, has no digits."""

CORNER_ROUNDOFF: Final = 1e-12
"""A corner (radians) more hollow than this is roundoff no more, below it a smooth joint."""

COPLANAR_FACETS: Final = 1e-9
"""Facets of a polytope whose normals differ by less (sine) are one face; hull facets of one plane
differ by the roundoff of their vertices."""

MERGED_TURN: Final = 0.0
"""Facets are merged into one face only where the cosine between their normals is above this: the
two sides of a body that is thinner than the tolerance stay two."""

INNER_SHARE: Final = 1.0 - 1e-12
"""Part of the largest rectangle of its proportions that is taken within a face's sides: the rest
is room for the roundoff of its corners."""

ON_SIDE: Final = 1e-12
"""A sample may be outside a face's side by this part of the area of the face's rectangle: the
middle of an obtuse triangle's rectangle is on its side, to roundoff."""

LEAST_CORE: Final = 1e-6
"""The core of a rounded polytope holds at least a ball of this fraction of the inscribed ball of
the sharp one: below it is not told from a point."""

SAME_VERTEX: Final = 1e-10
"""Vertices of the core nearer than this (fraction of its size) are one: more than three planes
meet."""

FLATTEST: Final = 5e-15
"""A box whose core is thinner than this fraction of its length is flat: roundoff of its corners."""

THIN: Final = 1e-6
"""Thickness over extent (a ratio) below which a polytope that cannot be built is told to be too
thin: its facets' planes are then one to roundoff, or to COPLANAR_FACETS where there are many. It
refuses nothing."""

OFF_PLANE: Final = 1e-9
"""Vertices may be off their common plane by this part of their extent: they are moved into it."""

PLANE_ROUNDINGS: Final = 8.0
"""Vertices off it by no more than the roundings (eps of the greatest coordinate) of three that
define it stay where they are."""

NARROWEST: Final = 1e-12
"""A polygon narrower than this part of its length is a segment: its width has no digits."""

SEWING_TOLERANCE: Final = 1e-9
"""Sides closer than this part of the body's size are one edge: the roundoff of making patches. It
is small as what is accepted goes off every lower bound; a CAD kernel's 1e-7 of a unit is asked for
by name."""

WIDEST_SEAM: Final = 1e-2
"""A gap wider than this part of the body's size is no seam: a message offers no tolerance for it,
as a patch is missing or out of place."""

THIN_LENS: Final = 1e-9
"""A lens's offset, and its radius less the offset, are at least this part of its radius: what
float64 can still tell from a ball and from nothing."""

SAME_RADIUS: Final = 1e-14
"""Rings whose radii differ by less (relative) are joined by a cylinder."""

SHORTEST_ARC: Final = 1e-6
"""An arc of a profile's hull shorter than this part of a sample's step is one ring."""

ON_AXIS: Final = 1e-13
"""Points nearer to the axis than this part of the size are on it."""

NO_ABSOLUTE_WIDTH: Final = 1e-300
"""Absolute width of a root's bracket (parameter units) where the relative one alone decides: SciPy
asks for a number above 0."""

ROOT_WIDTH: Final = 4.0 * EPS
"""Relative width of that bracket: the least that SciPy takes."""

HELD_ENDS_RANK: Final = 1e-12
"""Singular values of a bitangent's Newton system below this part of the greatest count as 0, as
where both ends of the line are held."""

BITANGENT_STEP: Final = 4e-16
"""A step of the bitangent's Newton method below this part of the parameters is the last: two
roundings."""

PROJECTION_STEP: Final = 4e-16
"""A projection on a side has arrived when its step is below this part of the side's parameter
range."""

MAX_SPREAD: Final = 3.0
"""Corners of one vertex may spread over this many sewing tolerances (lengths); more is a chain of
corners, which a tolerance far above the sewing's quality makes."""

LEAST_THICKNESS: Final = 2.0
"""A shell whose volume is below this many sewing tolerances (lengths) times its area is a sheet, no
body."""

STRAIGHT_SIDE: Final = 2e-14
"""A straight pcurve serves where it is no farther from the first side than the nearest points are,
but for this part of the body's size and STRAIGHT_SHARE of that distance itself."""

STRAIGHT_SHARE: Final = 0.5
"""Part of the nearest points' distance by which a straight pcurve may be farther off: half of it
leaves the greater part of the gap to the sewing."""

SPLINE_MISS: Final = 1e-13
"""A span of a spline serves when it misses the nearest points by this part of the size or by
SPLINE_SHARE of their distance, or has been halved often enough."""

SPLINE_SHARE: Final = 0.1
"""Part of the nearest points' distance by which a span may miss them: it is lost in the gap
itself."""

AFFINE_SIDE: Final = 1e-13
"""A side's rational parameter whose constant (a ratio, dimensionless) is 1 to this is affine: the
roundoff of its least squares."""

LEVEL: Final = 1e-9
"""Radians: a point is level with another if the line between them is tilted by no more. The normal
of an answer is good to it, and two faces whose normals agree to it count as parallel."""

HEIGHT_ROUNDINGS: Final = 16.0
"""A height carries this many roundings (eps) of the core's size and its offset from its origin."""

PEAK: Final = 1e-15
"""Width (parameter units, and relative) to which a highest point of a curve is bracketed:
roundoff."""

NEAREST_SPOT: Final = 1e-12
"""Width (parameter units) to which the arc's point nearest to the witness is sought: the distance's
square is level to roundoff over far more."""

FLAT_CLOUD: Final = 1e-9
"""Points within this part of the body's size of a common plane span no volume: their hull is not
drawn."""

SHOWN_ROUNDOFF: Final = 1e-15
"""Part of the size at which a number is shown as zero: a few roundings of a sum of that size. What
is computed keeps it."""


def coordinate_roundoff(points: Array) -> float:
    """How far parts at these points, (n, 3), may miss each other by roundoff alone, length."""
    return COORDINATE_ROUNDINGS * EPS * float(np.abs(points).max(initial=0.0))
