"""Formulas in spherical-like parameters: smooth poles are seen through, dents are not."""

from itertools import pairwise

import numpy as np
import pytest

import standoff as so
from shares import only, share
from standoff.bodies.proofs.formulas.forms import curvature_forms
from standoff.bodies.proofs.interval import prove
from standoff.errors import BodyError
from standoff.geometry.formulas import FormulaSurface

PI = np.pi
AXES = {"a": 1.3, "b": 0.7, "c": 0.9}
POLAR = ("a*sin(v)*cos(u)", "b*sin(v)*sin(u)", "c*cos(v)")
LATITUDE = ("a*cos(v)*cos(u)", "b*cos(v)*sin(u)", "c*sin(v)")
EGG = ("a*sin(v)*cos(u)/(1 + cos(v)/4)", "b*sin(v)*sin(u)/(1 + cos(v)/4)", "c*cos(v)")


def shell(formulas, parameters, cuts_v, sectors):
    cuts_u = np.linspace(0.0, 2 * PI, sectors + 1)
    return [
        FormulaSurface(*formulas, (u0, u1, v0, v1), parameters)
        for u0, u1 in pairwise(cuts_u)
        for v0, v1 in pairwise(cuts_v)
    ]


SHELLS = [
    (POLAR, (0, PI)),
    (POLAR, (0, PI / 2, PI)),
    (POLAR, (0, 1, PI)),
    (LATITUDE, (-PI / 2, PI / 2)),
    (EGG, (0, PI)),
    (EGG, (0, 2, PI)),
]


@pytest.mark.parametrize(("of", "sectors"), share(2, SHELLS, [3, 4]))
def test_bodies_in_spherical_parameters(of, sectors):
    formulas, cuts_v = of
    body = so.Body.from_patches(shell(formulas, AXES, cuts_v, sectors))
    patches = body.check().patches
    # both poles never share a hemisphere: such patches are halved, once
    assert len(patches) == 2 * sectors
    for patch in patches:
        assert (patch.convex, patch.defect, patch.hemisphere) == (True, 0.0, True)


def test_distance_of_an_ellipsoid_in_spherical_parameters():
    body = so.Body.from_patches(shell(POLAR, AXES, (0, PI), 3))
    exact = so.shapes.ellipsoid(*AXES.values())
    rng = np.random.default_rng(3)
    point = so.shapes.point()
    for _ in range(6):
        place = rng.normal(size=3)
        pose = np.eye(4)
        pose[:3, 3] = 3.0 * place / np.linalg.norm(place)
        assert so.distance(body, point, np.eye(4), pose).distance == pytest.approx(
            so.distance(exact, point, np.eye(4), pose).distance, abs=1e-10
        )


def test_a_turned_ellipsoid_has_its_hidden_factor_taken_out():
    rows = np.random.default_rng(5).normal(size=(3, 3)) + 2 * np.eye(3)
    unit = ("sin(v)*cos(u)", "sin(v)*sin(u)", "cos(v)")
    turned = [
        " + ".join(f"({x!r})*{e}" for x, e in zip(row, unit, strict=True)) + " + 3"
        for row in rows.tolist()
    ]
    for v0, v1 in ((0, PI / 2), (PI / 2, PI)):
        proof = prove(FormulaSurface(*turned, (0, 2, v0, v1)))
        assert (proof.convex, proof.defect, proof.hemisphere) == (True, 0.0, True)


def test_the_normal_stays_along_x_u_cross_x_v():
    surface = FormulaSurface(*EGG, (0, 2, 0, PI), AXES)
    forms = curvature_forms(surface.formula)
    u, v = 1.1, 2.5
    values = {"u": u, "v": v}
    _, xu, xv, *_ = surface.jet(u, v)
    direction = np.array([float(e.subs(values)) for e in forms.normal])
    for factor in forms.normal_signs:
        direction = direction * float(factor.subs(values))
    n = np.cross(xu, xv)
    cosine = direction @ n / np.linalg.norm(direction) / np.linalg.norm(n)
    assert cosine == pytest.approx(1.0, rel=1e-12)
    # at the poles themselves the direction is known
    for pole in (0, PI):
        at_pole = [float(e.subs({"u": u, "v": pole})) for e in forms.normal]
        assert abs(at_pole[2]) > 0.01
        assert np.abs(at_pole[:2]).max() <= 1e-12


# What dents a pole: height as a function of v.
DENTED = {
    "pole pressed in": "c*(cos(v) - cos(v)**4)",
    "shallow dimple": "c*cos(v) - exp(-60*sin(v)**2)/20",
}


@pytest.mark.parametrize("name", only(["pole pressed in"], DENTED))
def test_dented_poles_are_refused(name):
    formulas = (*POLAR[:2], DENTED[name])
    proof = prove(FormulaSurface(*formulas, (0, 2 * PI / 3, 0, PI / 2), AXES))
    assert not proof.convex
    assert proof.defect > 0.0
    assert proof.curvature < -1.0


def test_a_body_with_a_dented_pole_is_refused():
    formulas = (*POLAR[:2], DENTED["shallow dimple"])
    with pytest.raises(BodyError):
        so.Body.from_patches(shell(formulas, AXES, (0, PI), 3))
