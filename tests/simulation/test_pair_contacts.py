"""All contacts of a run and of a state: what spots push is what the bodies feel."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest

import standoff as so
from standoff.errors import StandoffError
from standoff.kernels.dynamics.solid_pairs import LOOKED_FOR
from standoff.simulation import HuntCrossley, Operator, RigidBody, System, SystemRun
from standoff.simulation.pair_contacts import FIRST_ROOM
from standoff.solids import Solid
from standoff.tracking import Status

LAW = HuntCrossley(stiffness=1e5, damping=5.0, friction=0.3, slip_speed=1e-2, depth=2e-3)
PLATE, BOX = so.shapes.box(0.5, 0.5, 0.1), so.shapes.box(0.2, 0.2, 0.1)
WEIGHT = 9.81 * 4.0
DEPTH = (WEIGHT / (4.0 * LAW.stiffness)) ** (2.0 / 3.0)


def at(*place: float) -> so.Pose:
    return so.Pose(np.eye(3), place)


def operator_of(ground: str) -> Operator:
    """A box that is set down on a plane, on a plate, or on a plate of solids: three routes to its
    four springs."""
    wrap: Any = Solid if ground == "solids" else (lambda body: body)
    under = (
        RigidBody.fixed(so.shapes.halfspace())
        if ground == "plane"
        else RigidBody.fixed(wrap(PLATE), at(0.0, 0.0, -0.05))
    )
    twist = so.Twist([0.1, 0.0, 0.0], [0.0, 0.0, 0.0])  # it slides for a while
    box = RigidBody.free(wrap(BOX), density=1000.0, pose=at(0.0, 0.0, 0.051), twist=twist)
    return Operator(System([under, box], LAW), 2e-4)


GROUNDS = ("plane", "plate", "solids")


@pytest.fixture(scope="module", params=GROUNDS)
def both(request: pytest.FixtureRequest) -> tuple[Operator, SystemRun]:
    operator = operator_of(request.param)
    return operator, operator.run(operator.start(), 4000, 100, contacts=True)


def test_spots_push_what_the_bodies_feel(both: tuple[Operator, SystemRun]) -> None:
    _, run = both
    touched = 0
    for row in range(len(run.times)):
        contacts = {each.pair: each for each in run.contacts(row)}
        spots = contacts[0].spots
        assert len(spots) == run.spots[row, 0]
        np.testing.assert_allclose(contacts[0].force, run.forces[row, 0], rtol=0.0, atol=1e-12)
        assert contacts[0].distance == run.distances[row, 0]
        touched += bool(spots)
        if spots:
            deepest = max(spot.depth for spot in spots)
            assert deepest == pytest.approx(-run.distances[row, 0], rel=1e-4)
    assert touched > 30
    # Friction is among them while it slides.
    sliding = run.forces[:, 0, 0]
    assert sliding.min() < -1.0


def test_at_rest_each_corner_carries_a_quarter(both: tuple[Operator, SystemRun]) -> None:
    _, run = both
    (contact,) = run.contacts(len(run.times) - 1)
    corners = {(round(s.point[0] - run.positions(1)[-1, 0], 4), round(s.point[1], 4))
               for s in contact.spots}  # fmt: skip
    assert corners == {(x, y) for x in (-0.1, 0.1) for y in (-0.1, 0.1)}
    for spot in contact.spots:
        assert spot.depth == pytest.approx(DEPTH, rel=1e-3)
        assert spot.point[2] == pytest.approx(-0.5 * DEPTH, rel=1e-3)
        assert spot.normal == pytest.approx([0.0, 0.0, 1.0], abs=1e-9)
        assert spot.force[2] == pytest.approx(0.25 * WEIGHT, rel=1e-3)
        assert spot.force[2] == pytest.approx(spot.springs * LAW.force(spot.depth), rel=1e-3)
    assert contact.status in (Status.LOCAL, Status.GLOBAL)
    (place,) = contact.places
    assert place.distance == pytest.approx(-DEPTH, rel=1e-3)
    assert place.point_a[2] == pytest.approx(0.0, abs=1e-9)
    assert place.point_b[2] == pytest.approx(-DEPTH, rel=1e-3)


def test_what_is_kept_changes_nothing(both: tuple[Operator, SystemRun]) -> None:
    operator, run = both
    plain = operator.run(operator.start(), 4000, 100)
    np.testing.assert_array_equal(plain.states, run.states)
    np.testing.assert_array_equal(plain.accounts, run.accounts)
    np.testing.assert_array_equal(plain.final.data, run.final.data)


def test_a_state_s_contacts_are_those_of_its_record(both: tuple[Operator, SystemRun]) -> None:
    operator, run = both
    for state, row in ((operator.start(), 0), (run.final, len(run.times) - 1)):
        _same(operator.contacts(state), run.contacts(row))
    kept = run.system.of_solids[0]
    if kept:
        own = run.final.contact(0)
        (contact,) = run.contacts(len(run.times) - 1)
        _same(contact.places, own.places)
        _same([(s.point, s.normal, s.depth, s.springs) for s in contact.spots], own.spots)
    stored = pickle.loads(pickle.dumps(run))
    _same(stored.contacts(20), run.contacts(20))


def test_rows_below_zero_count_from_the_end(both: tuple[Operator, SystemRun]) -> None:
    _, run = both
    count = len(run.times)
    for row in (-1, -count, np.int64(-2)):
        _same(run.contacts(row), run.contacts(row + count))
        _same(run.state(row).data, run.state(row + count).data)
    for row in (count, -count - 1, 0.0):
        with pytest.raises(StandoffError, match=f"from {-count} to {count - 1}"):
            run.contacts(row)
        with pytest.raises(StandoffError, match="row"):
            run.state(row)


def _same(found: Any, expected: Any) -> None:
    """Do tuples of tuples hold the same numbers?"""
    if isinstance(expected, tuple | list):
        assert len(found) == len(expected)
        for a, b in zip(found, expected, strict=True):
            _same(a, b)
    else:
        np.testing.assert_array_equal(found, expected)


def test_more_spots_than_there_is_room_for_at_first() -> None:
    count = FIRST_ROOM // 4 + 1
    bodies = [RigidBody.fixed(so.shapes.halfspace())]
    bodies += [
        RigidBody.free(BOX, density=1000.0, pose=at(0.3 * k, 0.0, 0.05 - DEPTH))
        for k in range(count)
    ]
    pairs = [(0, k + 1) for k in range(count)]
    operator = Operator(System(bodies, LAW, pairs), 2e-4)
    contacts = operator.contacts(operator.start(allow_overlap=True))
    assert [each.pair for each in contacts] == list(range(count))
    assert [len(each.spots) for each in contacts] == [4] * count
    for each in contacts:
        assert each.force[2] == pytest.approx(WEIGHT, rel=1e-9)


@pytest.mark.parametrize("solids", [False, True])
def test_a_place_is_told_within_eight_depths(solids: bool) -> None:
    ball: Any = so.shapes.sphere(0.05)
    for height, near in ((0.9, True), (1.1, False)):
        gap = height * LOOKED_FOR * LAW.depth
        bodies = [
            RigidBody.fixed(Solid(PLATE) if solids else PLATE),
            RigidBody.free(ball, density=1000.0, pose=at(0.0, 0.0, 0.1 + gap)),
        ]
        operator = Operator(System(bodies, LAW), 2e-4)
        told = operator.contacts(operator.start())
        assert len(told) == near
        if near:
            (contact,) = told
            assert contact.spots == ()
            assert contact.force.tolist() == [0.0, 0.0, 0.0]
            assert contact.places[0].distance == pytest.approx(gap, abs=1e-9)


def test_what_was_not_kept_is_not_told() -> None:
    operator = operator_of("plate")
    run = operator.run(operator.start(), 1)
    with pytest.raises(StandoffError, match=r"contacts=True"):
        run.contacts(0)
    with pytest.raises(StandoffError, match=r"must be True or False"):
        operator.run(operator.start(), 1, contacts="yes")  # type: ignore[arg-type]
    with pytest.raises(StandoffError, match="another system"):
        operator_of("plate").contacts(operator.start())
