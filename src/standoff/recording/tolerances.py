"""Tolerances of locating switches and of counting steps, each with its unit and reason."""

from __future__ import annotations

from typing import Final

from standoff.kernels.tolerances import SLOPE

INSTANT_RESOLUTION: Final = 1e-10
"""Part of the frame's step to which a switch's time is halved: 1e-13 s of a millisecond."""

INSTANT_ROUNDINGS: Final = 4.0
"""The same in roundings of the time itself (units in its last place), where that is more."""

SWITCH_PROOF: Final = 1e-7
"""The features this part of the step before and after a root must be the switch's own."""

PROOF_SLOPE: Final = 4.0 * SLOPE
"""The switching function (a sine) so far before and after, at least, where that is farther: below
the threshold of release itself either feature may be held."""

RATE_STENCIL: Final = 1e-5
"""Half width, in steps, of the difference that gives a switching function's rate."""

HELD_AT_REST: Final = 1e-14
"""A step that moves the witness points by less (relative to body sizes and distance) is the last:
some roundings of the witness points."""

FLAT_DIRECTION: Final = 1e-10
"""Singular values of H below this part of the greatest belong to flat directions, as between
parallel edges; the step is the shortest one."""

WHOLE_STEPS: Final = 1e-9
"""Part of a step by which a duration may miss a whole number of steps and still count as one.

0.3 / 0.1 is a little less than 3 in double precision; a duration of a million steps is off by a few
1e-10 of a step."""
