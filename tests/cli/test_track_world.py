"""`standoff track` of a scene with a world: least distances by closed forms, its table and plot."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

from standoff.scene import load_scene

Standoff = Callable[..., Any]

SCENE = """version = 1
title = "Three balls"
length_unit = "cm"
[bodies.sun]
shape = "sphere"
radius = 1.0
[bodies.comet]
shape = "sphere"
radius = 0.5
[bodies.pole]
shape = "compound"
[bodies.pole.pieces.rod]
shape = "capsule"
radius = 0.25
length = 4.0
[bodies.pole.pieces.knob]
shape = "sphere"
radius = 0.5
position = [0.0, 0.0, 2.5]
[placements.pole]
position = [6.0, 0.0, 0.0]
[placements.comet]
position = [-4.0, 2.0, 0.0]
[motions.comet]
kind = "twist"
linear = [1.0, 0.0, 0.0]
[world]
within = 3.0
ignore = [["sun", "pole"]]
[track]
step = 0.05
duration = 12.0
"""


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    file = tmp_path / "balls.toml"
    file.write_text(SCENE, encoding="utf-8")
    return file


def truth(times: Any) -> dict[tuple[str, str], Any]:
    """Distances of the comet, which flies along x, 2 beside both others' middles."""
    return {
        ("sun", "comet"): np.hypot(-4.0 + times, 2.0) - 1.5,
        ("comet", "pole"): np.hypot(-10.0 + times, 2.0) - 0.75,
    }


def test_the_summary(standoff: Standoff, scene: Path) -> None:
    ended = standoff("track", scene)
    assert (ended.code, ended.err) == (0, "")
    lines = {line[:14].strip(): line[14:] for line in reversed(ended.out.splitlines())}
    assert lines["scene"] == "Three balls: 3 bodies, 2 pairs"
    assert lines["frames"] == "241 from 0 s to 12 s, 50 ms apart"
    assert lines["clearance"] == "0.499999999999 cm at 4 s, proven for all pairs in all frames"
    assert lines["closest"] == "0.5 cm at 4 s, sun - comet"
    assert "1.25 cm at 10 s, comet - pole rod" in ended.out
    assert lines["certified"] == "241 of 241 frames, 100 %"
    assert lines["near"].startswith("2 pairs within the horizon at some time")


def test_the_table_has_each_near_pair_of_each_frame(
    standoff: Standoff, scene: Path, tmp_path: Path
) -> None:
    file = tmp_path / "run.parquet"
    ended = standoff("track", scene, "-o", file)
    assert f"wrote         {file}" in ended.out
    table = pq.read_table(file)
    found = table.to_pydict()
    times = load_scene(scene).times()
    expected: dict[tuple[float, str, str], float] = {}
    for names, distances in truth(times).items():
        expected |= {(time, *names): d for time, d in zip(times.tolist(), distances, strict=True)}
    near = {key for key, distance in expected.items() if distance <= 3.0}
    keys = list(zip(found["time"], found["a"], found["b"], strict=True))
    assert len(set(keys)) == len(keys)
    assert set(keys) == near
    for k, key in enumerate(keys):
        assert found["distance"][k] == pytest.approx(expected[key], abs=1e-12)
        assert found["lower_bound"][k] <= expected[key] + 1e-15
        assert found["lower_bound"][k] == pytest.approx(expected[key], abs=1e-9)
        assert found["upper_bound"][k] >= expected[key] - 1e-15
    assert set(found["status"]) == {"CONVERGED"}
    assert all(found["certified"])
    facts = json.loads(table.schema.metadata[b"standoff"])
    assert (facts["format"], facts["within"]) == ("standoff-world", 3.0)
    assert set(facts["bodies"]) == {"sun", "comet", "pole.rod", "pole.knob"}
    assert facts["scene_text"] == SCENE
    again = tmp_path / "again.parquet"
    standoff("track", scene, "-o", again)
    assert again.read_bytes() == file.read_bytes()


def test_a_world_that_is_never_near_writes_an_empty_table(
    standoff: Standoff, scene: Path, tmp_path: Path
) -> None:
    scene.write_text(SCENE.replace("within = 3.0", "within = 0.1"))
    file, plot = tmp_path / "run.parquet", tmp_path / "run.png"
    ended = standoff("track", scene, "-o", file, "--plot", plot)
    assert ended.code == 0
    assert pq.read_table(file).num_rows == 0
    assert plot.exists()
    assert "0.1 cm at 0 s, proven for all pairs" in ended.out


def test_json(standoff: Standoff, scene: Path) -> None:
    facts = json.loads(standoff("track", scene, "--json", "--step", "0.5").out)
    assert (facts["frames"], facts["certified_frames"]) == (25, 25)
    assert facts["clearance"] == pytest.approx(0.5, abs=1e-9)
    assert [pair["names"] for pair in facts["pairs"]] == [["sun", "comet"], ["comet", "pole"]]
    assert [pair["time"] for pair in facts["pairs"]] == [4.0, 10.0]
    assert facts["counts"]["uncertified"] == 0
    assert facts["settings"]["step"] == 0.5


def test_the_plot_names_the_nearest_pairs(standoff: Standoff, scene: Path, tmp_path: Path) -> None:
    plot = tmp_path / "run.svg"
    assert standoff("track", scene, "--plot", plot).code == 0
    text = plot.read_text("utf-8")
    for words in ("sun - comet", "comet - pole", "Three balls: the nearest pair of each frame"):
        assert words in text


def test_options_of_pairs_are_refused(standoff: Standoff, scene: Path, tmp_path: Path) -> None:
    for options, words in (
        (("--pair", "x"), "--pair: the scene has a [world] and no pair"),
        (("--export", tmp_path / "run.html"), "--export: shows the motion of a pair"),
        (("--duration", "-1"), "--duration"),
        (("-o", tmp_path / "run.csv"), "the ending '.csv' is not known"),
        (("--plot", tmp_path / "none" / "run.png"), "does not exist"),
    ):
        ended = standoff("track", scene, *options)
        assert (ended.code, ended.out) == (2, ""), options
        assert words in ended.err
    assert [file.name for file in tmp_path.iterdir()] == ["balls.toml"]


def test_a_pair_beside_a_world_is_tracked_as_a_pair(standoff: Standoff, scene: Path) -> None:
    scene.write_text(SCENE + '[pair]\na = "sun"\nb = "comet"\n')
    ended = standoff("track", scene)
    assert ended.code == 0
    assert "scene         Three balls: A = sun (sphere), B = comet (sphere)" in ended.out
