"""Tolerances of the proofs along joint paths and over boxes, each with its unit and reason."""

from __future__ import annotations

from typing import Final

ASKED_CLEARANCE: Final = 5e-3
"""That a proof asks of every pair where nothing else is said, length: 5 mm of a robot in metres."""

KINEMATICS_ROUNDINGS: Final = 64.0
"""Roundings (eps) of the lengths of a robot, for each joint and one: a joint's turn and the two
products that pass it on take some twenty; the package's own kinematics need no more."""

PATH_ROUNDINGS: Final = 8.0
"""Roundings (eps) of a path's times and joint positions, each worth the way that it makes: the
products and sums of an interpolation."""

BOUND_INFLATION: Final = 1e-9
"""By so much (relative) each bound of a motion is raised: the sums of some hundred products that it
is made of lose 1e-14, and a sine of an angle that is nearly zero 1e-8 of a bound that is not."""

REACH_ROUNDOFF: Final = 1e-12
"""Part of the robot's lengths that is added to each distance from an axis (relative): its own
roundoff, where the distance is nearly zero."""

SAME_KINEMATICS: Final = 1e-9
"""Part of the robot's lengths within which the joints as read and the package's own kinematics must
place a geom alike (relative): rounding leaves 1e-15; more is a joint that was read wrongly, of
which no bound would hold."""

SHORTEST_STEP: Final = 1e-6
"""Share of a path's duration: shorter steps are not tried, and the path is undecided there. A dip
of d below the clearance lasts for about √d: one of 1e-9 is found."""

BRACKET: Final = 1e-4
"""Share of a path's duration between an instant up to which all is proven and one at which a pair
is proven to be nearer than the clearance: halving it once more costs as much as a step."""

SMALLEST_SIDE: Final = 1e-6
"""Share of a box's sides: smaller boxes are not split."""

SPEED_SLACK: Final = 1e-9
"""By so much (relative) a path that is given with its greatest speeds may be faster between two
instants that are looked at: the roundings of the function that gives it."""

LIMIT_SLACK: Final = 1e-9
"""By so much (relative, and in radians or lengths at 1) a joint may be outside its limits: what is
left when a configuration that is on them has been interpolated or read from a file."""
