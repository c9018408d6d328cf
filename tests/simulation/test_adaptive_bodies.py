"""Rigid bodies by SciPy's adaptive methods: closed forms, the operator, events, refusals."""

from __future__ import annotations

import numpy as np
import pytest
from scenes_with_contact import FLOOR, G, on_floor, upright

import standoff as so
from standoff import simulation as sim
from standoff.solids import Solid

NONE = sim.HuntCrossley(stiffness=1.0)


def free_top(spin: np.ndarray) -> sim.System:
    """A cylinder without forces, spinning."""
    twist = so.Twist([0.0, 0.0, 0.0], spin)
    top = sim.RigidBody.free(so.shapes.cylinder(0.1, 0.4), mass=1.0, twist=twist)
    return sim.System([top], NONE, gravity=[0, 0, 0])


@pytest.mark.parametrize("method", ["DOP853", "RK45", "LSODA"])
def test_a_free_top_precesses_as_its_closed_form_says(method: str) -> None:
    """R(t) = exp(t L / I) exp(t (1 - J / I) w_3 e_3), over many charts."""
    spin = np.array([2.0, 0.0, 9.0])
    system = free_top(spin)
    found = sim.solve(system, duration=5.0, method=method, tolerance=1e-11, max_step=1.0)
    mass = system.bodies[0].mass_properties
    assert mass is not None
    across, along = mass.inertia[0, 0], mass.inertia[2, 2]
    momentum = mass.inertia @ spin
    R = found.run.rotations(0)
    for t, turned in zip(found.run.times, R, strict=True):
        first = so.Pose.exp(t * momentum / across).rotation
        second = so.Pose.exp([0.0, 0.0, t * (1.0 - along / across) * spin[2]]).rotation
        assert turned == pytest.approx(first @ second, abs=2e-8)
    # some forty radians, in charts of 1.5
    assert np.abs(R @ R.transpose(0, 2, 1) - np.eye(3)).max() < 1e-15 * 4
    assert found.run.angular_momenta(0)[-1] == pytest.approx(momentum, abs=1e-15)
    assert np.ptp(found.run.energy.kinetic) < 1e-8 * found.run.energy.kinetic[0]


def test_it_is_the_operators_motion_in_contact() -> None:
    """Of order four inside with 1024 steps, whose own error is 1e-16 times their order's."""
    contact = sim.HuntCrossley(stiffness=2e4, damping=0.3, friction=0.3, slip_speed=0.5, depth=0.02)
    upper = sim.RigidBody.free(
        so.shapes.ellipsoid([0.15, 0.2, 0.1]),
        density=1000.0,
        pose=so.Pose.exp([0.3, -0.2, 0.4], [0.03, 0.02, 0.3]),
        twist=so.Twist([0.3, 0.2, 0.0], [1.0, -2.0, 0.5]),
    )
    lower = sim.RigidBody.fixed(so.shapes.ellipsoid([0.4, 0.3, 0.2]))
    system = sim.System([lower, upper], contact)
    found = sim.solve(system, duration=0.02, tolerance=1e-12, allow_overlap=True).run
    operator = sim.Operator(system, 0.02 / 1024, method="rk4", tracker="inside", gain=100.0)
    run = operator.run(operator.start(allow_overlap=True), 1024, every=1024)
    for name in ("rotations", "positions", "velocities", "angular_velocities"):
        difference = getattr(found, name)(1)[-1] - getattr(run, name)(1)[-1]
        assert np.abs(difference).max() < 1e-12, name
    assert np.ptp(found.energy.balance) < 1e-12 * abs(found.energy.balance[0])
    assert found.energy.dissipated[-1] == pytest.approx(run.energy.dissipated[-1], rel=1e-9)


def test_a_ball_touches_and_leaves_as_its_restitution_says() -> None:
    contact = sim.HuntCrossley(stiffness=1e7, damping=0.3)
    twist = so.Twist([0.0, 0.0, -1.0], [0.0, 0.0, 0.0])
    system = on_floor(so.shapes.sphere(0.1), contact, np.zeros(3), pose=upright(0.11), twist=twist)
    found = sim.solve(system, duration=0.02, max_step=1e-3)
    assert [event.kind for event in found.events] == ["contact", "release"]
    assert found.events[0].time == pytest.approx(0.01, abs=1e-12)
    assert found.run.velocities(1)[-1, 2] == pytest.approx(contact.restitution(1.0), rel=1e-6)
    assert found.run.energy.dissipated[-1] == pytest.approx(
        0.5 * 1000.0 * 4.0 / 3.0 * np.pi * 1e-3 * (1.0 - contact.restitution(1.0) ** 2), rel=1e-6
    )


def test_switches_of_a_flying_body_are_located() -> None:
    """A point that flies past a box's upper face switches over its edges."""
    flying = sim.RigidBody.free(
        so.shapes.point(),
        mass=1.0,
        inertia=np.eye(3),
        pose=so.Pose(np.eye(3), [-1.03, 0.1, 0.8]),
        twist=so.Twist([1.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
    )
    box = sim.RigidBody.fixed(so.shapes.box(1.0, 1.0, 1.0))
    system = sim.System([box, flying], NONE, gravity=[0, 0, 0])
    events = sim.solve(system, duration=2.0).events
    assert [event.kind for event in events] == ["switch", "switch"]
    assert [event.time for event in events] == pytest.approx([0.53, 1.53], abs=1e-9)
    assert events[0].source.startswith("edge")
    assert events[0].target.startswith("face")


def test_a_box_falls_flat_and_rests_on_four_corners() -> None:
    contact = sim.HuntCrossley(
        stiffness=1e7, damping=30.0, friction=0.5, slip_speed=2e-3, depth=1e-3
    )
    system = on_floor(so.shapes.box(0.2, 0.3, 0.1), contact, pose=upright(0.0505))
    found = sim.solve(system, duration=0.5, method="LSODA", tolerance=1e-10).run
    weight = 1000.0 * 0.2 * 0.3 * 0.1 * G
    sunk = (weight / 4e7) ** (2.0 / 3.0)
    assert found.positions(1)[-1, 2] == pytest.approx(0.05 - sunk, abs=2e-2 * sunk)
    assert found.spots[-1, 0] == 4
    assert np.abs(found.angular_velocities(1)).max() < 1e-9
    assert 0.0 < found.deepest < 1e-3
    assert found.uncertified == 0


def test_a_driven_body_pushes_and_what_it_gives_is_told() -> None:
    """A floor that rises at 1 m/s meets a ball at rest: both frames see one impact."""
    contact = sim.HuntCrossley(stiffness=1e7, damping=0.3)
    rising = so.motion.ConstantTwist(so.Pose.identity(), so.Twist([0, 0, 1.0], [0, 0, 0]))
    floor = sim.RigidBody.driven(FLOOR, rising)
    ball = sim.RigidBody.free(so.shapes.sphere(0.1), density=1000.0, pose=upright(0.11))
    system = sim.System([floor, ball], contact, gravity=[0, 0, 0])
    found = sim.solve(system, duration=0.02, max_step=1e-3, tolerance=1e-10)
    assert found.events[0].time == pytest.approx(0.01, abs=1e-12)
    after = 1.0 + contact.restitution(1.0)
    assert found.run.velocities(1)[-1, 2] == pytest.approx(after, rel=1e-6)
    balance = found.run.energy.balance
    assert np.ptp(balance) < 1e-7 * found.run.energy.supplied[-1]


def test_what_a_system_cannot_be_given_is_refused() -> None:
    system = on_floor(so.shapes.sphere(0.1), sim.HuntCrossley(stiffness=1e6), pose=upright(0.09))
    with pytest.raises(so.StandoffError, match=r"overlap at the start, by 0\.01"):
        sim.solve(system, duration=0.01)
    with pytest.raises(so.StandoffError, match=r"theta = .* leave it out"):
        sim.solve(system, [0.0], duration=0.01)  # type: ignore[call-overload]
    with pytest.raises(so.StandoffError, match="duration"):
        sim.solve(system)  # type: ignore[call-overload]
    with pytest.raises(so.StandoffError, match="method"):
        sim.solve(system, duration=0.01, method="RK4")
    with pytest.raises(so.StandoffError, match="GeneralisedSystem or a System"):
        sim.solve(7, duration=0.01)  # type: ignore[call-overload]
    coupler = sim.VirtualCoupler(stiffness=100.0, damping=0.1, max_force=5.0, max_age=3e-3)
    coupled = sim.System(system.bodies, sim.HuntCrossley(stiffness=1e6), coupler=coupler, tool=1)
    with pytest.raises(so.StandoffError, match="has a coupler"):
        sim.solve(coupled, duration=0.01)


def test_solids_are_refused() -> None:
    """Their places of contact go on from tick to tick, which an adaptive method has not."""
    box = Solid(so.shapes.box(0.1, 0.1, 0.1))
    bodies = [sim.RigidBody.fixed(box), sim.RigidBody.free(box, mass=1.0, pose=upright(0.2))]
    with pytest.raises(so.StandoffError, match="pair with a Solid"):
        sim.solve(sim.System(bodies, NONE), duration=0.01)
