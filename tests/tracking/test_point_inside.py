"""A point in a spatial body: depth, the medial switches in closed form, and the way out."""

from __future__ import annotations

import numpy as np
import pytest

import standoff as so
from oracles.depth import depth_minima
from standoff_studies.oracles import Cylinder, Ellipsoid, Lens, Placed, Point

HOME = np.eye(4)
HALF = np.array([1.0, 1.5, 2.0])
BOX = so.shapes.box(2, 3, 4)
LENS = so.shapes.lens(2, 1)
CYLINDER = so.shapes.cylinder(1, 4)
ELLIPSOID = so.shapes.ellipsoid(3, 2, 1)
ROUNDING = 0.2
ROUNDED = so.shapes.box(2, 3, 4, rounding=ROUNDING)
CENTRES = -np.array([[np.cos(t), np.sin(t), 0] for t in 2 * np.pi / 3 * np.arange(3)])

FRAMES = 60
INSTANT = 1e-9
"""Error of a located switch [s]: the run takes one second."""


def box_depths(x):
    return np.concatenate([HALF - x, HALF + x], axis=-1)


def rounded_box(x):
    q = np.abs(x) - HALF + ROUNDING
    return np.linalg.norm(np.maximum(q, 0)) + min(q.max(), 0.0) - ROUNDING


def pose_of(x):
    pose = np.eye(4)
    pose[:3, 3] = x
    return pose


def cold(body, x):
    return so.distance(body, so.shapes.point(), HOME, pose_of(x)).distance


def run(body, place, velocity=None, frames=FRAMES):
    """Answers of one second, and the places; the first answer is the start's."""
    tracker = so.PointTracker(body, 1.0 / frames)
    times = np.linspace(0, 1, frames + 1)
    places = np.array([place(t) for t in times])
    speeds = [None if velocity is None else velocity(t) for t in times]
    state = tracker.start(places[0], speeds[0])
    answers = [state.proximity]
    for x, v in zip(places[1:], speeds[1:], strict=True):
        state, answer = tracker.step(state, x, v)
        answers.append(answer)
    return answers, places


def straight(body, p, q, frames=FRAMES):
    p, q = np.array(p, dtype=float), np.array(q, dtype=float)
    return run(body, lambda t: p + t * (q - p), lambda t: q - p, frames)


def events(answers, kind):
    return [e for answer in answers for e in answer.events if e.kind == kind]


def check(body, answers, places):
    """The answer is the cold one, between its bounds, and continuous."""
    for answer, x in zip(answers, places, strict=True):
        d = cold(body, x)
        assert answer.distance == pytest.approx(d, abs=1e-12)
        assert answer.lower_bound <= answer.distance <= answer.upper_bound
        assert answer.certified
        assert answer.inside == (d < 0) == bool(answer.minima)
        np.testing.assert_allclose(answer.witness + d * answer.normal, x, atol=1e-9)
        keys = [m.key for m in answer.minima]
        assert len(set(keys)) == len(keys)
        if answer.inside:
            assert answer.minima[0].distance == pytest.approx(-d, abs=1e-12)
            assert answer.active in keys
    ways = np.linalg.norm(np.diff(places, axis=0), axis=1)
    d = np.array([answer.distance for answer in answers])
    assert (np.abs(np.diff(d)) <= ways + 1e-12).all()


def first_changes(depths, p, v):
    """Instants at which the least of linear depths changes on a line, and which it becomes."""
    start, rate = depths(p), depths(p + v) - depths(p)
    now, time, found = int(np.argmin(start)), 0.0, []
    while True:
        with np.errstate(divide="ignore", invalid="ignore"):
            meets = (start - start[now]) / (rate[now] - rate)
        meets[(rate >= rate[now]) | (meets <= time)] = np.inf
        if meets.min() >= 1.0:
            return found
        now = int(np.argmin(meets))
        time = float(meets[now])
        found.append((time, now))


def outward(number):
    return np.eye(3)[number % 3] * (1 if number < 3 else -1)


@pytest.mark.parametrize("frames", [FRAMES, 1])
@pytest.mark.parametrize("draw", range(4))
def test_box(draw, frames, rng):
    """One frame may hold all switches of the way: each is found at its own time."""
    p, q = rng.uniform(-0.95, 0.95, (2, 3)) * HALF
    answers, places = straight(BOX, p, q, frames)
    check(BOX, answers, places)
    for answer, x in zip(answers, places, strict=True):
        np.testing.assert_allclose(
            sorted(m.distance for m in answer.minima), np.sort(box_depths(x)), atol=1e-13
        )
    found, wanted = events(answers, "medial"), first_changes(box_depths, p, q - p)
    assert all(e.located for e in found)
    np.testing.assert_allclose([e.time for e in found], [t for t, _ in wanted], atol=INSTANT)
    normals = {m.feature: m.normal for m in answers[0].minima}
    for event, (_, number) in zip(found, wanted, strict=True):
        np.testing.assert_allclose(normals[event.target], outward(number), atol=1e-12)
        assert event.slope < 0.0


def test_box_by_turns():
    """All six faces win in turn, with keys that stay."""
    corners = np.array([[0.9, 0, 0], [0, 1.4, 0], [0, 0, 1.9], [-0.9, 0, 0], [0, -1.4, 0]])
    tracker = so.PointTracker(BOX)
    state = tracker.start(corners[0])
    keys = {m.feature: m.key for m in state.proximity.minima}
    assert len(keys) == 6
    for corner in corners[1:]:
        for x in np.linspace(state.point, corner, 21)[1:]:
            state, answer = tracker.step(state, x)
            assert {m.feature: m.key for m in answer.minima} == keys
            assert answer.distance == pytest.approx(-box_depths(x).min(), abs=1e-14)


def test_a_third_face_wins_within_one_step():
    (start, answer), _ = straight(BOX, (0.95, 0.6, 0), (-0.95, 0.6, 0), 1)
    normals = {m.feature: m.normal for m in start.minima}
    assert all(e.located for e in answer.events)
    np.testing.assert_allclose(
        [e.time for e in answer.events], [0.85 / 1.9, 1.05 / 1.9], atol=INSTANT
    )
    between, last = (normals[e.target] for e in answer.events)
    np.testing.assert_allclose([between, last], [[0, 1, 0], [-1, 0, 0]], atol=1e-12)


def test_ellipsoid_changes_sides_in_its_symmetry_plane():
    answers, places = straight(ELLIPSOID, (0.3, 0.2, -0.3), (0.1, 0.3, 0.5))
    check(ELLIPSOID, answers, places)
    (event,) = events(answers, "medial")
    assert event.located
    assert event.time == pytest.approx(0.375, abs=INSTANT)
    assert event.source == event.target  # one face holds both minima
    below, above = sorted(answers[22].minima, key=lambda m: m.normal[2])
    np.testing.assert_allclose(answers[22].normal, below.normal)
    assert above.normal[2] > 0.9
    # along the long axis: there is one minimum beyond a²-c² over a, and two within
    answers, places = straight(ELLIPSOID, (0, 0, 0), (2.95, 0, 0))
    check(ELLIPSOID, answers, places)
    for answer, (x, _, _) in zip(answers, places, strict=True):
        if abs(x - 8 / 3) > 0.01:
            assert len(answer.minima) == (2 if x < 8 / 3 else 1)
            depth = np.sqrt(1 - x * x / 8) if x < 8 / 3 else 3 - x
            assert answer.distance == pytest.approx(-depth, abs=1e-10)


@pytest.mark.parametrize(
    ("body", "shape", "x"),
    [
        (ELLIPSOID, Ellipsoid(3, 2, 1), (0.4, -0.3, 0.1)),
        (LENS, Lens(2, 1), (0.1, 0.2, -0.3)),
        (CYLINDER, Cylinder(1, 4), (0.3, -0.4, 0.7)),
    ],
)
def test_minima_by_brute_force(body, shape, x):
    answer = so.PointTracker(body).start(x).proximity
    truth = depth_minima(Placed(shape, np.eye(3), np.zeros(3)), Placed(Point(), np.eye(3), x))
    np.testing.assert_allclose(
        [m.distance for m in answer.minima], [m.depth for m in truth.minima], atol=1e-9
    )


def test_lens_where_two_balls_are_equally_far():
    """The depth in a ball is 2 less the distance to its centre."""
    p, q = np.array([-0.3, 0.2, 0.1]), np.array([0.4, -0.1, 0.3])
    answers, places = straight(LENS, p, q)
    check(LENS, answers, places)
    for answer, x in zip(answers, places, strict=True):
        deep = 2 - np.linalg.norm(x - CENTRES, axis=1)
        np.testing.assert_allclose([m.distance for m in answer.minima], np.sort(deep), atol=1e-12)
    (event,) = events(answers, "medial")
    first = np.argmin(2 - np.linalg.norm(p - CENTRES, axis=1))
    last = np.argmin(2 - np.linalg.norm(q - CENTRES, axis=1))
    apart = CENTRES[last] - CENTRES[first]  # the centres are equally far from the origin
    assert event.time == pytest.approx(-(p @ apart) / ((q - p) @ apart), abs=INSTANT)
    assert event.located


def test_cylinder_from_side_to_cap():
    answers, places = straight(CYLINDER, (0.3, -0.4, 0), (0.3, -0.4, 1.9))
    check(CYLINDER, answers, places)
    (event,) = events(answers, "medial")
    assert (event.source.kind, event.target.kind, event.located) == ("face", "face", True)
    assert event.time == pytest.approx(1.5 / 1.9, abs=INSTANT)
    assert event.value == pytest.approx(0, abs=1e-14)
    assert event.slope == pytest.approx(-1.9)


def test_curved_way():
    """Between frames with velocities the way is a cubic; here it is one itself."""
    way = np.polynomial.Polynomial([-0.9, 0.3, 2.2, -0.8])
    answers, places = run(
        BOX,
        lambda t: np.array([way(t), 0.1 * t, 0]),
        lambda t: np.array([way.deriv()(t), 0.1, 0]),
        7,
    )
    check(BOX, answers, places)
    (event,) = events(answers, "medial")
    root = next(r.real for r in way.roots() if abs(r.imag) < 1e-12 and 0 < r.real < 1)
    assert event.time == pytest.approx(root, abs=INSTANT)
    assert event.slope == pytest.approx(-2 * way.deriv()(root))


def test_in_and_out_and_back():
    """In by a side, out at the top, in again, at exact times; inside a medial switch each way."""

    def place(t):
        z = 4.5 * (1 - abs(2 * t - 1)) - 1.2
        return np.array([0.3, 1.4 if z > -2 else 0.0, z])

    answers, places = straight(BOX, (-1.5, 0.1, 0.2), (2.5, 0.4, 0.2))
    check(BOX, answers, places)
    np.testing.assert_allclose(
        [e.time for e in events(answers, "crossing")], [0.125, 0.625], atol=INSTANT
    )
    assert [e.slope for e in events(answers, "crossing")] == pytest.approx([-4, 4])
    answers, places = run(BOX, place)  # no velocity
    check(BOX, answers, places)
    crossings = events(answers, "crossing")
    np.testing.assert_allclose([e.time for e in crossings], [3.2 / 9, 1 - 3.2 / 9], atol=INSTANT)
    medial = events(answers, "medial")
    np.testing.assert_allclose([e.time for e in medial], [3.1 / 9, 1 - 3.1 / 9], atol=INSTANT)
    assert [e.target for e in medial] == [crossings[0].source, medial[0].source]
    assert np.isnan(crossings[0].slope)
    assert np.isnan(answers[-1].rate)
    (once, after), _ = straight(BOX, (-0.9, 0, 0), (1.2, 0.1, 0), 1)
    assert [e.kind for e in after.events] == ["medial", "crossing"]
    np.testing.assert_allclose([e.time for e in after.events], [0.9 / 2.1, 1.9 / 2.1])
    assert (once.inside, after.inside, after.counts.switches) == (True, False, 2)


def test_swept_radius():
    """Inside, in the shell around the core, and outside past a rounded corner."""
    answers, places = straight(ROUNDED, (0.2, 0, 0), (1.1, 1.6, 2.1))
    check(ROUNDED, answers, places)
    for answer, x in zip(answers, places, strict=True):
        assert answer.distance == pytest.approx(rounded_box(x), abs=1e-12)
    (crossing,) = events(answers, "crossing")
    at = places[0] + crossing.time * (places[-1] - places[0])
    assert rounded_box(at) == pytest.approx(0, abs=1e-12)
    sphere = so.PointTracker(so.shapes.sphere(2.0)).start((0.3, 0, 0.4)).proximity
    assert sphere.distance == pytest.approx(-1.5, abs=1e-14)
    assert len(sphere.minima) == 1


@pytest.mark.parametrize("body", [BOX, LENS, CYLINDER, ELLIPSOID, ROUNDED], ids=lambda b: b.name)
def test_rate_and_cold_answer_on_random_ways(body, rng):
    centre, *bows = rng.uniform(-0.5, 0.5, (4, 3))
    w = np.array([5.0, 7.0, 9.0])[:, None]
    answers, places = run(
        body,
        lambda t: centre + (bows * np.sin(w * t)).sum(axis=0),
        lambda t: (bows * w * np.cos(w * t)).sum(axis=0),
        100,
    )
    check(body, answers, places)
    for answer in answers:
        assert len(answer.minima) <= 12
        for event in answer.events:
            assert event.located == (event.kind != "voronoi")


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: so.PointTracker("box"), "is not a Body"),
        (lambda: so.PointTracker(BOX).start((0, 0)), "shape"),
        (lambda: so.PointTracker(BOX).start((0, 0, np.nan)), "point"),
        (lambda: so.points.record_point(so.PointTracker(BOX), None, [0.0]), "not a path"),
        (lambda: so.points.record_point(BOX, HOME, [0.0]), "PointTracker"),
    ],
)
def test_bad_input(call, words):
    with pytest.raises((TypeError, ValueError), match=words):
        call()
