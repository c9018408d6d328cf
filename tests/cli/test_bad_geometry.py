"""Bad geometry at the command line: one message with file, key and fix; nothing is written."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Standoff = Callable[..., Any]

HEAD = """version = 1
[bodies.part]
shape = "patches"
PART
[bodies.tool]
shape = "sphere"
radius = 0.1
[placements.tool]
position = [0.0, 0.0, 3.0]
[motions.tool]
kind = "twist"
linear = [0.1, 0.0, 0.0]
[track]
step = 0.1
duration = 0.3
"""
PAIR = '[pair]\na = "part"\nb = "tool"\n'
POINTS = (
    "control_points = [[[0, 0, 0], [0, 1, 0], [0, 2, 0]], [[1, 0, 0], [1, 1, 1], [1, 2, 0]], "
    "[[2, 0, 0], [2, 1, 0], [2, 2, 0]]]"
)
KNOTS = "knots_u = [0, 0, 0, 1, 1, 1]\nknots_v = [0, 0, 0, 1, 1, 1]"


def patch(*lines: str) -> str:
    return "\n".join(("[[bodies.part.patches]]", *lines))


# the part's table, key of the complaint, pieces of its sentence
BAD = [
    (
        patch(POINTS, KNOTS.replace("[0, 0, 0, 1, 1, 1]", "[0, 0, 0, 1, 0.5, 1]", 1)),
        "bodies.part.patches[0].knots_u",
        ["is not sorted: knot 3 = 1.0 is above knot 4 = 0.5", "sort the knots"],
    ),
    (
        patch(POINTS, KNOTS, "weights = [[1, 1, 1], [1, 0, 1], [1, 1, 1]]"),
        "bodies.part.patches[0].weights",
        ["(1, 1)", "every weight must be positive"],
    ),
    (
        patch(POINTS, KNOTS.replace("knots_v = [0, 0, 0, 1, 1, 1]", "knots_v = [0, 1]")),
        "bodies.part.patches[0].knots_v",
        ["2 knots for 3 columns of control points", "give 5 to 13"],
    ),
    (
        patch(POINTS.replace("[1, 1, 1]", "[1, nan, 1]"), KNOTS),
        "bodies.part.patches[0].control_points[1][1][1]",
        ["must be a finite number, got nan"],
    ),
    (
        patch('kind = "formula"', 'x = "u"', 'y = "v"', 'z = "h*u*v"', "domain = [0, 1, 0, 1]"),
        "bodies.part.patches[0].z",
        ["Unknown symbol 'h'", "Known: u, v"],
    ),
    (
        patch('kind = "formula"', 'x = "u"', 'y = "v"', 'z = "1/(u-0.3)"', "domain = [0, 1, 0, 1]"),
        "bodies.part.patches[0]",
        ["pole", "u = 0.3", "cut the domain"],
    ),
    (patch(POINTS, KNOTS), "bodies.part", ["patch 0"]),
    ('file = "prat.json"', "bodies.part.file", ["did you mean 'part.json'?"]),
]


@pytest.mark.parametrize("command", ["track", "distance", "automaton", "check"])
@pytest.mark.parametrize(("part", "key", "pieces"), BAD)
def test_bad_patches(
    standoff: Standoff, tmp_path: Path, command: str, part: str, key: str, pieces: list[str]
) -> None:
    (tmp_path / "part.json").write_text("{}")
    scene = tmp_path / "scene.toml"
    scene.write_text(HEAD.replace("PART", part) + PAIR)
    written = {
        "track": ["-o", tmp_path / "o.parquet", "--plot", tmp_path / "o.png"],
        "automaton": ["-o", tmp_path / "o.svg"],
        "check": ["--plot", tmp_path / "o.png"],
    }
    ended = standoff(command, scene, *written.get(command, []))
    assert (ended.code, ended.out) == (2, "")
    assert ended.err.startswith(f"standoff: {scene}: {key}: ")
    assert "Traceback" not in ended.err
    for piece in pieces:
        assert piece in ended.err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["part.json", "scene.toml"]


def test_a_file_of_patches_that_is_cut_off(standoff: Standoff, tmp_path: Path) -> None:
    net = [[[i, j, 0.0] for j in range(3)] for i in range(3)]
    whole = json.dumps(
        {
            "format": "standoff-patches",
            "version": 1,
            "patches": [{"kind": "bezier", "control_points": net}],
        }
    )
    scene, file = tmp_path / "scene.toml", tmp_path / "part.json"
    scene.write_text(HEAD.replace("PART", 'file = "part.json"') + PAIR)
    for length in range(0, len(whole), 7):
        file.write_text(whole[:length])
        for arguments in (["track", scene, "-o", tmp_path / "o.parquet"], ["check", file]):
            ended = standoff(*arguments)
            assert (ended.code, ended.out) == (2, "")
            assert ended.err.startswith(f"standoff: {file}: is not JSON: ")
            assert "it seems to be cut off" in ended.err
            assert ended.err.count("\n") == 1
    assert len(list(tmp_path.iterdir())) == 2


@pytest.mark.parametrize(
    ("pairs", "message"),
    [
        (
            '[[pairs]]\nname = "x"\na = "part"\nb = "tool"\n' * 2,
            "pairs[1].name: two pairs are called 'x', this one and pairs[0]; give each its own",
        ),
        (
            '[[pairs]]\na = "part"\nb = "tol"\n',
            "pairs[0].b: unknown body 'tol'; did you mean 'tool'?",
        ),
    ],
)
def test_bad_pairs(standoff: Standoff, tmp_path: Path, pairs: str, message: str) -> None:
    scene = tmp_path / "scene.toml"
    text = HEAD.replace('shape = "patches"\nPART', 'shape = "sphere"\nradius = 1')
    scene.write_text(text + pairs)
    ended = standoff("track", scene, "-o", tmp_path / "o.parquet")
    assert (ended.code, ended.out) == (2, "")
    assert ended.err.startswith(f"standoff: {scene}: {message}")
    assert [path.name for path in tmp_path.iterdir()] == ["scene.toml"]


@pytest.mark.parametrize("library", ["pyarrow", "sympy"])
def test_a_missing_extra_is_named(
    standoff: Standoff, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, library: str
) -> None:
    (tmp_path / "tool.parquet").write_bytes(b"PAR1")
    formula = patch('kind = "formula"', 'x = "u"', 'y = "v"', 'z = "u*v"', "domain = [0, 1, 0, 1]")
    text = HEAD.replace("PART", formula)
    if library == "pyarrow":
        text = HEAD.replace('shape = "patches"\nPART', 'shape = "sphere"\nradius = 1')
        twist = 'kind = "twist"\nlinear = [0.1, 0.0, 0.0]'
        text = text.replace(twist, 'kind = "samples"\nfile = "tool.parquet"')
        text = text.replace("[placements.tool]\nposition = [0.0, 0.0, 3.0]\n", "")
    scene = tmp_path / "scene.toml"
    scene.write_text(text + PAIR)
    monkeypatch.setitem(sys.modules, library, None)
    ended = standoff("distance", scene)
    assert (ended.code, ended.out) == (2, "")
    assert "pip install" in ended.err
    assert f"standoff[{'cli' if library == 'pyarrow' else 'formulas'}]" in ended.err
    assert ended.err.startswith(f"standoff: {scene}: ")
