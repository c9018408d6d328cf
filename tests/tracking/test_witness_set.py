"""The set of all witness points: closed forms, bodies of patches, linear programs."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.interpolate import BSpline
from scipy.spatial import ConvexHull

import standoff as so
from oracles.exact_pairs import random_rotation
from standoff.geometry import BezierPatch, NurbsSurface
from tracking.contact_cases import BOX, CASES, CYLINDER, LYING, OVERLAPS, PLATE, Z
from tracking.made_answers import convex_mix, made_answer, random_pose, same_points

Array = NDArray[np.float64]

s = so.shapes
HOME = so.Pose.identity()

CORNERS = 1e-12
"""Extreme points by closed form, over the size."""
ARC = 5e-4
"""Points along an arc may leave this part of the radius between them."""


SWAPPED = [False, True]
# In every run the gaps of a case by turns, one way round or the other.
CLOSED = [
    pytest.param(
        swapped,
        case,
        gap,
        id=f"{'BA' if swapped else 'AB'}-{case}, {gap:g}",
        marks=[pytest.mark.soak] if (k + i + swapped) % 2 else [],
    )
    for swapped in SWAPPED
    for k, case in enumerate(CASES)
    for i, gap in enumerate(case.gaps)
]


@pytest.mark.parametrize(("swapped", "case", "gap"), CLOSED)
def test_closed_forms(swapped, case, gap, rng):
    planar = case.a.dimension == 2
    world = random_pose(rng, 3.0, planar)
    n = np.array(case.normal)
    pose_b = world @ so.Pose.exp(case.turn, case.position + gap * n)
    x = world.apply(convex_mix(case.corners, rng))
    up = world.rotation @ n
    on_a, on_b = world.apply(case.corners), world.apply(case.corners + gap * n)
    if swapped:
        found = so.witness_set(made_answer(case.b, case.a, x + gap * up, -up, gap), pose_b, world)
        on_a, on_b = on_b, on_a
    else:
        found = so.witness_set(made_answer(case.a, case.b, x, up, gap), world, pose_b)
    size = max(body.size for body in (case.a, case.b) if body.bounded)
    assert found.dimension == case.dim
    assert found.normal_dimension == (case.normals if gap == 0.0 else 0)
    assert found.unique == (found.dimension == found.normal_dimension == 0)
    assert found.residual <= CORNERS * size
    if case.arc:
        assert_fills(found.points_a, on_a, world.rotation[:, :2])
    else:
        assert same_points(found.points_a, on_a, CORNERS * size)
        assert same_points(found.points_b, on_b, CORNERS * size)


def assert_fills(found: Array, expected: Array, across: Array) -> None:
    """The found polygon is the expected set but for what arcs hold between two points."""
    hulls = [ConvexHull(points @ across) for points in (found, expected)]
    radius = np.linalg.norm(np.ptp(expected, axis=0))
    outside = hulls[1].equations @ np.column_stack([found @ across, np.ones(len(found))]).T
    assert outside.max() <= ARC * radius
    thin = hulls[1].volume < 1e-2 * radius**2  # between two points an arc is lost
    assert hulls[0].volume == pytest.approx(hulls[1].volume, rel=0.5 if thin else 5e-3)


@pytest.mark.parametrize(("scale", "place"), [(1e-6, 1.0), (1e2, 1.0), (1.0, 1e4)])
def test_sizes_and_places(scale, place):
    """Tiny, huge, and far from the origin: the corners to the roundoff of the place."""
    box, cylinder = s.box(scale, scale, scale), s.cylinder(0.5 * scale, 2 * scale)
    world = so.Pose(np.eye(3), scale * place * np.array([1.0, -2.0, 3.0]))
    far = 1e-12 + 1e-15 * place
    for turn, up, dimension in (((0, 0, 0), 1.5, 2), (LYING, 1.0, 1), ((0.3, 0, 0), 1.6, 0)):
        pose = world @ so.Pose.exp(turn, (0, 0, (up + 0.1) * scale))
        found = so.witness_set(so.distance(box, cylinder, world, pose), world, pose)
        assert found.dimension == dimension
        assert found.residual <= far * 10 * scale


@pytest.mark.parametrize("tilt", [0.0, 1e-12, 1e-10, 1e-8, 1e-5, 1e-3])
def test_tilts(tilt, rng):
    """Parallel to 1e-9 rad is parallel; a greater tilt leaves an edge or a point."""
    for turn, parallel, tilted in (((tilt, 0, 0), 2, 1), ((tilt, tilt, 0), 2, 0)):
        pose = so.Pose.exp(turn, [0.1, 0.2, 2.0])
        found = so.witness_set(so.distance(PLATE, BOX, HOME, pose), HOME, pose)
        assert found.dimension == (parallel if tilt <= 1e-9 else tilted)
        inner = pose.inverse().apply(found.points_b)
        assert np.abs(inner[:, 2] + 0.5).max() <= 1e-15  # on the face, not on a plane nearby
    spin = so.Pose.exp([0, 0, rng.uniform(0, 6)])
    pose = spin @ so.Pose.exp([np.pi / 2 + tilt, 0, 0], [0, 0, 2.0])
    found = so.witness_set(so.distance(PLATE, CYLINDER, HOME, pose), HOME, pose)
    assert found.dimension == (1 if tilt <= 1e-9 else 0)


def half_flat_body() -> so.Body:
    """x and y from 0 to 3, its roof one C2 patch of degree 3: z = f(x) + f(y), f flat from 1 to 2,
    f(x) = -(1 - x)^3 and -(x - 2)^3 beside. So it is flat in the middle one of nine spans.
    """
    knots = np.array([0.0, 0, 0, 0, 1, 2, 3, 3, 3, 3])
    x = np.array([knots[k + 1 : k + 4].mean() for k in range(6)])
    f = np.minimum(0, x - 1) ** 3 - np.maximum(0, x - 2) ** 3
    f = np.linalg.solve(BSpline.design_matrix(x, knots, 3).toarray(), f)
    net = np.stack([*np.meshgrid(x, x, indexing="ij"), f[:, None] + f], axis=2)
    low = net * [1, 1, 0] + [0, 0, -4]
    sides = [(net[0], low[0]), (net[-1], low[-1]), (net[:, 0], low[:, 0]), (net[:, -1], low[:, -1])]
    walls = [NurbsSurface(np.stack(ends, axis=1), knots, [0, 0, 1, 1]) for ends in sides]
    floor = BezierPatch(low[:: len(x) - 1, :: len(x) - 1])
    return so.Body.from_patches([NurbsSurface(net, knots, knots), floor, *walls])


def test_a_patch_that_is_flat_in_one_span():
    body = half_flat_body()
    over = so.Pose.exp([np.pi, 0, 0]) @ so.Pose.exp([0, 0, 0], [-0.5, -0.3, -1.0])
    found = so.witness_set(so.distance(PLATE, body, HOME, over), HOME, over)
    flat = np.array([[x, y, 0.0] for x in (1.0, 2.0) for y in (1.0, 2.0)])
    assert found.dimension == 2
    # beside the flat span the roof falls with the third power: no more digits, and a witness point
    # on the span's rim may be one more corner of the set
    corners = over.apply(flat)
    off = np.linalg.norm(found.points_b[:, None] - corners, axis=2)
    assert off.min(axis=0).max() < 1e-7
    assert (found.points_b >= corners.min(axis=0) - 1e-7).all()
    assert (found.points_b <= corners.max(axis=0) + 1e-7).all()
    # rolled by as much as the roof slopes at x = 2.1: it lies on the ruling there
    rolled = so.Pose.exp([np.pi, 0, 0]) @ so.Pose.exp([0, -np.arctan(3 * 0.1**2), 0], [0, 0, -1])
    found = so.witness_set(so.distance(PLATE, body, HOME, rolled), HOME, rolled)
    ruling = np.array([[2.1, y, -(0.1**3)] for y in (1.0, 2.0)])
    assert found.dimension == 1
    assert same_points(found.points_b, rolled.apply(ruling), 1e-7)


def cube_of_patches() -> so.Body:
    """A cube of bilinear patches: every face flat, none a plane by kind."""
    patches = []
    for k in range(3):
        for side in (-0.5, 0.5):
            corners = np.zeros((2, 2, 3))
            corners[..., k] = side
            corners[..., (k + 1) % 3] = [[-0.5, -0.5], [0.5, 0.5]]
            corners[..., (k + 2) % 3] = [[-0.5, 0.5], [-0.5, 0.5]]
            patches.append(BezierPatch(corners))
    return so.Body.from_patches(patches)


def test_patches_by_cold_queries():
    cube = cube_of_patches()
    found = so.witness_set(
        so.distance(cube, BOX, HOME, at := so.Pose.exp([0, 0, 0.7], [0.2, 0.1, 1.5])), HOME, at
    )
    assert found.dimension == 2
    exact = so.witness_set(so.distance(BOX, BOX, HOME, at), HOME, at)
    assert same_points(found.points_a, exact.points_a, 1e-12)
    patches = s.ellipsoid(1, 1, 1)
    for x in (0.0, 0.3):
        at = so.Pose.exp([0, 0, 0], [x, 0, 2.0])
        assert so.witness_set(so.distance(cube, patches, HOME, at), HOME, at).unique


@pytest.mark.parametrize("case", OVERLAPS, ids=str)
def test_overlaps_with_several_normals(case, rng):
    world = random_pose(rng, 2.0)
    n, x, y = (np.array(v, dtype=float) for v in (case.normal, case.x, case.y))
    answer = made_answer(case.a, case.b, world.apply(x), world.rotation @ n, float((y - x) @ n))
    found = so.witness_set(answer, world, world @ so.Pose.exp(case.turn, case.position))
    assert (found.dimension, found.normal_dimension) == (case.dim, case.normals)


def test_refused():
    answer = made_answer(BOX, BOX, [0, 0, 0.5], Z, 1.0)
    with pytest.raises(ValueError, match="both poses"):
        so.witness_set(answer, HOME)
    nothing = made_answer(BOX, BOX, [0, 0, 0.5], Z, np.nan)
    with pytest.raises(ValueError, match="no distance"):
        so.witness_set(nothing, HOME, HOME)


def test_turned_about_its_normal(rng):
    """Corners come in order around the normal, which is a right-handed turn seen from B."""
    at = so.Pose(random_rotation(rng), np.zeros(3))
    pose = at @ so.Pose.exp([0, 0, 0.4], [0.1, 0.2, 2.0])
    found = so.witness_set(so.distance(BOX, BOX, at, pose), at, pose)
    sides = np.roll(found.points_a, -1, axis=0) - found.points_a
    turns = np.cross(sides, np.roll(sides, -1, axis=0)) @ found.normal
    assert (turns > 0).all()
