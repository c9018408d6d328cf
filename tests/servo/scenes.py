"""A ball over a lens, joined to a handle that knocks at it: what servos run here."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

import standoff as so
from standoff import simulation as sim

PERIOD = 2e-3
"""s, of the loops of these tests: half of what a lab runs, for machines that others use too."""


def knocking(t: float) -> so.Pose:
    """In circles over the lens, down to it twice a second."""
    height = 0.058 + 0.012 * np.cos(4.0 * np.pi * t)
    return so.Pose(np.eye(3), [0.02 * np.sin(1.7 * t), 0.02 * np.cos(2.3 * t), height])


def coupled(
    max_age: float = 0.05,
    period: float = PERIOD,
    stiffness: float = 1e5,
    made: Callable[[so.Body], Any] = lambda body: body,
) -> sim.Operator:
    """The operator of ball and lens, of what is made of both bodies."""
    coupler = sim.VirtualCoupler(
        stiffness=400.0, damping=0.5, max_force=20.0, max_age=max_age, engage_time=0.0
    )
    contact = sim.HuntCrossley(stiffness=stiffness, damping=2.0, depth=5e-4)
    lens = sim.RigidBody.fixed(made(so.shapes.lens(0.05, 0.0225)))
    ball = sim.RigidBody.free(made(so.shapes.sphere(0.01)), mass=0.2, pose=knocking(0.0))
    system = sim.System([lens, ball], contact, gravity=[0, 0, 0], coupler=coupler, tool=1)
    return sim.Operator(system, period)
