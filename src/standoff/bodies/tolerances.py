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
below it the facets' normals lose no more than three digits, within COPLANAR."""

JOIN_TOLERANCE: Final = 1e-9
"""Endpoints of curves and their vertices must agree to this fraction of the body's size."""

WIDE_ANGLE: Final = 1e-6
"""A face's angle at a vertex of 180 degrees less this (radians) counts as wide."""

SINGULAR: Final = 1e-12
"""Tangents at a corner whose sine is below this are one direction: the chart is singular there."""

CHART_RIM: Final = 1e-3
"""A chart sees a point whose depth (cosine from its centre) is above this."""

COLLAPSED_TANGENT: Final = 1e-11
"""A tangent shorter than this part of the other has collapsed: its direction is roundoff."""

INWARD_STEP: Final = 1e-3
"""How far towards the middle of the domain the sign of a collapsed side's normal is taken."""

FLAT_ROUNDINGS: Final = 8.0
"""A face that passes the body's middle by no more than this many roundings of the coordinates is a
side of a flat body."""

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
"""Least over greatest singular value of a map that keeps a body's volume: below, its inverse, by
which pcurves are found, has no digits."""

CORNER_ROUNDOFF: Final = 1e-12
"""A corner (radians) more hollow than this is roundoff no more, below it a smooth joint."""

COPLANAR: Final = 1e-9
"""Facets of a polytope whose normals differ by less (sine) are one face; hull facets of one plane
differ by the roundoff of their vertices."""

LEAST_CORE: Final = 1e-6
"""The core of a rounded polytope holds at least a ball of this fraction of the inscribed ball of
the sharp one: below it is not told from a point."""

SAME_VERTEX: Final = 1e-10
"""Vertices of the core nearer than this (fraction of its size) are one: more than three planes
meet."""

FLATTEST: Final = 5e-15
"""A box whose core is thinner than this fraction of its length is flat: roundoff of its corners."""

THIN: Final = 1e-6
"""Thickness over extent below which a polytope that cannot be built is told to be too thin: its
facets' planes are then one to roundoff, or to COPLANAR where there are many. It refuses nothing."""

OFF_PLANE: Final = 1e-9
"""Vertices may be off their common plane by this part of their extent: they are moved into it."""

PLANE_ROUNDINGS: Final = 8.0
"""Vertices off it by no more than the roundings (eps of the greatest coordinate) of three that
define it stay where they are."""

NARROWEST: Final = 1e-12
"""A polygon narrower than this part of its length is a segment: its width has no digits."""

SEWING_TOLERANCE: Final = 1e-9
"""Sides closer than this part of the body's size are one edge: the roundoff of making patches."""


def coordinate_roundoff(points: Array) -> float:
    """How far parts at these points, (n, 3), may miss each other by roundoff alone, length."""
    return COORDINATE_ROUNDINGS * EPS * float(np.abs(points).max(initial=0.0))
