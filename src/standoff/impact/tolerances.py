"""Tolerances of the time of impact, each with its unit and reason."""

from __future__ import annotations

import sys
from typing import Final

TRACKER_SHARE: Final = 0.1
"""The tracker's own gap may be this part of the tolerance."""

TRACKER_TOLERANCE: Final = 1e-10
"""The tracker's gap (relative) is never looser than this, its default: a bound that comes too late
costs more steps than a sharp one."""

AIM: Final = 0.3
"""The search aims at a gap of this part of the tolerance, so that it ends a little before."""

LEAST_TOLERANCE: Final = 8.0
"""The tolerance (length) is at least so many times what rounding of the poses and of time may
do."""

NEIGHBOURS: Final = 4.0
"""Times within so many roundings (units in the last place) of each other have nothing useful
between them."""

SHORTEST_TIME: Final = sys.float_info.min
"""Nor have times this near [s]: below it floating point loses digits."""

POSE_ROUNDINGS: Final = 16.0
"""Roundings (eps) of each length that goes into a pose or a world point: the products of a rotation
with a point, and those that made the rotation."""

TIME_ROUNDINGS: Final = 4.0
"""Roundings (eps) of the time, each worth the way of the bodies in it: paths multiply rates by
it."""
