"""Paths that graze: a little more than the clearance is proven, a little less is found."""

from __future__ import annotations

import numpy as np
import pytest

import standoff as so
from robots.path_oracle import Judged, drawn_judged, least_distances
from robots.trees import robot_of
from standoff.robots import certify
from standoff.robots.proof import Verdict

CLEARANCE = 5e-3
BALL = so.shapes.sphere(0.05)


def moved(x: float, y: float, z: float) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, 3] = x, y, z
    return pose


def swinging(gap: float) -> tuple[object, np.ndarray]:
    """A ball on an arm of length 1 that passes a fixed ball at a least distance `gap`."""
    robot = robot_of(
        [1],
        [-1],
        [np.eye(4)],
        [[0, 0, 1.0]],
        [(0, BALL, moved(1, 0, 0))],
        fixed={"post": (BALL, moved(1.1 + gap, 0, 0))},
    )
    return robot, np.array([[-0.9], [1.1]])


def sliding(gap: float) -> tuple[object, np.ndarray]:
    """A box that slides along a table at a distance `gap` all the time."""
    robot = robot_of(
        [2],
        [-1],
        [np.eye(4)],
        [[1.0, 0, 0]],
        [(0, so.shapes.box((0.1, 0.1, 0.1)), moved(0, 0, 0.05))],
        fixed={"table": (so.shapes.box((3.0, 1.0, 0.2)), moved(0, 0, -0.1 - gap))},
    )
    return robot, np.array([[-1.0], [1.0]])


def turning(gap: float) -> tuple[object, np.ndarray]:
    """A lens on an arm that turns over a floor."""
    robot = robot_of(
        [1],
        [-1],
        [np.eye(4)],
        [[0, 0, 1.0]],
        [(0, so.shapes.capsule(0.05, 0.3), moved(1, 0, 0.2))],
        fixed={"floor": (so.shapes.halfspace([0.0, 0.0, 1.0], -gap), np.eye(4))},
    )
    return robot, np.array([[-3.0], [3.0]])


def crossing(gap: float) -> tuple[object, np.ndarray]:
    """Two slides that pass each other at once: both ways have their least distance in one place."""
    robot = robot_of(
        [2, 2],
        [-1, -1],
        [moved(0, 0, 0), moved(0, 0, 0.1 + gap)],
        [[1.0, 0, 0], [0, 1.0, 0]],
        [(0, BALL, np.eye(4)), (1, BALL, np.eye(4))],
    )
    return robot, np.array([[-0.5, 0.7], [0.5, -0.7]])


@pytest.mark.parametrize("case", [swinging, turning, crossing, sliding])
@pytest.mark.parametrize("margin", [1e-3, 1e-6, pytest.param(1e-9, marks=pytest.mark.soak)])
def test_a_little_more_is_proven_and_a_little_less_is_found(case: object, margin: float) -> None:
    robot, path = case(CLEARANCE + margin)
    proof = robot.certify(path, CLEARANCE)
    assert proof.verdict is Verdict.PROVEN
    assert CLEARANCE < proof.proven <= CLEARANCE + margin + 1e-12
    robot, path = case(CLEARANCE - margin)
    proof = robot.certify(path, CLEARANCE)
    assert proof.verdict is Verdict.VIOLATED
    assert proof.witness.upper_bound < CLEARANCE
    assert not proof


@pytest.mark.parametrize("case", [swinging, turning, crossing])
def test_exactly_the_clearance_is_not_decided(case: object) -> None:
    robot, path = case(CLEARANCE)
    proof = robot.certify(path, CLEARANCE, max_steps=20_000)
    assert proof.verdict is Verdict.UNDECIDED
    assert proof.witness is not None
    assert proof.time < proof.end
    assert str(proof).startswith("UNDECIDED")


def past_posts(gaps: list[float]) -> tuple[object, np.ndarray]:
    """A ball on an arm of length 1 that passes fixed balls at least distances `gaps`."""
    posts = {}
    for k, gap in enumerate(gaps):
        away = 1.1 + gap
        posts[f"post {k}"] = (BALL, moved(away * np.cos(k), away * np.sin(k), 0))
    robot = robot_of(
        [1], [-1], [np.eye(4)], [[0, 0, 1.0]], [(0, BALL, moved(1, 0, 0))], fixed=posts
    )
    return robot, np.array([[-0.5], [len(gaps) - 0.5]])


@pytest.mark.parametrize("batch", [4, 2048])
def test_a_violation_behind_an_undecided_instant_is_found(
    batch: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(certify, "BATCH", batch)
    robot, path = past_posts([CLEARANCE, 1.0, CLEARANCE - 1e-6, -0.1])
    proof = robot.certify(path, CLEARANCE)
    assert proof.verdict is Verdict.VIOLATED
    assert "post 2" in proof.witness.names
    (span,) = proof.undecided
    assert "post 0" in span.names
    assert span.start == proof.time < 0.125 < span.end < 0.126
    assert proof.latest == pytest.approx(0.625, abs=1e-3)
    between = np.linspace(span.end, 0.62, 50)
    assert (proof.steps.clearance(between) > CLEARANCE).all()
    assert np.isnan(proof.steps.clearance(np.array([0.125])))
    assert "undecided: " in str(proof)
    assert proof.as_dict()["undecided"][0]["end"] == span.end


@pytest.mark.parametrize("batch", [4, 2048])
def test_all_undecided_instants_are_listed(batch: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(certify, "BATCH", batch)
    robot, path = past_posts([CLEARANCE, 1.0, CLEARANCE, 1.0])
    proof = robot.certify(path, CLEARANCE)
    assert proof.verdict is Verdict.UNDECIDED
    assert not proof
    for span, at in zip(proof.undecided, (0.125, 0.625), strict=True):
        assert span.start < at < span.end
    assert proof.time == proof.undecided[0].start
    assert "and 1 more" in str(proof)
    open_ = np.isnan(proof.steps.clearance(np.linspace(0.0, 1.0, 10_001)))
    assert 1 <= open_.sum() < 10


def test_a_pair_at_the_clearance_all_the_time_ends_soon() -> None:
    robot, path = sliding(0.25)
    proof = robot.certify(path, 0.25)
    assert proof.verdict is Verdict.UNDECIDED
    (span,) = proof.undecided
    assert (span.start, span.end) == (0.0, 1.0)
    assert proof.counts.tried < 100_000


def test_what_the_budget_leaves_is_listed() -> None:
    robot, path = past_posts([CLEARANCE, CLEARANCE + 1e-3, CLEARANCE + 1e-3])
    proof = robot.certify(path, CLEARANCE, max_steps=20)
    assert proof.verdict is Verdict.UNDECIDED
    times = np.linspace(0.0, 1.0, 1000)
    within = np.zeros(len(times), dtype=bool)
    for span in proof.undecided:
        within |= (times >= span.start) & (times <= span.end)
    assert np.array_equal(np.isnan(proof.steps.clearance(times)), within)


def test_the_steps_of_a_grazing_path_grow_with_the_digits_alone() -> None:
    counts = []
    for margin in (1e-3, 1e-5, 1e-7):
        robot, path = swinging(CLEARANCE + margin)
        counts.append(robot.certify(path, CLEARANCE).counts.steps)
    assert counts[-1] < 60
    assert counts[2] - counts[1] < 3 * max(1, counts[1] - counts[0]) + 8


def least_on(judged: Judged, points: np.ndarray) -> float:
    """The least distance on a straight path, to 1e-12: samples, and closer ones beside the best."""

    def at(times: np.ndarray) -> np.ndarray:
        return least_distances(judged, points[0] + times[:, None] * (points[1] - points[0]))

    times = np.linspace(0.0, 1.0, 4001)
    each = at(times)
    best = float(each.min())
    for pair in np.flatnonzero(each.min(axis=0) < best + 1e-3):
        near, found = times, each[:, pair]
        for _ in range(4):
            k = int(np.argmin(found))
            near = np.linspace(near[max(k - 1, 0)], near[min(k + 1, len(near) - 1)], 101)
            found = at(near)[:, pair]
        best = min(best, float(found.min()))
    return best


def test_random_paths_that_graze_at_1e_6() -> None:
    rng = np.random.default_rng(6)
    tried = 0
    while tried < 25:
        judged = drawn_judged(rng, int(rng.integers(2, 8)))
        points = rng.uniform(-1.0, 1.0, judged.robot.nq) + rng.uniform(
            -0.6, 0.6, (2, judged.robot.nq)
        )
        least = least_on(judged, points)
        if least < 1e-3:
            continue
        tried += 1
        assert judged.robot.certify(points, least - 1e-6).verdict is Verdict.PROVEN
        found = judged.robot.certify(points, least + 1e-6)
        assert found.verdict is Verdict.VIOLATED
        assert found.witness.distance == pytest.approx(least, abs=1.1e-6)
