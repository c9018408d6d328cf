"""Tolerances of robots, each with its unit and reason."""

UNIT_LENGTH = 1e-3
"""By how much the length of a quaternion, or of (cos, sin), in q may differ from 1, no unit: as of
a pose's quaternion. It is then made 1."""

TURN_LOST = 1e-12
"""Angular velocity by unit velocity of a joint, no unit, below which it does not turn a pair about
an axis: the roundoff of a chain of joints."""

FIRST_HORIZON = 0.1
"""Part of the size of all bodies together within which the nearest pair is sought first, no unit:
arms among obstacles mostly have one there. The answer does not depend on it."""

WIDER = 8.0
"""Factor from one horizon to the next while no pair is found, no unit: the bodies are within a few
of them, and each costs a world that is kept."""

SAME_READING = 1e-9
"""By how much a size or place in what a package read of a file may differ from the file, length or
no unit, relative to 1 and to itself: rounding leaves 1e-15; more is another number."""

UNLIMITED = 1e30
"""Limits of q beyond this, rad or length, are none: packages write large numbers for them."""

RATE_LOST = 1e-6
"""By how much a velocity of a `SafetyFilter` may miss a row, as a part of 1 and the greatest right
side, length per time: the precision of the quadratic programming solvers (DAQP's is 1e-6). One
that misses by more is refused as infeasible."""

CONTACT_HORIZON = 0.01
"""How far beyond the margins of contacts pairs are followed, as a part of the smallest body's
size, no unit: what is about to touch starts warm. The contacts do not depend on it."""

LEAST_FRICTION = 1e-5
"""MuJoCo's mjMINMU, a coefficient of friction, no unit: it makes a lesser one this."""

TIED = 1e-10
"""Distances of two pairs of pieces that differ by less, length, are one: their roundoff, where the
bodies are not greater than some metres."""

TIED_APART = 1e-7
"""Part of 1 and the greatest derivative by which those of two equally near pairs of pieces may
differ: their roundoff, where these are one smooth surface in two pieces."""
