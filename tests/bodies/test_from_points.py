"""Hulls of points: their parts, their proof and their distances against brute force."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import nnls
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

import standoff as so
from shares import share
from standoff.bodies.hulls.heights import highest
from standoff.kernels.body import layout as L
from standoff.kernels.entries.queries import on_face

Array = NDArray[np.float64]
EPS = float(np.finfo(float).eps)
TETRAHEDRON = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])


def ball(rng: np.random.Generator, n: int) -> Array:
    points = rng.normal(size=(n, 3))
    return np.asarray(points / np.linalg.norm(points, axis=1)[:, None])


def turned(rng: np.random.Generator) -> Array:
    return np.asarray(Rotation.random(random_state=rng).as_matrix())


def grid_on_a_cube(n: int = 9) -> Array:
    ticks = np.linspace(-1.0, 1.0, n)
    points = np.stack(np.meshgrid(ticks, ticks, ticks), axis=-1).reshape(-1, 3)
    return np.asarray(points[np.abs(points).max(axis=1) == 1.0])


def prism(n: int) -> Array:
    t = 2.0 * np.pi * np.arange(n) / n
    return np.concatenate([np.column_stack([np.cos(t), np.sin(t), 0 * t + z]) for z in (-1, 1)])


def globe(n: int) -> Array:
    """A sphere's grid of parallels and meridians: quadrangles, and needles at the poles."""
    u, v = np.meshgrid(2.0 * np.pi * np.arange(n) / n, np.linspace(0.0, np.pi, n // 2))
    points = [np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), np.cos(v)]
    return np.stack([x.ravel() for x in points], axis=1)


CLOUDS: dict[str, Callable[[np.random.Generator], Array]] = {
    "tetrahedron": lambda rng: TETRAHEDRON,
    "ball": lambda rng: ball(rng, 40),
    "cloud": lambda rng: rng.normal(size=(300, 3)) * [1.0, 0.5, 0.1],
    "cube": lambda rng: grid_on_a_cube(),
    "turned cube": lambda rng: 3.0 * grid_on_a_cube() @ turned(rng).T + rng.normal(size=3),
    "prism": lambda rng: prism(30) @ turned(rng).T,
    "globe": lambda rng: globe(16) @ turned(rng).T,
    "whole numbers": lambda rng: rng.integers(-3, 4, size=(200, 3)).astype(float),
    "twice": lambda rng: np.repeat(ball(rng, 30), 2, axis=0),
    "clusters": lambda rng: np.repeat(ball(rng, 30), 3, axis=0) + 1e-14 * rng.normal(size=(90, 3)),
    "needle": lambda rng: rng.normal(size=(50, 3)) * [1.0, 1e-4, 1e-4],
}


@pytest.fixture(params=CLOUDS)
def points(request: pytest.FixtureRequest, rng: np.random.Generator) -> Array:
    return CLOUDS[request.param](rng)


def planes(body: so.Body) -> tuple[Array, Array]:
    """(normals, offsets) of its faces, from their surfaces."""
    jets = [face.charts[0].jet(0.0, 0.0) for face in body.face_parts]
    normals = np.array([np.cross(jet[1], jet[2]) for jet in jets])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    spots = np.array([jet[0] for jet in jets])
    inside = body.vertex_points.mean(axis=0)
    # those of a mirror image point inwards
    normals *= np.sign(np.einsum("ij,ij->i", normals, spots - inside))[:, None]
    return normals, np.einsum("ij,ij->i", normals, spots)


@pytest.mark.parametrize("name", [name for name in CLOUDS if name != "clusters"])
def test_arrays_are_those_of_the_same_parts_one_by_one(name: str, rng: np.random.Generator) -> None:
    """But for clusters, whose shortest edges have no direction to agree upon."""
    body = so.Body.from_points(CLOUDS[name](rng))
    again = so.Body.from_brep(body.vertex_points, body.edge_parts, body.face_parts, name="hull")
    assert np.array_equal(body.ints, again.ints)
    reals, expected = body.reals.copy(), again.reals.copy()
    for row in range(body.n_faces):  # whose inner rectangles are found another way
        at = int(body.ints[body.ints[L.CHARTS] + L.CHART_STRIDE * row + L.CHART_REALS]) + L.INNER
        reals[at : at + 4] = expected[at : at + 4] = 0.0
    assert np.array_equal(np.isinf(reals), np.isinf(expected))
    finite = np.isfinite(reals)
    size = max(1.0, body.size)
    assert reals[finite] == pytest.approx(expected[finite], abs=1e-10 * size, rel=1e-10)
    ours, theirs = body.check(), again.check()
    assert (ours.slack, ours.smooth_edges) == (theirs.slack, theirs.smooth_edges) == (0.0, 0)
    assert theirs.notes == ours.notes == ()
    for one, other in ((ours.sharpest, theirs.sharpest), (ours.flattest, theirs.flattest)):
        assert one is not None
        assert other is not None
        assert one.angle == pytest.approx(other.angle, abs=1e-9)


def test_no_point_is_above_a_face_and_every_direction_has_its_support(
    points: Array, rng: np.random.Generator
) -> None:
    body = so.Body.from_points(points)
    normals, offsets = planes(body)
    heights = normals @ points.T - offsets[:, None]
    size = body.size + np.abs(points).max()
    assert heights.max() <= 1e-14 * size
    assert heights.max() <= body.check().convexity_defect + 8.0 * EPS * size
    directions = ball(rng, 200)
    supports = (directions @ body.vertex_points.T).max(axis=1)
    assert supports == pytest.approx((directions @ points.T).max(axis=1), abs=1e-13 * size)
    given = {tuple(p) for p in points.tolist()}
    assert all(tuple(v) in given for v in body.vertex_points.tolist())


def test_the_surface_closes(points: Array) -> None:
    body = so.Body.from_points(points)
    assert body.n_vertices - body.n_edges + body.n_faces == 2
    passed = sorted(entry for face in body.face_parts for entry in face.loop)
    assert passed == sorted((j, s) for j in range(body.n_edges) for s in (-1, 1))


@pytest.mark.parametrize(("n", "faces"), [(3, 6), (9, 6)])
def test_grid_points_on_a_cube_have_six_faces(n: int, faces: int) -> None:
    body = so.Body.from_points(grid_on_a_cube(n))
    assert (body.n_faces, body.n_edges, body.n_vertices) == (faces, 12, 8)
    assert body.check().slack == 0.0


def test_inner_rectangles_are_on_their_faces(points: Array) -> None:
    body = so.Body.from_points(points)
    found = 0
    for chart in range(body.n_faces):
        row = body.ints[L.CHARTS] + L.CHART_STRIDE * chart
        at = int(body.ints[row + L.CHART_REALS]) + L.INNER
        u0, u1, v0, v1 = body.reals[at : at + 4].tolist()
        if u0 <= u1:
            found += 1
            assert all(
                on_face(body.ints, body.reals, chart, u, v) for u in (u0, u1) for v in (v0, v1)
            )
    assert found > 0.8 * body.n_faces


def test_heights_are_those_of_all_points(rng: np.random.Generator) -> None:
    points, normals = rng.normal(size=(3000, 3)), ball(rng, 500)
    offsets = (normals @ points.T).max(axis=1) + rng.normal(scale=0.1, size=500)
    exact = np.maximum((normals @ points.T).max(axis=1) - offsets, 0.0)
    heights, numbers = highest(points, normals, offsets)
    assert heights == pytest.approx(exact, abs=1e-14)
    above = numbers >= 0
    assert np.array_equal(above, heights > 0.0)
    own = np.einsum("ij,ij->i", normals[above], points[numbers[above]]) - offsets[above]
    assert own == pytest.approx(heights[above], abs=1e-14)


def between(P: Array, Q: Array) -> tuple[float, float]:
    """(lower, upper) bounds of the distance of two hulls that are apart, by a quadratic program.

    Its active points give the nearest ones; these bound it from above, and the plane square to
    their line, with every point on its side, from below.
    """
    m, n, weight = len(P), len(Q), 1e3
    ones = np.zeros((2, m + n))
    ones[0, :m] = ones[1, m:] = 1.0
    points = np.hstack([P.T, -Q.T])
    target = np.array([0.0, 0.0, 0.0, weight, weight])
    active = np.flatnonzero(nnls(np.vstack([points, weight * ones]), target, maxiter=10_000)[0])
    while True:  # the sums exactly 1, and no share below 0
        D, sums, k = points[:, active], ones[:, active], len(active)
        system = np.block([[D.T @ D, sums.T], [sums, np.zeros((2, 2))]])
        known = np.concatenate([np.zeros(k), [1.0, 1.0]])
        shares = np.linalg.lstsq(system, known, rcond=None)[0][:k]
        if shares.min() >= 0.0:
            break
        active = np.delete(active, shares.argmin())
    apart = -D @ shares
    upper = float(np.linalg.norm(apart))
    normal = apart / upper
    return float((Q @ normal).min() - (P @ normal).max()), upper


def apart(rng: np.random.Generator, reach: float) -> so.Pose:
    away = rng.normal(size=3)
    return so.Pose(turned(rng), reach * away / np.linalg.norm(away))


def test_distances_are_those_of_a_quadratic_program(
    points: Array, rng: np.random.Generator
) -> None:
    other = rng.normal(size=(60, 3)) * [0.3, 0.5, 0.2]
    a, b = so.Body.from_points(points), so.Body.from_points(other)
    reach = float(np.linalg.norm(points, axis=1).max() + np.linalg.norm(other, axis=1).max())
    for factor in (1.01, 1.3, 4.0):
        pose = apart(rng, factor * reach)
        answer = so.distance(a, b, so.Pose.identity(), pose)
        low, high = between(points, other @ pose.rotation.T + pose.translation)
        assert high - low <= 1e-11 * reach  # else the program is no judge
        assert answer.certified
        assert answer.lower_bound <= high + 1e-13 * reach
        assert low - 1e-13 * reach <= answer.distance
        assert answer.distance == pytest.approx(high, abs=1e-11 * reach)


def check_law(body: so.Body, fine: so.Body, other: so.Body, reach: float, rng: Any) -> None:
    """lower_bound <= the distance of the hull of all points <= distance, anywhere round it."""
    slack = body.check().slack
    for _ in range(15):
        pose = apart(rng, reach)
        answer = so.distance(body, other, so.Pose.identity(), pose)
        exact = so.distance(fine, other, so.Pose.identity(), pose)
        assert answer.certified
        assert exact.certified
        assert answer.lower_bound <= exact.distance
        assert exact.lower_bound <= answer.distance + 1e-13
        assert answer.distance - answer.lower_bound <= slack + 1e-8


@pytest.mark.parametrize("noise", [1e-8, 1e-5, 1e-3])
def test_rough_faces_become_few_within_what_is_told(noise: float, rng: np.random.Generator) -> None:
    points = grid_on_a_cube() @ turned(rng).T
    points = points + noise * rng.uniform(-1.0, 1.0, size=points.shape)
    fine, body = so.Body.from_points(points), so.Body.from_points(points, tolerance=10.0 * noise)
    report = body.check()
    assert fine.n_faces > 30
    assert body.n_faces <= 12
    assert body.n_vertices == 8
    assert 0.1 * noise < report.convexity_defect <= report.slack <= 10.0 * noise
    assert "points left out: they are inside the hull of the others, or up to" in report.notes[0]
    normals, offsets = planes(body)
    heights = (normals @ points.T - offsets[:, None]).max()
    assert heights == pytest.approx(report.convexity_defect, rel=1e-6)
    check_law(body, fine, so.shapes.ellipsoid(0.4, 0.3, 0.2), 2.4, rng)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-2, 0.1])
def test_fewer_facets_keep_the_law_on_a_ball(tolerance: float, rng: np.random.Generator) -> None:
    points = ball(rng, 800)
    fine, body = so.Body.from_points(points), so.Body.from_points(points, tolerance=tolerance)
    report = body.check()
    assert body.n_faces < fine.n_faces
    assert report.convexity_defect <= tolerance
    normals, offsets = planes(body)
    heights = (normals @ points.T - offsets[:, None]).max()
    assert heights == pytest.approx(report.convexity_defect, rel=1e-6)
    check_law(body, fine, so.shapes.box(0.5, 0.4, 0.3), 1.6, rng)
    check_law(body, fine, so.Body.from_points(0.3 * ball(rng, 100)), 1.5, rng)


def test_a_body_of_fewer_facets_tracks(rng: np.random.Generator) -> None:
    body = so.Body.from_points(ball(rng, 400), tolerance=3e-3)
    other = so.shapes.ellipsoid(0.3, 0.2, 0.1)
    tracker = so.Tracker(body, other, dt=1e-2)
    here = so.Pose.identity()
    turns = np.linspace(0.0, 2.0 * np.pi, 200)
    places = [so.Pose(np.eye(3), 1.5 * np.array([np.cos(t), np.sin(t), 0.2])) for t in turns]
    state = tracker.start(here, places[0])
    for place in places[1:]:
        state, answer = tracker.step(state, here, place)
        cold = so.distance(body, other, here, place)
        assert answer.certified
        assert answer.distance == pytest.approx(cold.distance, abs=1e-9)


@pytest.mark.parametrize(("mirrored", "tolerance"), share(2, [False, True], [None, 1e-2]))
def test_images_are_the_hulls_of_the_images(
    mirrored: bool, tolerance: float | None, rng: np.random.Generator
) -> None:
    points = np.concatenate([ball(rng, 300), grid_on_a_cube(5) * 0.7])
    body = so.Body.from_points(points, tolerance=tolerance)
    linear, shift = turned(rng) @ np.diag([1.0, 2.0, 0.5]) @ turned(rng), rng.normal(size=3)
    linear = -linear if mirrored else linear
    image = body.transformed((linear, shift))
    cloud = points @ linear.T + shift
    assert (image.n_faces, image.n_edges) == (body.n_faces, body.n_edges)
    assert image.vertex_points == pytest.approx(body.vertex_points @ linear.T + shift)
    normals, offsets = planes(image)
    heights = (normals @ cloud.T - offsets[:, None]).max()
    # what was left out is still in the slack
    assert heights <= image.check().slack + 1e-13
    again = so.Body.from_brep(image.vertex_points, image.edge_parts, image.face_parts)
    assert np.array_equal(again.ints, image.ints)


def test_the_same_points_give_the_same_body(rng: np.random.Generator) -> None:
    points = ball(rng, 100)
    one, other = so.Body.from_points(points), so.Body.from_points(points.tolist())
    assert one.digest == other.digest
    assert one.digest == so.shapes.polytope(points).digest
    # vertices keep the order of the points
    places = [int(np.flatnonzero((points == v).all(axis=1))[0]) for v in one.vertex_points]
    assert places == sorted(places)


def test_stored_and_read_again(rng: np.random.Generator) -> None:
    body = so.Body.from_points(ball(rng, 60), rounding=0.1, name="egg")
    edge = body.edge_parts[3]
    again, part = pickle.loads(pickle.dumps((body, edge)))
    assert again.digest == body.digest
    assert again.name == "egg"
    assert again.edge_parts[3] is part
    assert not again.ints.flags.writeable
    pose = so.Pose(np.eye(3), (3.0, 0.1, 0.2))
    answers = [so.distance(b, body, so.Pose.identity(), pose) for b in (body, again)]
    assert answers[0].distance == answers[1].distance


def test_parts_are_made_once_and_read_as_a_sequence() -> None:
    body = so.Body.from_points(grid_on_a_cube(3))
    assert len(body.edge_parts) == 12
    assert body.edge_parts[-1] is body.edge_parts[11]
    assert body.face_parts[1:3] == (body.face_parts[1], body.face_parts[2])
    assert [e.first for e in body.edge_parts] == [body.edge_parts[k].first for k in range(12)]
    with pytest.raises(IndexError):
        body.edge_parts[12]
    assert body.check().patches[5].convex


def test_rounding_grows_the_hull_all_round(rng: np.random.Generator) -> None:
    points = ball(rng, 50)
    sharp, body = so.Body.from_points(points), so.Body.from_points(points, rounding=0.25)
    assert body.size == pytest.approx(sharp.size + 0.5)
    other, pose = so.shapes.sphere(0.1), so.Pose(np.eye(3), (3.0, 0.0, 0.5))
    gaps = [so.distance(b, other, so.Pose.identity(), pose).distance for b in (sharp, body)]
    assert gaps[0] - gaps[1] == pytest.approx(0.25, abs=1e-13)


def test_points_far_from_the_origin_are_told(rng: np.random.Generator) -> None:
    body = so.Body.from_points(ball(rng, 60) + np.array([1e7, 0.0, 0.0]))
    assert body.check().notes[0].startswith("recentred: the hull is computed about")
    assert body.n_faces == 116


def test_planar_points_make_a_planar_body(rng: np.random.Generator) -> None:
    points = rng.normal(size=(200, 2))
    body = so.Body.from_points(points)
    hull = ConvexHull(points)
    assert body.dimension == 2
    assert {tuple(v) for v in body.vertex_points[:, :2]} == {
        tuple(v) for v in points[hull.vertices]
    }
    other = so.shapes.planar_loop([so.geometry.ConicArc((0, 0), (1, 0), (0, 1))])
    pose = so.Pose(np.eye(3), (9.0, 1.0, 0.0))
    answer = so.distance(body, other, so.Pose.identity(), pose)
    circle = 2.0 * np.pi * np.arange(720) / 720
    rim = np.column_stack([np.cos(circle), np.sin(circle)]) + np.array([9.0, 1.0])
    flat = [np.column_stack([x, np.zeros(len(x))]) for x in (points, rim)]
    assert answer.lower_bound <= between(*flat)[1]
    assert answer.distance == pytest.approx(between(*flat)[1], abs=1e-4)


SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])


@pytest.mark.parametrize(
    ("points", "words"),
    [
        ([], r"points has shape \(0,\)"),
        (TETRAHEDRON[:3], "3 points span no volume.*at least four points"),
        (SQUARE, "4 points span no volume.*not in one plane"),
        (np.repeat(SQUARE, 50, axis=0), "200 points span no volume"),
        (np.outer(np.arange(9.0), [1.0, 2.0, 3.0]), "9 points span no volume"),
        (np.ones((7, 3)), "7 points span no volume"),
        (1e-60 * TETRAHEDRON, "4 points extend over 1e-60"),
        (np.ones((4, 4)), r"points has shape \(4, 4\)"),
        (np.ones((2, 4, 3)), r"points has shape \(2, 4, 3\)"),
        ("cube", "points is not numeric"),
        ([[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]], "3 points span no area.*so.shapes.segment"),
        ([[0.0, 0.0], [1.0, 1.0]], "2 points span no area"),
    ],
)
def test_what_is_no_hull_is_refused(points: object, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        so.Body.from_points(points)


def test_the_first_bad_point_is_named(rng: np.random.Generator) -> None:
    points = ball(rng, 5000)
    points[4321, 1] = np.nan
    with pytest.raises(so.StandoffError, match=r"^points\[4321\] has a NaN or infinite") as caught:
        so.Body.from_points(points)
    assert caught.value.argument == "points"
    points[1234, 0] = 1e60
    with pytest.raises(so.StandoffError, match=r"^points\[1234\] has a number beyond 1e\+50"):
        so.Body.from_points(points)


def test_points_too_near_to_one_plane_are_told(rng: np.random.Generator) -> None:
    points = rng.uniform(size=(40, 3)) * [1.0, 1.0, 1e-14]
    with pytest.raises(so.BodyError, match=r"points (are too nearly in one plane|span no volume)"):
        so.Body.from_points(points)


def test_tolerances() -> None:
    for bad in (0.0, -1.0, np.nan):
        with pytest.raises(ValueError, match="tolerance = "):
            so.Body.from_points(TETRAHEDRON, tolerance=bad)
    # the extreme points stay, whatever the tolerance
    assert so.Body.from_points(TETRAHEDRON, tolerance=2.0).n_faces == 4
    with pytest.raises(ValueError, match=r"rounding = -0\.1"):
        so.Body.from_points(TETRAHEDRON, rounding=-0.1)
