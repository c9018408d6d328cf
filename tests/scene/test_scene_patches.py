"""Patches of the format: inline, from a file, by formula; what is refused, with its place."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from standoff import Body
from standoff.geometry import (
    BezierPatch,
    FormulaSurface,
    NurbsSurface,
    Surface,
    ellipsoid_patches,
)
from standoff.scene import Scene, SceneError
from standoff.scene.patches import PATCHES, read_patches
from standoff.scene.reader import SceneTable

LoadText = Callable[[str], Scene]

OTHER = (
    '[bodies.b]\nshape = "point"\n[placements.b]\nposition = [9, 9, 9]\n[pair]\na = "a"\nb = "b"\n'
)

NET = [[[float(i), float(j), 0.1 * i * j] for j in range(3)] for i in range(4)]
WEIGHTS = [[1.0 + 0.1 * i + 0.2 * j for j in range(3)] for i in range(4)]
KNOTS_U = [0.0, 0.0, 0.0, 0.4, 1.0, 1.0, 1.0]
KNOTS_V = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]
NURBS: dict[str, Any] = {
    "control_points": NET,
    "weights": WEIGHTS,
    "knots_u": KNOTS_U,
    "knots_v": KNOTS_V,
}
FORMULA: dict[str, Any] = {
    "kind": "formula",
    "x": "a*cos(u)*cos(v)",
    "y": "a*sin(u)*cos(v)",
    "z": "sin(v)",
    "domain": [0.0, 1.0, -0.5, 0.5],
    "parameters": {"a": 2.0},
}

CASES: list[tuple[dict[str, Any], Callable[[], Surface]]] = [
    (NURBS, lambda: NurbsSurface(NET, KNOTS_U, KNOTS_V, WEIGHTS)),
    (
        {key: value for key, value in NURBS.items() if key != "weights"} | {"kind": "nurbs"},
        lambda: NurbsSurface(NET, KNOTS_U, KNOTS_V),
    ),
    (
        {"kind": "bezier", "control_points": NET, "weights": WEIGHTS},
        lambda: BezierPatch(NET, WEIGHTS),
    ),
    (
        FORMULA,
        lambda: FormulaSurface(
            "a*cos(u)*cos(v)", "a*sin(u)*cos(v)", "sin(v)", (0.0, 1.0, -0.5, 0.5), {"a": 2.0}
        ),
    ),
]


@pytest.mark.parametrize(("content", "build"), CASES)
def test_a_patch_is_the_one_that_python_builds(
    content: dict[str, Any], build: Callable[[], Surface]
) -> None:
    (mine,), theirs = read_patches(SceneTable({"patches": [content]})), build()
    assert type(mine) is type(theirs)
    assert mine.domain == theirs.domain
    u0, u1, v0, v1 = theirs.domain
    for s in (0.0, 0.3, 1.0):
        u, v = u0 + s * (u1 - u0), v0 + (1.0 - s) * (v1 - v0)
        np.testing.assert_array_equal(mine.jet(u, v), theirs.jet(u, v))


def test_every_kind_is_among_the_cases() -> None:
    assert {content.get("kind", "nurbs") for content, _ in CASES} == set(PATCHES)


def ellipsoid_file(path: Path) -> list[BezierPatch]:
    patches = list(ellipsoid_patches(0.3, 0.2, 0.1))
    content = {
        "format": "standoff-patches",
        "version": 1,
        "patches": [
            {
                "kind": "bezier",
                "control_points": patch.control_points.tolist(),
                "weights": patch.weights.tolist(),
            }
            for patch in patches
        ],
    }
    path.write_text(json.dumps(content))
    return patches


def test_a_body_from_a_file(load_text: LoadText, tmp_path: Path) -> None:
    patches = ellipsoid_file(tmp_path / "e.json")
    table = '[bodies.a]\nshape = "patches"\nfile = "e.json"\n'
    body = load_text(f"version = 1\n{table}{OTHER}").bodies["a"]
    assert body.digest == Body.from_patches(patches, name="patches").digest
    assert (body.name, body.n_faces, body.check().smooth_edges) == ("patches", 6, 12)
    rounded = load_text(f"version = 1\n{table}rounding = 0.1\ntolerance = 1e-6\n{OTHER}").bodies[
        "a"
    ]
    assert rounded.radius == 0.1


def test_what_may_be_joined_and_dented(load_text: LoadText, tmp_path: Path) -> None:
    file = tmp_path / "e.json"
    ellipsoid_file(file)
    content = json.loads(file.read_text())
    # One patch lifted off the others by 1e-5, outwards.
    for row in content["patches"][0]["control_points"]:
        for point in row:
            point[0] += 1e-5
    file.write_text(json.dumps(content))
    table = 'version = 1\n[bodies.a]\nshape = "patches"\nfile = "e.json"\n'
    with pytest.raises(SceneError, match=r"bodies\.a: .*1e-05"):
        load_text(f"{table}{OTHER}")
    with pytest.raises(SceneError, match="convexity_tolerance"):
        load_text(f"{table}tolerance = 1e-4\nconvexity_tolerance = 1e-10\n{OTHER}")
    allowed = "tolerance = 1e-4\nconvexity_tolerance = 1e-3\n"
    report = load_text(f"{table}{allowed}{OTHER}").bodies["a"].check()
    assert (report.sewing_tolerance, report.convexity_tolerance) == (1e-4, 1e-3)
    assert report.sewing_residual > 9e-6
    assert report.slack > 1e-5


def test_a_body_of_formulas(load_text: LoadText) -> None:
    # A ball, cut from pole to pole into four.
    patches = "".join(
        "[[bodies.a.patches]]\nkind = 'formula'\nx = 'r*cos(u)*cos(v)'\ny = 'r*sin(u)*cos(v)'\n"
        f"z = 'r*sin(v)'\nparameters = {{r = 0.5}}\n"
        f"domain = [{k * np.pi / 2!r}, {(k + 1) * np.pi / 2!r}, {-np.pi / 2!r}, {np.pi / 2!r}]\n"
        for k in range(4)
    )
    scene = load_text(f'version = 1\n[bodies.a]\nshape = "patches"\n{patches}{OTHER}')
    body = scene.bodies["a"]
    # a gore with both poles fits no open hemisphere: each is halved at the equator
    assert (body.n_faces, body.n_edges, body.n_vertices) == (8, 12, 6)


def patched(**changes: Any) -> dict[str, Any]:
    """The NURBS patch with some keys changed; None takes a key away."""
    changed = NURBS | changes
    return {key: value for key, value in changed.items() if value is not None}


def with_point(i: int, j: int, point: Any) -> list[list[Any]]:
    net: list[list[Any]] = [[list(entry) for entry in row] for row in NET]
    net[i][j] = point
    return net


NOT_A_NUMBER = float("nan")

# a patch, key below it, pieces of the sentence
BAD_PATCHES = [
    (patched(knots_u=[0.0, 0.0, 0.0, 0.6, 0.4, 1.0, 1.0]), "knots_u", ["not sorted", "knot 3"]),
    (patched(knots_v=KNOTS_V[:-2]), "knots_v", ["4 knots", "degree 0", "give 5 to 13"]),
    (patched(knots_v=[0.0, *KNOTS_V]), "knots_v", ["7 knots", "degree 3", "at least 4"]),
    (
        patched(knots_u=[0.0, 0.0, 0.0, NOT_A_NUMBER, 1.0, 1.0, 1.0]),
        "knots_u[3]",
        ["finite", "nan"],
    ),
    (
        patched(weights=[[1.0] * 3, [1.0, 0.0, 1.0], *WEIGHTS[2:]]),
        "weights",
        ["(1, 1)", "positive"],
    ),
    (patched(weights=[[1.0] * 3, [1.0, -2.0, 1.0], *WEIGHTS[2:]]), "weights", ["-2.0", "positive"]),
    (patched(weights=WEIGHTS[:3]), "weights", ["(3, 3)", "4 by 3"]),
    (patched(weights=[[1.0] * 2, *WEIGHTS[1:]]), "weights[1]", ["3 entries", "weights[0] has 2"]),
    (
        patched(control_points=with_point(2, 1, [0.0, NOT_A_NUMBER, 0.0])),
        "control_points[2][1][1]",
        ["finite", "nan"],
    ),
    (patched(control_points=with_point(2, 1, [0.0, 1.0])), "control_points[2][1]", ["3 numbers"]),
    (patched(control_points=with_point(2, 1, "x")), "control_points[2][1]", ["3 numbers", "'x'"]),
    (patched(control_points=NET[0]), "control_points[0][0]", ["3 numbers"]),
    (patched(control_points=[]), "control_points", ["empty"]),
    (patched(control_points=[[]]), "control_points[0]", ["0 entries"]),
    (patched(control_points=[NET[0], NET[1][:2]]), "control_points[1]", ["2 entries", "has 3"]),
    (patched(control_points=None), "", ["'control_points' is missing"]),
    (patched(knots_u=None), "", ["'knots_u' is missing"]),
    (patched(knot_u=1), "knot_u", ["unknown key 'knot_u'; did you mean 'knots_u'?"]),
    (patched(kind="nurb"), "kind", ["unknown kind 'nurb'; did you mean 'nurbs'?"]),
    (patched(kind="bezier"), "knots_u", ["unknown key 'knots_u'"]),
    (FORMULA | {"x": "a*cos(u)*w"}, "x", ["Unknown symbol 'w'", "Known: u, v"]),
    (FORMULA | {"z": "1/(v - 0.25)"}, "", ["pole", "v = 0.25", "cut the domain"]),
    (FORMULA | {"y": "sin(u"}, "y", ["syntax error"]),
    (FORMULA | {"y": True}, "y", ["must be a number", "True"]),
    (FORMULA | {"domain": [0.0, 0.0, 0.0, 1.0]}, "domain", ["empty", "u0 < u1"]),
    (FORMULA | {"domain": [0.0, 1.0]}, "domain", ["4 numbers"]),
    (FORMULA | {"parameters": {"a": "2"}}, "parameters.a", ["must be a number", "'2'"]),
    (FORMULA | {"parameters": 2}, "parameters", ["must be"]),
    (3, "", ["must be"]),
]


def inline(value: Any) -> str:
    """A value as TOML writes it."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {inline(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(inline, value)) + "]"
    return json.dumps(value).replace("NaN", "nan")


@pytest.mark.parametrize(("patch", "key", "pieces"), BAD_PATCHES)
@pytest.mark.parametrize("in_file", [False, True], ids=["inline", "file"])
def test_a_patch_that_is_refused(
    load_text: LoadText, tmp_path: Path, patch: Any, key: str, pieces: list[str], in_file: bool
) -> None:
    place = ".".join(filter(None, ["patches[1]", key]))
    if in_file:
        content = {"format": "standoff-patches", "version": 1, "patches": [NURBS, patch]}
        (tmp_path / "p.json").write_text(json.dumps(content))
        given = 'file = "p.json"'
    else:
        given = f"patches = {inline([NURBS, patch])}"
        place = f"bodies.a.{place}"
    with pytest.raises(SceneError) as caught:
        load_text(f'version = 1\n[bodies.a]\nshape = "patches"\n{given}\n')
    assert caught.value.key == place
    assert caught.value.file == tmp_path / ("p.json" if in_file else "scene.toml")
    for piece in pieces:
        assert piece in caught.value.problem
    if in_file:  # then nothing is said in TOML
        assert "add a line" not in caught.value.problem
        assert "[[" not in caught.value.problem


GOOD = json.dumps({"format": "standoff-patches", "version": 1, "patches": [NURBS]}, indent=1)

# content of the file, key, pieces of the sentence
BAD_FILES = [
    (GOOD[: len(GOOD) // 2], "", ["is not JSON", "line", "column", "cut off"]),
    (GOOD[:-2], "", ["is not JSON", "cut off"]),
    ("", "", ["is not JSON", "line 1", "cut off"]),
    (GOOD.replace('"version": 1', '"version": 1 2'), "", ["is not JSON", "line 3"]),
    ("[1]", "", ["must be an object", "[1]"]),
    ("\xff", "", ["UTF-8"]),
    (GOOD.replace("standoff-patches", "standoff-patch"), "format", ["'standoff-patches'"]),
    (GOOD.replace('"version": 1', '"version": 2'), "version", ["is 2", "reads version 1"]),
    (GOOD.replace('"version": 1', '"version": true'), "version", ["is True"]),
    (GOOD.replace('"version": 1,', ""), "", ["'version' is missing", 'add "version"']),
    (GOOD.replace('"patches"', '"patchs"'), "patchs", ["did you mean 'patches'?"]),
    (GOOD.replace('"version": 1', '"version": 1, "version": 1'), "", ["'version' appears twice"]),
    ('{"format": "standoff-patches", "version": 1}', "", ["'patches' is missing"]),
    ('{"format": "standoff-patches", "version": 1, "patches": []}', "patches", ["empty"]),
    ('{"format": "standoff-patches", "version": 1, "patches": {}}', "patches", ["a list"]),
]


@pytest.mark.parametrize(("content", "key", "pieces"), BAD_FILES)
def test_a_file_that_is_refused(
    load_text: LoadText, tmp_path: Path, content: str, key: str, pieces: list[str]
) -> None:
    (tmp_path / "p.json").write_bytes(content.encode("latin-1"))
    with pytest.raises(SceneError) as caught:
        load_text('version = 1\n[bodies.a]\nshape = "patches"\nfile = "p.json"\n')
    assert (caught.value.file, caught.value.key) == (tmp_path / "p.json", key)
    for piece in pieces:
        assert piece in caught.value.problem


def test_patches_or_a_file(load_text: LoadText, tmp_path: Path) -> None:
    ellipsoid_file(tmp_path / "pebble.json")
    for table, key, piece in (
        ("", "bodies.a", "'patches' is missing"),
        ('file = "peble.json"', "bodies.a.file", "did you mean 'pebble.json'?"),
        (f"file = 'pebble.json'\npatches = {inline([NURBS])}", "bodies.a", "keep one of them"),
        (f"patches = {inline([NURBS])}", "bodies.a", "patch 0"),
        ("file = 'pebble.json'\ntolerance = 0", "bodies.a.tolerance", "above zero"),
        ("file = 'pebble.json'\nrounding = -1", "bodies.a.rounding", "zero or above"),
    ):
        with pytest.raises(SceneError) as caught:
            load_text(f'version = 1\n[bodies.a]\nshape = "patches"\n{table}\n')
        assert caught.value.key == key
        assert piece in caught.value.problem
