"""Spheres, capsules and other bodies with a radius beside solids: as `so.distance` of convex bodies
answers, closed forms, and places that are exact by construction."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import standoff as so
from draws import draws
from families.solid_shapes import bracket, socket, tube
from standoff.bodies import Body
from standoff.bodies.enclosed import enclosed_by
from standoff.bodies.features import Feature
from standoff.bodies.rounding.build import rounded_boundary
from standoff.geometry import ConicArc, Line
from standoff.solids import Solid
from standoff.solids.spatial.models import as_model
from standoff.solids.spatial.pair import PlacedPair
from standoff.tracking.derivatives import Smoothness

STILL = so.Pose.identity()
R = 0.2
"""Of the ball that is swept, length."""


def at(x: float, y: float = 0.0, z: float = 0.0) -> so.Pose:
    return so.Pose(np.eye(3), [x, y, z])


@cache
def cloud() -> np.ndarray:
    return np.random.default_rng(3).normal(size=(9, 3))


SHAPES = {
    "sphere": lambda: so.shapes.sphere(0.7),
    "capsule": lambda: so.shapes.capsule(0.3, 1.2),
    "box": lambda: so.shapes.box((1.0, 2.0, 3.0), rounding=R),
    "polytope": lambda: so.shapes.polytope(cloud(), rounding=R),
    "rounded polytope": lambda: so.shapes.rounded_polytope(cloud(), 0.1),
    "cylinder": lambda: so.shapes.cylinder(0.5, 1.0, rounding=R),
    "flat cylinder": lambda: so.shapes.cylinder(0.1, 0.1, rounding=0.5),
    "cone": lambda: so.shapes.cone(0.5, 1.0, rounding=R),
    "cap": lambda: so.shapes.cap(1.0, 0.3, rounding=R),
    "large cap": lambda: so.shapes.cap(1.0, -0.5, rounding=R),
    "lens": lambda: so.shapes.lens(1.0, 0.4, rounding=R),
    "frustum": lambda: so.shapes.hull_of_revolution(Line((0.6, 0, 0), (0.3, 0, 1)), rounding=R),
    "turned circle": lambda: so.shapes.hull_of_revolution(
        ConicArc((0.6, 0, 0), (0.3, 0, 0), (0, 0, 0.3)), rounding=R
    ),
    "turned arc": lambda: so.shapes.hull_of_revolution(
        ConicArc((0, 0, 0), (1, 0, 0), (0, 0, 1), -0.5 * np.pi, 0.5), rounding=R
    ),
    "spindle": lambda: so.shapes.spindle(0.5, 2.0, rounding=R),
}


KINDS = ("face", "edge", "vertex")
FACES = {
    "sphere": (0, 0, 1),
    "capsule": (0, 1, 2),
    "box": (6, 12, 8),
    "polytope": (10, 15, 7),
    "rounded polytope": (10, 24, 16),
    "cylinder": (3, 2, 0),
    "flat cylinder": (3, 2, 0),
    "cone": (2, 1, 1),
    "cap": (2, 1, 0),
    "large cap": (2, 1, 0),
    "lens": (3, 3, 2),
    "frustum": (3, 2, 0),
    "turned circle": (3, 0, 0),
    "turned arc": (2, 1, 0),
    "spindle": (3, 0, 2),
}
"""How many faces of the boundary are swept from faces, edges and vertices of the core."""


@cache
def shape(name: str) -> Body:
    return SHAPES[name]()


@cache
def partners() -> list[tuple[Body, Solid]]:
    bodies = so.shapes.box((1.0, 1.5, 0.7)), so.shapes.cylinder(0.6, 1.0)
    return [(body, Solid(body)) for body in bodies]


TURNS = st.tuples(*[st.floats(-3.0, 3.0)] * 3).map(
    lambda vector: Rotation.from_rotvec(vector).as_matrix()
)
WAYS = (
    st.tuples(*[st.floats(-1.0, 1.0)] * 3)
    .filter(lambda way: np.linalg.norm(way) > 0.1)
    .map(lambda way: np.array(way) / np.linalg.norm(way))
)


@given(
    st.sampled_from(list(SHAPES)), st.integers(0, 1), TURNS, TURNS, WAYS, st.floats(0.0, 1.0)
)  # fmt: skip
def test_apart_they_are_as_near_as_convex_bodies(
    name: str, which: int, turn: np.ndarray, other: np.ndarray, way: np.ndarray, more: float
) -> None:
    """... with the core's own features and parameters."""
    body, (partner, solid) = shape(name), partners()[which]
    both = body.size + partner.size
    poses = so.Pose(turn, [0.3, -0.2, 0.1]), so.Pose(other, (0.5 + more) * both * way)
    told = so.distance(body, partner, *poses)
    found = so.solids.distance(body, solid, *poses)
    if told.distance <= 0.0:
        return
    assert found.certified
    assert found.distance == pytest.approx(told.distance, abs=1e-10 * both)
    assert found.lower_bound <= told.upper_bound
    assert told.lower_bound <= found.upper_bound
    if found.smoothness is Smoothness.SMOOTH:
        core = core_points(body, found.feature_a, found.parameters_a)
        spots = core @ poses[0].rotation.T + poses[0].translation + body.radius * found.normal
        assert np.linalg.norm(spots - found.point_a, axis=1).min() <= 1e-9 * both


def test_a_cone_s_parameters_are_those_of_its_core() -> None:
    """The moved cone begins at another apex, so that its v is another."""
    body, (partner, solid) = shape("cone"), partners()[0]
    for angle in (0.3, 2.0, -1.0):
        place = at(1.5 * np.cos(angle), 1.5 * np.sin(angle), 0.6)
        told = so.distance(body, partner, STILL, place)
        found = so.solids.distance(body, solid, STILL, place)
        assert told.feature_a == found.feature_a == Feature("face", 0)
        np.testing.assert_allclose(found.parameters_a[1], told.parameters_a[1], atol=1e-6)
        core = core_points(body, found.feature_a, found.parameters_a)
        np.testing.assert_allclose(core[0] + R * found.normal, found.point_a, atol=1e-12)


def core_points(body: Body, feature: Feature, parameters: tuple[float, ...]) -> np.ndarray:
    """(n, 3) what a feature of the core and parameters stand for, on each of a face's charts."""
    if feature.kind == "vertex":
        return np.asarray(body.vertex_points)[[feature.index]]
    if feature.kind == "edge":
        return body.edge_parts[feature.index].curve.point(*parameters)[None]
    charts = body.face_parts[feature.index].charts
    return np.array([chart.jet(*parameters)[0] for chart in charts])


@pytest.mark.parametrize("name", SHAPES)
def test_points_are_as_far_from_the_boundary_as_from_the_convex_body(
    name: str, rng: np.random.Generator
) -> None:
    body = shape(name)
    points = rng.normal(size=(draws(30), 3)) * 0.6 * body.size
    told = as_signed(body).signed_distance(points)
    assert told.converged.all()
    for point, distance in zip(points, told.distance, strict=True):
        found = so.distance(body, so.shapes.point(), STILL, at(*point))
        if found.distance > 0.0:
            assert distance == pytest.approx(found.distance, abs=1e-12 * body.size)
        else:
            assert distance < 0.0
            assert distance == pytest.approx(found.distance, abs=1e-9 * body.size)


@cache
def as_signed_by_name(name: str) -> Solid:
    return Solid(shape(name))


def as_signed(body: Body) -> Solid:
    return as_signed_by_name(next(name for name in SHAPES if shape(name) is body))


def test_a_rounded_box_in_closed_form(rng: np.random.Generator) -> None:
    half = 0.5 * np.array([1.0, 2.0, 3.0]) - R
    points = rng.uniform(-2.0, 2.0, (60, 3))
    over = np.abs(points) - half
    closed = np.linalg.norm(np.maximum(over, 0.0), axis=1) + np.minimum(over.max(axis=1), 0.0) - R
    told = as_signed_by_name("box").signed_distance(points)
    assert np.abs(told.distance - closed).max() <= 1e-12 * shape("box").size


def steiner(volume: float, area: float, mean: float, r: float) -> tuple[float, float]:
    """(volume, area) of a convex body moved out by r, from its integral of the mean curvature."""
    ball = 4.0 / 3.0 * np.pi * r**3
    return volume + area * r + mean * r**2 + ball, area + 2.0 * mean * r + 3.0 * ball / r


def angles_of(points: np.ndarray) -> tuple[float, float, float]:
    """(volume, area, half the sum of lengths times outer angles) of a polytope's corners."""
    core = Solid(so.shapes.polytope(points)).boundary
    mean = 0.0
    for j, edge in enumerate(core.edge_parts):
        normals = []
        for face in core.face_parts:
            if any(j == k for k, _ in face.loop):
                n = np.cross(*face.charts[0].linear[:, :2].T)
                normals.append(n / np.linalg.norm(n) * np.sign(n @ face.charts[0].shift))
        length = np.linalg.norm(edge.curve.point(1.0) - edge.curve.point(0.0))
        mean += 0.5 * float(length) * float(np.arccos(np.clip(normals[0] @ normals[1], -1, 1)))
    found = enclosed_by(core, range(core.n_faces), 1e-9)
    return found.volume, found.area, mean


@pytest.mark.parametrize(
    ("name", "core"),
    [
        ("sphere", lambda: (0.0, 0.0, 0.0)),
        ("capsule", lambda: (0.0, 0.0, np.pi * 1.2)),
        ("box", lambda: (0.6 * 1.6 * 2.6, 2 * (0.96 + 1.56 + 4.16), np.pi * 4.8)),
        ("cylinder", lambda: (np.pi * 0.25, np.pi * 1.5, np.pi + np.pi**2 * 0.5)),
        ("polytope", lambda: angles_of(cloud())),
    ],
)
def test_volume_and_area_are_steiner_s(name: str, core: object) -> None:
    body = shape(name)
    boundary = rounded_boundary(body).boundary
    volume, area = steiner(*core(), body.radius)  # type: ignore[operator]
    found = enclosed_by(boundary, range(boundary.n_faces), 1e-10)
    assert found.volume == pytest.approx(volume, rel=1e-9)
    assert found.area == pytest.approx(area, rel=1e-7)


@pytest.mark.parametrize("name", SHAPES)
def test_the_parts_of_the_boundary_join_smoothly(name: str) -> None:
    built = rounded_boundary(shape(name))
    assert {str(kind) for kind in built.boundary.edge_kinds} <= {"smooth"}
    assert built.boundary.report.slack == 0.0
    counts = built.boundary.n_faces, built.boundary.n_edges, built.boundary.n_vertices
    assert len(built.origins) == sum(counts)
    told = [origin.feature for part, origin in built.origins.items() if part.kind == "face"]
    counts = tuple(sum(feature.kind == kind for feature in told) for kind in KINDS)
    assert counts == FACES[name]
    assert len(set(told)) == len(told)


def test_a_ball_in_a_round_cavity() -> None:
    ball = so.shapes.sphere(0.6)
    found = so.solids.distance(socket(1.0, 1.3), ball, STILL, STILL)
    assert found.status is so.Status.CONTINUUM
    assert found.continuum is not None
    assert found.distance == pytest.approx(0.4, abs=1e-14)
    found = so.solids.distance(socket(1.0, 1.3), ball, STILL, at(0.1, -0.2, 0.2))
    assert found.status is so.Status.CONVERGED
    assert found.distance == pytest.approx(0.1, abs=1e-12)
    assert found.feature_b == Feature("vertex", 0)
    assert found.parameters_b == ()
    np.testing.assert_allclose(found.point_b, np.array([0.1, -0.2, 0.2]) * 3.0, atol=1e-9)


def test_a_ball_and_a_capsule_in_a_hole() -> None:
    bush = tube(0.5, 1.0, -1.0, 1.0)
    found = so.solids.distance(bush, so.shapes.sphere(0.3), STILL, at(0.0))
    assert found.status is so.Status.CONTINUUM
    assert found.continuum is not None
    assert found.continuum.kind == "arc"
    assert found.distance == pytest.approx(0.2, abs=1e-14)
    capsule = so.shapes.capsule(0.3, 1.0)
    found = so.solids.distance(bush, capsule, STILL, at(0.0, 0.0, 0.1))
    assert found.status is so.Status.CONTINUUM
    assert found.continuum is not None
    assert found.continuum.kind == "surface"
    assert found.distance == pytest.approx(0.2, abs=1e-14)
    found = so.solids.distance(bush, capsule, STILL, at(0.03, 0.04, 0.1))
    assert found.status is so.Status.CONTINUUM
    assert found.continuum is not None
    assert found.continuum.kind == "line"
    assert found.distance == pytest.approx(0.15, abs=1e-12)
    ends = np.array([pair[1] for pair in found.continuum.ends])
    assert np.ptp(ends[:, 2]) == pytest.approx(1.0, abs=0.05)
    # the line ends at both vertices, so that the first pair may be one's
    assert Feature("edge", 0) in {pair.feature_b for pair in found.minima}


def test_a_ball_on_a_bracket_touches_it() -> None:
    found = so.solids.distance(bracket(), so.shapes.sphere(0.25), STILL, at(1.2, 0.65, 0.35))
    assert found.status is so.Status.TOUCHING
    assert found.distance == pytest.approx(0.0, abs=1e-12)
    np.testing.assert_allclose(found.normal, [0.0, 1.0, 0.0], atol=1e-6)
    # in its inner corner it touches both legs
    found = so.solids.distance(bracket(), so.shapes.sphere(0.25), STILL, at(0.65, 0.65, 0.35))
    assert found.status is so.Status.TOUCHING
    assert len(found.minima) == 2


def test_a_ball_inside_a_solid_tells_its_wall() -> None:
    block = Solid(so.shapes.box((4.0, 4.0, 4.0)))
    found = so.solids.distance(block, so.shapes.sphere(0.5), STILL, at(0.3, 0.1, -0.2))
    assert found.status is so.Status.CONTAINED
    assert found.inside == "B"
    assert found.distance == pytest.approx(2.0 - 0.3 - 0.5, abs=1e-12)
    found = so.solids.distance(block, so.shapes.sphere(0.5), STILL, at(2.2))
    assert found.status is so.Status.OVERLAPPING
    assert found.depth >= 0.29


def test_all_local_minima_of_a_ball_in_a_corner() -> None:
    found = so.solids.distance(
        bracket(), so.shapes.sphere(0.1), STILL, at(0.9, 0.8, 0.35), minima=0.6
    )
    assert [round(pair.distance, 9) for pair in found.minima] == [0.3, 0.4]
    assert {pair.feature_b for pair in found.minima} == {Feature("vertex", 0)}


def test_a_rounded_box_over_a_plate_has_one_set_of_nearest_pairs() -> None:
    plate = Solid(so.shapes.box((8.0, 8.0, 1.0)))
    found = so.solids.distance(plate, shape("box"), STILL, at(0.3, 0.2, 2.5), minima=0.9)
    assert found.status is so.Status.CONTINUUM
    assert [round(pair.distance, 9) for pair in found.minima] == [0.5]
    assert found.continuum is not None
    assert found.continuum.kind == "surface"


def test_the_slack_of_the_core_is_that_of_the_surface() -> None:
    corners = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)], dtype=float)
    points = np.vstack([corners, [[0.1, 0.2, 1.0001]]])  # the last is left out
    body = Body.from_points(points, tolerance=1e-3, rounding=R)
    assert body.report.slack > 1e-5
    assert Solid(body).slack >= body.report.slack
    assert Solid(body).name == body.name


def test_the_gradient_is_that_of_the_body_s_own_frame(rng: np.random.Generator) -> None:
    body, solid = shape("box"), partners()[0][1]
    poses = at(0.0), so.Pose(Rotation.from_rotvec([0.4, 0.9, -0.3]).as_matrix(), [2.0, 2.2, 0.4])
    found = so.solids.distance(body, solid, *poses)
    assert found.smoothness is Smoothness.SMOOTH
    step = 1e-5
    for k in range(12):
        ends = []
        for sign in (1.0, -1.0):
            twist = np.zeros(12)
            twist[k] = sign * step
            moved = [
                so.Pose(
                    Rotation.from_rotvec(twist[o + 3 : o + 6]).as_matrix() @ pose.rotation,
                    pose.translation + twist[o : o + 3],
                )
                for o, pose in zip((0, 6), poses, strict=True)
            ]
            ends.append(so.solids.distance(body, solid, *moved).distance)
        assert (ends[0] - ends[1]) / (2.0 * step) == pytest.approx(found.gradient[k], abs=1e-5)


def test_what_has_no_exact_surface_is_refused_by_its_kind() -> None:
    block = partners()[0][1]
    for body, words in (
        (so.shapes.ellipsoid(1.0, 2.0, 3.0, rounding=0.1), "face 0, a Sphere, has no exact"),
        (so.shapes.superellipsoid((1.0, 1.0, 1.0), (0.5, 0.5), rounding=0.1), "rounded by 0.1"),
        (so.shapes.egg(1.0, 3.0, rounding=0.1), "has no exact surface"),
        (so.shapes.gore(0.5, 2.0, rounding=0.1), "face 0, a BezierPatch"),
        (so.shapes.segment(1.0), "a radius makes it"),
        (so.shapes.planar_loop([ConicArc([0, 0, 0], [1, 0, 0], [0, 1, 0])]), "planar"),
    ):
        with pytest.raises(ValueError, match=words):
            so.solids.distance(block, body, STILL, at(9.0))
    with pytest.raises(ValueError, match="is not bounded"):
        Solid(so.shapes.halfspace())


def test_a_picture_marks_the_part_that_is_told() -> None:
    body, solid = shape("box"), partners()[0][1]
    found = so.solids.distance(body, solid, STILL, at(2.0, 2.2, 0.3))
    pair = PlacedPair(as_model(body), as_model(solid), STILL, at(2.0, 2.2, 0.3))
    part = pair.a.part_told(found.feature_a)
    assert found.feature_a.kind == "edge"
    assert rounded_boundary(body).origins[part].feature == found.feature_a
    figure = so.plot(body, solid, found)
    assert any(f"{found.feature_a}" in text.get_text() for text in figure.legends[0].get_texts())
