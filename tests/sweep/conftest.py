"""Jobs over small scenes, for the tests of this folder."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from standoff.sweep.job import Job
from standoff.sweep.reading import load_job

SCENE = """version = 1
title = "Two ellipsoids"
length_unit = "cm"
[bodies.tool]
shape = "ellipsoid"
semi_axes = [3.0, 1.0, 0.8]
[bodies.part]
shape = "ellipsoid"
semi_axes = [2.0, 2.5, 1.5]
[placements.tool]
position = [1.0, 0.5, 7.0]
rotation_vector = [0.3, -0.2, 0.4]
[pair]
a = "tool"
b = "part"
"""

PARAMETERS = """
[parameters.x]
moves = "tool"
what = "x"
from = -4.0
to = 5.0
[parameters.z]
moves = "tool"
what = "z"
from = -5.0
to = 2.0
[parameters.any]
moves = "tool"
rotation = "uniform"
[parameters.tilt]
moves = "part"
what = "turn_y"
from_degrees = -30.0
to_degrees = 60.0
"""

TOP = 'version = 1\nscene = "scene.toml"\n'

JOB = f"""{TOP}{PARAMETERS}
[sampler]
kind = "sobol"
rows = 3000
seed = 5
[keep]
worst = 40
below = 0.5
most_below = 100
histogram = {{ from = 0.0, to = 5.0, bins = 50 }}
[shards]
rows = 700
"""

Make = Callable[..., Job]


@pytest.fixture
def make(tmp_path: Path) -> Make:
    """Write a job beside a scene of two ellipsoids, and read it."""

    def made(text: str = JOB, scene: str = SCENE) -> Job:
        (tmp_path / "scene.toml").write_text(scene, encoding="utf-8")
        file = tmp_path / "job.toml"
        file.write_text(text, encoding="utf-8")
        return load_job(file)

    return made
