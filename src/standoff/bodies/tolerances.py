"""Tolerances for building bodies, each with its unit and reason.

Those of proofs are next to the proofs, those of Voronoi regions in ``voronoi/tolerances.py``.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from standoff.kernels.tolerances import EPS
from standoff.typing import Array

COORDINATE_ROUNDINGS: Final = 16.0
"""Roundings (eps) of the greatest coordinate by which parts may always miss each other: points of
a curve and of a surface have three or four each. The certificate subtracts as many from every
bound."""

FAR_OFF: Final = 1e3
"""Greatest coordinate over extent (a ratio) above which a hull is computed relative to the middle
of the vertices: below it the facets' normals lose at most three digits, within COPLANAR_FACETS."""

JOIN_TOLERANCE: Final = 1e-9
"""Ends of curves and their vertices must agree to this fraction of the body's size."""

WIDE_ANGLE: Final = 1e-6
"""A face's angle at a vertex counts as wide from 180 degrees minus this (radians)."""

SINGULAR_CORNER: Final = 1e-12
"""Tangents at a corner whose sine is below this are one direction: the chart is singular there."""

PIECE_ROUNDOFF: Final = 1e-15
"""A parameter belongs to a piece of a trimming curve whose end it passes by this (relative to 1 +
the parameter): the roundoff of ends that were computed in two ways."""

PERIOD_ROUNDOFF: Final = 1e-12
"""Radians by which trimming curves may leave their period: the roundoff of where they are cut."""

DOMAIN_SPARE: Final = 1e-6
"""Share of a surface's domain by which trimming curves may leave it: what files, and curves fitted
to their edges, miss: OpenCASCADE's 1e-7 of length, on a domain of a tenth. Surfaces, and the bounds
of their parts, go on beyond their domain as what they are there."""

SMALLEST_PART: Final = 1e-8
"""A trimming curve is not divided beyond this fraction of it to prove that it is in its period: the
hull of a part that begins square to the angle leaves it by the square of its length."""

CHART_RIM: Final = 1e-3
"""A chart sees a point whose depth (cosine from its centre) is above this."""

COLLAPSED_TANGENT: Final = 1e-11
"""A tangent shorter than this fraction of the other has collapsed: its direction is roundoff."""

INWARD_STEP: Final = 1e-3
"""How far towards the middle of the domain (a fraction) the sign of a collapsed side's normal is
taken: beyond the roundoff near the side, and before the normal turns noticeably."""

VOLUME_END: Final = 1e-6
"""Relative tolerance of a volume that is reported together with its error."""

BOX_REACH: Final = 1e-3
"""A boundary's box may reach past known points of it by this fraction of its size."""

SAME_CROSSING: Final = 1e-12
"""A point whose ray meets a face within this fraction of the size plus the greatest coordinate is
on the face; crossings as near to each other are one: a few thousand roundings."""

CROSSING_STEP: Final = 1e-14
"""The search for a crossing ends after a step below this fraction of its rectangle's sides."""

LEAF_MARGIN: Final = 1e-9
"""A crossing may lie outside its rectangle by this fraction of the sides: it may be found twice."""

VOLUME_ROUNDINGS: Final = 64.0
"""Roundings (eps of the sum of the parts' magnitudes) by which an enclosed volume may be wrong."""

ROUNDOFF: Final = 1e-14
"""A residual or defect below this fraction of the size is the roundoff of evaluating the same point
twice: the certificate's own allowance covers it."""

CONVEXITY_TOLERANCE: Final = 1e-6
"""Convexity defect accepted by default, as a fraction of the body's size: distances of such a body
are certified to a millionth of it."""

TURN_ROUNDOFF: Final = 3e-14
"""A turn (radians) below this is roundoff between two equal normals."""

LEAST_AXIS: Final = 1e-6
"""If normals of one vertex or edge come nearer than this (cosine) to the rim of a half-space around
their axis, no bound is derived from them."""

SMOOTH_ANGLE: Final = 1e-7
"""An edge whose faces' normals differ by less than this (sine, radians) is smooth (G1)."""

TURN_NOISE: Final = 1e-13
"""A turn is refined if its sampled extreme may be wrong by more than this (radians)."""

SAMPLED_DEFECT: Final = 1e-9
"""A sampled point may lie above a sampled tangent plane by this fraction of the body's size more
than was proven: the roundoff of building the body."""

SIMILARITY_TOLERANCE: Final = 1e-12
"""A linear map is a similarity (maps spheres to spheres) if its singular values agree to this
relative difference."""

SINGULAR_MAP: Final = 1e-14
"""A map with a ratio of least to greatest singular value below this is singular: its inverse, by
which pcurves are found, has no correct digits."""

CORNER_ROUNDOFF: Final = 1e-12
"""A corner turned by more than this (radians) is not roundoff; below it, it is a smooth joint."""

COPLANAR_FACETS: Final = 1e-9
"""Facets of a polytope whose normals differ by less than this (sine) are one face; hull facets of
one plane differ by the roundoff of their vertices."""

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
"""The core of a rounded polytope contains at least a ball of this fraction of the inscribed ball of
the sharp one: a smaller core cannot be distinguished from a point."""

SAME_VERTEX: Final = 1e-10
"""Vertices of the core nearer to each other than this (fraction of its size) are one, where more
than three planes meet."""

MESH_CORNER: Final = 1e-12
"""Corners of a mesh nearer than this, as a fraction of its greatest coordinate, are one: programs
that write each triangle by itself round the same corner in several ways."""

FLATTEST: Final = 5e-15
"""A box whose core is thinner than this fraction of its length is flat: roundoff of its corners."""

THIN: Final = 1e-6
"""Thickness over extent (a ratio) below which the message about a polytope that cannot be built
says that it is too thin: its facets' planes then coincide to roundoff, or to COPLANAR_FACETS if
there are many. It does not reject anything itself."""

OFF_PLANE: Final = 1e-9
"""Vertices may be off their common plane by this fraction of their extent; they are moved into
it."""

PLANE_ROUNDINGS: Final = 8.0
"""Vertices off the plane by no more than this many roundings (eps of the greatest coordinate),
those of three points that define it, are not moved."""

NARROWEST: Final = 1e-12
"""A polygon narrower than this fraction of its length is a segment: its width has no correct
digits."""

SEWING_TOLERANCE: Final = 1e-9
"""Sides closer than this fraction of the body's size are one edge: the roundoff of making patches.
It is small because a gap that is accepted lowers every lower bound; for the 1e-7 of a unit of a CAD
kernel, ask with ``tolerance=``."""

WIDEST_SEAM: Final = 1e-2
"""A gap wider than this fraction of the body's size is not a seam: the message does not suggest a
tolerance for it, because a patch is missing or out of place."""

THIN_LENS: Final = 1e-9
"""A lens's offset, and its radius minus the offset, are at least this fraction of its radius: what
float64 can still distinguish from a ball and from nothing."""

SAME_RADIUS: Final = 1e-14
"""Rings whose radii differ by less (relative) are joined by a cylinder."""

SHORTEST_ARC: Final = 1e-6
"""An arc of a profile's hull shorter than this fraction of a sample's step is one ring."""

ON_AXIS: Final = 1e-13
"""Points nearer to the axis than this fraction of the size are on it."""

NO_ABSOLUTE_WIDTH: Final = 1e-300
"""Absolute width of a root's bracket (parameter units) if only the relative one should decide:
SciPy requires a number above 0."""

ROOT_WIDTH: Final = 4.0 * EPS
"""Relative width of that bracket: the least that SciPy accepts."""

HELD_ENDS_RANK: Final = 1e-12
"""Singular values of a bitangent's Newton system below this fraction of the greatest count as 0,
for instance where both ends of the line are fixed."""

BITANGENT_STEP: Final = 4e-16
"""The bitangent's Newton method ends after a step below this fraction of the parameters: two
roundings."""

PROJECTION_STEP: Final = 4e-16
"""A projection onto a side has converged when its step is below this fraction of the side's
parameter range."""

MAX_SPREAD: Final = 3.0
"""Corners of one vertex may spread over this many sewing tolerances (lengths); more is a chain of
corners, caused by a tolerance far above the quality of the patches."""

LEAST_THICKNESS: Final = 2.0
"""A shell whose volume is below this many sewing tolerances (lengths) times its area is a sheet,
not a body."""

STRAIGHT_SIDE: Final = 2e-14
"""A straight pcurve is used if it is farther from the first side than the nearest points are by at
most this fraction of the body's size or STRAIGHT_SHARE of that distance."""

STRAIGHT_SHARE: Final = 0.5
"""Fraction of the nearest points' distance by which a straight pcurve may be farther off: with a
half, most of the gap is still that of the patches."""

SPLINE_MISS: Final = 1e-13
"""A span of a spline is accepted if it misses the nearest points by at most this fraction of the
size or SPLINE_SHARE of their distance, or has been halved often enough."""

SPLINE_SHARE: Final = 0.1
"""Fraction of the nearest points' distance by which a span may miss them: little compared with the
gap itself."""

AFFINE_SIDE: Final = 1e-13
"""A side's rational parameter is affine if its constant (a ratio, dimensionless) is 1 to within
this, the roundoff of the least squares."""

LEVEL: Final = 1e-9
"""A point is level with another if the line between them is tilted by no more (radians). The normal
of an answer is accurate to this, and two faces whose normals agree to it count as parallel."""

HEIGHT_ROUNDINGS: Final = 16.0
"""A height has this many roundings (eps) of the core's size plus its offset from its origin."""

PEAK: Final = 1e-15
"""Width (parameter units, and relative) to which the highest point of a curve is bracketed:
roundoff."""

NEAREST_SPOT: Final = 1e-12
"""Width (parameter units) to which the arc's point nearest to the witness is sought: the squared
distance is constant to roundoff over much more."""

FLAT_CLOUD: Final = 1e-9
"""Points within this fraction of the body's size of a common plane span no volume: their hull is
not drawn."""

SHOWN_ROUNDOFF: Final = 1e-15
"""Fraction of the size below which a number is shown as zero: a few roundings of a sum of that
size. The computed value keeps it."""


def coordinate_roundoff(points: Array) -> float:
    """How far parts at these points, (n, 3), may miss each other by roundoff alone, length."""
    return COORDINATE_ROUNDINGS * EPS * float(np.abs(points).max(initial=0.0))


EXACT_KIND: Final = 1e-12
"""Cosine, and relative for lengths: normals and semi-axes that differ by less are the same, some
thousand roundings. Then a rounded face, moved out by the radius, is of the kind of its core's."""

NO_STRIP: Final = 1e-10
"""Part of the size: a rounded edge or vertex whose strip of cylinder, torus or sphere is narrower
than this has none: its faces' moved edges are one within the tolerance of joints."""
