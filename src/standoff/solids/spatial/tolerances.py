"""Tolerances of solids in space."""

from typing import Final

BOUND_INFLATION: Final = 1e-12
"""Relative: for the rounding of norms that bound derivatives, some tens of operations."""
ROUND_KIND: Final = 1e-14
"""Relative: columns of a map that differ by less make a round cylinder, cone, sphere or torus; the
surface is then from the round one by less than a rounding of its size."""
PROOF_TOLERANCE: Final = 1e-10
"""Of the sizes of both solids: how far below the distance the proven bound may be."""
PROOF_ROUNDING: Final = 1e-14
"""Of the sizes and the distance: about fifty roundings of double numbers, for a bound that is
computed without intervals at the time of a query."""
SMOOTH_JOIN: Final = 2e-7
"""Radians: faces that join smoothly may differ by this in their normals, twice SMOOTH_ANGLE."""
CONTINUUM_LENGTH: Final = 1e-3
"""Of the sizes: nearest pairs spread less than this are one."""
SAME_PAIR: Final = 1e-6
"""Of the sizes: pairs of points nearer to each other than this are one, found twice."""
DIRECTED: Final = 1e-9
"""Of the sizes: witness points nearer than this have no direction with seven digits; a face's
normal takes its place."""
OPPOSED: Final = 1e-3
"""Length of a sum of unit normals below which it tells no side."""
STILL: Final = 1e-6
"""Length of a sum of unit gradients below which it leads nowhere."""
COLLAPSED_FRAME: Final = 1e-6
"""Part of a vector across another below which it gives no direction."""
SAME_BASIN: Final = 1e-2
"""Of the sizes: a pair this near to a nearer one lies in the same valley, cut at the side of
a leaf."""
VALLEY: Final = 1e-14
"""Of the sizes: pairs that differ by less in their distance are as near as each other."""
STRAIGHT: Final = 1e-6
"""Of its length: a continuum that bends less is a line."""

ALONG_NORMAL = 0.9
"""Cosine (-): a point is along a face's normal, so that the face says on which side it is. At a
nearest place within a face it is 1."""

BESIDE_EDGE = 1e-2
"""Cosine (-) to an edge's or a vertex's sum of normals from which on they say on which side a point
is; less is told by a ray."""

PARTED = 4.0
"""Tolerances (-) by which a solid is moved along the normal to see whether it then is apart: if so,
no more than that is shared, and they touch."""
