"""Convexity of surfaces of revolution and extrusion, by the patches that they are."""

import numpy as np
import pytest

from shares import share
from standoff.bodies.proofs import prove_patch
from standoff.geometry import ConicArc, FormulaCurve, Line, RationalBezier
from standoff.geometry.nurbs_curves import NurbsCurve
from standoff.geometry.swept import Extrusion, Revolution

PI = np.pi
DOME = RationalBezier([[2, 0, 0], [2, 0, 1], [0, 0, 1.5]])
VALLEY = RationalBezier([[1, 0, 0], [1.5, 0, 0.5], [0.7, 0, 1], [1.5, 0, 1.5], [1, 0, 2]])
OVERHANGING = RationalBezier([[2, 0, 0], [2.1, 0, 1], [0, 0, 1.5]])
LEANING = RationalBezier([[2, 0, 0], [1.9, 0, 1], [0, 0, 1.5]])
HOLLOW = RationalBezier([[2, 0, 0], [1, 0, 1], [2, 0, 2]])
REVOLVED = {
    "cone": (Line([0, 0, 1], [1, 0, 0]), True),
    "disc": (Line([0, 0, 0], [1, 0, 0]), True),
    "sphere": (ConicArc([0, 0, 0], [1, 0, 0], [0, 0, 1], -PI / 2, PI / 2), True),
    "outside of a torus": (ConicArc([2, 0, 0], [1, 0, 0], [0, 0, 1], -1.5, 1.5), True),
    "inside of a torus": (ConicArc([2, 0, 0], [1, 0, 0], [0, 0, 1], 2, 4), False),
    "dome": (DOME, True),
    "valley": (VALLEY, False),
    "waist": (HOLLOW, False),
    "spline": (
        NurbsCurve([[1, 0, 0], [2, 0, 0.5], [2, 0, 1.5], [1, 0, 2]], [0, 0, 0, 1, 2, 2, 2]), True,
    ),
    "formula": (FormulaCurve("cos(t)*(1 + sin(t)/5)", "0", "sin(t)", -PI / 2, PI / 2), True),
    "formula with a waist": (FormulaCurve("cosh(t)", "0", "t", -1, 1), False),
}  # fmt: skip


@pytest.mark.parametrize(("name", "turn"), share(2, REVOLVED, [2 * PI, 1.0]))
def test_surfaces_of_revolution(name, turn):
    profile, convex = REVOLVED[name]
    linear = np.array([[1, 0.2, 0], [0, 1.5, 0.1], [0.3, 0, -0.8]])
    for surface in (
        Revolution(profile, 0.3, 0.3 + turn),
        Revolution(profile, 0.3, 0.3 + turn).transformed(linear, np.ones(3)),
    ):
        proof = prove_patch(surface)
        assert proof.convex == convex
        points, normals, least = sampled(surface, proof.sense)
        rise = max(float(np.einsum("ij,ij->i", normals, p - points).max()) for p in points)
        size = np.linalg.norm(np.ptp(points, axis=0))
        assert rise <= proof.defect + 1e-12 * size
        assert proof.curvature <= least + 1e-9 / size
        if convex:
            assert proof.defect <= 1e-11 * size
        else:
            assert proof.curvature < 0
        if proof.hemisphere:
            assert np.linalg.norm(normals.mean(axis=0)) > 0
            assert (normals @ normals.mean(axis=0)).max() > 0


def sampled(surface, sense, n=16):
    u0, u1, v0, v1 = surface.domain
    inner = (np.arange(n) + 0.5) / n
    points, normals, least = [], [], np.inf
    for u in u0 + inner * (u1 - u0):
        for v in v0 + inner * (v1 - v0):
            x, xu, xv, xuu, xuv, xvv = surface.jet(u, v)
            normal = (sense or 1) * np.cross(xu, xv)
            normal = normal / np.linalg.norm(normal)
            first = np.array([[xu @ xu, xu @ xv], [xu @ xv, xv @ xv]])
            second = -np.array([[xuu @ normal, xuv @ normal], [xuv @ normal, xvv @ normal]])
            least = min(least, np.linalg.eigvals(np.linalg.solve(first, second)).real.min())
            points.append(x)
            normals.append(normal)
    return np.array(points), np.array(normals), least


@pytest.mark.parametrize(
    ("profile", "turn", "hemisphere"),
    [
        (Line([0, 0, 1], [1, 0, 0]), 2 * PI, True),
        (LEANING, 2 * PI, True),
        (OVERHANGING, 2 * PI, False),
        (ConicArc([0, 0, 0], [1, 0, 0], [0, 0, 1], 0.1, PI / 2), 2 * PI, True),
        (ConicArc([0, 0, 0], [1, 0, 0], [0, 0, 1], -0.1, PI / 2), 2 * PI, False),
        (ConicArc([0, 0, 0], [1, 0, 0], [0, 0, 1], -0.1, 1.4), 2.0, True),
        (FormulaCurve("cos(t)", "0", "sin(t)", 0.1, PI / 2), 2 * PI, True),
        (FormulaCurve("cos(t)", "0", "sin(t)", -0.1, PI / 2), 2 * PI, False),
    ],
)
def test_hemispheres_of_normals(profile, turn, hemisphere):
    assert prove_patch(Revolution(profile, 0.0, turn)).hemisphere == hemisphere


@pytest.mark.parametrize(
    ("profile", "convex"),
    [
        (Line([0, 0, 0], [1, 0, 0]), True),
        (ConicArc([0, 0, 0], [1, 0, 0], [0, 2, 0]), True),
        (RationalBezier([[0, 0, 0], [1, 1, 0], [2, 0, 0]]), True),
        (RationalBezier([[0, 0, 0], [1, 1, 0], [2, -1, 0], [3, 0, 0]]), False),
        (FormulaCurve("t", "exp(t)", "0", -1, 1), True),
        (FormulaCurve("t", "sin(t)", "0", -1, 1), False),
    ],
)
def test_extrusions(profile, convex):
    for direction in ([0, 0, 1], [0.3, -0.2, -2]):
        surface = Extrusion(profile, direction, -0.5, 1.0)
        proof = prove_patch(surface)
        assert proof.convex == convex
        assert (proof.defect <= 1e-11) == convex
        if convex and proof.sense:
            hollow = prove_patch(surface, -proof.sense)
            assert not hollow.convex
            assert hollow.defect > 0.1


def test_a_groove_round_a_body_is_graded():
    for depth in (1e-8, 1e-3):
        profile = RationalBezier(
            [[1, 0, 0], [1 + depth, 0, 1], [1 - 1.2 * depth, 0, 2], [1 + depth, 0, 3], [1, 0, 4]]
        )
        surface = Revolution(profile)
        proof = prove_patch(surface)
        assert not proof.convex
        points, normals, least = sampled(surface, proof.sense)
        rise = max(float(np.einsum("ij,ij->i", normals, p - points).max()) for p in points)
        assert 0 < rise <= proof.defect <= 2000 * depth
        assert proof.curvature <= least < 0


def test_a_creased_profile_is_refused_with_its_knot():
    creased = NurbsCurve([[1, 0, 0], [2, 0, 1], [1, 0, 2]], [0, 0, 1, 2, 2])
    with pytest.raises(ValueError, match=r"creased at its knot 1\.0"):
        prove_patch(Revolution(creased))
    assert prove_patch(Revolution(creased).restricted(0, 2 * PI, 0, 1)).convex
