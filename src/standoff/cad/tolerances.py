"""Tolerances of reading CAD files, each with its unit and reason."""

from __future__ import annotations

from typing import Final

FILE_AREA: Final = 1e-6
"""A face's area, and a solid's volume, may differ from OpenCASCADE's by this fraction: both are
found by quadrature to about this, and a lost piece of a face is more."""

FITTED_TRIM: Final = 1e-10
"""A fitted trimming curve is good enough when its points miss the edge by at most this fraction of
the part's size: a tenth of what parts may miss each other by."""

KEPT_TRIM: Final = 2e-8
"""Fraction of the part's size by which a file's trimming curve may miss its edge and still be taken
as it is, on surfaces where a nearer one has to be searched for and has more spans."""

SAME_TANGENTS: Final = 1e-14
"""Squared sine of the angle between a surface's tangents below which they are parallel: a collapsed
side, or roundoff."""

OFF_PLANE_PROFILE: Final = 1e-9
"""A profile of a surface of revolution may leave the plane of its axis by this fraction of its
extent; it is moved into it, and the distance joins the slack."""

BOUND_SHARE: Final = 0.1
"""What is unknown between samples of a trimming curve's miss is reduced until it is at most this
fraction of the greatest sampled miss, or BOUND_FLOOR of the size."""

BOUND_FLOOR: Final = 3e-10
"""Fraction of the part's size below which the bound of a trimming curve's miss is not sharpened: a
third of what parts may miss each other by; half of it costs a quarter more time."""

REMAINDER: Final = 1e-3
"""Fraction of BOUND_FLOOR that Taylor polynomials of sines may leave: it joins the bound, and a
smaller one costs a higher degree."""

RECOGNISED: Final = 1e-9
"""Fraction of the part's size within which a spline has to be a surface or curve of another kind to
be taken for it: what parts may miss each other by anyway. What it is off by joins the slack."""

SAME_NORMALS: Final = 1e-6
"""Of unit normals of a spline: below this they have one direction, or lie in one plane
(dimensionless). It tells what to try only; a bound proves it."""

SPHERE_DEPTH: Final = 0.15
"""Cosine from the middle of a sphere's face beyond which its trimming curves are not fitted in one
gnomonic chart: there the chart stretches by 1 / cosine²."""

LEAST_FACE: Final = 1e-14
"""A face whose area is below this fraction of the square of the part's size has no area: the
roundoff of its corners."""

FILE_SLACK: Final = 4.0
"""Parts may miss each other by this many times the file's greatest tolerance: an edge and a vertex
each have one, on two faces. What they miss by is measured, and joins the slack."""

MOST_ACCURACY: Final = 1e-3
"""The accuracy that a file states counts up to this fraction of a part's size: more is a mistake in
its unit, and would take parts that gape for closed ones. ``tolerance=`` allows it."""

SEWN_AT_LEAST: Final = 1e-7
"""Length, in the file's unit, within which healing sews at least: OpenCASCADE's own precision."""

QUADRATURE: Final = 1e-9
"""Relative error asked of OpenCASCADE's integrals of area and volume: what its own adaptive rule
reaches on curved faces in milliseconds."""

SAME_KNOT: Final = 1e-9
"""A knot that is nearer to an end of an edge than this fraction of its range is that end: files
round parameters to about twelve digits, and a span of roundoff has no direction."""

CONSTANT: Final = 1e-11
"""A parameter of a trimming curve that varies by less than this (relative to 1 + itself) along it
is constant: the roundoff of angles, and of the file's own digits."""

WHOLE_PROFILE: Final = 1e-9
"""An extruded arc is a whole turn if its angle is one to within this fraction: the digits that
files keep of angles."""

AT_POLE: Final = 1e-6
"""A point this near to the axis of an angle, as a fraction of the surface's size there, is on it:
files round the ends of edges to about a tenth of this, and the angle has no digits there."""

MISSED_POLE: Final = 1e-2
"""Radians by which a file's trimming curves may miss the angle at which their edge leaves a pole:
OpenCASCADE's end some 1e-4 before it."""
