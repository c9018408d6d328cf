"""`standoff track` of a pair with a solid that need not be convex."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import standoff as so
from families.solid_shapes import prism
from standoff.scene import load_scene, prepare, record
from standoff.solids import save_boundary

SCENE = """version = 1
title = "A ball over two feet"
length_unit = "mm"
[bodies.bridge]
body = "feet.json"
[bodies.ball]
shape = "sphere"
radius = 0.3
[placements.ball]
position = [0.2, 1.5, 0.5]
[motions.ball]
kind = "twist"
linear = [1.0, 0.0, 0.0]
[pair]
a = "bridge"
b = "ball"
[track]
step = 0.035
duration = 2.6
"""
FEET = [(0, 0), (3, 0), (3, 1), (2, 1), (2, 0.5), (1, 0.5), (1, 1), (0, 1)]


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    save_boundary(tmp_path / "feet.json", prism(FEET, 1.0).boundary)
    file = tmp_path / "feet.toml"
    file.write_text(SCENE, encoding="utf-8")
    return file


def test_a_run_is_summed_up_and_written(standoff: Any, scene: Path) -> None:
    out, plot, page = (scene.with_name(f"run.{kind}") for kind in ("parquet", "png", "html"))
    asked = ("--minima", 0.75, "-o", out, "--plot", plot, "--export", page)
    ended = standoff("track", scene, *asked)
    assert ended.code == 0, ended.err
    lines = ended.out.splitlines()
    assert "certified     75 of 75 frames, 100 %, tolerance 1e-10 of the pair's size" in lines
    assert "minima        3 local minima below 0.75 mm, 3 at most in a frame:" in lines
    assert "              0.8 s        bridge: face 8 to edge 22" in lines
    assert "              1.33 s       minimum 2 is the nearest, 0 was, at 0.386222 mm" in lines
    assert "              1.82 s       minimum 1: end, LEFT, at 0.7 mm" in lines
    assert not any(text.startswith("law") for text in lines)
    run = so.open_recording(out)
    assert run.info.bodies == ("bridge", "ball")
    assert run.info.options["minima"] == 0.75
    assert len(run.minima.frame) > len(run)
    assert plot.stat().st_size > 10_000
    assert page.stat().st_size > 100_000


def test_the_same_as_json(standoff: Any, scene: Path) -> None:
    told = json.loads(standoff("track", scene, "--json", "--minima", 0.75).out)
    assert told["certified_frames"] == 75
    assert told["settings"]["minima"] == 0.75
    assert [event["time"] for event in told["events"]] == pytest.approx([0.8, 1.3, 1.8], abs=1e-6)
    ends = [event for event in told["minima_events"] if event["kind"] == "end"]
    assert [(e["key"], e["reason"], e["time"]) for e in ends] == [
        (0, "FAR", pytest.approx(1.75)),
        (1, "LEFT", pytest.approx(1.82)),
    ]
    plain = json.loads(standoff("track", scene, "--json").out)
    assert "minima_events" not in plain
    assert plain["settings"]["minima"] is None


def test_options_mean_what_they_mean_of_convex_bodies(standoff: Any, scene: Path) -> None:
    """The tolerance is in sizes of the pair; evaluations that run out end with exit code 3."""
    loose = json.loads(standoff("track", scene, "--json", "--tolerance", 1e-4).out)
    size = prism(FEET, 1.0).size + so.Solid(so.shapes.sphere(0.3)).size
    assert 1e-6 * size < loose["worst_gap"] < 1.001e-4 * size
    loaded = load_scene(scene)
    tracker, _ = prepare(loaded, loaded.settings.overridden({"tolerance": 1e-4}))
    assert tracker.tolerance == pytest.approx(1e-4 * size)
    ended = standoff("track", scene, "--deadline", 20)
    assert ended.code == 3
    assert "DEADLINE in" in ended.out


def test_the_scene_says_minima(scene: Path) -> None:
    scene.write_text(SCENE + "minima = 0.75\n", encoding="utf-8")
    loaded = load_scene(scene)
    assert loaded.settings.minima == 0.75
    run = record(loaded)
    assert run.info.options["minima"] == 0.75
    assert run.info.source["settings"]["minima"] == 0.75


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--depth", "local"), "depth = 'local' is of convex bodies"),
        (("--within", "2"), "within = 2.0 is of convex bodies"),
        (("--restarts", "false"), "restarts = False is of convex bodies"),
        (("--law", "paper"), "such a pair follows no law"),
        (("--tolerance", "inf"), "give a finite one"),
        (("--minima", "0"), "--minima: "),
        (("--minima", "wide"), "--minima: "),
        (("--export", "run.gif"), "films draw convex bodies alone"),
        (("--export", "run.mp4"), "films draw convex bodies alone"),
    ],
)
def test_what_does_not_go_is_refused_before_the_run(
    standoff: Any, scene: Path, arguments: tuple[str, str], words: str
) -> None:
    ended = standoff("track", scene, *arguments)
    assert ended.code == 2
    assert words in ended.err
    assert ended.out == ""


def test_bodies_that_no_tracker_takes(standoff: Any, scene: Path) -> None:
    for ball, words in (
        ('shape = "point"', "is a point"),
        ('shape = "halfspace"', "is a half-space"),
    ):
        text = SCENE.replace('shape = "sphere"\nradius = 0.3', ball)
        scene.write_text(text, encoding="utf-8")
        ended = standoff("track", scene)
        assert ended.code == 2
        assert words in ended.err


def test_minima_are_of_pairs_with_a_solid(standoff: Any, scene: Path) -> None:
    body = 'shape = "box"\nsize = [1.0, 1.0, 1.0]'
    scene.write_text(SCENE.replace('body = "feet.json"', body), encoding="utf-8")
    ended = standoff("track", scene, "--minima", 0.5)
    assert ended.code == 2
    assert "two convex bodies have one minimum" in ended.err
    world = SCENE.replace('[pair]\na = "bridge"\nb = "ball"', "[world]")
    scene.write_text(world, encoding="utf-8")
    ended = standoff("track", scene, "--minima", 0.5)
    assert ended.code == 2
    assert "is of a pair" in ended.err
