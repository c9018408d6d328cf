"""Support points of the report's solids, and their flats, lie on the boundary."""

import numpy as np
import pytest

import standoff as so
from oracles.membership import outside
from standoff_studies.accuracy.solids import DIRECTIONS, KINDS, Solid
from standoff_studies.oracles import RoundedPolytope, extended

UNJUDGED = {"torus hull", "halfspace", "rounded polytope"}
"""They are tested by themselves."""
JUDGED = [kind.name for kind in KINDS if kind.name not in UNJUDGED]
EVEN = DIRECTIONS[::7]


@pytest.mark.parametrize("name", JUDGED)
def test_support_points_lie_on_the_surface_and_none_lies_farther(name, solids) -> None:
    """By how far points lie outside, which knows of surfaces and not of support points."""
    for solid in solids[name]:
        heights, points = solid.support.support_many(EVEN)
        assert max(abs(outside(solid.support, point)) for point in points[::9]) <= 1e-14
        assert (EVEN @ points.T - heights[:, None]).max() <= 4e-15


def test_rounded_polytopes_are_openings(solids) -> None:
    """Drawn so that the core is the polytope made smaller, which nothing else needs to know."""
    for solid in solids["rounded polytope"]:
        opened = RoundedPolytope(*solid.values.values())
        np.testing.assert_allclose(
            solid.support.heights(EVEN), opened.heights(EVEN), rtol=0, atol=4e-15
        )


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_longer_directions_have_longer_points(kind, solids) -> None:
    for solid in solids[kind.name]:
        longer = solid.support.points(extended(EVEN[1:40]))
        assert longer.dtype == np.longdouble
        if solid.bounded:
            points = solid.support.points(EVEN[1:40])
            np.testing.assert_allclose(longer.astype(float), points, rtol=0, atol=2e-15)


def test_torus_hull_is_that_of_sampled_points(solids) -> None:
    t = np.linspace(0, 2 * np.pi, 721)
    for solid in solids["torus hull"]:
        ring, width, height = solid.values.values()
        across = np.hypot(EVEN[:, 0], EVEN[:, 1])
        profile = across[:, None] * (ring + width * np.cos(t)) + EVEN[:, 2:] * height * np.sin(t)
        np.testing.assert_allclose(solid.support.heights(EVEN), profile.max(axis=1), rtol=2e-5)


def test_half_space_is_supported_along_z_only(solids) -> None:
    (solid,) = solids["halfspace"]
    heights = solid.support.points(np.array([[0, 0, 2.0], [0.1, 0, 1.0]]))
    assert heights[0].tolist() == [0, 0, 0]
    assert np.isinf(heights[1]).all()


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_flats_touch_their_supporting_planes(kind, solids, rng: np.random.Generator) -> None:
    for solid in solids[kind.name]:
        for flat in solid.support.flats(rng):
            for t in (flat.start, flat.start + 1e-3):
                normal, ends = flat.at(extended(t))
                assert abs(float(normal @ normal) - 1) < 1e-18
                assert len(ends) == 2 if flat.turns else len(ends) > 2
                np.testing.assert_allclose(((ends - ends[0]) @ normal).astype(float), 0, atol=1e-15)
                if solid.bounded:
                    height = solid.support.heights(normal[None].astype(float))[0]
                    assert float(ends[0] @ normal) == pytest.approx(height, abs=4e-15)


@pytest.mark.parametrize(
    ("name", "count"), [("box", 6), ("polytope", None), ("point", 0), ("rounded polytope", None)]
)
def test_faces_of_hulls(name, count, solids, rng: np.random.Generator) -> None:
    solid: Solid = solids[name][0]
    hull = getattr(solid.support, "core", solid.support)
    if name == "point":
        assert not hull.flats(rng)
        return
    corners = sum(len(each) for each in hull.facets.corners)
    vertices, faces = len(hull.vertices), len(hull.facets.corners)
    # Euler: every edge has two faces, and a face as many edges as corners
    assert vertices - corners / 2 + faces == 2
    assert count is None or faces == count


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_a_solid_is_built_again_from_its_call(kind, solids) -> None:
    solid = solids[kind.name][0]
    again = eval(solid.call, {"so": so})
    assert np.array_equal(again.reals, solid.body.reals)
    assert np.array_equal(again.ints, solid.body.ints)
