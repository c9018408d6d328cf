"""Which couplers a system's step follows: the tool's own motion on the coupler's spring."""

from __future__ import annotations

import numpy as np

from standoff.errors import StandoffError
from standoff.simulation import stability
from standoff.simulation.system import System


def check_tool(system: System, dt: float, method: str) -> None:
    """Refuse a coupler on whose spring the tool's motion would grow by the step alone.

    Raises StandoffError: the message gives the largest stable stiffness.
    """
    coupler, tool = system.coupler, system.tool
    if coupler is None or tool is None:
        return
    mass = system.bodies[tool].mass_properties
    assert mass is not None, "a tool is free"
    turning = 1.0 / float(mass.principal_moments[0])
    # the coupler holds the tool at its origin
    pushed = 1.0 / mass.mass + float(np.dot(mass.centre, mass.centre)) * turning
    for kind, give in (("", pushed), ("rotational_", turning)):
        stiffness = float(getattr(coupler, f"{kind}stiffness"))
        damping = float(getattr(coupler, f"{kind}damping"))
        if stability.is_stable_held(method, give * stiffness, give * damping, dt):
            continue
        largest = stability.largest_coupled_stiffness(damping, method, dt, give)
        cure = (
            f"the largest stable one is {largest:.4g}"
            if largest > 0.0
            else f"with {kind}damping = {damping:g} none is stable"
        )
        raise StandoffError(
            f"{kind}stiffness = {stiffness:g} of the coupler, held over a step, is beyond what "
            f"{method} follows at dt = {dt:g} with a tool that gives by {give:.4g} (one over its "
            f"mass or least inertia): {cure}. Take a shorter step, or a heavier tool.",
            f"{kind}stiffness",
            stiffness,
        )
