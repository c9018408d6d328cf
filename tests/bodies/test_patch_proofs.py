"""Convexity proofs of patches: convex ones proven, dents never bounded too low, places named."""

import numpy as np
import pytest

from draws import draws
from shares import share
from standoff.bodies.proofs import prove_patch
from standoff.geometry import (
    BezierPatch,
    Cone,
    ConicArc,
    Cylinder,
    NurbsSurface,
    Plane,
    Sphere,
    ellipsoid_octants,
    ellipsoid_patches,
)

QUARTER = np.array([1.0, np.sqrt(0.5), 1.0])


def graph(height, degrees=(2, 2)):
    """The patch z = height(x, y) over the square [-1, 1]^2, of degree (2, 2), elevated."""
    x, y = np.meshgrid([-1.0, 0.0, 1.0], [-1.0, 0.0, 1.0], indexing="ij")
    patch = BezierPatch(np.stack([x, y, height(x, y)], axis=-1))
    return patch.elevated(*degrees)


def bump(rng, degrees, least=0.0):
    """A quadratic form that bends down; its control points are a linear map of its monomials."""
    a = rng.normal(size=(2, 2))
    a = a @ a.T + least * np.eye(2)
    # control values of x^2 on [-1, 1] are 1, -1, 1
    return graph(
        lambda x, y: (
            -0.5 * (a[0, 0] * (2 * x * x - 1) + 2 * a[0, 1] * x * y)
            - 0.5 * a[1, 1] * (2 * y * y - 1)
        ),
        degrees,
    )


def moved(patch, rng, far=1.0):
    """Of another size, turned, and some `far` sizes away: its control points are rounded there."""
    linear = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    if np.linalg.det(linear) < 0.0:
        linear = -linear
    scale = 10.0 ** rng.uniform(-3.0, 3.0)
    return patch.transformed(scale * linear, scale * far * rng.normal(size=3))


def rise(patch, sense, n=31):
    """How far points rise above tangent planes of others, on a grid."""
    u0, u1, v0, v1 = patch.domain
    points, normals = [], []
    for u in np.linspace(u0, u1, n):
        for v in np.linspace(v0, v1, n):
            x, xu, xv, *_ = patch.jet(u, v)
            normal = np.cross(xu, xv)
            points.append(x)
            normals.append(sense * normal / max(np.linalg.norm(normal), 1e-300))
    points, normals = np.array(points), np.array(normals)
    return float((normals @ points.T - (normals * points).sum(axis=1)[:, None]).max())


def size(patch):
    return float(np.linalg.norm(np.subtract(*patch.box()[::-1])))


def roundoff(patch):
    """Of the measured rise: that of points, wherever they lie."""
    return 1e-14 * size(patch) + 4e-16 * float(np.abs(patch.control_points).max())


def assert_proven(patch, sense=None, hemisphere=True, far=1.0):
    proof = prove_patch(patch)
    assert proof.convex
    assert 0.0 <= proof.defect <= 1e-12 * size(patch) * far
    assert proof.hemisphere is hemisphere
    assert proof.method == "bernstein"
    if sense is not None:
        assert proof.sense == sense
    return proof


@pytest.mark.parametrize("degree", range(4, 10))
def test_tiles_of_ellipsoids_are_convex(degree, rng):
    axes = 10.0 ** rng.uniform(-1.5, 0.0, 3)
    for patch in ellipsoid_patches(*axes)[::2]:
        elevated = patch.elevated(degree, max(4, 13 - degree))
        assert assert_proven(elevated, 1).defect == 0.0
        assert_proven(elevated.swapped(), -1)
        assert_proven(moved(elevated, rng), 1)


@pytest.mark.parametrize("degree", [2, 3, 5, 9])
def test_octants_with_a_pole_are_convex(degree, rng):
    axes = 10.0 ** rng.uniform(-1.5, 0.0, 3)
    for patch in ellipsoid_octants(*axes)[:2]:
        elevated = patch.elevated(degree, degree)
        assert_proven(elevated, 1)
        assert_proven(elevated.reversed_v(), -1)
        assert_proven(elevated.swapped(), -1)
        assert_proven(elevated.swapped().reversed_u(), 1)
        far = 10.0 ** rng.uniform(0.0, 3.0)
        assert_proven(moved(elevated, rng, far), 1, far=10.0 * far)


def test_a_gore_between_two_poles_is_convex():
    """A sphere's gore of 60 degrees from pole to pole: two collapsed sides, degree (2, 4)."""
    half = np.sqrt(0.5)
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    wide = np.array([[c, -s], [1.0 / c, 0.0], [c, s]]), np.array([1.0, c, 1.0])
    profile = np.array([(0, -1), (1, -1), (1, 0), (1, 1), (0, 1)], dtype=float)
    weights = np.outer(wide[1], [1.0, half, 1.0, half, 1.0])
    points = np.empty((3, 5, 3))
    points[..., :2] = wide[0][:, None, :] * profile[None, :, :1]
    points[..., 2] = profile[:, 1]
    gore = NurbsSurface(points, [0, 0, 0, 1, 1, 1], [0, 0, 0, 1, 1, 2, 2, 2], weights)
    with pytest.raises(ValueError, match=r"creased at v = 1.0.*multiplicity 2 with degree 2"):
        prove_patch(gore)
    assert_proven(gore.restricted(0.0, 1.0, 0.0, 1.0), 1)
    assert_proven(gore.restricted(0.0, 1.0, 1.0, 2.0), 1)


def test_random_bumps_are_convex(rng):
    for _ in range(12):
        degrees = tuple(int(k) for k in rng.integers(2, 10, 2))
        patch = moved(bump(rng, degrees), rng)
        proof = assert_proven(patch, 1)
        assert rise(patch, 1, 15) <= proof.defect + roundoff(patch)


def test_developable_patches_are_convex(rng):
    """Cylinder, cone frustum, cone to its apex: one curvature is zero everywhere."""
    ring = np.array([(1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 1.0, 0.0)])
    w = np.repeat(QUARTER[:, None], 2, axis=1)
    for top, shrink in ((1.0, 1.0), (1.0, 0.4), (2.0, 0.0)):
        upper = ring * shrink + [0.0, 0.0, top]
        patch = BezierPatch(np.stack([ring, upper], axis=1), w)
        assert_proven(patch, 1)
        assert_proven(moved(patch.elevated(4, 3), rng), 1)


def test_flat_patches_are_convex_both_ways(rng):
    flat = graph(lambda x, y: 0.0 * x, (3, 4))
    for patch in (flat, moved(flat, rng)):
        assert_proven(patch, 0)
        for outward in (1, -1):
            proof = prove_patch(patch, outward)
            assert proof.convex
            assert proof.defect <= 1e-12 * size(patch)


def test_nurbs_of_many_spans_is_proven_span_by_span():
    u, v = np.meshgrid(np.linspace(-1.0, 1.0, 8), np.linspace(-1.0, 1.0, 7), indexing="ij")
    knots_u = [0, 0, 0, 0, 1, 2, 2.5, 4, 6, 6, 6, 6]
    knots_v = [0, 0, 0, 1, 2, 3, 4, 5, 5, 5]
    points = np.stack([u, v, -(u**2) - v**2 - 0.4 * u * v], axis=-1)
    assert_proven(NurbsSurface(points, knots_u, knots_v), 1)
    dented = points.copy()
    dented[4, 3, 2] -= 0.3
    proof = prove_patch(NurbsSurface(dented, knots_u, knots_v))
    assert not proof.convex
    # the points moved are those of u in 1 .. 6, v in 1 .. 4
    assert 1.0 <= proof.place[0] <= 6.0
    assert 1.0 <= proof.place[1] <= 4.0


def test_curvature_that_touches_zero_inside_is_proven_from_a_knot_there():
    """z = -x^4 over -1 <= x <= 0.7: flat along the line x = 0, at u = 10/17."""
    x = np.linspace(-1.0, 0.7, 5)
    knots = np.array([-1.0] * 4 + [0.7] * 4)
    # the control values of x^4 are its blossom: products of the knots round each point
    z = [-np.prod(knots[i : i + 4]) for i in range(5)]
    points = np.empty((5, 2, 3))
    points[..., 0], points[..., 1], points[..., 2] = x[:, None], [-1.0, 0.7], np.array(z)[:, None]
    patch = BezierPatch(points)
    assert patch.jet(0.3, 0.5)[0][2] == pytest.approx(-(patch.jet(0.3, 0.5)[0][0] ** 4), abs=1e-15)
    proof = prove_patch(patch)
    assert not proof.convex
    assert proof.defect <= 1e-3
    assert_proven(patch.refined([10 / 17]), 1)


def test_saddles_and_inflections_are_told_with_their_place():
    saddle = prove_patch(graph(lambda x, y: x * y, (4, 3)))
    assert not saddle.convex
    assert saddle.defect >= 1.0
    assert saddle.curvature <= -0.5
    # z = -x^2 bends up for x > 0.4 only: control values of a cubic in x
    x = np.linspace(-1.0, 1.0, 4)
    z = np.array([-1.0, 0.6, -0.2, 0.4])
    points = np.empty((4, 2, 3))
    points[..., 0], points[..., 1], points[..., 2] = x[:, None], [-1.0, 1.0], z[:, None]
    bent = prove_patch(BezierPatch(points), outward=1)
    second = np.diff(z, 2)
    where = second[0] / (second[0] - second[1])
    assert second[0] < 0.0 < second[1]
    assert not bent.convex
    assert bent.place[0] > where


def test_a_bowl_is_convex_to_the_other_side_only():
    bowl = graph(lambda x, y: x * x + y * y, (3, 3))
    assert prove_patch(bowl).sense == -1
    assert prove_patch(bowl).convex
    hollow = prove_patch(bowl, outward=1)
    assert not hollow.convex
    assert hollow.defect >= rise(bowl, 1)


@pytest.mark.parametrize(
    ("rational", "depth"), share(2, [False, True], [1e-12, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2])
)
def test_dents_are_graded_and_never_bounded_too_low(depth, rational, rng):
    """A control point of a flat patch pushed in: the dent's depth is known at its middle."""
    p, q = (int(k) for k in rng.integers(2, 10, 2))
    flat = graph(lambda x, y: 0.0 * x, (p, q))
    i, j = rng.integers(1, p), rng.integers(1, q)
    points = flat.control_points.copy()
    points[i, j, 2] -= depth
    w = np.exp(rng.uniform(-0.3, 0.3, (p + 1, q + 1))) if rational else None
    patch = BezierPatch(points, w)
    deepest = -min(patch.jet(u, v)[0][2] for u in np.linspace(0, 1, 21) for v in (0.3, 0.5, 0.7))
    patch = moved(patch, rng)
    scale = size(patch) / size(flat)
    proof = prove_patch(patch, outward=1)
    assert not proof.convex
    assert proof.defect >= deepest * scale
    assert proof.defect >= rise(patch, 1) - roundoff(patch)
    # and not far too high: 4 control points' height a curvature p^2, over the whole width
    assert proof.defect <= 40.0 * max(p, q) ** 2 * depth * scale
    assert proof.curvature < 0.0


def test_random_patches_are_never_called_convex_when_they_are_dented(rng):
    outcomes = set()
    for _ in range(draws(60)):
        degrees = tuple(int(k) for k in rng.integers(2, 8, 2))
        patch = bump(rng, degrees, least=10.0 ** rng.uniform(-4.0, 0.0))
        points = patch.control_points.copy()
        points[..., 2] += rng.normal(size=points.shape[:2]) * 10.0 ** rng.uniform(-12.0, 0.0)
        patch = moved(BezierPatch(points), rng)
        proof = prove_patch(patch, outward=1)
        high = rise(patch, 1, 17)
        assert high <= proof.defect + roundoff(patch)
        outcomes.add(proof.convex)
        if proof.convex:
            assert proof.defect <= 1e-12 * size(patch)
    assert outcomes == {True, False}


def test_dents_beside_a_pole_are_bounded():
    for depth in (1e-9, 1e-6, 1e-3):
        octant = ellipsoid_octants(1.0, 1.3, 0.7)[0].elevated(3, 4)
        points = octant.control_points.copy()
        points[1, 3] *= 1.0 - depth
        patch = BezierPatch(points, octant.weights)
        proof = prove_patch(patch, outward=1)
        assert not proof.convex
        assert proof.defect >= rise(patch.restricted(0.0, 1.0, 0.0, 1.0 - 1e-6), 1)
        assert proof.defect >= depth * np.linalg.norm(points[1, 3]) / 64.0


def test_points_of_a_pole_need_not_agree_to_the_last_digit(rng):
    octant = ellipsoid_octants(1.0, 1.3, 0.7)[0]
    for miss in (1e-15, 1e-12):
        points = octant.control_points.copy()
        points[:, -1] += miss * rng.uniform(-1.0, 1.0, (3, 3))
        proof = prove_patch(BezierPatch(points, octant.weights))
        assert proof.hemisphere
        assert 0.0 < proof.defect <= 1e3 * miss


def test_a_sharp_apex_is_convex_or_not_by_its_ring():
    def cone(ring):
        apex = np.broadcast_to([0.0, 0.0, 1.0], ring.shape)
        return BezierPatch(np.stack([ring, apex], axis=1))

    t = np.linspace(0.0, 0.5 * np.pi, 6)
    ring = np.stack([np.cos(t), np.sin(t), 0.0 * t], axis=-1)
    assert_proven(cone(ring), 1)
    ring[2] *= 0.6
    proof = prove_patch(cone(ring))
    assert not proof.convex
    assert proof.defect > 1e-3


def test_wide_patches_fill_no_hemisphere():
    """A developable arch that turns by more than 180 degrees: convex all the same."""
    rim = [(1, 0), (1, 2), (-1, 2), (-1, 0)]
    w = np.repeat(np.array([1.0, 1 / 3, 1 / 3, 1.0])[:, None], 2, axis=1)
    half = BezierPatch([[(x, y, z) for z in (0.0, 1.0)] for x, y in rim], w)
    assert_proven(half.restricted(0.1, 0.9, 0.0, 1.0))
    rim = [(1, -2), (3, 4), (-3, 4), (-1, -2)]
    wide = BezierPatch([[(x, y, z) for z in (0.0, 1.0)] for x, y in rim])
    assert_proven(wide, hemisphere=False)
    assert_proven(wide.restricted(0.3, 0.7, 0.0, 1.0))


def test_quadrics_are_convex_by_theorem():
    linear = np.diag([1.0, 2.0, 3.0])
    mirror = np.diag([1.0, 2.0, -3.0])
    for kind in (Sphere, Cylinder, Cone):
        proof = prove_patch(kind(linear, np.zeros(3)))
        assert (proof.convex, proof.defect, proof.method) == (True, 0.0, "theorem")
        surface = kind(mirror, np.zeros(3))
        sense = prove_patch(surface).sense
        x, xu, xv, *_ = surface.jet(0.4, 0.7)
        centre = np.array([0.0, 0.0, x[2]]) if kind is not Sphere else np.zeros(3)
        assert sense * np.cross(xu, xv) @ (x - centre) > 0.0
        hollow = prove_patch(surface, outward=-sense)
        assert not hollow.convex
        assert hollow.defect == np.inf
    assert prove_patch(Plane(linear, np.zeros(3))).sense == 0
    assert not prove_patch(Cylinder(linear, np.zeros(3))).hemisphere
    assert prove_patch(Cylinder(linear, np.zeros(3), (0.0, 3.0, 0.0, 1.0))).hemisphere


def test_surfaces_without_a_proof_are_named():
    with pytest.raises(TypeError, match="No convexity proof for a ConicArc"):
        prove_patch(ConicArc([0, 0], [1, 0], [0, 1]))
