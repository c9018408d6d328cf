"""Meshes: convex ones are bodies; others are hulls or pieces by name, with what that changes."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

import standoff as so
from standoff.bodies.meshes.columns import measured
from standoff.bodies.meshes.mesh import read_mesh

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Triangles = tuple[Array, Ints]


def box(low: Any = (0, 0, 0), high: Any = (1, 1, 1)) -> Triangles:
    """Twelve triangles."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    triangles = [[q[0], q[i], q[i + 1]] for q in quads for i in (1, 2)]
    points = np.array(low) + corners * np.subtract(high, low)
    return points.astype(float), np.array(triangles)


def angle(height: float = 1.0, turn: Array | None = None) -> Triangles:
    """An L of three unit squares, extruded: volume 3 times its height."""
    outline = np.array([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]], dtype=float)
    points = np.concatenate([np.column_stack([outline, np.full(6, z)]) for z in (0.0, height)])
    top = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]])
    around = [[i, (i + 1) % 6, 6 + (i + 1) % 6] for i in range(6)]
    around += [[i, 6 + (i + 1) % 6, 6 + i] for i in range(6)]
    triangles = np.concatenate([top[:, ::-1], 6 + top, around])
    return (points if turn is None else points @ turn.T), triangles


def together(*meshes: Triangles) -> Triangles:
    points, triangles, count = [], [], 0
    for some, corners in meshes:
        points.append(some)
        triangles.append(corners + count)
        count += len(some)
    return np.concatenate(points), np.concatenate(triangles)


def ball(rng: np.random.Generator, n: int = 200) -> Triangles:
    points = rng.normal(size=(n, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    corners = ConvexHull(points).simplices
    a, b, c = (points[corners[:, k]] for k in range(3))
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), a) < 0.0
    corners[inward] = corners[inward][:, [0, 2, 1]]
    return points, corners.astype(np.int64)


def test_a_box_is_a_box() -> None:
    body = so.Body.from_mesh(box(high=(1, 2, 3)))
    assert (body.n_faces, body.n_edges, body.n_vertices) == (6, 12, 8)
    assert body.check().slack == 0.0
    assert body.check().notes == ()
    answer = so.distance(body, so.shapes.sphere(0.5), np.eye(4), so.Pose(np.eye(3), (0.5, 4, 1)))
    assert answer.distance == pytest.approx(1.5, abs=1e-14)


def test_a_convex_mesh_is_its_hull(rng: np.random.Generator) -> None:
    points, triangles = ball(rng)
    body = so.Body.from_mesh((points, triangles))
    assert body.digest == so.Body.from_points(points).digest
    # as single precision stores it, its edges are concave by roundoff
    coarse = so.Body.from_mesh((points.astype(np.float32), triangles))
    assert coarse.check().slack < 1e-6


def test_a_mesh_of_separate_triangles_facing_inward_is_read(rng: np.random.Generator) -> None:
    points, triangles = ball(rng)
    loose = points[triangles[:, ::-1]].reshape(-1, 3)
    body = so.Body.from_mesh((loose, np.arange(len(loose)).reshape(-1, 3)))
    assert body.n_vertices == len(points)
    merged, turned = body.check().notes
    assert merged == f"{len(loose) - len(points)} points within 1e-12 of others are one with them"
    assert turned == "all triangles face inward: turned outward"
    # each corner rounded in its own way, as programs that write triangle by triangle do
    bent = loose * (1.0 + rng.choice([-1.0, 0.0, 1.0], loose.shape) * np.finfo(float).eps)
    again = so.Body.from_mesh((bent, np.arange(len(loose)).reshape(-1, 3)))
    assert (again.n_vertices, again.n_faces) == (body.n_vertices, body.n_faces)


def test_trimesh_objects_and_files(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    solid = trimesh.creation.icosphere(2)
    body = so.Body.from_mesh(solid)
    assert body.n_faces == len(solid.faces)
    file = tmp_path / "box.stl"
    trimesh.creation.box((1.0, 2.0, 3.0)).export(file)
    for given in (file, str(file)):
        assert so.Body.from_mesh(given).n_faces == 6
    file.write_bytes(b"no mesh")
    with pytest.raises(ValueError, match=r"was not read as a mesh|no triangles"):
        so.Body.from_mesh(file)
    with pytest.raises(FileNotFoundError, match=r"no mesh file .*none\.stl"):
        so.Body.from_mesh(tmp_path / "none.stl")


@pytest.mark.parametrize("module", ["trimesh", "coacd"])
def test_a_missing_extra_is_named(
    module: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    make = so.Body.from_mesh if module == "trimesh" else so.bodies.decomposition
    given: Any = tmp_path / "box.stl" if module == "trimesh" else angle()
    with pytest.raises(ModuleNotFoundError, match=r"pip install 'standoff\[meshes\]'"):
        make(given)


def test_a_mesh_that_is_not_convex_is_refused_with_its_edge() -> None:
    words = r"not convex: the edge from \[1\. 1\. .\.\] to \[1\. 1\. .\.\].*16\.7 % to its volume"
    with pytest.raises(so.BodyError, match=words) as caught:
        so.Body.from_mesh(angle())
    kind, triangle = caught.value.part or ("", -1)
    assert kind == "face"
    points, triangles = angle()
    assert (np.array([1.0, 1.0]) == points[triangles[triangle]][:, :2]).all(axis=1).any()


@pytest.mark.parametrize("gap", [0.5, 3.0])
def test_two_convex_surfaces_are_not_convex(gap: float) -> None:
    two = together(box(), box((1.0 + gap, 0, 0), (2.0 + gap, 1, 1)))
    with pytest.raises(so.BodyError, match="several surfaces, or crosses itself"):
        so.Body.from_mesh(two)
    body = so.Body.from_mesh(two, hull=True)
    assert f"adds a volume of {gap:.3g} ({50.0 * gap:.3g} % of the mesh)" in body.check().notes[-1]


def test_a_hull_says_what_it_adds(rng: np.random.Generator) -> None:
    """The L's hull adds a prism over a right triangle with sides of 1: 0.5, up to 0.5 away."""
    for turn in (np.eye(3), Rotation.random(random_state=rng).as_matrix()):
        body = so.Body.from_mesh(angle(turn=turn), hull=True)
        (note,) = body.check().notes
        assert "adds a volume of 0.5 (16.7 % of the mesh)" in note
        assert "loses 0 (0 % of the mesh), up to 0 away" in note
        away = float(note.split("up to ")[1].split()[0])
        spacing = float(note.split("columns ")[1].split()[0])
        # of the points added, the farthest from the L is the middle of the slope
        assert away == pytest.approx(0.5, abs=2.0 * spacing)
        assert body.n_faces == 7


def test_convex_pieces_are_measured_exactly_where_columns_are(rng: np.random.Generator) -> None:
    mesh = read_mesh(angle())
    one, other = box((0, 0, 0), (2, 1, 1)), box((0, 1, 0), (1, 2, 1))
    exact = measured(mesh, [one, other])
    assert exact.added == exact.lost == exact.added_distance == exact.lost_distance == 0.0
    assert exact.volume == pytest.approx(3.0)
    assert exact.volume_error <= 0.05
    less = measured(mesh, [one, box((0, 1, 0), (1, 2, 0.75))])
    assert less.lost == pytest.approx(0.25, rel=0.02)
    assert less.lost_distance == pytest.approx(0.25, abs=2.0 * less.spacing)
    assert less.added == 0.0
    # they may overlap each other; what is outside the mesh counts once
    more = measured(mesh, [one, box((0, 0, 0), (1, 2, 1.5)), box((0, 0, 0.5), (1, 2, 1.5))])
    assert more.added == pytest.approx(1.0, rel=0.02)
    assert more.added_distance == pytest.approx(0.5, abs=2.0 * more.spacing)
    assert more.lost == 0.0
    assert str(more).startswith("adds a volume of 1")


def test_a_decomposition_is_the_mesh_but_for_what_it_says() -> None:
    pytest.importorskip("coacd")
    made = so.bodies.decomposition(angle(), concavity=0.1)
    assert list(made.pieces) == [f"piece {k}" for k in range(len(made.pieces))]
    assert len(made.pieces) >= 2
    assert made.fit.volume == pytest.approx(3.0)
    assert made.fit.added <= 0.1
    assert made.fit.lost <= 0.1
    assert str(made).startswith(f"{len(made.pieces)} convex pieces of a mesh: their union adds")
    inside = so.shapes.point()
    for spot, distance in (((1.5, 1.5, 0.5), 0.5), ((3.0, 0.5, 0.5), 1.0)):
        pose = so.Pose(np.eye(3), spot)
        found = min(so.distance(b, inside, np.eye(4), pose).distance for b in made.pieces.values())
        assert found == pytest.approx(distance, abs=0.05)
    again = so.bodies.decomposition(angle(), concavity=0.1)
    assert [b.digest for b in again.pieces.values()] == [b.digest for b in made.pieces.values()]


def test_bad_arguments_of_a_decomposition() -> None:
    for wrong in ({"concavity": 0.001}, {"concavity": 2.0}, {"most": 0}, {"seed": -1}):
        (name,) = wrong
        with pytest.raises(ValueError, match=name):
            so.bodies.decomposition(angle(), **wrong)  # type: ignore[arg-type]


POINTS, TRIANGLES = box()
NAN = np.where(np.arange(24).reshape(8, 3) == 7, np.nan, POINTS)
TURNED = np.concatenate([TRIANGLES[:1, ::-1], TRIANGLES[1:]])


@pytest.mark.parametrize(
    ("mesh", "words"),
    [
        ((POINTS, TRIANGLES[1:]), r"has holes: 3 edges have a triangle on one side only \(\[0\. 0"),
        ((POINTS, TRIANGLES[2:]), "has holes: 4 edges"),
        ((POINTS, TURNED), r"Triangles 0 and \d+ of the mesh both pass the edge from \[0\. 0\."),
        ((POINTS, np.concatenate([TRIANGLES, TRIANGLES[:1]])), r"Triangles 0 and 12 .* both pass"),
        ((NAN, TRIANGLES), r"mesh vertices\[2\] has a NaN or infinite number"),
        (
            (POINTS, TRIANGLES + 1),
            r"Triangle \d of the mesh has the corners .* whole numbers from 0 to 7",
        ),
        ((POINTS, TRIANGLES + 0.5), r"Triangle 0 of .* whole numbers from 0 to 7"),
        ((POINTS, TRIANGLES[:, :2]), r"mesh triangles has shape \(12, 2\)"),
        ((POINTS[:, :2], TRIANGLES), r"mesh vertices has shape \(8, 2\)"),
        ((POINTS, np.zeros((4, 3), dtype=int)), "The mesh has no triangles"),
        ((POINTS * [1, 1, 0], TRIANGLES), "encloses no volume|span no volume|both pass|holes"),
    ],
)
def test_what_is_no_closed_mesh_is_refused(mesh: Triangles, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        so.Body.from_mesh(mesh)
    with pytest.raises(ValueError, match=words):
        so.bodies.decomposition(mesh)


@pytest.mark.parametrize("mesh", [3, None, np.zeros((3, 3)), (POINTS,)])
def test_what_is_no_mesh_at_all(mesh: Any) -> None:
    with pytest.raises(TypeError, match=r"give a trimesh\.Trimesh, the path of a file, or a pair"):
        so.Body.from_mesh(mesh)
