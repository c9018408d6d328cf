"""Bodies that lie on faces, edges and rims of others: they rest, tip over and do not rock."""

from __future__ import annotations

import numpy as np
import pytest
from scenes_with_contact import on_floor, upright

import standoff as so
from standoff import simulation as sim

FIRM = sim.HuntCrossley(stiffness=3e6, damping=2.0, friction=0.5, slip_speed=8e-3, depth=1e-3)
TABLE = so.shapes.box(1.0, 1.0, 0.1)
BRICK = so.shapes.box(0.2, 0.1, 0.05)


def on_table(body: so.Body, x: float, z: float) -> sim.SystemRun:
    """A body set down on a table whose upper face is z = 0, for half a second."""
    table = sim.RigidBody.fixed(TABLE, upright(-0.05))
    free = sim.RigidBody.free(body, density=1000.0, pose=upright(z, x))
    operator = sim.Operator(sim.System([table, free], FIRM), 5e-5)
    return operator.run(operator.start(), 10_000, every=100)


@pytest.mark.parametrize("overhang", [0.0, 0.04, 0.08])
def test_a_brick_stays_while_its_centre_is_over_the_table(overhang: float) -> None:
    run = on_table(BRICK, 0.4 + overhang, 0.025)
    assert run.spots[-1, 0] == 4
    assert np.abs(run.rotations(1)[-1] - np.eye(3)).max() < 1e-2
    assert np.abs(run.angular_velocities(1)[-1]).max() < 1e-2
    assert run.uncertified == 0


def test_a_brick_tips_where_its_centre_is_beyond_the_table() -> None:
    run = on_table(BRICK, 0.53, 0.025)
    assert run.rotations(1)[-1, 0, 0] < 0.9
    assert run.positions(1)[-1, 2] < 0.0


def test_a_stack_stands() -> None:
    bodies = [sim.RigidBody.fixed(so.shapes.halfspace())]
    for k in range(3):
        turn = so.Pose.exp([0.0, 0.0, 0.3 * k]).rotation
        pose = so.Pose(turn, [0.0, 0.0, 0.025 + 0.05 * k])
        bodies.append(sim.RigidBody.free(BRICK, density=1000.0, pose=pose))
    pairs = [(0, 1), (1, 2), (2, 3)]
    operator = sim.Operator(sim.System(bodies, FIRM, pairs), 5e-5)
    run = operator.run(operator.start(), 20_000, every=1000)
    for k in (1, 2, 3):
        assert run.positions(k)[-1, 2] == pytest.approx(0.05 * k - 0.025, abs=1e-3)
        assert np.abs(run.positions(k)[-1, :2]).max() < 1e-3
    # turned by 0.3 rad two rectangles of two to one share an octagon
    assert run.spots[-1].tolist() == [4, 8, 8]
    weight = 1000.0 * 0.2 * 0.1 * 0.05 * 9.81
    carried = run.forces[-1, :, 2]
    assert carried == pytest.approx(weight * np.array([3.0, 2.0, 1.0]), rel=5e-2)


@pytest.mark.parametrize("count", [1, 5])
def test_friction_under_a_load_gives_no_energy(count: int) -> None:
    """The lowest box bears nine times its own weight, for which the step was checked."""
    law = sim.HuntCrossley(stiffness=1e6, damping=2.0, friction=0.5, slip_speed=5e-3, depth=2e-3)
    bodies = [sim.RigidBody.fixed(so.shapes.box(2.0, 2.0, 0.2), upright(-0.1))]
    for k in range(count):
        pose = upright(0.1 * (k + 0.5) + 1e-4 * (k + 1), 0.005 * (k % 2))
        bodies.append(sim.RigidBody.free(so.shapes.box(0.2, 0.2, 0.1), density=1000.0, pose=pose))
    pairs = [(k, k + 1) for k in range(count)]
    operator = sim.Operator(sim.System(bodies, law, pairs), 1e-4)
    run = operator.run(operator.start(), 15_000, every=1000)
    energy = run.energy
    # what damping and impacts cost the method until it rests, a thousandth of a joule
    assert np.abs(energy.balance - energy.balance[0]).max() < 1e-3
    # the stack sways until then: what moves falls to a fifth in 0.2 s
    assert np.ptp(energy.balance[10:]) < 6e-7
    assert energy.kinetic[-1] < 6e-7
    # all friction is taken where the step bears it
    assert (run.eased > 0) == (count > 1)


def test_friction_of_an_impact_ends_a_slip_within_ticks() -> None:
    """A ball that hits the floor with a thousand times its weight, and slips a little there."""
    law = sim.HuntCrossley(stiffness=1e8, friction=1.0, slip_speed=2e-3, depth=1e-3)
    twist = so.Twist([1e-3, 0.0, -2.0], [0.0, 0.0, 0.0])
    system = on_floor(so.shapes.sphere(0.1), law, np.zeros(3), pose=upright(0.1), twist=twist)
    operator = sim.Operator(system, 2e-5)
    run = operator.run(operator.start(), 60, every=1)
    # the place of contact is in the middle of the overlap, a little nearer to the centre
    lever = 0.1 + 0.5 * run.distances[:, 0]
    slip = run.velocities(1)[:, 0] - lever * run.angular_velocities(1)[:, 1]
    assert run.eased > 0
    assert np.abs(slip).max() <= 1e-3 * (1.0 + 1e-9)
    assert np.abs(slip[-20:]).max() < 6e-7
    # it rolls now, as it would without any slip: 5/7 of its speed
    assert run.velocities(1)[-1, 0] == pytest.approx(5.0 / 7.0 * 1e-3, rel=1e-2)


def test_a_cylinder_stands_on_its_rim() -> None:
    system = on_floor(so.shapes.cylinder(0.1, 0.1), FIRM, pose=upright(0.05))
    operator = sim.Operator(system, 5e-5)
    run = operator.run(operator.start(), 10_000, every=100)
    weight = 1000.0 * np.pi * 0.01 * 0.1 * 9.81
    # twelve corners share four springs
    sunk = (weight / 12e6) ** (2.0 / 3.0)
    assert run.spots[-1, 0] == 12
    assert run.positions(1)[-1, 2] == pytest.approx(0.05 - sunk, abs=5e-2 * sunk)
    assert np.abs(run.angular_velocities(1)).max() < 1e-9


def test_a_run_is_the_same_again_and_in_parts() -> None:
    system = on_floor(BRICK, FIRM, pose=so.Pose(so.Pose.exp([0.3, 0.2, 0.1]).rotation, [0, 0, 0.2]))
    operator = sim.Operator(system, 5e-5, tracker="inside")
    start = operator.start()
    whole = operator.run(start, 6000, every=3000)
    again = operator.run(start, 6000, every=3000)
    assert np.array_equal(whole.states, again.states)
    half = operator.run(operator.run(start, 3000).final, 3000)
    assert np.array_equal(half.final.data[1:], whole.final.data[1:])


def test_the_law_inside_follows_bodies_that_pass_each_other() -> None:
    """Apart nothing corrects the parameters but the law: at its gain limit it still holds them."""
    fixed = sim.RigidBody.fixed(so.shapes.ellipsoid([0.3, 0.2, 0.1]))
    free = sim.RigidBody.free(
        so.shapes.ellipsoid([0.1, 0.2, 0.15]),
        mass=1.0,
        pose=so.Pose(np.eye(3), [-0.6, 0.1, 0.5]),
        twist=so.Twist([1.0, 0.0, 0.0], [0.5, 1.0, -0.7]),
    )
    system = sim.System([fixed, free], sim.HuntCrossley(stiffness=1.0), gravity=[0, 0, 0])
    for factor, allowed in ((0.5, 1e-5), (1.0, 1e-5), (1.9, 1e-4)):
        operator = sim.Operator(system, 1e-3, "rk4", "inside", gain=factor / 1e-3)
        run = operator.run(operator.start(), 1000, every=50)
        exact = [
            so.distance(fixed.body, free.body, fixed.pose, run.state(k).pose(1)).distance
            for k in range(len(run.times))
        ]
        assert np.abs(run.distances[:, 0] - exact).max() < allowed
    with pytest.raises(so.StandoffError, match="gain"):
        sim.Operator(system, 1e-3, "rk4", "inside", gain=2.8 / 1e-3)
