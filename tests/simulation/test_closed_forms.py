"""Simulated systems against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from scenes_with_contact import G, on_floor, upright

import standoff as so
from standoff import simulation as sim

FALLING = so.Twist([0.0, 0.0, -1.0], [0.0, 0.0, 0.0])


def ticks(time: float, dt: float, every: int) -> int:
    """Steps for a time, a multiple of `every`."""
    return every * round(time / dt / every)


@pytest.mark.parametrize("damping", [0.0, 0.2, 0.6])
@pytest.mark.parametrize("tracker", ["inside", "beside"])
def test_a_ball_leaves_a_wall_as_its_restitution_says(damping: float, tracker: str) -> None:
    contact = sim.HuntCrossley(stiffness=1e7, damping=damping, depth=4e-3)
    system = on_floor(
        so.shapes.sphere(0.1), contact, np.zeros(3), pose=upright(0.1005), twist=FALLING
    )
    operator = sim.Operator(system, 1e-5, tracker=tracker)
    run = operator.run(operator.start(), 2000, every=2000)
    assert run.velocities(1)[-1, 2] == pytest.approx(contact.restitution(1.0), rel=1e-6)
    assert run.uncertified == 0


def test_a_ball_bounces_as_high_as_its_restitution_says() -> None:
    contact = sim.HuntCrossley(stiffness=1e9, damping=0.2, depth=6e-4)
    drop = 0.05
    system = on_floor(so.shapes.sphere(0.1), contact, pose=upright(0.1 + drop))
    operator = sim.Operator(system, 5e-6)
    speed = np.sqrt(2.0 * G * drop)
    fall = speed / G
    # past the top of the first bounce
    run = operator.run(operator.start(), ticks(2.1 * fall, 5e-6, 20), every=20)
    height = run.positions(1)[:, 2] - 0.1
    after = run.times > 1.1 * fall
    wanted = contact.restitution(speed) ** 2 * drop
    # its weight works over the depth too, a hundredth of the drop
    assert height[after].max() == pytest.approx(wanted, rel=6e-3)
    assert run.deepest < 6e-4


def test_an_ellipsoid_rocks_with_its_period() -> None:
    a, c = 0.2, 0.1
    body = so.shapes.ellipsoid([a, a, c])
    # rolling keeps the lowest point: friction high enough that it does not slip
    contact = sim.HuntCrossley(stiffness=3e8, friction=0.9, slip_speed=2e-3, depth=1e-4)
    turn = so.Pose.exp([0.0, 0.02, 0.0]).rotation
    lowest = np.sqrt((c * turn[2, 2]) ** 2 + (a * turn[2, 0]) ** 2)
    weight = 1000.0 * 4.0 / 3.0 * np.pi * a * a * c * G
    sunk = (weight / 3e8) ** (2.0 / 3.0)
    system = on_floor(body, contact, pose=so.Pose(turn, [0.0, 0.0, lowest - sunk]))
    operator = sim.Operator(system, 2e-5)
    # a rolling body: I + m c² about the lowest point, m g (a²/c - c) of stiffness
    mass = system.bodies[1].mass_properties
    assert mass is not None
    inertia = mass.inertia[1, 1] + mass.mass * c * c
    period = 2.0 * np.pi * np.sqrt(inertia / (mass.mass * G * (a * a / c - c)))
    run = operator.run(operator.start(allow_overlap=True), ticks(2.2 * period, 2e-5, 50), every=50)
    tilt = run.rotations(1)[:, 0, 2]
    crossings = np.flatnonzero((tilt[:-1] > 0.0) & (tilt[1:] <= 0.0))
    at = run.times[crossings] + (run.times[1] - run.times[0]) * tilt[crossings] / (
        tilt[crossings] - tilt[crossings + 1]
    )
    assert np.diff(at)[0] == pytest.approx(period, rel=2e-3)


@pytest.mark.parametrize("slope", [0.1, 0.3])
def test_a_cylinder_rolls_down_a_slope(slope: float) -> None:
    radius = 0.1
    body = so.shapes.cylinder(radius, 0.4)
    contact = sim.HuntCrossley(
        stiffness=1e8, damping=0.5, friction=0.6, slip_speed=1e-3, depth=1e-3
    )
    gravity = G * np.array([np.sin(slope), 0.0, -np.cos(slope)])
    lying = so.Pose.exp([np.pi / 2, 0.0, 0.0]).rotation
    system = on_floor(body, contact, gravity, pose=so.Pose(lying, [0.0, 0.0, radius]))
    operator = sim.Operator(system, 2e-5)
    run = operator.run(operator.start(), 25000, every=500)
    speed = run.velocities(1)[-1]
    # m a = m g sin - F, with F = m a / 2 of a solid cylinder
    wanted = 2.0 / 3.0 * G * np.sin(slope) * run.times[-1]
    assert speed[0] == pytest.approx(wanted, rel=5e-3)
    assert np.abs(speed[1]) < 1e-6
    assert run.angular_velocities(1)[-1] == pytest.approx(
        [0.0, wanted / radius, 0.0], rel=1e-2, abs=1e-5
    )


def test_a_box_at_rest_does_not_rock() -> None:
    contact = sim.HuntCrossley(
        stiffness=1e7, damping=1.0, friction=0.5, slip_speed=2e-3, depth=1e-3
    )
    body = so.shapes.box(0.2, 0.3, 0.1)
    system = on_floor(body, contact, pose=upright(0.05))
    operator = sim.Operator(system, 5e-5)
    run = operator.run(operator.start(), 20000, every=100)
    # four corners carry it: k d^1.5 is a quarter of the weight each
    weight = 1000.0 * 0.2 * 0.3 * 0.1 * G
    sunk = (weight / 4e7) ** (2.0 / 3.0)
    assert run.positions(1)[-1, 2] == pytest.approx(0.05 - sunk, abs=1e-2 * sunk)
    assert run.distances[-1, 0] == pytest.approx(-sunk, rel=1e-2)
    assert (run.spots[50:] == 4).all()
    assert np.abs(run.angular_velocities(1)).max() < 1e-9
    assert np.linalg.norm(run.forces[-1, 0]) == pytest.approx(weight, rel=2e-3)


def test_a_box_slides_to_a_stop() -> None:
    mu, speed = 0.4, 0.5
    contact = sim.HuntCrossley(stiffness=1e7, damping=1.0, friction=mu, slip_speed=5e-4, depth=1e-3)
    body = so.shapes.box(0.3, 0.3, 0.1)
    weight = 1000.0 * 0.3 * 0.3 * 0.1 * G
    sunk = (weight / 4e7) ** (2.0 / 3.0)
    system = on_floor(
        body, contact, pose=upright(0.05 - sunk), twist=so.Twist([speed, 0, 0], [0, 0, 0])
    )
    operator = sim.Operator(system, 2e-5)
    stop = speed / (mu * G)
    run = operator.run(operator.start(allow_overlap=True), ticks(1.3 * stop, 2e-5, 10), every=10)
    way = run.positions(1)[:, 0]
    assert way[-1] == pytest.approx(speed**2 / (2.0 * mu * G), rel=5e-3)
    assert np.abs(run.velocities(1)[-1]).max() < 2e-3
    # it pitches forward a little while it slides, and lies flat again
    assert np.abs(run.rotations(1)[-1] - np.eye(3)).max() < 1e-4
    lost = run.energy.dissipated[-1]
    assert lost == pytest.approx(0.5 * weight / G * speed**2, rel=1e-2)


TUMBLING = so.Twist([0.0, 0.0, 0.0], [0.1, 3.0, 0.2])


@pytest.mark.parametrize("method", ["rk4", "semi-implicit"])
def test_a_free_asymmetric_body_keeps_energy_and_momentum(method: str) -> None:
    body = sim.RigidBody.free(so.shapes.box(0.1, 0.2, 0.4), mass=1.0, twist=TUMBLING)
    system = sim.System([body], sim.HuntCrossley(stiffness=1.0), gravity=[0, 0, 0])
    operator = sim.Operator(system, 1e-4, method=method)
    run = operator.run(operator.start(), 100_000, every=1000)
    spin = run.angular_momenta(0)
    assert np.array_equal(spin, np.broadcast_to(spin[0], spin.shape))
    energy = run.energy.kinetic
    allowed = {"rk4": 1e-12, "semi-implicit": 2e-7}[method]
    assert np.abs(energy / energy[0] - 1.0).max() < allowed
    R = run.rotations(0)
    assert np.abs(R @ R.transpose(0, 2, 1) - np.eye(3)).max() < 1e-15 * 4


TILTED = so.shapes.ellipsoid([0.15, 0.2, 0.1])


def pressed(
    tracker: str, method: str, dt: float, body: so.Body = TILTED, height: float = 0.3
) -> np.ndarray:
    """A tilted body pressed into an ellipsoid for 20 ms: every stage has a contact force."""
    end = 0.02
    contact = sim.HuntCrossley(stiffness=2e4, damping=0.3, friction=0.3, slip_speed=0.5, depth=0.02)
    lower = sim.RigidBody.fixed(so.shapes.ellipsoid([0.4, 0.3, 0.2]))
    turn = so.Pose.exp([0.3, -0.2, 0.4]).rotation
    twist = so.Twist([0.3, 0.2, 0.0], [1.0, -2.0, 0.5])
    upper = sim.RigidBody.free(
        body,
        density=1000.0,
        pose=so.Pose(turn, [0.03, 0.02, height]),
        twist=twist,
    )
    system = sim.System([lower, upper], contact)
    gain = 100.0 if tracker == "inside" else None
    operator = sim.Operator(system, dt, method=method, tracker=tracker, gain=gain)
    run = operator.run(operator.start(allow_overlap=True), round(end / dt), every=round(end / dt))
    assert run.distances.max() < 0.0
    R, p = run.rotations(1)[-1], run.positions(1)[-1]
    return np.concatenate([R.ravel(), p, run.velocities(1)[-1], run.angular_velocities(1)[-1]])


STEPS = 0.02 / np.array([16, 32, 64])
ORDERS = {"euler": 1, "semi-implicit": 1, "heun": 2, "midpoint": 2, "rk4": 4}


@pytest.mark.parametrize("method", ORDERS)
def test_the_whole_operator_has_its_methods_order(method: str) -> None:
    exact = pressed("inside", "rk4", 0.02 / 1024)
    errors = [np.abs(pressed("inside", method, dt) - exact).max() for dt in STEPS]
    found = np.log2(np.array(errors[:-1]) / errors[1:])
    assert found == pytest.approx(ORDERS[method], abs=0.25), errors


@pytest.mark.parametrize("method", ["heun", "rk4"])
def test_swept_bodies_push_along_their_witness_points_at_every_stage(method: str) -> None:
    """A capsule's core is a segment, apart from what the capsule touches."""
    capsule = so.shapes.capsule(0.1, 0.1)
    exact = pressed("inside", "rk4", 0.02 / 1024, capsule, 0.295)
    errors = [np.abs(pressed("inside", method, dt, capsule, 0.295) - exact).max() for dt in STEPS]
    found = np.log2(np.array(errors[:-1]) / errors[1:])
    assert found == pytest.approx(ORDERS[method], abs=0.4), errors


def test_a_tracker_beside_is_of_first_order_whatever_the_method() -> None:
    exact = pressed("inside", "rk4", 0.02 / 1024)
    beside = [np.abs(pressed("beside", "rk4", dt) - exact).max() for dt in STEPS]
    inside = [np.abs(pressed("inside", "rk4", dt) - exact).max() for dt in STEPS]
    assert np.log2(np.array(beside[:-1]) / beside[1:]) == pytest.approx(1.0, abs=0.2)
    assert (np.array(inside) < 1e-3 * np.array(beside)).all()


@pytest.mark.parametrize("tracker", ["inside", "beside"])
def test_a_polytope_tumbles_and_settles_without_gaining_energy(tracker: str) -> None:
    """Vertex by vertex, edge by edge, face by face: mechanical energy never grows."""
    corners = np.random.default_rng(3).normal(size=(20, 3)) * 0.1
    contact = sim.HuntCrossley(
        stiffness=3e6, damping=0.3, friction=0.4, slip_speed=0.03, depth=5e-3
    )
    system = on_floor(
        so.shapes.polytope(corners),
        contact,
        pose=so.Pose(so.Pose.exp([0.7, -0.4, 0.3]).rotation, [0.0, 0.0, 0.45]),
        twist=so.Twist([0.3, 0.0, 0.0], [1.0, 2.0, 3.0]),
    )
    operator = sim.Operator(system, 2e-5, tracker=tracker)
    run = operator.run(operator.start(), 100_000, every=250)
    mechanical = run.energy.mechanical
    lost = mechanical[0] - mechanical[-1]
    # the semi-implicit method's own error, of first order in the step
    assert np.diff(mechanical).max() < 2e-4 * lost
    assert np.abs(run.energy.balance - run.energy.balance[0]).max() < 3e-3 * lost
    assert run.spots[-1, 0] >= 3
    assert run.uncertified == 0
