"""Times of impact: never late, in closed forms and in cases built backward from contact."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

import standoff as so
from families import impacts
from standoff.bodies.body import proven_again
from standoff.impact.moment import BodyBox, PairInstant
from standoff.impact.search import Chords
from standoff.motion import (
    Bounded,
    Carried,
    ConstantTwist,
    Fixed,
    Helix,
    Offset,
    PoseSamples,
    Screw,
    Spiral,
)
from standoff_studies import oracles as oracle

REST = so.Pose.identity()
LATE = 1e-12
"""Of the time and of the way: what rounding may do to a closed form."""


def at(*position: float) -> so.Pose:
    return so.Pose.exp([0.0, 0.0, 0.0], position)


def check(found: so.impact.Impact, truth: float, error: float, late: float = LATE) -> None:
    """The bracket holds the truth, and is no wider than `error` before it."""
    assert found.status is so.impact.ImpactStatus.IMPACT, found
    assert found.time <= truth + late, found
    assert truth <= found.latest + late, found
    assert truth - found.time <= error, found
    assert found.proximity.lower_bound > found.clearance


def first_meeting(offset: Any, velocity: Any, reach: float) -> float | None:
    """The first t with |offset + velocity t| = reach."""
    a, b = velocity @ velocity, offset @ velocity
    inside = b * b - a * (offset @ offset - reach * reach)
    if inside < 0.0 or b > 0.0:
        return None
    return float((offset @ offset - reach * reach) / (-b + math.sqrt(inside)))


def test_spheres_on_straight_lines_at_any_clearance(rng: np.random.Generator) -> None:
    for _ in range(30):
        radii, size = rng.uniform(0.1, 1.0, 2), 10.0 ** rng.uniform(-3, 3)
        a, b = (so.shapes.sphere(float(r * size)) for r in radii)
        clearance = float(rng.choice([0.0, rng.uniform(0, 1) * size]))
        reach = radii.sum() * size + clearance
        offset = reach * rng.uniform(1.1, 4.0) * impacts.unit(rng.normal(size=(1, 3)))[0]
        v_a, v_b = rng.normal(size=(2, 3)) * size
        v_b -= offset * rng.uniform(0, 3)
        spin = rng.normal(size=3) * 10.0
        paths = ConstantTwist(REST, (v_a, spin)), ConstantTwist(at(*offset), (v_b, -spin))
        found = so.time_of_impact(a, b, *paths, 5.0, clearance=clearance)
        truth = first_meeting(offset, v_b - v_a, reach)
        if truth is None or truth > 5.0:
            nearest = np.linalg.norm(
                offset + (v_b - v_a) * np.linspace(0, 5, 2001)[:, None], axis=1
            ).min()
            assert found.status is so.impact.ImpactStatus.NO_IMPACT or nearest - reach < 1e-6 * size
            continue
        closing = -(offset + (v_b - v_a) * truth) @ (v_b - v_a) / reach
        if closing > 1e-3 * size:
            check(found, truth, 1e-8 * size / closing)


@pytest.mark.parametrize("swapped", [False, True])
def test_an_ellipsoid_that_falls_and_turns_meets_the_ground(
    swapped: bool, rng: np.random.Generator
) -> None:
    axes = np.array([0.3, 0.2, 0.1])
    body, ground = so.shapes.ellipsoid(*axes), so.shapes.halfspace()
    for _ in range(10):
        omega = rng.normal(size=3) * 5.0
        speed = 0.3 * float(np.linalg.norm(omega)) + rng.uniform(0.1, 1.0)
        path = ConstantTwist(at(0.0, 0.0, 3.0), ([0.4, 0.0, -speed], omega))

        def height(t: float, path: Any = path) -> float:
            pose = path.pose(t)
            return float(pose.translation[2] - np.linalg.norm(axes * pose.rotation[2]))

        truth = brentq(height, 0.0, 4.0 / speed, xtol=1e-15)
        pair, paths = (body, ground), (path, REST)
        if swapped:
            pair, paths = pair[::-1], paths[::-1]
        found = so.time_of_impact(*pair, *paths, 4.0 / speed)
        check(found, truth, 1e-7)
        assert abs(found.normal[2]) == pytest.approx(1.0)


def test_a_half_space_may_turn_too() -> None:
    """The same relative motion, seen from the ground and from the body."""
    box = so.shapes.box(0.3, 0.2, 0.1)
    path = Screw(at(0.0, 0.0, 1.0), [1.0, 0.2, 0.0], (0.0, 0.7, 0.7), angular_rate=0.7)
    ground = so.shapes.halfspace()

    class Inverse:
        def pose(self, t: float) -> so.Pose:
            return path.pose(t).inverse()

        def twist(self, t: float) -> so.Twist:
            pose, twist = path.pose(t), path.twist(t)
            back = pose.rotation.T
            return so.Twist(
                back @ (np.cross(twist.omega, pose.translation) - twist.v), -back @ twist.omega
            )

    wall = Bounded(
        Inverse(), speed=1.1, acceleration=1.5, angular_speed=0.7, angular_acceleration=0.0
    )
    first = so.time_of_impact(box, ground, path, REST, 8.0)
    second = so.time_of_impact(box, ground, REST, wall, 8.0)
    assert first.status is second.status is so.impact.ImpactStatus.IMPACT
    assert max(first.time, second.time) <= min(first.latest, second.latest)
    assert first.time == pytest.approx(second.time, abs=1e-7)


def test_the_corner_of_a_box_meets_the_ground() -> None:
    box, ground = so.shapes.box(1.0, 1.0, 1.0), so.shapes.halfspace()
    path = Screw(at(0.0, 0.0, 0.8), [1.0, 0.0, 0.0], (0.0, 0.0, 0.8), angular_rate=0.5)
    # its lowest edge is at 0.8 - sin(45° + angle) / sqrt(2): it never reaches down to 0.05
    found = so.time_of_impact(box, ground, path, REST, 10.0, clearance=0.05)
    assert found.status is so.impact.ImpactStatus.NO_IMPACT
    assert found.evaluations < 200
    found = so.time_of_impact(box, ground, path, REST, 10.0, clearance=0.15)
    truth = 2.0 * (math.asin(0.65 * math.sqrt(2.0)) - math.pi / 4)
    check(found, truth, 1e-7)


@pytest.mark.parametrize("beyond", [1e-3, 1e-6, 1e-8])
def test_spheres_that_pass_each_other_closely(beyond: float) -> None:
    a, b = so.shapes.sphere(1.0), so.shapes.sphere(0.5)
    for offset, reaches in ((1.5 + beyond, False), (1.5 - beyond, True)):
        path = ConstantTwist(at(5.0, offset, 0.0), ([-1.0, 0.0, 0.0], [0.0, 3.0, 0.0]))
        found = so.time_of_impact(a, b, REST, path, 10.0, tolerance=1e-10)
        assert found.evaluations < 60
        if reaches:
            truth = 5.0 - math.sqrt(1.5**2 - offset**2)
            check(found, truth, 2e-9 / math.sqrt(beyond))
        else:
            assert found.status is so.impact.ImpactStatus.NO_IMPACT, found


def test_spheres_that_only_touch() -> None:
    a, b = so.shapes.sphere(1.0), so.shapes.sphere(0.5)
    path = ConstantTwist(at(5.0, 1.5, 0.0), ([-1.0, 0.0, 0.0], [0.0, 3.0, 0.0]))
    found = so.time_of_impact(a, b, REST, path, 10.0)
    assert found.status in (so.impact.ImpactStatus.GRAZING, so.impact.ImpactStatus.IMPACT)
    assert 5.0 - 2e-4 < found.time <= 5.0
    assert found.time <= found.latest
    assert found.evaluations < 60


@pytest.mark.parametrize("kind", ["closing", "passing", "swinging", "free"])
def test_never_late_where_the_contact_is_known(kind: str, rng: np.random.Generator) -> None:
    sharp = 0
    for _ in range(6):
        a, b = impacts.draw_twins(rng)
        for _ in range(4):
            case = impacts.draw_case(kind, a, b, rng)
            found = so.time_of_impact(
                a.body, b.body, case.path_a, case.path_b, case.duration, clearance=case.clearance
            )
            assert impacts.judge(case, found) == "", case.describe()
            sharp += found.latest >= case.time
    assert sharp > 0 or kind == "passing"


def test_the_separation_along_the_normal_is_no_less_than_the_lower_bound(
    rng: np.random.Generator,
) -> None:
    """What the proof of an interval rests on, at its ends; also where the answer is off."""
    for _ in range(40):
        a, b = impacts.draw_twins(rng)
        if any(isinstance(twin.shape, oracle.HalfSpace) for twin in (a, b)):
            continue
        pair = impacts.exact_pair(a.shape, b.shape, float(10.0 ** rng.uniform(-6, 0)), rng)
        size = a.shape.bounding_radius + b.shape.bounding_radius
        rough = so.Tracker(a.body, b.body, law=so.PredictorCorrector(tolerance=math.inf))
        state = rough.start(pair.pose_a, pair.pose_b)
        turn = so.Pose.exp([0.0, 0.0, 0.2]).rotation @ pair.b.rotation
        moved = oracle.Placed(b.shape, turn, pair.b.position + 0.3 * size * pair.normal)
        _, wrong = rough.step(state, pair.pose_a, (moved.rotation, moved.position))
        for placed, found in ((pair.b, state.proximity), (moved, wrong)):
            n = found.normal
            separation = -pair.a.support(n)[0] - placed.support(-n)[0]
            assert separation >= found.lower_bound - 1e-14 * (size + 1.0)


@pytest.mark.parametrize("wall", [False, True])
def test_no_separation_sags_below_the_bound(wall: bool, rng: np.random.Generator) -> None:
    """The inequality that proves an interval, against support functions inside of it."""
    blade, bar = oracle.SharpBox(2.0, 0.1, 0.1), so.shapes.box(2.0, 0.1, 0.1)
    shapes = blade, oracle.HalfSpace() if wall else blade
    tracker = so.Tracker(bar, so.shapes.halfspace() if wall else bar)
    boxes = BodyBox(tracker.a), BodyBox(tracker.b)
    for _ in range(100):
        place = np.array([0.0, 0.0, -4.0]) if wall else np.array([0.0, 0.0, 4.0])
        paths = [
            ConstantTwist(so.Pose.exp(turn, at), so.Twist(v, omega, frame))
            for turn, at, v, omega, frame in (
                (rng.normal(size=3), np.zeros(3), rng.normal(size=3), rng.normal(size=3), "world"),
                (np.zeros(3), place, rng.normal(size=3) * 0.3, rng.normal(size=3) * 0.4, "body"),
            )
        ]
        first, last = (PairInstant(boxes, (paths[0], paths[1]), t) for t in (0.0, 0.4))
        for moment in (first, last):
            moment.ask(tracker, None)
        if min(first.lower, last.lower) <= 0.0:
            continue
        chords = Chords(boxes, (paths[0], paths[1]))
        chords.prepare(first, 0.4)
        sag = chords.sag(first, last, balls=False)
        for share in np.linspace(0.0, 1.0, 9):
            a, b = (
                oracle.Placed(shape, pose.rotation, pose.translation)
                for shape, pose in zip(
                    shapes, (path.pose(0.4 * share) for path in paths), strict=True
                )
            )
            n = -b.rotation[:, 2]
            if not wall:
                n = (1 - share) * first.normal + share * last.normal
            facing = n @ b.position if wall else -b.support(-n)[0]
            bound = (1 - share) * first.lower + share * last.lower - share * (1 - share) * sag
            assert facing - a.support(n)[0] >= bound - 1e-12


def test_nothing_slips_through() -> None:
    """A bullet through a foil, in a thousandth of the duration's thousandth."""
    bullet, foil = so.shapes.sphere(1e-3), so.shapes.cylinder(9.0, 0.0025)
    path = ConstantTwist(at(0.1, 0.2, -100.0), ([0.0, 0.0, 1e4], [0.0, 0.0, 0.0]))
    found = so.time_of_impact(foil, bullet, REST, path, 1.0)
    check(found, (100.0 - 0.00125 - 0.001) / 1e4, 1e-11)


def test_a_fast_spinning_blade() -> None:
    blade, ball = so.shapes.box(2.0, 0.1, 0.02), so.shapes.sphere(0.1)
    spin = ConstantTwist(REST, ([0.0, 0.0, 0.0], [0.0, 0.0, 1000.0]))
    # out of its reach: proven by the bounding balls, whatever the spin
    found = so.time_of_impact(blade, ball, spin, at(1.5, 0.0, 0.0), 100.0)
    assert found.status is so.impact.ImpactStatus.NO_IMPACT
    assert found.evaluations < 5
    # within it: the blade's leading face reaches the ball in less than a turn
    found = so.time_of_impact(blade, ball, spin, at(0.0, -0.8, 0.0), 100.0)
    truth = (1.5 * math.pi - math.pi - math.asin(0.15 / 0.8)) / 1000.0
    check(found, truth, 1e-10)


def test_bodies_that_do_not_move() -> None:
    a, b = so.shapes.sphere(1.0), so.shapes.box(1.0, 1.0, 1.0)
    found = so.time_of_impact(a, b, REST, at(3.0, 0.0, 0.0), 1e6)
    assert found.status is so.impact.ImpactStatus.NO_IMPACT
    assert (found.time, found.evaluations) == (1e6, 2)
    assert math.isnan(found.latest)
    assert math.isnan(found.error)


def test_in_contact_at_the_start() -> None:
    a, b = so.shapes.sphere(1.0), so.shapes.box(1.0, 1.0, 1.0)
    away = ConstantTwist(at(1.2, 0.0, 0.0), ([1.0, 0.0, 0.0], [0.0, 0.0, 0.0]))
    found = so.time_of_impact(a, b, REST, away, 1.0)
    assert (found.status, found.time, found.latest) == (so.impact.ImpactStatus.AT_START, 0.0, 0.0)
    found = so.time_of_impact(a, b, REST, away, 1.0, start=0.5)
    assert (found.status, found.time) == (so.impact.ImpactStatus.NO_IMPACT, 1.5)
    found = so.time_of_impact(a, b, REST, away, 1.0, start=0.5, clearance=0.3)
    assert found.status is so.impact.ImpactStatus.AT_START


def test_planar_bodies(rng: np.random.Generator) -> None:
    from families.shapes import loop

    twin = loop(rng)
    path = ConstantTwist(at(8.0, 0.5, 0.0), ([-1.0, 0.0, 0.0], [0.0, 0.0, 0.3]))
    found = so.time_of_impact(twin.body, twin.body, REST, path, 20.0)
    assert found.status is so.impact.ImpactStatus.IMPACT
    assert found.normal[2] == 0.0
    assert found.error < 1e-6


def test_every_kind_of_path() -> None:
    """A dense sample of distances agrees with the bracket."""
    a, b = so.shapes.capsule(0.2, 1.0), so.shapes.box(0.5, 0.3, 0.4, 0.05)
    tilt = so.Pose.exp([0.4, 0.2, 0.1], [0.3, 0.0, 0.0])
    poses = [so.Pose.exp([0.3 * k, 0.1, 0.2 * k], [3.0 - k, 0.2 * k, 0.0]) for k in range(5)]
    paths = [
        ConstantTwist(at(3.0, 0.0, 0.0), so.Twist([-1.0, 0.0, 0.0], [0.0, 0.5, 0.2], "body")),
        Screw(at(2.0, 0.0, 0.5), [0.0, 0.0, 1.0], (1.2, 0.0, 0.0), 1.5, 0.3),
        Helix(1.5, 0.4, 2.0, (1.6, 0.0, -0.5), (0.0, 1.0, 0.0), 0.2, "turning"),
        Spiral(2.5, -0.3, 1.0, (0.1, 0.0), 0.3, "turning"),
        Offset(Spiral(2.5, -0.3, 1.0, (0.1, 0.0), 0.3, "turning"), tilt),
        Carried(
            Helix(1.5, -0.4, 2.0, (1.6, 0.0, 0.5)), ConstantTwist(tilt, ([0, 0, 0], [3, 2, 1]))
        ),
        PoseSamples([0.0, 0.7, 1.5, 1.9, 4.0], poses),
        Carried(Fixed(tilt), PoseSamples([0.0, 0.7, 1.5, 1.9, 4.0], poses)),
    ]
    for path in paths:
        found = so.time_of_impact(a, b, Fixed(REST), path, 4.0)
        times = np.append(np.linspace(0.0, found.time, 60), found.time)
        apart = [so.distance(a, b, REST, path.pose(t)).lower_bound for t in times]
        assert min(apart) > 0.0
        if found.status is so.impact.ImpactStatus.IMPACT:
            assert apart[-1] < 2.0 * found.tolerance
            touching = so.distance(a, b, REST, path.pose(found.latest))
            assert not touching.lower_bound > 0.0
        else:
            assert (found.status, found.time) == (so.impact.ImpactStatus.NO_IMPACT, 4.0)


def test_a_path_of_ones_own_needs_a_bound() -> None:
    class Oscillating:
        def pose(self, t: float) -> so.Pose:
            return at(2.0 + math.cos(t), 0.0, 0.0)

        def twist(self, t: float) -> so.Twist:
            return so.Twist([-math.sin(t), 0.0, 0.0], [0.0, 0.0, 0.0])

    a, b = so.shapes.sphere(0.6), so.shapes.sphere(0.9)
    with pytest.raises(TypeError, match="wrap it in standoff"):
        so.time_of_impact(a, b, REST, Oscillating(), 4.0)
    path = Bounded(
        Oscillating(), speed=1.0, acceleration=1.0, angular_speed=0.0, angular_acceleration=0.0
    )
    check(so.time_of_impact(a, b, REST, path, 4.0), math.acos(-0.5), 1e-7)


def test_a_small_budget_proves_what_it_can() -> None:
    blade, ball = so.shapes.box(2.0, 0.1, 0.02), so.shapes.sphere(0.1)
    spin = ConstantTwist(REST, ([0.0, 0.0, 0.0], [0.0, 0.0, 100.0]))
    above = at(0.9, 0.0, 0.12)
    found = so.time_of_impact(blade, ball, spin, above, 100.0, max_evaluations=50)
    assert found.status is so.impact.ImpactStatus.UNDECIDED
    assert 0.0 < found.time < 100.0
    assert found.evaluations == 50
    assert "max_evaluations" in found.status.advice


def test_the_status_says_what_to_do() -> None:
    assert all(status.advice.endswith(".") for status in so.impact.ImpactStatus)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"clearance": -0.1}, "clearance = -0.1: give zero or more"),
        ({"clearance": math.nan}, "clearance = nan"),
        ({"tolerance": 0.0}, "tolerance = 0.0"),
        ({"duration": -1.0}, "duration = -1.0"),
        ({"start": math.inf}, "start = inf"),
        ({"max_evaluations": 1}, "max_evaluations = 1"),
        ({"max_evaluations": 2.5}, "max_evaluations = 2.5: must be a whole number"),
        ({"max_evaluations": None}, "max_evaluations = None: must be a whole number"),
        ({"max_evaluations": "5"}, "max_evaluations = '5': must be a whole number"),
        ({"max_evaluations": math.nan}, "max_evaluations = nan: must be a whole number"),
        ({"duration": True}, "duration = True is not a number"),
        ({"tolerance": True}, "tolerance = True is not a number"),
        ({"duration": 10**400}, "is not a number"),
        ({"duration": 1e308}, r"duration = 1e\+308: beyond 1e\+50"),
        ({"start": -1e200}, r"start = -1e\+200: beyond 1e\+50"),
    ],
)
def test_bad_input_is_refused(options: dict[str, Any], message: str) -> None:
    body = so.shapes.sphere(1.0)
    given = {"duration": 1.0, **options}
    with pytest.raises(ValueError, match=message):
        so.time_of_impact(body, body, REST, at(3.0, 0.0, 0.0), **given)


def test_a_path_that_ends_before_is_refused() -> None:
    body = so.shapes.sphere(1.0)
    path = PoseSamples([0.0, 1.0], [at(3.0, 0.0, 0.0), at(4.0, 0.0, 0.0)])
    with pytest.raises(ValueError, match=r"= 1\.5, but a path ends at 1\.0"):
        so.time_of_impact(body, body, REST, path, 1.5)


def loose_disc() -> so.Body:
    """Of height 1, whose parts are known to miss each other by up to 1e-4: that is its slack."""
    disc = so.shapes.cylinder(1.0, 1.0)
    parts = disc.vertex_points, disc.edge_parts, disc.face_parts
    return proven_again(parts, "loose", 0.0, 1e-3, 1e-4)


@pytest.mark.parametrize(
    ("make", "upper", "slacks", "status"),
    [
        (lambda: so.shapes.sphere(0.5), 1e-9, 0.0, "GRAZING"),
        (lambda: so.shapes.sphere(0.5), 0.3, 0.0, "UNDECIDED"),
        (lambda: so.shapes.sphere(0.5), math.inf, 0.0, "UNDECIDED"),
        # the lower bound is less by the slack of both: they may be as far apart again
        (loose_disc, 0.0, 3.9, "GRAZING"),
        (loose_disc, 0.0, 4.1, "UNDECIDED"),
    ],
)
def test_bodies_graze_only_where_they_are_proven_near(
    monkeypatch, make, upper, slacks, status
) -> None:
    """Of bodies that touch, with answers that prove no more than the bounds that are given."""
    ask, body = PairInstant.ask, make()

    def asked(moment, tracker, before):
        ask(moment, tracker, before)
        moment.lower, moment.upper = -1.0, upper + slacks * body.report.slack

    monkeypatch.setattr(PairInstant, "ask", asked)
    found = so.time_of_impact(body, body, REST, Fixed(at(0.0, 0.0, 1.0)), 1.0)
    assert found.status.name == status
