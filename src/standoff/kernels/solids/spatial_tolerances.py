"""Tolerances of the kernels of solids in space, each with its unit and reason."""

from typing import Final

CONE_SPARE: Final = 1e-9
"""Radians: added to cones of normals for the rounding of their angles."""
SMOOTH_SPARE: Final = 2e-7
"""Radians: faces that join smoothly may differ by this in their normals, twice SMOOTH_ANGLE."""
SHORTEST_PART: Final = 1e-9
"""Of the sizes: parts of a leaf shorter than this are not cut again."""
SURE_NORMAL: Final = 1e-9
"""Of the sizes: points nearer than this length have no direction between them with seven digits."""
LEAST_SPAN: Final = 1e-6
"""Of the sizes: pieces count as at least this long where curvatures are chosen by their span."""
SAME_NUMBER: Final = 1e-15
"""Relative: radii and cosines that differ by no more than their rounding are one."""
LEAST_PIVOT: Final = 1e-14
"""Relative, of a squared tangent: a pivot of Newton's system below this is not positive."""
LEAST_MOVE: Final = 1e-30
"""Relative, of a square of the length: a step that moves points by less changes no digit."""
FIRST_DAMPING: Final = 1e-4
"""Relative, of squared tangents: what is added to Newton's system where it is not positive."""
UNDAMPED_STEP: Final = 1e-8
"""Relative, of squared tangents: a damping below this is left out."""
LEAST_GAIN: Final = 1e-17
"""Relative: a step that lessens the square of the length by less is the last."""
PARALLEL_TANGENTS: Final = 1e-9
"""Relative: area of two tangents, over their squares, below which a face has no curvature."""
PARAMETER_SPARE: Final = 4e-16
"""Relative: two roundings of a parameter at the end of a part of a trimming curve."""
LEAST_CROSSING: Final = 1e-3
"""Sine of the angle of two planes below which their common line is not computed."""
CROSSING_SPARE: Final = 1e-12
"""Of the sizes and coordinates: how far the computed common line of two planes may be from the
true one, some ten roundings over `LEAST_CROSSING`."""
NEARLY_COAXIAL: Final = 0.02
"""One less the cosine of the axes' angle, and their offset in sizes: what turns about axes nearer
to each other than this is tried with a potential about one of them."""
NEARLY_STRAIGHT: Final = 1e-4
"""Cosine: a normal this near to an axis, or to across it, is taken to be so in a coaxial potential;
the torus potential beside it keeps the normal as it is."""
ALONG_OWN: Final = 1e-6
"""One less the cosine: a normal this near to that of a cylinder or a cone that one of its points
lies on is taken to be it."""
ROUND_CONIC: Final = 1e-14
"""Relative, of a squared radius: a conic whose two half axes are this near to one length, and to
being normal to each other, is an arc of a circle."""
CIRCLE_ROUNDING: Final = 4e-15
"""Relative: some twenty roundings of the terms of the distance from a circle."""
MAY_REACH: Final = 0.3
"""Of the length below which faces meet: how far one may reach beyond the other's surface where it
counts as on one side of it. It is more than a quarter, the slack of both, and less than the half to
which parts are proven to be apart, so that no part that goes on from there counts as apart."""
ONE_PLACE: Final = 1e-6
"""Of the sizes: nearest pairs that are nearer to each other than this are one, found twice."""
FLAT_VALLEY: Final = 1e-6
"""Relative, of squared tangents: where the square of the distance bends less than this along a
direction, the nearest pairs may be a continuum, which is then looked for."""
PAST_SIDE: Final = 1e-9
"""Of a leaf: how far beyond its side the next one is looked for, some roundings of a parameter."""
FLAT_SPAN: Final = 8e6
"""Per square of the sizes: where the distance bends by less than this many tolerances, nearest
pairs a thousandth of the sizes apart may be as near; eight over the square of that length."""
HELD_SLOPE: Final = 1e-6
"""Sine: a parameter at the side of a leaf is held there if the distance's slope is more."""
LEAST_REST: Final = 1e-4
"""Of the sizes: rows that are not due within this motion are not looked up meanwhile, so that the
list of the others serves for many frames of solids that are nearly at rest."""
MOTION_SPARE: Final = 1e-14
"""Relative, and of the sizes and the distances of the frames: for the rounding of a motion between
two poses."""
NEAREST_AXIS: Final = 0.3
"""Of a point's distance from a screw's axis: parts that reach nearer to it are cut before the
potential of the screw, which is steeper there, is tried."""
ONE_THREAD: Final = 0.03
"""Relative, of a rise: the screw that is tangential to a thread at a place is taken if it is this
near to that of the whole."""
SAME_BASIN: Final = 1e-2
"""Of the sizes: a pair this near to a nearer one lies in the same valley, cut at the side of
a leaf."""
VALLEY: Final = 1e-14
"""Of the sizes: pairs that differ by less in their distance are as near as each other."""
ONE_PATCH: Final = 0.95
"""Cosine, of 18 degrees: pairs of points whose normals differ by more belong to no one patch."""
CONTACT_ERROR: Final = 1e-9
"""Relative, of the sizes and of unit tangents: an error of the contact-regular form below which its
Newton's method has come to an end, some thousand roundings of the least of its pivots."""
CONTACT_ROUNDED: Final = 1e-15
"""The same, where no step makes it less: some roundings."""
PARALLEL_EDGES: Final = 1e-5
"""Sine: edges at a smaller angle have no common normal of their own; `PIVOT` is its square."""
ROUGHLY_LEVEL: Final = 1e-6
"""Of the length of an edge's leaf: steps to where it is level with the way out of a hollow edge end
below; Newton's method goes on from there."""
SLOPE_STEP: Final = 1e-3
"""Of the length of a hollow edge's leaf, by which the change of the way out of it is told: a start
of Newton's method needs no more digits."""
FELT_SPARE: Final = 1e-6
"""Of the sizes: by how much the signed distance of a place may jump beyond its motion where it goes
from one feature to the next, and how deep one may be born."""
ALIKE: Final = 0.5
"""Cosine, of 60 degrees: normals of one region in which two boundaries overlap; another way out of
it is farther off."""
NEARLY_OPPOSED: Final = 0.2
"""Sine: a vertex or an edge that is pressed beside a place may be tilted by as much away from what
presses it, far more than a shallow overlap lets it; what is turned away farther is pushed from
another side."""
NEARLY_LEVEL: Final = 1e-3
"""Relative, of the sizes and of unit tangents: an error of the contact-regular form below which the
first steps of its Newton's method may make it so great: a rim that is tilted by 1e-8 has an error
of 1e-8 all around, and is level in one place."""
NO_SIDE: Final = 1e-3
"""Length of a sum of unit normals below which it tells no side."""
UNCLEAR_NORMAL: Final = 0.1
"""Chord of the unit sphere: a normal that roundoff may turn by this tells no side: at a pole it may
be turned round."""
ALONG_NORMAL: Final = 1.0 - 1e-6
"""Cosine: a point is along a face's normal, so that the face says on which side it is. At a place
within a face it is 1. At a sharp edge one face's normal is nearly against the other's."""
ACROSS_EDGE: Final = 1e-5
"""Cosine to an edge's tangent up to which a point's nearest place is along the edge, not at its
end."""
BESIDE_EDGE: Final = 1e-2
"""Cosine to an edge's or a vertex's sum of normals from which on they say on which side a point
is; less is told by a ray."""
WAY_ROUNDINGS: Final = 4.0
"""Of both solids' rounding: a way past each other has that of two heights, and of B's move."""
