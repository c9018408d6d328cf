"""The soak of tracked solids: what it compares, and that a planted fault is seen."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from families.solid_shapes import ball, bracket
from standoff.solids import SolidTracker, distance
from standoff.tracking.status import Status
from standoff_studies.soak import tracked_solids
from standoff_studies.soak.tracked_solids import Differs, Follower, compare, judged_frames

STILL = np.eye(4)


def at(x: float) -> np.ndarray:
    matrix = np.eye(4)
    matrix[0, 3] = x
    return matrix


def test_frames_of_a_pair_are_judged() -> None:
    verdict, lines = judged_frames(0, 7, [("bolt", "plate")], 3)
    assert lines == []
    assert verdict.poses == 20
    assert verdict.sound


def test_the_way_ends_at_the_pose() -> None:
    follower = Follower(5, np.random.default_rng(1))
    way = follower.way_to(at(2.0), 3.0)
    assert way.shape == (5, 4, 4)
    assert np.abs(way[-1] - at(2.0)).max() == 0.0
    moves = np.linalg.norm(np.diff(way[:, :3, 3], axis=0), axis=1)
    assert 0.0 < moves.sum() < 3.0 * tracked_solids.FARTHEST


def test_answers_that_cannot_both_be_true() -> None:
    cold = distance(bracket(), ball(0.3), STILL, at(5.0))
    compare(cold, cold)
    compare(replace(cold, status=Status.CONTINUUM), cold)
    for wrong in (
        replace(cold, lower_bound=cold.upper_bound + 1e-12),
        replace(cold, upper_bound=cold.lower_bound - 1e-12),
        replace(cold, status=Status.CONTAINED),
    ):
        with pytest.raises(Differs):
            compare(wrong, cold)


def test_a_bound_that_is_too_high_ends_a_run(monkeypatch: pytest.MonkeyPatch) -> None:
    run = SolidTracker.run

    def wrong(*given: object) -> object:
        state, answers = run(*given)
        return state, [replace(each, lower_bound=each.upper_bound + 1e-6) for each in answers]

    monkeypatch.setattr(SolidTracker, "run", wrong)
    with pytest.raises(Differs):
        Follower(2, np.random.default_rng(2))(bracket(), ball(0.3), STILL, at(5.0))
