"""The ground truth against known values, against itself, and against denser brute force."""

import ast
from itertools import combinations_with_replacement
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff_studies.oracles
from draws import draws
from oracles import closed_forms
from oracles.bounds import gap, maximise_separation, overlap, separation
from oracles.brute import _proves, nearest_points, nearest_polytopes
from oracles.exact_pairs import exact_pair, random_normal, random_rotation
from oracles.features import feature_at
from oracles.loops import BezierCurve, ConicArc, PlanarLoop, line
from oracles.poses import draw_poses, rotation_about, size_of, tilted_pair
from oracles.surfaces import placed_quadrics, quadrics
from standoff_studies.oracles import (
    Affine,
    Box,
    Cap,
    Capsule,
    Cone,
    Cylinder,
    Ellipsoid,
    HalfSpace,
    Lens,
    Placed,
    Point,
    Polytope,
    Segment,
    Sphere,
)

LENS = Lens(1.0, 0.45)
PLANAR = PlanarLoop(
    [
        BezierCurve([(1, 0), (0.775, 0.645), (0.175, 1.005), (-0.5, 0.9)]),
        BezierCurve([(-0.5, 0.9), (-0.87, 0.41), (-0.91, -0.27), (-0.6, -0.8)]),
        BezierCurve([(-0.6, -0.8), (0.12, -1.04), (0.76, -0.72), (1, 0)]),
    ]
)
HALF_DISC = PlanarLoop([ConicArc((0, 0), (1, 0), (0, 1), 0, np.pi), line((-1, 0), (1, 0))])
ROCK = Polytope(np.random.default_rng(7).normal(size=(14, 3)))
SKEW = Affine(LENS, [[0.8, 0.1, 0.0], [0.0, 0.6, 0.2], [0.0, 0.0, 0.7]], (0.1, -0.2, 0.3))
SOLIDS = {
    "point": Point(),
    "segment": Segment(1.5),
    "sphere": Sphere(0.7),
    "ellipsoid": Ellipsoid(1.0, 0.5, 0.1),
    "capsule": Capsule(0.2, 1.0),
    "cylinder": Cylinder(0.5, 2.0),
    "cone": Cone(0.5, 1.2),
    "box": Box(1, 2, 3),
    "rounded box": Box(1, 2, 3, 0.2),
    "polytope": ROCK,
    "lens": LENS,
    "two-ball lens": Lens(1.0, 0.4, 2),
    "five-ball lens": Lens(1.0, 0.5, 5),
    "cap": Cap(1.0, 0.3),
    "affine lens": SKEW,
}
SYSTEMS = {name: shape for name, shape in SOLIDS.items() if name not in ("cone",)}


def placed(shape, vector=(0, 0, 0), position=(0, 0, 0)):
    return Placed(shape, Rotation.from_rotvec(vector).as_matrix(), position)


def inside_samples(shape, rng, count=20000):
    """Points of the shape by rejection on its membership test, not on its support."""
    box = rng.uniform(-1, 1, (count, 3)) * shape.bounding_radius
    if isinstance(shape, Cone):
        slope = shape.radius / shape.height * (shape.height / 2 - box[:, 2])
        return box[(np.hypot(box[:, 0], box[:, 1]) <= slope) & (box[:, 2] >= -shape.height / 2)]
    system = quadrics(shape)
    return box[[(system.values(point) <= 0).all() for point in box]]


def test_nothing_imports_the_library():
    shared = Path(standoff_studies.oracles.__file__).parent
    for path in (*Path(__file__).parent.glob("*.py"), *shared.glob("*.py")):
        for node in ast.walk(ast.parse(path.read_text())):
            names = [a.name for a in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            for name in names:
                top, *rest = name.split(".")
                assert top != "standoff", path.name
                assert top != "standoff_studies" or rest[0] == "oracles", path.name


@pytest.mark.parametrize("name", SOLIDS)
def test_support_points_belong_and_are_extreme(name):
    shape, rng = SOLIDS[name], np.random.default_rng(11)
    normals = rng.normal(size=(300, 3))
    values, points = shape.support_many(normals)
    np.testing.assert_allclose(values, (normals * points).sum(axis=1), rtol=0, atol=1e-14)
    assert np.linalg.norm(points, axis=1).max() <= shape.bounding_radius * (1 + 1e-14)
    # Each support point is a point of the shape, so no other direction's may lie farther.
    assert (normals @ points.T <= values[:, None] + 1e-12).all()
    for point in points[:40]:
        feature_at(shape, point, 1e-9)


@pytest.mark.parametrize(
    "name", ["ellipsoid", "cylinder", "cone", "box", "polytope", "lens", "five-ball lens", "cap"]
)
def test_support_bounds_samples_and_is_nearly_reached(name):
    shape, rng = SOLIDS[name], np.random.default_rng(12)
    samples = inside_samples(shape, rng)
    normals = rng.normal(size=(50, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    reached = (samples @ normals.T).max(axis=0)
    values = shape.support_many(normals)[0]
    assert (reached <= values + 1e-14).all()
    assert (values - reached).max() <= 0.25 * shape.bounding_radius


def test_support_values_by_hand():
    assert Box(1, 2, 3, 0.2).support((1, 0, 0))[0] == pytest.approx(0.5, abs=1e-15)
    corner = 0.3 + 0.8 + 1.3 + 0.2 * np.sqrt(3)
    assert Box(1, 2, 3, 0.2).support((1, 1, 1))[0] == pytest.approx(corner, abs=1e-14)
    assert Capsule(0.2, 1.0).support((0, 0, 1))[0] == pytest.approx(0.7, abs=1e-15)
    assert Cone(0.5, 1.2).support((0, 0, 1))[0] == pytest.approx(0.6, abs=1e-15)
    assert Cone(0.5, 1.2).support((1, 0, 0))[0] == pytest.approx(0.5, abs=1e-15)
    assert Cylinder(0.5, 2.0).support((0, 3, 4))[0] == pytest.approx(5.5, abs=1e-14)
    assert Ellipsoid(1, 0.5, 0.1).support((0, 1, 0))[0] == pytest.approx(0.5, abs=1e-15)
    assert LENS.support((1, 0, 0))[0] == pytest.approx(0.55, abs=1e-15)
    assert LENS.support((0, 0, 1))[0] == pytest.approx(np.sqrt(1 - 0.45**2), abs=1e-15)
    # Opposite to a ball's centre lies the circle of the other two spheres.
    rim = np.sqrt(1 - (0.45 * np.sqrt(3) / 2) ** 2) - 0.45 / 2
    assert LENS.support((-1, 0, 0))[0] == pytest.approx(rim, abs=1e-15)
    assert Cap(1.0, 0.3).support((1, 0, 0))[0] == pytest.approx(np.sqrt(0.91), abs=1e-15)
    assert Cap(1.0, 0.3).support((0, 0, -1))[0] == pytest.approx(-0.3, abs=1e-15)
    assert HalfSpace().support((0, 0, 2))[0] == 0
    assert HalfSpace().support((1e-9, 0, 2))[0] == np.inf


def test_planar_support():
    rng = np.random.default_rng(13)
    normals = np.array([random_normal(rng, planar=True) for _ in range(200)])
    for loop in (PLANAR, HALF_DISC):
        dense = np.vstack([c.jet(np.linspace(*c.span, 20001))[0] for c in loop.curves])
        values, points = loop.support_many(normals)
        excess = values - (normals[:, :2] @ dense.T).max(axis=1)
        assert excess.min() >= -1e-15
        assert excess.max() <= 1e-8
        assert (points[:, 2] == 0).all()
    upper = HALF_DISC.support((0.6, 0.8, 0))
    assert upper[0] == pytest.approx(1, abs=1e-15)
    # A quarter circle as a rational curve is the same as the conic arc.
    quarter = BezierCurve([(1, 0), (1, 1), (0, 1)], [1, np.sqrt(0.5), 1])
    arc = quarter.jet(np.linspace(0, 1, 9))
    np.testing.assert_allclose(np.linalg.norm(arc[0], axis=1), 1, atol=1e-15)
    assert np.abs((arc[0] * arc[1]).sum(axis=1)).max() <= 1e-15
    step = 1e-5
    t = np.array([0.3])
    change = (quarter.jet(t + step)[1] - quarter.jet(t - step)[1]) / (2 * step)
    np.testing.assert_allclose(quarter.jet(t)[2], change, rtol=1e-8)
    with pytest.raises(ValueError, match="misses the next"):
        PlanarLoop([line((0, 0), (1, 0)), line((1, 0.1), (0, 0))])


def test_affine_and_placed_agree():
    rng = np.random.default_rng(14)
    rotation, shift = random_rotation(rng), rng.normal(size=3)
    normals = rng.normal(size=(50, 3))
    image = Affine(ROCK, rotation, shift).support_many(normals)
    world = Placed(ROCK, rotation, shift).support_many(normals)
    moved = (ROCK.vertices @ rotation.T + shift) @ normals.T
    np.testing.assert_allclose(image[0], moved.max(axis=0), atol=1e-14)
    np.testing.assert_allclose(world[0], moved.max(axis=0), atol=1e-14)


GOLDEN = [
    (LENS, placed(Point(), position=(1.2, 0.3, 0.4)), 0.724093964957, 1e-11),
    (LENS, placed(Point(), position=(0.1, 0.05, 1.5)), 0.617182578397, 1e-11),
    (
        LENS,
        placed(Affine(LENS, np.diag([0.8, 0.6, 0.7])), (0.7, -0.5, 0.9), (1.75, 0, 0)),
        0.833265668215,
        1e-11,
    ),
    (
        LENS,
        placed(Affine(LENS, np.diag([1.1, 0.7, 0.5])), (0.3, 0.2, 0.1), (1.9, 0.3, 0.2)),
        0.638234369589,
        1e-11,
    ),
]


@pytest.mark.parametrize(("shape", "other", "distance", "tolerance"), GOLDEN)
def test_golden_distances(shape, other, distance, tolerance):
    a = placed(shape)
    found = maximise_separation(a, other)
    assert found.value == pytest.approx(distance, abs=tolerance)
    assert found.upper - found.value <= 1e-12
    assert nearest_points(a, other).distance == pytest.approx(distance, abs=tolerance)


def test_golden_ellipsoids():
    a = placed(Ellipsoid(0.15, 0.30, 0.20), position=(1.5, 0, -0.5))
    b = placed(Ellipsoid(0.10, 0.10, 0.15), position=(1.5, 0.5, 0.5))
    found = nearest_points(a, b)
    assert found.distance == pytest.approx(0.75426646628621, abs=2e-14)
    np.testing.assert_allclose(found.normal, (0, 0.405151815529, 0.914249422408), atol=1e-12)
    assert maximise_separation(a, b).value == pytest.approx(found.distance, abs=1e-13)


def test_golden_planar():
    first = closed_forms.point_loop((1.5, 0.4), PLANAR)
    assert first[:2] == (pytest.approx(0.614435369167, abs=1e-11), 0)
    assert first[2] == pytest.approx(0.07527316, abs=1e-8)
    second = closed_forms.point_loop((1.6, 0.05), PLANAR)
    assert second[0] == pytest.approx(0.602079728940, abs=1e-11)
    assert feature_at(PLANAR, second[3]).kind == "vertex"
    third = closed_forms.point_loop((0.1, 0.05), PLANAR)
    assert third[:2] == (pytest.approx(-0.742667779143, abs=1e-11), 0)
    assert third[2] == pytest.approx(0.40068024, abs=1e-8)
    found = maximise_separation(placed(PLANAR), placed(Point(), position=(1.5, 0.4, 0)))
    assert found.value == pytest.approx(first[0], abs=1e-12)
    assert feature_at(PLANAR, first[3]).surfaces == {"curve0"}


def test_lens_point_closed_form():
    assert closed_forms.point_lens((1.2, 0.3, 0.4), LENS)[0] == pytest.approx(
        0.724093964957, abs=1e-11
    )
    assert closed_forms.point_lens((0.1, 0.05, 1.5), LENS)[0] == pytest.approx(
        0.617182578397, abs=1e-11
    )


CLOSED = {
    "segment": lambda p, s: closed_forms.point_segment(p, s.vertices[0], s.vertices[1]),
    "box": closed_forms.point_box,
    "rounded box": closed_forms.point_box,
    "ellipsoid": closed_forms.point_ellipsoid,
    "cylinder": closed_forms.point_cylinder,
    "cone": closed_forms.point_cone,
    "cap": closed_forms.point_cap,
    "lens": closed_forms.point_lens,
    "two-ball lens": closed_forms.point_lens,
    "five-ball lens": closed_forms.point_lens,
}


@pytest.mark.parametrize("name", CLOSED)
def test_closed_forms_against_separation(name):
    shape, rng = SOLIDS[name], np.random.default_rng(15)
    body = placed(shape)
    for _ in range(draws(60)):
        n = random_normal(rng)
        point = shape.support(n)[1] + n * np.exp(rng.uniform(-7, 1)) + 0.3 * random_normal(rng)
        if overlap(body, placed(Point(), position=point)):
            continue
        known = maximise_separation(body, placed(Point(), position=point))
        distance, nearest = CLOSED[name](point, shape)
        assert distance == pytest.approx(known.value, abs=1e-11)
        assert gap(distance, body, placed(Point(), position=point), point - nearest) <= 1e-11
        feature_at(shape, nearest, 1e-9)


@pytest.mark.parametrize("name", ["box", "ellipsoid", "cone", "cap", "lens"])
def test_closed_forms_refuse_inside(name):
    inside = (0, 0, 0.6) if name == "cap" else (0, 0, 0)
    with pytest.raises(ValueError, match="inside"):
        CLOSED[name](inside, SOLIDS[name])


def test_spheres_segments_and_planes():
    found = closed_forms.sphere_sphere((0, 0, 0), 0.7, (3, 4, 0), 1.0)
    assert found[0] == pytest.approx(3.3, abs=1e-15)
    known = maximise_separation(placed(Sphere(0.7)), placed(Sphere(1.0), position=(3, 4, 0)))
    assert known.value == pytest.approx(3.3, abs=1e-12)
    assert closed_forms.point_plane((1, 2, 3), (0, 0, 2), (5, 5, 1))[0] == 2
    rng = np.random.default_rng(16)
    for _ in range(100):
        bodies = [placed(Segment(1.5), rng.normal(size=3), rng.normal(size=3)) for _ in range(2)]
        ends = [body.shape.vertices @ body.rotation.T + body.position for body in bodies]
        distance, x, y = closed_forms.segment_segment(*ends[0], *ends[1])
        assert distance == pytest.approx(np.linalg.norm(x - y), abs=1e-15)
        assert distance == pytest.approx(maximise_separation(*bodies).value, abs=1e-12)
    parallel = closed_forms.segment_segment((0, 0, 0), (1, 0, 0), (0.5, 1, 0), (2, 1, 0))
    assert parallel[0] == 1


def test_half_space():
    box = placed(Box(1, 2, 3, 0.2), (0.3, -0.4, 0.8), (0.2, 0.1, 4.0))
    plane = placed(HalfSpace(), (0.1, 0.2, 0.0), (0, 0, 0.5))
    distance, x, y = closed_forms.body_halfspace(box, plane)
    assert distance == pytest.approx(np.linalg.norm(x - y), abs=1e-15)
    normal = plane.rotation[:, 2]
    corners = box.shape.core.vertices @ box.rotation.T + box.position - plane.position
    assert distance == pytest.approx((corners @ normal).min() - 0.2, abs=1e-14)
    assert separation(box, plane, -normal) == pytest.approx(distance, abs=1e-15)
    assert separation(plane, box, normal + 1e-12) == pytest.approx(distance, abs=1e-15)
    assert separation(plane, box, (1, 0, 0)) == -np.inf
    assert maximise_separation(plane, box).value == pytest.approx(distance, abs=1e-15)
    other = placed(HalfSpace(), (np.pi, 0, 0), (0, 0, 2.0))
    assert maximise_separation(placed(HalfSpace()), other).value == pytest.approx(2.0)
    assert overlap(placed(HalfSpace()), plane)


def pairs_of(names):
    """Each with itself and, in every run, with every other of the others."""
    return [
        pytest.param(a, b, marks=[pytest.mark.soak] if (i + j) % 2 else [])
        for (i, a), (j, b) in combinations_with_replacement(enumerate(sorted(names)), 2)
    ]


@pytest.mark.parametrize(("name_a", "name_b"), pairs_of(SOLIDS))
def test_exact_pairs_are_exact(name_a, name_b):
    a, b = SOLIDS[name_a], SOLIDS[name_b]
    rng = np.random.default_rng(17)
    size = size_of(a, b)
    for width in (1e-3, 0.1, 1.0):
        pair = exact_pair(a, b, width * size, rng, position_a=rng.normal(size=3))
        assert pair.distance == pytest.approx(width * size, abs=1e-14 * (size + 1))
        between = pair.point_b - pair.point_a
        np.testing.assert_allclose(between, pair.distance * pair.normal, atol=4e-15 * (size + 1))
        lowest = separation(pair.a, pair.b, pair.normal)
        assert lowest == pytest.approx(pair.distance, abs=1e-14 * size)
        feature_at(a, pair.a.local(pair.point_a), 1e-9)
        feature_at(b, pair.b.local(pair.point_b), 1e-9)
        found = maximise_separation(pair.a, pair.b)
        assert found.value == pytest.approx(pair.distance, abs=1e-12 * size)
        assert not overlap(pair.a, pair.b)


def test_separation_never_exceeds_the_distance():
    rng = np.random.default_rng(18)
    for name_a, name_b in (("lens", "box"), ("cone", "cylinder"), ("ellipsoid", "capsule")):
        pair = exact_pair(SOLIDS[name_a], SOLIDS[name_b], 0.3, rng)
        for _ in range(200):
            assert separation(pair.a, pair.b, rng.normal(size=3)) <= pair.distance + 1e-14
            near = pair.normal + 1e-4 * rng.normal(size=3)
            assert gap(pair.distance, pair.a, pair.b, near) >= -1e-14


def test_overlap_and_depth():
    a = placed(Sphere(1.0))
    assert overlap(a, placed(Sphere(0.5), position=(1.2, 0, 0)))
    assert not overlap(a, placed(Sphere(0.5), position=(1.50001, 0, 0)))
    found = maximise_separation(a, placed(Sphere(0.5), position=(1.2, 0, 0)))
    assert found.value == pytest.approx(-0.3, abs=1e-9)
    assert found.upper == 0
    boxes = placed(Box(2, 2, 2)), placed(Box(2, 2, 2), position=(1.5, 0.1, 0.2))
    assert maximise_separation(*boxes).value == pytest.approx(-0.5, abs=1e-6)
    discs = placed(HALF_DISC), placed(HALF_DISC, position=(0, 0.9, 0))
    assert maximise_separation(*discs).value == pytest.approx(-0.1, abs=1e-6)
    rng = np.random.default_rng(19)
    for a_shape, b_shape in ((LENS, Box(1, 2, 3)), (Cone(0.5, 1.2), Ellipsoid(1, 0.5, 0.1))):
        for depth in (1e-6, 1e-2):
            # Pushed together along their normal, so that a common point exists.
            pair = exact_pair(a_shape, b_shape, -depth, rng)
            assert overlap(pair.a, pair.b)


@pytest.mark.parametrize(("name_a", "name_b"), pairs_of(SYSTEMS))
def test_nearest_points_are_proven_and_agree(name_a, name_b):
    a, b = SYSTEMS[name_a], SYSTEMS[name_b]
    size = size_of(a, b)
    for pose in draw_poses(a, b, 6, seed=20, gaps=(1e-3, 2.0)):
        found = nearest_points(pose.a, pose.b)
        between = found.point_b - found.point_a
        assert found.distance == pytest.approx(np.linalg.norm(between), abs=1e-14 * size)
        assert gap(found.distance, pose.a, pose.b, found.normal) == pytest.approx(
            0, abs=1e-11 * size
        )
        if pose.distance is not None:
            assert found.distance == pytest.approx(pose.distance, abs=1e-13 * (size + 1))


def test_nearest_points_against_exact_witnesses():
    rng = np.random.default_rng(21)
    for name in ("ellipsoid", "lens", "cylinder", "cap", "capsule", "affine lens"):
        for _ in range(10):
            pair = exact_pair(SOLIDS[name], LENS, np.exp(rng.uniform(-6, 0.5)), rng)
            found = nearest_points(pair.a, pair.b)
            np.testing.assert_allclose(found.point_a, pair.point_a, atol=1e-11)
            np.testing.assert_allclose(found.point_b, pair.point_b, atol=1e-11)
            np.testing.assert_allclose(found.normal, pair.normal, atol=1e-11)


def test_nearest_points_refuse_overlap_and_cones():
    with pytest.raises(ValueError, match="overlap"):
        nearest_points(placed(LENS), placed(LENS, position=(0.1, 0, 0)))
    with pytest.raises(TypeError, match="Cone"):
        nearest_points(placed(Cone(1, 1)), placed(LENS, position=(5, 0, 0)))


def test_warm_answers_equal_cold_ones():
    warm, kinds = None, set()
    other = Affine(LENS, np.diag([0.8, 0.6, 0.7]))
    for angle in np.linspace(0, 2 * np.pi, 120):
        place = 2.1 * np.array([np.cos(angle), np.sin(angle), 0.6 * np.sin(3 * angle)])
        b = placed(other, (angle, 0.5, -angle / 2), place)
        warm = nearest_points(placed(LENS), b, warm)
        cold = nearest_points(placed(LENS), b)
        assert warm.distance == pytest.approx(cold.distance, abs=1e-13)
        assert (warm.feature_a, warm.feature_b) == (cold.feature_a, cold.feature_b)
        kinds.add((warm.feature_a.kind, warm.feature_b.kind))
    assert len(kinds) >= 3


def test_polytopes_by_enumeration():
    kinds = set()
    shapes = [Box(1, 2, 3), ROCK, Box(0.5, 0.6, 0.7, 0.1)]
    for a, b in combinations_with_replacement(shapes, 2):
        for pose in draw_poses(a, b, 40, seed=22):
            found = nearest_polytopes(pose.a, pose.b)
            size = size_of(a, b)
            assert gap(found.distance, pose.a, pose.b, found.normal) == pytest.approx(
                0, abs=1e-12 * size
            )
            known = maximise_separation(pose.a, pose.b)
            assert found.distance == pytest.approx(known.value, abs=1e-12 * size)
            kinds.add((found.feature_a.kind, found.feature_b.kind))
    assert {("edge", "edge"), ("face", "vertex"), ("vertex", "vertex")} <= kinds
    with pytest.raises(TypeError, match="Lens"):
        nearest_polytopes(placed(LENS), placed(ROCK, position=(9, 0, 0)))


def test_features_by_hand():
    tip = np.sqrt(1 - 0.45**2)
    assert feature_at(LENS, (0.55, 0, 0)).surfaces == {"ball0"}
    assert feature_at(LENS, (0, 0, tip)).kind == "vertex"
    edge = LENS.support((-1, 0, 0))[1]
    assert feature_at(LENS, edge).surfaces == {"ball1", "ball2"}
    assert feature_at(LENS, edge).kind == "edge"
    assert feature_at(Box(1, 2, 3), (0.5, 0.2, 0.1)).surfaces == {"x+"}
    assert feature_at(Box(1, 2, 3), (0.5, -1.0, 0.1)).surfaces == {"x+", "y-"}
    assert feature_at(Box(1, 2, 3), (0.5, -1.0, 1.5)).dimension == 0
    rounded = Box(1, 2, 3, 0.2)
    assert feature_at(rounded, rounded.support((1, 1, 0))[1] * (1, 1, 0)).surfaces == {"x+", "y+"}
    assert feature_at(Cylinder(0.5, 2), (0.5, 0, 0.1)).surfaces == {"side"}
    assert feature_at(Cylinder(0.5, 2), (0.5, 0, 1)).surfaces == {"side", "top"}
    assert feature_at(Cylinder(0.5, 2), (0.1, 0, -1)).surfaces == {"bottom"}
    cone = Cone(0.5, 1.2)
    assert feature_at(cone, (0, 0, 0.6)).kind == "vertex"
    assert feature_at(cone, (0.25, 0, 0)).surfaces == {"side"}
    assert feature_at(cone, (0.5, 0, -0.6)).kind == "edge"
    assert feature_at(cone, (0.1, 0, -0.6)).surfaces == {"base"}
    assert feature_at(Capsule(0.2, 1.0), (0.2, 0, 0.1)).kind == "edge"
    assert feature_at(Capsule(0.2, 1.0), (0, 0, 0.7)).kind == "vertex"
    assert feature_at(Sphere(0.7), (0.7, 0, 0)).kind == "vertex"
    assert feature_at(Cap(1.0, 0.3), (0.1, 0, 0.3)).surfaces == {"plane"}
    assert feature_at(ROCK, ROCK.vertices[ROCK.facets.edges[0]].mean(axis=0)).kind == "edge"
    for shape in (LENS, cone, PLANAR):
        with pytest.raises(ValueError, match="off"):
            feature_at(shape, (0.01, 0.02, 0.0))


def test_drawn_poses_are_separated_and_seeded():
    for a, b in ((LENS, Box(1, 2, 3)), (PLANAR, HALF_DISC), (HalfSpace(), ROCK)):
        first = list(draw_poses(a, b, 30, seed=23))
        again = list(draw_poses(a, b, 30, seed=23))
        for one, two in zip(first, again, strict=True):
            assert (one.b.position == two.b.position).all()
            found = maximise_separation(one.a, one.b)
            assert found.value > 0
            if one.distance is not None:
                assert one.distance == pytest.approx(found.value, abs=1e-12 * size_of(a, b))
            if a.dimension == 2:
                assert one.a.position[2] == one.b.position[2] == 0
        assert len({pose.kind for pose in first}) >= 2


@pytest.mark.parametrize("tilt", [0.0, 1e-9, 1e-5, 1e-2])
def test_tilted_boxes(tilt):
    rng = np.random.default_rng(24)
    a, b = Box(1, 2, 3), Box(1.5, 1.0, 2.0)
    for _ in range(20):
        pose = tilted_pair(a, b, tilt, 0.01, rng)
        normal = pose.a.rotation[:, 2]
        assert separation(pose.a, pose.b, normal) == pytest.approx(0.01, abs=1e-14)
        between = float(np.linalg.norm(pose.a.rotation[:, 2] - pose.b.rotation[:, 2]))
        assert between == pytest.approx(2 * np.sin(tilt / 2), abs=1e-15)
        known = maximise_separation(pose.a, pose.b)
        # the search brackets the truth; how tightly depends on the rounding of its solver
        distance = nearest_polytopes(pose.a, pose.b).distance
        assert known.value - 1e-13 <= distance <= known.upper + 1e-13
        assert known.upper - known.value <= 1e-9


def test_rotations():
    rng = np.random.default_rng(25)
    for planar in (False, True):
        rotation = random_rotation(rng, planar)
        np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-15)
        assert np.linalg.det(rotation) == pytest.approx(1)
    axis = random_normal(rng)
    expected = Rotation.from_rotvec(0.7 * axis).as_matrix()
    np.testing.assert_allclose(rotation_about(axis, 0.7), expected, atol=1e-15)


def test_facets_of_a_box():
    facets = Box(1, 2, 3).core.facets
    assert (len(facets.normals), len(facets.edges)) == (6, 12)
    assert sorted(facets.offsets) == [0.5, 0.5, 1, 1, 1.5, 1.5]
    # Euler: a rock of triangles has 3 v - 6 edges.
    hull = Polytope(ROCK.vertices[np.unique(ROCK.facets.edges)])
    assert len(hull.facets.edges) == 3 * len(hull.vertices) - 6


def test_a_point_off_its_place_is_not_proven():
    place, ball = placed_quadrics(placed(Point()), np.zeros(3)), quadrics(Ellipsoid(1, 1, 1))
    far = placed_quadrics(placed(Ellipsoid(1, 1, 1), position=(3, 0, 0)), np.zeros(3))
    assert _proves(place, far, np.array([0.0, 0, 0, 2, 0, 0]), 2.0)
    assert not _proves(place, far, np.array([-0.1, 0, 0, 2, 0, 0]), 2.0)
    assert not _proves(place, far, np.array([0.0, 0, 0, 2.1, 0, 0]), 2.0)
    assert not _proves(place, ball, np.array([0.0, 0, 0, 2, 0, 0]), 2.0)
    beside = placed_quadrics(placed(Ellipsoid(1, 1, 1), position=(-0.1, 3, 0)), np.zeros(3))
    assert not _proves(place, beside, np.array([-0.1, 0, 0, -0.1, 2, 0]), 2.0)
