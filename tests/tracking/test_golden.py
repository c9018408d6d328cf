"""The golden values of the design; those of moving ellipsoids are in ``test_laws``."""

import numpy as np
import pytest

import standoff as so
from families.shapes import PLANAR
from standoff.geometry import RationalBezier

RADIUS, OFFSET = 1.0, 0.45
LENS = so.shapes.lens(RADIUS, OFFSET)
POINT = so.shapes.point()
LOOP = so.shapes.planar_loop([RationalBezier(points) for points in PLANAR])
ELLIPSOIDS = so.shapes.ellipsoid(0.15, 0.30, 0.20), so.shapes.ellipsoid(0.10, 0.10, 0.15)
ELLIPSOID_POSES = (np.eye(3), (1.5, 0.0, -0.5)), (np.eye(3), (1.5, 0.5, 0.5))
REST = (np.zeros(3), np.zeros(3))
HOME = so.Pose.identity()


def at(position):
    return so.Pose(np.eye(3), position)


@pytest.mark.parametrize(
    ("position", "expected", "kind"),
    [((1.2, 0.3, 0.4), 0.724093964957, "face"), ((0.1, 0.05, 1.5), 0.617182578397, "vertex")],
)
def test_lens_point(position, expected, kind):
    found = so.distance(LENS, POINT, HOME, at(position))
    assert found.certified
    assert found.distance == pytest.approx(expected, abs=1e-10)
    assert found.feature_a.kind == kind


def test_planar_point():
    found = so.distance(LOOP, POINT, HOME, at((1.5, 0.4, 0)))
    assert found.certified
    assert found.distance == pytest.approx(0.614435369167, abs=1e-10)
    assert str(found.feature_a) == "edge 0"
    assert found.parameters_a == pytest.approx((0.07527316,), abs=1e-8)
    found = so.distance(LOOP, POINT, HOME, at((1.6, 0.05, 0)))
    assert found.certified
    assert found.distance == pytest.approx(0.602079728940, abs=1e-10)
    assert found.feature_a.kind == "vertex"
    np.testing.assert_allclose(found.point_a, (1, 0, 0), atol=1e-15)


def test_planar_point_inside():
    found = so.distance(LOOP, POINT, HOME, at((0.1, 0.05, 0)))
    assert found.status is so.Status.GLOBAL
    assert found.distance == pytest.approx(-0.742667779143, abs=1e-10)
    assert found.parameters_a == pytest.approx((0.40068024,), abs=1e-8)


@pytest.mark.parametrize(
    ("scales", "vector", "position", "expected", "tolerance"),
    [
        ((0.8, 0.6, 0.7), (0.7, -0.5, 0.9), (1.75, 0, 0), 0.833265668215, 1e-10),
        ((1.1, 0.7, 0.5), (0.3, 0.2, 0.1), (1.9, 0.3, 0.2), 0.638234369589, 1e-8),
    ],
)
def test_lens_scaled_lens(scales, vector, position, expected, tolerance):
    scaled = LENS.transformed(np.diag(scales))
    found = so.distance(LENS, scaled, HOME, so.Pose.exp(vector, position))
    assert found.certified
    assert found.distance == pytest.approx(expected, abs=tolerance)


def test_the_gradient_by_the_position_is_the_normal():
    scaled = LENS.transformed(np.diag((1.1, 0.7, 0.5)))
    place, step = np.array((1.9, 0.3, 0.2)), 1e-5

    def distance(position):
        found = so.distance(LENS, scaled, HOME, so.Pose.exp((0.3, 0.2, 0.1), position))
        assert found.certified
        return found.distance

    expected = (0.97679777, 0.13674945, 0.16482020)
    found = so.distance(LENS, scaled, HOME, so.Pose.exp((0.3, 0.2, 0.1), place))
    np.testing.assert_allclose(found.normal, expected, atol=1e-8)
    slopes = [
        (distance(place + step * axis) - distance(place - step * axis)) / (2 * step)
        for axis in np.eye(3)
    ]
    np.testing.assert_allclose(slopes, expected, atol=1e-8)


def test_two_ellipsoids():
    found = so.distance(*ELLIPSOIDS, *ELLIPSOID_POSES)
    assert found.certified
    assert found.distance == pytest.approx(0.75426646628621, abs=1e-12)
    np.testing.assert_allclose(found.normal, (0, 0.405151815529, 0.914249422408), atol=1e-12)


def greatest_projection_error(answer):
    """max |Psi_i|, Eqs. (1)-(4), from the surfaces' own jets (rotations are the identity)."""
    sides = []
    for body, (_, position), parameters in (
        (ELLIPSOIDS[0], ELLIPSOID_POSES[0], answer.parameters_a),
        (ELLIPSOIDS[1], ELLIPSOID_POSES[1], answer.parameters_b),
    ):
        jet = body.face_parts[0].charts[int(parameters[2])].jet(*parameters[:2])
        sides.append((jet[0] + position, jet[1], jet[2]))
    (x_f, f_u, f_v), (x_h, h_r, h_s) = sides
    return max(abs(tangent @ (x_f - x_h)) for tangent in (f_u, f_v, h_r, h_s))


@pytest.mark.parametrize(("gain", "expected"), [(100.0, 70), (1000.0, 10)])
@pytest.mark.parametrize("start", [(0.2, 0.1), (-0.3, 0.25)])
def test_steps_of_the_papers_law(gain, expected, start):
    """Steps until max |Psi_i| is 1e-3 of its value at the start."""
    settled = so.distance(*ELLIPSOIDS, *ELLIPSOID_POSES)
    shift = np.array([*start, 0.0])
    tracker = so.Tracker(*ELLIPSOIDS, dt=1e-3, law=so.PaperLaw(integrator="heun", gain=gain))
    state = tracker.start_from(
        *ELLIPSOID_POSES,
        (settled.feature_a, settled.parameters_a + shift),
        (settled.feature_b, settled.parameters_b - shift),
        REST,
        REST,
        settle=False,
    )
    first = greatest_projection_error(state.proximity)
    errors = []
    for _ in range(2 * expected):
        state, answer = tracker.step(state, *ELLIPSOID_POSES, REST, REST)
        errors.append(greatest_projection_error(answer))
    count = 1 + int(np.argmax(np.array(errors) <= 1e-3 * first))
    assert count == pytest.approx(expected, abs=1)
    assert min(errors) <= 1e-3 * first


def test_second_derivatives_across_face_and_edge():
    """d along a line that passes, at d = 0.4, from over a face of the lens to over its edge."""
    angles = 2 * np.pi / 3 * np.arange(3)
    centres = -OFFSET * np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    x, tangent, _ = LENS.edge_parts[0].curve.jet(0.3)
    first, second = (c for c in centres if abs(np.linalg.norm(x - c) - RADIUS) < 1e-12)
    normal = (x - first) / RADIUS
    # Square to the edge in the tangent plane of the first ball, towards the inside of the second.
    inward = np.cross(normal, tangent / np.linalg.norm(tangent))
    inward *= -np.sign(inward @ (x - second))
    curvatures = []
    step = 1e-4
    for direction in (inward, -inward):
        found = [
            so.distance(LENS, POINT, HOME, at(x + 0.4 * normal + k * step * direction))
            for k in range(4)
        ]
        assert all(answer.certified for answer in found)
        d = [answer.distance for answer in found]
        curvatures.append((2 * d[0] - 5 * d[1] + 4 * d[2] - d[3]) / step**2)
        assert d[0] == pytest.approx(0.4, abs=1e-14)
        kinds = {answer.feature_a.kind for answer in found[1:]}
        assert kinds == ({"face"} if direction is inward else {"edge"})
    np.testing.assert_allclose(curvatures, (1 / 1.4, 1 / 0.4), atol=1e-5)
