"""A point's switches: their order and their instants, against independent roots."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray
from point_oracle import ellipse, to_curve
from scipy.optimize import brentq

import standoff as so
from standoff.motion import ConstantTwist, Pose, Spiral, Twist
from standoff_studies.paper.bodies import planar_body

Array = NDArray[np.float64]

SPIRAL = Spiral(0.05, 0.08, 2.0 * math.pi)
WRONG = ((0.95, 0.05, 0.05), (0.05, 0.95, 0.95), (1.0, 1.0, 0.0))


@cache
def reference() -> so.points.PointRecording:
    """The predictor-corrector on a spiral of three turns through the planar body."""
    times = np.linspace(0.0, 3.0, 1201)
    return so.points.record_point(so.PointTracker(planar_body(), 2.5e-3), SPIRAL, times)


def test_features_against_brute_force_over_all() -> None:
    """Every fifth frame's active feature has the least distance of all curves."""
    run = reference()
    for k in range(0, len(run), 25):
        near = [to_curve(run.body, e, run.point[k]) for e in range(3)]
        least = min(range(3), key=lambda e: near[e][0])
        curve = run.body.edge_parts[least].curve
        t = near[least][1]
        if t in (curve.first, curve.last) and not run.inside[k]:
            assert run.feature[k].kind == "vertex"
        else:
            assert run.feature[k] == so.Feature("edge", least)


def test_instants_are_roots_of_independent_functions() -> None:
    """1e-9 s where the switching function's slope is above 1e-3: all of them here."""
    run = reference()
    assert {event.kind for event in run.events} == {"medial", "crossing", "voronoi"}
    for event in run.events:
        assert event.located
        assert abs(event.slope) > 1e-3

        def value(t: float, event: so.points.PointEvent = event) -> float:
            x = SPIRAL.pose(t).translation
            if event.kind == "medial":
                source, target = (to_curve(run.body, f.index, x)[0] for f in event[2:4])
                return target - source
            if event.kind == "crossing":
                return beside(run.body, event.source.index, x)
            return along_the_end(run.body, event, x)

        root = brentq(value, event.time - 1e-3, event.time + 1e-3, xtol=1e-13)
        assert event.time == pytest.approx(root, abs=1e-9)
        step = 1e-6
        rate = (value(event.time + step) - value(event.time - step)) / (2.0 * step)
        assert event.slope == pytest.approx(rate, rel=1e-3)


def slow(start: Array, velocity: Array) -> ConstantTwist:
    """A straight path at 2e-3 length/s: switching functions with small slopes."""
    unit = velocity / np.linalg.norm(velocity)
    pose = Pose.from_wxyz((1, 0, 0, 0), start - 2e-3 * unit)
    return ConstantTwist(pose, Twist(2e-3 * unit, (0.0, 0.0, 0.0)))


@pytest.mark.parametrize("kind", ["medial", "crossing", "voronoi"])
def test_slow_switches_are_located_as_well(kind: str) -> None:
    """1e-9 s where the slope is a few 1e-3: the thresholds of release do not shift an instant."""
    body = planar_body()
    foot, tangent, _ = body.edge_parts[0].curve.jet(0.4)
    end, into, _ = body.edge_parts[0].curve.jet(0.0)
    places = {
        "medial": (so.voronoi_regions(body).medial_axis[0].points[9], np.array([0.1, 1.0, 0.0])),
        "crossing": (foot, np.array([tangent[1], -0.5 * tangent[0], 0.0])),
        "voronoi": (end + 0.8 * np.array([into[1], -into[0], 0.0]), into),
    }
    path = slow(*places[kind])
    tracker = so.PointTracker(body, 0.05)
    run = so.points.record_point(tracker, path, np.arange(0.0, 2.0, 0.05))
    (event,) = run.events
    assert event.kind == kind
    assert 1e-3 < abs(event.slope) < 1e-2

    def value(t: float) -> float:
        x = path.pose(t).translation
        if kind == "medial":
            source, target = (to_curve(body, f.index, x)[0] for f in event[2:4])
            return target - source
        return beside(body, 0, x) if kind == "crossing" else along_the_end(body, event, x)

    root = brentq(value, event.time - 0.1, event.time + 0.1, xtol=1e-13)
    assert event.time == pytest.approx(root, abs=1e-9)


def beside(body: so.Body, edge: int, x: Array) -> float:
    """How far a point is to the right of a counter-clockwise curve, by the normal at its foot."""
    foot, tangent, _ = body.edge_parts[edge].curve.jet(to_curve(body, edge, x)[1])
    normal = np.array([tangent[1], -tangent[0], 0.0]) / np.linalg.norm(tangent)
    return float(normal @ (x - foot))


def along_the_end(body: so.Body, event: so.points.PointEvent, x: Array) -> float:
    """Cosine between a curve's end tangent and the way from the vertex to the point."""
    edge, vertex = sorted((event.source, event.target), key=lambda f: f.kind)
    curve, corner = body.edge_parts[edge.index].curve, body.vertex_points[vertex.index]
    first = math.dist(curve.point(curve.first), corner) < math.dist(curve.point(curve.last), corner)
    end, other = (0.0, 1e-7) if first else (1.0, 1.0 - 1e-7)
    along = curve.jet(end)[1] * math.copysign(1.0, other - end)
    away = x - corner
    return float(-(along @ away) / np.linalg.norm(along) / np.linalg.norm(away))


def test_distance_never_grows_at_a_switch() -> None:
    """Dated to the frame, the winner is less than what it replaces; located, they are equal."""
    times = np.linspace(0.0, 3.0, 301)
    dated = so.points.record_point(
        so.PointTracker(planar_body(), 1e-2), SPIRAL, times, locate=False
    )
    jumps = [event for event in dated.events if event.kind == "medial"]
    assert jumps
    assert all(event.value < 0.0 for event in jumps)
    for event in reference().events:
        if event.kind != "voronoi":
            assert abs(event.value) < 1e-12


@cache
def from_wrong(start: int, gain: float = 40.0) -> so.points.PointRecording:
    tracker = so.PointTracker(planar_body(), 2.5e-3, law=so.PaperLaw(gain=gain))
    x, v = SPIRAL.pose(0.0).translation, SPIRAL.twist(0.0).v
    state = tracker.start_from(x, WRONG[start], v)
    return so.points.record_point(tracker, SPIRAL, np.linspace(0.0, 3.0, 1201), state)


def test_wrong_start_converges_as_the_gain_says() -> None:
    """Psi of every curve's own tracker falls as exp(-K t), Eq. (13)."""
    run = from_wrong(0)
    for edge in range(3):
        curve = run.body.edge_parts[edge].curve
        psi = [
            run.curve_residual[k, edge] * np.linalg.norm(curve.jet(run.curve_parameter[k, edge])[1])
            for k in (20, 80)
        ]
        assert math.log(psi[0] / psi[1]) / (run.time[80] - run.time[20]) == pytest.approx(
            40, rel=0.02
        )
    assert abs(run.distance[0] - reference().distance[0]) > 0.05
    error = np.abs(run.distance - reference().distance)[160:]
    # Where a parameter leaves its bound the law sets off early, by up to its rate over K.
    assert np.quantile(error, 0.75) < 1e-6
    assert error.max() < 6.0 / 40.0


def test_instants_do_not_depend_on_the_start() -> None:
    """Once the starts have converged, all switch at the same instants: to 1e-9 s."""
    runs = [[e for e in from_wrong(k).events if e.time > 0.6] for k in range(len(WRONG))]
    for run in runs[1:]:
        assert [e[1:4] for e in run] == [e[1:4] for e in runs[0]]
        assert [e.time for e in run] == pytest.approx([e.time for e in runs[0]], abs=1e-9)


def test_printed_switching_does_not_depend_on_the_parameters_at_all() -> None:
    """Voronoi tests outside: not converged by far, and yet the exact instants."""
    path = Spiral(1.3, 0.02, 4.0)
    times = np.linspace(0.0, 2.0, 801)
    exact = so.points.record_point(so.PointTracker(planar_body(), 2.5e-3), path, times)
    assert len(exact.events) >= 4
    for wrong in (0.6, 1.0):
        tracker = so.PointTracker(
            planar_body(), 2.5e-3, law=so.PaperLaw(gain=2.0, switching="voronoi")
        )
        x, v = path.pose(0.0).translation, path.twist(0.0).v
        state = tracker.start_from(x, (wrong,) * 3, v, feature=("edge", 0))
        run = so.points.record_point(tracker, path, times, state)
        assert np.abs(run.distance - exact.distance).max() > 1e-2
        own = [e for e in run.events if e.time > times[1]]
        kept = [e for e in exact.events if e.time > times[1]]
        assert [e[1:4] for e in own] == [e[1:4] for e in kept]
        assert [e.time for e in own] == pytest.approx([e.time for e in kept], abs=1e-9)


def test_ellipse_jumps_on_its_major_axis() -> None:
    """One curve with two minima: its medial axis is the axis between the centres of curvature."""
    path = Spiral(0.1, 0.03, 5.0)
    run = so.points.record_point(so.PointTracker(ellipse(), 4e-3), path, np.arange(0.0, 2.4, 4e-3))
    jumps = [event for event in run.events if event.kind == "medial"]
    assert len(jumps) == 3
    for event in jumps:
        assert event.source == event.target == so.Feature("edge", 0)
        assert event.time * 5.0 / math.pi == pytest.approx(
            round(event.time * 5.0 / math.pi), abs=1e-9
        )


@pytest.mark.parametrize("switching", ["multipliers", "voronoi"])
def test_out_of_the_body_and_on_to_a_vertex_within_a_frame(switching: str) -> None:
    """Crossing and Voronoi switch in one step: both found, also where the paper's law enters."""
    body = planar_body()
    foot = body.edge_parts[0].curve.point(0.005)
    way = np.array([0.8, -0.6, 0.0])
    path = ConstantTwist(
        Pose.from_wxyz((1, 0, 0, 0), foot - 0.02 * way), Twist(way, (0.0, 0.0, 0.0))
    )
    times = np.array([0.0, 0.036])
    exact = so.points.record_point(so.PointTracker(body, 0.05), path, times)
    assert [event.kind for event in exact.events] == ["crossing", "voronoi"]
    assert exact.events[0].time == pytest.approx(0.02, abs=1e-9)
    tracker = so.PointTracker(body, 0.05, law=so.PaperLaw(gain=20.0, switching=switching))
    paper = so.points.record_point(tracker, path, times)
    assert paper.feature[1] == exact.feature[1] == so.Feature("vertex", 0)
    if switching == "voronoi":
        assert [event.time for event in paper.events] == pytest.approx(
            [event.time for event in exact.events], abs=1e-9
        )
