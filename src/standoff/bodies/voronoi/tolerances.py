"""Tolerances of the Voronoi regions, each with its unit and reason."""

CORNER_TURN = 1e-5
"""Least turn of the outward normal at a vertex that has a region of its own [rad]; a flatter corner
counts as smooth. Where a disc touches either side of it, one point lies above the tangent at the
other by half the turn squared, in radii of the disc: above LEAST_HEIGHT."""

SAME_PLACE = 1e-9
"""Points of the medial axis nearer than this are one [body's size]: a thousand times what solving
three touching points leaves where their normals are well apart."""

SAME_DEPTH = 1e-9
"""A disc whose inside is entered by less is empty; named edges are nearest within this [body's
size]."""

FLAT_CURVATURE = 1e-9
"""Curvatures that differ by less are those of one circular arc [relative]: roundoff of second
derivatives, and far below how a curvature falls off between two of its samples."""

POLYLINE = 1e-4
"""How far a drawn branch may be from the true one where nothing else is asked for [body's size]:
less than a pixel of any picture."""

LONGEST_CHORD = 1.0 / 24.0
"""Longest piece of a branch's polyline [body's size], so that its depths interpolate well too."""

OUTLINE_SAMPLES = 65
"""Samples of an arc's curvature and points: they resolve every maximum of one span of a curve of
moderate degree. What they miss is found by the checks at the end."""

PART_SAMPLES = 33
"""Samples of a part of an arc in which a touching point is sought."""

GRADES = 24
"""Samples beside those, each half as far from the end: to the last 1e-8 of the part."""

LEAST_HEIGHT = 1e-11
"""A boundary point nearer to the tangent at the other one says nothing of the disc through both
[body's size]: the radius would have fewer than five digits."""

HALVINGS = 60
"""Most bisections of a foot's way to a junction: the whole of float64's digits."""

NEAR_JUNCTION = 1e-3
"""A foot's bracket at a junction [part of its way] from which Newton's method is tried."""

NEWTON_STEPS = 12
"""Most steps of Newton's method on a junction; from such a bracket four do."""

SOLVED = 1e-14
"""Residual of a junction's equations that is roundoff [body's size]: some dozen roundings."""

CHECK_SAMPLES = 24
"""Boundary points of every arc from which completeness is checked."""

FINEST_POLYLINE = 1e-7
"""Finest polyline that may be asked for [body's size]: a branch then has a few thousand points."""

BRACKET_SLACK = 1e-6
"""How far Newton's junction may lie outside its bracket [parameter units]: the roundoff of the
bracket's ends."""

FOOT_AT_REST = 1e-15
"""A step on a face that moves the point by less [of the way to it and the body's size] is the
last."""

OFF_NORMAL = 1e-6
"""A face's nearest point has the way to it along its normal: greatest sine of the angle between."""

AT_END = 1e-7
"""A maximum nearer than this to the end of its arc (part of the arc) is at the end."""
