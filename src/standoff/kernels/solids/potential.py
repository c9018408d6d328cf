"""Potentials: functions that change by no more than the distance of two points (1-Lipschitz)."""

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.compiler.decorators import small


@small
def circle_distance(k, t, z):
    """The signed distance of (t, z) from the circle of curvature k that touches the t-axis at the
    origin from below; z for k = 0. No cancellation."""
    w = k * (t * t + z * z) + 2.0 * z
    return w / (1.0 + sqrt(max(0.0, 1.0 + k * w)))
