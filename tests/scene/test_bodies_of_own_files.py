"""Bodies of scenes from files of finished boundaries, and what the commands do with solids."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import standoff as so
from families.solid_shapes import tube
from standoff.cli.entry import main
from standoff.robots.obstacles import read_obstacles
from standoff.scene import Scene, SceneError, load_scene, query
from standoff.solids import Solid, SolidProximity, save_boundary

BODIES = """version = 1
length_unit = "mm"
[bodies.ring]
body = "ring.json"
[bodies.pin]
shape = "cylinder"
radius = 0.9
height = 6.0
[placements.pin]
position = [0.03, 0.04, 0.0]
"""
PAIR = BODIES + '[pair]\na = "ring"\nb = "pin"\n'
WORLD = (
    BODIES
    + """[bodies.clip]
shape = "compound"
[bodies.clip.pieces.ring]
body = "ring.json"
position = [0.0, 0.0, 2.0]
[bodies.clip.pieces.bead]
shape = "ellipsoid"
semi_axes = [0.1, 0.1, 0.1]
position = [5.0, 0.0, 0.0]
[motions.pin]
kind = "twist"
linear = [0.02, 0.0, 0.0]
[world]
within = 3.0
[track]
step = 0.5
duration = 1.0
"""
)
Command = Callable[..., tuple[int, str]]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    save_boundary(tmp_path / "ring.json", tube(1.0, 1.5, -0.5, 0.5).boundary)
    save_boundary(tmp_path / "box.json", so.shapes.box((1.0, 2.0, 3.0)))
    return tmp_path


@pytest.fixture
def command(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> Command:
    """Run a command on a scene's text: its code, and what it said."""
    monkeypatch.setenv("STANDOFF_QUIET", "1")

    def run(text: str, name: str, *arguments: object) -> tuple[int, str]:
        (folder / "scene.toml").write_text(text)
        capsys.readouterr()
        code = main([name, str(folder / "scene.toml"), *map(str, arguments)])
        ended = capsys.readouterr()
        assert "Traceback" not in ended.err
        return code, ended.out + ended.err

    return run


def loaded(folder: Path, text: str) -> Scene:
    (folder / "scene.toml").write_text(text)
    return load_scene(folder / "scene.toml")


def test_a_pair_and_a_world_of_finished_boundaries(folder: Path) -> None:
    scene = loaded(folder, PAIR)
    assert isinstance(scene.bodies["ring"], Solid)
    _, found = query(scene)
    assert isinstance(found, SolidProximity)
    assert found.distance == pytest.approx(0.05, abs=1e-8)
    scene = loaded(folder, WORLD)
    answer = scene.world.distances(scene.poses(scene.world, 0.0))
    assert answer["ring", "pin"].distance == pytest.approx(0.05, abs=1e-8)
    assert answer["clip", "pin"].pieces == ("ring", "")
    assert answer["clip", "ring"].distance == pytest.approx(1.0, abs=1e-8)
    convex = loaded(folder, '[bodies.a]\nbody = "box.json"\n'.join(("version = 1\n", "[world]\n")))
    assert isinstance(convex.bodies["a"], so.Body)


def test_the_commands_take_solids(command: Command, folder: Path) -> None:
    code, told = command(PAIR, "distance")
    assert code == 0
    assert "0.0499999999999" in told
    assert "status        CON" in told  # CONVERGED or CONTINUUM
    code, text = command(PAIR, "distance", "--json")
    facts: dict[str, Any] = json.loads(text)
    assert facts["certified"]
    assert len(facts["minima"]) >= 1
    assert facts["lower_bound"] <= 0.05 <= facts["upper_bound"] + 1e-12

    code, told = command(WORLD, "check", "--plot", folder / "body.png")
    assert code == 0
    assert "no: a Solid" in told
    assert "clip.ring" in told
    assert (folder / "body-clip_ring.png").stat().st_size > 1000
    code, text = command(WORLD, "check", "--json", "--body", "ring")
    facts = json.loads(text)
    assert facts["convex"] is False
    assert facts["report"]["volume"] == pytest.approx(np.pi * 1.25, rel=1e-9)

    page = folder / "page.html"
    code, told = command(WORLD, "clearance", "--min", "0.06", "--page", page)
    assert code == 3
    assert "not proven to keep 0.06" in told
    assert "data:image/png" in page.read_text()
    code, text = command(WORLD, "clearance", "--motion", "--json")
    assert code == 0
    pairs = {tuple(pair["names"]): pair for pair in json.loads(text)["pairs"]}
    assert pairs["ring", "pin"]["distance"] == pytest.approx(0.1 - np.hypot(0.05, 0.04), abs=1e-8)
    assert pairs["ring", "pin"]["time"] == 1.0
    code, told = command(WORLD, "track", "-o", folder / "pairs.parquet")
    assert code == 0
    assert (folder / "pairs.parquet").exists()


def test_every_shape_may_be_beside_a_solid(command: Command, folder: Path) -> None:
    text = """version = 1
[bodies.ring]
body = "ring.json"
[bodies.ball]
shape = "sphere"
radius = 0.9
[bodies.rod]
shape = "capsule"
radius = 0.2
length = 1.0
[bodies.ground]
shape = "halfspace"
offset = -1.25
[bodies.block]
shape = "box"
size = [1.0, 1.0, 1.0]
rounding = 0.1
[placements.ball]
position = [0.03, 0.04, 0.0]
[placements.rod]
position = [2.0, 0.0, 0.0]
[placements.ground]
position = [40.0, 30.0, 0.0]
[placements.block]
position = [0.0, 2.5, 0.0]
[world]
"""
    page = folder / "page.html"
    code, told = command(text, "clearance", "--json", "--page", page)
    assert code == 0
    pairs = {tuple(pair["names"]): pair for pair in json.loads(told)["pairs"]}
    for name, gap in (("ball", 0.05), ("rod", 0.3), ("ground", 0.75), ("block", 0.5)):
        assert pairs["ring", name]["distance"] == pytest.approx(gap, abs=1e-8)
    assert page.read_text().count("data:image/png") >= 1
    code, told = command(text.replace("[world]", '[pair]\na = "ground"\nb = "ring"'), "distance")
    assert code == 0
    assert "face 0" in told
    assert "0.75" in told or "0.7499999" in told


def test_a_body_inside_another_is_told_over_a_motion(command: Command) -> None:
    """A stone jumps from before the ring into its material: the frame inside is the least."""
    text = (
        BODIES
        + """[bodies.stone]
shape = "ellipsoid"
semi_axes = [0.05, 0.05, 0.05]
[placements.stone]
position = [1.75, 0.0, 0.0]
[motions.stone]
kind = "twist"
linear = [-1.0, 0.0, 0.0]
[world]
only = [["ring", "stone"]]
[track]
step = 0.5
duration = 0.5
"""
    )
    code, told = command(text, "clearance", "--motion", "--json")
    assert code == 0
    (pair,) = json.loads(told)["pairs"]
    assert pair["verdict"] == "CONTAINED"
    assert pair["time"] == 0.5
    assert pair["distance"] == pytest.approx(0.2, abs=1e-8)
    code, told = command(text, "clearance", "--motion", "--min", "0.1")
    assert code == 3
    assert "inside the other's material" in told
    assert "none is proven" in told


def test_a_simulation_moves_solids(command: Command) -> None:
    """A ring falls on a plate, and rests on it."""
    text = """version = 1
[bodies.ring]
body = "ring.json"
[bodies.plate]
shape = "box"
size = [6.0, 6.0, 1.0]
[placements.plate]
position = [0.0, 0.0, -1.01]
[free.ring]
density = 1.0
[contact]
stiffness = 1e4
damping = 1.0
friction = 0.1
slip_speed = 0.1
depth = 0.02
[simulate]
step = 1e-3
duration = 1.0
every = 10
"""
    code, told = command(text, "simulate", "--json")
    assert code == 0, told
    found = json.loads(told)
    assert found["uncertified"] == found["ended_deep"] == 0
    assert 0.0 < found["deepest"] < 0.05
    height = found["bodies"]["ring"]["position"][2]
    assert -0.05 < height < 0.0
    weight = 9.81 * np.pi * (1.5**2 - 1.0)
    assert found["pairs"]["ring-plate"]["greatest_force"] > weight
    told = command(text, "simulate")[1]
    assert "all places looked for; 0 places ended deep" in told
    assert "certified" not in told


def test_obstacles_of_a_robot_may_be_solids(folder: Path) -> None:
    ring = loaded(folder, PAIR).bodies["ring"]
    for obstacle in (ring, so.compound({"ring": ring})):
        body, pose = read_obstacles({"ring": obstacle}, ())["ring"]
        assert body is obstacle
        assert np.array_equal(pose.matrix, np.eye(4))


@pytest.mark.parametrize(
    ("lines", "key", "words"),
    [
        ('body = "none.json"', "body", "no file 'none.json'"),
        ('body = "rings.json"', "body", "did you mean 'ring.json'"),
        ('body = "folder"', "body", "is a folder"),
        ('body = "note.txt"', "body", "must end in .step, .stp"),
        ('body = "torn.json"', "body", "not a boundary's file, or damaged"),
        ('body = "other.json"', "body", "not a boundary's file"),
        ('body = "changed.json"', "body", "checksum"),
        ("body = 3", "body", "string in quotes"),
        ('body = "ring.json"\npart = "ring"', "part", "for other files"),
        ('body = "ring.json"\nshape = "box"', "shape", "unknown key"),
        ('body = "ring.json"\nscale = 2.0', "scale", "unknown key"),
        ('body = "ring.json"\nheal = "yes"', "heal", "true or false"),
    ],
)
def test_bad_files_are_told_with_their_place(
    folder: Path, lines: str, key: str, words: str
) -> None:
    (folder / "folder").mkdir()
    (folder / "note.txt").write_text("a part")
    whole = (folder / "ring.json").read_text()
    (folder / "torn.json").write_text(whole[: len(whole) // 2])
    (folder / "other.json").write_text('{"patches": []}')
    (folder / "changed.json").write_text(whole.replace('"radius": 0.0', '"radius": 0.5'))
    with pytest.raises(SceneError) as caught:
        loaded(folder, f"version = 1\n[bodies.a]\n{lines}\n[world]\n")
    assert caught.value.key == f"bodies.a.{key}"
    assert words in str(caught.value)
    assert "scene.toml" in str(caught.value)
