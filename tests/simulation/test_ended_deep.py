"""Places that ended while they were pressed: counted where their force ended with them."""

from __future__ import annotations

import numpy as np
import pytest
from benchmarks.solid_servo import coupled, hand

import standoff as so
from standoff.simulation import DeviceReadings, HuntCrossley, Operator, RigidBody, System
from standoff.solids import Solid
from standoff_studies.soak import solid_corners

DT = 1e-3


def test_places_that_merge_push_on() -> None:
    """A peg that is tilted in its hole is pressed at its rim, and at the hole's on the other side.
    For some ticks both are one place; each pushes on as a spot where it was, and none has ended."""
    begun, ticks, last = 15.4, 1320, 60
    operator = coupled(1.0 / DT)
    moved = DeviceReadings.along(lambda t: hand(begun + t), ticks, DT)
    run = operator.run(operator.start().engage(), ticks, 1, device=moved, contacts=True)
    contacts = [run.contacts(k)[0] for k in range(ticks - last, ticks + 1)]
    felt = np.array([sum(place.felt for place in each.places) for each in contacts])
    assert set(np.unique(felt)) == {1, 2}
    assert (run.spots[-last:] == 2).all()
    forces = run.forces[-last - 1 :, 0]
    change = np.linalg.norm(np.diff(forces, axis=0), axis=1)
    merged = np.diff(felt) < 0
    assert change[merged].max() < 1.5 * np.median(change)
    assert run.jumps == 0


def test_what_is_pressed_too_deep_goes_on() -> None:
    """Corners that come much deeper than eight times what the contact is meant for are kept: the
    cube stops where its energy is in four springs, and comes back with all of it."""
    law = HuntCrossley(stiffness=1e5, damping=0.0, depth=1e-4)
    plate, cube = so.shapes.box(0.4, 0.4, 0.1), so.shapes.box(0.1, 0.1, 0.1)
    mass, speed = 2.0, 0.2
    free = RigidBody.free(
        Solid(cube), mass=mass, pose=so.Pose(np.eye(3), [0.0, 0.0, 0.1001]),
        twist=so.Twist([0.0, 0.0, -speed], [0.0, 0.0, 0.0]),
    )  # fmt: skip
    bodies = [RigidBody.fixed(Solid(plate)), free]
    operator = Operator(System(bodies, law, gravity=[0.0, 0.0, 0.0]), 2e-5)
    run = operator.run(operator.start(), 2400, 1)
    assert (run.jumps, run.uncertified, run.crossings) == (0, 0, ())
    deepest = (1.25 * mass * speed**2 / (4.0 * law.stiffness)) ** 0.4  # 0.4 k d^2.5 of each
    assert deepest > 15.0 * law.depth
    assert run.deepest == pytest.approx(deepest, rel=1e-3)
    assert run.velocities(1)[-1] == pytest.approx([0.0, 0.0, speed], abs=1e-3 * speed)
    assert np.ptp(run.energy.balance) < 0.01 * run.energy.kinetic[0]


def test_a_contact_that_is_missed_in_a_tick_is_felt_in_the_next() -> None:
    """A drum is pressed into a hole so fast that in some ticks nothing of it is found. It does not
    sink: what is found again has been felt before."""
    found, _ = solid_corners.judged_press(22, 1, 1200)
    assert found.ticks == 1200  # it ends where a point is deeper than a fall explains
    assert found.overlaps > 20
