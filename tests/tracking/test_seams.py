"""Derivatives where the library, or a user, has cut what goes on as one surface or curve."""

import numpy as np
import pytest

import standoff as so
from standoff.geometry import ConicArc, FormulaSurface, Line
from standoff.tracking import Smoothness

TURN = (0.0, 2.0 * np.pi)
OTHER = so.shapes.ellipsoid(0.3, 0.2, 0.25)


def arc(centre, radius, first, last):
    return ConicArc(centre, (radius, 0.0), (0.0, radius), first, last)


SEAMS = np.array([0.0, 0.5, 1.0, 1.5]) * np.pi
"""Angles about z: where closed patches are halved, and halves again, and in between."""


def closed_ellipsoid():
    texts = "a*cos(u)*cos(v)", "b*sin(u)*cos(v)", "c*sin(v)"
    values = {"a": 0.5, "b": 0.4, "c": 0.6}
    return so.Body.from_patches([FormulaSurface(*texts, (*TURN, -np.pi / 2, np.pi / 2), values)])


def closed_cylinder():
    side = FormulaSurface("cos(u)/2", "sin(u)/2", "v", (*TURN, -0.5, 0.5))
    discs = [FormulaSurface("v*cos(u)", "v*sin(u)", z, (*TURN, 0, 0.5)) for z in (-0.5, 0.5)]
    return so.Body.from_patches([side, *discs])


def quarters():
    """A disc of four arcs."""
    ends = SEAMS + 0.5 * np.pi
    return so.shapes.planar_loop(
        [arc((0.0, 0.0), 0.5, a, b) for a, b in zip(SEAMS, ends, strict=True)]
    )


def whole_disc():
    return so.shapes.planar_loop([arc((0.0, 0.0), 0.5, *TURN)])


SPLIT = {
    "ellipsoid": (closed_ellipsoid, lambda: so.shapes.ellipsoid(0.5, 0.4, 0.6), 0.0),
    "side": (closed_cylinder, lambda: so.shapes.cylinder(0.5, 1.0), 0.1),
    "rim": (closed_cylinder, lambda: so.shapes.cylinder(0.5, 1.0), 1.0),
}


def check(split, whole, other, pose):
    one, two = (so.distance(x, other, so.Pose.identity(), pose) for x in (split, whole))
    found, known = one.derivatives(), two.derivatives()
    assert known.smoothness is Smoothness.SMOOTH
    assert found.smoothness is Smoothness.SMOOTH, found.reason
    for name in ("gradient", "hessian", "normal_jacobian"):
        np.testing.assert_allclose(getattr(found, name), getattr(known, name), atol=2e-8)
    for a, b in zip(found.point_jacobians, known.point_jacobians, strict=True):
        np.testing.assert_allclose(a, b, atol=2e-8)


@pytest.mark.parametrize("beside", [0.0, 1e-10, -3e-10])
@pytest.mark.parametrize("name", SPLIT)
def test_a_seam_has_the_derivatives_of_an_unsplit_body(name, beside):
    split, whole, height = SPLIT[name]
    split, whole = split(), whole()
    for angle in SEAMS + beside:
        for z in (height, -height):
            way = np.array([2.0 * np.cos(angle), 2.0 * np.sin(angle), z])
            check(split, whole, OTHER, so.Pose.exp((0.0, 0.0, 0.0), way))


def test_a_curve_of_several_arcs_is_one():
    split, whole = quarters(), whole_disc()
    other = so.shapes.planar_loop([arc((0.0, 0.0), 0.3, *TURN)])
    for angle in SEAMS:
        way = (2.0 * np.cos(angle), 2.0 * np.sin(angle), 0.0)
        check(split, whole, other, so.Pose.exp((0.0, 0.0, 0.0), way))


def test_where_only_the_normal_goes_on_the_derivatives_stay_one_sided():
    """A capsule of patches, at the rims of its ends: the curvature along the axis jumps."""
    side = FormulaSurface("cos(u)/2", "sin(u)/2", "v", (*TURN, -0.5, 0.5))
    ends = [
        FormulaSurface(
            "cos(u)*cos(v)/2", "sin(u)*cos(v)/2", f"{s}*(1 + sin(v))/2", (*TURN, 0, np.pi / 2)
        )
        for s in (-1, 1)
    ]
    body = so.Body.from_patches([side, *ends])
    for angle in (*SEAMS, 0.3):
        pose = so.Pose.exp((0.0, 0.0, 0.0), (2.0 * np.cos(angle), 2.0 * np.sin(angle), 0.5))
        found = so.distance(body, OTHER, so.Pose.identity(), pose).derivatives()
        assert found.smoothness is Smoothness.ONE_SIDED


def test_a_corner_stays_one_sided():
    """A square with a rounding: arcs and lines share tangents, not curvatures."""
    front = arc((0.5, 0.0), 0.5, -0.5 * np.pi, 0.5 * np.pi)
    back = arc((-0.5, 0.0), 0.5, 0.5 * np.pi, 1.5 * np.pi)
    stadium = so.shapes.planar_loop(
        [front, Line((0.5, 0.5), (-0.5, 0.5)), back, Line((-0.5, -0.5), (0.5, -0.5))]
    )
    other = so.shapes.planar_loop([arc((0.0, 0.0), 0.3, *TURN)])
    pose = so.Pose.exp((0.0, 0.0, 0.0), (0.5, 2.0, 0.0))
    found = so.distance(stadium, other, so.Pose.identity(), pose).derivatives()
    assert found.smoothness is Smoothness.ONE_SIDED
