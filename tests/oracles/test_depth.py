"""The search over s(n) against closed forms, enumeration and dense samples; J's inertia."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from oracles.bounds import maximise_separation, separation_many
from oracles.depth import depth_minima, least_depth, searched_minima, sphere
from oracles.depth_inertia import contact, jacobian, tangents
from oracles.depth_polytopes import difference_faces, polytope_minima
from oracles.exact_pairs import exact_pair, random_normal, random_rotation
from oracles.loops import ConicArc, PlanarLoop, line
from standoff_studies.oracles import (
    Box,
    Capsule,
    Cone,
    Cylinder,
    Ellipsoid,
    HalfSpace,
    Lens,
    Placed,
    Point,
    Polytope,
    SharpBox,
    Sphere,
)

DISC = PlanarLoop([ConicArc((0, 0), (1, 0), (0, 1), 0, 2 * np.pi)])
SQUARE = PlanarLoop(
    [line((1, -1), (1, 1)), line((1, 1), (-1, 1)), line((-1, 1), (-1, -1)), line((-1, -1), (1, -1))]
)


def placed(shape, position=(0, 0, 0), vector=(0, 0, 0)):
    return Placed(shape, Rotation.from_rotvec(vector).as_matrix(), position)


def mingled(first, second, rng):
    """Two shapes turned at random, their origins close: both have theirs inside."""
    offset = 0.2 * random_normal(rng)
    places = ((first, np.zeros(3)), (second, offset))
    return [Placed(shape, random_rotation(rng), spot) for shape, spot in places]


def rock(rng):
    """A polytope that holds the ball of radius 0.5 at its origin, about."""
    return Polytope(
        rng.uniform(1.0, 1.5, (16, 1)) * np.stack([random_normal(rng) for _ in range(16)])
    )


def negative(matrix):
    return int((np.linalg.eigvalsh(matrix) < 0).sum())


def test_two_spheres():
    found = depth_minima(placed(Sphere(1.0)), placed(Sphere(0.5), (0.3, 0.4, 0)))
    assert len(found.minima) == 1
    assert found.least.depth == pytest.approx(1.0, abs=1e-14)
    assert found.least.depth - 1e-11 <= found.lower <= found.least.depth
    assert found.least.normal == pytest.approx([0.6, 0.8, 0], abs=1e-9)
    assert found.least.point_a == pytest.approx([0.6, 0.8, 0], abs=1e-9)
    assert found.least.point_b == pytest.approx([0, 0, 0], abs=1e-9)
    assert found.least.negative == 3


def test_spheres_about_one_centre():
    assert least_depth(placed(Sphere(1.0)), placed(Sphere(0.5)))[1] == pytest.approx(1.5)


def test_ellipsoid_in_an_ellipsoid():
    """Axis against axis: every axis is stationary, a minimum where rho_A + rho_B > s."""
    outer, inner = np.array([1.0, 0.8, 0.5]), np.array([0.5, 0.3, 0.2])
    found = depth_minima(placed(Ellipsoid(*outer)), placed(Ellipsoid(*inner)))
    assert [m.depth for m in found.minima] == pytest.approx([0.7, 0.7], abs=1e-12)
    assert {round(float(m.normal[2]), 6) for m in found.minima} == {-1.0, 1.0}
    for k in range(3):
        depth = outer[k] + inner[k]
        others = np.delete(np.arange(3), k)
        radii = outer[others] ** 2 / outer[k] + inner[others] ** 2 / inner[k]
        one = contact(placed(Ellipsoid(*outer)), placed(Ellipsoid(*inner)), np.eye(3)[k])
        assert one.depth == pytest.approx(depth)
        assert one.negative == 1 + int((radii > depth).sum())


def test_sphere_in_a_box():
    """The six faces: half the length plus the radius minus the offset towards the face."""
    lengths, centre = np.array([1.0, 0.8, 0.5]), np.array([0.1, 0.03, 0.02])
    found = depth_minima(placed(SharpBox(*lengths)), placed(Sphere(0.1), centre))
    depths = np.sort(np.concatenate([lengths / 2 - centre, lengths / 2 + centre])) + 0.1
    assert [m.depth for m in found.minima] == pytest.approx(depths, abs=1e-12)
    assert all(m.negative == 3 and m.feature_a == "face" for m in found.minima)


def test_box_in_a_box():
    found = least_depth(placed(SharpBox(2, 2, 1)), placed(SharpBox(0.2, 0.2, 0.2), (0.1, 0, 0.3)))
    assert found[1] == pytest.approx(0.3, abs=1e-12)
    assert found[0] == pytest.approx([0, 0, 1], abs=1e-9)


def test_point_in_a_cone():
    cone = placed(Cone(0.5, 1.0))
    spot = np.array([0.1, 0.05, -0.1])
    to_side = (0.5 - spot[2] - 2 * np.hypot(0.1, 0.05)) / np.sqrt(5.0)
    found = depth_minima(cone, placed(Point(), spot))
    assert found.least.depth == pytest.approx(min(to_side, spot[2] + 0.5), abs=1e-12)
    assert found.least.point_b == pytest.approx(spot, abs=1e-6)


def test_half_space():
    _, depth, _ = least_depth(placed(Sphere(0.5), (0, 0, 0.2)), placed(HalfSpace()))
    assert depth == pytest.approx(0.3)


@pytest.mark.parametrize("rounding", [0.0, 0.1])
def test_polytopes_by_enumeration(rounding, rng):
    known = seen = 0
    for _ in range(5):
        second = Box(*rng.uniform(0.5, 2, 3), rounding) if rounding else rock(rng)
        a, b = mingled(rock(rng), second, rng)
        depths, normals = polytope_minima(a, b)
        _, depth, lower = least_depth(a, b)
        assert depth == pytest.approx(depths[0], abs=1e-10)
        assert lower <= depths[0] + 1e-13
        searched = searched_minima(a, b)
        for one in searched:  # the sample misses narrow ones, but adds none
            near = np.abs(depths - one.depth) < 1e-9
            assert near.any()
            assert np.linalg.norm(normals[near] - one.normal, axis=1).min() < 1e-6
            assert one.negative == 3
        known, seen = known + len(depths), seen + len(searched)
        assert [m.depth for m in depth_minima(a, b).minima] == pytest.approx(depths, abs=1e-12)
    assert seen > 0.3 * known


def test_enumeration_finds_the_hull_of_the_differences(rng):
    """The faces of A - B against Qhull on the differences of all vertices."""
    for _ in range(5):
        a, b = mingled(rock(rng), rock(rng), rng)
        corners = [p.shape.vertices @ p.rotation.T + p.position for p in (a, b)]
        hull = ConvexHull((corners[0][:, None] - corners[1]).reshape(-1, 3))
        _, heights = difference_faces(a, b)
        assert heights.min() == pytest.approx(-hull.equations[:, 3].max(), abs=1e-12)
        assert len(heights) == len(np.unique(np.round(hull.equations, 8), axis=0))


SHAPES = {
    "ellipsoid": Ellipsoid(1.0, 0.6, 0.3),
    "lens": Lens(1.0, 0.45),
    "thin lens": Lens(1.0, 0.9),
    "cylinder": Cylinder(0.4, 1.0),
    "cone": Cone(0.5, 1.0),
    "capsule": Capsule(0.3, 1.0),
    "box": SharpBox(0.6, 0.9, 1.2),
}


@pytest.mark.parametrize("name", SHAPES)
def test_against_a_dense_sample(name, rng):
    """No direction of a dense sample has a lesser s, and the points are the bodies' own."""
    dense, _ = sphere(6)
    for other in list(SHAPES.values())[list(SHAPES).index(name) :]:
        pair = exact_pair(SHAPES[name], other, -float(rng.uniform(0.01, 0.3)), rng)
        found = depth_minima(pair.a, pair.b)
        least = -separation_many(pair.a, pair.b, dense).max()
        assert found.lower <= found.least.depth <= found.lower + 1e-10
        assert found.least.depth <= min(least, -pair.distance) + 1e-13
        assert found.least.depth >= least - 0.02  # the sample's spacing
        assert found.least.error < 1e-4
        for one in found.minima[1:]:
            assert one.negative in (3, 5), one  # 5: parallel faces, beyond the generic pairs


def test_separated_bodies_give_minus_their_distance(rng):
    for gap in (1e-3, 0.3):
        pair = exact_pair(SHAPES["lens"], SHAPES["cone"], gap, rng)
        n, depth, lower = least_depth(pair.a, pair.b)
        assert depth == pytest.approx(-gap, abs=1e-10)
        assert -maximise_separation(pair.a, pair.b).value >= lower
        assert n == pytest.approx(pair.normal, abs=1e-5)


def test_exactly_constructed_ellipsoids(rng):
    """Less deep than the least radii of curvature, the constructed direction is a minimum."""
    for _ in range(10):
        axes = rng.uniform(0.2, 1, (2, 3))
        least = min((row.min() ** 2) / row.max() for row in axes)
        pair = exact_pair(*(Ellipsoid(*row) for row in axes), -float(least), rng)
        one = contact(pair.a, pair.b, pair.normal)
        assert one.negative == 3
        assert one.error < 1e-12
        found = depth_minima(pair.a, pair.b)
        assert min(np.linalg.norm(m.normal - pair.normal) for m in found.minima) < 1e-6


def test_inertia_is_that_of_the_reduced_hessian(rng):
    """J against rho - s I, for random radii of curvature on both sides."""
    for _ in range(50):
        n = random_normal(rng)
        frame = np.stack(tangents(n))
        sides, total = [], np.zeros((2, 2))
        for _ in range(2):
            root = rng.normal(size=(2, 2))
            radii = root @ root.T + 0.01 * np.eye(2)
            total += radii
            sides.append((frame.T, np.linalg.inv(radii)))
        depth = float(rng.uniform(0, 4))
        J = jacobian(sides[0], sides[1], n, -depth)
        minima = int((np.linalg.eigvalsh(total - depth * np.eye(2)) > 0).sum())
        assert negative(J) == 1 + minima


def test_inertia_of_flat_features():
    """A vertex on a plane and two crossed edges are minima at any depth, two planes are not J's."""
    n = np.array([0, 0, 1.0])
    plane = (np.eye(3)[:, :2], np.zeros((2, 2)))
    vertex = (np.zeros((3, 0)), np.zeros((0, 0)))
    along_x, along_y = ((np.eye(3)[:, [k]], np.zeros((1, 1))) for k in (0, 1))
    for depth in (0.01, 1.0, 100.0):
        assert negative(jacobian(plane, vertex, n, -depth)) == 3
        assert negative(jacobian(along_x, along_y, n, -depth)) == 3
        assert negative(jacobian(vertex, vertex, n, -depth)) == 1  # s is greatest there


def test_planar_bodies():
    found = depth_minima(placed(SQUARE), placed(DISC, (0.3, 0.1, 0)))
    assert [m.depth for m in found.minima] == pytest.approx([1.7, 1.9, 2.1, 2.3], abs=1e-9)
    assert all(m.negative == 2 for m in found.minima)
    turned = placed(SQUARE, (0.5, 0, 0), (0, 0, np.pi / 4))
    assert least_depth(placed(SQUARE), turned)[1] == pytest.approx(0.5 + np.sqrt(2), abs=1e-9)


def test_motions_change_nothing(rng):
    pair = exact_pair(SHAPES["lens"], SHAPES["box"], -0.1, rng)
    depth = least_depth(pair.a, pair.b)[1]
    turn, shift = random_rotation(rng), rng.normal(size=3)
    moved = [
        Placed(p.shape, turn @ p.rotation, turn @ p.position + shift) for p in (pair.a, pair.b)
    ]
    assert least_depth(*moved)[1] == pytest.approx(depth, abs=1e-12)
    assert least_depth(pair.b, pair.a)[1] == pytest.approx(depth, abs=1e-12)
