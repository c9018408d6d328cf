"""Simulations of solids that need not be convex: beside those of convex bodies, and in equilibrium.

The spots of a place share no spring, so a body that rests on n of them at one depth d weighs
n k d^1.5.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import standoff as so
from families import solid_shapes
from standoff.errors import StandoffError
from standoff.kernels.solids import contact_places as P
from standoff.simulation import (
    HuntCrossley,
    Operator,
    RigidBody,
    System,
    SystemRun,
    SystemState,
    mass_properties,
)
from standoff.simulation.system_state import state_length
from standoff.solids import Solid

LAW = HuntCrossley(stiffness=1e5, damping=0.3, friction=0.3, slip_speed=1e-2, depth=1e-3)
PLATE = so.shapes.box(1.0, 1.0, 0.1)
BALL = so.shapes.sphere(0.05)
DT = 2e-4


def pressed(a: Any, b: Any, law: HuntCrossley = LAW, dt: float = DT, **given: Any) -> Operator:
    """A free body B on a fixed one."""
    gravity = given.pop("gravity", (0.0, 0.0, -9.81))
    given.setdefault("density", 1000.0)
    bodies = [RigidBody.fixed(a), RigidBody.free(b, **given)]
    return Operator(System(bodies, law, gravity=gravity), dt)


def run_of(operator: Operator, ticks: int, every: int = 1, **start: Any) -> SystemRun:
    return operator.run(operator.start(**start), ticks, every)


def at(height: float, x: float = 0.0) -> so.Pose:
    return so.Pose(np.eye(3), [x, 0.0, height])


def test_a_ball_bounces_and_rolls_as_convex_bodies_do() -> None:
    """Over the sides of its faces too, where a place goes on in another chart."""
    start = {"pose": at(0.11), "twist": so.Twist([0.2, 0.0, 0.0], [0.0, 0.0, 0.0])}
    solids = run_of(pressed(Solid(PLATE), Solid(BALL), **start), 5000, 50)
    convex = run_of(pressed(PLATE, BALL, **start), 5000, 50)
    assert solids.spots.max() == 1
    assert solids.positions(1)[-1, 0] > 0.12
    np.testing.assert_allclose(solids.positions(1), convex.positions(1), rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(solids.rotations(1), convex.rotations(1), rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(solids.forces, convex.forces, rtol=0.0, atol=1e-8)
    assert solids.uncertified == solids.jumps == 0


def test_one_of_a_pair_may_be_a_convex_body() -> None:
    start = {"pose": at(0.102)}
    both = run_of(pressed(Solid(PLATE), Solid(BALL), **start), 600, 20)
    one = run_of(pressed(PLATE, Solid(BALL), **start), 600, 20)
    np.testing.assert_array_equal(one.states, both.states)


def test_a_box_rests_on_four_springs() -> None:
    """Each corner has a whole one."""
    box = Solid(so.shapes.box(0.2, 0.2, 0.1))
    law = HuntCrossley(stiffness=1e5, damping=5.0, friction=0.3, slip_speed=1e-2, depth=2e-3)
    operator = pressed(Solid(PLATE), box, law, pose=at(0.1))
    run = run_of(operator, 20_000, 1000)
    weight = 9.81 * operator.system.bodies[1].mass_properties.mass
    depth = (weight / (4.0 * law.stiffness)) ** (2.0 / 3.0)
    assert run.spots[-1, 0] == 4
    assert run.distances[-1, 0] == pytest.approx(-depth, rel=1e-4)
    assert run.forces[-1, 0, 2] == pytest.approx(weight, rel=1e-4)
    assert np.linalg.norm(run.velocities(1)[-1]) < 1e-6


def test_a_bracket_stands_on_its_corners_as_its_weight_is_shared() -> None:
    """Its centre is not above the middle of its foot: it leans, until moments balance."""
    foot = solid_shapes.prism([(0.0, 0.0), (0.2, 0.0), (0.2, 0.04), (0.04, 0.04), (0.04, 0.15),
                               (0.0, 0.15)], 0.07)  # fmt: skip
    law = HuntCrossley(stiffness=2e4, damping=5.0, friction=0.3, slip_speed=1e-2, depth=3e-3)
    turn = so.Pose.exp((np.pi / 2, 0.0, 0.0)).rotation  # its outline's y is up
    operator = pressed(Solid(PLATE), foot, law, pose=so.Pose(turn, [0.0, 0.0, 0.05]))
    run = run_of(operator, 20_000, 1000)
    mass = operator.system.bodies[1].mass_properties
    pose, weight = run.final.pose(1), 9.81 * mass.mass
    corners = np.array([(x, 0.0, z) for x in (0.0, 0.2) for z in (0.0, 0.07)])
    heights = (corners @ pose.rotation.T + pose.translation)[:, 2]
    pushes = law.stiffness * np.maximum(0.05 - heights, 0.0) ** 1.5
    assert pushes.sum() == pytest.approx(weight, rel=1e-4)
    level = (corners @ pose.rotation.T + pose.translation)[:, :2]
    centre = (pose.rotation @ mass.centre + pose.translation)[:2]
    np.testing.assert_allclose(pushes @ level / weight, centre, rtol=0.0, atol=1e-5)
    assert run.forces[-1, 0, 2] == pytest.approx(weight, rel=1e-4)
    assert heights.max() - heights.min() > 1e-4


def in_its_hole(dt: float = 5e-5) -> Operator:
    """A steel peg of 20 mm with a play of 10 µm, pressed sideways and drawn down."""
    hole, own = solid_shapes.tube(0.01001, 0.02, -0.02, 0.02), solid_shapes.peg(0.01, 0.0, 0.06)
    law = HuntCrossley(stiffness=1e6, damping=20.0, friction=0.1, slip_speed=2e-2, depth=5e-5)
    pull = (4.0, 1.0, -1.0)
    return pressed(hole, own, law, dt, density=7800.0, pose=at(-0.01), gravity=pull)


@pytest.fixture(scope="module")
def peg() -> SystemRun:
    """It sinks along the wall of its hole."""
    return run_of(in_its_hole(), 4000, 20)


def test_a_peg_slides_along_its_hole(peg: SystemRun) -> None:
    """The wall carries what presses it sideways, along the way it is pressed."""
    mass = peg.system.bodies[1].mass_properties
    settled = slice(len(peg.times) // 2, None)
    across = peg.forces[settled, 0, :2].mean(axis=0)
    np.testing.assert_allclose(across, -mass.mass * np.array([4.0, 1.0]), rtol=0.02)
    assert peg.positions(1)[-1, 2] < -0.015
    assert peg.spots[settled].min() >= 1
    assert peg.spots.max() <= 16
    assert peg.uncertified == peg.jumps == 0


def test_the_force_does_not_jump() -> None:
    """As spots begin and end it changes by half as much in half a tick."""
    most = []
    for dt in (5e-5, 2.5e-5):
        run = run_of(in_its_hole(dt), round(0.1 / dt))
        forces = run.forces[:, 0]
        assert len(np.unique(run.spots)) > 1
        change = np.linalg.norm(np.diff(forces, axis=0), axis=1).max()
        most.append(change / np.linalg.norm(forces, axis=1).max())
    assert most[0] < 0.03
    assert most[1] < 0.55 * most[0]


def test_nothing_of_the_energy_comes_from_nowhere(peg: SystemRun) -> None:
    balance, mechanical = peg.energy.balance, peg.energy.mechanical
    # the step's own error; the spots of a patch change with the place
    assert np.ptp(balance) < 0.02 * np.ptp(mechanical)
    assert (np.diff(peg.energy.dissipated) >= -1e-15).all()


def test_a_run_in_parts_is_the_whole_run() -> None:
    """What is kept beside the row of a state goes with it."""
    operator = in_its_hole()
    whole = run_of(operator, 200)
    state = operator.start()
    for ticks in (1, 50, 149):
        state = operator.run(state, ticks, ticks).final
    np.testing.assert_array_equal(state.data, whole.final.data)
    # a record has none of it: its places are found again
    again = operator.run(whole.state(150), 50)
    np.testing.assert_allclose(again.positions(1)[-1], whole.positions(1)[-1], rtol=0, atol=1e-9)


def moved_to(operator: Operator, state: SystemState, height: float) -> SystemState:
    """The same with B at a height, as no motion takes it there."""
    data = state.data.copy()
    row = 8 + 18 + 9  # the centre of the second body
    data[row + 2] = height
    data.flags.writeable = False
    return SystemState(operator.system, data)


def test_another_way_out_pushes_nothing() -> None:
    """A peg set down on the mouth of its hole, half a millimetre off: the rim of the hole would
    push it aside, 0.7 mm deep, where the face has only begun to carry it."""
    hole, own = solid_shapes.tube(0.01001, 0.02, -0.02, 0.02), solid_shapes.peg(0.01, 0.0, 0.06)
    law = HuntCrossley(stiffness=1e5, damping=20.0, friction=0.0, depth=2e-4)
    off = so.Pose(np.eye(3), [5e-4, 5e-4, 0.02002])
    operator = pressed(hole, own, law, 5e-5, density=7800.0, pose=off, gravity=(0.0, 0.0, -1.0))
    run = run_of(operator, 400)
    seen = run.final.contact(0).places
    aside = [p for p in seen if abs(p.normal[2]) < 0.1 and p.distance < 0.0]
    assert [p.felt for p in aside] == [False]
    assert aside[0].distance < -5e-4
    pushed = run.forces[:, 0]
    assert pushed[:, 2].max() > 0.1
    assert np.abs(pushed[:, :2]).max() < 0.02 * pushed[:, 2].max()
    assert run.uncertified == 0  # the face's own place is felt beside it
    # from nothing nobody can tell
    anew = SystemState(operator.system, run.states[-1].copy())
    felt = [p.felt for p in operator.run(anew, 1).final.contact(0).places]
    assert all(felt)
    assert len(felt) == len(seen)


def test_a_place_is_felt_that_is_as_deep_as_the_bodies_have_moved() -> None:
    operator = pressed(Solid(PLATE), Solid(BALL), pose=at(0.12), gravity=(0.0, 0.0, 0.0))
    near = operator.run(operator.start(), 1).final
    moved = operator.run(moved_to(operator, near, 0.0995), 1)
    assert [p.felt for p in moved.final.contact(0).places] == [True]


def test_a_place_that_ends_deep_is_counted() -> None:
    operator = pressed(Solid(PLATE), Solid(BALL), pose=at(0.1001), gravity=(0.0, 0.0, -5.0))
    state = operator.run(operator.start(), 60, 60).final
    assert state.contact(0).places[0].distance < -1e-6
    data = moved_to(operator, state, 0.2).data.copy()  # nothing is near there
    data[state_length(operator.system) + P.F_POSE + 11] = 0.2  # as if B had not moved
    data.flags.writeable = False
    run = operator.run(SystemState(operator.system, data), 1)
    assert run.jumps == 1
    assert run.spots[-1, 0] == 0


def test_the_mass_of_a_tube() -> None:
    found = mass_properties(solid_shapes.tube(0.5, 0.8, -0.5, 0.5), 2.0)
    volume = np.pi * (0.8**2 - 0.5**2)
    assert found.mass == pytest.approx(2.0 * volume, rel=1e-10)
    about = 0.5 * found.mass * (0.8**2 + 0.5**2)
    assert found.inertia[2, 2] == pytest.approx(about, rel=1e-10)


def test_an_overlap_at_the_start_is_told() -> None:
    operator = pressed(Solid(PLATE), Solid(BALL), pose=at(0.099))
    with pytest.raises(StandoffError, match=r"overlap at the start, by 0\.001"):
        operator.start()
    run = run_of(operator, 1, allow_overlap=True)
    assert run.spots[0, 0] == 1
    assert run.forces[0, 0, 2] > 0.0


@pytest.mark.parametrize(
    ("given", "match"),
    [
        ({"tracker": "inside"}, "is for convex bodies"),
        ({"law": {(0, 1): so.PredictorCorrector()}}, "a pair with a Solid"),
    ],
)
def test_what_solids_do_not_have(given: dict[str, Any], match: str) -> None:
    system = pressed(Solid(PLATE), Solid(BALL), pose=at(0.2)).system
    with pytest.raises(StandoffError, match=match):
        Operator(system, DT, **given)


def test_a_half_space_has_no_contact_with_a_solid() -> None:
    with pytest.raises(StandoffError, match="box or a plate"):
        pressed(so.shapes.halfspace(), Solid(BALL), pose=at(0.2))


def test_the_spots_of_a_state_are_its_force() -> None:
    operator = in_its_hole()
    run = run_of(operator, 1000)
    contact = run.final.contact(0)
    assert contact.complete
    law, total = operator.system.contacts[0], np.zeros(3)
    moving = run.final.twist(1)
    for spot in contact.spots:
        arm = spot.point - run.final.pose(1).translation
        velocity = moving.v + np.cross(moving.omega, arm)
        closing = -velocity @ spot.normal
        spring = spot.springs * law.stiffness * spot.depth**1.5
        push = max(0.0, spring * (1.0 + 1.5 * law.damping * closing))
        slip = velocity + closing * spot.normal
        grip = law.friction * push / np.hypot(np.linalg.norm(slip), law.slip_speed)
        total += push * spot.normal - grip * slip
    np.testing.assert_allclose(total, run.forces[-1, 0], rtol=1e-9)
    deepest = min(place.distance for place in contact.places if place.felt)
    assert deepest == run.distances[-1, 0]
    assert sum(spot.springs for spot in contact.spots) <= 8.0


def test_who_has_no_places_says_so() -> None:
    operator = in_its_hole()
    for state in (operator.start(), run_of(operator, 2).state(1)):
        with pytest.raises(StandoffError, match="no places of contact"):
            state.contact(0)
    convex = pressed(PLATE, BALL, pose=at(0.2))
    with pytest.raises(StandoffError, match="of convex bodies"):
        convex.start().contact(0)


def test_a_rim_that_lies_flat_has_four_springs_in_all() -> None:
    """However many spots of it are known."""
    law = HuntCrossley(stiffness=1e5, damping=5.0, friction=0.3, slip_speed=1e-2, depth=2e-3)
    rim = solid_shapes.tube(0.1, 0.15, -0.05, 0.05)
    operator = pressed(Solid(PLATE), rim, law, pose=at(0.0999))
    run = run_of(operator, 1, allow_overlap=True)
    spots = run.final.contact(0).spots
    assert len(spots) > 8
    # hardly less deep on one side after a tick
    assert sum(spot.springs for spot in spots) == pytest.approx(4.0, rel=1e-4)
    assert run.forces[0, 0, 2] == pytest.approx(4.0 * law.force(1e-4), rel=1e-6)


def test_corners_side_by_side_share_a_spring() -> None:
    """A board on edge: of both corners at each end one is as good as the other."""
    thick = 2e-3
    board = solid_shapes.prism([(-0.1, 0.0), (0.1, 0.0), (0.1, 0.02), (-0.1, 0.02)], thick)
    turn = so.Pose.exp((np.pi / 2, 0.0, 0.0)).rotation
    law = HuntCrossley(stiffness=1e2, damping=1.0, depth=1e-3)
    operator = pressed(Solid(PLATE), board, law, 1e-4, pose=so.Pose(turn, [0.0, 0.0, 0.04999]))
    spots = run_of(operator, 1, allow_overlap=True).final.contact(0).spots
    assert len(spots) == 4
    left = 1.0 - (thick / (0.1 * board.size)) ** 2
    expected = 1.0 / (1.0 + left * left)
    for spot in spots:
        assert spot.springs == pytest.approx(expected, rel=1e-3)


def test_a_side_that_a_body_slides_in_over_pushes_nothing() -> None:
    """A box comes on to a plate: its last corners, pressed by the plate's face, pass the plane of
    its side, and are under that face too, less deep."""
    box = Solid(so.shapes.box(0.2, 0.2, 0.1))
    start = so.Pose(np.eye(3), [0.4002, 0.0, 0.09995])
    moving = so.Twist([-0.2, 0.0, 0.0], [0.0, 0.0, 0.0])
    law = HuntCrossley(stiffness=1e5, damping=5.0, depth=2e-3)
    operator = pressed(Solid(PLATE), box, law, pose=start, twist=moving)
    run = operator.run(operator.start(allow_overlap=True), 20)
    assert run.positions(1)[-1, 0] < 0.3997
    assert run.forces[1:, 0, 2].min() > 0.05
    aside = np.abs(run.forces[1:, 0, 0]) / run.forces[1:, 0, 2]
    assert aside.max() < 1e-5  # the tilt that the box has come to
