"""Which pairs count, their margins, and what is refused."""

import itertools

import numpy as np
import pytest

import standoff as so

BALL = so.shapes.sphere(0.5)
NAMES = ("arm", "hand", "shelf", "wall", "box")
BODIES = dict.fromkeys(NAMES, BALL)
EVERY = set(itertools.combinations(NAMES, 2))


def pairs(**rules: object) -> set[tuple[str, str]]:
    return set(so.World(BODIES, **rules).pairs())


def test_all_pairs_count_but_those_of_fixed_bodies() -> None:
    assert pairs() == EVERY
    fixed = {"shelf": np.eye(4), "wall": np.eye(4)}
    assert pairs(fixed=fixed) == EVERY - {("shelf", "wall")}


def test_pairs_by_name_and_by_group() -> None:
    groups = {"robot": ["arm", "hand"], "room": ["shelf", "wall"]}
    assert pairs(ignore=[("hand", "arm")]) == EVERY - {("arm", "hand")}
    assert pairs(parents={"hand": "arm"}) == EVERY - {("arm", "hand")}
    assert pairs(groups=groups, ignore=[("robot", "robot")]) == EVERY - {("arm", "hand")}
    within_room = {("arm", "box"), ("hand", "box")}
    between = {(a, b) for a in groups["robot"] for b in groups["room"]}
    assert pairs(groups=groups, only=[("robot", "room")]) == between
    assert pairs(groups=groups, only=[("robot", "box"), ("room", "robot")]) == between | within_room
    assert pairs(groups=groups, only=[("robot", "room")], ignore=[("arm", "wall")]) == between - {
        ("arm", "wall")
    }
    assert pairs(groups=groups, ignore=[("robot", "shelf")]) == EVERY - {
        ("arm", "shelf"),
        ("hand", "shelf"),
    }


def test_rules_hold_in_the_search(rng: np.random.Generator) -> None:
    names = [f"b{k}" for k in range(30)]
    groups = {"even": names[::2], "third": names[::3]}
    world = so.World(
        dict.fromkeys(names, BALL),
        within=5.0,
        groups=groups,
        ignore=[("even", "third"), ("b1", "b5")],
    )
    poses = np.tile(np.eye(4), (30, 1, 1))
    poses[:, :3, 3] = rng.uniform(-1, 1, (30, 3))
    assert set(world.distances(poses).pairs.names) == set(world.pairs())


def test_margins() -> None:
    world = so.World(BODIES, within=0.1, margins={("arm", "hand"): 0.5, ("arm", "shelf"): 0.2})
    poses = np.tile(np.eye(4), (5, 1, 1))
    poses[:, 0, 3] = 0.0, 1.4, -1.3, 20.0, 40.0
    answer = world.distances(poses)
    assert answer["arm", "hand"].distance == pytest.approx(0.4)
    assert answer["arm", "shelf"].far
    assert [x.names for x in answer.below_margin] == [("arm", "hand")]


@pytest.mark.parametrize(
    ("rules", "told"),
    [
        ({"ignore": [("arm", "hnad")]}, "'hnad'.*'hand'"),
        ({"ignore": [("arm", "arm")]}, "with itself"),
        ({"ignore": ["arm"]}, "pairs of names"),
        ({"groups": {"arm": ["hand"]}}, "is a body"),
        ({"groups": {"robot": []}}, "one body or more"),
        ({"groups": {"robot": ["claw"]}}, "no body 'claw'"),
        ({"only": [("robot", "arm")]}, "no body or group 'robot'"),
        ({"parents": {"hand": "hand"}}, "its own parent"),
        ({"margins": {("arm", "hand"): -1.0}}, "zero or positive"),
        ({"margins": {("arm", "hand"): np.nan}}, "finite"),
        ({"within": 0.0}, "positive"),
        ({"within": np.nan}, "finite"),
        ({"fixed": {"floor": np.eye(4)}}, "'floor'"),
        ({"fixed": {"arm": np.full((4, 4), np.nan)}}, "'arm'"),
        ({"dt": -1.0}, "positive"),
    ],
)
def test_bad_rules(rules: dict[str, object], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        so.World(BODIES, **rules)


def test_bad_bodies() -> None:
    floor = so.shapes.halfspace()
    with pytest.raises(TypeError, match="'a' is 1"):
        so.World({"a": 1})
    with pytest.raises(TypeError, match="at least one"):
        so.World({})
    with pytest.raises(ValueError, match="half-spaces"):
        so.World({"a": floor, "b": floor, "c": BALL})
    so.World({"a": floor, "b": floor, "c": BALL}, fixed={"a": np.eye(4), "b": np.eye(4)})
    with pytest.raises(TypeError, match="not a string"):
        so.World({3: BALL})


@pytest.mark.parametrize(
    ("poses", "told"),
    [
        (np.eye(4), "poses are 1, but the world has 5"),
        (np.tile(np.eye(4), (6, 1, 1)), "poses are 6"),
        (dict.fromkeys(NAMES[:4], np.eye(4)), "none of 'box'"),
        (dict.fromkeys((*NAMES, "bx"), np.eye(4)), "'bx'.*'box'"),
        (np.where(np.arange(5)[:, None, None] == 3, np.nan, np.eye(4)), "The pose of 'wall'"),
        (np.tile(np.diag([2.0, 1.0, 1.0, 1.0]), (5, 1, 1)), "The pose of 'arm'"),
        ("arms", "poses"),
    ],
)
def test_bad_poses(poses: object, told: str) -> None:
    world = so.World(BODIES, within=1.0)
    with pytest.raises(ValueError, match=told):
        world.start(poses)


def test_a_bad_pose_among_a_thousand_is_named() -> None:
    world = so.World({f"b{k}": BALL for k in range(1000)}, within=0.1)
    poses = np.tile(np.eye(4), (1000, 1, 1))
    poses[:, 0, 3] = 2.0 * np.arange(1000)
    state = world.start(poses)
    poses[517, 1, 3] = np.nan
    with pytest.raises(ValueError, match="'b517'"):
        world.step(state, poses)


def test_bad_twists() -> None:
    world = so.World(BODIES, within=1.0)
    poses = np.tile(np.eye(4), (5, 1, 1))
    for twists, told in [
        (np.zeros((4, 6)), "twists are 4"),
        (np.zeros(6), "shape"),
        (np.full((5, 6), np.inf), "'arm'"),
        ("fast", "twists"),
        (dict.fromkeys(NAMES[1:], np.zeros(6)), "none of 'arm'"),
    ]:
        with pytest.raises(ValueError, match=told):
            world.start(poses, twists)


def test_rounded_poses_are_repaired_and_counted() -> None:
    world = so.World(BODIES, within=1.0)
    poses = np.tile(np.eye(4), (5, 1, 1))
    poses[:, 0, 3] = 1.2 * np.arange(5)
    turn = so.Pose.exp((0.3, 0.2, 0.1)).rotation
    poses[2, :3, :3] = turn.astype(np.float32)
    state = world.start(poses)
    assert state.repaired == 1
    assert len(world.answer(state).pairs) == 4


def test_bad_questions() -> None:
    world = so.World(BODIES, ignore=[("arm", "hand")])
    answer = world.distances(np.tile(np.eye(4), (5, 1, 1)))
    with pytest.raises(ValueError, match="no body 'cat'"):
        _ = answer["arm", "cat"]
    with pytest.raises(ValueError, match="does not count"):
        _ = answer["arm", "hand"]
    with pytest.raises(TypeError, match="two names"):
        _ = answer["arm"]
