"""Bodies that leave and enter, and horizons that change: a state goes from world to world."""

import numpy as np
import pytest
from scattered import SHAPES, Motion, bodies_of, check, poses_of, truth_of

import standoff as so
from draws import draws
from standoff.errors import StandoffError, StandoffTypeError

H = 1e-2
BALL = so.shapes.sphere(0.2)
FLOOR = {"floor": (np.eye(3), [0.0, 0.0, -2.5])}


def placed(world: so.World, state: so.world.WorldState) -> np.ndarray:
    """Poses of the moving bodies."""
    return state.poses[world.model.moving_rows]


def drawn_change(rng: np.random.Generator, world: so.World, number: int) -> so.World:
    """Some leave, some enter, and the horizon is another."""
    names = [str(x) for x in rng.choice([x for x in world.bodies if x != "floor"], 4, False)]
    new = {f"n{number}.{k}": SHAPES[int(rng.integers(len(SHAPES)))] for k in range(3)}
    return world.changed(new, names, within=float(rng.uniform(0.2, 1.0)))


def entering(rng: np.random.Generator, world: so.World, old: so.World) -> dict[str, np.ndarray]:
    names = [name for name in world.moving if name not in old.bodies]
    return dict(zip(names, poses_of(rng, len(names)), strict=True))


@pytest.mark.parametrize("compounds", [0, 4])
def test_no_pair_is_missed_while_bodies_come_and_go(
    rng: np.random.Generator, compounds: int
) -> None:
    ignored = [("b0", "b1"), ("b2", "floor")]
    world = so.World(bodies_of(rng, 18, compounds), within=0.6, fixed=FLOOR, ignore=ignored, dt=H)
    motion, near, reused = Motion(rng, len(world.moving)), 0, 0
    state = world.start(motion.poses)
    for number in range(draws(6)):
        for _ in range(4):
            state, _ = world.step(state, motion.step(H))
        old, before = world, state
        world = drawn_change(rng, old, number)
        state = world.start_from(old, before, entering(rng, world, old))
        poses = placed(world, state)
        near += check(world.answer(state), truth_of(world, poses), world.within)
        reused += state.counts.resting
        assert state.time == before.time
        fresh = world.start(poses)
        assert state.counts.started < fresh.counts.started
        motion = Motion(rng, len(world.moving))
        motion.poses = poses
    assert near > draws(20)
    assert reused > draws(20)


def same_answers(one: so.World, first: so.world.WorldState, second: so.world.WorldState) -> None:
    """Equal in proven bounds: each state's lower bounds are below the other's upper ones."""
    a, b = one.answer(first), one.answer(second)
    np.testing.assert_array_equal(a.pairs.bodies, b.pairs.bodies)
    assert (a.pairs.lower_bound <= b.pairs.upper_bound + 1e-12).all()
    assert (b.pairs.lower_bound <= a.pairs.upper_bound + 1e-12).all()
    outside = a.pairs.distance > 0.0
    np.testing.assert_allclose(
        a.pairs.distance[outside], b.pairs.distance[outside], atol=1e-9, rtol=0.0
    )
    np.testing.assert_allclose(a.pairs.normal[outside], b.pairs.normal[outside], atol=1e-5)


def test_a_wider_horizon_asks_the_new_pairs_alone(rng: np.random.Generator) -> None:
    world = so.World(bodies_of(rng, 20, 2), within=0.3, fixed=FLOOR, dt=H)
    motion = Motion(rng, len(world.moving))
    state = world.start(motion.poses)
    for _ in range(5):
        state, _ = world.step(state, motion.step(H))
    wider = world.changed(within=1.2)
    carried = wider.start_from(world, state)
    fresh = wider.start(motion.poses)
    same_answers(wider, carried, fresh)
    assert carried.counts.resting > 0
    assert carried.counts.started <= fresh.counts.started - carried.counts.resting
    again = world.start_from(wider, carried)  # and back: nothing is asked
    assert again.counts.started == again.counts.tracked == 0
    same_answers(world, again, state)
    # a step afterwards finds what one from a fresh start does
    poses = motion.step(H)
    same_answers(wider, wider.step(carried, poses)[0], wider.step(fresh, poses)[0])


def test_a_pair_that_comes_back_into_the_horizon_at_once(rng: np.random.Generator) -> None:
    """It has a tracker's state of some frames ago, and no time has passed."""
    ball = so.shapes.ellipsoid(0.3, 0.5, 0.4)
    world = so.World({"a": ball, "b": ball}, within=0.5)
    poses = np.tile(np.eye(4), (2, 1, 1))
    poses[1, 0, 3] = 0.7
    state, _ = world.step(world.start(poses), poses + 0.0)
    near = world.changed(within=0.05)
    far = near.start_from(world, state)
    assert len(near.answer(far).pairs) == 0
    back = world.start_from(near, far)
    same_answers(world, back, world.start(poses))
    poses[1, 0, 3] += 0.01
    same_answers(world, world.step(back, poses)[0], world.start(poses))


def test_the_order_of_the_bodies_may_change(rng: np.random.Generator) -> None:
    bodies = bodies_of(rng, 14, 2)
    world = so.World(bodies, within=0.6, fixed=FLOOR, dt=H)
    state = world.start(Motion(rng, len(world.moving)).poses)
    other = so.World(dict(reversed(bodies.items())), within=0.6, fixed=FLOOR, dt=H)
    carried = other.start_from(world, state)
    check(other.answer(carried), truth_of(other, placed(other, carried)), 0.6)
    same_answers(other, carried, other.start(placed(other, carried)))


@pytest.mark.parametrize("within", [None, 2.0])
def test_pairs_that_count_no_more_are_gone(within: float | None) -> None:
    bodies = {"a": BALL, "b": BALL, "floor": so.shapes.halfspace()}
    world = so.World(bodies, within=within, fixed=FLOOR)
    poses = np.tile(np.eye(4), (2, 1, 1))
    poses[1, 0, 3] = 1.0
    state = world.start(poses)
    other = world.changed(ignore=[("a", "floor"), ("a", "b")])
    answer = other.answer(other.start_from(world, state))
    assert [pair.names for pair in answer.pairs] == ([("b", "floor")] if within is None else [])
    assert answer.counts.open == int(within is None)


def test_another_body_under_the_same_name_is_asked_anew() -> None:
    small, large = so.shapes.sphere(0.2), so.shapes.sphere(0.6)
    world = so.World({"a": small, "b": small}, within=2.0)
    poses = np.tile(np.eye(4), (2, 1, 1))
    poses[1, 0, 3] = 2.0
    state = world.start(poses)
    other = so.World({"a": small, "b": large}, within=2.0)
    found = other.answer(other.start_from(world, state))["a", "b"]
    assert found.distance == pytest.approx(1.2, abs=1e-12)
    assert other.start_from(world, state).counts.started == 1


def test_a_body_may_be_fixed_elsewhere() -> None:
    ball = so.shapes.sphere(0.2)
    world = so.World({"a": ball, "b": ball}, within=2.0)
    poses = np.tile(np.eye(4), (2, 1, 1))
    poses[1, 0, 3] = 1.0
    other = world.changed(fixed={"b": (np.eye(3), [0.0, 1.5, 0.0])})
    found = other.answer(other.start_from(world, world.start(poses)))
    assert found["a", "b"].distance == pytest.approx(1.1, abs=1e-9)
    given = world.start_from(other, found.state, {"b": (np.eye(3), [0.0, 0.0, 1.0])})
    assert world.answer(given)["a", "b"].distance == pytest.approx(0.6, abs=1e-9)


def test_rules_of_bodies_that_leave_go_with_them() -> None:
    ball = so.shapes.sphere(0.2)
    world = so.World(
        dict.fromkeys("abcd", ball),
        within=1.0,
        groups={"both": ["a", "b"], "one": ["d"]},
        ignore=[("both", "c"), ("one", "c")],
        parents={"b": "d", "c": "d"},
        margins={("a", "d"): 0.1, ("a", "b"): 0.2},
        fixed={"d": (np.eye(3), [0.0, 0.0, 1.0])},
    )
    left = world.changed(remove=["d"])
    assert list(left.pairs()) == [("a", "b")]
    assert left.margin("a", "b") == 0.2
    assert left.fixed == ()
    same = left.changed({"d": ball}, within=0.5)
    assert list(same.pairs()) == [("a", "b"), ("a", "d"), ("b", "d"), ("c", "d")]
    assert (same.within, left.within) == (0.5, 1.0)


@pytest.mark.parametrize(
    ("add", "remove", "told"),
    [
        ({"a": BALL}, [], "has a body 'a' already"),
        ({}, ["q"], "no body 'q'"),
        ({}, "a", "give a list of names"),
        ([BALL], [], "give a mapping to bodies"),
        ({}, ["a", "b"], "at least one"),
        ({"c": 3}, [], "give a Body, a Solid or a Compound"),
    ],
)
def test_changes_that_are_none(add, remove, told) -> None:
    world = so.World({"a": BALL, "b": BALL}, within=1.0)
    with pytest.raises((StandoffError, StandoffTypeError), match=told):
        world.changed(add, remove)


def test_poses_of_those_that_enter() -> None:
    world = so.World({"a": BALL, "b": BALL}, within=1.0)
    poses = np.tile(np.eye(4), (2, 1, 1))
    poses[1, 0, 3] = 1.0
    state = world.start(poses)
    more = world.changed({"c": BALL})
    with pytest.raises(StandoffError, match="poses has none of 'c'"):
        more.start_from(world, state)
    with pytest.raises(StandoffError, match="'d', which is no body of the world"):
        more.start_from(world, state, {"c": np.eye(4), "d": np.eye(4)})
    with pytest.raises(StandoffTypeError, match="give a mapping of names to poses"):
        more.start_from(world, state, [np.eye(4)])
    with pytest.raises(StandoffError, match="another world"):
        more.start_from(more, state)
    with pytest.raises(StandoffTypeError, match="not a World"):
        more.start_from(state, state)
    bad = np.eye(4)
    bad[0, 3] = np.nan
    with pytest.raises(StandoffError, match="'c'"):
        more.start_from(world, state, {"c": bad})
