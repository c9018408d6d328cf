"""Systems that several tests simulate."""

from __future__ import annotations

from typing import Any

import numpy as np

import standoff as so
from standoff import simulation as sim

FLOOR = so.shapes.halfspace()
G = 9.81


def on_floor(body: so.Body, contact: sim.HuntCrossley, gravity: Any = None, **free: Any) -> Any:
    """A body above the plane z = 0."""
    falling = sim.RigidBody.free(body, density=1000.0, **free)
    field = (0.0, 0.0, -G) if gravity is None else gravity
    return sim.System([sim.RigidBody.fixed(FLOOR), falling], contact, gravity=field)


def upright(z: float, x: float = 0.0) -> so.Pose:
    return so.Pose(np.eye(3), [x, 0.0, z])
