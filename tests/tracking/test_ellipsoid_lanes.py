"""Cold rows and frames of ellipsoids, which are answered in lanes: beside pairs that are exact by
construction, and beside the general code."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import standoff as so
from standoff.kernels.body import layout as L
from standoff.kernels.entries import smooth
from standoff.kernels.lanes.frames import may_lane
from standoff.kernels.lanes.layout import ROWS
from standoff.kernels.pair.events import CORRECTIONS, EVALUATIONS, GENERAL_FRAMES
from standoff.kernels.state.arrays import (
    BLOCK_DONE,
    BLOCK_STATE,
    DISTANCE,
    LOWER_BOUND,
    N_OUT,
    N_STATE,
    OUT_COUNTS,
    OUT_MODE,
    OUT_Q,
    STATUS,
    UPPER_BOUND,
)
from standoff.kernels.values import Pair, Place
from standoff.tracking import Status, reached
from standoff.tracking.many_states import TrackerStates

REST = np.eye(4)
TOOL, PART = so.shapes.ellipsoid(0.15, 0.3, 0.2), so.shapes.ellipsoid(0.5, 0.8, 0.9)
BOX = so.shapes.box(1.0, 0.8, 0.6)
AXES = st.tuples(*[st.floats(0.02, 1.0)] * 3)


def turned(rng, n):
    poses = np.tile(np.eye(4), (n, 1, 1))
    poses[:, :3, :3] = Rotation.random(n, random_state=rng).as_matrix()
    return poses


def support(axes, R, n):
    """Points (k, 3) of turned ellipsoids farthest along unit vectors (k, 3), from their centres."""
    own = np.einsum("kji,kj->ki", R, n) * axes
    return np.einsum("kij,kj->ki", R, own * axes / np.linalg.norm(own, axis=1, keepdims=True))


def placed(axes_a, axes_b, gaps, rng):
    """(poses of A, poses of B, normals): rows whose distances are the gaps (k,)."""
    k = len(gaps)
    poses_a, poses_b, n = turned(rng, k), turned(rng, k), rng.normal(size=(k, 3))
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    poses_a[:, :3, 3] = rng.uniform(-1.0, 1.0, size=(k, 3))
    x = poses_a[:, :3, 3] + support(axes_a, poses_a[:, :3, :3], n)
    arm = support(axes_b, poses_b[:, :3, :3], -n)
    poses_b[:, :3, 3] = x + gaps[:, None] * n - arm
    return poses_a, poses_b, n


def in_lanes(found):
    """Which rows (n,) were answered in lanes: apart, with one evaluation more than steps."""
    counts = found.rows[:, OUT_COUNTS:]
    apart = found.status == Status.CONVERGED
    return apart & (counts[:, EVALUATIONS] == counts[:, CORRECTIONS] + 1.0)


@settings(max_examples=25)
@given(AXES, AXES, st.integers(0, 2**32 - 1), st.floats(-4.0, 1.0))
def test_gaps_that_are_exact_by_construction(axes_a, axes_b, seed, decade):
    rng = np.random.default_rng(seed)
    a, b = so.shapes.ellipsoid(*axes_a), so.shapes.ellipsoid(*axes_b)
    gaps = 10.0**decade * rng.uniform(0.5, 1.0, size=2 * ROWS + 5)
    poses_a, poses_b, n = placed(np.array(axes_a), np.array(axes_b), gaps, rng)
    found = so.distances(a, b, poses_a, poses_b)
    roundoff = 1e-14 * (a.size + b.size + gaps + 2.0)
    assert (abs(found.distance - gaps) <= roundoff).all()
    assert (found.lower_bound <= gaps + roundoff).all()
    assert (found.lower_bound <= found.distance).all()
    assert (found.status == Status.CONVERGED).all()
    # the normal turns by the roundoff of the points over the least radius of curvature and gap
    assert (np.linalg.norm(found.normal - n, axis=1) <= 1e-11 / gaps).all()
    assert in_lanes(found).mean() > 0.9


def test_a_sheared_ellipsoid_is_one_with_other_axes(rng):
    """Its map takes the ball to what its singular values and left vectors make of it."""
    axes, shear = np.array([0.5, 0.8, 0.9]), np.eye(4)
    shear[:3, :3] += rng.uniform(-0.4, 0.4, size=(3, 3))
    left, values, _ = np.linalg.svd(shear[:3, :3] * axes)
    left *= np.sign(np.linalg.det(left))
    turn = np.eye(4)
    turn[:3, :3] = left
    poses_a, poses_b = turned(rng, 100), turned(rng, 100)
    poses_a[:, :3, 3], poses_b[:, :3, 3] = rng.uniform(-1.5, 1.5, size=(2, 100, 3))
    found = so.distances(so.shapes.ellipsoid(*axes).transformed(shear), TOOL, poses_a, poses_b)
    straight = so.distances(so.shapes.ellipsoid(*values), TOOL, poses_a @ turn, poses_b)
    apart = found.status == Status.CONVERGED
    assert in_lanes(found)[apart].mean() > 0.9
    assert (abs(found.distance - straight.distance)[apart] <= 1e-14).all()
    assert (found.lower_bound <= straight.upper_bound + 1e-14).all()


@pytest.mark.parametrize("rounding", [0.0, 0.1])
def test_lanes_answer_as_the_general_code(rng, rounding):
    a = so.shapes.ellipsoid(0.5, 0.8, 0.9, rounding=rounding)
    poses_a, poses_b = turned(rng, 400), turned(rng, 400)
    poses_a[:, :3, 3], poses_b[:, :3, 3] = rng.uniform(-1.5, 1.5, size=(2, 400, 3))
    found = so.distances(a, TOOL, poses_a, poses_b)
    # a horizon that nothing is beyond: it takes the general code
    general = so.distances(a, TOOL, poses_a, poses_b, within=1e6)
    lanes = in_lanes(found)
    assert not in_lanes(general).any()
    assert (lanes == (general.status == Status.CONVERGED)).mean() > 0.99
    assert 0.5 < lanes.mean() < 0.99
    assert (found.status == general.status).all()
    size = a.size + TOOL.size
    for name in ("distance", "lower_bound", "upper_bound"):
        one, other = getattr(found, name), getattr(general, name)
        np.testing.assert_allclose(one[lanes], other[lanes], rtol=0.0, atol=1e-13 * size)
    for name in ("point_a", "point_b", "normal"):
        one, other = getattr(found, name), getattr(general, name)
        np.testing.assert_allclose(one[lanes], other[lanes], rtol=0.0, atol=1e-9 * size)
    np.testing.assert_array_equal(found.rows[~lanes], general.rows[~lanes])


def test_a_row_does_not_depend_on_its_neighbours(rng):
    poses = turned(rng, 3 * ROWS + 7)
    poses[:, :3, 3] = rng.uniform(-2.0, 2.0, size=(len(poses), 3))
    found = so.distances(PART, TOOL, REST, poses)
    order = rng.permutation(len(poses))
    again = so.distances(PART, TOOL, REST, poses[order], workers=3)
    assert found.rows[order].tobytes() == again.rows.tobytes()
    for k in (0, ROWS - 1, ROWS, len(poses) - 1):
        alone = so.distances(PART, TOOL, REST, poses[k])
        assert alone.rows[0].tobytes() == found.rows[k].tobytes()


def test_refused_rows_among_them(rng):
    poses = turned(rng, 2 * ROWS)
    poses[:, :3, 3] = [2.0, 0.0, 0.0]
    sound = so.distances(PART, TOOL, REST, poses)
    poses[5, 0, 0], poses[ROWS + 1, :3, 0] = np.nan, -poses[ROWS + 1, :3, 0]
    found = so.distances(PART, TOOL, REST, poses)
    assert sorted(found.errors) == [5, ROWS + 1]
    assert np.isnan(found.distance[[5, ROWS + 1]]).all()
    good = np.setdiff1d(np.arange(2 * ROWS), [5, ROWS + 1])
    np.testing.assert_array_equal(found.distance[good], sound.distance[good])


def test_answers_of_single_rows_are_whole(rng):
    poses = turned(rng, 4)
    poses[:, :3, 3] = [1.5, 0.4, 0.1]
    found = so.distances(PART, TOOL, REST, poses)
    single = [so.distance(PART, TOOL, REST, pose) for pose in poses]
    for k, answer in enumerate(single):
        row = found[k]
        assert (row.feature_a, row.feature_b) == (answer.feature_a, answer.feature_b)
        assert row.residual <= 1e-14
        np.testing.assert_allclose(row.gradient, answer.gradient, atol=1e-9)


def test_a_sphere_of_patches_inside_another_is_left_to_the_general_code():
    big, small = so.shapes.ellipsoid(1.0, 1.0, 1.0), so.shapes.ellipsoid(0.2, 0.2, 0.2)
    poses = np.tile(np.eye(4), (3, 1, 1))
    poses[1, 0, 3], poses[2, 0, 3] = 0.5, 1.25
    found = so.distances(big, small, REST, poses)
    np.testing.assert_allclose(found.distance, [-1.2, -0.7, 0.05], atol=1e-12)
    assert in_lanes(found).tolist() == [False, False, True]


# Frames of many states, each of its own bodies and from its own state.


def approached(axes_a, axes_b, gaps, rng, way=2e-3):
    """Twice what `placed` gives, at gaps (2, k): the second a small motion after the first."""
    k = gaps.shape[1]
    poses_a, poses_b, n = placed(axes_a, axes_b, gaps[0], rng)
    later_a, later_b = poses_a.copy(), poses_b.copy()
    for later in (later_a, later_b):
        later[:, :3, :3] = (
            Rotation.from_rotvec(way * rng.normal(size=(k, 3))).as_matrix() @ later[:, :3, :3]
        )
    m = n + way * rng.normal(size=(k, 3))
    m /= np.linalg.norm(m, axis=1, keepdims=True)
    later_a[:, :3, 3] += way * rng.normal(size=(k, 3))
    x = later_a[:, :3, 3] + support(axes_a, later_a[:, :3, :3], m)
    arm = support(axes_b, later_b[:, :3, :3], -m)
    later_b[:, :3, 3] = x + gaps[1][:, None] * m - arm
    return (poses_a, poses_b), (later_a, later_b)


def by_lanes(answers):
    """Which frames can have been made in lanes: certified, and by no general frame."""
    counts = answers.rows[:, OUT_COUNTS:]
    return (answers.status == Status.CONVERGED) & (counts[:, GENERAL_FRAMES] == 0.0)


@settings(max_examples=15)
@given(AXES, AXES, st.integers(0, 2**32 - 1), st.floats(-1.0, 1.0))
def test_frames_at_gaps_that_are_exact_by_construction(axes_a, axes_b, seed, decade):
    rng = np.random.default_rng(seed)
    a, b = so.shapes.ellipsoid(*axes_a), so.shapes.ellipsoid(*axes_b)
    gaps = 10.0**decade * rng.uniform(0.5, 1.0, size=ROWS + 5) * np.array([[1.0], [1.01]])
    first, second = approached(np.array(axes_a), np.array(axes_b), gaps, rng)
    tracker = so.Tracker(a, b)
    _, answers = tracker.step_many(tracker.start_many(*first), *second)
    roundoff = 1e-14 * (a.size + b.size + gaps[1] + 2.0)
    assert (answers.status == Status.CONVERGED).all()
    assert (abs(answers.distance - gaps[1]) <= roundoff).all()
    assert (answers.lower_bound <= gaps[1] + roundoff).all()


def step_by_step(tracker, states, poses_a, poses_b, **given):
    return [
        tracker.step(states[k], poses_a[k], poses_b[k], **{x: y[k] for x, y in given.items()})
        for k in range(len(states))
    ]


@pytest.mark.parametrize(
    ("rounding", "twists", "way", "deadline"),
    [
        (0.0, False, 2e-3, None),
        (0.05, True, 2e-3, None),
        (0.05, False, 1e-4, None),
        (0.0, True, 0.02, None),
        (0.05, False, 0.02, None),
        (0.0, True, 0.0, None),
        (0.0, False, 2e-3, 2),
    ],
)
def test_frames_in_lanes_are_those_of_step(rng, rounding, twists, way, deadline):
    """To 1e-13 where they are in lanes, elsewhere to the last bit: answers, counts and states."""
    a = so.shapes.ellipsoid(0.5, 0.8, 0.9, rounding=rounding)
    law, n = so.PredictorCorrector(deadline=deadline), 8 * ROWS + 11
    tracker = so.Tracker(a, TOOL, law=law)
    gaps = rng.uniform(-0.02, 1.5, size=n) + rng.uniform(-way, way, size=(2, n))
    axes = np.array([0.5, 0.8, 0.9]), np.array([0.15, 0.3, 0.2])
    first, second = approached(*axes, gaps, rng, way)
    states = tracker.start_many(*first)
    given = {"twist_a": rng.normal(size=(n, 6)), "twist_b": rng.normal(size=(n, 6))}
    both = {"twists_a": given["twist_a"], "twists_b": given["twist_b"]} if twists else {}
    found, answers = tracker.step_many(states, *second, **both)
    alone = step_by_step(tracker, states, *second, **(given if twists else {}))
    rows = np.array([answer._out[:N_OUT] for _, answer in alone])
    kept = np.array([state.warm_start[:N_STATE] for state, _ in alone])
    lanes = by_lanes(answers)
    assert (0.6 if way < 0.02 and deadline is None else 0.1) < lanes.mean() < 1.0
    size = a.size + TOOL.size
    ours = found.blocks[:, BLOCK_STATE : BLOCK_STATE + N_STATE]
    for one, other in ((answers.rows, rows), (ours, kept)):
        np.testing.assert_array_equal(one[~lanes], other[~lanes])
        np.testing.assert_allclose(one[lanes], other[lanes], rtol=1e-9, atol=1e-9)
    bounds = [DISTANCE, LOWER_BOUND, UPPER_BOUND]
    np.testing.assert_allclose(answers.rows[:, bounds], rows[:, bounds], rtol=0, atol=1e-13 * size)
    exact = [*range(OUT_MODE, OUT_Q), STATUS, *range(OUT_COUNTS, N_OUT)]
    np.testing.assert_array_equal(answers.rows[:, exact], rows[:, exact])


def test_a_frame_does_not_depend_on_its_neighbours(rng):
    tracker, n = so.Tracker(PART, TOOL), 2 * ROWS + 9
    gaps = rng.uniform(-0.02, 1.5, size=n) + rng.uniform(-2e-3, 2e-3, size=(2, n))
    first, second = approached(np.array([0.5, 0.8, 0.9]), np.array([0.15, 0.3, 0.2]), gaps, rng)
    states = tracker.start_many(*first)
    found, _ = tracker.step_many(states, *second)
    order = rng.permutation(n)
    shuffled = TrackerStates.of([states[k] for k in order])
    again, _ = tracker.step_many(shuffled, *(x[order] for x in second), workers=3)
    assert found.blocks[order][:, :BLOCK_DONE].tobytes() == again.blocks[:, :BLOCK_DONE].tobytes()
    for k in (0, ROWS, n - 1):
        one, _ = tracker.step_many(TrackerStates.of([states[k]]), *(x[k] for x in second))
        assert one.blocks[0, :BLOCK_DONE].tobytes() == found.blocks[k, :BLOCK_DONE].tobytes()


def test_other_frames_among_them(rng):
    """Of a lens, whose rim is an edge: what is in lanes is proven beside `step`."""
    lens, n = so.shapes.lens(radius=1.0, offset=0.45), 150
    tracker, poses = so.Tracker(lens, TOOL), turned(rng, n)
    poses[:, :3, 3] = rng.normal(size=(n, 3))
    poses[:, :3, 3] *= 1.6 / np.linalg.norm(poses[:, :3, 3], axis=1, keepdims=True)
    states, later = tracker.start_many(REST, poses), poses.copy()
    later[:, :3, 3] += 5e-3 * rng.normal(size=(n, 3))
    _, answers = tracker.step_many(states, REST, later)
    rows = np.array([tracker.step(states[k], REST, later[k])[1]._out[:N_OUT] for k in range(n)])
    lanes = by_lanes(answers) & (answers.rows[:, OUT_MODE] < lens.ints[L.N_FACES])
    assert 0.3 < lanes.mean() < 0.9
    np.testing.assert_array_equal(answers.rows[~lanes], rows[~lanes])
    bounds = [DISTANCE, LOWER_BOUND, UPPER_BOUND]
    np.testing.assert_allclose(answers.rows[:, bounds], rows[:, bounds], rtol=0, atol=3e-13)


def test_a_world_of_different_ellipsoids(rng):
    """Each pair of a frame has bodies of its own; it says what their tracker would."""
    n, side = 64, 4
    axes = rng.uniform(0.15, 0.5, size=(n, 3))
    bodies = {f"b{k}": so.shapes.ellipsoid(*axes[k]) for k in range(n)}
    poses = turned(rng, n)
    poses[:, :3, 3] = np.stack(np.meshgrid(*[np.arange(side)] * 3), -1).reshape(-1, 3)
    world = so.World(bodies, within=0.3, dt=1e-3)
    later = poses.copy()
    later[:, :3, 3] += 0.01 * rng.normal(size=(n, 3))
    begun = world.start(poses)
    found = [world.step(begun, later, workers=k)[1].pairs for k in (1, 3)]
    assert found[0].distance.tobytes() == found[1].distance.tobytes()
    pairs, told = found[0], 0
    for k, (i, j) in enumerate(pairs.bodies.tolist()):
        tracker = so.Tracker(bodies[f"b{i}"], bodies[f"b{j}"], dt=1e-3)
        _, one = tracker.step(tracker.start(poses[i], poses[j]), later[i], later[j])
        assert pairs.status[k] == one.status
        assert abs(pairs.distance[k] - one.distance) <= 1e-13
        assert abs(pairs.lower_bound[k] - one.lower_bound) <= 1e-13
        told += one.status is Status.CONVERGED
    assert told > 30


def test_what_is_not_proven_is_left_to_the_general_frame(rng):
    """A tolerance that no bound meets: there is nothing that lanes may say."""
    n, law = ROWS + 3, so.PredictorCorrector(tolerance=1e-18)
    tracker = so.Tracker(PART, TOOL, law=law)
    proven = so.Tracker(PART, TOOL)  # states that are
    gaps = rng.uniform(0.2, 1.0, size=n) + rng.uniform(-2e-3, 2e-3, size=(2, n))
    first, second = approached(np.array([0.5, 0.8, 0.9]), np.array([0.15, 0.3, 0.2]), gaps, rng)
    states = proven.start_many(*first)
    _, answers = tracker.step_many(states, *second)
    assert (answers.rows[:, OUT_COUNTS + GENERAL_FRAMES] == 1.0).all()
    for k in range(n):
        _, one = tracker.step(states[k], second[0][k], second[1][k])
        np.testing.assert_array_equal(answers.rows[k], one._out[:N_OUT])


def test_the_lanes_make_frames_themselves(rng, monkeypatch):
    """With a frame of other kinds behind them, which makes none: what they leave is general."""
    monkeypatch.setattr(reached, "smooth_frame_of", lambda a, b, specialise: smooth.nurbs_2)
    axes, n = np.array([[0.6, 0.8, 0.9], [0.2, 0.3, 0.2]]), 4 * ROWS + 5
    law = so.PredictorCorrector()  # of its own: what is made of the default one is kept
    tracker = so.Tracker(*(so.shapes.ellipsoid(*x) for x in axes), law=law)
    gaps = rng.uniform(0.2, 1.5, size=n) + rng.uniform(-1e-3, 1e-3, size=(2, n))
    first, second = approached(*axes, gaps, rng)
    states = tracker.start_many(*first)
    _, answers = tracker.step_many(states, *second)
    _, one = tracker.step(states[0], second[0][0], second[1][0])
    assert one._out[OUT_COUNTS + GENERAL_FRAMES] == 1.0
    assert by_lanes(answers).mean() > 0.95


def test_poses_that_are_none_are_refused_in_lanes_too(rng):
    tracker, n = so.Tracker(PART, TOOL), ROWS + 3
    poses = turned(rng, n)
    poses[:, :3, 3] = [1.6, 0.2, 0.1]
    states = tracker.start_many(REST, poses)
    for row, wrong in ((3, 1.5), (n - 1, -1.0)):  # stretched, mirrored
        bad = poses.copy()
        bad[row, :3, :3] *= wrong
        with pytest.raises(ValueError, match=f"Row {row}: "):
            tracker.step_many(states, REST, bad)
    rounded = poses.astype(np.float32).astype(float)
    _, answers = tracker.step_many(states, REST, rounded)
    assert (answers.repaired == 1).all()


def test_frames_beyond_a_horizon(rng):
    """They are bounds alone, with lanes as without."""
    law, n = so.PredictorCorrector(within=0.5), ROWS + 3
    tracker = so.Tracker(PART, TOOL, law=law)
    gaps = rng.uniform(0.2, 3.0, size=n) + rng.uniform(-2e-3, 2e-3, size=(2, n))
    first, second = approached(np.array([0.5, 0.8, 0.9]), np.array([0.15, 0.3, 0.2]), gaps, rng)
    states = tracker.start_many(*first)
    _, answers = tracker.step_many(states, *second)
    assert 0.5 < np.mean(answers.status == Status.FAR) < 1.0
    for k in range(n):
        _, one = tracker.step(states[k], second[0][k], second[1][k])
        np.testing.assert_array_equal(answers.rows[k], one._out[:N_OUT])


@pytest.mark.parametrize(("body", "chart", "fits"), [(PART, 0, True), (BOX, 0, False)])
def test_lanes_are_for_patches_of_ellipsoids(body, chart, fits):
    for a, b in ((body, TOOL), (TOOL, body)):
        pair = Pair(a.ints, a.reals, b.ints, b.reals)
        place = Place(0, chart, 0, chart, 0.1, 0.1, 0.1, 0.1)
        assert may_lane(pair, place) is fits
