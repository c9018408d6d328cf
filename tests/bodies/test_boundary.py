"""Boundaries of solids that need not be convex: senses, volumes, edges, points, refusals."""

from __future__ import annotations

import pickle
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from brep_solids import SOLIDS, Solid, X, Y, Z, apple, drilled, prism, shells_of_balls

import standoff as so
from draws import draws
from standoff.bodies import BodyError, Edge, Face
from standoff.bodies.boundary import Boundary, EdgeKind
from standoff.bodies.moments.boundary import moments_of
from standoff.bodies.tessellation import chart_row
from standoff.geometry import BezierPatch, Line, Plane
from standoff.kernels.body import layout as L
from standoff.kernels.entries.queries import chart_normal

NEAR = 1e-3
"""Points of a test stay this far from the boundary: its own closed form does not say which side."""


def made(solid: Solid, faces: list[Face] | None = None) -> Boundary:
    parts = solid.vertices, solid.edges, faces or solid.faces
    return Boundary.from_brep(*parts, senses=solid.senses)


def drawn_points(solid: Solid, count: int, rng: np.random.Generator) -> np.ndarray:
    """In and around its box, away from the boundary."""
    spread = 0.1 * (solid.high - solid.low)
    points = rng.uniform(solid.low - spread, solid.high + spread, (count, 3))
    steps = NEAR * np.vstack([np.eye(3), -np.eye(3)])
    sides = [solid.inside(points + step) for step in steps]
    return points[(np.array(sides) == solid.inside(points)).all(axis=0)]


@pytest.mark.parametrize("name", SOLIDS)
def test_volume_area_and_box_are_those_of_the_closed_form(name: str) -> None:
    solid = SOLIDS[name]()
    report = made(solid).check()
    assert abs(report.volume - solid.volume) <= max(report.volume_error, 1e-12 * solid.volume)
    assert report.volume_error <= 1e-8 * solid.volume
    np.testing.assert_allclose(report.area, solid.area, rtol=1e-8)
    boundary = made(solid)
    centre = boundary.reals[L.BOX_CENTRE : L.BOX_CENTRE + 3]
    half = boundary.reals[L.BOX_HALF : L.BOX_HALF + 3]
    spare = 1e-14 * boundary.size
    assert (centre - half <= solid.low + spare).all()
    assert (centre + half >= solid.high - spare).all()
    np.testing.assert_allclose(centre - half, solid.low, atol=1e-2 * boundary.size)
    np.testing.assert_allclose(centre + half, solid.high, atol=1e-2 * boundary.size)


@pytest.mark.parametrize("name", SOLIDS)
def test_every_edge_is_told(name: str) -> None:
    solid = SOLIDS[name]()
    assert Counter(kind.value for kind in made(solid).edge_kinds) == solid.kinds


@pytest.mark.parametrize("name", SOLIDS)
def test_points_inside_and_outside(name: str, rng: np.random.Generator) -> None:
    solid = SOLIDS[name]()
    points = drawn_points(solid, draws(300), rng)
    np.testing.assert_array_equal(made(solid).contains(points), solid.inside(points))


@pytest.mark.parametrize("name", SOLIDS)
def test_rays_along_edges_and_through_vertices(name: str) -> None:
    """Points of a grid that has its lines along the solids' own."""
    solid = SOLIDS[name]()
    grid = [
        np.linspace(low, high, 9)[1::2] for low, high in zip(solid.low, solid.high, strict=True)
    ]
    points = np.array(np.meshgrid(*grid)).reshape(3, -1).T + 1e-4 * np.array([1.0, 1.7, 2.3])
    np.testing.assert_array_equal(made(solid).contains(points), solid.inside(points))


def reversed_loop(face: Face) -> Face:
    return replace(face, loop=tuple((j, -sense) for j, sense in reversed(face.loop)))


@pytest.mark.parametrize("name", SOLIDS)
def test_whichever_way_the_loops_are_given(name: str, rng: np.random.Generator) -> None:
    """All turned, or some of them: the same boundary to the bit. A face of an atlas alone, whose
    loop has two sides, keeps it with its sense."""
    solid = SOLIDS[name]()
    known = made(solid)
    for turned in ([True] * len(solid.faces), *(rng.uniform(size=(4, len(solid.faces))) < 0.5)):
        faces = [reversed_loop(f) if t else f for f, t in zip(solid.faces, turned, strict=True)]
        found = made(solid, faces)
        assert found.check().shells == known.check().shells
        for row, other in zip(normals(known), normals(found), strict=True):
            np.testing.assert_array_equal(row, other)
        np.testing.assert_array_equal(found.edge_kinds, known.edge_kinds)
        np.testing.assert_allclose(found.check().volume, known.check().volume, rtol=1e-13)


def normals(boundary: Boundary) -> list[np.ndarray]:
    """Outward, at a place of every chart."""
    spots = []
    for number in range(int(boundary.ints[L.N_CHARTS])):
        face = boundary.face_parts[int(chart_row(boundary, number)[L.CHART_FACE])]
        u, v = (
            (0.3, 0.4)
            if not np.isfinite(face.charts[0].domain).all()
            else np.reshape(face.charts[0].domain, (2, 2)).mean(axis=1)
        )
        spots.append(np.array(chart_normal(boundary.ints, boundary.reals, number, u, v)))
    return spots


@pytest.mark.parametrize("name", [name for name in SOLIDS if name != "ring"])
def test_whichever_side_of_a_surface_is_up(name: str) -> None:
    """Every chart mirrored in its parameters, so that x_u × x_v points the other way.

    The edges of the ring are curves on its own surfaces, which must stay as they are.
    """
    solid = SOLIDS[name]()
    mirror = np.diag([1.0, -1.0, 1.0])
    faces = [
        replace(f, charts=tuple(replace(c, linear=c.linear @ mirror) for c in f.charts))
        for f in solid.faces
    ]
    senses = None if solid.senses is None else [s and -s for s in solid.senses]
    found = made(replace(solid, senses=senses), faces)
    np.testing.assert_allclose(found.check().volume, solid.volume, rtol=1e-9)
    assert Counter(kind.value for kind in found.edge_kinds) == solid.kinds


def test_a_cavity_faces_into_it() -> None:
    boundary = made(SOLIDS["hollow ball"]())
    assert boundary.check().cavities == (1,)
    assert boundary.check().shells == ((0,), (1,))
    inner = [n for n in range(12) if int(chart_row(boundary, n)[L.CHART_FACE]) == 1]
    for number in inner:
        n = np.array(chart_normal(boundary.ints, boundary.reals, number, 0.2, -0.1))
        x = boundary.face_parts[1].charts[number - 6].jet(0.2, -0.1)[0]
        assert n @ (x - [0.1, 0.0, -0.2]) < 0.0


@pytest.mark.parametrize("name", SOLIDS)
def test_moments_are_those_of_the_material(name: str, rng: np.random.Generator) -> None:
    """The centre, against points drawn evenly in the box."""
    solid = SOLIDS[name]()
    found = moments_of(made(solid), 1e-9)
    np.testing.assert_allclose(found.volume, solid.volume, rtol=1e-8)
    points = rng.uniform(solid.low, solid.high, (200_000, 3))
    inside = points[solid.inside(points)]
    centre = found.about + found.first / found.volume
    spread = np.linalg.norm(solid.high - solid.low) / np.sqrt(len(inside))
    np.testing.assert_allclose(centre, inside.mean(axis=0), atol=5.0 * spread)


def test_sewn_patches_of_a_torus() -> None:
    boundary = Boundary.from_patches(apple())
    np.testing.assert_allclose(boundary.check().volume, np.pi**2, rtol=1e-9)
    assert set(boundary.edge_kinds) == {EdgeKind.SMOOTH}
    r = np.array([[2.0, 0, 0], [0, 2.4, 0], [0, 0, 0.1], [0, 1.4, 0], [1.5, 1.5, 0.2]])
    assert boundary.contains(r).tolist() == [True, True, False, False, True]


def test_sewn_patches_of_two_shells() -> None:
    boundary = Boundary.from_patches(shells_of_balls())
    np.testing.assert_allclose(
        boundary.check().volume, 4.0 / 3.0 * np.pi * (1.0 - 0.125), rtol=1e-9
    )
    assert len(boundary.check().cavities) == 1
    assert boundary.contains([[0, 0, 0], [0, 0.7, 0], [0, 0, 1.1]]).tolist() == [
        False,
        True,
        False,
    ]


def test_a_bracket_from_a_step_file(tmp_path: Path, rng: np.random.Generator) -> None:
    """Against OpenCASCADE: volume, area, and which points are inside."""
    pytest.importorskip("OCP")
    import step_parts
    from OCP.BRepClass3d import BRepClass3d_SolidClassifier
    from OCP.gp import gp_Pnt
    from OCP.TopAbs import TopAbs_IN

    volume, area = step_parts.bracket(tmp_path / "bracket.step")
    shape = step_parts.read(tmp_path / "bracket.step")
    boundary = Boundary.from_brep(*step_parts.parts(shape), tolerance=1e-6)
    np.testing.assert_allclose(boundary.check().volume, volume, rtol=1e-9)
    np.testing.assert_allclose(boundary.check().area, area, rtol=1e-9)
    kinds = Counter(kind.value for kind in boundary.edge_kinds)
    # the fillet's two borders are smooth; of the hole, where cone and cylinder meet is convex too
    assert kinds["smooth"] == 2
    assert kinds["reflex"] == 0
    points = rng.uniform([-2, -2, -2], [62, 32, 42], (draws(200), 3))
    known = []
    for x in points:
        side = BRepClass3d_SolidClassifier(shape, gp_Pnt(*x.tolist()), 1e-9)
        known.append(side.State() == TopAbs_IN)
    np.testing.assert_array_equal(boundary.contains(points), known)


def test_contains_is_of_solids_without_a_skin() -> None:
    others = (
        so.shapes.segment(1.0),
        so.shapes.halfspace([0, 0, 1]),
        so.shapes.box(1, 1, 1, rounding=0.1),
    )
    for body in others:
        with pytest.raises(so.StandoffError, match="is not a bounded, unrounded solid"):
            body.contains([[0, 0, 0]])


CUBE = [(0, 0), (1, 0), (1, 1), (0, 1)]


def cube(size: float = 1.0, shift: tuple[float, ...] = (0, 0, 0)) -> tuple:
    vertices, edges, faces = prism([(size * x, size * y) for x, y in CUBE], size)
    moved = np.asarray(shift, dtype=float)
    edges = [replace(e, curve=e.curve.transformed(np.eye(3), moved)) for e in edges]
    faces = [
        replace(f, charts=tuple(c.transformed(np.eye(3), moved) for c in f.charts)) for f in faces
    ]
    return np.array(vertices) + moved, edges, faces


def together(*solids: tuple) -> tuple:
    vertices, edges, faces = np.zeros((0, 3)), [], []
    for v, e, f in solids:
        n, m = len(vertices), len(edges)
        edges += [replace(one, first=one.first + n, last=one.last + n) for one in e]
        faces += [replace(one, loop=tuple((j + m, s) for j, s in one.loop)) for one in f]
        vertices = np.vstack([vertices, v])
    return vertices, edges, faces


def inverted(solid: tuple) -> tuple:
    return solid[0], solid[1], [reversed_loop(face) for face in solid[2]]


def test_shells_within_shells() -> None:
    inner = cube(0.5, (0.25, 0.25, 0.25))
    found = Boundary.from_brep(*together(cube(), inverted(inner)))
    np.testing.assert_allclose(found.check().volume, 0.875, rtol=1e-12)
    other = Boundary.from_brep(*together(inverted(cube()), inner))
    np.testing.assert_allclose(other.check().volume, 0.875, rtol=1e-12)
    with pytest.raises(BodyError, match=r"lie inside .* face the same way"):
        Boundary.from_brep(*together(cube(), inner))
    with pytest.raises(BodyError, match=r"lie outside .* a boundary of each"):
        Boundary.from_brep(*together(cube(), inverted(cube(0.5, (3, 0, 0)))))
    smallest = cube(0.1, (0.4, 0.4, 0.4))
    with pytest.raises(BodyError, match=r"inside the cavity"):
        Boundary.from_brep(*together(cube(), inverted(inner), inverted(smallest)))


def test_open_shells_and_edges_of_three_faces() -> None:
    vertices, edges, faces = cube()
    with pytest.raises(BodyError, match="is open: it bounds 1 faces"):
        Boundary.from_brep(vertices, edges, faces[:-1])
    with pytest.raises(BodyError, match="used too often: it bounds 3 faces"):
        Boundary.from_brep(vertices, edges, [*faces, faces[0]])
    both = [*faces[:-1], replace(faces[-1], loop=(faces[-1].loop[0], *reversed_rest(faces[-1])))]
    with pytest.raises(BodyError, match="runs both ways round"):
        Boundary.from_brep(vertices, edges, both)


def reversed_rest(face: Face) -> tuple:
    return tuple((j, -s) for j, s in face.loop[1:])


def test_a_surface_with_one_side() -> None:
    """Four faces of an octahedron and its three squares: a closed polyhedron that has no inside."""
    vertices = np.vstack([np.eye(3), -np.eye(3)])
    corners = [(0, 1, 2), (0, 4, 5), (3, 1, 5), (3, 4, 2)]
    squares = [(0, 1, 3, 4), (1, 2, 4, 5), (2, 0, 5, 3)]
    edges: list[Edge] = []
    number: dict[frozenset, int] = {}
    faces = []
    for ring in (*corners, *squares):
        loop = []
        for a, b in zip(ring, ring[1:] + ring[:1], strict=True):
            key = frozenset((a, b))
            if key not in number:
                number[key] = len(edges)
                edges.append(Edge(Line(vertices[a], vertices[b]), a, b))
            j = number[key]
            loop.append((j, 1 if edges[j].first == a else -1))
        p, q, r = (vertices[k] for k in ring[:3])
        faces.append(Face((Plane.through(p, q - p, r - p),), tuple(loop)))
    with pytest.raises(BodyError, match="one side only"):
        Boundary.from_brep(vertices, edges, faces)


def test_nothing_enclosed() -> None:
    vertices, edges, faces = cube()
    twice = [
        faces[0],
        Face((Plane.through(Z, Y, X),), tuple((j, -s) for j, s in reversed(faces[0].loop))),
    ]
    used = [j for j, _ in faces[0].loop]
    flat = [replace(edges[j], first=edges[j].first - 4, last=edges[j].last - 4) for j in used]
    two = [replace(f, loop=tuple((used.index(j), s) for j, s in f.loop)) for f in twice]
    with pytest.raises(BodyError, match="enclose no volume"):
        Boundary.from_brep(vertices[4:], flat, two)


def test_loops_beside_each_other_are_no_face() -> None:
    vertices, edges, faces = cube()
    more = together((vertices, edges, faces), cube(1.0, (3, 0, 0)))
    top, other = more[2][0], more[2][6]
    joined = Face(top.charts, (*top.loop, *other.loop))
    rest = [f for k, f in enumerate(more[2]) if k not in (0, 6)]
    with pytest.raises(BodyError, match="loops beside each other"):
        Boundary.from_brep(more[0], more[1], [joined, *rest])


@pytest.mark.parametrize(
    ("parts", "told"),
    [
        (lambda: ([], [], []), "at least one vertex"),
        (lambda: ([[0, 0, 0]], [], []), "needs faces"),
        (lambda: ([], [], [Face((Plane.through((0, 0, 0), X, Y),))]), "half-space"),
        (lambda: (np.full((1, 3), np.nan), [], []), "NaN"),
    ],
)
def test_what_has_no_closed_boundary(parts, told: str) -> None:
    with pytest.raises(ValueError, match=told):
        Boundary.from_brep(*parts())
    with pytest.raises(BodyError, match="senses"):
        Boundary.from_brep(*cube(), senses=[1, 2])


def test_an_edge_that_is_convex_in_part() -> None:
    """Beside a level half of its top a block has a twisted one, that falls from their common edge
    in front and rises from it behind."""
    slope = 0.4

    def quad(*corners: tuple[float, float, float]) -> BezierPatch:
        return BezierPatch(np.reshape(corners, (2, 2, 3)))

    low, high = -0.5 * slope, 0.5 * slope
    patches = [
        quad((0, -1, 0), (1, -1, 0), (0, 0, 0), (1, 0, 0)),
        quad((0, 0, 0), (1, 0, 0), (0, 1, low), (1, 1, high)),
        quad((0, -1, -1), (1, -1, -1), (0, 0, -1), (1, 0, -1)),
        quad((0, 0, -1), (1, 0, -1), (0, 1, -1), (1, 1, -1)),
        quad((0, -1, -1), (1, -1, -1), (0, -1, 0), (1, -1, 0)),
        quad((0, 1, -1), (1, 1, -1), (0, 1, low), (1, 1, high)),
    ]
    for x, end in ((0, low), (1, high)):
        patches.append(quad((x, -1, -1), (x, 0, -1), (x, -1, 0), (x, 0, 0)))
        patches.append(quad((x, 0, -1), (x, 1, -1), (x, 0, 0), (x, 1, end)))
    boundary = Boundary.from_patches(patches)
    assert Counter(boundary.edge_kinds)[EdgeKind.MIXED] == 1
    assert Counter(boundary.edge_kinds)[EdgeKind.SMOOTH] == 3
    assert Counter(boundary.edge_kinds)[EdgeKind.REFLEX] == 0
    np.testing.assert_allclose(boundary.check().volume, 2.0, rtol=1e-12)
    heights = np.array([[0.1, 0.5, -0.1], [0.9, 0.5, 0.05], [0.1, 0.5, -0.05], [0.9, 0.5, 0.1]])
    inside = heights[:, 2] < slope * 0.5 * (heights[:, 0] - 0.5)
    np.testing.assert_array_equal(boundary.contains(heights), inside)


def test_a_body_is_a_boundary(rng: np.random.Generator) -> None:
    box = so.shapes.box(1.0, 2.0, 3.0)
    assert isinstance(box, Boundary)
    assert set(box.edge_kinds) == {EdgeKind.CONVEX}
    points = rng.uniform(-2, 2, (50, 3))
    inside = (np.abs(points) < 0.5 * np.array([1.0, 2, 3])).all(axis=1)
    np.testing.assert_array_equal(box.contains(points), inside)
    assert Boundary.from_brep(
        box.vertex_points, box.edge_parts, box.face_parts
    ).check().volume == pytest.approx(moments_of(box, 1e-9).volume)


def test_a_stored_boundary_is_the_same() -> None:
    boundary = made(SOLIDS["drilled"]())
    again = pickle.loads(pickle.dumps(boundary))
    assert again.digest == boundary.digest
    assert repr(again) == repr(boundary)
    assert not again.reals.flags.writeable


def test_no_inner_box_holds_a_small_hole() -> None:
    """It would stand for a part of the face without a look at its loops."""
    solid = drilled(0.05)
    boundary = made(solid)
    for number in range(2):
        at = int(chart_row(boundary, number)[L.CHART_REALS]) + L.INNER
        u0, u1, _, _ = boundary.reals[at : at + 4]
        assert u0 > u1
    points = np.array([[1.0, 1.0, 0.5], [1.0, 1.1, 0.5], [1.02, 0.98, 0.9], [1.0, 1.0, -0.1]])
    np.testing.assert_array_equal(boundary.contains(points), solid.inside(points))


def test_a_boundary_of_many_cells_is_integrated_to_the_end() -> None:
    """However few points are allowed for all of it, as for a part of a thousand faces."""
    from standoff.bodies.moments.cells import MomentCell, integrate

    def values(_: object, t: np.ndarray, s: np.ndarray) -> np.ndarray:
        return np.exp(3.0 * (t[:, :, None, None] + s[:, None, :, None]))

    found = integrate([MomentCell(values)] * 5_000, np.abs, 1e-9, 200_000)
    each = ((np.exp(3.0) - 1.0) / 3.0) ** 2
    assert found.values[0] == pytest.approx(5_000 * each, rel=1e-9)
    assert found.remainder[0] <= 1e-9 * found.values[0]
