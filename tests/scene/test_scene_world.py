"""Worlds in scenes: compounds, which pairs count, and what is refused."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from standoff.scene import Scene, SceneError, load_scene, record
from standoff.scene.simulation import load_simulation
from standoff.world import Compound, WorldAnswer

LoadText = Callable[[str], Scene]

BODIES = """version = 1
[bodies.ball]
shape = "sphere"
radius = 0.5
[bodies.hand]
shape = "compound"
[bodies.hand.pieces.palm]
shape = "box"
size = [2.0, 2.0, 0.5]
[bodies.hand.pieces.finger]
shape = "capsule"
radius = 0.25
length = 1.0
position = [1.0, 0.0, 1.0]
rotation_vector_degrees = [0.0, 90.0, 0.0]
[bodies.wall]
shape = "box"
size = [1.0, 4.0, 4.0]
[bodies.floor]
shape = "halfspace"
[placements.ball]
position = [0.0, 0.0, 2.0]
[placements.wall]
position = [4.0, 0.0, 0.0]
[placements.floor]
position = [0.0, 0.0, -2.0]
[motions.ball]
kind = "twist"
linear = [0.0, 0.0, -1.0]
"""
WORLD = BODIES + "[world]\n"
PAIR = '[pair]\na = "ball"\nb = "wall"\n'


def answer(scene: Scene, time: float = 0.0) -> WorldAnswer:
    return scene.world.distances(scene.poses(scene.world, time))


def test_a_world_needs_no_pair(load_text: LoadText) -> None:
    scene = load_text(WORLD)
    assert scene.pairs == ()
    assert list(scene.world.bodies) == ["ball", "hand", "wall", "floor"]
    assert scene.world.within == math.inf
    assert scene.world.fixed == ()
    found = answer(scene)
    # The finger lies along x at z = 1, from x = 0.5 to 1.5: its end is a ball of 0.25.
    to_finger = math.hypot(0.5, 1.0) - 0.75
    assert found["ball", "hand"].distance == pytest.approx(to_finger, abs=1e-12)
    assert found["ball", "hand"].pieces == ("", "finger")
    assert found["hand", "wall"].distance == pytest.approx(3.5 - 1.75, abs=1e-12)
    assert found["hand", "floor"].distance == pytest.approx(2.0 - 0.25, abs=1e-12)
    assert found["hand", "floor"].pieces == ("palm", "")
    assert found["wall", "floor"].distance == pytest.approx(0.0, abs=1e-12)


def test_motions_move_the_bodies(load_text: LoadText) -> None:
    scene = load_text(WORLD)
    for time in (0.0, 0.5, 1.0):
        found = answer(scene, time)
        assert found["ball", "floor"].distance == pytest.approx(3.5 - time, abs=1e-12)


def test_what_the_table_says_is_what_the_world_gets(load_text: LoadText) -> None:
    scene = load_text(
        WORLD
        + """within = 1.5
minima = 0.25
fixed = ["still"]
groups = { still = ["wall", "floor"] }
ignore = [["hand", "wall"]]
margins = [["ball", "still", 2.0], { a = "ball", b = "hand", length = 0.1 }]
"""
    )
    world = scene.world
    assert (world.within, world.minima) == (1.5, 0.25)
    assert (world.moving, world.fixed) == (("ball", "hand"), ("wall", "floor"))
    assert set(world.pairs()) == {
        ("ball", "hand"),
        ("ball", "wall"),
        ("ball", "floor"),
        ("hand", "floor"),
    }
    first, *others = world.bodies
    assert [world.margin(first, other) for other in others[:3]] == [0.1, 2.0, 2.0]
    assert answer(scene)["hand", "floor"].far
    assert answer(scene)["hand", "floor"].lower_bound >= 1.5


def test_only_and_parents(load_text: LoadText) -> None:
    scene = load_text(
        WORLD + 'only = [["hand", "solids"]]\n[world.groups]\nsolids = ["ball", "wall"]\n'
    )
    assert set(scene.world.pairs()) == {("ball", "hand"), ("hand", "wall")}
    scene = load_text(WORLD + 'parents = { ball = "hand", wall = "floor" }\n')
    assert ("ball", "hand") not in set(scene.world.pairs())
    assert len(set(scene.world.pairs())) == 4


def test_margins_as_an_array_of_tables(load_text: LoadText) -> None:
    scene = load_text(WORLD + '[[world.margins]]\na = "ball"\nb = "wall"\nlength = 0.3\n')
    assert scene.world.margin("ball", "wall") == 0.3


def test_a_pair_beside_a_world_is_as_before(load_text: LoadText) -> None:
    track = "[track]\nstep = 0.1\nduration = 1.0\n"
    alone, both = load_text(BODIES + PAIR + track), load_text(WORLD + PAIR + track)
    assert both.pair == ("ball", "wall")
    np.testing.assert_array_equal(record(both).distance, record(alone).distance)
    assert len(set(both.world.pairs())) == 6


def test_the_world_of_a_scene_without_one_has_its_pairs(load_text: LoadText) -> None:
    world = load_text(BODIES + PAIR).world
    assert list(world.bodies) == ["ball", "wall"]
    assert set(world.pairs()) == {("ball", "wall")}


def test_times_are_those_of_all_bodies(load_text: LoadText) -> None:
    scene = load_text(WORLD + "[track]\nstep = 0.25\nduration = 1.0\nstart = 1.0\n")
    np.testing.assert_allclose(scene.times(), [1.0, 1.25, 1.5, 1.75, 2.0])
    assert scene.instant(None) == 1.0
    with pytest.raises(SceneError, match="no motion ends by itself"):
        load_text(WORLD).times()


def test_a_pose_of_a_piece_in_any_form(load_text: LoadText) -> None:
    forms = [
        "position = [1.0, 0.0, 1.0]\n"
        "quaternion_wxyz = [0.7071067811865476, 0.0, 0.7071067811865476, 0.0]",
        "rotation_vector = [0.0, 1.5707963267948966, 0.0]\nposition = [1.0, 0.0, 1.0]",
        "matrix = [[0, 0, 1, 1], [0, 1, 0, 0], [-1, 0, 0, 1], [0, 0, 0, 1]]",
    ]
    usual = "position = [1.0, 0.0, 1.0]\nrotation_vector_degrees = [0.0, 90.0, 0.0]"
    hand = load_text(WORLD).bodies["hand"]
    assert isinstance(hand, Compound)
    for form in forms:
        other = load_text(WORLD.replace(usual, form)).bodies["hand"]
        assert isinstance(other, Compound)
        mine, theirs = hand.pieces["finger"].pose, other.pieces["finger"].pose
        np.testing.assert_allclose(mine.matrix, theirs.matrix, atol=1e-15)
    assert np.array_equal(hand.pieces["palm"].pose.matrix, np.eye(4))


def piece(text: str) -> str:
    return f'version = 1\n[bodies.a]\nshape = "compound"\n{text}\n[world]\n'


BLOCK = '[bodies.a.pieces.palm]\nshape = "box"\nsize = [1.0, 1.0, 1.0]\n'
PALM = '[bodies.a.pieces.palm]\nshape = "sphere"\nradius = 1.0\n'


@pytest.mark.parametrize(
    ("text", "key", "pieces"),
    [
        (piece(""), "bodies.a", ["'pieces' is missing", "[bodies.a.pieces.handle]"]),
        (piece("pieces = {}"), "bodies.a.pieces", ["no pieces", "[bodies.a.pieces.handle]"]),
        (piece("pieces = 3"), "bodies.a.pieces", ["must be a table", "got 3"]),
        (piece(PALM + "radus = 1"), "bodies.a.pieces.palm.radus", ["did you mean 'radius'?"]),
        (piece(PALM + "positon = [0]"), "bodies.a.pieces.palm.positon", ["mean 'position'?"]),
        (
            piece(PALM + "position = [0, 1]\nangle = 0\nmatrix = []"),
            "bodies.a.pieces.palm",
            [
                "say the same thing",
            ],
        ),
        (piece(PALM + "position = [0]"), "bodies.a.pieces.palm.position", ["2 or 3 numbers"]),
        (
            piece(PALM.replace("sphere", "compound")),
            "bodies.a.pieces.palm.shape",
            [
                "one convex shape",
            ],
        ),
        (piece("rounding = 0.1\n" + PALM), "bodies.a.rounding", ["unknown key 'rounding'"]),
        (
            piece(
                BLOCK + '[bodies.a.pieces.disk]\nshape = "planar_loop"\n[[bodies.a.pieces.disk.'
                'curves]]\nkind = "ellipse"\ncentre = [0, 0]\nsemi_axes = [1, 1]'
            ),
            "bodies.a.pieces",
            ["'disk' is planar", "'palm' is not"],
        ),
        (WORLD + '[bodies.ball]\nshape = "box"', "", ["('bodies', 'ball') twice"]),
        (
            BODIES + '[bodies.pad]\nshape = "compound"\n[bodies.pad.pieces.disk]\nposition = '
            '[0, 0, 0.1]\nshape = "planar_loop"\n[[bodies.pad.pieces.disk.curves]]\n'
            'kind = "ellipse"\ncentre = [0, 0]\nsemi_axes = [1, 1]',
            "bodies.pad.pieces",
            ["'disk' is out of the plane z = 0"],
        ),
        (
            WORLD + '[bodies.disk]\nshape = "planar_loop"\n[[bodies.disk.curves]]\nkind = "ellipse"'
            "\ncentre = [0, 0]\nsemi_axes = [1, 1]",
            "bodies",
            ["'disk' is planar", "'hand.palm' is not"],
        ),
        (WORLD + "witin = 1", "world.witin", ["unknown key 'witin'", "did you mean 'within'?"]),
        (WORLD + "within = 0", "world.within", ["above zero"]),
        (WORLD + "minima = -1", "world.minima", ["zero or above"]),
        (
            WORLD + 'ignore = [["ball", "hnad"]]',
            "world.ignore[0][1]",
            [
                "unknown body or group 'hnad'",
                "did you mean 'hand'?",
            ],
        ),
        (WORLD + 'ignore = ["ball", "hand"]', "world.ignore[0]", ["two names", "'ball'"]),
        (WORLD + 'ignore = [["ball", "ball"]]', "world.ignore", ["'ball' with itself"]),
        (WORLD + "ignore = [[1, 2]]", "world.ignore[0][0]", ["name of a body or group", "got 1"]),
        (WORLD + "only = []", "world.only", ["empty list"]),
        (WORLD + "groups = { robot = [] }", "world.groups.robot", ["empty list"]),
        (WORLD + 'groups = { robot = ["bal"] }', "world.groups.robot[0]", ["mean 'ball'?"]),
        (WORLD + 'groups = { ball = ["hand"] }', "world.groups", ["'ball' is a body"]),
        (WORLD + 'fixed = ["flor"]', "world.fixed[0]", ["did you mean 'floor'?"]),
        (WORLD + 'fixed = ["ball"]', "world.fixed[0]", ["[motions.ball]"]),
        (WORLD + 'parents = { bal = "hand" }', "world.parents.bal", ["did you mean 'ball'?"]),
        (WORLD + 'parents = { ball = "hnd" }', "world.parents.ball", ["did you mean 'hand'?"]),
        (WORLD + 'parents = { ball = "ball" }', "world.parents", ["its own parent"]),
        (WORLD + 'margins = [["ball", "hand"]]', "world.margins[0]", ["a, b and length"]),
        (WORLD + 'margins = [["ball", "hand", -1]]', "world.margins[0].length", ["zero or above"]),
        (
            WORLD + 'margins = [{ a = "ball", b = "hand", len = 1 }]',
            "world.margins[0].len",
            [
                "did you mean 'length'?",
            ],
        ),
        (WORLD + 'margins = [["ball", "x", 1]]', "world.margins[0].b", ["unknown body or group"]),
        (BODIES + '[pair]\na = "ball"\nb = "hand"', "pair.b", ["'hand' has several pieces"]),
        (BODIES, "", ["'pair' is missing"]),
    ],
)
def test_refused(load_text: LoadText, text: str, key: str, pieces: list[str]) -> None:
    with pytest.raises(SceneError) as caught:
        load_text(text)
    assert caught.value.key == key
    for words in pieces:
        assert words in caught.value.problem


def test_two_half_spaces_are_no_pair(load_text: LoadText) -> None:
    more = '[bodies.ceiling]\nshape = "halfspace"\n'
    with pytest.raises(SceneError, match="are half-spaces") as caught:
        _ = load_text(BODIES + more + "[world]\n").world
    assert caught.value.key == "world"
    world = load_text(BODIES + more + '[world]\nfixed = ["floor", "ceiling"]\n').world
    assert ("floor", "ceiling") not in set(world.pairs())


def test_what_needs_a_pair_says_so(load_text: LoadText) -> None:
    scene = load_text(WORLD)
    for ask in (lambda: scene.selected, lambda: scene.each(), lambda: scene.pair_bodies):
        with pytest.raises(SceneError, match=r"a \[world\] and no \[pair\]: `standoff clearance`"):
            ask()


def test_a_simulation_has_no_compounds(tmp_path: Path) -> None:
    file = tmp_path / "falling.toml"
    contact = "[contact]\nstiffness = 1e4\n[simulate]\nstep = 1e-3\nduration = 0.1\n"
    file.write_text(BODIES + contact + "[free.hand]\ndensity = 1.0\n")
    with pytest.raises(SceneError, match="has several pieces") as caught:
        load_simulation(file)
    assert caught.value.key == "bodies.hand"


@pytest.mark.parametrize("name", ["shelves", "fits"])
def test_examples_load(name: str) -> None:
    scene = load_scene(Path(__file__).parents[2] / "examples" / f"{name}.toml")
    assert answer(scene, scene.instant(None)).certified
