"""Voronoi regions of planar bodies: closed forms of medial axes, and brute force."""

import numpy as np
import pytest
from numpy.typing import NDArray

import standoff as so
from shares import only
from standoff.geometry import ConicArc, Curve, Line, RationalBezier

Array = NDArray[np.float64]
# DESIGN.md, section 7.
PLANAR_CONTROL = (
    ((1, 0), (0.775, 0.645), (0.175, 1.005), (-0.5, 0.9)),
    ((-0.5, 0.9), (-0.87, 0.41), (-0.91, -0.27), (-0.6, -0.8)),
    ((-0.6, -0.8), (0.12, -1.04), (0.76, -0.72), (1, 0)),
)


@pytest.fixture(scope="module")
def planar_body() -> so.Body:
    return so.shapes.planar_loop([RationalBezier(control) for control in PLANAR_CONTROL])


def polygon(corners: list[tuple[float, float]]) -> so.Body:
    ends = [*corners[1:], corners[0]]
    return so.shapes.planar_loop([Line(p, q) for p, q in zip(corners, ends, strict=True)])


def junctions(regions: so.voronoi.VoronoiRegions) -> Array:
    found = [
        branch.points[k]
        for branch in regions.medial_axis
        for k in (0, -1)
        if branch.ends[k].kind == "junction"
    ]
    return np.unique(np.round(found, 11), axis=0)


def names(features: tuple[so.Feature, ...]) -> set[str]:
    return {str(feature) for feature in features}


def test_a_rectangle_has_four_diagonals_and_a_ridge() -> None:
    """The axis of a 3 x 1 rectangle: bisectors of its corners to (1/2, 1/2) and (5/2, 1/2)."""
    regions = so.voronoi_regions(polygon([(0, 0), (3, 0), (3, 1), (0, 1)]))
    assert np.allclose(junctions(regions), [[0.5, 0.5, 0], [2.5, 0.5, 0]], atol=1e-14)
    ridge = [b for b in regions.medial_axis if names(b.features) == {"edge 0", "edge 2"}]
    assert len(regions.medial_axis) == 5
    assert len(ridge) == 1
    assert np.abs(ridge[0].points[:, 1] - 0.5).max() < 1e-14
    assert np.abs(ridge[0].depth - 0.5).max() < 1e-14
    for branch in regions.medial_axis:
        if branch is not ridge[0]:
            assert {end.kind for end in branch.ends} == {"corner", "junction"}


def test_a_triangle_meets_in_its_incentre() -> None:
    regions = so.voronoi_regions(polygon([(0, 0), (3, 0), (0, 4)]))
    assert np.allclose(junctions(regions), [[1, 1, 0]], atol=1e-14)
    assert len(regions.medial_axis) == 3


def test_a_regular_hexagon_has_one_junction_of_all_edges() -> None:
    angles = np.arange(6) * np.pi / 3.0
    regions = so.voronoi_regions(polygon([(np.cos(t), np.sin(t)) for t in angles]))
    assert len(regions.medial_axis) == 6
    ends = [end for b in regions.medial_axis for end in b.ends if end.kind == "junction"]
    assert all(len(end.features) == 6 for end in ends)


@pytest.mark.parametrize("first", only([0.3], [0.0, 0.3]))
def test_an_ellipse_has_the_segment_between_two_focal_centres(first: float) -> None:
    """Semi-axes a > b: from -(a - b²/a) to +(a - b²/a) on the major axis, depth b²/a there."""
    a, b = 2.0, 1.0
    loop = so.shapes.planar_loop([ConicArc((0, 0), (a, 0), (0, b), first, first + 2.0 * np.pi)])
    regions = so.voronoi_regions(loop)
    (branch,) = regions.medial_axis
    assert names(branch.features) == {"edge 0"}
    assert [end.kind for end in branch.ends] == ["focal", "focal"]
    ends = np.sort(branch.points[[0, -1], 0])
    assert np.allclose(ends, [-(a - b * b / a), a - b * b / a], atol=1e-12)
    assert np.abs(branch.points[:, 1]).max() < 1e-9
    assert np.allclose(branch.depth[[0, -1]], b * b / a, atol=1e-12)
    # a disc about (x, 0) touches at b sqrt(1 - x²/(a² - b²))
    depth = b * np.sqrt(1.0 - branch.points[:, 0] ** 2 / (a * a - b * b))
    assert np.abs(branch.depth - depth).max() < 1e-9
    assert not regions.external


def test_a_half_disc_has_a_parabola() -> None:
    """Points as far from the chord y = 0 as from the unit circle: y = (1 - x²)/2."""
    half = so.shapes.planar_loop(
        [ConicArc((0, 0), (1, 0), (0, 1), 0.0, np.pi), Line((-1, 0), (1, 0))]
    )
    (branch,) = so.voronoi_regions(half).medial_axis
    x, y = branch.points[:, 0], branch.points[:, 1]
    assert np.abs(y - 0.5 * (1.0 - x * x)).max() < 1e-12
    assert np.abs(branch.depth - y).max() < 1e-12
    assert [end.kind for end in branch.ends] == ["corner", "corner"]
    assert x.max() - x.min() == pytest.approx(2.0, abs=1e-14)


def test_a_disc_has_its_centre() -> None:
    (branch,) = so.voronoi_regions(
        so.shapes.planar_loop([ConicArc((1, 2), (3, 0), (0, 3))])
    ).medial_axis
    assert np.allclose(branch.points, [[1, 2, 0]], atol=1e-14)
    assert np.allclose(branch.depth, 3.0, atol=1e-14)


def test_a_body_that_is_no_disc_between_two_lines_and_two_arcs() -> None:
    """A stadium: the segment between its arcs' centres, which are focal points."""
    arcs = [ConicArc((s, 0), (s, 0), (0, s), -np.pi / 2, np.pi / 2) for s in (1.0, -1.0)]
    stadium = so.shapes.planar_loop(
        [Line((-1, -1), (1, -1)), arcs[0], Line((1, 1), (-1, 1)), arcs[1]]
    )
    regions = so.voronoi_regions(stadium)
    (branch,) = regions.medial_axis
    assert np.allclose(np.sort(branch.points[[0, -1], 0]), [-1, 1], atol=1e-14)
    assert {end.features for end in branch.ends} == {
        (so.Feature("edge", 1),),
        (so.Feature("edge", 3),),
    }
    # where two edges meet smoothly one line separates them
    assert [names(ray.features) for ray in regions.external] == [
        {"edge 0", "edge 3"},
        {"edge 0", "edge 1"},
        {"edge 1", "edge 2"},
        {"edge 2", "edge 3"},
    ]


def test_the_papers_body_has_six_lines_and_three_branches(planar_body: so.Body) -> None:
    """Figs. 8-11: two normals at each of three vertices; three bisectors meet in one point."""
    regions = so.voronoi_regions(planar_body)
    assert len(regions.external) == 6
    for ray in regions.external:
        edge, vertex = ray.features
        curve = planar_body.edge_parts[edge.index].curve
        ends = {planar_body.edge_parts[edge.index].first: curve.first}
        ends[planar_body.edge_parts[edge.index].last] = curve.last
        x, tangent, _ = curve.jet(ends[vertex.index])
        assert np.allclose(ray.origins[0], x, atol=1e-15)
        assert abs(ray.directions[0] @ tangent) < 1e-14
        assert np.linalg.norm(ray.directions[0]) == pytest.approx(1.0, abs=1e-15)
        assert ray.grid(2.0).shape == (1, 2, 3)
    assert len(regions.medial_axis) == 3
    assert len(junctions(regions)) == 1


def test_the_point_inside_the_papers_body_belongs_to_curve_0(planar_body: so.Body) -> None:
    """DESIGN.md, section 7: (.1, .05) is 0.742667779143 deep, nearest to C0 at u = .40068024."""
    regions = so.voronoi_regions(planar_body)
    assert regions.feature_at((0.1, 0.05)) == so.Feature("edge", 0)
    distance = np.linalg.norm(
        planar_body.edge_parts[0].curve.point(0.40068024) - np.array([0.1, 0.05, 0.0])
    )
    assert distance == pytest.approx(0.742667779143, abs=1e-12)


def test_a_rounded_rectangle_has_focal_ends_at_its_arcs() -> None:
    """Arcs of radius 1/2 that join lines smoothly: their centres are the ends of the axis."""
    middles = [(3.0, -0.5), (3.0, 0.5), (0.0, 0.5), (0.0, -0.5)]
    ends = [(0.0, -1.0), (3.0, -1.0), (3.5, -0.5), (3.5, 0.5), (3.0, 1.0), (0.0, 1.0)]
    ends += [(-0.5, 0.5), (-0.5, -0.5)]
    curves: list[Curve] = []
    for k, middle in enumerate(middles):
        curves.append(Line(ends[2 * k], ends[2 * k + 1]))
        first = (k - 1) * np.pi / 2.0
        curves.append(ConicArc(middle, (0.5, 0), (0, 0.5), first, first + np.pi / 2.0))
    regions = so.voronoi_regions(so.shapes.planar_loop(curves))
    focal = [
        (end.features, branch.points[k, :2].tolist())
        for branch in regions.medial_axis
        for k, end in zip((0, -1), branch.ends, strict=True)
        if end.kind == "focal"
    ]
    assert sorted(features[0].index for features, _ in focal) == [1, 3, 5, 7]
    for features, point in focal:
        assert point == pytest.approx(middles[features[0].index // 2], abs=1e-14)
    assert np.allclose(junctions(regions), [[0.5, 0, 0], [2.5, 0, 0]], atol=1e-14)


def test_edges_may_run_either_way() -> None:
    """A triangle of clockwise edges in any order has the same incentre and rays."""
    corners = np.array([(0, 0, 0), (3, 0, 0), (0, 4, 0)])
    pairs = [(0, 2), (1, 0), (2, 1)]
    edges = [so.bodies.Edge(Line(corners[a], corners[b]), a, b) for a, b in pairs]
    regions = so.voronoi_regions(so.Body.from_brep(corners, edges, dimension=2))
    assert np.allclose(junctions(regions), [[1, 1, 0]], atol=1e-14)
    rays = {
        (ray.features[0].index, ray.features[1].index): ray.directions[0]
        for ray in regions.external
    }
    assert np.allclose(rays[0, 0], (-1, 0, 0))
    assert np.allclose(rays[1, 0], (0, -1, 0))
    assert np.allclose(rays[2, 1], (0.8, 0.6, 0))


@pytest.mark.parametrize("turn", only([2e-5, 1e-6], [1e-3, 2e-5, 1e-6]))
def test_a_flat_corner_has_its_branch_or_counts_as_smooth(turn: float) -> None:
    """A corner that turns by less than 1e-5 rad is passed; the checks hold either way."""
    body = polygon([(0, 0), (1.5, -0.75 * turn), (3, 0), (3, 2), (0, 2)])
    regions = so.voronoi_regions(body)
    ends = [end for branch in regions.medial_axis for end in branch.ends]
    kind = "corner" if turn > 1e-5 else "passage"
    assert so.voronoi.BranchEnd(kind, (so.Feature("vertex", 1),)) in ends


@pytest.mark.parametrize("scale", only([1e-6], [1e-6, 1e6]))
def test_the_axis_goes_with_the_body(planar_body: so.Body, scale: float) -> None:
    """A hundred sizes off the origin, at any scale: the same axis."""
    moved = planar_body.transformed((scale * np.eye(3), scale * np.array([100.0, -50.0, 0.0])))
    here, there = so.voronoi_regions(planar_body), so.voronoi_regions(moved)
    expected = scale * (junctions(here) + np.array([100.0, -50.0, 0.0]))
    found = [
        branch.points[k]
        for branch in there.medial_axis
        for k in (0, -1)
        if branch.ends[k].kind == "junction"
    ]
    assert len(found) == 3
    assert np.abs(np.array(found) - expected).max() < 1e-11 * scale
