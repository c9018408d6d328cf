"""Sliding, swinging and tilting contact, frame by frame against the truth by construction."""

from __future__ import annotations

import numpy as np
import pytest
from benchmarks.touching import DT, RIGHT, run
from benchmarks.touching_scenes import SCENES, SWING, gaps_of, oscillating

import standoff as so
from draws import draws
from tracking.contact_cases import CASES, OVERLAPS

STEPS = draws(2000)
DISTANCE = 1e-12
"""Error over the size; tilts through parallel may cost the certificate's tolerance."""
WITNESS = 1e-9
NORMAL = 1e-9
JUMP = 2.0
"""Witness points may move by so many times the motion of a frame."""
BOUND = 1e-14
"""A lower bound may be above the truth by its roundoff, over the size."""
MOST = 200
"""Second-order evaluations a frame: the most seen in 10^6 frames is 88, where a depth is proven."""

RUNS = [
    pytest.param(scene, name, gap, id=f"{scene.name}, {name}")
    for scene in SCENES
    for name, gap in gaps_of(scene)
]


@pytest.mark.parametrize(("scene", "name", "gap"), RUNS)
def test_contact_is_kept(scene, name, gap):
    report = run(scene, name, gap, STEPS)
    assert report.lost == 0, f"first at frame {report.first_lost}"
    assert report.distance <= (RIGHT if scene.jumps else DISTANCE)
    assert report.bound <= BOUND
    assert report.normal <= NORMAL
    assert report.flips == 0
    assert report.evaluations <= MOST
    assert report.witness <= WITNESS
    if not scene.jumps:
        assert report.jump <= JUMP


@pytest.mark.parametrize("scene", [s for s in SCENES if not s.jumps], ids=lambda s: s.name)
def test_slope_through_contact_is_one(scene):
    """The distance follows the gap through zero, from Python, and the normal does not turn."""
    swing = oscillating(SWING * min(scene.a.size, scene.b.size))
    times = 2 * np.pi / 11 + DT * np.arange(-20, 20)
    frames, twists = scene.motion(times, swing)
    tracker = so.Tracker(scene.a, scene.b, DT)
    poses = [
        so.Pose.from_checked(*pose) for pose in zip(frames.rotations, frames.positions, strict=True)
    ]
    state = tracker.start(HOME, poses[0])
    found = []
    for pose, xi in zip(poses[1:], twists[1:], strict=True):
        state, answer = tracker.step(state, HOME, pose, None, (xi[:3], xi[3:]))
        found.append((answer.distance, answer.rate, *answer.normal))
    d, rate, *normals = np.array(found).T
    gaps = swing(times)
    assert gaps.min() < 0 < gaps.max()
    np.testing.assert_allclose(np.diff(d) / np.diff(gaps[1:]), 1.0, rtol=1e-9)
    np.testing.assert_allclose(
        rate, 11 * SWING * min(scene.a.size, scene.b.size) * np.cos(11 * times[1:]), rtol=1e-6
    )
    np.testing.assert_allclose(np.transpose(normals), frames.normals[1:], atol=NORMAL)


HOME = so.Pose.identity()
DIMENSIONS = {
    "face on face": 2,
    "disc on face": 2,
    "cylinder lying on face": 1,
    "capsules parallel": 1,
}


@pytest.mark.parametrize("scene", [s for s in SCENES if not s.jumps], ids=lambda s: s.name)
def test_the_flag_tells_the_scene(scene, rng):
    """Witness points are unique where the scene says so, and their set holds the answer."""
    for _, gap in gaps_of(scene):
        times = np.sort(rng.uniform(0.0, 20.0, draws(3)))
        frames, _ = scene.motion(times, gap)
        for k in range(len(times)):
            pose = so.Pose.from_checked(frames.rotations[k], frames.positions[k])
            answer = so.distance(scene.a, scene.b, HOME, pose)
            found = answer.witness_set()
            assert found.dimension == DIMENSIONS.get(scene.name, 0)
            assert found.normal_dimension == 0
            assert found.residual <= WITNESS * scene.size
            assert answer.unique == (scene.outside is None)
            if scene.outside is not None:
                part = so_frames(frames, k)
                for x in (answer.point_a, *found.points_a):
                    assert scene.outside(part, x[None]).max() <= WITNESS * scene.size


REST = [
    case for case in CASES if "sliver" not in case.name
]  # which part sideways when they overlap


@pytest.mark.parametrize("case", REST, ids=str)
def test_cold_answers_at_rest(case):
    """Distance, normal and set of witness points of a cold query, from a gap into overlap."""
    n = np.array(case.normal)
    size = sum(body.size for body in (case.a, case.b) if body.bounded)
    for gap in case.gaps:
        pose = so.Pose.exp(case.turn, case.position + gap * n)
        answer = so.distance(case.a, case.b, HOME, pose)
        found = answer.witness_set()
        assert answer.certified or answer.status is so.Status.LOCAL
        assert abs(answer.distance - gap) <= DISTANCE * size
        assert found.dimension == case.dim
        assert found.normal_dimension == (case.normals if gap == 0.0 else 0)
        assert found.residual <= WITNESS * size
        if not found.normal_dimension:
            assert np.linalg.norm(answer.normal - n) <= NORMAL


@pytest.mark.parametrize("case", OVERLAPS, ids=str)
def test_cold_answers_in_overlap(case):
    answer = so.distance(case.a, case.b, HOME, so.Pose.exp(case.turn, case.position))
    found = answer.witness_set()
    depth = float(np.subtract(case.x, case.y) @ np.array(case.normal))
    assert answer.distance == pytest.approx(-depth, abs=DISTANCE)
    assert (found.dimension, found.normal_dimension) == (case.dim, case.normals)


def so_frames(frames, k):
    """One of the frames."""
    return type(frames)(*(np.asarray(v)[k : k + 1] for v in vars(frames).values()))
