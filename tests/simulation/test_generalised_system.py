"""Systems in the user's coordinates, solved by SciPy: bounce, pendulum, switches, refusals."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy
from scenes_with_contact import FLOOR, G, on_floor, upright

import standoff as so
from standoff import simulation as sim

UP = np.eye(6)[:, 2:3]
BALL = so.shapes.sphere(0.1)
MASS = 1000.0 * 4.0 / 3.0 * np.pi * 0.1**3


def falling(contact: Any, gravity: float = G, **over: Any) -> sim.GeneralisedSystem:
    """A ball above a plane, its height the only coordinate."""
    given: dict[str, Any] = {
        "bodies": [FLOOR, BALL],
        "place": lambda theta: [so.Pose.identity(), upright(theta[0])],
        "jacobian": lambda theta: [np.zeros((6, 1)), UP],
        "mass": lambda theta: [[MASS]],
        "coriolis": lambda theta, rate: [0.0],
        "field": lambda theta, rate: [MASS * gravity],
        "contact": contact,
    }
    return sim.GeneralisedSystem(**{**given, **over})


@pytest.mark.parametrize("method", ["RK45", "DOP853", "Radau"])
def test_a_ball_leaves_a_wall_as_its_restitution_says(method: str) -> None:
    contact = sim.HuntCrossley(stiffness=1e7, damping=0.3)
    found = sim.solve(falling(contact, 0.0), [0.11], [-1.0], 0.02, method=method, max_step=1e-3)
    assert found.rate[-1, 0] == pytest.approx(contact.restitution(1.0), rel=1e-6)
    assert [event.kind for event in found.events] == ["contact", "release"]
    assert found.events[0].time == pytest.approx(0.01, abs=1e-12)


def test_it_agrees_with_the_compiled_operator() -> None:
    contact = sim.HuntCrossley(stiffness=1e6, damping=0.2, depth=0.01)
    found = sim.solve(falling(contact), [0.105], [-1.0], 0.025, max_step=1e-3)
    system = on_floor(BALL, contact, pose=upright(0.105), twist=so.Twist([0, 0, -1.0], [0, 0, 0]))
    operator = sim.Operator(system, 1e-5, method="rk4", tracker="inside", gain=100.0)
    run = operator.run(operator.start(), 2500, every=2500)
    assert run.positions(1)[-1, 2] == pytest.approx(found.theta[-1, 0], abs=1e-9)
    assert run.velocities(1)[-1, 2] == pytest.approx(found.rate[-1, 0], abs=1e-7)


def test_flat_contacts_press_with_several_spots_as_a_systems_do() -> None:
    """A box falls on a corner's edge and rocks: a force in the middle alone would not right it."""
    box, contact = so.shapes.box(0.2, 0.3, 0.1), sim.HuntCrossley(stiffness=1e6, damping=0.3)
    mass = sim.mass_properties(box, 1000.0)
    tilt, height, span = 0.02, 0.0535, 0.06

    def place(theta: np.ndarray) -> list[so.Pose]:
        return [so.Pose.identity(), so.Pose.exp([0.0, theta[2], 0.0], [theta[0], 0.0, theta[1]])]

    moved = np.zeros((6, 3))
    moved[0, 0] = moved[2, 1] = moved[4, 2] = 1.0
    generalised = sim.GeneralisedSystem(
        bodies=[FLOOR, box],
        place=place,
        jacobian=lambda theta: [np.zeros((6, 3)), moved],
        mass=lambda theta: np.diag([mass.mass, mass.mass, mass.inertia[1, 1]]),
        coriolis=lambda theta, rate: np.zeros(3),
        field=lambda theta, rate: [0.0, mass.mass * G, 0.0],
        contact=contact,
    )
    first = [0.0, height, tilt]
    within = {"max_step": 1e-3, "tolerance": 1e-10}  # each takes steps of its own
    found = sim.solve(generalised, first, np.zeros(3), span, **within)
    system = on_floor(box, contact, pose=place(np.array(first))[1])
    free = sim.solve(system, duration=span, **within)
    assert [e.kind for e in found.events].count("contact") >= 1
    assert free.run.spots[:, 0].max() == 4
    assert found.theta[-1, :2] == pytest.approx(free.run.positions(1)[-1, [0, 2]], abs=1e-9)
    assert found.rate[-1, 2] == pytest.approx(free.run.angular_velocities(1)[-1, 1], abs=1e-5)
    assert abs(found.rate[-1, 2]) > 0.1


def test_planar_bodies_meet_in_their_plane() -> None:
    corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
    sides = zip(corners, [*corners[1:], corners[0]], strict=True)
    square = so.shapes.planar_loop([so.geometry.Line(p, q) for p, q in sides])
    contact = sim.HuntCrossley(stiffness=1e7, damping=0.3)
    system = falling(
        contact,
        0.0,
        bodies=[square, so.shapes.planar_loop([so.geometry.ConicArc((0, 0), (0.5, 0), (0, 0.5))])],
        place=lambda theta: [so.Pose.identity(), so.Pose(np.eye(3), [theta[0], 0.1, 0.0])],
        jacobian=lambda theta: [np.zeros((6, 1)), np.eye(6)[:, :1]],
        mass=lambda theta: [[4.0]],
    )
    found = sim.solve(system, [1.51], [-1.0], 0.02, max_step=1e-3)
    assert found.rate[-1, 0] == pytest.approx(contact.restitution(1.0), rel=1e-6)


def test_each_pair_may_have_a_contact_of_its_own() -> None:
    soft, hard = (sim.HuntCrossley(stiffness=k) for k in (1e5, 1e7))
    two = falling(
        [soft, hard],
        bodies=[FLOOR, BALL, BALL],
        place=lambda theta: [so.Pose.identity(), *(upright(z) for z in theta)],
        jacobian=lambda theta: [
            np.zeros((6, 2)),
            np.outer(UP, [1.0, 0.0]),
            np.outer(UP, [0.0, 1.0]),
        ],
        mass=lambda theta: MASS * np.eye(2),
        coriolis=lambda theta, rate: np.zeros(2),
        field=lambda theta, rate: np.full(2, MASS * G),
        pairs=[(0, 1), (0, 2)],
    )
    found = sim.solve(two, [0.11, 0.11], [-1.0, -1.0], 0.03, max_step=1e-3)
    for k, contact in enumerate((soft, hard)):
        alone = sim.solve(falling(contact), [0.11], [-1.0], 0.03, max_step=1e-3)
        assert found.theta[-1, k] == pytest.approx(alone.theta[-1, 0], abs=1e-8)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"bodies": [FLOOR, "ball"]}, "bodies has 'ball', which is not a Body"),
        ({"contact": 1e6}, "contact"),
        ({"pairs": [(0, 2)]}, "from 0 to 1"),
        ({"pairs": [(0, 1), (1, 0)]}, "twice"),
        ({"pairs": [(True, 0)]}, "from 0 to 1"),
        ({"bodies": [FLOOR, FLOOR]}, "half-spaces"),
        ({"mass": None}, "give a function"),
    ],
)
def test_what_is_no_system_is_refused(given: dict[str, Any], message: str) -> None:
    with pytest.raises(so.StandoffError, match=message):
        falling(**{"contact": sim.HuntCrossley(stiffness=1e6), **given})


LENGTH = 0.5


def pendulum(contact: sim.HuntCrossley) -> sim.GeneralisedSystem:
    """A ball on a massless rod that swings against a wall under its pivot; θ from straight down."""

    def place(theta: np.ndarray) -> list[so.Pose]:
        (a,) = theta
        return [
            so.Pose.exp([0.0, np.pi / 2, 0.0]),
            so.Pose(np.eye(3), [0.1 + LENGTH * np.sin(a), 0.0, -LENGTH * np.cos(a)]),
        ]

    def jacobian(theta: np.ndarray) -> list[np.ndarray]:
        (a,) = theta
        moving = [LENGTH * np.cos(a), 0.0, LENGTH * np.sin(a), 0.0, 0.0, 0.0]
        return [np.zeros((6, 1)), np.array(moving)[:, None]]

    return sim.GeneralisedSystem(
        bodies=[FLOOR, BALL],
        place=place,
        jacobian=jacobian,
        mass=lambda theta: [[MASS * LENGTH**2]],
        coriolis=lambda theta, rate: [0.0],
        field=lambda theta, rate: MASS * G * LENGTH * np.sin(theta),
        contact=contact,
    )


def test_a_pendulum_meets_a_wall_at_its_lowest_point_and_keeps_its_energy() -> None:
    """The wall is x = 0, so a ball of radius 0.1 touches it hanging straight down."""
    start = 0.6
    stiff = 1e7
    found = sim.solve(pendulum(sim.HuntCrossley(stiffness=stiff)), [start], [0.0], 1.5)
    quarter = np.sqrt(LENGTH / G) * scipy.special.ellipk(np.sin(start / 2.0) ** 2)
    touches = [event.time for event in found.events if event.kind == "contact"]
    assert touches[0] == pytest.approx(quarter, abs=1e-9)
    depth = np.maximum(-found.distances[:, 0], 0.0)
    energy = (
        0.5 * MASS * LENGTH**2 * found.rate[:, 0] ** 2
        - MASS * G * LENGTH * np.cos(found.theta[:, 0])
        + 0.4 * stiff * depth**2.5
    )
    assert len(touches) == 2
    assert np.abs(energy - energy[0]).max() < 1e-6 * (energy[0] + MASS * G * LENGTH)


def passing(box: so.Body, **given: Any) -> sim.Solution:
    """A point slides at the speed 1 over a box's upper face, from x = -1.03 on."""
    system = sim.GeneralisedSystem(
        bodies=[box, so.shapes.point()],
        place=lambda theta: [so.Pose.identity(), so.Pose(np.eye(3), [theta[0], 0.1, 0.8])],
        jacobian=lambda theta: [np.zeros((6, 1)), np.eye(6)[:, :1]],
        mass=lambda theta: np.eye(1),
        coriolis=lambda theta, rate: np.zeros(1),
        field=lambda theta, rate: np.zeros(1),
        contact=sim.HuntCrossley(stiffness=1.0),
    )
    return sim.solve(system, [-1.03], [1.0], 2.0, **given)


def test_switches_are_located() -> None:
    """Two switches, at the face's edges."""
    found = passing(so.shapes.box(1.0, 1.0, 1.0))
    times = [event.time for event in found.events if event.kind == "switch"]
    assert times == pytest.approx([0.53, 1.53], abs=1e-9)
    assert found.events[0].source.startswith("edge")
    assert found.events[0].target.startswith("face")


def test_several_switches_of_one_step_are_located() -> None:
    """A face that is passed within one step: the features at its ends are two edges."""
    found = passing(so.shapes.box(0.02, 1.0, 1.0), max_step=1.0)
    assert max(np.diff(found.times)) > 0.5
    times = [event.time for event in found.events]
    assert times == pytest.approx([1.02, 1.04], abs=1e-9)
    kinds = [(event.source.split()[0], event.target.split()[0]) for event in found.events]
    assert kinds == [("edge", "face"), ("face", "edge")]


def test_a_singular_mass_is_told_with_its_coordinates() -> None:
    contact = sim.HuntCrossley(stiffness=1e6)
    with pytest.raises(so.StandoffError, match=r"theta = \[0\.2\] is singular"):
        sim.solve(falling(contact, mass=lambda theta: [[0.0]]), [0.2], [0.0], 0.01)
    with pytest.raises(so.StandoffError, match="field has shape"):
        sim.solve(falling(contact, field=lambda theta, rate: [0.0, 0.0]), [0.2], [0.0], 0.01)
    with pytest.raises(so.StandoffError, match="jacobian"):
        sim.solve(falling(contact, jacobian=lambda theta: [UP]), [0.2], [0.0], 0.01)
    with pytest.raises(so.StandoffError, match="place returned 1 poses"):
        sim.solve(falling(contact, place=lambda theta: [upright(0.0)]), [0.2], [0.0], 0.01)
