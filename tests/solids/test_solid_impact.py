"""The time of impact of solids: never late, by closed forms and samples."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import standoff as so
from draws import draws
from families.solid_shapes import ball, bracket, peg, prism, socket, tube
from standoff.geometry import ConicArc, Line
from standoff.impact import ImpactStatus
from standoff.impact.moment import BodyBox
from standoff.impact.solids import InstantAnswer, Lipschitz, SolidSearch
from standoff.motion import ConstantTwist, Fixed, Screw
from standoff.solids import distance

STILL = so.Pose.identity()
SLOT = prism([(-1, -1), (3, -1), (3, 2), (2, 2), (2, 0), (0, 0), (0, 2), (-1, 2)], 3.0)


def at(*shift: float) -> so.Pose:
    return so.Pose(np.eye(3), shift)


def going(start: so.Pose, *velocity: float) -> ConstantTwist:
    return ConstantTwist(start, (list(velocity), [0.0, 0.0, 0.0]))


def test_a_ball_in_a_slot_meets_the_wall() -> None:
    found = so.time_of_impact(SLOT, ball(0.3), STILL, going(at(1.0, 1.0, 1.5), 0.25, 0, 0), 5.0)
    assert found.status is ImpactStatus.IMPACT
    assert 2.8 - 1e-6 < found.time <= 2.8
    assert 2.8 <= found.latest < 2.8 + 1e-6
    assert found.proximity.feature_b == so.Feature("face", 0)
    assert found.proximity.lower_bound > 0.0
    near = so.time_of_impact(
        SLOT, ball(0.3), STILL, going(at(1.0, 1.0, 1.5), 0.25, 0, 0), 5.0, clearance=0.2
    )
    assert near.status is ImpactStatus.IMPACT
    assert 2.0 - 1e-6 < near.time <= 2.0 + 1e-9


def test_a_ball_in_a_cavity() -> None:
    path = going(STILL, 0.0, 0.1, 0.0)
    found = so.time_of_impact(socket(0.5, 0.8), ball(0.3), STILL, path, 5.0)
    assert found.status is ImpactStatus.IMPACT
    assert 2.0 - 1e-6 < found.time <= 2.0 <= found.latest < 2.0 + 1e-6


def test_a_peg_slides_through_its_hole_and_out() -> None:
    """Parts that are around each other come apart without a contact, 10 µm apart all the way."""
    bush, pin = tube(0.05, 0.1, -0.5, 0.5), peg(0.04999, -0.6, 0.6)
    path = going(STILL, 0.0, 0.0, 0.2)
    found = so.time_of_impact(bush, pin, STILL, path, 0.002)
    assert found.status is ImpactStatus.NO_IMPACT
    assert found.time == 0.002
    assert found.proximity.distance == pytest.approx(1e-5, abs=1e-11)
    across = so.time_of_impact(bush, pin, STILL, going(STILL, 0.01, 0.0, 0.0), 0.01)
    assert across.status is ImpactStatus.IMPACT
    assert 1e-3 - 1e-6 < across.time <= 1e-3 + 1e-9


def test_solids_that_keep_apart_meet_never() -> None:
    found = so.time_of_impact(bracket(), ball(0.2), STILL, going(at(0, 0, 2), 1.0, 0, 0), 3.0)
    assert found.status is ImpactStatus.NO_IMPACT
    assert np.isnan(found.latest)


def test_solids_in_contact_are_so_at_the_start() -> None:
    found = so.time_of_impact(SLOT, ball(0.6), STILL, going(at(0.5, 0.5, 1.5), 1, 0, 0), 1.0)
    assert found.status is ImpactStatus.AT_START
    assert found.latest == found.time == 0.0


def test_a_grazing_pass() -> None:
    """A ball goes by a plane face, 1e-9 off it."""
    path = going(at(-2.0, 0.5, 3.25 + 1e-9), 1.0, 0.0, 0.0)
    found = so.time_of_impact(SLOT, ball(0.25), STILL, path, 4.0, tolerance=1e-6)
    assert found.status is ImpactStatus.GRAZING
    assert found.time < 1.5


def test_a_wheel_over_a_half_space() -> None:
    """No tracker keeps a half-space."""
    ground = so.shapes.halfspace()
    path = going(at(0.0, 0.0, 1.0), 0.0, 0.0, -0.25)
    found = so.time_of_impact(tube(0.2, 0.4, -0.1, 0.1), ground, path, STILL, 5.0)
    assert found.status is ImpactStatus.IMPACT
    assert 3.6 - 1e-5 < found.time <= 3.6 + 1e-9


def test_in_the_plane() -> None:
    hole = [ConicArc((0, 0), (0.5, 0), (0, 0.5))]
    ring = so.PlanarSolid.from_loops([ConicArc((0, 0), (1, 0), (0, 1))], [hole])
    disc = so.PlanarSolid.from_loops([ConicArc((0, 0), (0.3, 0), (0, 0.3))])
    found = so.time_of_impact(ring, disc, STILL, going(STILL, 0.1, 0.0, 0.0), 5.0)
    assert found.status is ImpactStatus.IMPACT
    assert 2.0 - 1e-6 < found.time <= 2.0 <= found.latest < 2.0 + 1e-6


def test_a_bar_turns_against_a_disc() -> None:
    bar = so.PlanarSolid.from_loops(
        [Line(a, b) for a, b in pairwise([(-1, -0.1), (1, -0.1), (1, 0.1), (-1, 0.1), (-1, -0.1)])]
    )
    disc = so.PlanarSolid.from_loops([ConicArc((0, 0), (0.1, 0), (0, 0.1))])
    turning = Screw(STILL, axis=[0.0, 0.0, 1.0], angular_rate=1.0)
    found = so.time_of_impact(bar, disc, turning, at(0.0, 0.8, 0.0), 3.0)
    true = np.arccos(0.25)
    assert found.status is ImpactStatus.IMPACT
    assert true - 1e-5 < found.time <= true + 1e-9


def test_what_is_no_solid_is_refused() -> None:
    with pytest.raises(so.StandoffError, match="no Solid"):
        so.time_of_impact(SLOT, "ball", STILL, STILL, 1.0)  # type: ignore[arg-type]
    with pytest.raises(so.StandoffError, match="clearance"):
        so.time_of_impact(SLOT, ball(0.2), STILL, STILL, 1.0, clearance=-0.1)


def test_a_small_budget_is_undecided() -> None:
    path = going(at(1.0, 1.0, 1.5), 0.25, 0, 0)
    found = so.time_of_impact(SLOT, ball(0.3), STILL, path, 5.0, max_evaluations=3)
    assert found.status is ImpactStatus.UNDECIDED
    assert found.time < 2.8


PAIRS = {
    "slot and bracket": (SLOT, bracket),
    "bush and bracket": (tube(0.5, 0.8, -0.6, 0.6), bracket),
    "shell and ball": (socket(0.5, 0.8), lambda: ball(0.2)),
}


@pytest.mark.parametrize("name", PAIRS)
@settings(max_examples=draws(4))
@given(st.integers(0, 2**32 - 1))
def test_it_is_never_late(name: str, seed: int) -> None:
    """Of drawn motions: before the time the solids are apart, and where a contact is told they are
    not."""
    rng = np.random.default_rng(seed)
    a, b = PAIRS[name][0], PAIRS[name][1]()
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.linalg.det(turn)
    way = rng.normal(size=3)
    start = so.Pose(turn, 2.5 * way / np.linalg.norm(way))
    velocity = -way / np.linalg.norm(way) + 0.3 * rng.normal(size=3)
    path_b = ConstantTwist(start, (velocity.tolist(), rng.normal(size=3).tolist()))
    path_a = Screw(STILL, axis=[0.0, 0.0, 1.0], angular_rate=float(rng.normal()))
    clearance = float(rng.choice([0.0, 0.05]))
    found = so.time_of_impact(a, b, path_a, path_b, 2.0, clearance=clearance)
    assert found.status is not ImpactStatus.UNDECIDED
    if found.status is ImpactStatus.AT_START:
        assert distance(a, b, path_a.pose(0.0), path_b.pose(0.0)).lower_bound <= clearance
        return
    for time in np.linspace(0.0, found.time, 24):
        answer = distance(a, b, path_a.pose(time), path_b.pose(time))
        assert answer.upper_bound >= clearance - 1e-12
        assert not answer.penetrating
    if found.status is ImpactStatus.IMPACT:
        there = distance(a, b, path_a.pose(found.latest), path_b.pose(found.latest))
        assert there.lower_bound <= clearance
        assert found.latest - found.time < 0.05


def test_a_path_at_rest() -> None:
    assert (
        so.time_of_impact(SLOT, ball(0.3), Fixed(STILL), Fixed(at(1, 1, 1.5)), 1.0).status
        is ImpactStatus.NO_IMPACT
    )


class Unproven:
    """A tracker that proves little from a time on: so told by how far B has come."""

    def __init__(self, lower: float) -> None:
        self.lower = lower

    def start(self, pose_a: so.Pose, pose_b: so.Pose) -> InstantAnswer:
        answer = distance(SLOT, ball(0.3), pose_a, pose_b)
        if pose_b.translation[0] > 1.2:
            answer = replace(answer, lower_bound=self.lower, status=so.Status.WITHIN)
        return InstantAnswer(answer)

    def step(
        self, before: InstantAnswer, *poses: so.Pose
    ) -> tuple[InstantAnswer, so.solids.SolidProximity]:
        now = self.start(*poses)
        return now, now.proximity


@pytest.mark.parametrize("lower", [-np.inf, 1e-10])
def test_what_is_not_proven_is_not_told_to_graze(lower: float) -> None:
    paths = Fixed(STILL), going(at(1.0, 1.0, 1.5), 0.25, 0, 0.25)
    boxes = BodyBox(SLOT), BodyBox(ball(0.3))
    search = SolidSearch(Unproven(lower), boxes, 5.0, paths, (0.0, 1e-9, 1000))
    found = search.run(0.0, 2.7)
    assert found.status is ImpactStatus.UNDECIDED
    assert found.time < 2.7


class Loose:
    """A tracker whose lower bound is 0, as parts miss each other by a slack."""

    def __init__(self, upper: float) -> None:
        self.upper = upper

    def start(self, pose_a: so.Pose, pose_b: so.Pose) -> InstantAnswer:
        answer = distance(SLOT, ball(0.3), pose_a, pose_b)
        return InstantAnswer(replace(answer, lower_bound=0.0, upper_bound=self.upper, slack=1e-4))

    def step(
        self, before: InstantAnswer, *poses: so.Pose
    ) -> tuple[InstantAnswer, so.solids.SolidProximity]:
        now = self.start(*poses)
        return now, now.proximity


@pytest.mark.parametrize(("upper", "status"), [(1.9e-4, "GRAZING"), (2.1e-4, "UNDECIDED")])
def test_solids_graze_where_they_are_near_but_for_their_slack(upper: float, status: str) -> None:
    paths = Fixed(STILL), Fixed(at(1.0, 1.0, 1.5))
    search = SolidSearch(
        Loose(upper), (BodyBox(SLOT), BodyBox(ball(0.3))), 0.0, paths, (0.0, 1e-9, 1000)
    )
    assert search.run(0.0, 1.0).status.name == status


@pytest.mark.parametrize("share", [1.0, 0.5, 0.3])
def test_whatever_span_is_proposed_it_is_never_late(share, monkeypatch) -> None:
    """A ball that flies through a slot's walls is far from them before and after: only the proof
    of the time between tells."""
    greedy = lambda self, gap, rate, target, longest: share * longest  # noqa: E731
    monkeypatch.setattr(Lipschitz, "ahead", greedy)
    path = going(at(-6.0, 1.0, 1.5), 12.0, 0.0, 0.0)
    found = so.time_of_impact(SLOT, ball(0.2), STILL, path, 1.0)
    assert found.status is not ImpactStatus.NO_IMPACT
    assert 0.3 < found.time <= 0.4 + 1e-9
