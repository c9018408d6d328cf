"""Tolerances of the patches of convex bodies, each with its unit and reason."""

ONE_SPOT = 1e-6
"""Of the smaller size: pairs that lie nearer to each other than this across the normal are one."""
RIMS_MEET = 1e-9
"""Of the smaller size: curves that miss each other by this meet, as rims that lie over each other
do to rounding."""
EVEN = 1e-2
"""Share: of candidates whose reach differs by less the first is taken, so that a slight tilt of a
symmetric pair does not choose others."""
SAME_CORNER = 0.25
"""Share of the region's extent by which a corner may have moved since the frame before."""
WORTH_A_CORNER = 1.5
"""Ratio of areas: corners are exchanged where the patch grows by more. Between it and 1 the corners
of the frame before stay, so that none goes to and fro."""
LEVEL_TURN = 1.5
"""Radians: a curve that turns by as much within the region is a rim that lies there, of which
places all round are taken; one that turns by less has only its highest place there."""
FACING = 1e-3
"""Cosine: a face whose normal is nearer to square to the direction than this is seen from the side,
and has no height."""
PAIR_LEAN = 0.95
"""Cosine, of 18 degrees, as of solids: pairs of rounded edges that lean by more are no part of a
patch."""
FLAT_CROSSING = 1e-9
"""Sine of the angle between two curves seen along the normal below which they do not cross."""
AT_CROSSING = 1e-14
"""Of both sizes: Newton's method for a crossing has come to its end."""
SPOT_STEPS = 12
"""Steps of Newton's method: it doubles its digits, from two at the start."""
AT_PEAK = 1e-15
"""Of the parameter plus 1: a step by which the highest place of a curve is found, its rounding."""
PEAK_HALVINGS = 60
"""Halvings of a piece of a curve at its highest place: down to rounding."""
OWN_REACH = 0.1
"""Share of a patch's extent: the witness points are one more corner of it where they are farther
outside. Nearer to it they may run along it, as where cylinders side by side turn across each other,
and are not spread any farther."""
