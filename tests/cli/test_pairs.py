"""`standoff track` and `standoff distance` on a scene with several pairs."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

from standoff.scene import load_scene, query, record

Standoff = Callable[..., Any]

PAIR = '[pair]\na = "tool"\nb = "part"\n'
PAIRS = """[bodies.wall]
shape = "halfspace"
[placements.wall]
position = [0.0, 0.0, -2.0]
[[pairs]]
name = "near"
a = "tool"
b = "part"
[[pairs]]
name = "far"
a = "tool"
b = "wall"
step = 0.1
"""


@pytest.fixture
def pairs(passing: Path) -> Path:
    """The tool past the box, and past a wall with longer steps."""
    passing.write_text(passing.read_text().replace(PAIR, PAIRS))
    return passing


def test_track_sums_up_each(standoff: Standoff, pairs: Path) -> None:
    ended = standoff("track", pairs)
    assert ended.code == 0
    near, far = ended.out.split("\n\n")
    assert "pair          near: A = tool (ellipsoid), B = part (box)" in near
    assert "pair          far: A = tool (ellipsoid), B = wall (halfspace)" in far
    for text, scene, frames in zip((near, far), load_scene(pairs).each(), (101, 21), strict=True):
        assert f"{record(scene).distance.min():.6g} cm" in text
        assert f"{frames} from 0 s to 2 s" in text


def test_each_pair_has_its_own_files(standoff: Standoff, pairs: Path) -> None:
    folder = pairs.parent
    ended = standoff("track", pairs, "-o", folder / "run.parquet", "--plot", folder / "run.svg")
    assert ended.code == 0
    assert sorted(path.name for path in folder.iterdir()) == [
        "passing.toml",
        "run-far.parquet",
        "run-far.svg",
        "run-near.parquet",
        "run-near.svg",
    ]
    for name in ("near", "far"):
        table = pq.read_table(folder / f"run-{name}.parquet")
        recording = record(load_scene(pairs).select(name))
        np.testing.assert_array_equal(table["distance"], recording.distance)
        metadata = json.loads(table.schema.metadata[b"standoff"])
        assert metadata["source"]["pair"] == name
        assert str(folder / f"run-{name}.parquet") in ended.out
    assert "B = wall" in (folder / "run-far.svg").read_text()


def test_json_lists_the_pairs(standoff: Standoff, pairs: Path) -> None:
    facts = json.loads(standoff("track", pairs, "--json").out)
    assert [pair["pair"] for pair in facts["pairs"]] == ["near", "far"]
    assert [pair["frames"] for pair in facts["pairs"]] == [101, 21]
    assert facts["title"] == "Tool past a box"
    facts = json.loads(standoff("distance", pairs, "--json", "--time", 0.5).out)
    for pair, scene in zip(facts["pairs"], load_scene(pairs).each(), strict=True):
        assert pair["distance"] == query(scene, 0.5)[1].distance


def test_one_pair_by_name(standoff: Standoff, pairs: Path) -> None:
    target = pairs.with_name("run.parquet")
    facts = json.loads(standoff("track", pairs, "--pair", "far", "--json", "-o", target).out)
    assert (facts["pair"], facts["b"], facts["files"]) == ("far", "wall", [str(target)])
    facts = json.loads(standoff("distance", pairs, "--pair", "far", "--json").out)
    assert facts["b"] == "wall"
    for command in ("track", "distance"):
        ended = standoff(command, pairs, "--pair", "fra")
        assert (ended.code, ended.out) == (2, "")
        assert ended.err == "standoff: --pair: unknown pair 'fra'; did you mean 'far'?\n"


def test_distance_tells_each(standoff: Standoff, pairs: Path) -> None:
    ended = standoff("distance", pairs)
    assert ended.code == 0
    for text, scene in zip(ended.out.split("\n\n"), load_scene(pairs).each(), strict=True):
        assert f"distance      {query(scene)[1].distance:.15g} cm" in text


def test_a_pair_in_penetration_is_certified(standoff: Standoff, pairs: Path) -> None:
    pairs.write_text(pairs.read_text().replace("0.0, 0.0, -2.0", "0.0, 0.0, 2.0"))
    ended = standoff("track", pairs, "-o", pairs.with_name("run.parquet"))
    assert ended.code == 0
    assert "100 %" in ended.out


def test_one_bad_pair_stops_all(standoff: Standoff, pairs: Path) -> None:
    text = pairs.read_text()
    pairs.write_text(text.replace("step = 0.1\n", 'step = "samples"\n'))
    ended = standoff("track", pairs, "-o", pairs.with_name("run.parquet"))
    assert (ended.code, ended.out) == (2, "")
    assert "'samples' needs a body that moves by pose samples" in ended.err
    ended = standoff("track", pairs, "--step", "0.1", "-o", pairs.with_name("run.txt"))
    assert (ended.code, ended.out) == (2, "")
    assert [path.name for path in pairs.parent.iterdir()] == ["passing.toml"]
