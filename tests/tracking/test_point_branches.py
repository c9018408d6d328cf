"""The minima of a point tracker: why they begin and end, and one meaning of its options."""

from __future__ import annotations

import copy
import math
import pickle
from itertools import pairwise

import numpy as np
import pytest
from point_oracle import ellipse

import standoff as so
from standoff.geometry import Line
from standoff.motion import ConstantTwist, Pose, Spiral, Twist
from standoff.tracking import Birth, BranchCounts, End

BOX = so.shapes.box(2, 3, 4)
EGG = so.shapes.ellipsoid(3, 2, 1)
CORNERS = [(0.0, 0.0), (4.0, 0.0), (0.0, 3.0)]
TRIANGLE = so.shapes.planar_loop(
    [Line((*p, 0.0), (*q, 0.0)) for p, q in zip(CORNERS, CORNERS[1:] + CORNERS[:1], strict=True)]
)


def straight(p, q):
    """In one second from one place, (3,), to another."""
    way = np.array(q, dtype=float) - p
    return ConstantTwist(Pose.from_wxyz((1, 0, 0, 0), p), Twist(way, (0, 0, 0)))


def reasons(answer):
    return [change.reason for change in answer.changes]


def test_a_box_s_six_minima_begin_at_the_start_and_end_as_the_point_leaves():
    tracker = so.PointTracker(BOX)
    state = tracker.start((0.3, 0.2, 0.1))
    assert reasons(state.proximity) == 6 * [Birth.START]
    assert state.proximity.counts.born == 6
    assert state.proximity.total == BranchCounts(start=6)
    state, out = tracker.step(state, (0.3, 1.7, 0.1))
    assert reasons(out) == 6 * [End.LEFT]
    assert (out.counts.ended, out.active, out.minima) == (6, -1, ())
    state, again = tracker.step(state, (0.3, 1.4, 0.1))
    assert reasons(again) == 6 * [Birth.SEARCH]
    assert again.total == BranchCounts(start=6, left=6, search=6)
    assert [m.key for m in again.minima] != [m.key for m in tracker.start((0.3, 1.4, 0)).branches]


def test_an_ellipsoid_s_second_minimum_merges_where_it_vanishes():
    """On the long axis there are two up to (a² - c²)/a = 8/3, mirrored, and one beyond."""
    tracker = so.PointTracker(EGG)
    state = tracker.start((2.6, 0, 0))
    assert len(state.proximity.minima) == 2
    ended = []
    for x in np.linspace(2.6, 2.75, 31)[1:]:
        state, answer = tracker.step(state, (x, 0, 0))
        ended += [(x, change) for change in answer.changes]
    ((x, change),) = ended
    assert change.reason is End.MERGED
    assert x == pytest.approx(8 / 3, abs=0.0101)
    assert answer.total == BranchCounts(start=2, merged=1)
    assert change.into == answer.active == answer.minima[0].key


def test_an_ellipse_s_second_minimum_is_shown_by_samples_and_merges():
    """The same in the plane; back inside of the evolute a second one begins again."""
    a, b = 2.0, 1.0
    body = so.shapes.planar_loop([so.geometry.ConicArc((0, 0), (a, 0), (0, b))])
    tracker = so.PointTracker(body)
    cusp = (a * a - b * b) / a
    state = tracker.start((cusp - 0.1, 1e-3))
    assert len(state.proximity.minima) == 2
    for x, due in ((cusp + 0.1, [End.MERGED]), (cusp - 0.1, [Birth.SEARCH])):
        seen = []
        for s in np.linspace(state.point[0], x, 41)[1:]:
            state, answer = tracker.step(state, (s, 1e-3))
            seen += reasons(answer)
        assert seen == due
    assert answer.total == BranchCounts(start=2, merged=1, search=1)


def test_what_the_proof_meets_begins_for_that_reason():
    """Begun on the far side of an ellipse alone."""
    answer = so.PointTracker(ellipse()).start_from((0.1, 0.3), (1.5 * math.pi,)).proximity
    assert reasons(answer) == [Birth.START, Birth.PROOF]
    assert answer.counts.restarts == 1


def test_in_a_triangle_no_minimum_ever_ends():
    """Three curves, three minima, inside and outside; each keeps its key."""
    tracker = so.PointTracker(TRIANGLE, 1e-2)
    path = straight((0.5, 0.5, 0.0), (-2.0, 4.0, 0.0))
    run = so.points.record_point(tracker, path, np.linspace(0.0, 1.0, 101))
    assert {True, False} == set(run.inside.tolist())
    for answer in run.answers:
        assert sorted(m.feature.index for m in answer.minima) == [0, 1, 2]
        assert [m.distance for m in answer.minima] == sorted(m.distance for m in answer.minima)
    assert run.answers[-1].total == BranchCounts(start=3)


def test_of_equal_depths_the_one_that_answers_stays():
    """Along the medial axis of a square, there and back by some roundings: no switch."""
    square = so.shapes.box(2, 2, 2)
    tracker = so.PointTracker(square)
    state = tracker.start((0.1, 0.0, 0.0))
    key = state.proximity.active
    for x, y in ((0.2, 0.2), (0.3, 0.3 + 8e-16), (0.4, 0.4), (0.3, 0.3)):
        state, answer = tracker.step(state, (x, y, 0.0))
        assert (answer.active, answer.events) == (key, ())
    state, answer = tracker.step(state, (0.3, 0.3 + 1e-9, 0.0))
    assert answer.active != key
    assert [event.kind for event in answer.events] == ["medial"]


@pytest.mark.parametrize("body", [EGG, TRIANGLE], ids=["ellipsoid", "triangle"])
def test_no_proof_is_made_where_none_is_asked_for(body):
    """Inside LOCAL with bounds that hold; outside there is no difference."""
    inside, outside = ((0.4, -0.3, 0.1), (0.3, 5.2, 0.1)) if body is EGG else ((1, 0.5), (1, -2))
    proven = so.PointTracker(body)
    alone = so.PointTracker(body, law=so.PredictorCorrector(depth="local"))
    one, two = proven.start(inside), alone.start(inside)
    place = np.array(inside) * 1.01
    (one, a), (two, b) = proven.step(one, place), alone.step(two, place)
    assert (a.status, b.status) == (so.Status.GLOBAL, so.Status.LOCAL)
    assert (a.certified, b.certified) == (True, False)
    assert a.distance == pytest.approx(b.distance, abs=1e-14)
    assert b.lower_bound - 1e-14 <= a.distance <= b.upper_bound + 1e-14
    assert b.counts.samples <= a.counts.samples
    a, b = proven.step(one, outside)[1], alone.step(two, outside)[1]
    assert a.status is b.status is so.Status.CONVERGED
    assert a.distance == b.distance


def test_a_run_along_a_path_has_a_spatial_body_s_switches_at_their_instants():
    """In by a side and out by the top, curved: the roots are those of the path's own functions."""
    path = Spiral(0.2, 0.35, 5.0)
    tracker = so.PointTracker(BOX, 0.05)
    run = so.points.record_point(tracker, path, np.arange(0.0, 1.5, 0.05))
    kinds = [event.kind for event in run.events if event.kind != "voronoi"]
    assert kinds.count("crossing") >= 1
    assert kinds.count("medial") >= 2
    half = np.array([1.0, 1.5, 2.0])
    for event in run.events:
        if event.kind == "voronoi":
            assert not event.located
            continue
        x, v = path.pose(event.time).translation, path.twist(event.time).v
        depths = np.concatenate([half - x, half + x])
        assert event.located
        if event.kind == "crossing":
            assert depths.min() == pytest.approx(0.0, abs=1e-12)
            rate = -v[int(depths.argmin())] if depths.argmin() < 3 else v[int(depths.argmin()) - 3]
            assert event.slope == pytest.approx(-rate, rel=1e-9)
        else:
            least, next_least = np.sort(depths)[:2]
            assert next_least - least == pytest.approx(0.0, abs=1e-12)
    assert run.parameters.shape == (len(run), 3)
    assert run.curve_distance.shape == (len(run), 0)
    visits = run.modes()
    assert visits[0].start == run.time[0]
    assert visits[-1].end == run.time[-1]
    assert all(a.end == b.start for a, b in pairwise(visits))


@pytest.mark.parametrize("body", [BOX, TRIANGLE], ids=["box", "triangle"])
def test_a_run_and_steps_on_a_straight_way_tell_the_same_switches(body):
    ends = ((0.3, 0.2, 0.1), (2.0, 2.9, 0.4)) if body is BOX else ((0.5, 0.6, 0), (5.0, -0.5, 0))
    path, times = straight(*ends), np.linspace(0.0, 1.0, 12)
    tracker = so.PointTracker(body, 1.0 / 11.0)
    run = so.points.record_point(tracker, path, times)
    state = tracker.start(ends[0], path.twist(0.0).v)
    steps = []
    for time in times[1:]:
        state, answer = tracker.step(state, path.pose(time).translation, path.twist(time).v)
        steps += answer.events
    assert [event[1:4] for event in steps] == [event[1:4] for event in run.events]
    assert [e.time for e in steps] == pytest.approx([e.time for e in run.events], abs=1e-12)
    assert len(steps) >= 2


def test_a_step_locates_a_planar_body_s_switches_or_dates_them():
    """Out of the triangle past its right angle: the boundary, then the vertex's region."""
    tracker = so.PointTracker(TRIANGLE, 1.0)
    begin, end = np.array([0.5, 0.45]), np.array([-0.3, -1.0])
    way = end - begin
    state = tracker.start(begin)
    answer = tracker.step(state, end)[1]
    assert [event.kind for event in answer.events] == ["crossing", "voronoi"]
    crossing, voronoi = answer.events
    assert crossing.time == pytest.approx(begin[1] / -way[1], abs=1e-12)
    assert voronoi.time == pytest.approx(begin[0] / -way[0], abs=1e-12)
    assert all(event.located for event in answer.events)
    dated = tracker.step(state, end, locate=False)[1]
    assert {(event.time, event.located) for event in dated.events} == {(1.0, False)}
    assert [e[1:4] for e in dated.events] == [e[1:4] for e in answer.events]


def test_state_and_answer_travel_with_their_branches():
    for body, x in ((BOX, (0.3, 0.2, 0.1)), (TRIANGLE, (1.0, 0.5))):
        tracker = so.PointTracker(body)
        state = tracker.start(x)
        for other in (copy.deepcopy(state), pickle.loads(pickle.dumps(state))):
            one = tracker.step(state, np.array(x) * 1.1, x)[1]
            two = tracker.step(other, np.array(x) * 1.1, x)[1]
            assert one.as_dict() == two.as_dict()
        facts = one.as_dict()
        assert facts["total"]["start"] == len(one.minima)
        assert facts["changes"] == []
    left = tracker.step(state, (-1.0, -1.0))[1].as_dict()
    assert left["total"]["merged"] == 0
