"""Which pairs count, their margins, and what is refused."""

import itertools
import time

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


def test_margins_by_group_are_those_by_name() -> None:
    groups = {"robot": ["arm", "hand", "box"], "room": ["shelf", "wall", "box"]}
    by_group = {("robot", "room"): 0.3, ("arm", "room"): 0.5, ("hand", "wall"): 0.2}
    by_name = {}
    for (a, b), margin in by_group.items():
        for x, y in itertools.product(groups.get(a, [a]), groups.get(b, [b])):
            if x != y:
                key = tuple(sorted((x, y), key=NAMES.index))
                by_name[key] = max(margin, by_name.get(key, 0.0))
    worlds = [
        so.World(BODIES, within=0.1, groups=groups, margins=margins)
        for margins in (by_group, by_name)
    ]
    for a, b in EVERY:
        wanted = by_name.get((a, b), 0.0)
        assert [world.margin(a, b) for world in worlds] == [wanted] * 2
        assert worlds[0].margin(b, a) == wanted
    poses = np.tile(np.eye(4), (5, 1, 1))
    poses[:, 0, 3] = 0.0, 1.25, 2.45, 3.7, 4.95
    for world in worlds:  # a pair without a margin has the horizon, and 0.25 is beyond it
        answer = world.distances(poses)
        assert [x.names for x in answer.below_margin] == [("hand", "shelf"), ("wall", "box")]
        assert answer.pairs.names == [("hand", "shelf"), ("wall", "box")]


def test_rules_of_large_groups_take_no_table_of_their_pairs() -> None:
    """1,000 bodies against 1,000: half a million pairs on each side, and one number."""
    names = [f"b{k}" for k in range(2000)]
    groups = {"left": names[:1000], "right": names[1000:], "all": names}
    began = time.perf_counter()
    world = so.World(
        dict.fromkeys(names, BALL),
        within=0.1,
        groups=groups,
        margins={("left", "right"): 0.2, ("all", "all"): 0.15, ("b0", "b1"): 0.4},
        only=[("left", "right"), ("left", "left")],
    )
    took = time.perf_counter() - began
    rules = world.model.search.rules
    assert len(rules.margin_pairs) == 1
    assert rules.meets.size <= 16
    assert world.margin("b3", "b1500") == 0.2
    assert world.margin("b3", "b4") == 0.15
    assert world.margin("b1", "b0") == 0.4
    assert world.model.search.reach == 0.4
    assert sum(1 for _ in world.pairs()) == 1000 * 1000 + 1000 * 999 // 2
    assert took < 60.0


def test_the_clearance_is_at_most_the_greatest_horizon() -> None:
    """That of a pair with a margin: nothing is known farther out."""
    poses = np.tile(np.eye(4), (5, 1, 1))
    poses[:, 0, 3] = 50.0 * np.arange(5)
    for margins, most in [({}, 0.1), ({("arm", "hand"): 0.5}, 0.5), ({("arm", "hand"): 0.05}, 0.1)]:
        world = so.World(BODIES, within=0.1, margins=margins)
        assert world.distances(poses).clearance == most
    poses[1, 0, 3] = 1.3  # arm and hand, 0.3 apart
    world = so.World(BODIES, within=0.1, margins={("arm", "hand"): 0.5})
    assert world.distances(poses).clearance == pytest.approx(0.3)
    poses[3, 0, 3] = poses[2, 0, 3] + 1.2  # beyond their horizon, and only that is proven
    answer = world.distances(poses)
    assert answer["shelf", "wall"].far
    assert 0.1 < answer.clearance <= 0.2 + 1e-12


@pytest.mark.parametrize(
    ("rules", "told"),
    [
        ({"ignore": [("arm", "hnad")]}, "'hnad'.*'hand'"),
        ({"ignore": [("arm", "arm")]}, "with itself"),
        ({"only": [("arm", "arm")]}, "only has 'arm' with itself"),
        ({"margins": {("arm", "arm"): 1.0}}, "margins has 'arm' with itself"),
        ({"margins": {("arm", "hnad"): 1.0}}, "margins.*'hnad'.*'hand'"),
        ({"margins": [("arm", "hand")]}, "margins = .*mapping"),
        ({"groups": ["arm"]}, "groups = .*mapping"),
        ({"parents": [("arm", "hand")]}, "parents = .*mapping"),
        ({"fixed": ["arm"]}, "fixed = .*mapping"),
        ({"ignore": 3}, "ignore = 3.*pairs of names"),
        ({"only": "arm"}, "only = .*pairs of names"),
        ({"law": so.PredictorCorrector(within=0.3)}, r"within = 0\.3.*give it there"),
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
