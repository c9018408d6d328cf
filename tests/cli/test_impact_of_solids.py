"""`standoff impact` of a scene whose body is a solid from a file."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from families.solid_shapes import socket
from standoff.solids import save_boundary

SCENE = """
version = 1
[bodies.shell]
body = "shell.json"
[bodies.tool]
shape = "sphere"
radius = 0.3
[motions.tool]
kind = "twist"
linear = [0.0, 0.1, 0.0]
[pair]
a = "shell"
b = "tool"
[track]
duration = 5.0
"""


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    save_boundary(tmp_path / "shell.json", socket(0.5, 0.8).boundary)
    file = tmp_path / "cage.toml"
    file.write_text(SCENE, encoding="utf-8")
    return file


def test_a_ball_meets_the_wall_of_its_cage(standoff: Any, scene: Path) -> None:
    ended = standoff("impact", scene)
    assert ended.code == 0
    assert "IMPACT" in ended.out
    assert "tool is in a cavity of shell" in ended.out
    told = json.loads(standoff("impact", scene, "--json", "--clearance", 0.1).out)
    assert told["impact"] == "IMPACT"
    assert told["cavity"] == "B"
    assert 1.0 - 1e-6 < told["time"] <= 1.0 + 1e-9
