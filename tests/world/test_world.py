"""Worlds against queries of all their pairs, through motion, jumps and pauses."""

import pickle

import numpy as np
import pytest
from scattered import SHAPES, Motion, bodies_of, check, poses_of, truth_of

import standoff as so
from draws import draws

WITHIN = 0.6
H = 1e-2


@pytest.mark.parametrize("compounds", [0, 4])
def test_no_pair_within_the_horizon_is_missed(rng: np.random.Generator, compounds: int) -> None:
    bodies = bodies_of(rng, 21, compounds)
    floor = {"floor": (np.eye(3), [0.0, 0.0, -2.5])}
    world = so.World(bodies, within=WITHIN, fixed=floor, ignore=[("b0", "b1")])
    motion = Motion(rng, len(world.moving))
    state = world.start(motion.poses)
    near = check(world.answer(state), truth_of(world, motion.poses), WITHIN)
    for frame in range(draws(40)):
        if frame % 9 == 4:
            motion.jump([3, 5, 6])
        elif frame % 9 != 7:  # there all pause
            motion.step(H)
        state, answer = world.step(state, motion.poses, dt=H, workers=1 + frame % 2)
        if frame % 4 == 0:
            near += check(answer, truth_of(world, motion.poses), WITHIN)
    assert near > 50
    assert answer.certified


def test_without_a_horizon_every_pair_is_tracked(rng: np.random.Generator) -> None:
    world = so.World(bodies_of(rng, 8, 1) | {"floor": SHAPES[2]})
    motion = Motion(rng, len(world.moving))
    state = world.start(motion.poses)
    for _ in range(5):
        state, answer = world.step(state, motion.step(H), dt=H)
        check(answer, truth_of(world, motion.poses), np.inf)
    assert len(answer.pairs) == 45


@pytest.mark.parametrize("with_twists", [False, True])
def test_a_pair_in_a_world_is_the_pair(rng: np.random.Generator, with_twists: bool) -> None:
    # not bit for bit: the start is compiled once more, and rounds products and sums in another way
    for a, b in [(0, 5), (1, 3), (2, 0), (4, 1)]:
        pair = SHAPES[a], SHAPES[b]
        world, tracker = so.World({"a": pair[0], "b": pair[1]}), so.Tracker(*pair)
        motion = Motion(rng, 2)
        twists = rng.normal(size=(2, 6)) if with_twists else None
        given = (None, None) if twists is None else twists
        motion.poses[1, :3, 3] = motion.poses[0, :3, 3] + [1.0, 0.5, 0.0]
        state, kept = world.start(motion.poses, twists), tracker.start(*motion.poses, *given)
        for _ in range(20):
            poses = motion.step(1e-3)
            state, answer = world.step(state, poses, twists)
            kept, alone = tracker.step(kept, *poses, *given)
            found = answer["a", "b"]
            assert found.row == pytest.approx(alone.row, rel=0.0, abs=1e-13, nan_ok=True)
            assert (found.feature_a, found.status) == (alone.feature_a, alone.status)


def test_any_number_of_workers_gives_the_same_bytes(rng: np.random.Generator) -> None:
    bodies = bodies_of(rng, 20, 3) | {"floor": SHAPES[2]}
    found = []
    for workers in (1, 2, 3):
        world = so.World(bodies, within=1.0)
        motion = Motion(np.random.default_rng(5), len(bodies))
        state = world.start(motion.poses)
        for _ in range(8):
            state, answer = world.step(state, motion.step(H), workers=workers)
        found.append((answer.pairs.distance, answer.pairs.point_a, answer.pairs.lower_bound))
    for other in found[1:]:
        for one, same in zip(found[0], other, strict=True):
            assert np.array_equal(one, same)


def test_bodies_at_rest_keep_their_answers(rng: np.random.Generator) -> None:
    world = so.World(bodies_of(rng, 12, 2) | {"floor": SHAPES[2]}, within=1.0)
    poses = poses_of(rng, len(world.moving), 1.5)
    before = world.start(poses)
    state, answer = world.step(before, poses.copy(), dt=0.5)
    assert state.ints is before.ints
    assert answer.time == 0.5
    assert answer.counts.tracked == answer.counts.started == 0
    poses = poses.copy()
    poses[0, 0, 3] += 1e-3
    state, answer = world.step(state, poses)
    counts = answer.counts
    assert counts.resting > 0
    assert counts.tracked + counts.started < counts.open
    check(answer, truth_of(world, poses), 1.0)


def test_all_that_states_share_is_locked(rng: np.random.Generator) -> None:
    world = so.World(bodies_of(rng, 10, 1) | {"floor": SHAPES[2]}, within=1.0)
    motion = Motion(rng, len(world.moving))
    state = world.start(motion.poses)
    for k in range(6):
        state, _ = world.step(state, motion.jump([1, 2]) if k % 2 else motion.step(H))
        for each in (state, pickle.loads(pickle.dumps(state))):
            tree = each.tree
            arrays = [each.poses, each.placed, each.ints, each.known, each.near, *each.pages]
            for array in (*arrays, tree.boxes, tree.nodes, tree.order, tree.leaf):
                assert not array.flags.writeable
    for array in (*world.model.search.rules, *world.model.search.pieces):
        assert not array.flags.writeable


def test_nothing_is_changed_by_an_error(rng: np.random.Generator) -> None:
    world = so.World(bodies_of(rng, 10, 1) | {"floor": SHAPES[2]}, within=1.0)
    motion = Motion(rng, len(world.moving))
    state = world.start(motion.poses)
    poses = motion.step(H)
    kept, given, true = pickle.dumps(state), poses.copy(), world.step(state, poses)[1]
    bad = poses.copy()
    bad[3, 0, 3] = np.nan
    other = so.World(dict(world.bodies), within=1.0)
    for attempt, told in [
        (lambda: world.step(state, bad), "'b3'"),
        (lambda: world.step(state, poses[:-1]), "poses are 11"),
        (lambda: world.step(state, dict(zip(world.moving[1:], poses[1:], strict=True))), "'b0'"),
        (lambda: other.step(state, poses), "another world"),
        (lambda: world.step(state, poses, np.full((12, 6), np.nan)), "'b0'"),
        (lambda: world.step(state, poses, np.full((12, 6), 1e200)), "'b0'.*too large"),
        (lambda: world.step(state, poses, dt=0.0), "dt"),
        (lambda: world.run(state, [poses, poses], [np.zeros((12, 6))]), "twists are of 1 frames"),
    ]:
        with pytest.raises(ValueError, match=told):
            attempt()
    assert pickle.dumps(state) == kept
    assert np.array_equal(poses, given)
    again = world.step(state, poses)[1]
    assert np.array_equal(again.pairs.distance, true.pairs.distance)


def test_a_state_is_a_value(rng: np.random.Generator) -> None:
    world = so.World(bodies_of(rng, 10, 1) | {"floor": SHAPES[2]}, within=1.0)
    motion = Motion(rng, len(world.moving))
    first = motion.poses
    state = world.start(first)
    shown = world.answer(state).pairs.distance.copy()
    after = [world.step(state, motion.step(H))[1].pairs.distance for _ in range(3)]
    assert np.array_equal(world.answer(state).pairs.distance, shown)
    again = world.step(state, first)[1].pairs.distance
    assert np.allclose(again, shown, atol=1e-9)
    assert len(after[0])
    with pytest.raises(ValueError, match="another world"):
        so.World(dict(world.bodies), within=1.0).step(state, first)
    with pytest.raises(TypeError, match="not a WorldState"):
        world.step(None, first)
    copy, kept = pickle.loads(pickle.dumps((world, state)))
    assert np.array_equal(copy.step(kept, first)[1].pairs.distance, again)
    first[0, 0, 3] = 7.0  # the caller's own array: the state has a copy
    assert state.poses[0, 0, 3] != 7.0


def test_many_frames_at_once(rng: np.random.Generator) -> None:
    world = so.World(bodies_of(rng, 6, 0) | {"floor": SHAPES[2]}, within=1.0)
    motion = Motion(rng, len(world.moving))
    state = world.start(motion.poses)
    path = np.array([motion.step(H) for _ in range(6)])
    last, answers = world.run(state, path)
    for poses in path:
        state, answer = world.step(state, poses)
    assert np.array_equal(answers[-1].pairs.distance, answer.pairs.distance)
    assert last.time == state.time == pytest.approx(6e-3)
    path[4, 2] = np.nan
    with pytest.raises(ValueError, match=r"Frame 4: The pose of 'b2'"):
        world.run(state, path)


def test_the_clearance_holds_for_far_pairs_too() -> None:
    ball = so.shapes.sphere(0.5)
    world = so.World({"a": ball, "b": ball, "c": ball}, within=2.0)
    poses = np.tile(np.eye(4), (3, 1, 1))
    poses[:, 0, 3] = 0.0, 10.0, 30.0
    answer = world.distances(poses)
    assert answer.closest is None
    assert len(answer.pairs) == 0
    assert answer.clearance == 2.0
    far = answer["c", "b"]
    assert far.status is so.Status.FAR
    assert far.certified
    assert far.far
    assert 2.0 < far.lower_bound <= 19.0
    assert far.distance == far.upper_bound == np.inf
    assert far.names == ("c", "b")
    assert "FAR" in repr(far)
    assert far.as_dict()["status"] == "FAR"
    with pytest.raises(ValueError, match="beyond the horizon"):
        _ = far.gradient
    poses[:, 0, 3] = 0.0, 2.5, 30.0
    answer = world.distances(poses)
    assert answer.clearance == pytest.approx(1.5, abs=1e-12)
    assert answer.closest.names == ("a", "b")


def test_rates_are_those_of_their_frame_after_far_ones() -> None:
    """Of a pair that was beyond the horizon, and of one that comes back from there."""
    a, b = SHAPES[0], SHAPES[5]
    world, tracker = so.World({"a": a, "b": b}, within=0.5), so.Tracker(a, b, 1e-2)
    path = np.concatenate([np.linspace(1.2, 4.0, 30), np.linspace(4.0, 1.2, 30)])
    poses = np.tile(np.eye(4), (2, 1, 1))
    poses[1, 0, 3] = path[0]
    state, alone = world.start(poses), tracker.start(*poses)
    near = before = 0
    for k, x in enumerate(path):
        poses[1, 0, 3] = x
        twists = np.zeros((2, 6))
        twists[1] = np.sin(k), 0.3, 0.0, 0.0, 0.5 * k, 1.0
        given = twists if k % 3 else None  # in some frames none are known
        state, answer = world.step(state, poses, given, dt=1e-2)
        alone, true = tracker.step(alone, *poses, *([None, None] if given is None else given))
        found = answer["a", "b"]
        assert found.time == pytest.approx(true.time)
        if found.far:
            assert np.isnan(found.rate)
            assert np.isnan(found.velocity_a).all()
            assert np.isnan(found.velocity_b).all()
            for name in ("gradient", "hessian", "unique"):
                with pytest.raises(ValueError, match="beyond the horizon"):
                    getattr(found, name)
            with pytest.raises(ValueError, match="beyond the horizon"):
                found.derivatives()
            before = near
        else:
            near += 1
            for name in ("rate", "velocity_a", "velocity_b"):
                wanted = getattr(true, name)
                assert getattr(found, name) == pytest.approx(wanted, abs=1e-5, nan_ok=True)
            assert answer.pairs.rate == pytest.approx([true.rate], abs=1e-5, nan_ok=True)
            assert np.isnan(found.rate) == (given is None)
    assert 0 < before < near


def test_the_paper_law_begins_anew_after_far_frames() -> None:
    """One long step over the frames that were left out would be none of the law."""
    a, b = SHAPES[0], SHAPES[5]
    world = so.World({"a": a, "b": b}, within=0.5, law=so.PaperLaw())
    poses = np.tile(np.eye(4), (2, 1, 1))
    poses[1, :3, 3] = 0.9, 0.1, 0.0
    state = world.start(poses)
    there, far = poses.copy(), 0
    while far < 3:  # beyond the horizon, but near enough to keep the tracker's state
        poses[1, 0, 3] += 0.02
        state, answer = world.step(state, poses)
        far += answer["a", "b"].far
    assert answer.counts.open == 1
    there[1, :3, :3] = so.Pose.exp((0.5, 1.0, -0.7)).rotation
    state, answer = world.step(state, there)
    true = so.distance(a, b, *there)
    assert answer["a", "b"].certified
    assert answer["a", "b"].distance == pytest.approx(true.distance, abs=1e-9)
    assert (answer.counts.started, answer.counts.tracked) == (1, 0)
    there[1, 0, 3] += 1e-5
    assert world.step(state, there)[1].counts.tracked == 1
    with pytest.raises(ValueError, match=r"dt|stable"):
        world.step(state, there, dt=1.0)


def test_both_orders_of_a_pair(rng: np.random.Generator) -> None:
    world = so.World({"a": SHAPES[0], "b": SHAPES[5]})
    poses = poses_of(rng, 2, 0.8)
    twists = rng.normal(size=(2, 6))
    answer = world.answer(world.start(poses, twists))
    ab, ba = answer["a", "b"], answer["b", "a"]
    turned = so.Tracker(SHAPES[5], SHAPES[0]).start(*poses[::-1], *twists[::-1]).proximity
    for name in ("distance", "lower_bound", "normal", "point_a", "point_b", "velocity_a", "rate"):
        assert getattr(ba, name) == pytest.approx(getattr(turned, name), abs=1e-9)
    assert np.array_equal(ab.point_a, ba.point_b)
    assert np.array_equal(ab.normal, -ba.normal)
    assert (ab.feature_a, ab.parameters_a) == (ba.feature_b, ba.parameters_b)
    assert np.array_equal(ba.poses[0], ab.poses[1])
    assert ba.gradient == pytest.approx(turned.gradient, abs=1e-9)


def test_planar_worlds() -> None:
    disc = so.shapes.planar_loop([so.geometry.ConicArc((0, 0), (0.5, 0), (0, 0.5))])
    world = so.World({"a": disc, "b": disc, "c": disc}, within=1.0)
    poses = np.tile(np.eye(4), (3, 1, 1))
    poses[:, 0, 3] = 0.0, 1.7, 9.0
    answer = world.distances(poses)
    assert answer.closest.distance == pytest.approx(0.7)
    assert len(answer.pairs) == 1
    poses[2, 2, 3] = 0.1
    with pytest.raises(ValueError, match="'c'"):
        world.distances(poses)
    with pytest.raises(ValueError, match="'c'"):
        so.World({"a": disc, "c": disc}, fixed={"c": (np.eye(3), [3.0, 0.0, 0.1])})
    with pytest.raises(ValueError, match="planar"):
        so.World({"a": disc, "ball": SHAPES[0]})
