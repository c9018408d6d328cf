"""Tolerances of trackers and witness sets, each with its unit and reason."""

from __future__ import annotations

from typing import Final

LEAST_WIDTH_ANGLE: Final = 1e-9
"""Radians to which the direction of a least width is found: the width is then known to far below
SAME_WIDTH."""

LEAST_EXTENT: Final = 1e-7
"""Of the smaller core's size: what is shorter or narrower does not count. A round body is level
with its highest point to roundoff (1e-15 of the size) within 6e-8 of it."""

LOOSENESS: Final = 4.0
"""Witness points off the normal's line by some length may be off their sets by a few times that."""

LINE_RANK: Final = 1e-6
"""A set whose smaller extent is below this part of the larger (singular values) is a line: its tilt
across the line has no digits."""

CHECK_ROUNDOFF: Final = 1e-15
"""Dimensionless. The compiled check of a rotation fuses sums and products, NumPy's does not: a
defect this close to the one that is allowed counts as above it, so that the kernels refuse no pose
that many at once have passed. Four roundoffs of 1."""

NEAR_LIMIT: Final = 0.9
"""Magnitude of a growth factor (dimensionless) above which a gain beyond 1/dt is warned of: a tenth
takes 22 steps, and beside a circle starts settle within 22 degrees (tan x / x = 2 / (K dt))."""
