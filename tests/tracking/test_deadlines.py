"""Steps with few evaluations: what they answer, and that a frame goes on where the last ended."""

from __future__ import annotations

import numpy as np
import pytest

import standoff as so
from oracles.exact_pairs import random_rotation

s = so.shapes
HOME = so.Pose.identity()
BOX = s.box(1, 1, 1)
DEPTHS = (so.Status.LOCAL, so.Status.GLOBAL)


def teleported(b, deadline, pose, frames, a=BOX):
    """Answers at one pose, after a start far away."""
    tracker = so.Tracker(a, b, law=so.PredictorCorrector(deadline=deadline))
    state = tracker.start(HOME, so.Pose.exp([0.1, 0.2, 0.3], [3.0, 0.2, 0.1]))
    answers = []
    for _ in range(frames):
        state, answer = tracker.step(state, HOME, pose)
        answers.append(answer)
    return answers


@pytest.mark.parametrize("deadline", [1, 2, 5, 20])
@pytest.mark.parametrize(
    ("body", "place", "depth"),
    [
        (s.point(), (0.1, 0.05, 0.02), 0.4),
        (s.sphere(0.4), (0.1, 0.05, 0.02), 0.8),
        (s.capsule(0.2, 0.5), (0.3, 0.1, 0.02), 0.4),
    ],
    ids=["point", "ball", "capsule"],
)
def test_a_teleport_into_a_box_is_followed(body, place, depth, deadline):
    answers = teleported(body, deadline, so.Pose.exp([0, 0, 0], place), 40)
    assert all(x.counts.evaluations <= deadline for x in answers)
    assert all(x.lower_bound <= -depth <= x.upper_bound + 1e-12 for x in answers)
    assert answers[-1].status in DEPTHS
    assert answers[-1].distance == pytest.approx(-depth, abs=1e-9) or (
        answers[-1].status is so.Status.LOCAL and answers[-1].distance < -depth
    )


MIXED = {
    "polytope": s.polytope(np.vstack([np.eye(3), -np.eye(3)]) * [0.5, 0.4, 0.3]),
    "ellipsoid": s.ellipsoid(0.5, 0.3, 0.2),
    "cylinder": s.cylinder(0.3, 1),
    "superellipsoid": s.superellipsoid(0.5, 0.4, 0.3, 0.5, 0.5),
    "box": s.box(0.5, 0.6, 0.7),
    "lens": s.lens(0.5, 0.2),
}


@pytest.mark.parametrize("deadline", [3, 5, 20])
@pytest.mark.parametrize("name", MIXED)
def test_a_depth_is_reached_in_turns(name, deadline, rng):
    for _ in range(4):
        pose = so.Pose(random_rotation(rng), 0.3 * random_rotation(rng)[0])
        truth = so.distance(BOX, MIXED[name], HOME, pose)
        answers = teleported(MIXED[name], deadline, pose, 150)
        for answer in answers:
            assert answer.status in (*DEPTHS, so.Status.DEADLINE, so.Status.CONVERGED)
            assert answer.counts.evaluations <= deadline
            assert answer.lower_bound <= truth.distance + 1e-9
            assert answer.upper_bound >= truth.lower_bound - 1e-9
        assert answers[-1].status in (*DEPTHS, so.Status.CONVERGED)
        assert answers[-1].distance <= truth.distance * (1.0 - 1e-3) + 1e-9


@pytest.mark.parametrize("name", MIXED)
def test_apart_one_evaluation_a_step_arrives(name, rng):
    for _ in range(4):
        pose = so.Pose(random_rotation(rng), 2.0 * random_rotation(rng)[0])
        truth = so.distance(BOX, MIXED[name], HOME, pose)
        last = teleported(MIXED[name], 2, pose, 250)[-1]
        assert last.status is so.Status.CONVERGED
        assert last.distance == pytest.approx(truth.distance, abs=1e-8)


@pytest.mark.parametrize("dt", [1e-3, 4e-3])
def test_the_papers_law_enters_an_overlap(dt, rng):
    """It lags behind as the bodies meet: the depth is followed all the same, not only proven."""
    for name in MIXED:
        turn, way = random_rotation(rng), random_rotation(rng)[0]
        far = so.distance(BOX, MIXED[name], HOME, so.Pose(turn, 3.0 * way))
        v = -2.0 * far.normal
        start = 3.0 * way - far.normal * (far.distance - 0.1)
        tracker = so.Tracker(BOX, MIXED[name], dt=dt, law=so.PaperLaw())
        state = tracker.start(HOME, so.Pose(turn, start), twist_b=(v, np.zeros(3)))
        for k in range(1, int(0.1 / dt)):
            pose = so.Pose(turn, start + v * k * dt)
            state, answer = tracker.step(state, HOME, pose, twist_b=(v, np.zeros(3)))
            assert answer.status is not so.Status.OVERLAPPING
        truth = so.distance(BOX, MIXED[name], HOME, pose)
        assert answer.status is so.Status.GLOBAL
        assert answer.distance == pytest.approx(truth.distance, rel=1e-3)
