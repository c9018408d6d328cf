"""Nearly convex bodies: which are refused, which slack the others get, and that it is enough."""

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

import standoff as so
from families import patch_shells as shells
from shares import only
from standoff.geometry import BezierPatch
from standoff.kernels.body import layout as L

SIZE = 2.0 * np.sqrt(3.0)
"""Diagonal of the block."""
DEPTHS = 10.0 ** np.arange(-12, -1)
ACCEPT = 10.0
"""A convexity tolerance that lets every one of these pass."""


def dented_top(depth, degree=4):
    """The square z = 1 with its middle control point pressed in; its rim keeps its normals."""
    t = np.linspace(-1.0, 1.0, degree + 1)
    points = np.stack([*np.meshgrid(t, t, indexing="ij"), np.ones((degree + 1,) * 2)], axis=-1)
    points[degree // 2, degree // 2, 2] -= depth
    return BezierPatch(points)


def dented_block(depth):
    """A cube of edge 2; patch 5 is the dented top."""
    return [*shells.box((2.0, 2.0, 2.0))[:5], dented_top(depth)]


def valley_block(depth):
    """A cube of edge 2 whose top is two rectangles that meet `depth` below its height."""
    patches = shells.box((2.0, 2.0, 2.0))
    kept = [p for p in patches if abs(normal(p)[0]) > 0.5 or normal(p)[2] < -0.5]
    low = 1.0 - depth
    for side in (-1.0, 1.0):
        kept.append(BezierPatch([[(side, -1, 1), (side, 1, 1)], [(0, -1, low), (0, 1, low)]]))
        for y in (-1.0, 1.0):
            wall = [[(side, y, -1), (side, y, 1)], [(0, y, -1), (0, y, low)]]
            kept.append(BezierPatch(wall))
    return kept


def normal(patch):
    jet = patch.jet(0.0, 0.0)
    return np.cross(jet[1], jet[2])


def brute_height(body, count=61):
    """The greatest height of a sampled point of the body over a sampled tangent plane."""
    points, normals = [], []
    for face in body.face_parts:
        surface = face.charts[0]
        u0, u1, v0, v1 = surface.domain
        for u in np.linspace(u0, u1, count):
            for v in np.linspace(v0, v1, count):
                x, xu, xv, *_ = surface.jet(u, v)
                points.append(x)
                normals.append(np.cross(xu, xv))
    points, normals = np.array(points), np.array(normals)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    normals *= np.sign((normals * points).sum(axis=1))[:, None]  # the origin is inside
    heights = (points @ normals.T).max(axis=0) - (points * normals).sum(axis=1)
    return float(heights.max())


def distance_from_top(surface, x):
    """The least distance of a patch from a point: the best of a grid, minimised from there."""
    t = np.linspace(0.0, 1.0, 41)
    away = [(np.linalg.norm(surface.jet(u, v)[0] - x), u, v) for u in t for v in t]
    best = min(away)
    found = minimize(
        lambda q: ((surface.jet(*q)[0] - x) ** 2).sum(),
        best[1:],
        jac=lambda q: [2.0 * (surface.jet(*q)[0] - x) @ d for d in surface.jet(*q)[1:3]],
        bounds=[(0.0, 1.0)] * 2,
        options={"ftol": 1e-16, "gtol": 1e-12},
    )
    return min(best[0], float(np.sqrt(found.fun)))


@pytest.mark.parametrize("depth", only(DEPTHS[::2], DEPTHS))
def test_what_is_refused_and_what_passes_with_which_slack(depth):
    """A defect above 1e-6 of the size is refused unless it is asked for."""
    body = so.Body.from_patches(dented_block(depth), convexity_tolerance=ACCEPT)
    report = body.check()
    true = brute_height(body, 25)
    assert report.convexity_defect >= true
    assert true <= report.slack <= 30.0 * true
    assert not report.patches[5].convex
    assert report.convexity_tolerance == ACCEPT
    assert body.reals[L.SLACK] == report.slack
    if report.convexity_defect <= 1e-6 * SIZE:
        assert so.Body.from_patches(dented_block(depth)).check().slack == report.slack
        return
    assert depth >= 1e-7
    words = r"patch 5 \(BezierPatch\) (dents inward|is hollow) near \(u, v\) = \([\d.]+, [\d.]+\)"
    with pytest.raises(so.BodyError, match=words + r".*tolerance 3\.46e-06"):
        so.Body.from_patches(dented_block(depth))


def test_both_sides_of_the_threshold_were_met():
    assert so.Body.from_patches(dented_block(1e-7)).check().slack > 0.0
    with pytest.raises(so.BodyError, match="Not convex"):
        so.Body.from_patches(dented_block(3e-6))
    with pytest.raises(so.BodyError, match="Not convex"):
        so.Body.from_patches(dented_block(1e-9), convexity_tolerance=1e-10)


@pytest.mark.parametrize("depth", [1e-9, 1e-6, 1e-3, 1e-2])
def test_the_bound_holds_over_a_dent(depth, rng):
    """Points above the dent and beside it: never farther than the bound says they are."""
    body = so.Body.from_patches(dented_block(depth), convexity_tolerance=ACCEPT)
    top, slack, home = dented_top(depth), body.check().slack, so.Pose.identity()
    for _ in range(25):
        x = np.append(rng.uniform(-0.9, 0.9, 2), 1.0 + 10.0 ** rng.uniform(-2, 0.3))
        found = so.distance(body, so.shapes.point(), home, so.Pose(np.eye(3), x))
        true = distance_from_top(top, x)
        assert found.lower_bound <= true + 1e-12
        assert found.distance >= true - 1e-12
        assert found.distance - found.lower_bound <= slack + 1e-9


@pytest.mark.parametrize("make", [dented_block, valley_block])
@pytest.mark.parametrize("depth", [1e-6, 1e-3, 1e-2])
def test_a_tracker_over_a_dent_bounds_the_distance(make, depth, rng):
    """A floor under the dent tilts from one rim to the other; a tracker may keep to the first.

    The true distance is that of the lowest corner; without slack some bounds would exceed it.
    """
    body = so.Body.from_patches(make(depth), convexity_tolerance=ACCEPT)
    tracker = so.Tracker(body, so.shapes.halfspace(), dt=1e-3)
    over = Rotation.from_euler("x", np.pi).as_matrix()
    corners = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
    home, height = so.Pose.identity(), np.array([0.0, 0.0, 1.5])
    for axis in (*np.eye(3)[:2], *(np.append(q, 0.0) for q in rng.normal(size=(6, 2)))):
        state = None
        for tilt in np.linspace(-0.3, 0.3, 12) * depth:
            turn = Rotation.from_rotvec(tilt * axis / np.linalg.norm(axis)).as_matrix() @ over
            pose = so.Pose(turn, height)
            state = tracker.start(pose, home) if state is None else state
            state, found = tracker.step(state, pose, home)
            true = float((corners @ turn.T + height)[:, 2].min())
            assert found.lower_bound <= true + 1e-13
            assert true - 1e-13 <= found.distance <= true + body.check().slack


@pytest.mark.parametrize("depth", [1e-9, 1e-7, 1e-4, 1e-2])
def test_a_concave_edge_is_measured_and_feeds_the_slack(depth):
    body = so.Body.from_patches(valley_block(depth), convexity_tolerance=ACCEPT)
    report = body.check()
    turn = 2.0 * np.arctan(depth)
    assert report.flattest.angle == pytest.approx(np.pi + turn, abs=1e-14)
    assert report.flattest.point == pytest.approx((0.0, report.flattest.point[1], 1.0 - depth))
    true = brute_height(body, 9)
    assert true == pytest.approx(2.0 * depth, rel=0.02)
    assert true <= report.convexity_defect <= 4.0 * true
    assert report.slack >= report.convexity_defect
    if depth > 1e-6:
        words = r"edge \d+ between patch \d and patch \d is concave by [\d.e-]+ degrees at \[ *0\."
        with pytest.raises(so.BodyError, match=words):
            so.Body.from_patches(valley_block(depth))


def test_a_gap_is_slack_at_the_edges(rng):
    """Patches apart by less than the tolerance: sewn, and the bound gives way by the gap."""
    gap = 1e-5
    patches = shells.box((2.0, 2.0, 2.0))
    patches[5] = patches[5].transformed(np.eye(3), np.array([0.0, 0.0, gap]))
    body = so.Body.from_patches(patches, tolerance=2.0 * gap)
    report = body.check()
    assert report.sewing_residual == pytest.approx(gap)
    assert gap <= report.slack <= 4.0 * gap
    other, home = so.shapes.point(), so.Pose.identity()
    block = so.shapes.box(2.0, 2.0, 2.0 + 2.0 * gap)  # holds all patches
    for _ in range(100):
        at = so.Pose(np.eye(3), 2.0 * rng.normal(size=3))
        found, bound = so.distance(body, other, home, at), so.distance(block, other, home, at)
        if bound.certified:
            assert found.lower_bound <= bound.distance + 1e-12


def graph(f, x0, x1):
    """The patch z = f(x, y) of degree 2 over x0 .. x1, -1 .. 1."""
    t = np.array([0.0, 0.5, 1.0])
    x, y = np.meshgrid(x0 + t * (x1 - x0), 2.0 * t - 1.0, indexing="ij")
    solve = np.linalg.inv(shells.bernstein(2, t))
    return np.stack([x, y, solve @ f(x, y) @ solve.T], axis=-1)


def test_a_seam_that_is_smooth_at_one_point_only_is_an_edge():
    """Its angle vanishes where one sample might be taken, and nowhere else."""
    y0 = -1.0 + 2.0 * 0.43
    left = graph(lambda x, y: 1.0 - 0.2 * (y - y0) ** 2 - 0.2 * x**2, -1.0, 0.0)
    right = graph(
        lambda x, y: 1.0 - 0.2 * (y - y0) ** 2 - 0.2 * x**2 - 0.1 * x * (y - y0) ** 2, 0.0, 1.0
    )
    walls = [left[0], right[-1], left[:, 0], left[:, -1], right[:, 0], right[:, -1]]
    sides = [np.stack([wall, wall * [1, 1, 0]], axis=1) for wall in walls]
    floor = [[(-1, -1, 0), (-1, 1, 0)], [(1, -1, 0), (1, 1, 0)]]
    body = so.Body.from_patches([BezierPatch(p) for p in (left, right, *sides, floor)])
    report = body.check()
    assert report.smooth_edges == 2  # the halves of two walls lie in one plane
    assert report.slack == 0.0
    assert report.flattest.angle == pytest.approx(np.pi, abs=1e-12)
    assert any(np.allclose(e.curve.point(0.43), (0.0, y0, 1.0)) for e in body.edge_parts)


def test_convex_bodies_have_no_slack():
    for body in (so.shapes.lens(1, 0.45), so.shapes.cone(1, 2), so.shapes.box(1, 2, 3)):
        report = body.check()
        assert report.slack == 0.0
        assert report.closed
        assert report.outward
        assert all(p.method == "theorem" and p.convex and p.defect == 0.0 for p in report.patches)
        assert len(report.patches) == report.charts
