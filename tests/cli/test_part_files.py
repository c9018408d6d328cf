"""`standoff check` and `clearance` of DXF drawings and files of meshes, and the same in scenes."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import standoff as so
from standoff.scene import SceneError, load_scene
from standoff.scene.part_files import file_parts
from standoff.world import Compound

PARTS = Path(__file__).parents[3] / "shared" / "parts"
BOX = np.array([[x, y, z] for z in (0.0, 1.0) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))])
SIDES = [[0, 3, 2], [0, 2, 1], [4, 5, 6], [4, 6, 7]]
SIDES += [[k, (k + 1) % 4, (k + 1) % 4 + 4] for k in range(4)]
SIDES += [[k, (k + 1) % 4 + 4, k + 4] for k in range(4)]
OUTLINE = np.array([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]], dtype=float)


def angle() -> tuple[np.ndarray, list[list[int]]]:
    """A prism over an L, which is not convex."""
    points = np.array([[*p, z] for z in (0.0, 1.0) for p in OUTLINE])
    top = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]
    sides = [[i, (i + 1) % 6, 6 + (i + 1) % 6] for i in range(6)]
    sides += [[i, 6 + (i + 1) % 6, 6 + i] for i in range(6)]
    return points, [t[::-1] for t in top] + [[6 + k for k in t] for t in top] + sides


def stl(path: Path, points: np.ndarray, triangles: Sequence[Sequence[int]]) -> Path:
    """Each triangle by itself, as programs write it."""
    facets = "".join(
        "facet normal 0 0 0\nouter loop\n"
        + "".join("vertex {:.17g} {:.17g} {:.17g}\n".format(*points[k]) for k in triangle)
        + "endloop\nendfacet\n"
        for triangle in triangles
    )
    path.write_text(f"solid a\n{facets}endsolid a\n")
    return path


def obj(path: Path, moves: dict[str, tuple[float, float, float]]) -> Path:
    """Boxes by name."""
    lines = []
    for k, (name, move) in enumerate(moves.items()):
        lines += [f"o {name}", *("v {} {} {}".format(*p) for p in BOX + move)]
        lines += ["f {} {} {}".format(*(np.array(t) + 1 + 8 * k)) for t in SIDES]
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.fixture
def drawing(tmp_path: Path) -> Path:
    """A disc of 0.9 in a hole of 1 inch in a plate."""
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.new(units=1)
    space = document.modelspace()
    space.add_lwpolyline([(0, 0), (4, 0), (4, 3), (0, 3)], close=True)
    for radius in (1.0, 0.9):
        space.add_circle((2, 1.5), radius)
    document.saveas(tmp_path / "fit.dxf")
    return tmp_path / "fit.dxf"


def facts(standoff: Any, *arguments: object) -> dict[str, Any]:
    ended = standoff(*arguments, "--json")
    assert ended.code == 0, ended.err
    told: dict[str, Any] = json.loads(ended.out)
    return told


def test_a_drawing_is_checked(standoff: Any, drawing: Path, tmp_path: Path) -> None:
    plot = tmp_path / "fit.png"
    plate, disc = facts(standoff, "check", drawing, "--plot", plot)["bodies"]
    assert (plate["body"], disc["body"], plate["length_unit"]) == ("fit", "fit 2", "mm")
    assert plate["report"]["area"] == pytest.approx((12 - np.pi) * 25.4**2, rel=1e-12)
    assert disc["report"]["area"] == pytest.approx(0.81 * np.pi * 25.4**2, rel=1e-12)
    assert plate["notes"] == ["lengths were converted from inch"]
    assert (tmp_path / "fit-fit_2.png").exists()
    ended = standoff("check", drawing, "--body", "fit 2")
    assert "lengths were converted from inch" in ended.out
    assert "2, planar" in ended.out


def test_the_clearance_of_a_drawing(standoff: Any, drawing: Path, tmp_path: Path) -> None:
    (pair,) = facts(standoff, "clearance", drawing)["pairs"]
    assert pair["distance"] == pytest.approx(2.54, rel=1e-9)
    page = tmp_path / "page.html"
    ended = standoff("clearance", drawing, "--min", "2.6", "--page", page)
    assert ended.code == 3
    assert "lengths were converted from inch" in ended.out
    assert page.exists()


def test_a_scene_of_a_drawing(standoff: Any, drawing: Path) -> None:
    scene = drawing.with_name("scene.toml")
    table = '[bodies.{0}]\nbody = "fit.dxf"\npart = "{1}"\n'
    bodies = table.format("plate", "fit") + table.format("disc", "fit 2")
    scene.write_text(f'version = 1\nlength_unit = "in"\n{bodies}[world]\n')
    (pair,) = facts(standoff, "clearance", scene)["pairs"]
    assert pair["distance"] == pytest.approx(0.1, rel=1e-9)
    assert len(facts(standoff, "check", scene)["bodies"]) == 2
    for key, what in (("heal", "CAD files"), ("hull", "files of meshes")):
        scene.write_text(f'version = 1\nlength_unit = "mm"\n{table.format("a", "fit")}{key} = true')
        with pytest.raises(SceneError, match=what):
            load_scene(scene)


def test_a_mesh_is_checked(standoff: Any, tmp_path: Path) -> None:
    pytest.importorskip("trimesh")
    box, bracket = stl(tmp_path / "box.stl", BOX, SIDES), stl(tmp_path / "angle.stl", *angle())
    told = facts(standoff, "check", box)
    assert (told["body"], told["length_unit"], told["report"]["faces"]) == ("box", "", 6)
    ended = standoff("check", bracket)
    assert ended.code == 2
    assert "is not convex" in ended.err
    assert "Give --hulls for its hull" in ended.err
    assert "or take --pieces" not in ended.err
    told = facts(standoff, "check", bracket, "--hulls")
    assert "16.7 % of the mesh" in told["report"]["notes"][-1]


def test_the_parts_of_a_file_of_meshes(standoff: Any, tmp_path: Path) -> None:
    pytest.importorskip("trimesh")
    file = obj(tmp_path / "two.obj", {"bolt": (0, 0, 0), "nut": (1.25, 0, 0)})
    (pair,) = facts(standoff, "clearance", file)["pairs"]
    assert set(pair["names"]) == {"bolt", "nut"}
    assert pair["distance"] == pytest.approx(0.25)
    scene = tmp_path / "scene.toml"
    scene.write_text('version = 1\n[bodies.a]\nbody = "two.obj"\npart = "nut"\n[world]\n')
    nut = load_scene(scene).bodies["a"]
    assert isinstance(nut, so.Body)
    assert nut.vertex_points.min(axis=0) == pytest.approx([1.25, 0.0, 0.0])


def test_convex_pieces_of_a_mesh(tmp_path: Path) -> None:
    pytest.importorskip("coacd")
    bracket = stl(tmp_path / "angle.stl", *angle())
    parts = file_parts(bracket, instead="pieces")
    pieces = parts.found["angle"].shape
    assert isinstance(pieces, Compound)
    assert len(pieces) > 1
    assert "convex pieces of a mesh: their union adds" in parts.notes[0]


def test_a_3mf_tells_its_unit(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    pytest.importorskip("lxml")
    pytest.importorskip("networkx")
    trimesh.Trimesh(BOX, SIDES, process=False).export(tmp_path / "box.3mf")
    parts = file_parts(tmp_path / "box.3mf", "m")
    assert parts.notes == ("lengths were converted from mm",)
    (box,) = (part.shape for part in parts.found.values())
    assert isinstance(box, so.Body)
    assert box.size == pytest.approx(3**0.5 / 1000.0)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("check", "none.dxf"), "no file 'none.dxf'"),
        (("clearance", "none.stl"), "no file 'none.stl'"),
        (("view", "none.obj"), "no file 'none.obj'"),
        (("check", "fit.dxf", "--hulls"), "--hulls: is for files of meshes"),
        (("clearance", "box.stl", "--hulls", "--pieces"), "give one of them"),
        (("view", "box.stl", "--pair", "a"), "--pair: the page of a file shows all its parts"),
        (("check", "box.stl", "--body", "lid"), "--body"),
        (("check", "torn.stl"), "torn"),
        (("check", "torn.dxf"), "is no DXF drawing"),
    ],
)
def test_bad_files_and_options(
    standoff: Any,
    drawing: Path,
    monkeypatch: pytest.MonkeyPatch,
    arguments: tuple[str, ...],
    said: str,
) -> None:
    pytest.importorskip("trimesh")
    folder = drawing.parent
    stl(folder / "box.stl", BOX, SIDES)
    for name in ("torn.stl", "torn.dxf"):
        (folder / name).write_text("solid")
    monkeypatch.chdir(folder)
    ended = standoff(*arguments)
    assert (ended.code, ended.out) == (2, "")
    assert said in ended.err
    assert ended.err.count("\n") == 1


def test_an_stl_that_nobody_here_made_loads_by_its_path_as_by_object() -> None:
    trimesh = pytest.importorskip("trimesh")
    path = PARTS / "featuretype.STL"
    if not path.exists():
        pytest.skip(f"{path} is missing")
    own, given = (so.Body.from_mesh(each, hull=True) for each in (str(path), trimesh.load(path)))
    assert np.array_equal(
        np.unique(own.vertex_points, axis=0), np.unique(given.vertex_points, axis=0)
    )
    assert "points within 1e-12 of others are one with them" in own.check().notes[0]
    (part,) = (part.shape for part in file_parts(path, instead="hull").found.values())
    assert isinstance(part, so.Body)
    assert part.digest == own.digest


@pytest.mark.parametrize("off", [3e-16, 1e-13, 5e-13])
def test_corners_that_differ_by_roundoff_close_a_mesh(
    off: float, rng: np.random.Generator, tmp_path: Path
) -> None:
    pytest.importorskip("trimesh")
    points, triangles = angle()
    apart = points[np.ravel(triangles)]
    apart += off * rng.uniform(-1.0, 1.0, apart.shape)
    path = stl(tmp_path / "off.stl", apart, np.arange(len(apart)).reshape(-1, 3).tolist())
    body = so.Body.from_mesh(path, hull=True)
    assert body.size == pytest.approx(3.0, rel=1e-6)
    wide = points[np.ravel(triangles)] + 1e-3 * rng.uniform(-1.0, 1.0, apart.shape)
    with pytest.raises(so.BodyError, match="has holes"):
        so.Body.from_mesh((wide, np.arange(len(wide)).reshape(-1, 3)), hull=True)
