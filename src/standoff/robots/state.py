"""What a robot carries from configuration to configuration, as a value."""

from __future__ import annotations

from typing import NamedTuple

from standoff.robots.kinematics import GeometryMotion
from standoff.typing import Array
from standoff.world.state import WorldState


class RobotState(NamedTuple):
    """The warm start of a robot: goes into a step and comes out of it, never changed.

    Attributes
    ----------
    q : (nq,) array
    world : WorldState
    motion : GeometryMotion
    """

    q: Array
    world: WorldState
    motion: GeometryMotion
