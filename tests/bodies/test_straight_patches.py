"""Planes and ruled patches, elevated, refined and far from the origin: as good as exact."""

import numpy as np
import pytest

import standoff as so
from shares import share
from standoff.bodies.proofs import prove_patch
from standoff.geometry import BezierPatch

# Lengths of spans and reach: rounding over a narrow span, far from the origin, turns normals more.
ROUNDING = 1e-13
# Least distance of knots from each other and from the ends, parts of the domain.
APART = 0.05


def trapezoid(rng):
    return BezierPatch([[(0, 0, 0), (0, 1, 0)], [(1, 0, 0), (1, rng.uniform(0.3, 2), 0)]])


def wall(rng):
    """The plane wall below a curve of degree 2 to 9, rational or not."""
    x = np.linspace(0.0, 1.0, rng.integers(3, 11))
    rows = [np.stack([x, h, 0 * x], axis=-1) for h in (0 * x, rng.uniform(0.5, 1.5, len(x)))]
    w = np.exp(rng.uniform(-0.3, 0.3, (len(x), 2))) if rng.random() < 0.5 else None
    return BezierPatch(np.stack(rows, axis=1), w)


def curved_net(rng):
    """A plane patch whose parameter lines are curved."""
    p, q = rng.integers(2, 10, 2)
    x, y = np.meshgrid(np.linspace(0, 1, p + 1), np.linspace(0, 1, q + 1), indexing="ij")
    return BezierPatch(np.stack([x + 0.1 * y * y, y + 0.1 * x * x, 0 * x], axis=-1))


def ring(rng):
    """A convex polygon of control points, of degree 2 to 9, and weights."""
    t = np.linspace(0.0, 2.5, rng.integers(3, 11))
    w = np.exp(rng.uniform(-0.3, 0.3, len(t))) if rng.random() < 0.5 else np.ones(len(t))
    return np.stack([np.cos(t), np.sin(t), 0 * t], axis=-1), w


def cylinder(rng):
    points, w = ring(rng)
    along = np.array([*rng.uniform(-0.5, 0.5, 2), rng.uniform(0.3, 2.0)])
    return BezierPatch(np.stack([points, points + along], axis=1), np.stack([w, w], axis=1))


def frustum(rng):
    """Of a cone; the weights of its rims differ by a factor."""
    points, w = ring(rng)
    top = np.array([*rng.uniform(-0.3, 0.3, 2), rng.uniform(1.0, 3.0)])
    small = points + rng.uniform(0.2, 0.8) * (top - points)
    rims = np.stack([w, rng.uniform(0.5, 1.5) * w], axis=1)
    return BezierPatch(np.stack([points, small], axis=1), rims)


def cone(rng):
    """To its apex, a collapsed side."""
    points, w = ring(rng)
    apex = np.broadcast_to([0.1, -0.2, 1.5], points.shape)
    return BezierPatch(np.stack([points, apex], axis=1), np.stack([w, w], axis=1))


def knots(rng):
    return list(np.cumsum(rng.uniform(APART, 0.3, rng.integers(0, 4))))


def varied(patch, rng, far):
    """Elevated, refined in both directions, mapped, exchanged; a part that is smooth inside."""
    patch = patch.elevated(*(int(rng.integers(d, 10)) for d in patch.degrees))
    patch = patch.refined(knots(rng), knots(rng))
    turn, other = (np.linalg.qr(rng.normal(size=(3, 3)))[0] for _ in range(2))
    linear = turn @ np.diag(rng.uniform(0.5, 2.0, 3)) @ other
    patch = patch.transformed(10.0 ** rng.uniform(-3, 3) * linear, np.zeros(3))
    patch = patch.transformed(np.eye(3), far * size_of(patch) * rng.uniform(-1, 1, 3))
    patch = patch.swapped() if rng.random() < 0.5 else patch
    ends = []
    for (low, high), inside in zip(
        (patch.domain[:2], patch.domain[2:]), patch.breaks(), strict=True
    ):
        cuts = [low, *inside, high]
        k = int(rng.integers(len(cuts) - 1))
        ends += [cuts[k], cuts[k + 1]]
    return patch.restricted(*ends)


def size_of(patch):
    return float(np.linalg.norm(np.subtract(*patch.box()[::-1])))


@pytest.mark.parametrize(
    ("far", "make"),
    share(3, [0.0, 1.0, 1e3], [trapezoid, wall, curved_net, cylinder, frustum, cone]),
)
def test_planes_and_ruled_patches_have_defects_of_rounding(make, far, rng):
    for k in range(4):
        patch = varied(make(rng), rng, far)
        proof = prove_patch(patch)
        size = size_of(patch)
        reach = max(float(np.abs(patch.box()).max()) / size, 1.0)
        assert proof.convex
        # degree 9 over a span of APART of the size, squeezed by 4
        allowed = ROUNDING * reach / APART
        assert proof.defect <= allowed * size
        assert proof.tilt <= allowed
        flat = make in (trapezoid, wall, curved_net)
        assert (proof.sense == 0) is flat
        if flat:
            assert prove_patch(patch, 1).convex
            assert prove_patch(patch, -1).convex
        elif k == 0:
            hollow = prove_patch(patch, -proof.sense)
            assert not hollow.convex
            assert hollow.defect > 1e-3 * size


@pytest.mark.parametrize(("draw", "far"), [(99, 0.0), (113, 1e3), (258, 1.0)])
def test_normals_are_compared_along_the_curve_whichever_parameter_it_has(draw, far):
    """Cylinders refused once: straight along u, and their normals turn far in one span of v."""
    rng = np.random.default_rng([draw, int(far), 8])
    patch = varied(cylinder(rng), rng, far)
    one, other = prove_patch(patch), prove_patch(patch.swapped())
    assert one.convex
    assert other.convex
    assert one.tilt == pytest.approx(other.tilt, rel=0.5)


def test_a_ruled_patch_with_a_real_dent_is_none():
    """Its lines bend more than by rounding, or it is twisted."""
    t = np.linspace(0.0, 2.5, 6)
    rim = np.stack([np.cos(t), np.sin(t), 0.0 * t], axis=-1)
    patch = BezierPatch(np.stack([rim, rim + np.array([0.1, 0.2, 1.0])], axis=1)).elevated(5, 4)
    for depth in (1e-11, 1e-9, 1e-6):
        points = patch.control_points.copy()
        points[2, 2] -= depth * rim[2]
        proof = prove_patch(BezierPatch(points))
        assert not proof.convex
        # the share of its control point in the middle of a dent
        assert proof.defect >= 0.1 * depth
    p, q = np.linspace(0.0, 1.0, 5), np.linspace(0.0, 1.0, 4)
    x, y = np.meshgrid(p, q, indexing="ij")
    for depth in (1e-12, 1e-9, 1e-6):
        proof = prove_patch(BezierPatch(np.stack([x, y, depth * x * y], axis=-1)))
        assert not proof.convex
        # opposite normals differ by this
        assert depth <= proof.tilt <= 4.0 * depth


def test_walls_refined_along_their_straight_lines_cost_a_body_nothing():
    faces = [[(x, y, z) for y in (0, 1)] for x, z in ((0, 0), (1, 0))]
    turn = np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]], dtype=float)
    floor = BezierPatch(faces)
    mirror = floor.swapped().transformed(np.eye(3), np.array([0.0, 0.0, 1.0]))
    cube = [
        side.transformed(np.linalg.matrix_power(turn, k), np.zeros(3))
        for k in range(3)
        for side in (floor, mirror)
    ]
    varied_cube = [
        side.elevated(1, 5).refined([0.371], [0.13, 0.6]).transformed(2.0 * np.eye(3), np.ones(3))
        for side in cube
    ]
    report = so.Body.from_patches(varied_cube).check()
    assert report.convexity_defect <= 1e-12
    assert report.slack <= 2e-12
    assert all(patch.convex for patch in report.patches)
