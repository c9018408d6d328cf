"""The lens of three biquadratic patches is the lens of three balls, in the paper's parameters."""

import numpy as np
import pytest

import standoff as so
from oracles import closed_forms
from standoff_studies import oracles as support
from standoff_studies.paper.bodies import lens_of_patches

RADIUS, OFFSET = 1.0, 0.45
LENS = lens_of_patches(RADIUS, OFFSET)
POINT = so.shapes.point()
HOME = so.Pose.identity()
SIZES = ((1.0, 0.45), (1.0, 0.9), (20.0, 3.0), (1e-3, 5e-4))


def at(position):
    return so.Pose(np.eye(3), position)


@pytest.mark.parametrize(("radius", "offset"), SIZES)
def test_patches_are_proven(radius, offset):
    report = lens_of_patches(radius, offset).check()
    assert (report.faces, report.edges, report.vertices) == (3, 3, 2)
    assert (report.closed, report.outward, report.smooth_edges) == (True, True, 0)
    assert report.notes == ()
    assert report.slack <= 1e-15 * radius
    assert [patch.convex and patch.hemisphere for patch in report.patches] == [True] * 3


@pytest.mark.parametrize(("radius", "offset"), SIZES)
def test_faces_lie_on_the_balls(radius, offset):
    lens = lens_of_patches(radius, offset)
    exact = support.Lens(radius, offset)
    for i, face in enumerate(lens.face_parts):
        (patch,) = face.charts
        assert patch.domain == (0.0, 1.0, 0.0, 1.0)
        grid = [patch.jet(u, v)[0] for u in np.linspace(0, 1, 7) for v in np.linspace(0, 1, 7)]
        off = np.linalg.norm(np.array(grid) - exact.centres[i], axis=1) - radius
        assert np.abs(off).max() <= 1e-14 * radius
        for u, other in ((0.0, (i + 2) % 3), (1.0, (i + 1) % 3)):
            edge = np.array([patch.jet(u, v)[0] for v in np.linspace(0, 1, 7)])
            off = np.linalg.norm(edge - exact.centres[other], axis=1) - radius
            assert np.abs(off).max() <= 1e-14 * radius
        for v, sign in ((0.0, -1.0), (1.0, 1.0)):
            ends = np.array([patch.jet(u, v)[0] for u in np.linspace(0, 1, 7)])
            np.testing.assert_allclose(ends, [[0, 0, sign * exact.tip]] * 7, atol=1e-14 * radius)


@pytest.mark.parametrize(("radius", "offset"), SIZES)
def test_distances_are_those_of_the_balls(radius, offset):
    rng = np.random.default_rng(7)
    lens, exact = lens_of_patches(radius, offset), support.Lens(radius, offset)
    kinds = set()
    for _ in range(30):
        place = rng.normal(size=3)
        place *= radius * rng.uniform(1.1, 3.0) / np.linalg.norm(place)
        distance, nearest = closed_forms.point_lens(place, exact)
        found = so.distance(lens, POINT, HOME, at(place))
        assert found.certified
        assert found.distance == pytest.approx(distance, abs=1e-12 * radius)
        np.testing.assert_allclose(found.point_a, nearest, atol=1e-12 * radius)
        kinds.add(found.feature_a.kind)
    assert kinds >= {"face", "edge"}


def test_volume_is_that_of_the_balls():
    """By the divergence theorem over the patches, against the balls' sectors."""
    nodes, weights = np.polynomial.legendre.leggauss(24)
    nodes, weights = 0.5 * (nodes + 1.0), 0.5 * weights
    volume = 0.0
    for face in LENS.face_parts:
        for u, wu in zip(nodes, weights, strict=True):
            for v, wv in zip(nodes, weights, strict=True):
                x, xu, xv = face.charts[0].jet(u, v)[:3]
                volume += wu * wv * x @ np.cross(xu, xv) / 3.0
    # In cylinder coordinates about z, face by face: r(φ, z) = −c cos φ + √(1 − z² − c² sin² φ).
    top = np.sqrt(RADIUS**2 - OFFSET**2)
    exact = 0.0
    for s, ws in zip(nodes, weights, strict=True):
        phi = (2.0 * s - 1.0) * np.pi / 3.0
        # z = top sin θ takes the root at the tips out of the integrand
        for q, wq in zip(nodes, weights, strict=True):
            theta = (2.0 * q - 1.0) * np.pi / 2.0
            z = top * np.sin(theta)
            r = np.sqrt(RADIUS**2 - z**2 - (OFFSET * np.sin(phi)) ** 2) - OFFSET * np.cos(phi)
            exact += ws * wq * 0.5 * r**2 * top * np.cos(theta) * np.pi * 2.0 * np.pi / 3.0
    assert abs(volume) == pytest.approx(3.0 * exact, rel=1e-12)


@pytest.mark.parametrize(
    ("position", "expected", "kind"),
    [((1.2, 0.3, 0.4), 0.724093964957, "face"), ((0.1, 0.05, 1.5), 0.617182578397, "vertex")],
)
def test_golden_points(position, expected, kind):
    """Section 7 of the design."""
    found = so.distance(LENS, POINT, HOME, at(position))
    assert found.certified
    assert found.distance == pytest.approx(expected, abs=1e-10)
    assert found.feature_a.kind == kind


@pytest.mark.parametrize(
    ("scales", "vector", "position", "expected", "tolerance"),
    [
        ((0.8, 0.6, 0.7), (0.7, -0.5, 0.9), (1.75, 0, 0), 0.833265668215, 1e-10),
        ((1.1, 0.7, 0.5), (0.3, 0.2, 0.1), (1.9, 0.3, 0.2), 0.638234369589, 1e-8),
    ],
)
def test_golden_pairs(scales, vector, position, expected, tolerance):
    """Section 7 of the design."""
    scaled = LENS.transformed(np.diag(scales))
    found = so.distance(LENS, scaled, HOME, so.Pose.exp(vector, position))
    assert found.certified
    assert found.distance == pytest.approx(expected, abs=tolerance)


@pytest.mark.parametrize(
    ("radius", "offset", "word"), [(0.0, 0.4, "radius"), (1.0, -1.0, "offset"), (1.0, 1.0, "Empty")]
)
def test_bad_sizes(radius, offset, word):
    with pytest.raises(ValueError, match=word):
        lens_of_patches(radius, offset)
