"""Laws that moments obey on bodies of every kind: between two polyhedra, under maps, in parts."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.spatial
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import solids
import standoff as so
from families import curved_shapes, formula_bodies, nurbs_bodies, shapes, swept_bodies
from families.shapes import Maker, Twin
from oracles.exact_pairs import random_rotation
from standoff.simulation import MassProperties, mass_properties

Array = NDArray[np.float64]

MAKERS: tuple[Maker, ...] = (
    *(maker for maker in shapes.SOLIDS if maker is not shapes.point),
    curved_shapes.rounded_polytope,
    curved_shapes.egg,
    curved_shapes.superellipsoid,
    curved_shapes.spindle,
    curved_shapes.gore,
    curved_shapes.revolved_hull,
    *nurbs_bodies.MAKERS,
    *swept_bodies.MAKERS,
    swept_bodies.affine_image,
    formula_bodies.egg,
    formula_bodies.paraboloid,
)
"""Every kind of body with volume that the families of random pairs draw."""

DIRECTIONS = 1500
SEEDS = st.integers(0, 2**32 - 1)


def spread_directions(count: int) -> Array:
    k = np.arange(count) + 0.5
    z, a = 1 - 2 * k / count, np.pi * (1 + np.sqrt(5)) * k
    r = np.sqrt(1 - z * z)
    return np.column_stack([r * np.cos(a), r * np.sin(a), z])


def second_of(found: MassProperties) -> Array:
    """∫ (x - c)(x - c)ᵀ dV of properties of density 1."""
    return np.asarray(0.5 * np.trace(found.inertia) * np.eye(3) - found.inertia)


def hulls(twin: Twin, found: MassProperties) -> tuple[solids.Solid, float]:
    """The hull of support points, and the volume within the planes that support there."""
    widths, axes = np.linalg.eigh(second_of(found))
    normals = spread_directions(DIRECTIONS) @ (axes / np.sqrt(widths)).T
    heights, points = twin.shape.support_many(normals)
    points = np.asarray(points, dtype=float)
    planes = np.column_stack([normals, -np.asarray(heights, dtype=float)])
    outer = scipy.spatial.HalfspaceIntersection(planes, points.mean(axis=0)).intersections
    return solids.polytope(points), float(scipy.spatial.ConvexHull(outer).volume)


@pytest.mark.parametrize("maker", MAKERS, ids=lambda m: f"{m.__module__[9:]}.{m.__name__}")
def test_a_body_lies_between_two_polyhedra(maker: Maker, rng: np.random.Generator) -> None:
    """Moments of the body less those of a polyhedron within it are at most those of what a
    polyhedron around it has more."""
    twin = maker(rng)
    found = mass_properties(twin.body, tolerance=1e-8)
    inner, outer = hulls(twin, found)
    assert found.volume is not None
    assert inner.volume <= found.volume * (1 + 1e-12) <= outer * (1 + 2e-12)
    # how much of the volume the polyhedron within leaves, at most
    left = (outer - inner.volume) / inner.volume
    assert left <= 0.1
    size = twin.body.size
    assert np.linalg.norm(found.centre - inner.centre) <= (left + 1e-12) * size
    gap = second_of(found) - inner.second
    # in each direction it is positive: what is left out, about the body's own centre
    middle = np.linalg.norm(found.centre - inner.centre)
    rounding = 1e-13 * size**2
    assert np.linalg.eigvalsh(gap).min() >= -inner.volume * (middle**2 + rounding)
    assert np.trace(gap) <= (left + 1e-12) * inner.volume * size**2
    # the boundary is closed and counted once: ∮ x nᵀ dA is the volume times the identity
    assert found.error.volume <= max(1e-7 * found.volume, 10 * twin.body.check().slack * size**2)


def test_what_is_left_of_a_body_shrinks_with_its_hull() -> None:
    """Twice as many directions: half of what the hull leaves."""
    twin = shapes.lens(np.random.default_rng(3))
    found = mass_properties(twin.body)
    left = []
    for count in (500, 1000, 2000):
        points = np.asarray(twin.shape.support_many(spread_directions(count))[1], dtype=float)
        left.append(float(found.volume or 0.0) / solids.polytope(points).volume - 1.0)
    ratios = np.array(left[:-1]) / left[1:]
    assert left[-1] < 1e-2
    np.testing.assert_allclose(ratios, 2.0, rtol=0.1)


SMOOTH = (shapes.ellipsoid, shapes.lens, shapes.cylinder, shapes.polytope, curved_shapes.spindle)


@settings(max_examples=5)
@given(SEEDS, st.sampled_from(SMOOTH))
def test_affine_images_follow_the_map(seed: int, maker: Maker) -> None:
    """Volume by |det|, centre by the map, second moments by both of its sides."""
    rng = np.random.default_rng(seed)
    body = maker(rng).body
    linear = random_rotation(rng) @ np.diag(np.exp(rng.uniform(-1, 1, 3))) @ random_rotation(rng)
    linear = linear * rng.choice([-1.0, 1.0])
    shift = 3.0 * rng.normal(size=3)
    one = mass_properties(body)
    other = mass_properties(body.transformed((linear, shift)))
    scale = abs(np.linalg.det(linear))
    assert abs(other.mass - scale * one.mass) <= 2 * (other.error.mass + scale * one.error.mass)
    norm = np.linalg.norm(linear, 2)
    apart = np.linalg.norm(other.centre - linear @ one.centre - shift)
    assert apart <= 2 * (other.error.centre + norm * one.error.centre)
    second = scale * linear @ second_of(one) @ linear.T
    off = np.linalg.norm(second_of(other) - second, 2)
    assert off <= 2 * (other.error.inertia + scale * norm**2 * one.error.inertia)


@settings(max_examples=5)
@given(SEEDS, st.sampled_from((shapes.capsule, shapes.box)))
def test_rigid_motions_and_scales_are_followed(seed: int, maker: Maker) -> None:
    rng = np.random.default_rng(seed)
    body, turn = maker(rng).body, random_rotation(rng)
    shift, scale = 3.0 * rng.normal(size=3), float(np.exp(rng.uniform(-2, 2)))
    one = mass_properties(body, density=3.0)
    other = mass_properties(body.transformed((scale * turn, shift)), density=3.0)
    mass = scale**3 * one.mass
    assert abs(other.mass - mass) <= 2 * (other.error.mass + scale**3 * one.error.mass)
    apart = np.linalg.norm(other.centre - scale * turn @ one.centre - shift)
    assert apart <= 2 * (other.error.centre + scale * one.error.centre)
    turned = scale**5 * turn @ one.inertia @ turn.T
    off = np.linalg.norm(other.inertia - turned, 2)
    assert off <= 2 * (other.error.inertia + scale**5 * one.error.inertia)


def test_a_cut_body_weighs_what_its_parts_do() -> None:
    """Two caps make a ball: volumes, first and second moments add up."""
    for offset in (0.0, 0.3, 0.95):
        upper = mass_properties(so.shapes.cap(1.0, offset))
        lower = mass_properties(so.shapes.cap(1.0, -offset).transformed(-np.eye(3)))
        assert upper.mass + lower.mass == pytest.approx(4 / 3 * np.pi, rel=1e-13)
        first = upper.mass * upper.centre + lower.mass * lower.centre
        np.testing.assert_allclose(first, 0.0, atol=1e-13)
        about = sum(second_of(p) + p.mass * np.outer(p.centre, p.centre) for p in (upper, lower))
        np.testing.assert_allclose(about, 4 / 15 * np.pi * np.eye(3), atol=1e-13)


def test_far_from_its_origin_a_body_loses_only_what_its_bound_says() -> None:
    near = so.shapes.lens(2.0, 1.0)
    far = near.transformed((np.eye(3), [1e6, -2e6, 3e6]))
    one, other = mass_properties(near), mass_properties(far)
    area, away = 20.3, 3.7e6
    assert other.error.mass > np.finfo(float).eps * away * area
    assert abs(other.mass - one.mass) <= other.error.mass + one.error.mass
    assert np.linalg.norm(other.inertia - one.inertia, 2) <= other.error.inertia
