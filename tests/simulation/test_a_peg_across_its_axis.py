"""A peg that goes across the axis of its hole is in contact on the other side.

Near the axis the common normal goes half way round the hole while the peg moves by micrometres,
through leaves of both walls that have rested. Truth is a search from nothing at the same state.
"""

from __future__ import annotations

import numpy as np
import pytest

import standoff as so
from families import solid_shapes
from standoff import simulation as sim
from standoff.simulation import SystemState

PERIOD, CROSSING, TICKS = 1e-3, 0.2, 320
DEPTH = 2e-4


def hand(off_axis: float) -> sim.DeviceReadings:
    """Pressed to one side, then across the axis, by so much beside it, to the other one."""

    def pose(t: float) -> so.Pose:
        way = np.cos(0.5 * np.pi * t / CROSSING) * np.sin(0.5 * np.pi * min(t / 0.1, 1.0))
        tilt = so.Pose.exp([0.0, 4e-3 * way, 0.0])
        return so.Pose(tilt.rotation, [4e-4 * way, off_axis, 0.003])

    return sim.DeviceReadings.along(pose, TICKS, PERIOD)


def in_its_hole(off_axis: float) -> sim.Operator:
    """A peg of 20 mm with a play of 10 µm, on a virtual coupler."""
    hole, peg = solid_shapes.tube(0.01001, 0.04, 0.0, 0.04), solid_shapes.peg(0.01, 0.0, 0.06)
    sampling = sim.Sampling(period=PERIOD, device_damping=1.0, device_rotational_damping=0.01)
    coupler = sim.VirtualCoupler(
        stiffness=800.0, damping=0.5, rotational_stiffness=2.0, rotational_damping=2e-3,
        max_force=20.0, max_torque=1.0, max_age=0.01, sampling=sampling,
    )  # fmt: skip
    law = sim.HuntCrossley(stiffness=1e5, damping=5.0, friction=0.1, slip_speed=0.05, depth=DEPTH)
    start = so.Pose(np.eye(3), [0.0, off_axis, 0.003])
    bodies = [sim.RigidBody.fixed(hole), sim.RigidBody.free(peg, mass=0.3, pose=start)]
    system = sim.System(bodies, law, gravity=[0, 0, 0], coupler=coupler, tool=1)
    return sim.Operator(system, PERIOD)


def test_a_peg_across_its_axis_is_in_contact_again() -> None:
    off_axis = 1e-6
    operator = in_its_hole(off_axis)
    run = operator.run(operator.start().engage(), TICKS, device=hand(off_axis))
    assert run.uncertified == run.jumps == 0
    # it has been pressed to both sides
    assert run.positions(1)[150, 0] > 2e-5
    assert run.positions(1)[-1, 0] < -2e-5
    for k in range(210, TICKS + 1, 10):
        [cold] = operator.contacts(SystemState(operator.system, run.states[k]))
        least = min(place.distance for place in cold.places)
        assert least < 0.0
        assert run.distances[k, 0] == pytest.approx(least, abs=1e-9), k
    assert run.spots[210:, 0].min() >= 1
