"""External Voronoi regions of spatial bodies: their surfaces, and the law of feature_at."""

import numpy as np
import pytest
from numpy.typing import NDArray

import standoff as so
from standoff.geometry import RationalBezier, ellipsoid_octants
from standoff_studies.paper.bodies import lens_of_patches

Array = NDArray[np.float64]
POINT = so.shapes.point()
PLANAR_CONTROL = (
    ((1, 0), (0.775, 0.645), (0.175, 1.005), (-0.5, 0.9)),
    ((-0.5, 0.9), (-0.87, 0.41), (-0.91, -0.27), (-0.6, -0.8)),
    ((-0.6, -0.8), (0.12, -1.04), (0.76, -0.72), (1, 0)),
)
BODIES = {
    "lens": so.shapes.lens(1.0, 0.45),
    "lens of patches": lens_of_patches(),
    "box": so.shapes.box(1.0, 2.0, 3.0),
    "rounded box": so.shapes.box(1.0, 2.0, 3.0, rounding=0.2),
    "cylinder": so.shapes.cylinder(1.0, 2.0),
    "cone": so.shapes.cone(1.0, 2.0),
    "capsule": so.shapes.capsule(0.3, 2.0),
    "planar": so.shapes.planar_loop([RationalBezier(control) for control in PLANAR_CONTROL]),
}
POINTS = 30
"""Random points for each body; with a few thousand no other differences were seen."""


def asked(body: so.Body, point: Array) -> so.Proximity:
    return so.distance(body, POINT, so.Pose.identity(), so.Pose(np.eye(3), point))


def outside(body: so.Body, rng: np.random.Generator) -> tuple[Array, so.Proximity]:
    """A random point that does not touch the body, and the distance to it."""
    while True:
        point = rng.normal(size=3)
        point *= rng.uniform(0.2, 1.5) * body.size / np.linalg.norm(point)
        if body.dimension == 2:
            point[2] = 0.0
        answer = asked(body, point)
        if answer.certified and answer.distance > 1e-3 * body.size:
            return point, answer


@pytest.mark.parametrize("name", BODIES)
def test_feature_at_agrees_with_the_distance(name: str) -> None:
    """Two ways to the same feature: search over the whole boundary, and a certified descent."""
    body, rng = BODIES[name], np.random.default_rng(5)
    regions = so.voronoi_regions(body)
    for _ in range(POINTS):
        point, answer = outside(body, rng)
        assert regions.feature_at(point) == answer.feature_a, point


@pytest.mark.parametrize("name", [name for name in BODIES if name != "planar"])
def test_either_side_of_a_boundary_lies_another_feature(name: str) -> None:
    """On a ray both features are equally near; a little to either side one of them is nearest."""
    body, rng = BODIES[name], np.random.default_rng(6)
    regions = so.voronoi_regions(body)
    assert regions.external
    for boundary in regions.external[:: max(1, len(regions.external) // 8)]:
        k = len(boundary.origins) // 2
        middle = slice(k - 1, k + 1) if k == 1 else slice(k, k + 1)
        start, way = boundary.origins[middle].mean(axis=0), boundary.directions[middle].mean(axis=0)
        assert np.linalg.norm(way) == pytest.approx(1.0, abs=1e-14)
        point = start + 0.7 * body.size * way
        answer = asked(body, point)
        assert answer.distance == pytest.approx(0.7 * body.size - body.radius, abs=1e-12)
        seen = set()
        for _ in range(60):
            seen.add(regions.feature_at(point + 1e-4 * body.size * rng.normal(size=3)))
            if seen >= set(boundary.features):
                break
        assert seen == set(boundary.features)


def test_a_box_has_its_regions() -> None:
    """12 edges with two faces and two ends each: 24 planes and 24 quarter discs."""
    regions = so.voronoi_regions(so.shapes.box(1.0, 2.0, 3.0), reach=0.5)
    kinds = [tuple(f.kind for f in boundary.features) for boundary in regions.external]
    assert kinds.count(("face", "edge")) == 24
    assert kinds.count(("edge", "vertex")) == 24
    assert len(regions.cones) == 8
    for cone in regions.cones:
        assert np.allclose(cone.normals @ cone.normals.T, np.eye(3), atol=1e-15)
        assert np.allclose(np.sign(cone.point), cone.normals.sum(axis=0), atol=1e-15)
    for boundary in regions.external:
        grid = boundary.grid(regions.reach)
        assert grid.shape == (len(boundary.origins), 2, 3)
        assert np.allclose(np.linalg.norm(grid[:, 1] - grid[:, 0], axis=1), 0.5)
        if boundary.features[1].kind == "vertex":
            first, last = boundary.directions[[0, -1]]
            assert abs(first @ last) < 1e-15
    assert not regions.medial_axis


def test_a_cones_apex_has_its_fan() -> None:
    """Radius 1, height 2: normals at the apex rise by atan(1/2) all round."""
    regions = so.voronoi_regions(so.shapes.cone(1.0, 2.0))
    (fan,) = [b for b in regions.external if b.features[1].kind == "vertex"]
    assert fan.features[0].kind == "face"
    assert np.allclose(fan.origins, [0, 0, 1])
    assert np.allclose(fan.directions[:, 2], 1.0 / np.sqrt(5.0), atol=1e-15)
    angles = np.unwrap(np.arctan2(fan.directions[:, 1], fan.directions[:, 0]))
    assert abs(angles[-1] - angles[0]) == pytest.approx(2.0 * np.pi, abs=1e-12)
    assert len(regions.cones[0].normals) == len(fan.directions)


def test_where_faces_meet_smoothly_nothing_is_separated() -> None:
    octants = so.Body.from_patches(ellipsoid_octants(1.0, 0.5, 0.7))
    assert octants.n_edges == 12
    for body in (octants, so.shapes.ellipsoid(1.0, 0.5, 0.7), so.shapes.halfspace(), POINT):
        assert so.voronoi_regions(body).external == ()


def test_bad_input_is_refused() -> None:
    box = so.shapes.box(1.0, 1.0, 1.0)
    planar = BODIES["planar"]
    with pytest.raises(ValueError, match=r"lies 0\.4 inside"):
        so.voronoi_regions(box).feature_at((0.1, 0.0, 0.0))
    with pytest.raises(ValueError, match="off the plane"):
        so.voronoi_regions(planar).feature_at((2.0, 0.0, 0.1))
    with pytest.raises(ValueError, match="point"):
        so.voronoi_regions(planar).feature_at((np.nan, 0.0, 0.0))
    with pytest.raises(ValueError, match="reach"):
        so.voronoi_regions(box, reach=-1.0)
    with pytest.raises(ValueError, match="planar"):
        so.voronoi_regions(box, tolerance=1e-3)
    with pytest.raises(ValueError, match="too fine"):
        so.voronoi_regions(planar, tolerance=1e-12)
    with pytest.raises(TypeError, match="give a standoff"):
        so.voronoi_regions("box")  # type: ignore[arg-type]
