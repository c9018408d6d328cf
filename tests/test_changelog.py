"""What the changelog tells users of 0.1: each old line is refused with the new one, which works."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import standoff as so
from standoff.cli import main
from standoff.geometry import BezierPatch, Line
from standoff.motion import Helix, PoseSamples
from standoff.scene import Motion, TrackSettings, load_scene

ROOT = Path(__file__).parents[1]
TEXT = (ROOT / "CHANGELOG.md").read_text("utf-8").split("\n## [0.1.0]")[0]
WORD = re.compile(r"[A-Za-z_]\w*")
CORNERS = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)]
SCENE = """version = 1
bodies.part = {{ {body} }}
bodies.tool = {{ shape = "point" }}
pair = {{ a = "part", b = "tool" }}
motions.tool = {{ kind = "helix", radius = 9.0, pitch = 0.4, rate = 2.0 }}
track = {{ {track} }}
"""
CURVES = '[{ kind = "line", start = [0, 0], end = [1, 0] }, { kind = "line", start = [1, 0], end '
CURVES += '= [0, 1] }, { kind = "line", start = [0, 1], end = [0, 0] }]'


def rows(table: str) -> list[tuple[str, str]]:
    """(old, new) of the rows of all tables whose first column is headed so."""
    found = []
    heading = re.escape(f"| {table}version 0.1 | version 0.2 |\n|---|---|\n")
    for lines in re.findall(rf"^{heading}((?:\|.*\n)+)", TEXT, re.MULTILINE):
        for line in lines.splitlines():
            (pair,) = re.findall(r"^\| `(.*)` \| `(.*)` \|$", line)
            found.append(pair)
    return found


PYTHON = rows("")
BODIES = rows("body of a scene, ")
TRACKS = rows("`[track]` of a scene, ")


def one_name_each(old: str, new: str) -> list[tuple[str, str]]:
    """A row that imports several names, as one row a name."""
    parts = [line.partition(" import ") for line in (old, new)]
    if not parts[0][1]:
        return [(old, new)]
    (before, _, names), (after, _, same) = parts
    assert names == same
    return [(f"{before} import {x}", f"{after} import {x}") for x in names.split(", ")]


LINES = [line for row in PYTHON for line in one_name_each(*row)]


def patches() -> list[BezierPatch]:
    """The six sides of a unit cube."""
    sides = []
    for axis in range(3):
        for height in (0.0, 1.0):
            grid = np.zeros((2, 2, 3))
            grid[..., axis] = height
            grid[1, :, (axis + 1) % 3] = 1.0
            grid[:, 1, (axis + 2) % 3] = 1.0
            sides.append(BezierPatch(grid))
    return sides


@pytest.fixture(scope="module")
def names() -> dict[str, Any]:
    """What the lines take for granted."""
    a, b, dt = so.shapes.lens(1.0, 0.45), so.shapes.ellipsoid(0.15, 0.30, 0.20), 1e-3
    path = Helix(radius=1.2, pitch=0.4, rate=2.0)
    curves = [Line(p, q) for p, q in zip(CORNERS, CORNERS[1:] + CORNERS[:1], strict=True)]
    return {
        "so": so,
        "a": a,
        "b": b,
        "dt": dt,
        "path_a": so.Pose.identity(),
        "path_b": path,
        "tracker": so.Tracker(a, b, dt),
        "paper": so.Tracker(a, b, dt, law=so.PaperLaw()),
        "triangle": so.shapes.planar_loop(curves),
        "curves": curves,
        "patches": patches(),
        "pose": path.pose(0.0),
        "p": so.distance(a, b, path.pose(0.0), path.pose(1.0)),
        "samples": PoseSamples([0.0, 1.0], [path.pose(0.0), path.pose(1.0)]),
        "motion": Motion(path, "helix", np.zeros(0)),
        "settings": TrackSettings(),
    }


def refused(line: str, names: dict[str, Any]) -> str:
    """The message with which a line ends."""
    with pytest.raises((AttributeError, ImportError, so.StandoffError)) as caught:
        exec(line, dict(names))
    return str(caught.value)


def test_the_version_is_the_one_that_the_changelog_begins_with() -> None:
    (version, date), *_ = re.findall(r"^## \[([\d.]+)\] - ([\d-]+)$", TEXT, re.MULTILINE)
    cited = (ROOT / "CITATION.cff").read_text("utf-8")
    assert so.__version__ == version
    assert f"\nversion: {version}\n" in cited
    assert f"\ndate-released: {date}\n" in cited


def test_the_tables_are_read() -> None:
    assert len(PYTHON) > 50
    assert len(BODIES) == 3
    assert len(TRACKS) == 4


@pytest.mark.parametrize(("old", "new"), LINES, ids=[old for old, _ in LINES])
def test_a_line_of_0_1_is_told_what_to_write(old: str, new: str, names: dict[str, Any]) -> None:
    said = refused(old, names)
    assert "write " in said
    assert set(WORD.findall(new)) - set(WORD.findall(old)) <= set(WORD.findall(said)) | {"so"}
    exec(new, dict(names))


def test_every_name_that_moved_is_in_the_changelog() -> None:
    told = set()
    for old, new in LINES:
        if " import " in old and "bodies import" not in old:
            _, package, _, name = old.split()
            told.add((f"{package}.{name}", new.split()[1]))
    on_demand: Any = sys.modules["standoff.on_demand"]
    assert set(on_demand._MOVED.items()) <= told


def scene(folder: Path, body: str, track: str) -> Any:
    file = folder / "scene.toml"
    curves = body.replace("curves = [...]", f"curves = {CURVES}")
    grids = ", ".join(
        f'{{ kind = "bezier", control_points = {patch.control_points.tolist()} }}'
        for patch in patches()
    )
    text = SCENE.format(body=curves.replace("patches = [...]", f"patches = [{grids}]"), track=track)
    file.write_text(text, encoding="utf-8")
    return load_scene(file)


@pytest.mark.parametrize(("old", "new"), BODIES + TRACKS)
def test_a_scene_of_0_1_is_told_what_to_write(old: str, new: str, tmp_path: Path) -> None:
    body, track = 'shape = "sphere", radius = 1.0', "step = 0.01, duration = 0.1"
    parts = [(x, track) if "shape" in x else (body, f"{track}, {x}") for x in (old, new)]
    with pytest.raises(so.StandoffError) as caught:
        scene(tmp_path, *parts[0])
    kept = "leave it out" in str(caught.value)
    expected = set(WORD.findall(new)) - set(WORD.findall(old))
    assert kept or expected <= set(WORD.findall(str(caught.value)))
    scene(tmp_path, *parts[1])


def test_a_command_of_0_1_is_told_what_to_write(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    scene(tmp_path, 'shape = "sphere", radius = 1.0', "step = 0.01, duration = 0.1")
    run = ["track", str(tmp_path / "scene.toml"), "--law", "paper"]
    assert main([*run, "--predictor", "none"]) == 2
    assert "feedforward" in capsys.readouterr().err
    assert main([*run, "--feedforward", "false"]) != 2
