"""``so.distances``: every row is what ``so.distance`` says of it, and bad rows spoil no other."""

import copy
import pickle
import time

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff as so
from standoff.tracking import Status, threads

LENS, TOOL, BOX = (
    so.shapes.lens(1.0, 0.45),
    so.shapes.ellipsoid(0.15, 0.3, 0.2),
    so.shapes.box(1, 2, 3),
)
CAPSULE = so.shapes.capsule(0.2, 0.5)
PAIRS = {"lens": (LENS, TOOL), "box": (BOX, CAPSULE), "boxes": (BOX, BOX)}


def drawn(rng, n, reach=2.0):
    """Random poses (n, 4, 4), some of which let the bodies overlap."""
    poses = np.tile(np.eye(4), (n, 1, 1))
    poses[:, :3, :3] = Rotation.random(n, random_state=rng).as_matrix()
    poses[:, :3, 3] = rng.uniform(-reach, reach, size=(n, 3))
    return poses


def along(n):
    """Poses of a body that turns and passes another."""
    poses = np.tile(np.eye(4), (n, 1, 1))
    turns = np.linspace(0.0, 1.0, n)
    poses[:, :3, :3] = Rotation.from_rotvec(np.outer(turns, [0.3, 0.5, 1.0])).as_matrix()
    poses[:, :3, 3] = np.c_[1.6 * np.cos(turns), 1.6 * np.sin(turns), 0.2 * turns]
    return poses


@pytest.mark.parametrize("kind", PAIRS)
def test_each_row_is_a_cold_query(kind, rng):
    a, b = PAIRS[kind]
    poses_a, poses_b = drawn(rng, 60, 0.5), drawn(rng, 60)
    found = so.distances(a, b, poses_a, poses_b)
    single = [so.distance(a, b, x, y) for x, y in zip(poses_a, poses_b, strict=True)]
    for name in ("distance", "lower_bound", "upper_bound", "point_a", "point_b", "normal"):
        np.testing.assert_array_equal(
            getattr(found, name), np.array([getattr(answer, name) for answer in single])
        )
    assert found.status.tolist() == [answer.status for answer in single]
    assert found.certified.tolist() == [answer.certified for answer in single]
    for side in "ab":
        features = getattr(found, f"feature_{side}")
        told = [getattr(answer, f"feature_{side}") for answer in single]
        assert [(kind, index) for kind, index in features.tolist()] == [
            (feature.kind, feature.index) for feature in told
        ]
    assert found[7].distance == single[7].distance
    assert (found.distance < 0.0).any()
    assert (found.distance > 0.0).any()


def test_one_pose_and_rows_of_twelve(rng):
    poses = drawn(rng, 20)
    whole = so.distances(LENS, TOOL, np.tile(np.eye(4), (20, 1, 1)), poses)
    flat = np.hstack([poses[:, :3, :3].reshape(20, 9), poses[:, :3, 3]])
    for one in (np.eye(4), so.Pose.identity(), np.eye(4)[None]):
        for many in (poses, flat, poses.tolist()):
            np.testing.assert_array_equal(so.distances(LENS, TOOL, one, many).rows, whole.rows)
    other = so.distances(TOOL, LENS, poses, so.Pose.identity())
    np.testing.assert_allclose(other.distance, whole.distance, atol=1e-9)


@pytest.mark.parametrize("workers", [2, 3, 7, 100])
def test_the_bytes_do_not_depend_on_the_workers(workers, rng):
    poses = drawn(rng, 53)
    alone = so.distances(LENS, TOOL, np.eye(4), poses)
    shared = so.distances(LENS, TOOL, np.eye(4), poses, workers=workers)
    assert alone.rows.tobytes() == shared.rows.tobytes()


@pytest.mark.parametrize("warm", [False, True])
def test_a_bad_row_says_so_and_the_others_stand(warm):
    poses = along(12)
    sound = so.distances(LENS, TOOL, np.eye(4), poses, warm=warm)
    wrong = poses.copy()
    wrong[3, 0, 0] = np.nan
    wrong[4, :3, 0] *= -1.0
    wrong[8, 3, 0] = 1.0
    found = so.distances(LENS, TOOL, np.eye(4), wrong, warm=warm)
    assert sorted(found.errors) == [3, 4, 8]
    assert "Row 4 of poses_b" in str(found.errors[4])
    good = [0, 1, 2, 5, 6, 7, 9, 10, 11]
    np.testing.assert_allclose(found.distance[good], sound.distance[good], atol=1e-9)
    assert np.isnan(found.rows[[3, 4, 8]]).all()
    assert [found.status[k] for k in (3, 4, 8)] == [Status.REFUSED] * 3
    assert found.feature_a["index"][3] == -1
    assert np.isnan(found.gradient[3]).all()
    with pytest.raises(ValueError, match="mirror"):
        found[4]
    assert "3 refused" in repr(found)


def test_all_rows_may_be_refused():
    found = so.distances(LENS, TOOL, np.full((4, 4), np.nan), along(3), warm=True)
    assert len(found.errors) == 3
    assert np.isnan(found.distance).all()


def test_rounded_rotations_are_mended_and_counted():
    poses = along(5)
    poses[2, :3, :3] += 1e-8
    found = so.distances(LENS, TOOL, np.eye(4), poses)
    assert found.repaired.tolist() == [0, 0, 1, 0, 0]
    answer = so.distance(LENS, TOOL, np.eye(4), poses[2])
    assert found.distance[2] == answer.distance


def test_warm_rows_are_those_of_a_run():
    poses = along(200)
    found = so.distances(LENS, TOOL, np.eye(4), poses, warm=True)
    tracker = so.Tracker(LENS, TOOL)
    begin = tracker.start(np.eye(4), poses[0])
    _, answers = tracker.run(begin, np.eye(4), poses[1:])
    np.testing.assert_array_equal(found.distance[1:], answers.distance)
    assert found.distance[0] == begin.proximity.distance
    cold = so.distances(LENS, TOOL, np.eye(4), poses)
    np.testing.assert_allclose(found.distance, cold.distance, atol=1e-9)
    assert found.certified.all()


def test_the_gradient_is_that_of_single_answers(rng):
    poses_a, poses_b = drawn(rng, 10, 0.3), drawn(rng, 10, 3.0)
    found = so.distances(LENS, TOOL, poses_a, poses_b)
    for k in np.flatnonzero(found.distance > 0.1):
        answer = so.distance(LENS, TOOL, poses_a[k], poses_b[k])
        np.testing.assert_allclose(found.gradient[k], answer.gradient, atol=1e-9)


def test_planar_rows_stay_in_their_plane():
    disc = so.shapes.planar_loop([so.geometry.ConicArc((0, 0), (1, 0), (0, 1))])
    poses = np.tile(np.eye(4), (3, 1, 1))
    poses[:, 0, 3] = 2.5, 3.0, 3.5
    poses[1, 2, 3] = 0.1
    found = so.distances(disc, disc, np.eye(4), poses)
    np.testing.assert_allclose(found.distance[[0, 2]], [0.5, 1.5], atol=1e-12)
    assert list(found.errors) == [1]


def test_it_is_a_value(rng):
    found = so.distances(LENS, TOOL, np.eye(4), drawn(rng, 4))
    with pytest.raises(ValueError, match="read-only"):
        found.distance[0] = 1.0
    for same in (copy.deepcopy(found), pickle.loads(pickle.dumps(found))):
        np.testing.assert_array_equal(same.rows, found.rows)
        assert not same.rows.flags.writeable


@pytest.mark.parametrize(
    ("given", "why"),
    [
        ({"poses_b": np.eye(3)}, "shape"),
        ({"poses_b": np.zeros((0, 4, 4))}, "shape"),
        ({"poses_a": along(3), "poses_b": along(4)}, "3 poses and poses_b 4"),
        ({"workers": 0}, "workers = 0"),
        ({"workers": 1.5}, "workers"),
        ({"warm": "yes"}, "warm"),
    ],
)
def test_what_is_refused(given, why):
    asked = {"poses_a": np.eye(4), "poses_b": along(2)} | given
    with pytest.raises((TypeError, ValueError), match=why):
        so.distances(LENS, TOOL, **asked)


def boxed():
    """Poses above a box: face to face, over an edge, apart, and inside at equal depths."""
    poses = np.tile(np.eye(4), (4, 1, 1))
    poses[:, 2, 3] = 3.0
    poses[1:, :3, :3] = Rotation.from_rotvec([0.3, 0.4, 0.5]).as_matrix()
    poses[2, :3, 3] = 3.0, 0.2, 0.1
    poses[3, :3, 3] = 0.0
    return poses


@pytest.mark.parametrize("warm", [False, True])
def test_derivatives_of_rows_are_those_of_single_answers(warm, rng):
    for a, b in PAIRS.values():
        found = so.distances(a, b, np.eye(4), drawn(rng, 30), warm=warm)
        arrays, both = found.derivatives(), found.derivatives(workers=3)
        for k in range(30):
            single = found[k].derivatives()
            assert arrays.smoothness[k] is single.smoothness is both.smoothness[k]
            assert arrays.reasons.get(k, "") == single.reason == both.reasons.get(k, "")
            pairs = zip(single[2:5], arrays[2:5], both[2:5], strict=True)
            for one, row, threaded in [
                *pairs,
                *zip(single[5], arrays[5], both[5], strict=True),
            ]:
                np.testing.assert_array_equal(one, row[k])
                np.testing.assert_array_equal(one, threaded[k])
        np.testing.assert_array_equal(found.gradient, arrays.gradient)
        np.testing.assert_array_equal(found.hessian, arrays.hessian)
        np.testing.assert_array_equal(found.normal_jacobian, arrays.normal_jacobian)
        np.testing.assert_array_equal(found.point_jacobians, arrays.point_jacobians)


def test_one_worker_or_one_row_starts_no_thread(monkeypatch, rng):
    poses = drawn(rng, 3)
    found, one = (so.distances(LENS, TOOL, np.eye(4), x) for x in (poses, poses[:1]))
    several = [found.derivatives(workers=k).hessian.tobytes() for k in (2, 3, 5)]

    def refused(workers):
        raise AssertionError(f"a pool of {workers}")

    monkeypatch.setattr(threads, "ThreadPoolExecutor", refused)
    assert {*several, found.derivatives().hessian.tobytes()} == {several[0]}
    np.testing.assert_array_equal(found.gradient[:1], one.derivatives(workers=4).gradient)
    assert so.distances(LENS, TOOL, np.eye(4), poses[:1], workers=4).distance == one.distance
    with pytest.raises(AssertionError, match="a pool of 1"):  # the caller's thread is the other
        found.derivatives(workers=2)


def test_in_a_half_space_derivatives_take_no_search(rng):
    """It has one normal, so overlapping rows cost what those apart do; a search costs 500 times."""
    ground, took = so.shapes.halfspace(), {}
    for height in (3.0, -3.0):
        poses = drawn(rng, 100)
        poses[:, 2, 3] = height
        found = so.distances(ground, TOOL, np.eye(4), poses)
        assert (np.sign(found.distance) == np.sign(height)).all()
        times = []
        for _ in range(5):
            start = time.perf_counter()
            given = found.derivatives()
            times.append(time.perf_counter() - start)
        assert not given.reasons
        took[height] = min(times)
    assert took[-3.0] <= 20.0 * took[3.0]


def test_rows_without_derivatives_have_flags_and_nan():
    box = so.shapes.box(1, 1, 1)
    found = so.distances(box, box, np.eye(4), boxed())
    flat, single = so.distance(box, box, np.eye(4), boxed()[0]), found.derivatives()
    assert [flag.name for flag in single.smoothness] == [
        "PARTIAL",
        "SMOOTH",
        "SMOOTH",
        "UNDEFINED",
    ]
    assert set(single.reasons) == {0, 3}
    assert flat.derivatives().smoothness is single.smoothness[0]
    for gradient in (single.gradient, found.gradient):
        np.testing.assert_array_equal(gradient[0], flat.gradient)
        np.testing.assert_array_equal(gradient[0, 6:9], [0.0, 0.0, 1.0])
        np.testing.assert_array_equal(np.flatnonzero(np.isnan(gradient[0])), [3, 4, 9, 10])
        assert np.isnan(gradient[3]).all()
    assert np.isnan(single.hessian[[0, 3]]).all()
    assert np.isfinite(single.hessian[[1, 2]]).all()


def test_a_refused_row_has_no_derivatives_and_a_changed_array_changes_none():
    poses = boxed()[:3]
    poses[1, 0, 0] = np.nan
    found = so.distances(BOX, TOOL, np.eye(4), poses)
    before = found.gradient
    poses[2, 0, 3] = 7.0
    np.testing.assert_array_equal(found.gradient, before)
    assert np.isnan(before[1]).all()
    assert np.isfinite(before[[0, 2]]).all()
    assert "no distance" in found.derivatives().reasons[1]
    assert not found.poses[1].flags.writeable
