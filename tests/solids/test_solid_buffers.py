"""Frames of two solids in place: the answers of `step`, bit for bit, without its objects."""

from __future__ import annotations

import pickle
import tracemalloc
from typing import Any

import numpy as np
import pytest
from test_tracked_solids import wandering

import standoff as so
from families.solid_shapes import bolt, bracket, tube
from standoff.kernels.entries.solid_blocks import Q_POINTS
from standoff.kernels.entries.solid_contact import DEPTH, FIRST, follow_contact
from standoff.solids import SolidFrameBuffer, SolidProximity
from standoff.solids.tracked import contact, frame_buffer
from standoff.tracking.status import Status

Array = np.ndarray
STILL = np.eye(4)
A = so.Pose.exp((0.3, -0.2, 0.5), (1.0, 2.0, -0.5))
"""Where A stands, so that its frame is not the world's."""


def carried(poses: Array) -> Array:
    return A.matrix @ poses


def is_same(buffer: SolidFrameBuffer, answer: SolidProximity) -> None:
    assert buffer.distance == answer.distance
    assert buffer.lower_bound == answer.lower_bound
    assert buffer.upper_bound == answer.upper_bound
    assert buffer.status is answer.status
    assert buffer.certified == answer.certified
    for name in ("point_a", "point_b"):
        assert getattr(buffer, name) == pytest.approx(getattr(answer, name), abs=1e-10)
    apart = max(abs(answer.distance), 1e-3)
    assert buffer.normal == pytest.approx(answer.normal, abs=1e-9 / apart)
    told = buffer.proximity()
    assert str(told.as_dict()) == str(answer.as_dict())


@pytest.mark.parametrize("asked", [{}, {"minima": 0.3}, {"minima": 0.3, "patch": 1e-3}])
def test_frames_in_place_are_those_of_steps(asked: dict[str, float]) -> None:
    a, b = bolt(), tube(1.2, 2.0, 0.0, 1.0)
    poses = carried(wandering(a, b, 40, 4e-3, np.random.default_rng(5), 0.02))
    tracker = so.Tracker(a, b, **asked)
    state = tracker.start(A, poses[0])
    buffer = tracker.buffer(state)
    is_same(buffer, state.proximity)
    for pose in poses[1:]:
        state, answer = tracker.step(state, A.matrix, pose)
        assert tracker.step_into(buffer, A.matrix, pose) == answer.distance
        is_same(buffer, answer)
    _, on = tracker.step(buffer.state, A, poses[0])
    assert on.as_dict() == tracker.step(state, A, poses[0])[1].as_dict()


def down(heights: tuple[float, ...], tilt: tuple[float, float, float]) -> Array:
    return np.array([so.Pose.exp(tilt, (0.1, 0.2, height)).matrix for height in heights])


@pytest.mark.parametrize("asked", [{}, {"minima": 0.2}])
@pytest.mark.parametrize("tilt", [(0.02, 0.03, 0.0), (0.0, 0.0, 0.0)])
def test_through_contact_and_ties(asked: dict[str, float], tilt: tuple[Any, Any, Any]) -> None:
    """Apart, in contact, deeper than is looked for, and apart again; tilted with one nearest pair,
    level with a continuum of them."""
    lid, pad = so.Solid(so.shapes.box((4, 4, 1))), so.shapes.box((1, 1, 1))
    poses = carried(down((1.1, 1.06, 1.0, 0.98, 0.5, 0.98, 1.1, 1.12), tilt))
    tracker = so.Tracker(lid, pad, **asked)
    state = tracker.start(A, poses[0])
    buffer, met = tracker.buffer(state), set()
    for pose in poses:
        state, answer = tracker.step(state, A, pose)
        tracker.step_into(buffer, A, so.Pose.of(pose))
        is_same(buffer, answer)
        met.add(answer.status)
    assert Status.OVERLAPPING in met
    assert (Status.CONTINUUM in met) == (tilt == (0.0, 0.0, 0.0))


ASKED = [{}, {"minima": 0.2}, {"deadline": 300}, {"minima": 0.2, "patch": 1e-3, "deadline": 3000}]


@pytest.mark.parametrize("asked", ASKED)
@pytest.mark.parametrize("tilt", [(0.02, 0.03, 0.0), (0.0, 0.0, 0.0)])
def test_in_and_out_of_overlap(asked: dict[str, Any], tilt: tuple[float, float, float]) -> None:
    """Apart, touching where level, many frames in overlap, and out again; answers are read in some
    frames only, and buffers begin in any of them."""
    lid, pad = so.Solid(so.shapes.box((4, 4, 1))), so.shapes.box((1, 1, 1))
    heights = 1.0 + np.concatenate([np.arange(12, -9, -1), np.arange(-7, 13)]) / 256.0
    assert 1.0 in heights
    poses = carried(down(tuple(heights), tilt))
    tracker = so.Tracker(lid, pad, **asked)
    state = tracker.start(A, poses[0])
    seldom, always = tracker.buffer(state), tracker.buffer(state)
    met: list[Status] = []
    for k, pose in enumerate(poses):
        begun = tracker.buffer(always.state)
        state, answer = tracker.step(state, A, pose)
        for buffer in (seldom, always, begun):
            assert tracker.step_into(buffer, A.matrix, pose) == answer.distance
            assert buffer.status is answer.status
        is_same(always, answer)
        if k % 5 == 4:
            is_same(seldom, answer)
            is_same(begun, answer)
        met.append(answer.status)
    overlaps = [k for k, status in enumerate(met) if status is Status.OVERLAPPING]
    assert len(overlaps) > 8
    assert overlaps[0] > 0
    assert overlaps[-1] < len(met) - 1
    if tilt == (0.0, 0.0, 0.0):
        assert Status.TOUCHING in met


def test_a_leap_into_the_other_solid() -> None:
    """Farther in one frame than they were apart: into the material, and out again."""
    block, ball = so.Solid(so.shapes.box((4, 4, 4))), so.shapes.sphere(0.3)
    poses = [so.Pose.exp((0, 0, 0), (x, 0.1, 0.2)).matrix for x in (3.0, 0.5, 0.6, 3.1)]
    tracker = so.Tracker(block, ball)
    state = tracker.start(STILL, poses[0])
    buffer, met = tracker.buffer(state), []
    for pose in poses:
        state, answer = tracker.step(state, STILL, pose)
        tracker.step_into(buffer, STILL, pose)
        assert buffer.status is answer.status
        assert buffer.distance == answer.distance
        met.append(answer.status.name)
    assert met == ["CONVERGED", "CONTAINED", "CONTAINED", "CONVERGED"]


@pytest.mark.parametrize("asked", [{}, {"minima": 0.2}])
def test_places_that_prove_nothing(asked: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    """A frame in overlap that the places kept do not prove is looked at as one of which nothing is
    known, in place as in a step."""
    refusing = [False]

    def refused(*given: Any) -> None:
        follow_contact(*given)
        if refusing.pop():
            given[4][5][FIRST] = -1.0
        refusing.append(False)

    for module in (contact, frame_buffer):
        monkeypatch.setattr(module, "follow_contact", refused)
    lid, pad = so.Solid(so.shapes.box((4, 4, 1))), so.shapes.box((1, 1, 1))
    poses = carried(down(tuple(np.linspace(1.03, 0.96, 16)), (0.02, 0.03, 0.0)))
    tracker = so.Tracker(lid, pad, **asked)
    state = tracker.start(A, poses[0])
    buffer, seen = tracker.buffer(state), 0
    for k, pose in enumerate(poses):
        again = state.proximity.overlap is not None and k % 3 == 0
        seen += again
        refusing[0] = again
        state, answer = tracker.step(state, A, pose)
        refusing[0] = again
        tracker.step_into(buffer, A, pose)
        is_same(buffer, answer)
        if again:
            assert answer.status is Status.OVERLAPPING
    assert seen > 2


def test_what_a_proof_may_take_is_that_of_one_frame() -> None:
    """Allowed little more than the first frame takes, all others prove as much."""
    lid, pad = so.Solid(so.shapes.box((4, 4, 1))), so.shapes.box((1, 1, 1))
    poses = carried(down(tuple(np.linspace(1.03, 0.97, 16)), (0.02, 0.03, 0.0)))
    tracker = so.Tracker(lid, pad)
    state = tracker.start(A, poses[0])
    for pose in poses[1:]:
        state, answer = tracker.step(state, A, pose)
    assert answer.overlap is not None
    frames, of_b = tracker.asks.contact(state.front), np.linalg.inv(A.matrix) @ poses[-1]
    relative = np.concatenate([of_b[:3, :3].ravel(), of_b[:3, 3]])
    assert frames.go(relative)
    taken, depth = int(frames.work.counts[8:].sum()), float(frames.told[DEPTH])
    assert taken > 0
    frames.asked[Q_POINTS] = 1.5 * taken
    for _ in range(20):
        assert frames.go(relative)
        assert frames.work.counts[8:].sum() == taken
        assert frames.told[DEPTH] == depth


def test_poses_are_read_in_every_form() -> None:
    tracker = so.Tracker(bracket(), bracket())
    poses = carried(wandering(bracket(), bracket(), 6, 4e-3, np.random.default_rng(7), 0.1))
    state = tracker.start(A, poses[0])
    buffers = [tracker.buffer(state) for _ in range(3)]
    normal = buffers[0].normal
    for pose in poses[1:]:
        told = {
            tracker.step_into(buffers[0], A.matrix, pose),
            tracker.step_into(buffers[1], A, so.Pose.of(pose)),
        }
        for row, given in ((buffers[2].pose_a, A.matrix), (buffers[2].pose_b, pose)):
            row[:9], row[9:] = given[:3, :3].ravel(), given[:3, 3]
        told.add(tracker.step_into(buffers[2]))
        assert len(told) == 1
    assert buffers[0].normal is normal
    with pytest.raises(ValueError, match="read-only"):
        normal[0] = 1.0


def test_what_is_no_pose_is_refused_and_what_is_rounded_repaired() -> None:
    tracker = so.Tracker(bracket(), bracket())
    poses = carried(wandering(bracket(), bracket(), 3, 4e-3, np.random.default_rng(8), 0.1))
    state = tracker.start(A, poses[0])
    buffer = tracker.buffer(state)
    rounded = poses[1].copy()
    rounded[:3, :3] = np.round(rounded[:3, :3], 7)
    for given in (rounded, rounded.astype(np.float32).astype(float)):
        tracker.step_into(buffer, A.matrix, given)
        assert buffer.repaired == 1
    before = buffer.proximity().as_dict()
    for k, bad in enumerate((np.eye(3), np.full((4, 4), np.nan), np.diag([1.0, 1, -1, 1]), None)):
        pair = (bad, poses[1]) if k % 2 else (A.matrix, bad)
        with pytest.raises((ValueError, TypeError)):
            tracker.step_into(buffer, *pair)
        assert buffer.proximity().as_dict() == before
    tracker.step_into(buffer, A.matrix, poses[2])
    assert buffer.repaired == 0
    other = so.Tracker(bracket(), bracket())
    with pytest.raises(so.StandoffError, match="another tracker"):
        other.step_into(buffer, A.matrix, poses[2])
    with pytest.raises(so.StandoffError, match="another pair"):
        so.Tracker(bolt(), bracket()).buffer(state)
    with pytest.raises(so.StandoffError, match="is not stored"):
        pickle.dumps(buffer)


def test_two_buffers_do_not_write_to_each_other() -> None:
    tracker = so.Tracker(bracket(), bracket())
    poses = carried(wandering(bracket(), bracket(), 20, 4e-3, np.random.default_rng(9), 0.05))
    state = tracker.start(A, poses[0])
    one, other = tracker.buffer(state), tracker.buffer(state)
    alone = tracker.buffer(state)
    expected = [tracker.step_into(alone, A.matrix, pose) for pose in poses]
    told = []
    for k, pose in enumerate(poses):
        told.append(tracker.step_into(one, A.matrix, pose))
        tracker.step_into(other, A.matrix, poses[-1 - k])
        tracker.step(state, A, pose)
    assert told == expected


def test_nothing_is_allocated() -> None:
    tracker = so.Tracker(bracket(), bracket())
    poses = carried(wandering(bracket(), bracket(), 30, 1e-4, np.random.default_rng(10), 0.05))
    state = tracker.start(A, poses[0])
    buffer, matrix = tracker.buffer(state), A.matrix

    def greatest(do: Any) -> int:
        most = 0
        for pose in poses:
            tracemalloc.reset_peak()
            before = tracemalloc.get_traced_memory()[0]
            do(pose)
            most = max(most, tracemalloc.get_traced_memory()[1] - before)
        return most

    for pose in poses:
        tracker.step_into(buffer, matrix, pose)
    tracemalloc.start()
    try:
        in_place = greatest(lambda pose: tracker.step_into(buffer, matrix, pose))
        by_itself = greatest(lambda pose: tracker.step(state, matrix, pose))
    finally:
        tracemalloc.stop()
    assert in_place < 2_000 < by_itself
