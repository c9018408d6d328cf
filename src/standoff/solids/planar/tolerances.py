"""Tolerances of planar solids, each with its unit and reason."""

from __future__ import annotations

from typing import Final

import numpy as np

JOINED: Final = 1e-9
"""Ends of curves that are to meet may miss each other by this fraction of the solid's size, the
same as for a planar `Body`; what they miss is the solid's slack."""

JOINED_IN_DRAWING: Final = 1e-5
"""Ends of a DXF drawing's curves that meet no other end, and so leave it open, are joined over this
fraction of the drawing's size. Programs write at least six digits, so each coordinate is off by up
to 5e-6 of it, and two ends by twice that; what they miss is told, and is the solid's slack."""

APART_FROM_ITSELF: Final = 4e-9
"""Parts of a boundary nearer to each other than this fraction of its size, and not joined there,
meet: a few times what ends may miss each other by."""

SMOOTH_TURN: Final = 1e-9
"""Radians by which the tangent may turn at a smooth vertex: roundoff of given coordinates."""

IN_PLANE: Final = 1e-12
"""A curve may leave the plane z = 0 by this fraction of its size: roundoff."""

ARC_OF_CIRCLE: Final = 1e-15
"""A conic arc whose axes differ in length, or from a right angle, by less than this fraction is an
arc of a circle; more would be a bound's error."""

PADDED: Final = 32.0 * float(np.finfo(np.float64).eps)
"""A computed point lies within this fraction of the greatest coordinate of the curve: some 10
roundings of a jet, and of the chord."""

BOUND_ROUNDED: Final = 1e-14
"""Roundoff of one bound (a fraction of the extent, the greatest number that is computed with): a
pose applied, a jet, a potential, some 40 operations of 1.1e-16 each."""

PROVEN_TO: Final = 1e-10
"""What a distance is proven to (a fraction of the pair's size)."""

LONG_SET: Final = 1e-3
"""Nearest pairs that reach over more than this fraction of the pair's size are a continuum, fewer
one pair."""

ONE_PAIR: Final = 3e-5
"""Nearest pairs closer to each other than this fraction of the pair's size, both points, are one:
where a distance grows quadratically, the pairs within the tolerance reach as far as its root."""

TURN_OF_LEAF: Final = 0.35
"""Radians by which the tangent of a leaf may turn: then its box is narrow."""

TURN_OF_ARC: Final = 0.8
"""Radians by which the tangent of an arc of a circle may turn: its bounds need no narrow box."""

UNEVEN_LEAF: Final = 0.05
"""Radians: width of a leaf's range of curvature, by its length."""

BALL_PART: Final = 2e-2
"""The ball in an overlap is sought until no other is larger by this part of it."""

NO_CORNER: Final = 1e-9
"""A round corner shorter than this fraction of the body's size is left out: its neighbours meet."""

CLEAR_AREA: Final = 1e-2
"""A polygon through points of a loop that has more area than this fraction of the size squared
turns as the loop does."""
