"""Frames of solids in overlap tell the depth of places that have come from above 0: it goes on
without a jump, though a deeper way out of the same region is there."""

from __future__ import annotations

import numpy as np
import pytest

import standoff as so
from families.solid_shapes import peg, tube
from standoff.solids import SolidAnswers, SolidTracker
from standoff.tracking.status import Status

STILL = so.Pose.identity()
HOLE, PEG = tube(0.01001, 0.02, -0.02, 0.02), peg(0.01, 0.0, 0.06)
"""A hole with its mouth at z = 0.02, and what goes into it."""
OFF = 5e-4
"""Along x and y from the hole's axis to the peg's, length: it does not go in, and comes to lie on
the face round the mouth. The rim would push it aside, by nearly 0.7 mm."""
ASIDE = np.hypot(OFF, OFF) - 1e-5


def at(height: float, off: float = OFF) -> so.Pose:
    return so.Pose(np.eye(3), [off, off, 0.02 + height])


def followed(heights: np.ndarray, offs: np.ndarray) -> tuple[SolidTracker, SolidAnswers]:
    """The peg as it is set down, and moved."""
    tracker = so.Tracker(HOLE, PEG, minima=1e-3)
    poses = [at(h, x) for h, x in zip(heights, offs, strict=True)]
    state = tracker.start(STILL, poses[0])
    return tracker, tracker.run(state, STILL, poses)[1]


def test_a_peg_on_the_mouth_of_its_hole_is_as_deep_as_it_has_come() -> None:
    down = 1e-6 * np.arange(10.5, -10.5, -1.0)
    heights = np.concatenate([down, np.full(10, down[-1])])
    offs = OFF + np.concatenate([np.zeros(len(down)), 1e-5 * np.arange(1, 11)])
    _, answers = followed(heights, offs)
    assert not answers.restarts.any()
    np.testing.assert_allclose(answers.distance, heights, rtol=0.0, atol=1e-12)
    for answer, height, off in zip(answers, heights, offs, strict=True):
        if height > 0.0:
            assert all(each.felt for each in answer.minima)
            continue
        assert answer.status is Status.OVERLAPPING
        # what no translation is less than is no more than this place's depth
        assert 0.0 < answer.overlap.depth <= -height * (1.0 + 1e-9)
        first, *others = answer.minima
        assert first.felt
        assert first.normal == pytest.approx([0.0, 0.0, 1.0], abs=1e-9)
        (aside,) = others
        assert not aside.felt
        assert aside.distance == pytest.approx(-(np.hypot(off, off) - 1e-5), rel=1e-6)
    assert {m.key for a in answers for m in a.minima if not m.felt} == {
        m.key for m in answers[-1].minima if not m.felt
    }


def test_a_query_and_a_start_can_not_tell() -> None:
    """Both know nothing of the way here; of two places in one region a query tells one."""
    cold = so.solids.distance(HOLE, PEG, STILL, at(-1e-5), minima=1e-3)
    assert cold.distance == pytest.approx(-ASIDE)
    tracker = so.Tracker(HOLE, PEG, minima=1e-3)
    state = tracker.start(STILL, at(-1e-5))
    assert state.proximity.distance == pytest.approx(-ASIDE)
    _, answer = tracker.step(state, STILL, at(-1.1e-5))
    assert all(each.felt for each in answer.minima)
    assert answer.distance == pytest.approx(-ASIDE)


def test_after_contact_it_is_as_before() -> None:
    """What was not felt is not there when they are apart, and is not felt when they meet again."""
    heights = 1e-5 * np.cos(np.linspace(0.0, 4.0 * np.pi, 42))
    _, answers = followed(heights, np.full(42, OFF))
    met = np.array([status is Status.OVERLAPPING for status in answers.status])
    assert np.abs(np.diff(met.astype(int))).sum() == 4
    np.testing.assert_allclose(answers.distance, heights, rtol=0.0, atol=1e-12)


def test_what_the_motion_explains_is_felt() -> None:
    """A leap through the wall, as deep as it is long."""
    tracker = so.Tracker(HOLE, PEG, minima=1e-3)
    into = so.Pose(np.eye(3), [0.015, 0.0, 0.0])
    _, answer = tracker.step(tracker.start(STILL, at(1e-5)), STILL, into)
    assert answer.status is Status.OVERLAPPING
    assert all(each.felt for each in answer.minima)
