"""Answers at places that no search would choose: each was once wrong and certified, or no bound.

The truth is a closed form: bodies that share a point, concentric bodies, heights over a plane.
"""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff as so

REST = np.eye(4)
LAWS = {
    "paper": so.PaperLaw(),
    "paper, without restarts": so.PaperLaw(restarts=False),
    "as printed": so.PaperLaw.as_printed(gain=100.0),
    "a deadline of 1": so.PredictorCorrector(deadline=1),
    "no tolerance": so.PredictorCorrector(tolerance=np.inf),
    "default": so.PredictorCorrector(),
}


def at(p, rotation=None):
    pose = np.eye(4)
    pose[:3, 3] = p
    if rotation is not None:
        pose[:3, :3] = rotation.as_matrix()
    return pose


def check_bounds(answer, truth, roundoff=1e-11):
    assert answer.lower_bound <= truth + roundoff
    assert answer.upper_bound >= truth - roundoff
    assert np.isfinite([answer.distance, *answer.point_a, *answer.point_b, *answer.normal]).all()
    assert np.linalg.norm(answer.normal) == pytest.approx(1.0, abs=1e-14)
    if answer.certified:
        assert answer.distance == pytest.approx(truth, abs=2e-3 * abs(truth) + 1e-9)


def test_a_normal_along_an_edge_bounds_nothing(rng):
    for _ in range(200):
        v = rng.normal(size=3)
        u = v / np.linalg.norm(v) + 0.3 * rng.normal(size=3)
        a = so.shapes.segment(start=-u, end=[0.0, 0.0, 0.0])
        b = so.shapes.segment(start=[0.0, 0.0, 0.0], end=v)  # both contain the origin
        tracker = so.Tracker(a, b, law=so.PaperLaw())
        places = (("vertex", 1), ()), (("edge", 0), (1.0,))
        check_bounds(tracker.start_from(REST, REST, *places).proximity, 0.0)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_segments_that_meet_at_an_end(law, rng):
    for _ in range(60):
        v, u = np.round(rng.normal(size=(2, 3)) * 4.0) / 4.0 + [0.0, 0.0, 0.25]
        side = np.cross(v, rng.normal(size=3))
        if u @ v < 0.1 or not side.any():
            continue
        side *= 0.3 / np.linalg.norm(side)
        a = so.shapes.segment(start=-u, end=[0.0, 0.0, 0.0])
        b = so.shapes.segment(start=[0.0, 0.0, 0.0], end=v)
        tracker = so.Tracker(a, b, law=law)
        state = tracker.start(REST, at(side - 0.5 * v))  # A's end is beside the middle of B
        check_bounds(tracker.step(state, REST, REST)[1], 0.0)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_points_that_coincide_prove_no_depth(law):
    """One box in the place of the other: the depth is its width, not 0."""
    box = so.shapes.box(2.0, 2.0, 2.0)
    tracker = so.Tracker(box, box, law=law)
    corner = (("vertex", 0), ())
    state = tracker.start_from(REST, REST, corner, corner, settle=False)
    check_bounds(state.proximity, -2.0)
    check_bounds(tracker.step(state, REST, REST)[1], -2.0)


def test_without_a_tolerance_no_depth_is_proven(rng):
    a, b = so.shapes.capsule(0.3, 1.0), so.shapes.ellipsoid(0.5, 0.3, 0.2)
    tracker = so.Tracker(a, b, law=so.PredictorCorrector(tolerance=np.inf))
    state, overlaps = tracker.start(REST, at([2.0, 0.0, 0.0])), 0
    for _ in range(400):
        pose = at(rng.normal(size=3) * 0.45, Rotation.random(random_state=rng))
        state, answer = tracker.step(state, REST, pose)
        if answer.certified and answer.distance < 0.0:
            overlaps += 1
            truth = so.distance(a, b, REST, pose).distance
            assert answer.distance == pytest.approx(truth, rel=2e-3)
    assert overlaps > 50


@pytest.mark.parametrize("deadline", [1, 2, 3, 4, 8, 16])
def test_a_deadline_over_a_half_space(deadline, rng):
    floor, cylinder = so.shapes.halfspace(), so.shapes.cylinder(0.4, 1.5)
    tracker = so.Tracker(floor, cylinder, law=so.PredictorCorrector(deadline=deadline))
    state, cut = tracker.start(REST, at([0.0, 0.0, -0.1])), 0
    for _ in range(300):
        pose = at([0.0, 0.0, rng.uniform(-0.6, 0.2)], Rotation.random(random_state=rng))
        up = pose[2, :3]
        lowest = 0.4 * math.hypot(up[0], up[1]) + 0.75 * abs(up[2])
        state, answer = tracker.step(state, REST, pose)
        check_bounds(answer, pose[2, 3] - lowest)
        cut += answer.status is so.Status.DEADLINE
    assert cut > 0 or deadline == 16


@pytest.mark.parametrize("switching", ["multipliers", "voronoi"])
@pytest.mark.parametrize("scale", [1e40, 1e78, 1e90])
def test_twists_beyond_all_bounds_leave_the_points_on_the_body(switching, scale, rng):
    lens = so.shapes.lens(1.0, 0.6)  # the part common to three unit balls
    angles = 2.0 * math.pi / 3.0 * np.arange(3)
    centres = -0.6 * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(3)])
    law = so.PaperLaw(switching=switching)
    for _ in range(4):
        tracker = so.Tracker(lens, lens, law=law)
        pose = at(rng.normal(size=3) * 2.0, Rotation.random(random_state=rng))
        state = tracker.start(REST, pose)
        d, w = rng.normal(size=3) * 0.05, rng.normal(size=3) * 0.1
        for _ in range(40):
            turned = Rotation.from_rotvec(w) * Rotation.from_matrix(pose[:3, :3])
            pose = at(pose[:3, 3] + d, turned)
            twist = np.concatenate([d, w]) * 1e3 * scale
            state, answer = tracker.step(state, REST, pose, np.zeros(6), twist)
            off = np.linalg.norm(answer.point_a - centres, axis=1).max() - 1.0
            assert answer.distance <= 0.0 or off <= 1e-9
    assert answer.counts.saturations > 0


def test_as_printed_a_point_on_a_half_space_stays_beside_the_body(rng):
    floor, cap, saturated = so.shapes.halfspace(), so.shapes.cap(1.0, 0.3), 0
    for _ in range(12):
        tracker = so.Tracker(floor, cap, law=so.PaperLaw.as_printed(gain=800.0))
        pose = at(rng.normal(size=3) * 0.5, Rotation.random(random_state=rng))
        state = tracker.start(REST, pose)
        for _ in range(40):
            turned = Rotation.from_rotvec(rng.normal(size=3) * 0.5) * Rotation.from_matrix(
                pose[:3, :3]
            )
            pose = at(pose[:3, 3] + rng.normal(size=3) * 0.1, turned)
            state, answer = tracker.step(state, REST, pose, *(rng.normal(size=(2, 6)) * 100.0))
            assert np.isfinite([answer.distance, answer.upper_bound]).all()
            assert not np.isnan(answer.lower_bound)
            assert np.abs(answer.point_a - pose[:3, 3]).max() < 100.0
            saturated += answer.counts.saturations
    assert saturated > 0


def test_a_cones_normal_past_its_apex_by_roundoff(rng):
    """A parameter below 0 by roundoff turned the face's normal around."""
    cone, point = so.shapes.cone(1.0, 1.0), so.shapes.point()
    side, apex = 0, cone.vertex_points[0]  # the face that is no plane
    for _ in range(100):
        x = rng.normal(size=3) * 3.0
        truth = so.distance(cone, point, REST, at(x)).distance
        tracker = so.Tracker(cone, point, law=so.PaperLaw(switching="none", restarts=False))
        for v in (-1e-17, 0.0, 1e-17):
            place = ("face", side), (rng.uniform(0.1, 6.0), v)
            answer = tracker.start_from(REST, at(x), place, (("vertex", 0), ())).proximity
            assert np.allclose(answer.point_a, apex)
            check_bounds(answer, truth)


def test_a_witness_point_leaves_no_face_without_width(rng):
    """The rim of a flat polygon goes on for ever along its line, but for its ends."""
    corners = np.array([[-1.25, 0.75, 0.0], [-0.75, 0.0, 0.0], [-0.75, 0.5, 0.0]])
    polygon, point = so.shapes.polygon(corners), so.shapes.point()
    tracker = so.Tracker(point, polygon)
    vertex = (("vertex", 0), ())
    for _ in range(40):
        # beyond a corner, nearest to it, in the polygon's plane: no step leads across a rim
        out = corners[0] - corners[1:].mean(axis=0)
        pose = at(-corners[0] - out * rng.uniform(0.5, 3.0) + rng.normal(size=3) * [0.1, 0.1, 0.0])
        truth = min(np.linalg.norm(corners + pose[:3, 3], axis=1))
        for face in (2, 3, 4):
            place = ("face", face), (rng.uniform(0.0, 0.3), 0.0)
            state = tracker.start_from(REST, pose, vertex, place)
            check_bounds(state.proximity, truth)
            moved = at(pose[:3, 3] + rng.normal(size=3) * [0.05, 0.05, 0.0])
            truth_then = min(np.linalg.norm(corners + moved[:3, 3], axis=1))
            check_bounds(tracker.step(state, REST, moved)[1], truth_then)
