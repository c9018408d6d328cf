"""`standoff check`: what it tells of a body, and what it refuses."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import pytest
from matplotlib.image import imread

import standoff as so
from standoff.cli.check import report_rows
from standoff.geometry import ellipsoid_patches
from standoff.scene import load_scene

Standoff = Callable[..., Any]

BOX = 'shape = "box", size = [1, 2, 3]'


def test_a_shape_in_a_line(standoff: Standoff) -> None:
    ended = standoff("check", BOX)
    assert (ended.code, ended.err) == (0, "")
    rows = [line.split(maxsplit=1) for line in ended.out.splitlines() if line.strip()]
    found = {what: rest[0].strip() for what, *rest in rows if rest}
    assert found["faces"] == "6"
    assert (found["edges"], found["vertices"]) == ("12", "8")
    assert found["size"] == f"{14**0.5:.9g} m"


def test_what_was_proven(standoff: Standoff, tmp_path: Path) -> None:
    told = " ".join(standoff("check", BOX).out.split())
    assert "convex patches 6 Plane by theorem" in told
    assert "hemispheres normals of 6 of 6 patches fit an open one" in told
    assert "sharpest edge 90° inside, edge 0" in told
    assert "closed yes" in told
    patches = list(ellipsoid_patches(0.3, 0.2, 0.1))
    content = [
        {
            "kind": "bezier",
            "control_points": patch.control_points.tolist(),
            "weights": patch.weights.tolist(),
        }
        for patch in patches
    ]
    file = tmp_path / "egg.json"
    file.write_text(json.dumps({"format": "standoff-patches", "version": 1, "patches": content}))
    told = " ".join(standoff("check", file).out.split())
    assert "egg: patches" in told
    assert "edges 12, 12 of them smooth" in told
    assert "convex patches 6 BezierPatch by Bernstein bounds over the whole patch" in told
    body = so.Body.from_patches(patches)
    assert f"slack {body.check().slack:.3g} m, taken off" in told
    told = " ".join(standoff("check", 'shape = "halfspace"').out.split())
    assert "size unbounded" in told
    assert "closed no: it is unbounded" in told
    assert "nan" not in told


def test_the_worst_patch_is_named() -> None:
    body = so.shapes.cylinder(1.0, 2.0)
    checks = [
        replace(check, defect=1e-7 * check.face, place=(0.25, 0.5))
        for check in body.check().patches
    ]
    dented = replace(body, report=replace(body.check(), patches=tuple(checks)))
    rows = dict(report_rows(dented, "cm"))
    assert rows["worst patch"] == "face 2 at u = 0.25, v = 0.5: may dent by 2e-07 cm"
    assert rows["hemispheres"] == "normals of 2 of 3 patches fit an open one"
    assert "worst patch" not in dict(report_rows(body, "cm"))


def test_json_is_the_report(standoff: Standoff) -> None:
    facts = json.loads(standoff("check", BOX, "--json").out)
    body = so.shapes.box(1, 2, 3)
    assert facts["report"] == json.loads(json.dumps(asdict(body.check())))
    assert facts["digest"] == body.digest
    assert facts["shape"] == "box"


def test_the_bodies_of_a_scene(standoff: Standoff, passing: Path) -> None:
    ended = standoff("check", passing)
    assert ended.code == 0
    assert "tool: ellipsoid" in ended.out
    assert "part: box" in ended.out
    assert " cm" in ended.out
    facts = json.loads(standoff("check", passing, "--json").out)
    assert [body["body"] for body in facts["bodies"]] == list(load_scene(passing).bodies)
    facts = json.loads(standoff("check", passing, "--json", "--body", "part").out)
    assert facts["report"]["vertices"] == 8


@pytest.mark.parametrize(
    ("arguments", "piece"),
    [
        (["nothing"], "'nothing' is not a scene (.toml), a file of patches (.json) or a shape"),
        (["no.toml"], "no file 'no.toml'"),
        (["no.json"], "no file 'no.json'"),
        (["passing.toml", "--body", "tol"], "--body: unknown body 'tol'; did you mean 'tool'?"),
        (['shape = "bxo"'], "body.shape: unknown shape 'bxo'; did you mean 'box'?"),
        (['shape = "sphere", radius = -1'], "body.radius: must be zero or above, got -1"),
        (["shape = box"], "is not a shape in the form that scenes use"),
        (['shape = "lens", radius = 1, offset = 2'], "body.offset: Empty lens"),
    ],
)
def test_refused(
    standoff: Standoff,
    passing: Path,
    monkeypatch: pytest.MonkeyPatch,
    arguments: list[str],
    piece: str,
) -> None:
    monkeypatch.chdir(passing.parent)
    ended = standoff("check", *arguments)
    assert (ended.code, ended.out) == (2, "")
    assert ended.err.startswith("standoff: ")
    assert ended.err.count("\n") == 1
    assert piece in ended.err


def test_pictures_of_each_body(standoff: Standoff, passing: Path) -> None:
    ended = standoff("check", passing, "--plot", passing.with_name("b.png"))
    assert ended.code == 0
    assert f"wrote {passing.with_name('b-tool.png')}" in ended.out
    for name in ("b-tool.png", "b-part.png"):
        assert imread(passing.with_name(name)).std() > 0.05
    target = passing.with_name("b.svg")
    facts = json.loads(standoff("check", passing, "--body", "part", "--plot", target, "--json").out)
    assert facts["files"] == [str(target)]
    drawn = target.read_text()
    for text in ("part: box, 6 faces, 12 edges, 8 vertices", "face 5", "e0", "v0", "0.2 cm"):
        assert f"<!-- {text} -->" in drawn
    # All six faces of a box are seen from two opposite sides, three from each.
    assert sorted(set(re.findall("<!-- (face .) -->", drawn))) == [f"face {k}" for k in range(6)]


@pytest.mark.parametrize(
    ("shape", "texts"),
    [
        (
            'shape = "planar_loop", curves = [{kind = "line", start = [0, 0], end = [1, 0]}, '
            '{kind = "bezier", control_points = [[1, 0], [1, 1], [0, 0]]}]',
            ["edge 0", "edge 1", "vertex 1", "x (m)", "outward normal"],
        ),
        ('shape = "sphere", radius = 2', ["v0", "skin at radius 2"]),
        ('shape = "halfspace"', ["face 0", "halfspace, 1 face; unbounded, only a part is shown"]),
        ('shape = "cone", radius = 1, height = 2', ["face 0", "face 1", "e0", "v0"]),
    ],
)
def test_pictures_of_all_kinds(
    standoff: Standoff, tmp_path: Path, shape: str, texts: list[str]
) -> None:
    target = tmp_path / "b.svg"
    assert standoff("check", shape, "--plot", target).code == 0
    for text in texts:
        assert f"<!-- {text} -->" in target.read_text()


def test_pictures_that_are_refused(standoff: Standoff, passing: Path) -> None:
    text = passing.read_text().replace('"tool"', '"a b"').replace('"part"', '"a.b"')
    passing.write_text(text.replace(".tool]", '."a b"]').replace(".part]", '."a.b"]'))
    for target, piece in (
        ("b.bmp", "ends in .png or .svg or .pdf"),
        ("no/b.png", "does not exist"),
        ("b.png", "two bodies would be drawn to this file"),
    ):
        ended = standoff("check", passing, "--plot", passing.parent / target)
        assert (ended.code, ended.out) == (2, "")
        assert piece in ended.err
    assert [path.name for path in passing.parent.iterdir()] == ["passing.toml"]
