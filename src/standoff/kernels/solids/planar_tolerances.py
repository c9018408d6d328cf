"""Tolerances of planar solids' kernels, each with its unit and reason."""

from __future__ import annotations

from typing import Final

SPLIT_LENGTH: Final = 1e-13
"""A piece whose box is smaller than this fraction of the pair's extent is not cut further: its
points are the same up to rounding."""

SAFE_NORMAL: Final = 1e-5
"""Points nearer than this fraction of the extent have no reliable direction between them, as it
is rounded by 1e-16 / 1e-5: the curve's own normal is taken."""

SAME_POINT: Final = 1e-15
"""Points nearer than this fraction of the extent are the same up to rounding."""

AT_OPTIMUM: Final = 1e-6
"""Sine of the angle by which a pair's direction may leave the normal cone of a local minimum:
Newton's steps end at some 1e-8."""

END_OF_PIECE: Final = 1e-9
"""A parameter this near to an end of its piece (a fraction of the piece) is at the end."""

SAME_ANGLE: Final = 1e-12
"""Radians by which an arc's extreme may lie outside the arc and is still counted: the roundoff of
its angle, and one point too many makes no bound wrong."""

STRAIGHT_LEVEL: Final = 1e-9
"""A level curve whose curvature times the extent is less than this is taken as straight: any
potential makes a true bound."""

NEWTON_END: Final = 1e-15
"""Newton's steps end when a step is below this fraction of the piece: roundoff."""

NEWTON_STEPS: Final = 12
"""Most steps of one descent to nearest points; 4 to 6 are usual."""

SINGULAR_STEP: Final = 1e-14
"""A 2 x 2 system whose determinant is below this fraction of its terms is not solved: parallel
lines, concentric arcs; the nearest points at the ends are as near."""
