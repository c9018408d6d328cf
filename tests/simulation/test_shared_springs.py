"""Energy that springs of contacts hold by being shared anew, and that no force has given them."""

from __future__ import annotations

import numpy as np
import pytest

import standoff as so
from standoff.simulation import HuntCrossley, Operator, RigidBody, System, SystemRun, solve
from standoff.solids import Solid

STIFFNESS, DEPTH = 1e5, 1e-4
LAW = HuntCrossley(stiffness=STIFFNESS, damping=0.3, depth=5.0 * DEPTH)
TABLE, SIDE = (0.4, 0.4, 0.1), 0.1
SPAN = 0.1 * np.sqrt(3.0) * SIDE
"""Within which a cube's spots share a spring: a tenth of its diagonal."""


def moved(size: tuple[float, float, float], mass: float, pose: so.Pose, v: list[float],
          ticks: int, dt: float = 1e-4) -> SystemRun:  # fmt: skip
    """A box over a table whose top is at z = 0, without gravity or friction."""
    table = RigidBody.fixed(Solid(so.shapes.box(*TABLE)), so.Pose(np.eye(3), [0.0, 0.0, -0.05]))
    box = Solid(so.shapes.box(*size))
    free = RigidBody.free(box, mass=mass, pose=pose, twist=so.Twist(v, [0.0, 0.0, 0.0]))
    operator = Operator(System([table, free], LAW, gravity=[0.0, 0.0, 0.0]), dt)
    return operator.run(operator.start(allow_overlap=True), ticks, 1)


def test_a_cube_that_leaves_a_table_shares_its_springs() -> None:
    """So heavy that it hardly rises, it slides past the edge. Its hind corners stay, and where its
    sides cross the edge there are two spots more; as all four come together, in pairs, they are
    worth two springs in place of four."""
    left = 0.02
    start = so.Pose(np.eye(3), [0.2 + 0.5 * SIDE - left, 0.0, 0.5 * SIDE - DEPTH])
    run = moved((SIDE, SIDE, SIDE), 1e7, start, [0.1, 0.0, 0.0], 1900)
    energy = run.energy
    assert (run.spots == 4).all()
    assert run.uncertified == run.jumps == 0
    assert run.distances == pytest.approx(-DEPTH, rel=1e-4)
    strip = left - (run.positions(1)[:, 0] - start.translation[0])
    near = np.maximum(1.0 - (strip / SPAN) ** 2, 0.0) ** 2
    whole = 0.4 * STIFFNESS * DEPTH**2.5
    held = 4.0 * whole / (1.0 + near)
    assert held[-1] < 2.02 * whole < held[0]
    np.testing.assert_allclose(energy.stored, held, rtol=1e-3)
    np.testing.assert_allclose(energy.shared, held - held[0], rtol=0.0, atol=2e-3 * whole)


def test_springs_that_are_not_shared_gain_nothing() -> None:
    """A cube comes down on an edge and then, turned back, on the other one: spots begin and end at
    the surface."""
    tilt = so.Pose.exp([0.0, 0.1, 0.0]).rotation
    low = (np.abs(tilt[2]) * 0.5 * SIDE).sum()
    run = moved((SIDE, SIDE, SIDE), 2.0, so.Pose(tilt, [0.0, 0.0, low + 1e-4]),
                [0.0, 0.0, -0.05], 12_000, 2e-5)  # fmt: skip
    energy, spots = run.energy, run.spots[:, 0]
    changes = spots[np.flatnonzero(np.diff(spots)) + 1]
    np.testing.assert_array_equal(changes, [2, 0, 2, 0])
    assert run.uncertified == run.jumps == 0
    assert energy.stored.max() > 1e-3
    assert np.abs(energy.shared).max() < 1e-3 * energy.stored.max()
    assert np.ptp(energy.balance) < 1e-2 * energy.stored.max()


ROUGH = HuntCrossley(stiffness=1e5, friction=0.3, slip_speed=0.02, depth=1e-3)


def dropped(body: so.Body, v: tuple[float, float, float]) -> System:
    """A convex body that falls on a plate, tilted, so that it claps onto its face and up again."""
    plate = RigidBody.fixed(so.shapes.box(0.6, 0.6, 0.1), so.Pose(np.eye(3), [0.0, 0.0, -0.05]))
    pose = so.Pose(so.Pose.exp([0.03, 0.0, 0.0]).rotation, [0.0, 0.2, 0.04])
    free = RigidBody.free(body, density=2700.0, pose=pose, twist=so.Twist(v, [1.0, 0.5, 0.0]))
    return System([plate, free], ROUGH)


@pytest.mark.parametrize("body", [so.shapes.cone(0.03, 0.06), so.shapes.cylinder(0.02, 0.06)])
def test_what_flat_contacts_share_is_booked(body: so.Body) -> None:
    """What is left of the balance is the step's error: half as much in half a step."""
    off = []
    for dt in (4e-5, 2e-5):
        operator = Operator(dropped(body, (0.3, 0.2, -0.3)), dt)
        run = operator.run(operator.start(), round(0.2 / dt), every=10)
        off.append(np.ptp(run.energy.balance) / run.energy.kinetic.max())
        shared = np.ptp(run.energy.shared) / run.energy.kinetic.max()
    assert shared > 0.02
    assert off[1] < 0.25 * shared
    assert off[1] < 0.65 * off[0]


def test_an_adaptive_method_books_it_too() -> None:
    found = solve(dropped(so.shapes.cone(0.03, 0.06), (0.0, 0.0, -0.3)), duration=0.1)
    energy = found.run.energy
    assert np.ptp(energy.shared) > 0.02 * energy.kinetic.max()
    assert np.ptp(energy.balance) < 0.1 * np.ptp(energy.shared)
