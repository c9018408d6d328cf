"""Tolerances of robots, each with its unit and reason."""

QUATERNION_LENGTH = 1e-6
"""By how much the length of a quaternion in q may differ from 1, no unit: more than the rounding of
float32 and of integration, less than a number that was forgotten. It is then made 1."""

TURN_LOST = 1e-12
"""Angular velocity by unit velocity of a joint, no unit, below which it does not turn a pair about
an axis: the roundoff of a chain of joints."""
