"""Scenes and jobs whose bodies change from row to row, for the tests of this folder."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from standoff.scene.reader import SceneTable
from standoff.sweep.parameters import Parameter
from standoff.sweep.subjects.shaped_body import ShapedBody

CUBE = [[x, y, z] for x in (-1.0, 1.0) for y in (-0.8, 0.8) for z in (-0.5, 0.5)]

TABLES: Mapping[str, Mapping[str, Any]] = {
    "point": {},
    "segment": {"length": 2.0},
    "sphere": {"radius": 1.0, "rounding": 0.2},
    "ellipsoid": {"semi_axes": [1.0, 2.0, 0.7]},
    "capsule": {"radius": 0.5, "length": 2.0, "rounding": 0.25},
    "cylinder": {"radius": 1.0, "height": 1.5},
    "cone": {"radius": 1.0, "height": 1.5, "rounding": 0.1},
    "box": {"size": [1.0, 2.0, 1.5], "rounding": 0.2},
    "polygon": {"vertices": [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.5, 1.0, 0.0]]},
    "polytope": {"vertices": CUBE},
    "lens": {"radius": 1.5, "offset": 0.5},
    "cap": {"radius": 1.5, "offset": 0.5},
    "halfspace": {"normal": [0.0, 0.6, 0.8], "offset": 0.3},
    "rounded_polytope": {"vertices": CUBE, "rounding": 0.2},
    "spindle": {"radius": 0.5, "length": 3.0},
    "gore": {"radius": 0.5, "height": 3.0},
    "egg": {"radius": 0.8, "length": 2.5},
    "superellipsoid": {"semi_axes": [1.0, 2.0, 0.7], "exponents": [0.8, 0.6]},
}
"""A table of each shape whose numbers can change, as a scene has it."""


def table_of(shape: str) -> SceneTable:
    return SceneTable({"shape": shape, **TABLES[shape]}, path="bodies.tool")


def shaped_of(shape: str, *whats: str) -> ShapedBody:
    parameters = [Parameter(what, "tool", what, shape=True) for what in whats]
    return ShapedBody("tool", table_of(shape), parameters)


TOOL_AND_BALL = """version = 1
length_unit = "cm"
[bodies.tool]
shape = "ellipsoid"
semi_axes = [3.0, 1.0, 0.8]
[bodies.ball]
shape = "sphere"
radius = 1.0
[placements.tool]
position = [0.5, -0.4, 4.0]
rotation_vector = [0.3, -0.2, 0.4]
[pair]
a = "tool"
b = "ball"
"""

SHAPES = """version = 1
scene = "scene.toml"
[parameters.r]
shapes = "ball"
what = "radius"
from = 0.5
to = 2.0
[parameters.a]
shapes = "tool"
what = "semi_axes.1"
from = 1.0
to = 4.0
[parameters.c]
shapes = "tool"
what = "semi_axes.3"
from = 0.5
to = 1.5
[parameters.z]
moves = "tool"
what = "z"
from = -1.0
to = 2.0
"""

SHAPE_JOB = f"""{SHAPES}
[sampler]
kind = "random"
rows = 60
seed = 4
[keep]
worst = 5
"""
