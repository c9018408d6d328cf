"""Scenes and the command line, for the tests of this folder."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest

from standoff.cli import main
from sweep.conftest import JOB, SCENE

PASSING = """version = 1
title = "Tool past a box"
length_unit = "cm"
[bodies.tool]
shape = "ellipsoid"
semi_axes = [0.3, 0.1, 0.1]
[bodies.part]
shape = "box"
size = [1.0, 1.0, 1.0]
[placements.tool]
position = [-1.0, 0.2, 0.9]
[motions.tool]
kind = "twist"
linear = [1.0, 0.0, 0.0]
angular = [0.0, 0.5, 1.0]
[pair]
a = "tool"
b = "part"
[track]
step = 0.02
duration = 2.0
"""


class Ended(NamedTuple):
    """How a command ended."""

    code: int
    out: str
    err: str


Standoff = Callable[..., Ended]


@pytest.fixture
def standoff(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Standoff:
    """Run the command line within this process; it does not say what it is about to do."""
    monkeypatch.setenv("STANDOFF_QUIET", "1")

    def run(*arguments: object) -> Ended:
        capsys.readouterr()
        code = main([str(argument) for argument in arguments])
        return Ended(code, *capsys.readouterr())

    return run


def lines_of(text: str) -> dict[str, str]:
    """What is printed, by the labels of its lines."""
    return {line[:14].strip(): line[14:] for line in text.splitlines() if line[:14].strip()}


@pytest.fixture
def job(tmp_path: Path) -> Path:
    """A sweep's job beside its scene."""
    (tmp_path / "scene.toml").write_text(SCENE, encoding="utf-8")
    file = tmp_path / "job.toml"
    file.write_text(JOB, encoding="utf-8")
    return file


@pytest.fixture
def passing(tmp_path: Path) -> Path:
    """A scene of a tool that passes a box, certified all along."""
    file = tmp_path / "passing.toml"
    file.write_text(PASSING, encoding="utf-8")
    return file


@pytest.fixture
def crossing(tmp_path: Path) -> Path:
    """The same, but the tool crosses the box: frames in between overlap."""
    file = tmp_path / "crossing.toml"
    file.write_text(PASSING.replace("-1.0, 0.2, 0.9", "-1.0, 0.2, 0.4"), encoding="utf-8")
    return file
