"""A key and its lock: a bitted outline, extruded, and a plate with a keyway that is wider by a
play; and a hand that pushes the one into the other."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

import standoff as so
from standoff import simulation as sim
from standoff.geometry import Line
from standoff.solids import Solid
from standoff_studies.machines.prisms import extruded

Array = NDArray[np.float64]

BITTED = (
    *((-4.0, -1.5), (-1.2, -1.5), (-0.8, -0.6), (0.2, -0.6), (0.6, -1.5), (4.0, -1.5)),
    *((4.0, 1.5), (3.2, 1.5), (2.4, 0.6), (1.8, 0.6), (1.0, 1.5), (0.4, 1.5), (-0.4, 0.2)),
    *((-1.0, 0.2), (-1.9, 1.2), (-2.6, 1.2), (-3.2, 0.8), (-4.0, 0.8)),
)
"""Corners of a blade's section, millimetres, counterclockwise: three cuts above, a ward below."""

LENGTH, LOCK_SIDE, LOCK_DEPTH = 0.025, 0.02, 0.012
"""Of the blade, and of the plate and its keyway, metres."""
WITHIN = 0.004
"""How far the blade is in its keyway at the start, metres."""
ASIDE = (2.5e-4, 1e-4)
"""How far the hand is beside the keyway once it holds, metres: it presses on two walls."""
HELD_AFTER = 0.02
"""s."""
STIFFNESS = 400.0
"""Of the hand, N/m."""
FRICTION = 0.1


class Pushed(NamedTuple):
    """A key on its coupler, engaged at the start, and what the hand does."""

    operator: sim.Operator
    hand: sim.DeviceReadings


def outline(apart: float = 0.0) -> Array:
    """(n, 2) corners of the section, metres, its sides moved outwards by a length."""
    corners = 1e-3 * np.array(BITTED)
    along = np.roll(corners, -1, axis=0) - corners
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    out = np.stack([along[:, 1], -along[:, 0]], axis=1)
    before = np.roll(out, 1, axis=0)
    # A corner goes along the bisector, so that it is as far from both of its sides.
    shift: Array = (before + out) / (1.0 + np.sum(before * out, axis=1, keepdims=True))
    return corners + apart * shift


def key(length: float) -> Solid:
    """The blade, from z = 0 upwards."""
    return extruded(so.PlanarSolid.from_loops(_polygon(outline()), name="key"), 0.0, length)


def lock(play: float, side: float, depth: float) -> Solid:
    """A square plate of a side, from z = -depth to 0, with a keyway that is wider than the blade by
    a play, on all of its sides."""
    half = 0.5 * side
    plate = [(-half, -half), (half, -half), (half, half), (-half, half)]
    around = so.PlanarSolid.from_loops(_polygon(plate), [_polygon(outline(play))], name="lock")
    return extruded(around, -depth, 0.0)


def pushed(play: float, speed: float, ticks: int, dt: float) -> Pushed:
    """A key of 50 g in a hand that goes down at a speed, m/s, and presses aside."""
    start = so.Pose(np.eye(3), (1e-6, 0.0, -WITHIN))
    # 9 N s/m is critical for 50 g, so that the key does not rattle on its way.
    coupler = sim.VirtualCoupler(
        stiffness=STIFFNESS, damping=9.0, rotational_stiffness=2.0, rotational_damping=5e-3,
        max_force=10.0, max_torque=1.0, max_age=0.01, engage_time=0.5 * HELD_AFTER,
    )  # fmt: skip
    law = sim.HuntCrossley(
        stiffness=5e5, damping=20.0, friction=FRICTION, slip_speed=0.2 * speed, depth=3e-5
    )
    plate = sim.RigidBody.fixed(lock(play, LOCK_SIDE, LOCK_DEPTH))
    blade = sim.RigidBody.free(key(LENGTH), mass=0.05, pose=start)
    system = sim.System([plate, blade], law, gravity=[0, 0, 0], coupler=coupler, tool=1)
    operator = sim.Operator(system, dt)
    down = so.Twist((0.0, 0.0, -speed), (0.0, 0.0, 0.0))

    def hand(t: float) -> so.Pose:
        aside = min(t / HELD_AFTER, 1.0) * np.array(ASIDE)
        return so.Pose(np.eye(3), (1e-6 + aside[0], aside[1], -WITHIN - speed * t))

    period = dt * operator.ticks_a_reading
    readings = [
        sim.DeviceReading(k * period, k, hand(k * period), down, valid=True)
        for k in range(ticks // operator.ticks_a_reading)
    ]
    return Pushed(operator, sim.DeviceReadings(readings))


def _polygon(corners: ArrayLike) -> list[Line]:
    flat = np.asarray(corners, dtype=float)
    spots = np.column_stack([flat, np.zeros(len(flat))])
    return [Line(p, q) for p, q in zip(spots, np.roll(spots, -1, axis=0), strict=True)]
