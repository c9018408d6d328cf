"""What overlaps are told to be at least and at most: pressed fits, whose interference is known, and
what no proof may say of it; ways out of deep overlaps, in space and in the plane."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import standoff as so
from draws import draws
from families.solid_shapes import (
    ball,
    bolt,
    peg,
    prism,
    samples,
    socket,
    taper_bore,
    taper_plug,
    tube,
)
from shares import only
from standoff.clearance import Fit, Wanted, check
from standoff.solids import Solid, distance
from standoff.solids.spatial.held import depth_bound
from standoff.solids.spatial.models import as_model
from standoff.solids.spatial.pair import PlacedPair
from standoff.solids.spatial.points import signed_distances
from standoff.tracking.status import Status

STILL = so.Pose.identity()
TOLERANCE = 1e-9


def deepest(a: Solid, b: Solid, pose: so.Pose) -> float:
    """How deep points of one boundary are in the other solid, by samples."""
    R, p = np.asarray(pose.rotation), np.asarray(pose.translation)
    in_a, in_b = samples(b, 8) @ R.T + p, (samples(a, 8) - p) @ R
    return max(
        float(-signed_distances(solid, spots).distance.min())
        for solid, spots in ((a, in_a), (b, in_b))
    )


PRESSED: dict[str, Callable[[float], tuple[Solid, Solid, float]]] = {
    "through": lambda h: (tube(1.0, 2.0, 0.0, 1.0), peg(1.0 + h, -0.5, 1.5), h),
    "flush": lambda h: (tube(1.0, 2.0, 0.0, 1.0), peg(1.0 + h, 0.0, 1.0), h),
    "half out": lambda h: (tube(1.0, 2.0, 0.0, 1.0), peg(1.0 + h, 0.2, 1.7), h),
    "taper": lambda h: (
        taper_bore(0.2, -6.0, 4.0, 0.0, 2.0),
        taper_plug(0.2, -6.0 - h * np.hypot(1.0, 0.2) / 0.2, -0.5, 2.5),
        h,
    ),
    "socket": lambda h: (socket(1.0, 2.0), ball(1.0 + h), h),
}
"""Of an interference both solids, and how deep they are in each other."""


@pytest.mark.parametrize("name", only(("through", "taper"), PRESSED))
def test_nothing_is_held_at_less_than_it_is_deep(name: str, rng: np.random.Generator) -> None:
    """The proof is asked for more and less than the truth, whatever a query would ask."""
    proven = 0
    for _ in range(draws(6)):
        h = float(rng.uniform(0.002, 0.02))
        a, b, deep = PRESSED[name](h)
        way = rng.normal(size=3) * (0.0 if rng.random() < 0.5 else 0.3 * h)
        way[2] *= name == "socket"
        off = float(np.linalg.norm(way))
        pose = so.Pose(np.eye(3), way)
        pair = PlacedPair(as_model(a), as_model(b), STILL, pose)
        found = max(deepest(a, b, pose), deep)
        for share in (0.5, 0.9, 0.98):
            assert depth_bound(pair, TOLERANCE, share * found) == np.inf
        bound = depth_bound(pair, TOLERANCE, 1.02 * (deep + off))
        proven += bound < np.inf
        assert bound >= found - TOLERANCE
    assert proven


def test_a_thin_neck_is_not_held() -> None:
    """Half of a dumbbell is in a block that crosses its neck, which is thinner than the depth."""
    bell = prism([(-3, -1), (-1, -1), (-1, -0.05), (1, -0.05), (1, -1), (3, -1), (3, 1), (1, 1),
                  (1, 0.05), (-1, 0.05), (-1, 1), (-3, 1)], 2.0)  # fmt: skip
    block = prism([(0, -2), (5, -2), (5, 2), (0, 2)], 4.0)
    told = distance(bell, block, STILL, so.Pose(np.eye(3), [0.0, 0.0, -1.0]))
    assert told.overlap is not None
    assert told.overlap.depth > 1.5
    assert told.overlap.held == np.inf
    assert told.upper_bound <= -1.5
    assert told.lower_bound >= -3.2


def test_the_interference_of_a_fit_is_checked_by_the_report() -> None:
    bodies = {"hub": tube(2.0, 5.0, 0.0, 4.0), "pin": peg(2.025, -1.0, 5.0)}
    world, places = so.World(bodies), dict.fromkeys(bodies, STILL)
    for gap, holds in (((-0.03, -0.02), True), ((-0.025, np.inf), True), ((-0.02, np.inf), False)):
        wanted = Wanted(least=0.1, fits=[Fit("hub", "pin", gap, "pressed in")])
        (row,) = check(world, places, wanted).rows
        assert row.answer.status is Status.OVERLAPPING
        assert (row.failure == "") is holds
    assert "held all round" in row.failure
    assert row.answer.lower_bound == pytest.approx(-0.025, abs=1e-7)
    assert row.answer.upper_bound == pytest.approx(-0.025, abs=1e-7)
    assert row.answer.overlap.way == pytest.approx(5.0, rel=1e-3)


DEEP = [((3.0, 3.0, 0.0), 4.0, 2.0), ((3.0, 3.0, -2.0), 2.0, 1.0), ((0.0, 0.0, 0.0), 4.0, 2.0)]


@pytest.mark.parametrize(("shift", "least", "radius"), DEEP)
def test_a_box_that_is_deep_in_another_one(
    shift: tuple[float, ...], least: float, radius: float
) -> None:
    ten, four = (prism([(0, 0), (w, 0), (w, w), (0, w)], w) for w in (10.0, 4.0))
    told = distance(ten, four, STILL, so.Pose(np.eye(3), shift))
    assert told.overlap is not None
    assert 0.8 * radius <= told.overlap.radius <= radius
    assert told.lower_bound == pytest.approx(-least, rel=2e-3)
    assert -least - 1e-9 <= told.upper_bound <= -0.99 * least
    assert told.overlap.reason == ""
    moved = so.Pose(np.eye(3), np.add(shift, told.overlap.parting))
    assert distance(ten, four, STILL, moved).distance >= 0.0


def drawn_in(a: Solid, b: Solid, rng: np.random.Generator) -> list[so.Pose]:
    """B goes into A, and turns, in frames."""
    way, turn, spin = rng.normal(size=3), rng.normal(size=3), 0.2 * rng.normal(size=3)
    far = 0.5 * (a.size + b.size) * way / np.linalg.norm(way)
    return [
        so.Pose.exp(s * spin, (1.0 - s) * far) @ so.Pose.exp(turn)
        for s in np.linspace(0.0, 1.0, 40)
    ]


@pytest.mark.parametrize("names", [("tube", "bolt"), ("bridge", "ball"), ("bridge", "bridge")])
def test_a_plane_comes_between_the_solids_of_a_frame_by_a_move(
    names: tuple[str, str], rng: np.random.Generator
) -> None:
    """In frames too an overlap has both bounds. All samples of A are below those of B after it."""
    bridge = prism([(0, 0), (3, 0), (3, 1), (2, 1), (2, 0.5), (1, 0.5), (1, 1), (0, 1)], 1.0)
    shapes = {"tube": tube(1.0, 2.0, 0.0, 1.0), "bolt": bolt(), "bridge": bridge, "ball": ball(0.7)}
    a, b = (shapes[name] for name in names)
    overlaps = 0
    for _ in range(draws(4)):
        tracker, poses = so.Tracker(a, b), drawn_in(a, b, rng)
        _, answers = tracker.run(tracker.start(STILL, poses[0]), STILL, poses)
        for answer, pose in zip(answers, poses, strict=True):
            if answer.status is not Status.OVERLAPPING or answer.counts.restarts:
                continue
            way, overlaps = answer.overlap.parting, overlaps + 1
            assert answer.lower_bound <= answer.distance <= answer.upper_bound < 0.0
            n = way / np.linalg.norm(way)
            moved = samples(b, 8) @ np.asarray(pose.rotation).T + pose.translation + way
            assert (samples(a, 8) @ n).max() <= (moved @ n).min()
    assert overlaps


@pytest.mark.parametrize("turn", [(0.0, 0.0, 0.0), (0.0, 0.0, 0.3)])
def test_a_frame_draws_what_is_round_out_as_far_as_it_is_in(turn: tuple[float, ...]) -> None:
    """Straight up, which is also the normal: to the top of the cylinder that lies, in closed form,
    and not of its box, which a turn makes higher."""
    table = prism([(-4, -4), (4, -4), (4, 4), (-4, 4)], 1.0)
    lying = so.Pose.exp((np.pi / 2, 0.0, 0.0)) @ so.Pose.exp(turn)
    tracker = so.Tracker(table, peg(1.0, -2.0, 2.0))
    poses = [so.Pose.exp((0, 0, 0), (0.0, 0.0, 2.0 - 0.01 * k)) @ lying for k in range(12)]
    _, answers = tracker.run(tracker.start(STILL, poses[0]), STILL, poses)
    assert answers[-1].status is Status.OVERLAPPING
    assert answers[-1].lower_bound == pytest.approx(-0.11, abs=1e-9)


def test_a_box_is_parted_from_a_half_space_along_its_normal() -> None:
    floor, pose = so.shapes.halfspace((0.0, 0.6, 0.8)), so.Pose(np.eye(3), [0.0, 0.0, 0.0])
    told = distance(floor, Solid(so.shapes.box((2.0, 1.0, 1.0))), STILL, pose)
    deep = 0.5 * (0.6 + 0.8)
    assert told.overlap is not None
    assert told.upper_bound == pytest.approx(-deep, rel=0.02)
    assert told.overlap.parting == pytest.approx(
        deep * np.array([0.0, 0.6, 0.8]), rel=2e-3, abs=1e-9
    )


def test_bounds_that_are_far_from_each_other_say_why() -> None:
    """A thick pin in a bore leaves it sideways or along it, and no common point is deep."""
    told = distance(tube(1.0, 5.0, 0.0, 6.0), peg(1.4, -1.0, 7.0), STILL, STILL)
    assert told.overlap is not None
    assert -np.inf < told.lower_bound <= -0.4
    assert told.upper_bound == pytest.approx(-0.4, abs=1e-6)
    if told.lower_bound < -1.0:
        assert "no translation shorter than 0.4" in told.overlap.reason


def test_solids_that_nearly_fill_each_other_are_not_held() -> None:
    """Neither boundary is deep in the other, and both solids are."""
    pose = so.Pose(np.eye(3), [0.01, 0.0, 0.0])
    pair = PlacedPair(as_model(ball(1.0)), as_model(ball(1.0)), STILL, pose)
    assert depth_bound(pair, TOLERANCE, 0.02) == np.inf
    told = distance(ball(1.0), ball(1.0), STILL, pose)
    assert -2.1 <= told.lower_bound <= -1.99 <= told.upper_bound <= -1.9


def test_a_depth_is_climbed_to() -> None:
    """Of two elbows the least way out is along their thickness, 0.9."""
    corners = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)]
    pose = so.Pose.exp((0.0, 0.0, 0.0), (0.2, 0.3, 0.1))
    told = distance(prism(corners, 1.0), prism(corners, 1.0), STILL, pose)
    assert told.lower_bound == pytest.approx(-0.9, rel=2e-3)
    assert -0.9 <= told.upper_bound <= -0.88
