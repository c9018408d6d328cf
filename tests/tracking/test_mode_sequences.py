"""Sequences of active features against brute force, and the events that tell them."""

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
from mode_scenes import FINE, make_scenes

import standoff as so

SCENES = make_scenes()
FRAME_TIMES = (1e-3, 1e-2, 33e-3)
PREDICTORS = ("feedforward-2", "feedforward", "secant")


@dataclass(frozen=True)
class Tracked:
    """All answers of a tracked scene; the first is that of the start."""

    answers: list[so.Proximity]
    truth: list[tuple]


def stride(frame_time):
    return round(frame_time / FINE)


@cache
def track(name, frame_time, predictor="feedforward-2"):
    scene = SCENES[name]
    tracker = so.Tracker(
        scene.body_a, scene.body_b, dt=frame_time, law=so.PredictorCorrector(predictor=predictor)
    )

    def twists(t):
        blind = predictor == "secant"
        return (None, None) if blind else (scene.path_a.twist(t), scene.path_b.twist(t))

    state = tracker.start(scene.path_a.pose(0.0), scene.path_b.pose(0.0), *twists(0.0))
    answers = [state.proximity]
    truth = scene.truth(stride(frame_time))
    for k in range(1, len(truth)):
        t = k * stride(frame_time) * FINE
        state, answer = tracker.step(state, scene.path_a.pose(t), scene.path_b.pose(t), *twists(t))
        answers.append(answer)
    return Tracked(answers, truth)


def runs(modes):
    """The sequence of modes without repetitions, each with its first frame."""
    return [(m, k) for k, m in enumerate(modes) if k == 0 or m != modes[k - 1]]


def assert_same_sequence(found, known):
    """Equal sequences of modes, each beginning in the same frame or the next to it."""
    found, known = runs(found), runs(known)
    assert [m for m, _ in found] == [m for m, _ in known]
    for (mode, first), (_, expected) in zip(found, known, strict=True):
        assert abs(first - expected) <= 1, (mode, first, expected)


def named(name, answers):
    """The modes of answers in the oracles' names."""
    of_a, of_b = SCENES[name].names
    return [(of_a[str(x.feature_a)], of_b[str(x.feature_b)]) for x in answers]


@pytest.mark.parametrize("name", SCENES)
def test_a_scene_visits_much(name):
    """The truth itself: many modes, and of each body every kind of feature that it may show."""
    truth = SCENES[name].truth(stride(1e-2))
    assert len(runs(truth)) >= 12
    kinds = {mode[0][0] for mode in truth}
    assert kinds == ({"edge", "vertex"} if "planar" in name else {"face", "edge", "vertex"})


# The brute force of a thousand frames a second takes long: `make soak` has that of all scenes.
FINELY = ("helix of a point around the lens", "tumbling box over a polytope")
RUNS = [
    pytest.param(name, frame_time, marks=[pytest.mark.soak] if long else [])
    for name in SCENES
    for frame_time in FRAME_TIMES
    for long in [frame_time == FRAME_TIMES[0] and name not in FINELY]
]


@pytest.mark.parametrize("predictor", PREDICTORS)
@pytest.mark.parametrize(("name", "frame_time"), RUNS)
def test_mode_sequence(name, frame_time, predictor):
    tracked = track(name, frame_time, predictor)
    assert all(answer.certified for answer in tracked.answers)
    assert_same_sequence(named(name, tracked.answers), tracked.truth)


@pytest.mark.parametrize(("name", "frame_time"), RUNS)
def test_events_tell_the_sequence(name, frame_time):
    tracked = track(name, frame_time)
    total = 0
    for k, (before, after) in enumerate(zip(tracked.answers, tracked.answers[1:], strict=False), 1):
        assert after.counts.switches == len(after.events)
        total += len(after.events)
        for body, at, end in (
            ("A", before.feature_a, after.feature_a),
            ("B", before.feature_b, after.feature_b),
        ):
            visited = [at]
            for event in after.events:
                if event.body == body:
                    assert event.source == visited[-1]
                    assert event.time == pytest.approx(k * frame_time, rel=1e-9)
                    visited.append(event.target)
            assert visited[-1] == end
            assert len(set(visited)) == len(visited), "an event loop within one frame"
    assert total >= len(runs(tracked.truth)) - 1


def neighbours(body, feature):
    """Features that share a boundary with this one, from the body's topology."""
    edges, faces = body.edge_parts, body.face_parts
    sides = [{j for j, _ in face.loop} for face in faces]
    if feature.kind == "face":
        return {so.Feature("edge", j) for j in sides[feature.index]}
    if feature.kind == "vertex":
        ends = {j for j, e in enumerate(edges) if feature.index in (e.first, e.last)}
        around = {so.Feature("face", i) for i, side in enumerate(sides) if side & ends}
        return around | {so.Feature("edge", j) for j in ends}
    edge = edges[feature.index]
    ends = {so.Feature("vertex", k) for k in (edge.first, edge.last)}
    return ends | {so.Feature("face", i) for i, side in enumerate(sides) if feature.index in side}


@pytest.mark.parametrize("name", SCENES)
def test_events_join_neighbours(name):
    """Every switch leads to a feature that shares a boundary with the one left."""
    scene = SCENES[name]
    for answer in track(name, FRAME_TIMES[0 if name in FINELY else 1]).answers:
        for event in answer.events:
            body = scene.body_a if event.body == "A" else scene.body_b
            assert event.target in neighbours(body, event.source), event


@pytest.mark.parametrize("name", SCENES)
def test_values_of_events(name):
    """A release has a negative slope, a boundary reached the part of the step that did not fit."""
    events = [event for answer in track(name, 1e-2).answers for event in answer.events]
    released = [event for event in events if event.slope != 0.0]
    assert released
    for event in events:
        if event.slope != 0.0:
            assert -1.0 <= event.slope < 0.0
            assert event.value < 0.0
        else:
            assert 0.0 <= event.value <= 1.0


@pytest.mark.parametrize("predictor", ["feedforward", "secant"])
def test_a_crossing_that_is_taken_back_is_no_event(predictor):
    """A point above a box turns back just before the face's edge: predictions cross it.

    What was predicted is seen in the extra work; the frames themselves stay on the face.
    """
    box = so.shapes.box(1.0, 1.0, 1.0)
    step, rate, swing, margin = 33e-3, 3.0, 0.2, 1e-5
    extra = 0
    for offset in (0.0, 0.01, 0.02, 0.03):

        def motion(k, offset=offset):
            angle = rate * (step * k + offset)
            x = 0.5 - margin - swing * (1.0 - math.cos(angle))
            v = -swing * rate * math.sin(angle)
            twist = None if predictor == "secant" else so.Twist([v, 0, 0], np.zeros(3))
            return so.Pose(np.eye(3), [x, 0.1, 0.9]), twist

        tracker = so.Tracker(
            box, so.shapes.point(), dt=step, law=so.PredictorCorrector(predictor=predictor)
        )
        pose, twist = motion(-20)
        state = tracker.start(np.eye(4), pose, None, twist)
        for k in range(-19, 20):
            pose, twist = motion(k)
            state, answer = tracker.step(state, np.eye(4), pose, None, twist)
            assert answer.certified
            assert answer.feature_a.kind == "face"
            assert answer.events == ()
            assert answer.counts.switches == 0
            extra += answer.counts.evaluations - 1
    assert extra > 0
