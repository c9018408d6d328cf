"""The signed distance of a point to a planar body against brute force over its curves."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from point_oracle import clockwise, ellipse, stadium, to_boundary, to_curve, winding

import standoff as so
from shares import share
from standoff.geometry import ConicArc, Line
from standoff.motion import Spiral
from standoff.points.planar_boundary import PlanarBoundary
from standoff_studies.paper.bodies import leaf, planar_body

Array = NDArray[np.float64]


@pytest.mark.parametrize(
    ("point", "distance", "feature", "parameter"),
    [
        ((0.1, 0.05), -0.742667779143, so.Feature("edge", 0), 0.40068024),
        ((1.5, 0.4), 0.614435369167, so.Feature("edge", 0), 0.07527316),
        ((1.6, 0.05), 0.602079728940, so.Feature("vertex", 0), None),
    ],
)
def test_golden_distances(
    point: tuple[float, float], distance: float, feature: so.Feature, parameter: float | None
) -> None:
    """The planar body's three rows of the table of golden values."""
    answer = so.PointTracker(planar_body()).start(point).proximity
    assert answer.certified
    assert answer.inside == (distance < 0.0)
    assert answer.distance == pytest.approx(distance, abs=1e-10)
    assert answer.feature == feature
    if parameter is not None:
        assert answer.parameters[0] == pytest.approx(parameter, abs=1e-8)


@pytest.mark.parametrize("make", [planar_body, ellipse, stadium, clockwise, leaf])
def test_against_brute_force_from_inside_to_outside(make: object) -> None:
    """Distance, side and bounds at every tenth frame, whatever the kinds of the curves."""
    body: so.Body = make()  # type: ignore[operator]
    path = Spiral(0.05, 0.08, 6.0, centre=(0.03, -0.02))
    run = so.points.record_point(so.PointTracker(body, 5e-3), path, np.arange(0.0, 3.0, 5e-3))
    assert all(answer.certified for answer in run.answers)
    assert {False, True} == set(run.inside.tolist())
    for k in range(0, len(run), 10):
        exact = to_boundary(body, run.point[k]) * (-1.0 if winding(body, run.point[k]) else 1.0)
        assert run.distance[k] == pytest.approx(exact, abs=1e-11)
        assert run.lower_bound[k] - 1e-12 <= exact <= run.upper_bound[k] + 1e-12
        # the witness is on the boundary, along the normal
        foot = run.point[k] - run.distance[k] * run.normal[k]
        assert foot == pytest.approx(run.witness[k], abs=1e-7)


def half_disc(height: float) -> so.Body:
    arc = ConicArc((0, 0), (1, 0), (0, height), 0.0, math.pi)
    return so.shapes.planar_loop([arc, Line((-1, 0), (1, 0))])


LAWS = so.PredictorCorrector(), so.PaperLaw(gain=60.0)


@pytest.mark.parametrize(("height", "law"), share(2, [0.05, 0.6, 2.0], LAWS), ids=repr)
def test_wild_motion_is_never_wrong_in_silence(height: float, law: Any) -> None:
    """Jumps of any size, thin bodies: certified answers are right, bounds hold in any case."""
    rng = np.random.default_rng(round(100 * height))
    body = half_disc(height)
    tracker = so.PointTracker(body, 1e-2, law)
    x = np.zeros(2)
    state = tracker.start(x)
    for k in range(60):
        way = rng.normal(size=2) * 10.0 ** rng.uniform(-3.0, 0.0)
        x = 0.9 * x + way
        state, answer = tracker.step(state, x, way / 1e-2 if k % 3 else None)
        exact = to_boundary(body, x) * (-1.0 if answer.inside else 1.0)
        assert answer.inside == winding(body, x)
        assert answer.lower_bound - 1e-9 <= exact <= answer.upper_bound + 1e-9
        if isinstance(law, so.PredictorCorrector):
            assert answer.certified
        if answer.certified:
            assert answer.distance == pytest.approx(exact, abs=1e-9)


def test_distance_and_normal_pass_through_the_boundary() -> None:
    """A straight path out of a curve: signed distance with slope 1, one normal throughout."""
    body = planar_body()
    foot, tangent, _ = body.edge_parts[0].curve.jet(0.4)
    normal = np.array([tangent[1], -tangent[0], 0.0]) / np.linalg.norm(tangent)
    tracker = so.PointTracker(body)
    state = tracker.start(foot - 1e-3 * normal, normal)
    for s in np.concatenate([np.linspace(-1e-3, 1e-3, 21), [-1e-9, 0.0, 1e-9, 1e-12, -1e-12]]):
        state, answer = tracker.step(state, foot + s * normal, normal)
        assert answer.distance == pytest.approx(s, abs=1e-14)
        assert answer.normal == pytest.approx(normal, abs=1e-9)
        assert answer.rate == pytest.approx(1.0, abs=1e-12)
        assert answer.certified


@pytest.mark.parametrize("make", [planar_body, ellipse, stadium])
def test_side_is_decided_to_roundoff(make: object) -> None:
    """Points 1e-12 beside the boundary; exactly on it is neither."""
    body: so.Body = make()  # type: ignore[operator]
    boundary = PlanarBoundary(body)
    for edge, part in enumerate(body.edge_parts):
        for t in np.linspace(part.curve.first, part.curve.last, 23)[1:-1]:
            foot, normal = boundary.point(edge, float(t)), boundary.normal(edge, float(t))
            assert boundary.inside(foot + 1e-12 * normal) is False
            assert boundary.inside(foot - 1e-12 * normal) is True


@pytest.mark.parametrize("make", [planar_body, ellipse])
def test_chords_bound_the_depth(make: object) -> None:
    """The bound is below the depth at any sharpness, and as sharp as it is asked to be."""
    body: so.Body = make()  # type: ignore[operator]
    boundary = PlanarBoundary(body)
    for x in np.random.default_rng(5).uniform(-0.5, 0.5, (12, 2)):
        depth, t = min(to_curve(body, e, x) for e in range(body.n_edges))
        edge = min(range(body.n_edges), key=lambda e: to_curve(body, e, x)[0])
        for slack in (1e-2, 1e-5, 1e-11):
            found = boundary.bounds(x, (edge, t), depth - slack)
            assert depth - slack - 1e-14 <= found.depth <= depth + 1e-14


def test_a_minimum_that_was_left_out_is_found_and_counted() -> None:
    """Begun on the far side of an ellipse alone: the certificate meets the nearer side."""
    tracker = so.PointTracker(ellipse())
    answer = tracker.start_from((0.1, 0.3), (1.5 * math.pi,)).proximity
    assert answer.counts.restarts == 1
    assert answer.certified
    assert answer.distance == pytest.approx(
        -to_boundary(ellipse(), np.array([0.1, 0.3])), abs=1e-12
    )


def test_no_bound_without_a_proof() -> None:
    """A tolerance that needs more chords than allowed: an open gap, said so."""
    disc = so.shapes.planar_loop([ConicArc((0, 0), (1, 0), (0, 1))])
    answer = so.PointTracker(disc).start((0.0, 0.0)).proximity
    assert answer.status is so.Status.LOCAL
    assert answer.lower_bound <= -1.0 <= answer.upper_bound
    assert answer.upper_bound - answer.lower_bound < 1e-3


def test_swept_radius_moves_boundary_and_witness() -> None:
    body = so.shapes.planar_loop([part.curve for part in planar_body().edge_parts], rounding=0.2)
    plain, swept = so.PointTracker(planar_body()), so.PointTracker(body)
    for point in ((0.1, 0.05), (1.5, 0.4), (1.6, 0.05), (0.95, 0.3)):
        a, b = plain.start(point).proximity, swept.start(point).proximity
        assert b.distance == pytest.approx(a.distance - 0.2, abs=1e-14)
        assert b.witness == pytest.approx(a.witness + 0.2 * a.normal, abs=1e-12)
        assert b.certified


def test_without_velocities_the_rates_are_unknown() -> None:
    tracker = so.PointTracker(planar_body(), 1e-2)
    state = tracker.start((0.1, 0.05))
    for k in range(60):
        state, answer = tracker.step(state, (0.1 + 0.02 * k, 0.05))
        assert math.isnan(answer.rate)
        assert answer.certified
    assert not answer.inside


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda t: t.start((0.0, math.nan)), "nan"),
        (lambda t: t.start((0.0, 0.0, 1.0)), "out of z = 0"),
        (lambda t: t.start((0.0, 0.0), (1.0, 0.0, 1.0)), "velocity"),
        (lambda t: t.start_from((0.0, 0.0), (0.5, 0.5)), "3 curves"),
        (lambda t: t.start_from((0.0, 0.0), (0.5, 1.5, 0.5)), "outside curve 1"),
        (lambda t: t.step(t.start((0.0, 0.0)), (0.0, 0.0), dt=-1.0), "dt = -1"),
        (lambda t: so.PointTracker(so.shapes.sphere(1.0), law=so.PaperLaw()), "paper's law"),
        (lambda t: so.PointTracker(so.shapes.sphere(1.0)).start_from((0, 0, 0), ()), "is spatial"),
        (
            lambda t: so.PointTracker(planar_body(), law=so.PaperLaw(switching="none")),
            "multipliers",
        ),
        (lambda t: so.PointTracker(planar_body(), law=so.shapes), "is not a law"),
        (lambda t: so.points.record_point(t, Spiral(0, 1, 1), [1.0, 0.0]), "increasing"),
    ],
)
def test_bad_input(call: object, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        call(so.PointTracker(planar_body()))  # type: ignore[operator]


def test_a_state_is_a_value() -> None:
    """The same step from the same state gives the same answer, also after others."""
    tracker = so.PointTracker(planar_body(), law=so.PaperLaw(gain=100.0))
    state = tracker.start_from((0.1, 0.05), (0.9, 0.1, 0.1), (1.0, 0.0))
    one = tracker.step(state, (0.101, 0.05), (1.0, 0.0))[1]
    tracker.step(state, (0.5, 0.5), (0.0, 3.0))
    two = tracker.step(state, (0.101, 0.05), (1.0, 0.0))[1]
    assert one.distance == two.distance
    assert one.as_dict() == two.as_dict()
