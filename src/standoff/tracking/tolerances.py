"""Tolerances of trackers and witness sets, each with its unit and reason."""

from __future__ import annotations

from typing import Final

SHRINK: Final = 1e-8
"""The hulls are shrunk by this part of their size before they are compared, and the linear program
is solved to a tenth of it: what it calls overlap is overlap."""

AROUND: Final = 1e-3
"""Radians: other normals are tried at this angle. Normal cones narrower than this, as of polytopes
with thousands of facets, are not seen."""

SAME_WIDTH: Final = 1e-10
"""Of the size: widths of overlap (support sums) closer than this are the same. At AROUND one that
grows with a radius of curvature of 2e-4 of the size differs by more."""

LEAST_WIDTH_ANGLE: Final = 1e-9
"""Radians to which the direction of a least width is sought: the width is then known to far below
SAME_WIDTH."""

LEAST_EXTENT: Final = 1e-7
"""Of the lesser core's size: what is shorter or narrower does not count. A round body is level with
its highest point to roundoff (1e-15 of the size) within 6e-8 of it."""

TOUCHING_CORES: Final = 1e-12
"""Of the sizes: cores that are nearer than this touch, and the normal may not be unique."""

LOOSENESS: Final = 4.0
"""Witness points off the normal's line by some length may be off their sets by a few times that."""

LINE_RANK: Final = 1e-6
"""A set whose lesser extent is below this part of the greater (singular values) is a line: its own
tilt across has no digits."""

PLANE_TILT: Final = 1e-12
"""Dimensionless, entries of R: a planar body's pose may be tilted by this, the roundoff of
composing rotations."""

SINGULAR_SYSTEM: Final = 1e-9
"""Least over greatest singular value of the contact-regular system, in lengths over the size and
parameters by arc length: below it fewer than seven digits of a derivative would be left."""

SETTLED: Final = 1e-4
"""Residual of that system, dimensionless: Newton's method from here ends at the same optimum, and
answers of a law that still converges are told apart."""

BESIDE_FEATURE: Final = 1e-9
"""Radians, and of the body's size: a witness point this near another feature lies on both."""
