"""Laws of every kind of surface, among them those that are added: each is taken up by itself."""

from __future__ import annotations

import inspect
from typing import Any

import numpy as np
import pytest

import standoff.geometry as geometry
from standoff.bodies.proofs import PROOFS, prove_patch
from standoff.control import principal_curvatures
from standoff.geometry import ConicArc, Line, Surface, pcurve_of
from standoff.kernels.body import layout as L

KINDS: dict[str, Any] = {
    name: each
    for name in geometry.__all__
    if inspect.isclass(each := getattr(geometry, name))
    and issubclass(each, Surface)
    and not inspect.isabstract(each)
}
EXPONENTS = {"e1": 0.6, "e2": 1.4}
WITH_NUMBERS: dict[str, Any] = {
    "Torus": lambda: geometry.Torus(2.0, 0.5),
    "SuperellipsoidPole": lambda: geometry.SuperellipsoidPole(np.eye(3), np.zeros(3), **EXPONENTS),
    "SuperellipsoidSide": lambda: geometry.SuperellipsoidSide(np.eye(3), np.zeros(3), **EXPONENTS),
}
"""Kinds that take numbers beside their affine map."""
FROM_PARTS = {"NurbsSurface", "BezierPatch", "FormulaSurface", "Revolution", "Extrusion"}
"""Those without a canonical form of their own; `test_nurbs` and others have their laws."""
CANONICAL = [name for name in KINDS if name not in FROM_PARTS]
FIRST_QUARTER = (0.1, 1.2, 0.1, 1.2)
"""A patch that every kind has: also a cone, and a torus outside."""
STEP = 1e-5


def drawn(name: str, rng: np.random.Generator) -> Any:
    """A surface of the kind behind a random affine map, mirrored in half of the cases."""
    linear = np.linalg.qr(rng.normal(size=(3, 3)))[0] @ np.diag(np.exp(rng.uniform(-1, 1, 3)))
    linear[:, 0] *= rng.choice([-1.0, 1.0])
    usual = WITH_NUMBERS.get(name, lambda: KINDS[name](np.eye(3), np.zeros(3)))
    return usual().transformed(linear, rng.normal(size=3))


def sampled(surface: Any, rng: np.random.Generator, count: int) -> np.ndarray:
    return np.array(
        [surface.jet(*rng.uniform(*np.reshape(FIRST_QUARTER, (2, 2)).T))[0] for _ in range(count)]
    )


def test_every_number_of_a_kind_has_its_class() -> None:
    source = inspect.getsource(L).split("# Surface kinds;")[1].split("\n\n")[0]
    numbers = {int(line.split("=")[1].split("#")[0]) for line in source.splitlines()[1:]}
    assert {each.kind for each in KINDS.values()} == numbers


FACTS = [
    name for name, kind in inspect.get_annotations(Surface).items() if kind.startswith("ClassVar")
]


@pytest.mark.parametrize("name", KINDS)
def test_a_class_says_every_fact_of_its_kind(name: str) -> None:
    """`Surface` has no default of any: what a new class leaves out is named here."""
    assert len(FACTS) > 6
    assert [fact for fact in FACTS if not hasattr(KINDS[name], fact)] == []
    assert KINDS[name].proof in PROOFS


@pytest.mark.parametrize("name", CANONICAL)
def test_a_ruled_kind_has_no_curvature_along_its_lines(name: str) -> None:
    rng = np.random.default_rng(5)
    ruled = KINDS[name].ruled
    for _ in range(20):
        curvatures = principal_curvatures(drawn(name, rng), *rng.uniform(0.1, 1.2, 2))
        assert curvatures is not None
        straight = min(np.abs(curvatures)) <= 1e-12 * max(np.abs(curvatures))
        assert straight or max(np.abs(curvatures)) <= 1e-12 if ruled else not straight


@pytest.mark.parametrize("name", CANONICAL)
def test_partials_are_those_of_the_point(name: str) -> None:
    rng = np.random.default_rng(1)
    for _ in range(20):
        surface = drawn(name, rng)
        u, v = rng.uniform(0.1, 1.2, 2)
        x, xu, xv, xuu, xuv, xvv = surface.jet(u, v)
        size = 1.0 + max(np.abs(c).max() for c in (x - surface.shift, xu, xv, xuu, xuv, xvv))
        after, before = surface.jet(u + STEP, v), surface.jet(u - STEP, v)
        above, below = surface.jet(u, v + STEP), surface.jet(u, v - STEP)
        for found, (one, other), k in (
            (xu, (after, before), 0),
            (xv, (above, below), 0),
            (xuu, (after, before), 1),
            (xuv, (after, before), 2),
            (xuv, (above, below), 1),
            (xvv, (above, below), 2),
        ):
            known = (one[k] - other[k]) / (2.0 * STEP)
            np.testing.assert_allclose(found, known, atol=1e-6 * size)


@pytest.mark.parametrize("name", CANONICAL)
def test_nothing_is_higher_than_the_highest_point(name: str) -> None:
    rng = np.random.default_rng(2)
    for _ in range(40):
        surface, direction = drawn(name, rng), rng.normal(size=3)
        top = surface.highest(direction)
        if top is not None:
            heights = sampled(surface, rng, 50) @ direction
            best = surface.jet(*top)[0] @ direction
            assert heights.max() <= best + 1e-12 * (1.0 + abs(best))


@pytest.mark.parametrize("name", [name for name in CANONICAL if KINDS[name].bulge is not None])
def test_a_kind_bulges_to_the_side_that_its_theorem_says(name: str) -> None:
    """All of a patch is below its tangent planes, seen from the side to which it bulges."""
    rng = np.random.default_rng(3)
    for _ in range(20):
        surface = drawn(name, rng).restricted(*FIRST_QUARTER)
        proof = prove_patch(surface)
        assert proof.convex
        x, xu, xv = surface.jet(*rng.uniform(0.1, 1.2, 2))[:3]
        heights = (sampled(surface, rng, 50) - x) @ np.cross(xu, xv)
        size = np.abs(heights).max() + np.linalg.norm(np.cross(xu, xv))
        sides = (proof.sense,) if proof.sense else (1, -1)
        assert all((side * heights).max() <= 1e-12 * size for side in sides)
        assert proof.sense == 0 or np.abs(heights).max() > 1e-6 * size


@pytest.mark.parametrize(
    "name", [name for name in CANONICAL if KINDS[name].projection == "parallel"]
)
def test_a_curve_over_the_plane_has_its_own_shadow_as_pcurve(name: str) -> None:
    rng = np.random.default_rng(4)
    for _ in range(20):
        surface = drawn(name, rng)
        u, v = rng.uniform(0.1, 0.5, 2)
        foot = surface.jet(u, v)[0]
        line = Line(foot, foot + surface.jet(u, v)[1])
        shadow = pcurve_of(line, surface)
        np.testing.assert_allclose(shadow.point(line.first)[:2], (u, v), atol=1e-12)
        arc = ConicArc(foot, surface.linear[:, 0], surface.linear[:, 1])
        at = pcurve_of(arc, surface).point(0.0)
        np.testing.assert_allclose(at[:2], (u + 1.0, v), atol=1e-12)
