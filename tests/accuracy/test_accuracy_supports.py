"""The report's supports agree with the oracles', and its flats lie on the boundary."""

import numpy as np
import pytest

import standoff as so
from families.accuracy_twins import TWINS
from standoff.accuracy.solids import DIRECTIONS, KINDS, Solid
from standoff.accuracy.supports import extended

WITHOUT_TWIN = {"torus hull", "halfspace"}
"""They are tested by themselves."""
EVEN = DIRECTIONS[::7]


def test_every_kind_has_a_twin() -> None:
    assert {kind.name for kind in KINDS} == set(TWINS) | WITHOUT_TWIN


@pytest.mark.parametrize("name", TWINS)
def test_supports_agree_with_the_oracles(name, solids) -> None:
    for solid in solids[name]:
        twin = TWINS[name](*solid.values.values())
        expected = twin.support_many(EVEN)[0]
        np.testing.assert_allclose(solid.support.heights(EVEN), expected, atol=4e-15)
        longer = solid.support.points(extended(EVEN[1:40])).astype(float)
        points = twin.support_many(extended(EVEN[1:40]))[1].astype(float)
        np.testing.assert_allclose(longer, points, atol=2e-15)


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
def test_flats_touch_their_supporting_planes(kind, solids) -> None:
    rng = np.random.default_rng()
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
def test_faces_of_hulls(name, count, solids) -> None:
    solid: Solid = solids[name][0]
    hull = getattr(solid.support, "core", solid.support)
    if name == "point":
        assert not hull.flats(np.random.default_rng())
        return
    corners = sum(len(each) for _, each in hull.faces)
    vertices, faces = len(hull.vertices), len(hull.faces)
    # Euler: every edge has two faces, and a face as many edges as corners
    assert vertices - corners / 2 + faces == 2
    assert count is None or faces == count


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_a_solid_is_built_again_from_its_call(kind, solids) -> None:
    solid = solids[kind.name][0]
    again = eval(solid.call, {"so": so})
    assert np.array_equal(again.reals, solid.body.reals)
    assert np.array_equal(again.ints, solid.body.ints)
