"""Derivatives by design at many poses: row by row those of the single answers."""

import numpy as np
import pytest

import standoff as so
from standoff.errors import StandoffError
from standoff.tracking.derivatives import Smoothness

REST = np.eye(4)
PAIRS = {
    "faces": ("ellipsoid", {"semi_axes": [0.5, 0.8, 1.1]}),
    "atlas, edges, vertices": ("lens", {"radius": 1.0, "offset": 0.45}),
    "planes": ("box", {"size": [0.7, 1.1, 0.4], "rounding": 0.05}),
    "edges of patches": ("gore", {"radius": 0.4, "height": 1.3}),
}


def many(rng, count):
    """Poses around the origin, some of them near it."""
    poses = np.tile(np.eye(4), (count, 1, 1))
    for pose in poses:
        n = rng.normal(size=3)
        pose[:3, :3] = so.Pose.exp(rng.normal(size=3), np.zeros(3)).rotation
        pose[:3, 3] = rng.uniform(0.2, 3.0) * n / np.linalg.norm(n)
    return poses


@pytest.mark.parametrize("pair", PAIRS)
def test_rows_are_the_single_answers(pair, rng):
    name, parameters = PAIRS[pair]
    a = so.Design(getattr(so.shapes, name), **parameters)
    b = so.Design(so.shapes.cylinder, radius=0.3, height=0.6)
    placed = so.Pose.exp([0.2, -0.3, 0.1], [0.1, 0.0, -0.2])
    found = so.distances(a.body, b.body, placed, many(rng, 60))
    told = so.shape_gradient(found, a=a, b=b)
    np.testing.assert_array_equal(told.smoothness, found.derivatives().smoothness)
    assert told.reasons == found.derivatives().reasons
    for k in range(len(found)):
        one = so.shape_gradient(found[k], a=a, b=b)
        assert told.smoothness[k] is one.smoothness
        assert told.reasons.get(k, "") == one.reason
        for side in "ab":
            rows, single = getattr(told, side), getattr(one, side)
            assert rows.keys() == single.keys()
            for key, rate in single.items():
                assert rows[key].shape == (60, *np.shape(rate))
                np.testing.assert_allclose(rows[key][k], rate, rtol=0.0, atol=1e-11)


def test_rows_without_witness_points_are_nan(rng):
    ball = so.Design(so.shapes.sphere, radius=0.4)
    poses = np.tile(np.eye(4), (4, 1, 1))
    poses[:, 0, 3] = 1.0, 9.0, 1.5, 2.0
    poses[2, 0, 0] = np.nan
    found = so.distances(ball.body, ball.body, REST, poses, within=3.0)
    told = so.shape_gradient(found, a=ball, b=ball)
    expected = [-1.0, np.nan, np.nan, -1.0]
    np.testing.assert_allclose(told.a["radius"], expected, atol=1e-9)
    np.testing.assert_allclose(told.b["radius"], expected, atol=1e-9)
    assert [kind is Smoothness.UNDEFINED for kind in told.smoothness] == [False, True, True, False]
    assert set(told.reasons) == {1, 2}


def test_many_placements_of_both_bodies(rng):
    """A moves in the rows, and its normals are turned into its frame row by row."""
    a = so.Design(so.shapes.ellipsoid, semi_axes=[0.5, 0.8, 1.1])
    ball, poses = so.shapes.sphere(0.2), many(rng, 20)
    poses[:, :3, 3] *= 2.0
    at_rest = so.distances(a.body, ball, REST, poses)
    turned = so.distances(a.body, ball, np.linalg.inv(poses), REST)
    found = [so.shape_gradient(rows, a=a).a["semi_axes"] for rows in (at_rest, turned)]
    np.testing.assert_allclose(found[0], found[1], rtol=0.0, atol=1e-9)


def test_frames_of_a_run_are_the_single_answers(rng):
    """From faces over edges to vertices, past the horizon and back."""
    a = so.Design(so.shapes.lens, radius=1.0, offset=0.45)
    b = so.Design(so.shapes.ellipsoid, semi_axes=[0.15, 0.3, 0.2])
    placed = so.Pose.exp([0.2, -0.3, 0.1], [0.1, 0.0, -0.2])
    poses = np.tile(np.eye(4), (40, 1, 1))
    angles = np.linspace(0.0, 3.0, 40)
    far = 1.2 + 2.0 * (angles > 2.5)
    poses[:, :3, 3] = (far * [np.cos(angles), np.sin(angles), 0.3 * angles]).T
    tracker = so.Tracker(a.body, b.body, law=so.PredictorCorrector(within=2.0))
    _, answers = tracker.run(tracker.start(placed, poses[0]), placed, poses[1:], dt=0.05)
    np.testing.assert_allclose(answers.poses[1], poses[1:], atol=1e-15)
    told = so.shape_gradient(answers, a=a, b=b)
    assert {kind for kind, _ in (x.feature_a for x in answers)} >= {"face", "edge", ""}
    for k, answer in enumerate(answers):
        if not answer.feature_a.kind:
            assert np.isnan(told.a["radius"][k])
            assert told.smoothness[k] is Smoothness.UNDEFINED
            continue
        one = so.shape_gradient(answer, a=a, b=b)
        assert told.smoothness[k] is one.smoothness
        assert told.reasons.get(k, "") == one.reason
        assert abs(told.a["radius"][k] - one.a["radius"]) <= 1e-11
        np.testing.assert_allclose(told.b["semi_axes"][k], one.b["semi_axes"], atol=1e-11)


def test_rows_of_other_bodies_are_refused():
    ball = so.Design(so.shapes.sphere, radius=1.0)
    pose = np.eye(4)
    pose[0, 3] = 3.0
    other = so.distances(so.shapes.sphere(0.9), ball.body, REST, pose[None])
    with pytest.raises(StandoffError, match="not the body of the design"):
        so.shape_gradient(other, a=ball)
