"""Making planar solids: orientation, nesting, area, and what is refused with its place."""

from __future__ import annotations

import copy
import pickle
from typing import Any

import numpy as np
import pytest
from planar_drawn import even_odd, samples, star

import standoff as so
from standoff.geometry import ConicArc, Curve, FormulaCurve, Line, RationalBezier
from standoff.solids import distance


def polygon(*points: tuple[float, float]) -> list[Curve]:
    return [Line(p, q) for p, q in zip(points, (*points[1:], points[0]), strict=True)]


def square(half: float, x: float = 0.0) -> list[Curve]:
    return polygon((x - half, -half), (x + half, -half), (x + half, half), (x - half, half))


def test_any_direction_of_loops_and_curves() -> None:
    p, q, r = (0.0, 0.0), (2.0, 0.0), (0.0, 1.0)
    for curves in (polygon(p, q, r), polygon(p, r, q), [Line(p, q), Line(r, q), Line(p, r)]):
        solid = so.PlanarSolid.from_loops(curves)
        assert solid.area == pytest.approx(1.0, abs=1e-15)
        assert solid.kinds == ("convex",) * 3
        assert solid.contains([(0.5, 0.2), (0.0, 0.0), (1.5, 0.9)]).tolist() == [True, True, False]


def test_loops_find_their_place() -> None:
    hole, island = square(1.0), square(0.5)
    # also if the outer loop is alone in a list, and the holes are given beside it
    assert so.PlanarSolid.from_loops([square(2.0)], [hole]).area == pytest.approx(12.0)
    solid = so.PlanarSolid.from_loops([hole, square(2.0)])
    assert solid.area == pytest.approx(12.0)
    assert solid.kinds == ("convex",) * 4 + ("reflex",) * 4
    assert repr(solid) == "PlanarSolid('solid', 8 edges, 1 inner loop, area=12)"
    with pytest.raises(so.BodyError, match="2 separate solids"):
        so.PlanarSolid.from_loops([hole, square(2.0), island])


def test_areas_are_proven() -> None:
    curve = FormulaCurve("3*cos(t)", "2*sin(t)", "0", 0.0, 2.0 * np.pi)
    for curves, exact in (
        ([ConicArc((5, 5), (3, 0), (1, 2))], 6.0 * np.pi),
        ([curve], 6.0 * np.pi),
        ([RationalBezier([(0, 0), (1, 2), (2, 0)]), Line((2, 0), (0, 0))], 4.0 / 3.0),
    ):
        solid = so.PlanarSolid.from_loops(curves)
        assert abs(solid.area - exact) <= min(solid.area_error, 1e-12)
        assert solid.area_error <= 1e-5


REFUSED: list[tuple[Any, str]] = [
    ([square(1.0)[0], square(1.0)[1]], r"open: curve . does not begin .* at \[-?1. -?1.\]"),
    (polygon((0, 0), (2, 0), (0, 2), (2, 1)), r"crosses or touches itself at \[1.3333"),
    ([*square(1.0), Line((-1, -1), (-1 + 1e-12, -1))], "no length"),
    ([[*square(1.0)], [*square(1.0)]], "given twice"),
    ([square(1.0), square(1.0, 1.0)], "crosses or touches itself"),
    ([ConicArc((0, 0, 1), (1, 0, 0), (0, 1, 0))], "leaves the plane"),
    ([Line((0, 0), (1, 0)), Line((1, 0), (0, 0))], r"crosses or touches itself at \["),
    (polygon((0, 0), (1, 0), (0.5, 0), (0.5, 1)), "turns back on itself|crosses or touches"),
    ([], "has no curves"),
    ([FormulaCurve("sin(t)", "sin(t)*cos(t)", "0", 0.1, 2 * np.pi + 0.1)], "crosses|no area"),
]


@pytest.mark.parametrize(("loops", "told"), REFUSED)
def test_what_is_no_solid(loops: Any, told: str) -> None:
    with pytest.raises(so.BodyError, match=told):
        so.PlanarSolid.from_loops(loops)


def test_holes_that_are_outside() -> None:
    with pytest.raises(so.BodyError, match="outside of the outer loop"):
        so.PlanarSolid.from_loops(square(1.0), [square(0.5, 3.0)])
    with pytest.raises(so.BodyError, match="inside inner loop"):
        so.PlanarSolid.from_loops(square(3.0), [square(2.0), square(1.0)])
    with pytest.raises(TypeError, match="give a Curve"):
        so.PlanarSolid.from_loops([Line((0, 0), (1, 0)), "line"])
    solid = so.PlanarSolid.from_loops(square(1.0))
    with pytest.raises(so.StandoffError, match="out of z = 0"):
        distance(solid, solid, so.Pose.identity(), so.Pose(np.eye(3), (0, 0, 1)))
    with pytest.raises(so.StandoffError, match="z = 0"):
        solid.signed_distance([(0.0, 0.0, 1.0)])


def test_points_against_counted_crossings(rng: np.random.Generator) -> None:
    solid = so.PlanarSolid.from_loops(star(rng, 20, "lab"))
    # each curve's samples follow those of the one before it, in the loop's direction
    loop = solid.loops[0]
    parts = []
    for curve, backward in zip(loop.curves, loop.backward, strict=True):
        t = np.linspace(curve.first, curve.last, 200)
        parts.append([curve.point(x)[:2] for x in (t[::-1] if backward else t)])
    outline = np.concatenate(parts)
    points = rng.uniform(-1.1, 1.1, (300, 2))
    signed, gradients = solid.signed_distance(points, gradients=True)
    inside = np.array([even_odd(outline, p) for p in points])
    clear = np.abs(signed) > 1e-3
    assert (inside == (signed < 0.0))[clear].all()
    assert np.linalg.norm(gradients, axis=1) == pytest.approx(1.0)
    steps = solid.signed_distance(points + 1e-6 * gradients) - signed
    assert np.median(np.abs(steps - 1e-6)) <= 1e-12
    boundary, _ = samples(solid)
    assert np.abs(solid.signed_distance(boundary)).max() <= 1e-12
    assert solid.contains(boundary[:50]).all()


def test_bodies_and_their_rounding() -> None:
    body = so.shapes.planar_loop(polygon((0, 0), (2, 0), (2, 1), (0, 1)), rounding=0.25)
    solid = so.PlanarSolid.from_body(body)
    assert solid.area == pytest.approx(2.0 + 6.0 * 0.25 + np.pi / 16.0, rel=1e-13)
    assert set(solid.kinds) == {"smooth"}
    disc = so.PlanarSolid.from_body(so.shapes.sphere(0.5))
    assert disc.area == pytest.approx(np.pi / 4.0)
    stadium = so.PlanarSolid.from_body(so.shapes.segment((1, 2, 0), (4, 6, 0), rounding=0.5))
    assert stadium.area == pytest.approx(5.0 + 0.25 * np.pi, rel=1e-13)
    assert set(stadium.kinds) == {"smooth"}
    spots = np.array([(2.5, 4.0), (1.0, 2.0), (0.0, 2.0), (5.5, 8.0), (1.7, 4.6)])
    found = stadium.signed_distance(spots)
    np.testing.assert_allclose(found, [-0.5, -0.5, 0.5, 2.0, 0.5], atol=1e-13)
    with pytest.raises(so.BodyError, match="has no area in the plane"):
        so.PlanarSolid.from_body(so.shapes.capsule(0.2, 0.5))  # along z
    at = so.Pose(np.eye(3), (5.0, 5.0, 0.0))
    answer = distance(body, disc, so.Pose.identity(), at)
    assert answer.distance == pytest.approx(5.0 - 0.25 - 0.5, abs=1e-13)
    with pytest.raises(so.BodyError, match="rounded by"):
        so.PlanarSolid.from_body(so.shapes.planar_loop([ConicArc((0, 0), (1, 0), (0, 0.5))], 0.1))
    with pytest.raises(so.BodyError, match="no area in the plane"):
        so.PlanarSolid.from_body(so.shapes.box(1.0, 1.0, 1.0))


def test_copies_answer_alike() -> None:
    solid = so.PlanarSolid.from_loops(square(1.0), [square(0.5)])
    for other in (copy.deepcopy(solid), pickle.loads(pickle.dumps(solid))):
        assert other.signed_distance([(0.7, 0.1)])[0] == solid.signed_distance([(0.7, 0.1)])[0]
    with pytest.raises(AttributeError):
        solid.name = "other"  # type: ignore[misc]
