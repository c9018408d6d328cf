"""The predictor-corrector without restarts keeps its local minimum, and says where it is doubted.

Boxes with parallel axes are as deep along each axis as their half lengths overlap: six local minima
of the depth, exactly known.
"""

from __future__ import annotations

import numpy as np
import pytest

import standoff as so
from standoff.kernels.tolerances import DEPTH_PROOF

ALONE = so.PredictorCorrector(restarts=False)
LOCAL = so.PredictorCorrector(restarts=False, depth="local")
HALVES = np.array([1.0, 0.8, 0.6]) + np.array([0.3, 0.4, 0.5])
BOXES = so.shapes.box(2.0, 1.6, 1.2), so.shapes.box(0.6, 0.8, 1.0)
HOME = np.eye(4)
ROUND = so.shapes.ellipsoid(1.0, 0.8, 0.6), so.shapes.ellipsoid(0.3, 0.7, 0.5)


def at(*p):
    pose = np.eye(4)
    pose[:3, 3] = p
    return pose


# From 0.1 deep along x to 0.9; along y from 1.1 to 0.3, less from the middle on.
WAY = [at(*p) for p in np.linspace((1.2, 0.1, 0.05), (0.4, 0.9, 0.05), 101)]


def followed(law, bodies=BOXES, way=WAY, dt=1e-2):
    tracker = so.Tracker(*bodies, dt, law)
    state = tracker.start(HOME, way[0])
    answers = []
    for pose in way[1:]:
        state, answer = tracker.step(state, HOME, pose)
        answers.append(answer)
    return answers


@pytest.mark.parametrize("law", [ALONE, LOCAL], ids=["proven", "local depth"])
def test_the_minimum_of_the_start_is_kept_where_another_is_less(law):
    statuses = []
    for answer, pose in zip(followed(law), WAY[1:], strict=True):
        depths = HALVES - np.abs(pose[:3, 3])
        assert answer.normal == pytest.approx((1.0, 0.0, 0.0), abs=1e-12)
        assert -answer.distance == pytest.approx(depths[0], abs=1e-12)
        assert answer.lower_bound - 1e-12 <= -depths.min() <= answer.upper_bound + 1e-12
        assert answer.counts.restarts == 0
        proven = (1.0 - DEPTH_PROOF) * depths[0] <= depths.min() + 1e-12
        doubted = so.Status.NOT_RESTARTED if law is ALONE else so.Status.LOCAL
        if law is ALONE or not proven:
            assert answer.status is (so.Status.GLOBAL if proven else doubted)
        statuses.append(answer.status)
        assert answer.certified == (answer.status is so.Status.GLOBAL)
    assert statuses[-1] is doubted


def test_with_restarts_the_least_is_gone_to():
    answers = followed(so.PredictorCorrector())
    assert answers[0].normal == pytest.approx((1.0, 0.0, 0.0), abs=1e-12)
    assert answers[-1].normal == pytest.approx((0.0, 1.0, 0.0), abs=1e-12)
    assert {answer.status for answer in answers} == {so.Status.GLOBAL}


def test_without_a_doubt_the_answers_are_those_of_the_default():
    """Apart to the last bit; in contact a search may sharpen the least depth by a rounding."""
    way = [at(2.0 - 1.1 * s, 0.3 * s, 0.1) for s in np.linspace(0.0, 1.0, 200)]
    for bodies in (ROUND, BOXES):
        wanted = followed(so.PredictorCorrector(), bodies, way)
        assert {a.status for a in wanted} == {so.Status.CONVERGED, so.Status.GLOBAL}
        for one, other in zip(followed(ALONE, bodies, way), wanted, strict=True):
            assert one.status is other.status
            assert one.distance == pytest.approx(other.distance, abs=1e-14)
            assert one.normal == pytest.approx(other.normal, abs=1e-9)
            if one.status is so.Status.CONVERGED:
                assert one.row.tobytes() == other.row.tobytes()


def test_after_jumps_no_frame_searches_and_every_bound_holds(rng):
    """Poses far from each other, apart and in overlap."""
    way = []
    for _ in range(300):
        pose = so.Pose.exp(rng.normal(size=3), rng.normal(size=3)).matrix
        pose[:3, 3] = rng.normal(size=3)
        way.append(pose)
    seen = {"doubted": 0, "sure": 0}
    for answer, pose in zip(followed(ALONE, ROUND, [at(2.0, 0.0, 0.0), *way]), way, strict=True):
        true = so.distance(*ROUND, HOME, pose)
        assert answer.counts.restarts == 0
        assert answer.lower_bound <= true.upper_bound + 1e-9
        assert answer.upper_bound >= true.lower_bound - 1e-9
        assert answer.certified or answer.status is so.Status.NOT_RESTARTED
        if answer.certified:
            assert answer.distance == pytest.approx(true.distance, abs=2e-3)
        seen["sure" if answer.certified else "doubted"] += 1
    assert min(seen.values()) > 0


def test_a_state_that_is_doubted_is_started_anew_by_another_tracker():
    tracker = so.Tracker(*BOXES, law=ALONE)
    state, answer = tracker.step(tracker.start(HOME, WAY[0]), HOME, WAY[-1])
    assert answer.status is so.Status.NOT_RESTARTED
    _, answer = so.Tracker(*BOXES).step(state, HOME, WAY[-1])
    assert answer.status is so.Status.GLOBAL
    assert answer.counts.restarts == 1
    assert answer.normal == pytest.approx((0.0, 1.0, 0.0), abs=1e-12)


def test_a_point_tracker_says_it_too():
    """Outside; no gap is within such a tolerance."""
    disc = so.shapes.planar_loop([so.geometry.ConicArc((0, 0), (2, 0), (0, 1))])
    for restarts, due in ((True, so.Status.NOT_CERTIFIED), (False, so.Status.NOT_RESTARTED)):
        law = so.PredictorCorrector(tolerance=1e-30, restarts=restarts)
        tracker = so.PointTracker(disc, law=law)
        state = tracker.start((2.0, 1.5))
        assert state.proximity.status is so.Status.NOT_CERTIFIED
        assert tracker.step(state, (2.1, 1.5))[1].status is due
