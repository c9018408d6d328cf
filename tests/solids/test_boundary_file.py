"""A finished boundary comes back from its file, and a damaged file is refused."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import standoff as so
from standoff.bodies import Body, Boundary, Edge, Face
from standoff.bodies.assembly import joined_parts
from standoff.bodies.body import proven_again
from standoff.bodies.boundary import made_boundary
from standoff.errors import StandoffError
from standoff.geometry import (
    ConicArc,
    Cylinder,
    NurbsCurve,
    Plane,
    Revolution,
    Torus,
    ellipsoid_patches,
)
from standoff.solids import boundary_file, open_boundary, save_boundary

X, Y, Z = np.eye(3)


def bolt() -> Boundary:
    def circle(radius: float, height: float) -> Edge:
        return Edge(ConicArc(height * Z, radius * X, radius * Y))

    def level(height: float, *loop: tuple[int, int]) -> Face:
        return Face((Plane.through(height * Z, X, Y),), loop)

    def wall(radius: float, *loop: tuple[int, int]) -> Face:
        return Face((Cylinder(np.diag([radius, radius, 1.0]), np.zeros(3)),), loop)

    edges = [circle(1, 0), circle(1, 3), circle(2, 3), circle(2, 4)]
    faces = [
        level(0, (0, 1)),
        wall(1, (0, 1), (1, 1)),
        level(3, (1, 1), (2, 1)),
        wall(2, (2, 1), (3, 1)),
        level(4, (3, 1)),
    ]
    return Boundary.from_brep(edges=edges, faces=faces, name="bolt")


def vase() -> Boundary:
    profile = NurbsCurve(
        [(0, 0, -1), (0.9, 0, -1), (0.3, 0, 0.2), (0.8, 0, 1), (0, 0, 1)],
        [0, 0, 0, 0, 0.5, 1, 1, 1, 1],
        [1, 2, 1, 0.5, 1],
    )
    return Boundary.from_patches([Revolution(profile)])


MADE = {
    "bolt": bolt,
    "hollow": lambda: Boundary.from_patches(
        [*ellipsoid_patches(1, 1, 1), *ellipsoid_patches(0.5, 0.4, 0.5)]
    ),
    "ring": lambda: Boundary.from_patches([Torus(2.0, 0.5, v0=-np.pi, v1=np.pi)]),
    "vase": vase,
    "lens": lambda: so.shapes.lens(1.0, 0.45),
    "superellipsoid": lambda: so.shapes.superellipsoid(1.0, 2.0, 3.0, 0.5, 0.8),
    "turned cylinder": lambda: so.shapes.cylinder(1.0, 2.0).transformed(
        np.linalg.qr(np.arange(9.0).reshape(3, 3) + 3.0 * np.eye(3))[0]
    ),
    "rounded box": lambda: so.shapes.box((1.0, 2.0, 3.0), rounding=0.1),
}


@pytest.mark.parametrize("name", MADE)
def test_a_boundary_comes_back(name: str, tmp_path: Path) -> None:
    made = MADE[name]()
    file = tmp_path / "part.json"
    save_boundary(file, made)
    back = open_boundary(file)
    assert type(back) is type(made)
    assert (back.name, back.radius) == (made.name, made.radius)
    assert np.array_equal(back.ints, made.ints)
    # all but a body's box is the same to the last bit; the box may lie a rounding farther out
    assert np.allclose(back.reals, made.reals, rtol=1e-12, atol=1e-12, equal_nan=True)
    save_boundary(tmp_path / "again.json", back)
    assert open_boundary(tmp_path / "again.json").digest == back.digest


def missed() -> Boundary:
    """The bolt, of which something proved that its parts miss each other by 1e-4."""
    parts = bolt()
    joined = joined_parts((), parts.edge_parts, parts.face_parts, 1e-3, closed=True)
    return made_boundary("missed", replace(joined, residual=1e-4))


@pytest.mark.parametrize("made", [missed, lambda: loose_cylinder(1e-4)])
def test_what_parts_are_proven_to_miss_comes_back(
    made: Callable[[], Boundary], tmp_path: Path
) -> None:
    file, first = tmp_path / "part.json", made()
    assert first.report.slack >= 1e-4
    save_boundary(file, first)
    back = open_boundary(file)
    assert back.report.slack == first.report.slack
    assert back.report.sewing_residual == 1e-4


def test_a_file_without_what_parts_miss_opens_with_their_tolerance(tmp_path: Path) -> None:
    file = tmp_path / "part.json"
    save_boundary(file, missed())

    def as_before(facts: dict[str, Any]) -> None:
        facts["version"] = 1
        del facts["sewing_residual"]

    rewritten(file, as_before)
    assert open_boundary(file).report.slack == 1e-3


def loose_cylinder(residual: float) -> Body:
    cylinder = so.shapes.cylinder(1.0, 2.0)
    parts = cylinder.vertex_points, cylinder.edge_parts, cylinder.face_parts
    return proven_again(parts, "loose", 0.0, 1e-3, residual)


def test_a_cavity_stays_one(tmp_path: Path) -> None:
    made = MADE["hollow"]()
    save_boundary(tmp_path / "part.json", made)
    back = open_boundary(tmp_path / "part.json")
    assert isinstance(back, Boundary)
    assert back.report.cavities == (1,)
    assert back.contains([[0.0, 0.0, 0.0], [0.75, 0.0, 0.0]]).tolist() == [False, True]


def rewritten(file: Path, change: Callable[[dict[str, Any]], Any]) -> None:
    """Change the facts of a file, with a checksum that fits."""
    facts = json.loads(file.read_text("utf-8"))
    change(facts)
    facts["sha256"] = boundary_file._checksum(facts)
    file.write_text(json.dumps(facts), "utf-8")


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (lambda text: text[: len(text) // 2], "damaged"),
        (lambda text: '{"format": "else"}', "not a boundary's file"),
        (lambda text: "[1, 2]", "not a boundary's file"),
        (lambda text: text.replace('"version": 2', '"version": 7'), "version 7"),
        (lambda text: text.replace("2.0", "2.0000000000000004", 1), "checksum"),
    ],
)
def test_a_damaged_file_is_refused(
    damage: Callable[[str], str], words: str, tmp_path: Path
) -> None:
    file = tmp_path / "part.json"
    save_boundary(file, bolt())
    text = file.read_text("utf-8")
    changed = damage(text)
    assert changed != text
    file.write_text(changed, "utf-8")
    with pytest.raises(StandoffError, match=words) as error:
        open_boundary(file)
    assert "part.json" in str(error.value)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda facts: facts.pop("edges"), "damaged"),
        (lambda facts: facts["faces"].pop(), "open"),
        (lambda facts: facts["faces"][1]["charts"][0].update(kind="Tube"), "Unknown kind 'Tube'"),
        (lambda facts: facts["faces"][1]["charts"][0].update(shift=[0, math.nan, 0]), "nan"),
        (lambda facts: facts["edges"][0].update(vertices=[0, 5]), "vertices|vertex"),
    ],
)
def test_parts_that_make_no_boundary_are_refused(
    change: Callable[[dict[str, Any]], Any], words: str, tmp_path: Path
) -> None:
    file = tmp_path / "part.json"
    save_boundary(file, bolt())
    rewritten(file, change)
    with pytest.raises(StandoffError, match=words):
        open_boundary(file)


def test_what_can_not_be_kept_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "part.json"
    with pytest.raises(TypeError, match="Boundary or a Body"):
        save_boundary(file, 3)  # type: ignore[arg-type]
    with pytest.raises(StandoffError, match="no closed surface"):
        save_boundary(file, so.shapes.sphere(1.0))
    assert not file.exists()
    assert isinstance(MADE["lens"](), Body)
