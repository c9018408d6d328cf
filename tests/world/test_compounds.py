"""Bodies of several pieces: the nearest, all local minima, gradients by the body's motion."""

import numpy as np
import pytest
from scattered import SHAPES, poses_of

import standoff as so

BALL = so.shapes.sphere(0.5)
TWO = so.compound({"left": BALL, "right": (BALL, (np.eye(3), [2.0, 0.0, 0.0]))})


def at(x: float, y: float = 0.0, z: float = 0.0) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, 3] = x, y, z
    return pose


def test_the_nearest_piece_is_told_with_the_bounds_of_all() -> None:
    answer = so.World({"two": TWO, "ball": BALL}).distances([at(0.0), at(4.5)])["two", "ball"]
    assert answer.distance == pytest.approx(1.5)
    assert answer.pieces == ("right", "")
    assert answer.lower_bound <= 1.5


def test_every_local_minimum_below_a_distance() -> None:
    world = so.World({"two": TWO, "ball": BALL}, minima=3.0)
    answer = world.distances([at(0.0), at(0.9, 1.5)])
    found = answer.minima(("two", "ball"))
    left, right = np.hypot(0.9, 1.5) - 1.0, np.hypot(1.1, 1.5) - 1.0
    assert [x.distance for x in found] == pytest.approx([left, right])
    assert [x.pieces[0] for x in found] == ["left", "right"]
    assert len(answer.minima(("ball", "two"), below=0.8)) == 1
    assert answer.minima(("ball", "two"))[0].pieces == ("", "left")
    # the nearest alone without
    alone = so.World({"two": TWO, "ball": BALL}).distances([at(0.0), at(0.2, 1.5)])
    assert len(alone.minima(("two", "ball"))) == 1


def test_depth_is_that_of_the_deepest_pair_of_pieces() -> None:
    world = so.World({"two": TWO, "ball": BALL})
    answer = world.distances([at(0.0), at(1.0, 0.0)])["two", "ball"]
    assert answer.distance == pytest.approx(0.0, abs=1e-9)
    answer = world.distances([at(0.0), at(1.3, 0.0)])["two", "ball"]
    assert answer.depth == pytest.approx(0.3)
    assert answer.pieces[0] == "right"
    assert answer.lower_bound <= -0.3 <= answer.upper_bound + 1e-12


def test_gradients_are_by_the_motion_of_the_bodies(rng: np.random.Generator) -> None:
    turned = poses_of(rng, 1, 0.7)[0]
    hand = so.compound({"palm": SHAPES[0], "thumb": (SHAPES[5], turned)})
    world = so.World({"hand": hand, "tool": SHAPES[0]})
    for _ in range(6):
        poses = poses_of(rng, 2, 1.6)
        found = world.distances(poses)["hand", "tool"]
        if found.distance < 0.05:
            continue
        step, numeric = 1e-6, np.zeros(12)
        for k in range(12):
            ends = []
            for sign in (1.0, -1.0):
                moved = poses.copy()
                twist = np.zeros(6)
                twist[k % 6] = sign * step
                side = k // 6
                moved[side, :3, 3] += twist[:3]
                moved[side, :3, :3] = so.Pose.exp(twist[3:]).rotation @ moved[side, :3, :3]
                ends.append(world.distances(moved)["hand", "tool"].distance)
            numeric[k] = (ends[0] - ends[1]) / (2.0 * step)
        assert found.gradient == pytest.approx(numeric, abs=1e-6)


def test_rates_are_those_of_the_bodies(rng: np.random.Generator) -> None:
    world = so.World({"two": TWO, "tool": SHAPES[0]})
    poses, twists = poses_of(rng, 2, 2.5), rng.normal(size=(2, 6))
    found = world.answer(world.start(poses, twists))["two", "tool"]
    if found.distance > 0.0:
        assert found.rate == pytest.approx(float(found.gradient @ twists.ravel()), abs=1e-8)


def test_bad_compounds() -> None:
    with pytest.raises(TypeError, match="mapping of names"):
        so.compound({})
    with pytest.raises(TypeError, match="'a' is 3"):
        so.compound({"a": 3})
    with pytest.raises(TypeError, match="not a string"):
        so.compound({7: BALL})
    with pytest.raises(ValueError, match="'a'"):
        so.compound({"a": (BALL, np.full((4, 4), np.nan))})
