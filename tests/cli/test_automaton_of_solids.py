"""`standoff automaton` of a pair with a solid that need not be convex."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from test_track_of_solids import scene as scene

from standoff.automaton.branch_text import branches_mermaid, branches_text
from standoff.scene import load_scene, record


def test_what_the_solids_allow(standoff: Any, scene: Path) -> None:
    ended = standoff("automaton", scene)
    assert ended.code == 0, ended.err
    lines = ended.out.splitlines()
    assert lines[0] == "modes of each local minimum: 50 features of A × 1 of B = 50"
    assert (
        "A = bridge (prism): 10 faces, 24 edges, 16 vertices, 196 switches, too many to list"
        in (lines)
    )
    assert "B = ball (sphere): 1 vertex, no switches" in lines


def test_visited(standoff: Any, scene: Path) -> None:
    loaded = load_scene(scene)
    recording = record(loaded, loaded.settings.overridden({"minima": 0.75}))
    found = recording.automaton()
    asked = ("automaton", scene, "--visited", "--minima", 0.75)
    assert standoff(*asked) == (0, branches_text(found, ("bridge", "ball")) + "\n", "")
    ended = standoff(*asked, "--format", "mermaid")
    assert ended == (0, branches_mermaid(found, ("bridge", "ball")) + "\n", "")
    picture = scene.with_name("a.svg")
    assert standoff(*asked, "-o", picture) == (0, f"wrote {picture}\n", "")
    assert "A ball over two feet: modes of bridge and ball" in picture.read_text("utf-8")


def test_the_scene_may_say_how_far(standoff: Any, scene: Path) -> None:
    scene.write_text(scene.read_text("utf-8") + "minima = 0.75\n", encoding="utf-8")
    ended = standoff("automaton", scene, "--visited")
    assert ended.code == 0, ended.err
    assert ended.out.startswith("3 branches, one per local minimum")


@pytest.mark.parametrize(
    ("options", "piece"),
    [
        (["--visited"], "say up to which distance: add --minima LENGTH"),
        (["--minima", "0.75"], "--minima: it says which local minima are followed; add --visited"),
        (["--visited", "--minima", "-1"], "--minima: must be above zero, got -1"),
    ],
)
def test_refused(standoff: Any, scene: Path, options: list[str], piece: str) -> None:
    files = sorted(path.name for path in scene.parent.iterdir())
    ended = standoff("automaton", scene, *options)
    assert (ended.code, ended.out) == (2, "")
    assert piece in ended.err
    assert sorted(path.name for path in scene.parent.iterdir()) == files
