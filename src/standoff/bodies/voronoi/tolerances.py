"""Tolerances of Voronoi regions, each with its unit and reason."""

CORNER_TURN = 1e-5
"""Least turn of the outward normal at a vertex that has its own region [rad]; a flatter corner
counts as smooth. If a disc touches both sides of it, one point lies above the tangent at the other
by half the turn squared, in radii of the disc: above LEAST_HEIGHT."""

SAME_PLACE = 1e-9
"""Points of the medial axis nearer to each other than this are one [body's size]: a thousand times
the error of solving for three touching points with well separated normals."""

SAME_DEPTH = 1e-9
"""A disc into which the boundary extends by less is empty; the edges named are nearest to within
this [body's size]."""

FLAT_CURVATURE = 1e-9
"""Curvatures that differ by less are those of one circular arc [relative]: the roundoff of second
derivatives, and far less than a varying curvature changes between two samples."""

POLYLINE = 1e-4
"""How far a drawn branch may be from the true one by default [body's size]: less than a pixel of
any picture."""

LONGEST_CHORD = 1.0 / 24.0
"""Longest piece of a branch's polyline [body's size], so that its depths interpolate well too."""

OUTLINE_SAMPLES = 65
"""Samples of an arc's curvature and points: they resolve every maximum of one span of a curve of
moderate degree. The checks at the end detect what they miss."""

PART_SAMPLES = 33
"""Samples of a part of an arc in which a touching point is sought."""

GRADES = 24
"""Additional samples, each half as far from the end as the previous: to the last 1e-8 of the
part."""

LEAST_HEIGHT = 1e-11
"""A boundary point nearer to the tangent at the other one does not determine the disc through both
[body's size]: the radius would have fewer than five digits."""

HALVINGS = 60
"""Most bisections of a foot's path to a junction: all of float64's digits."""

NEAR_JUNCTION = 1e-3
"""A foot's bracket at a junction [part of its path] from which Newton's method is tried."""

NEWTON_STEPS = 12
"""Most steps of Newton's method for a junction; from such a bracket four are enough."""

SOLVED = 1e-14
"""Residual of a junction's equations that is roundoff [body's size]: a few dozen roundings."""

CHECK_SAMPLES = 24
"""Boundary points of every arc from which completeness is checked."""

FINEST_POLYLINE = 1e-7
"""Finest polyline that may be requested [body's size]: a branch then has a few thousand points."""

BRACKET_SLACK = 1e-6
"""How far Newton's junction may lie outside its bracket [parameter units]: the roundoff of the
bracket's ends."""

FOOT_AT_REST = 1e-15
"""A descent on a face ends after a step that moves the point by less than this [as a part of its
distance plus the body's size]."""

OFF_NORMAL = 1e-6
"""At a face's nearest point, the greatest sine of the angle between its normal and the line to the
point."""

AT_END = 1e-7
"""A maximum nearer than this to the end of its arc (part of the arc) is at the end."""
