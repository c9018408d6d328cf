"""Least curvatures: theorems, searches, and flat or sharp bodies."""

import math

import numpy as np
import pytest

import standoff as so
from standoff import control
from standoff.geometry import ConicArc, Line
from standoff_studies.paper.bodies import lens_of_patches, planar_body

HALF_DISC = [ConicArc((0, 0), (0.6, 0), (0, 0.6), 0.0, math.pi), Line((-0.6, 0.0), (0.6, 0.0))]
OVAL = [
    ConicArc((0, 0), (0.6, 0), (0, 0.4), 0.0, math.pi),
    ConicArc((0, 0), (0.6, 0), (0, 0.4), math.pi, 2 * math.pi),
]

BY_THEOREM = {
    "point": (so.shapes.point(), math.inf),
    "sphere": (so.shapes.sphere(0.3), math.inf),  # its core is a point
    "ellipsoid": (so.shapes.ellipsoid(0.5, 1.0, 0.7), 0.5),
    "lens": (so.shapes.lens(2.0, 0.9), 0.5),
    "box": (so.shapes.box(1.0, 2.0, 3.0), 0.0),
    "cylinder": (so.shapes.cylinder(1.0, 1.0), 0.0),
    "capsule": (so.shapes.capsule(0.2, 1.0), 0.0),
    "half-space": (so.shapes.halfspace(), 0.0),
    "oval": (so.shapes.planar_loop(OVAL), 0.4 / 0.36),
    "half disc": (so.shapes.planar_loop(HALF_DISC), 0.0),
}


@pytest.mark.parametrize("name", BY_THEOREM)
def test_known_by_theorem(name: str) -> None:
    body, expected = BY_THEOREM[name]
    found = control.least_curvature(body)
    assert found.proven
    assert found.value == pytest.approx(expected, rel=1e-12)


def test_searched() -> None:
    """The lens of rational patches is one of unit spheres; its collapsed sides do not mislead."""
    found = control.least_curvature(lens_of_patches())
    assert not found.proven
    assert found.value == pytest.approx(1.0, rel=1e-6)


def test_searched_on_planar_curves() -> None:
    body = planar_body()
    found = control.least_curvature(body)
    dense = min(
        np.linalg.norm(np.cross(xt, xtt)) / np.linalg.norm(xt) ** 3
        for edge in body.edge_parts
        for _, xt, xtt in map(edge.curve.jet, np.linspace(0, 1, 2001))
    )
    assert not found.proven
    assert found.value <= dense * (1 + 1e-9)
    assert found.value == pytest.approx(dense, rel=1e-5)


def test_ellipsoid_bound_holds_everywhere_and_is_attained() -> None:
    body = so.shapes.ellipsoid(0.5, 1.0, 0.7)
    values = [
        -control.principal_curvatures(chart, u, v)[1]
        for chart in body.face_parts[0].charts
        for u in np.linspace(-1, 1, 9)
        for v in np.linspace(-1, 1, 9)
    ]
    assert min(values) == pytest.approx(0.5, rel=1e-9)


def test_a_flat_spot_of_a_superellipsoid() -> None:
    assert control.least_curvature(so.shapes.superellipsoid(1, 0.8, 0.6, 0.7, 0.8)).value < 1e-6


def test_reach() -> None:
    assert control.reach(so.shapes.ellipsoid(0.5, 1.0, 0.7)) == pytest.approx(1.0)
    assert control.reach(so.shapes.box(2.0, 2.0, 2.0)) == pytest.approx(math.sqrt(3.0))
    assert control.reach(so.shapes.cylinder(1.0, 2.0)) >= math.sqrt(2.0)
    assert control.reach(so.shapes.halfspace()) == math.inf
    assert control.reach(so.shapes.point()) == 0.0


def test_no_body() -> None:
    with pytest.raises(TypeError, match="is not a Body"):
        control.least_curvature("ball")
