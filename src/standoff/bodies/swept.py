"""A body's core, swept by another ball."""

from __future__ import annotations

from dataclasses import replace

from standoff.bodies.body import Body
from standoff.checks.numbers import magnitude_or_zero
from standoff.kernels.body import layout as L


def with_radius(body: Body, radius: float) -> Body:
    """Return the same core, swept by a ball of another radius: the packed numbers are those of a
    body that is made with it, in a hundredth of the time.

    Raises ValueError: a radius that is negative, not finite, beyond 1e50, or between 0 and 1e-50.

    Parameters
    ----------
    body : Body
    radius : float
        Length, zero or above.
    """
    radius = magnitude_or_zero(radius, "radius")
    reals = body.reals.copy()
    reals[L.RADIUS] = radius
    reals.flags.writeable = False
    size = float(reals[L.SIZE]) + 2.0 * radius if body.bounded else body.size
    report = replace(body.report, size=size)
    return replace(body, radius=radius, reals=reals, size=size, report=report)
