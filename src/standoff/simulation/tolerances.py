"""Tolerances of mass, contact and motion: each with its unit and its reason."""

from typing import Final

STIFFNESS_FOUND: Final = 1e-6
"""Relative: how near the largest stable stiffness is found."""

RIM_GAP: Final = 1e-9
"""Radians: an arc that is short of a full turn by less than this is a rim."""

EVENT_INSTANT: Final = 1e-12
"""Part of the duration to which a switch is located: the tracker's own answers carry no more."""

SINGULAR_INERTIA: Final = 1e-12
"""Least eigenvalue of M over its greatest, a ratio: below it no digit of θ'' is known to four
places."""

SYMMETRIC_INERTIA: Final = 1e-9
"""Part of its greatest entry by which M's entries across the diagonal may differ: roundoff of
whoever computed them."""

DAMPING_ROUNDING: Final = 1e-12
"""No unit. The damping needed may exceed the damping there is by this part, so that the largest
stiffness, which an error gives, is accepted when it is used."""

TOUCHING_START: Final = 1e-9
"""Part of the smaller body's size: a start that overlaps by no more than this touches, to
roundoff."""

INERTIA_ROUNDOFF: Final = 1e-12
"""Relative: two entries across an inertia's diagonal count as equal if they differ by no more than
this part of the largest, and a moment above the sum of the others by no more counts as equal to it:
roundoff of whoever computed them."""

MOMENTS_END: Final = 1e-11
"""Relative: where refinement ends: remainders over the volume, its reach and its reach squared."""

LEAST_MOMENT: Final = 1e-15
"""Relative: a least principal moment below this part of the largest is roundoff of zero: that of a
rod 3e-8 of its length wide."""

STABLE_ROUNDING: Final = 1e-12
"""No unit, of the spectral radius: a step that grows by no more is stable, to the roundoff of its
eigenvalues."""

LEAST_STABLE: Final = 1e-14
"""Relative: where the search for a stable stiffness gives up, because there is none."""

SHARED_END: Final = 1e-9
"""Relative to a face's reach: corners nearer than this are the shared end of two edges."""

STIFFNESS_ROUNDING: Final = 1e-9
"""Relative: the damping needed by the stiffness found may exceed the damping there is by this part,
since the search ends there."""

NO_DAMPING: Final = 1e-300
"""N s/m, parts of the least damping: keeps the comparison true where both are zero."""

FIRST_FREQUENCY: Final = 1e-3
"""Part of the first interval of the grid of frequencies, where the search for the greatest damping
needed begins: at zero itself the expression is 0 / 0."""

PEAK_FOUND: Final = 1e-10
"""Radians (frequency times the period): to which the frequency of the greatest damping needed is
found."""

CHART_SERIES: Final = 1e-3
"""Radians, half the angle of a chart: below it two terms of the series for J_r⁻¹ miss it by less
than 1e-12 of a third-order term, and the closed form loses digits."""

BALL_SLACK: Final = 1e-6
"""Relative, of the radius of a ball and of the horizon: how much greater the search for near pairs
takes them, so that the bound of a pair that it leaves out exceeds the horizon although a rotation
may miss being orthonormal by 1e-9 (``kernels.tolerances.ROTATION``) and lengths are rounded."""

UNSEEN_PART: Final = 0.25
"""Part of the least side of the box around the thinner of two bodies: how deep a tick may have
hidden them in each other, at most, before it is counted; who crosses it is in it by half of that
side."""
