"""Tolerances of gains, levels and basins, each with its unit and reason."""

from __future__ import annotations

from typing import Final

CURVE_TOLERANCE: Final = 1e-8
"""Relative error of the curves outwards; their ends are found to this as well."""

DIRECTION_TOLERANCE: Final = 1e-6
"""The search for the least end of a curve ends where its directions (unit vectors, dimensionless)
are within this: near a least value the end depends on their square."""

POLE_AREA: Final = 1e-4
"""Tangents whose area falls below this part of their lengths' product, or of which one (over the
domain) is this much shorter than the other, are a pole's: curvature there is roundoff, which grows
with the inverse square of this; it is taken at the points beside it."""

SEARCH_TOLERANCE: Final = 1e-9
"""Tolerance of a local search for the least curvature, relative to the parameters' range."""

REAL_LIMIT: Final = 1e-9
"""A root of R(-z) = 1 or -1 (dimensionless) whose imaginary part is below this is real, and one
below it is z = 0 itself: far above roundoff, far below the limits, which are 2 and more."""

REAL_EXTREME: Final = 1e-6
"""A root of a derivative counts as real where its imaginary part is below this part of it."""

FOUND_MINIMUM: Final = 1e-6
"""A run has found the minimum where its distance and witness points are within this part of the
pair's size of the true ones: far above roundoff, far below the distance to any other stationary
point."""

SETTLED_RUN: Final = 1e-6
"""A run has settled where the projection of the witness vector on the tangents is below this part
of its length."""

WHOLE_STEPS: Final = 1e-9
"""A time this part below a whole number of steps is that number: far above roundoff."""
