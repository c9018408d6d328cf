"""What a scene may not say: each refused with its key, its value and the fix."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from standoff.scene import Scene, SceneError, load_scene

LoadText = Callable[[str], Scene]

BODIES = """
[bodies.a]
shape = "sphere"
radius = 0.1
[bodies.b]
shape = "sphere"
radius = 0.1
"""
PAIR = '[pair]\na = "a"\nb = "b"\n'
HEAD = f"version = 1\n{BODIES}{PAIR}"


def body(table: str) -> str:
    return f"version = 1\n[bodies.a]\n{table}\n"


def placed(table: str) -> str:
    return f"{HEAD}[placements.a]\n{table}\n"


def moved(table: str) -> str:
    return f"{HEAD}[motions.a]\n{table}\n"


def tracked(table: str) -> str:
    return f"{HEAD}[track]\n{table}\n"


# text, key of the complaint, pieces of its sentence
TOP = [
    ("", "", ["'version' is missing", "version = 1"]),
    ("version = 2", "version", ["is 2", "version = 1"]),
    ('version = "1"', "version", ["'1'"]),
    ("version = true", "version", ["True"]),
    ("versio = 1", "", ["'version' is missing", "rename 'versio'"]),
    ("version = 1\nbodys = 1", "bodys", ["did you mean 'bodies'?"]),
    ("version = 1", "bodies", ["no bodies", "[bodies.tool]"]),
    ("version = 1\nbodies = 3", "bodies", ["must be a table", "[bodies]", "got 3"]),
    ("version = 1\n[bodies]\na = 3", "bodies.a", ["must be a table", "[bodies.a]"]),
    (f"version = 1\n{BODIES}", "", ["'pair' is missing"]),
    (f"version = 1\n{BODIES}[free.a]", "free", ["a simulation", "`standoff simulate`", "[free]"]),
    (f"version = 1\n{BODIES}{PAIR}[free.a]", "free", ["unknown key 'free'"]),
    (f'version = 1\ntitle = ""\n{BODIES}{PAIR}', "title", ["string in quotes"]),
    (f"version = 1\nlength_unit = 1\n{BODIES}{PAIR}", "length_unit", ["string in quotes", "got 1"]),
    (f'version = 1\n{BODIES}[pair]\na = "a"', "pair", ["'b' is missing"]),
    (f'version = 1\n{BODIES}[pair]\na = "a"\nb = "a"', "pair", ["'a' is both"]),
    (
        f'version = 1\n{BODIES}[pair]\na = "a"\nb = "c"',
        "pair.b",
        ["unknown body 'c'", "'a'", "'b'"],
    ),
    (f'version = 1\n{BODIES}[pair]\na = "a"\nb = "b"\nc = "a"', "pair.c", ["unknown key 'c'"]),
    (f"{HEAD}[placements.c]", "placements.c", ["unknown body 'c'"]),
    (f'{HEAD}[motions.c]\nkind = "twist"', "motions.c", ["unknown body 'c'"]),
]

SHAPES = [
    (body(""), "bodies.a", ["'shape' is missing"]),
    (body('shpae = "box"'), "bodies.a", ["'shape' is missing", "rename 'shpae'"]),
    (body('shape = "elipsoid"'), "bodies.a.shape", ["did you mean 'ellipsoid'?"]),
    (body('shape = "qqq"'), "bodies.a.shape", ["unknown shape 'qqq'", "'lens'"]),
    (body('shape = "sphere"'), "bodies.a", ["'radius' is missing", "radius = "]),
    (body('shape = "sphere"\nradius = -1.5'), "bodies.a.radius", ["zero or above", "got -1.5"]),
    (body('shape = "sphere"\nradius = nan'), "bodies.a.radius", ["finite", "got nan"]),
    (body('shape = "sphere"\nradius = inf'), "bodies.a.radius", ["finite", "got inf"]),
    (body(f'shape = "sphere"\nradius = 1{"0" * 400}'), "bodies.a.radius", ["finite"]),
    (body('shape = "sphere"\nradius = "1"'), "bodies.a.radius", ["must be a number", "'1'"]),
    (body('shape = "sphere"\nradius = true'), "bodies.a.radius", ["must be a number", "True"]),
    (
        body('shape = "ellipsoid"\nsemi_axes = [1, 2]'),
        "bodies.a.semi_axes",
        ["3 numbers", "[1, 2]"],
    ),
    (body('shape = "ellipsoid"\nsemi_axes = 1'), "bodies.a.semi_axes", ["3 numbers", "got 1"]),
    (body('shape = "ellipsoid"\nsemi_axes = [1, nan, 1]'), "bodies.a.semi_axes[1]", ["finite"]),
    (body('shape = "ellipsoid"\nsemi_axes = [1, 0, 1]'), "bodies.a.semi_axes", ["above zero"]),
    (
        body('shape = "box"\nsize = [1, 1, 1]\nrounding = -1'),
        "bodies.a.rounding",
        ["zero or above"],
    ),
    (body('shape = "box"\nsize = [1, 1, 1]\nrounding = 2'), "bodies.a.rounding", ["2.0", "core"]),
    (body('shape = "lens"\nradius = 1\noffset = 1.5'), "bodies.a.offset", ["mpty lens", "1.5"]),
    (body('shape = "cap"\nradius = 1\noffset = 1.5'), "bodies.a.offset", ["offset = 1.5"]),
    (
        body('shape = "polytope"\nvertices = [[0,0,0],[1,0,0],[0,1,0],[1,1,0]]'),
        "bodies.a",
        ["flat polytope"],
    ),
    (
        body('shape = "polytope"\nvertices = [[0,0,0],[1,0,0]]'),
        "bodies.a.vertices",
        ["at least 4 points", "got 2"],
    ),
    (
        body('shape = "polytope"\nvertices = [[0,0,0],[1,0],[0,1,0],[1,1,0]]'),
        "bodies.a.vertices[1]",
        ["3 numbers", "[1, 0]"],
    ),
    (body('shape = "polytope"\nvertices = 3'), "bodies.a.vertices", ["a list", "got 3"]),
    (body('shape = "sphere"\nradius = 1\nscale = 0'), "bodies.a.scale", ["above zero"]),
    (body('shape = "sphere"\nradius = 1\nscale = [1, 2, 3]'), "bodies.a.scale", ["round skin"]),
    (body('shape = "point"\nscale = 1\naffine = [[1]]'), "bodies.a", ["'affine' and 'scale'"]),
    (body('shape = "point"\naffine = [[1, 0], [0, 1]]'), "bodies.a.affine[0]", ["3 or 4 numbers"]),
    (
        body('shape = "point"\naffine = [[1,0,0], [0,1,0], [0,0,1], [0,0,0]]'),
        "bodies.a.affine",
        ["3×3 or 4×4", "4 rows"],
    ),
    (
        body('shape = "lens"\nradius = 1\noffset = 0.4\naffine = [[1,0,0], [0,1,0], [0,0,0]]'),
        "bodies.a.affine",
        ["singular"],
    ),
    (body('shape = "planar_loop"\ncurves = []'), "bodies.a.curves", ["empty"]),
    (body('shape = "planar_loop"\ncurves = [3]'), "bodies.a.curves[0]", ["must be a table"]),
    (
        body('shape = "planar_loop"\ncurves = [{kind = "lien"}]'),
        "bodies.a.curves[0].kind",
        ["did you mean 'line'?"],
    ),
    (
        body('shape = "planar_loop"\ncurves = [{kind = "line", start = [0, 0], ende = [1, 0]}]'),
        "bodies.a.curves[0].ende",
        ["did you mean 'end'?"],
    ),
    (
        body('shape = "planar_loop"\ncurves = [{kind = "line", start = [0, 0], end = [0, 0]}]'),
        "bodies.a.curves[0]",
        ["different points"],
    ),
    (
        body(
            'shape = "planar_loop"\n'
            'curves = [{kind = "bezier", control_points = [[0, 0], [1, 0]], weights = [1, -1]}]'
        ),
        "bodies.a.curves[0].weights",
        ["positive"],
    ),
]


def curved(curve: str) -> str:
    return body(f'shape = "planar_loop"\ncurves = [{{{curve}}}]')


POINTS = "control_points = [[0, 0], [1, 0], [1, 1]]"
CURVES = [
    (
        curved(f'kind = "nurbs", {POINTS}, knots = [0, 0, 1, 0.5, 1, 1]'),
        "bodies.a.curves[0].knots",
        ["not sorted", "knot 2"],
    ),
    (
        curved(f'kind = "nurbs", {POINTS}, knots = [0, 0, 1]'),
        "bodies.a.curves[0].knots",
        ["3 knots for 3 control points", "give 5 to 13"],
    ),
    (
        curved(f'kind = "nurbs", {POINTS}, knots = [0, 0, 0, 1, 1, 1], weights = [1, -1, 1]'),
        "bodies.a.curves[0].weights",
        ["-1.0", "positive"],
    ),
    (curved(f'kind = "nurbs", {POINTS}'), "bodies.a.curves[0]", ["'knots' is missing"]),
    (
        curved('kind = "formula", x = "t", y = "sin(w)", start = 0, end = 1'),
        "bodies.a.curves[0].y",
        ["Unknown symbol 'w'", "Known: t"],
    ),
    (
        curved('kind = "formula", x = "t", y = "1/(t - 0.25)", start = 0, end = 1'),
        "bodies.a.curves[0]",
        ["pole", "t = 0.25"],
    ),
    (
        curved('kind = "formula", x = "t", y = "t**2", start = 0'),
        "bodies.a.curves[0]",
        ["'end' is missing"],
    ),
    (
        body('shape = "spindle"\nradius = 1\nlength = 3\npatches = 2'),
        "bodies.a",
        ["patches", "3"],
    ),
    (
        body('shape = "gore"\nradius = 1\nheight = 3\npatches = 3.5'),
        "bodies.a.patches",
        ["whole number above zero", "3.5"],
    ),
    (body('shape = "egg"\nradius = 1\nlength = 3\ntaper = 0.9'), "bodies.a", ["taper", "0.9"]),
    (
        body('shape = "hull_of_revolution"\ncurve = {kind = "lin"}'),
        "bodies.a.curve.kind",
        ["did you mean 'line'?"],
    ),
    (
        body(
            'shape = "hull_of_revolution"\ncurve = {kind = "line", start = [-1, 0], end = [1, 1]}'
        ),
        "bodies.a",
        ["axis"],
    ),
    (
        body('shape = "superellipsoid"\nsemi_axes = [1, 1, 1]\nexponents = [0.5, 2.5]'),
        "bodies.a.exponents[1]",
        ["2.5", "from 0.1 to 1.8"],
    ),
]

PLACEMENTS = [
    (placed("positon = [1, 2, 3]"), "placements.a.positon", ["did you mean 'position'?"]),
    (placed("quaternion = [1, 0, 0, 0]"), "placements.a.quaternion", ["'quaternion_"]),
    (placed("position = [1]"), "placements.a.position", ["2 or 3 numbers"]),
    (placed("position = [nan, 0, 0]"), "placements.a.position[0]", ["finite"]),
    (
        placed("angle = 1\nrotation_vector = [1, 0, 0]"),
        "placements.a",
        ["'rotation_vector' and 'angle'", "keep one"],
    ),
    (
        placed("quaternion_wxyz = [1, 1, 0, 0]"),
        "placements.a.quaternion_wxyz",
        ["norm 1.41421"],
    ),
    (
        placed("matrix = [[1, 0, 0], [0, 2, 0], [0, 0, 1]]"),
        "placements.a.matrix",
        ["not orthonormal"],
    ),
    (
        placed("matrix = [[1, 0, 0], [0, 1, 0], [0, 0, -1]]"),
        "placements.a.matrix",
        ["mirrored"],
    ),
    (
        placed(
            "position = [0, 0, 0]\n"
            "matrix = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]"
        ),
        "placements.a.matrix",
        ["remove 'position'"],
    ),
]

MOTIONS = [
    (moved(""), "motions.a", ["'kind' is missing"]),
    (moved('kind = "twits"'), "motions.a.kind", ["did you mean 'twist'?"]),
    (moved('kind = "twist"'), "motions.a", ["'linear' or 'angular'"]),
    (moved('kind = "twist"\nlinaer = [1, 0, 0]'), "motions.a.linaer", ["did you mean 'linear'?"]),
    (moved('kind = "twist"\nlinear = [inf, 0, 0]'), "motions.a.linear[0]", ["finite"]),
    (
        moved('kind = "twist"\nlinear = [1, 0, 0]\nframe = "tool"'),
        "motions.a.frame",
        ["unknown frame 'tool'", "'body' or 'world'"],
    ),
    (moved('kind = "screw"\naxis = [0, 0, 0]\nangular_rate = 1'), "motions.a.axis", ["axis"]),
    (moved('kind = "helix"\nradius = 0\npitch = 1\nrate = 1'), "motions.a.radius", ["above zero"]),
    (moved('kind = "spiral"\nradius = -1\ngrowth = 1\nrate = 1'), "motions.a.radius", ["got -1"]),
    (
        moved('kind = "helix"\nradius = 1\npitch = 1\nrate = 1\norientation = "turnin"'),
        "motions.a.orientation",
        ["did you mean 'turning'?"],
    ),
    (
        moved('kind = "helix"\nradius = 1\npitch = 1\nrate = 1\n[placements.a]\nposition = [0, 0]'),
        "motions.a.kind",
        ["remove the placement", "'offset'"],
    ),
    (
        moved('kind = "helix"\nradius = 1\npitch = 1\nrate = 1\nspin = 3'),
        "motions.a.spin",
        ["3 numbers", "got 3"],
    ),
    (moved('kind = "samples"'), "motions.a", ["'file' is missing"]),
    (moved('kind = "samples"\nfile = "hnad.tum"'), "motions.a.file", ["did you mean 'hand.tum'?"]),
    (moved('kind = "samples"\nfile = "x/hand.tum"'), "motions.a.file", ["folder does not exist"]),
    (moved('kind = "samples"\nfile = "."'), "motions.a.file", ["is a folder"]),
    (moved('kind = "samples"\nfile = "hand.xyz"'), "motions.a.file", ["'.xyz'", ".tum"]),
    (moved('kind = "samples"\nfile = "unsorted.tum"'), "motions.a.file", ["line 3", "sort"]),
    (moved('kind = "samples"\nfile = "nan.tum"'), "motions.a.file", ["line 2", "nan"]),
    (moved('kind = "samples"\nfile = "short.tum"'), "motions.a.file", ["line 1", "columns"]),
    (
        moved('kind = "samples"\nfile = "hand.tum"\nstart = "first"'),
        "motions.a.start",
        ["a number or 'file'", "'first'"],
    ),
    (
        moved('kind = "samples"\nfile = "hand.tum"\noffset = {poistion = [1, 0, 0]}'),
        "motions.a.offset.poistion",
        ["did you mean 'position'?"],
    ),
]

TRACK = [
    (tracked('law = "papr"'), "track.law", ["did you mean 'paper'?"]),
    (tracked('predictor = "seccant"'), "track.predictor", ["did you mean 'secant'?"]),
    (tracked('law = "paper"\nintegrator = "rk5"'), "track.integrator", ["did you mean 'rk4'?"]),
    (tracked('law = "paper"\ngain = 0'), "track.gain", ["above zero"]),
    (tracked('law = "paper"\ngain = -3'), "track.gain", ["above zero", "got -3"]),
    (tracked("step = 0"), "track.step", ["above zero"]),
    (tracked('step = "sampels"'), "track.step", ["a number or 'samples'", "'sampels'"]),
    (tracked("tolerance = 0"), "track.tolerance", ["above zero"]),
    (tracked("duration = -1"), "track.duration", ["above zero"]),
    (tracked("start = inf"), "track.start", ["finite"]),
    (tracked("stpe = 1"), "track.stpe", ["did you mean 'step'?"]),
]


@pytest.mark.parametrize(
    ("text", "key", "pieces"), [*TOP, *SHAPES, *CURVES, *PLACEMENTS, *MOTIONS, *TRACK]
)
def test_refusal(
    load_text: LoadText, tmp_path: Path, text: str, key: str, pieces: list[str]
) -> None:
    (tmp_path / "hand.tum").write_text("0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n")
    (tmp_path / "hand.xyz").write_text("0 0 0 0 0 0 0 1\n")
    (tmp_path / "unsorted.tum").write_text("0 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n")
    (tmp_path / "nan.tum").write_text("0 0 0 0 0 0 0 1\n1 nan 0 0 0 0 0 1\n")
    (tmp_path / "short.tum").write_text("0 0 0 0 0 0 1\n")
    with pytest.raises(SceneError) as caught:
        load_text(text)
    assert caught.value.key == key
    for piece in pieces:
        assert piece in caught.value.problem
    assert str(caught.value).startswith(str(tmp_path / "scene.toml"))


def test_a_broken_file_is_told_with_its_line(load_text: LoadText) -> None:
    with pytest.raises(SceneError, match=r"is not TOML.*line 2"):
        load_text("version = 1\nbodies = = 3\n")


def test_a_file_that_is_no_text(tmp_path: Path) -> None:
    (tmp_path / "scene.toml").write_bytes(b"version = 1 # \xff")
    with pytest.raises(SceneError, match=r"UTF-8 \(byte 14\)"):
        load_scene(tmp_path / "scene.toml")


def test_a_missing_scene_names_the_one_beside_it(tmp_path: Path) -> None:
    (tmp_path / "demo.toml").write_text(HEAD)
    with pytest.raises(SceneError, match=r"did you mean 'demo\.toml'\?"):
        load_scene(tmp_path / "dmo.toml")
    with pytest.raises(SceneError, match="is a folder"):
        load_scene(tmp_path)
    with pytest.raises(SceneError, match="folder does not exist"):
        load_scene(tmp_path / "no" / "demo.toml")
