"""Switching instants: closed forms, chains, and what is told where they are not located."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from moving_pairs import REST, check_chain, random_pairs, straight, switch_times

import standoff as so
from shares import only
from standoff.geometry import Line
from standoff.motion import ConstantTwist, Spiral

POINT = so.shapes.point()
KINDS = ("vertex", "edge", "face")


def quadratic(a: float, b: float, c: float) -> list[float]:
    root = math.sqrt(b * b - 4.0 * a * c)
    return sorted([(-b - root) / (2.0 * a), (-b + root) / (2.0 * a)])


@pytest.mark.parametrize("dt", [1e-3, 1e-2, 0.1, 1.0])
def test_a_point_past_a_box(dt: float) -> None:
    # The Voronoi planes of a unit box are at x, y = ±1/2: crossed at known instants.
    first, velocity = np.array([-1.0, -0.9, 0.8]), np.array([1.0, 0.77, 0.013])
    recording = so.track(
        so.Tracker(POINT, so.shapes.box(1.0, 1.0, 1.0), dt), straight(first, velocity), REST, 2.0
    )
    crossings = sorted((side - first[k]) / velocity[k] for k in (0, 1) for side in (-0.5, 0.5))
    np.testing.assert_allclose(switch_times(recording), crossings, rtol=0.0, atol=1e-14)
    kinds = [(event.source.kind, event.target.kind) for event in recording.events]
    assert kinds == [("vertex", "edge"), ("edge", "face"), ("face", "edge"), ("edge", "vertex")]
    assert {event.body for event in recording.events} == {"B"}
    check_chain(recording)
    # The nearest point of the box moves off along x; the slope along the edge is -n·x.
    enter = recording.events[0]
    away = first + velocity * crossings[0] - np.array([-0.5, -0.5, 0.5])
    assert enter.value == pytest.approx(0.0, abs=1e-14)
    assert enter.slope == pytest.approx(-velocity[0] / np.linalg.norm(away), rel=1e-4)
    assert [math.copysign(1.0, event.slope) for event in recording.events] == [-1, -1, 1, 1]


def test_switches_within_one_frame_are_told_apart() -> None:
    box = so.shapes.box(1.0, 1.0, 1.0)
    path = straight((-1.0, -0.9, 0.8), (1.0, 0.77, 0.0))
    recording = so.track(so.Tracker(POINT, box, 2.0), path, REST, 2.0)
    assert len(recording) == 2
    exact = [0.5, 0.4 / 0.77, 1.5, 1.4 / 0.77]
    np.testing.assert_allclose(switch_times(recording), exact, rtol=0.0, atol=1e-14)
    assert len({event.frame for event in recording.events}) == 1
    assert len(set(switch_times(recording))) == 4
    check_chain(recording)


def test_over_the_rim_of_a_cylinder() -> None:
    cylinder = so.shapes.cylinder(0.5, 1.0)
    x, y, vx, vy = -1.0, 0.1, 1.0, 0.05
    recording = so.track(
        so.Tracker(POINT, cylinder, 1e-2), straight((x, y, 0.8), (vx, vy, 0.0)), REST, 2.0
    )
    exact = quadratic(vx * vx + vy * vy, 2.0 * (x * vx + y * vy), x * x + y * y - 0.25)
    np.testing.assert_allclose(switch_times(recording), exact, rtol=0.0, atol=1e-13)
    assert [event.target.kind for event in recording.events] == ["face", "edge"]
    down = so.track(
        so.Tracker(POINT, cylinder, 1e-2), straight((-0.6, 0.3, 1.0), (0, 0.05, -1)), REST, 2.0
    )
    np.testing.assert_allclose(switch_times(down), [0.5, 1.5], rtol=0.0, atol=1e-13)


def test_a_sphere_over_a_lens() -> None:
    # The foot on ball i leaves its face where it reaches ball j: 2 u·D = -|D|², u the unit vector
    # from centre i to the sphere, D = c_i - c_j.
    angles = np.radians([0.0, 120.0, 240.0])
    centres = -0.45 * np.column_stack([np.cos(angles), np.sin(angles), 0.0 * angles])
    first, velocity = np.array([0.5, -2.0, 0.2]), np.array([0.05, 1.0, 0.03])
    exact = []
    for i in range(3):
        for j in range(3):
            if i != j:
                p, d = first - centres[i], centres[i] - centres[j]
                d4 = float(d @ d) ** 2
                a = 4.0 * (velocity @ d) ** 2 - d4 * (velocity @ velocity)
                b = 8.0 * (p @ d) * (velocity @ d) - 2.0 * d4 * (p @ velocity)
                c = 4.0 * (p @ d) ** 2 - d4 * (p @ p)
                if b * b > 4.0 * a * c:
                    exact += [
                        t for t in quadratic(a, b, c) if (p + velocity * t) @ d < 0.0 <= t <= 4.0
                    ]
    recording = so.track(
        so.Tracker(so.shapes.sphere(0.2), so.shapes.lens(1.0, 0.45), 5e-3),
        *(straight(first, velocity), REST, 4.0),
    )
    times = switch_times(recording)
    assert len(times) == 3
    gaps = np.abs(np.asarray(exact)[:, None] - times[None, :]).min(axis=0)
    assert gaps.max() < 1e-12
    check_chain(recording)


def test_over_the_apex_of_a_cone() -> None:
    # A fan of directions leaves the apex: no single switching function, so its features are halved.
    radius, height, above = 0.5, 1.0, 0.2
    path = straight((-1.0, 0.0, height / 2.0 + above), (1.0, 0.0, 0.0))
    recording = so.track(so.Tracker(POINT, so.shapes.cone(radius, height), 1e-2), path, REST, 2.0)
    reach = above * height / radius
    times = switch_times(recording)
    np.testing.assert_allclose(times, [1.0 - reach, 1.0 + reach], rtol=0.0, atol=1e-9)
    assert [event.target.kind for event in recording.events] == ["vertex", "face"]
    assert all(math.isnan(event.value) for event in recording.events)


def test_a_point_round_a_polygon() -> None:
    # On a spiral round a square: crosses its Voronoi lines x, y = ±1/2 where r sin or cos is ±1/2.
    corners = [(-0.5, -0.5, 0.0), (0.5, -0.5, 0.0), (0.5, 0.5, 0.0), (-0.5, 0.5, 0.0)]
    loop = so.shapes.planar_loop([Line(corners[k], corners[(k + 1) % 4]) for k in range(4)])
    spiral = Spiral(1.2, 0.05, 1.0)
    recording = so.track(so.Tracker(POINT, loop, 0.02), spiral, REST, 6.0)
    times = switch_times(recording)
    assert len(times) == 8
    for time in times.tolist():
        place = np.abs(spiral.pose(time).translation[:2])
        assert np.abs(place - 0.5).min() < 1e-13
    check_chain(recording)


@pytest.mark.parametrize("number", only(range(4), range(8)))
def test_random_motions(number: int) -> None:
    a, b, path_a, path_b = random_pairs(8)[number]
    coarse = so.track(so.Tracker(a, b, 0.02), path_a, path_b, 1.5)
    fine = so.track(so.Tracker(a, b, 2.5e-3), path_a, path_b, 1.5)
    for recording in (coarse, fine):
        assert recording.certified.all()
        check_chain(recording)
    assert len(coarse.events) >= 1
    for event in coarse.events:
        assert event.located
        # Where the answer jumps, as over a face that is parallel for an instant, the instant is
        # one but the way is not.
        jump = math.isnan(event.value)
        twins = [
            e.time for e in fine.events if e.body == event.body and (jump or e[3:5] == event[3:5])
        ]
        assert min(abs(event.time - time) for time in twins) < 1e-10
    for event in fine.events:
        rises = KINDS.index(event.target.kind) > KINDS.index(event.source.kind)
        assert math.isnan(event.slope) or (event.slope < 0.0) == rises
        for time, feature in ((event.time - 1e-7, event.source), (event.time + 1e-7, event.target)):
            if not any(0.0 < abs(time - e.time) < 2e-7 for e in fine.events if e != event):
                cold = so.distance(a, b, path_a.pose(time), path_b.pose(time))
                assert feature == (cold.feature_a if event.body == "A" else cold.feature_b)


def test_the_paper_s_law_switches_by_itself() -> None:
    box, path = so.shapes.box(1.0, 1.0, 1.0), straight((-1.0, -0.9, 0.8), (1.0, 0.77, 0.013))
    recording = so.track(so.Tracker(POINT, box, 1e-2, law=so.PaperLaw()), path, REST, 2.0)
    times = switch_times(recording)
    assert len(times) == 4
    check_chain(recording)
    # The law's own switch: cut short there, its step ends in the target, a little before in the
    # source.
    tracker = so.Tracker(POINT, box, 1e-2, law=so.PaperLaw())

    def moved(t: float) -> tuple[so.Pose, so.Pose, so.Twist, so.Twist]:
        return path.pose(t), REST, path.twist(t), so.Twist.zero()

    state, before, at = tracker.start(*moved(0.0)), 0.0, 0
    for frame, time in enumerate(recording.time.tolist()):
        while at < 4 and recording.events[at].frame == frame:
            event, at = recording.events[at], at + 1
            cut = tracker.step(state, *moved(event.time), dt=event.time - before)[1]
            assert cut.feature_b == event.target
            early = event.time - 1e-11
            if early > before:
                cut = tracker.step(state, *moved(early), dt=early - before)[1]
                assert cut.feature_b == event.source
        if frame:
            state = tracker.step(state, *moved(time), dt=time - before)[0]
            before = time
    assert at == 4


def test_not_located_where_not_asked() -> None:
    path = straight((-1.0, -0.9, 0.8), (1.0, 0.77, 0.013))
    recording = so.track(
        so.Tracker(POINT, so.shapes.box(1.0, 1.0, 1.0), 1e-2), path, REST, 2.0, locate=False
    )
    # at frame 150 the point is in the Voronoi plane itself
    assert [event.frame for event in recording.events] in ([51, 52, k, 182] for k in (150, 151))
    for event in recording.events:
        assert not event.located
        assert event.time == recording.time[event.frame]
        assert math.isnan(event.slope)
    assert recording.info.options["locate"] is False


def test_over_a_corner_two_switches_have_one_instant() -> None:
    # Over the line where the regions of face, edges and vertex meet, x = y = 1/2.
    path = straight((0.3, 0.3, 0.8), (1.0, 1.0, 0.0))
    recording = so.track(so.Tracker(POINT, so.shapes.box(1.0, 1.0, 1.0), 3e-2), path, REST, 0.5)
    np.testing.assert_allclose(switch_times(recording), [0.2, 0.2], rtol=0.0, atol=1e-11)
    kinds = [(event.source.kind, event.target.kind) for event in recording.events]
    assert kinds == [("face", "edge"), ("edge", "vertex")]
    check_chain(recording)


def test_frames_that_lag_are_not_called_located() -> None:
    # One correction a frame from the last frame's point, whatever the gap: fast motion is behind.
    a, b, path_a, path_b = random_pairs(4)[3]
    lagging = so.track(
        so.Tracker(a, b, 0.05, law=so.PredictorCorrector(predictor="none", tolerance=math.inf)),
        path_a,
        path_b,
        1.5,
    )
    check_chain(lagging)
    exact = so.track(so.Tracker(a, b, 2.5e-3), path_a, path_b, 1.5)
    assert {event.located for event in lagging.events} == {True, False}
    for event in lagging.events:
        if event.located:
            twins = [e.time for e in exact.events if e[2:5] == event[2:5]]
            assert min(abs(event.time - time) for time in twins) < 1e-10
        else:
            assert event.time == lagging.time[event.frame]


@pytest.mark.parametrize("law", [so.PredictorCorrector(), so.PaperLaw()], ids=repr)
def test_not_located_out_of_an_overlap(law: Any) -> None:
    # A box through a box: the features before and after have nothing to do with each other.
    small, large = so.shapes.box(0.3, 0.2, 0.25), so.shapes.box(1.0, 1.0, 1.0)
    turned = so.Pose.from_wxyz(np.array([0.9, 0.3, 0.2, 0.1]) / math.sqrt(0.95), (-1.0, 0.1, 0.7))
    path = ConstantTwist(turned, so.Twist((1.0, 0.0, -0.5), (0.0, 0.0, 0.0)))
    recording = so.track(so.Tracker(small, large, 1e-2, law), path, REST, 3.0)
    overlapping = recording.penetrating
    assert overlapping.any()
    assert not overlapping[-1]
    check_chain(recording)
    out_of = [e for e in recording.events if overlapping[e.frame] or overlapping[e.frame - 1]]
    assert out_of
    assert not any(event.located for event in out_of)
    assert all(e.time == recording.time[e.frame] for e in out_of)
    assert any(event.located for event in recording.events)
