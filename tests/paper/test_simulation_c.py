"""Simulation C (Figs. 12-15) against brute force over all pairs of features."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy.optimize import brentq

from oracles.bounds import maximise_separation
from oracles.closed_forms import point_curve
from oracles.loops import BezierCurve, PlanarLoop
from oracles.planar_pairs import PlanarPair
from standoff.tracking import Status
from standoff_studies.oracles import Placed
from standoff_studies.paper import style
from standoff_studies.paper.held_features import CONTINUOUS, greatest_growth, growth
from standoff_studies.paper.simulation_c import figure_12, figure_13, figure_14, figure_15
from standoff_studies.paper.simulation_c import run as chapter
from standoff_studies.paper.simulation_c.automaton import ways
from standoff_studies.paper.simulation_c.kinds import kind_of, mode_name
from standoff_studies.paper.simulation_c.parameters import (
    LEAST_APART,
    after_switches,
    named_stays,
    spread,
)
from standoff_studies.paper.simulation_c.regions import off_line

A = [
    BezierCurve([(1, 0), (0.775, 0.645), (0.175, 1.005), (-0.5, 0.9)]),
    BezierCurve([(-0.5, 0.9), (-0.87, 0.41), (-0.91, -0.27), (-0.6, -0.8)]),
    BezierCurve([(-0.6, -0.8), (0.12, -1.04), (0.76, -0.72), (1, 0)]),
]
B = [
    BezierCurve([(-0.7, 0), (0, -0.75), (0.7, 0)], [1, 0.8, 1]),
    BezierCurve([(0.7, 0), (0.5, 0.35), (0.1, 0.45)]),
    BezierCurve([(0.1, 0.45), (-0.4, 0.45), (-0.7, 0)]),
]
PAIR = PlanarPair(A, B)

INSTANT = 1e-9
"""s: the issue's tolerance of an instant whose switching function is steep enough."""
STEEP = 1e-3
"""1/s: the least slope that counts as steep; below it the tolerance is INSTANT / slope."""
RATE_STENCIL = 1e-6
"""s: half width of the difference that gives the brute force's slope."""


def placed(times):
    """B's turn (n, 2, 2) and shift (n, 2) in A's axes, written out anew."""
    t = np.atleast_1d(times)
    angle, radius = np.radians(150.0) + np.pi / 4.0 * t, 3.0 - 0.13 * np.pi / 4.0 * t
    spin = -1.5 * t
    turn = np.array([[np.cos(spin), -np.sin(spin)], [np.sin(spin), np.cos(spin)]])
    return np.moveaxis(turn, 2, 0), np.column_stack(
        [radius * np.cos(angle), radius * np.sin(angle)]
    )


@cache
def truth():
    """The brute force at every frame."""
    return PAIR.nearest(*placed(chapter.SIMULATION.exact.time))


def named(feature):
    return ("vertex" if feature.kind == "vertex" else "curve", feature.index)


def modes_of(recording):
    pairs = zip(recording.feature_a, recording.feature_b, strict=True)
    return [(named(a), named(b)) for a, b in pairs]


def true_switches():
    """Frames before a change of mode by the brute force, with the modes before and after."""
    found = truth().pair
    frames = np.flatnonzero(np.diff(found)).tolist()
    return [(k, PAIR.pairs[found[k]], PAIR.pairs[found[k + 1]]) for k in frames]


def switching_value(low, high, time):
    """Slope of the distance at the held minimum of the lower mode, into the higher one's curve."""
    turn, shift = placed(time)
    held = PAIR.held(low, turn, shift)
    side = 0 if low[0] != high[0] else 1
    (_, vertex), (_, curve) = low[side], high[side]
    end = 0.0 if vertex == curve else 1.0
    tangent = PAIR.loops[side][curve].jet(np.array([end]))[1][0]
    tangent *= (1.0 - 2.0 * end) / np.linalg.norm(tangent)
    if side == 1:
        tangent = turn[0] @ tangent
    gap = (held.point_a - held.point_b)[0] * (1.0 - 2.0 * side)
    return float(gap @ tangent) / float(np.linalg.norm(gap))


def true_instant(frame, before, after):
    """The root of the brute force's switching function near a frame's step, and its slope."""
    low, high = sorted((before, after), key=lambda pair: [kind for kind, _ in pair].count("curve"))
    assert sum(x != y for x, y in zip(low, high, strict=True)) == 1
    time = chapter.SIMULATION.exact.time

    def value(t):
        return switching_value(low, high, t)

    # A step more on both sides: at a frame itself the sign is that of roundoff.
    root = brentq(value, time[frame - 1], time[frame + 2], xtol=1e-15, rtol=1e-15)
    rise = value(root + RATE_STENCIL) - value(root - RATE_STENCIL)
    return root, rise / (2.0 * RATE_STENCIL)


@pytest.mark.soak
def test_the_brute_force_itself():
    """The design's golden values for a vertex of B as the point; then cutting planes, which
    bound the distance from both sides by support functions alone."""
    corner = np.array([-0.7, 0.0])
    for point, distance, feature in (
        ((1.5, 0.4), 0.614435369167, ("curve", 0)),
        ((1.6, 0.05), 0.602079728940, ("vertex", 0)),
    ):
        shift = np.array([point]) - corner
        rows = {f: PAIR.held((f, g), np.eye(2)[None], shift) for f, g in PAIR.pairs[::6]}
        assert {g for _, g in PAIR.pairs[::6]} == {("vertex", 0)}
        nearest = min(rows, key=lambda f: rows[f].distance[0])
        assert nearest == feature
        assert rows[nearest].distance[0] == pytest.approx(distance, abs=1e-10)
    time = chapter.SIMULATION.exact.time
    for frame in range(0, len(time), 1500):
        turn, shift = placed(time[frame])
        whole = np.eye(3)
        whole[:2, :2] = turn[0]
        loops = (
            Placed(PlanarLoop(A), np.eye(3), np.zeros(3)),
            Placed(PlanarLoop(B), whole, np.append(shift[0], 0.0)),
        )
        bound = maximise_separation(*loops)
        assert truth().distance[frame] == pytest.approx(bound.value, abs=1e-9)


def test_mode_sequence():
    """Fig. 13: the visited modes are those of the brute force, frame by frame."""
    simulation = chapter.SIMULATION
    known = [PAIR.pairs[k] for k in truth().pair]
    assert modes_of(simulation.exact) == known
    stays = [(named(stay.feature_a), named(stay.feature_b)) for stay in simulation.exact.modes()]
    assert stays == [known[0], *(after for _, _, after in true_switches())]


def test_the_printed_system_takes_the_same_switches():
    """Fig. 13: once converged, the modes of the brute force, late by less than 1/K = 40 ms; a
    frame may differ where a switch falls into it."""
    simulation, gain = chapter.SIMULATION, 25.0
    law = simulation.paper.info.options
    assert (law["gain"], law["switching"], law["solve"]) == (gain, "voronoi", "plain")
    assert (law["saturation"], law["reset"], law["restarts"]) == ("zero", "nearest", False)
    modes, known = modes_of(simulation.paper), [PAIR.pairs[k] for k in truth().pair]
    settled = round(chapter.SIMULATION.entered / chapter.SIMULATION.step)
    changes = [
        k for k in range(settled, len(known)) if known[k] != known[k - 1]
    ]  # frames at which the brute force switches
    differ = [k for k in range(settled, len(known)) if modes[k] != known[k]]
    assert len(changes) == 34
    assert all(min(abs(k - c) for c in changes) <= 1 for k in differ)
    assert simulation.furthest() < 1e-4
    # the start is wrong, on another feature of B
    assert modes[0] == (("curve", 1), ("curve", 0)) != known[0]


def test_nothing_is_injected():
    """No frame holds a restart, a search or a parameter that a solve has written."""
    counts = chapter.SIMULATION.paper.total_counts()
    assert (counts.restarts, counts.searches, counts.solved_parameters) == (0, 0, 0)
    assert counts.foot_points > 12000


def test_starts_anywhere():
    """Random curves and parameters of both: what the statement of Fig. 13 counts."""
    tried = chapter.arrivals()
    assert tried.tried == 200
    assert tried.arrived == 200


def test_all_kinds_of_modes_occur_several_times():
    """Issue: vertex-vertex, vertex-curve, curve-curve; each more than once, B on every feature."""
    simulation = chapter.SIMULATION
    kinds = [kind_of(stay.feature_a, stay.feature_b) for stay in simulation.paper.modes()]
    assert min(kinds.count(kind) for kind in range(3)) >= 3
    stays = simulation.paper.modes()
    assert {named(stay.feature_a) for stay in stays} == {f for f, _ in PAIR.pairs}
    assert {named(stay.feature_b) for stay in stays} == {f for _, f in PAIR.pairs}
    table = figure_13().tables["stays"]
    for a, b, kind in zip(table["feature_a"], table["feature_b"], table["kind"], strict=True):
        assert sorted(name[0] for name in (a, b)) == sorted(w[0].upper() for w in kind.split("–"))
    assert chapter.SIMULATION.b.n_edges == chapter.SIMULATION.b.n_vertices == 3


def test_snapshots_show_the_modes_of_their_frames():
    """Fig. 14: each snapshot's active features are the brute force's at its time."""
    simulation = chapter.SIMULATION
    times = [snapshot.time for snapshot in chapter.snapshots()]
    assert times == pytest.approx([k + 0.5 for k in range(12)], abs=1e-12)
    for snapshot in chapter.snapshots():
        assert simulation.exact.time[snapshot.frame] == pytest.approx(snapshot.time, abs=1e-12)
        known = PAIR.pairs[truth().pair[snapshot.frame]]
        assert (named(snapshot.feature_a), named(snapshot.feature_b)) == known


def test_switching_instants():
    """Fig. 15: instants to 1e-9 s where the switching function crosses with slope above 1e-3."""
    events = chapter.SIMULATION.exact.events
    switches = true_switches()
    assert len(events) == len(switches) == 35
    for event, switch in zip(events, switches, strict=True):
        assert event.located
        instant, slope = true_instant(*switch)
        allowed = INSTANT if abs(slope) > STEEP else INSTANT / abs(slope)
        assert abs(event.time - instant) <= allowed, (event, instant)
        assert abs(event.slope) == pytest.approx(abs(slope), rel=1e-4)


def test_tracking_error_at_all_times():
    """Fig. 15: distance and witness points are the brute force's at every frame."""
    recording, known = chapter.SIMULATION.exact, truth()
    np.testing.assert_allclose(recording.distance, known.distance, rtol=0.0, atol=1e-13)
    np.testing.assert_allclose(recording.point_a[:, :2], known.point_a, rtol=0.0, atol=5e-11)
    np.testing.assert_allclose(recording.point_b[:, :2], known.point_b, rtol=0.0, atol=5e-11)
    assert (recording.status == Status.CONVERGED).all()
    assert recording.lower_bound.min() > 0.2
    assert recording.gap.max() < 1e-10


def test_tracking_error_of_the_printed_system():
    """From a wrong start the errors decay as exp(-K t); so do those that a switch leaves."""
    simulation, known = chapter.SIMULATION, truth()
    off_a = np.linalg.norm(simulation.paper.point_a[:, :2] - known.point_a, axis=1)
    off_b = np.linalg.norm(simulation.paper.point_b[:, :2] - known.point_b, axis=1)
    error = np.maximum(off_a, off_b)
    np.testing.assert_allclose(error, simulation.witness_error, rtol=0.0, atol=1e-10)
    assert error[0] > 0.5
    settled = round(chapter.SIMULATION.entered / chapter.SIMULATION.step)
    assert error[settled:].max() < 3e-3
    quiet = ~after_switches(simulation)
    quiet[:settled] = False
    assert error[quiet].max() < 2e-5
    steps = [e.frame for e in simulation.entered_events(simulation.paper) if error[e.frame] > 1e-4]
    assert len(steps) >= 5
    rates = [np.log(error[k + 1] / error[k + 4]) / (3.0 * chapter.SIMULATION.step) for k in steps]
    assert np.median(rates) == pytest.approx(25.0, rel=0.2)


def test_the_distance_never_grows_at_a_switch():
    """The paper's claim: what the target's features reach is no farther than the source's."""
    simulation = chapter.SIMULATION
    assert greatest_growth(simulation.exact, simulation.paths) <= CONTINUOUS
    assert max(figure_13().tables["growth"]["distance_growth_length"]) <= CONTINUOUS
    for event in simulation.exact.events:
        # beside the instant one of the two is nearer: the measure can tell
        early, late = (
            growth(simulation.exact, simulation.paths, event, offset) for offset in (-0.02, 0.02)
        )
        assert early >= -CONTINUOUS
        assert late <= CONTINUOUS
        assert max(early, -late) > 1e-6

    def closed(pair, turn, shift):
        ends = [
            [feature, ("vertex", feature[1]), ("vertex", (feature[1] + 1) % len(loop))]
            if feature[0] == "curve"
            else [feature]
            for feature, loop in zip(pair, PAIR.loops, strict=True)
        ]
        held = [PAIR.held((x, y), turn, shift).distance[0] for x in ends[0] for y in ends[1]]
        return min(held)

    for event, (_, before, after) in zip(simulation.exact.events, true_switches(), strict=True):
        for time in (event.time, event.time + 1e-6):
            there = placed(time)
            assert closed(after, *there) <= closed(before, *there) + 1e-15


def test_parameters_are_constant_where_a_vertex_holds():
    """Fig. 15: the witness point stays in the vertex, and leaves it along the curve's parameter."""
    simulation = chapter.SIMULATION
    assert chapter.vertex_slip(simulation) <= 2e-15
    paper, table = simulation.paper, figure_15().tables["frames"]
    for names, features in (
        (("u_1", "u_2", "u_3"), paper.feature_a),
        (("r_a", "r_b", "r_c"), paper.feature_b),
    ):
        columns = np.array([table[name] for name in names])
        for k, feature in enumerate(features[::7]):
            drawn = columns[:, 7 * k]
            if feature.kind == "vertex":
                assert (drawn[feature.index], drawn[feature.index - 1]) == (0.0, 1.0)
            else:
                assert 0.0 <= drawn[feature.index] <= 1.0
                assert np.isnan(np.delete(drawn, feature.index)).all()


def test_external_lines_part_the_brute_force_s_features():
    """Fig. 12: on either side of each line the nearest feature is that of its region."""
    table = figure_12().tables["external_lines"]
    rows = list(zip(*table.values(), strict=True))
    assert [row[0] for row in rows] == ["A"] * 6 + ["B"] * 6
    for body, between, x, y, along_x, along_y in rows:
        loop = (A, B)["AB".index(body)]
        pair = PlanarPair(loop, [BezierCurve([(0, 0), (0.5, -0.2), (1, 0)])])
        start, along = np.array([x, y]), np.array([along_x, along_y])
        aside = np.array([-along_y, along_x])
        for far in (0.1, 1.0, 3.0):
            seen = set()
            for sign in (-1.0, 1.0):
                point = start + far * along + sign * 1e-4 * aside
                held = {
                    feature: pair.held((feature, ("vertex", 0)), np.eye(2)[None], point[None])
                    for feature, other in pair.pairs
                    if other == ("vertex", 0)
                }
                kind, index = min(held, key=lambda feature: held[feature].distance[0])
                seen.add(f"{'V' if kind == 'vertex' else 'C'}{index}")
            assert seen == set(between.split("/"))


def test_medial_axes_are_halfway_between_the_curves():
    """Fig. 12: a point of the axis is as deep under one curve as under the other, and no deeper
    under a third."""
    table = figure_12().tables["medial_axes"]
    assert set(zip(table["body"], table["branch"], strict=True)) == {
        ("A", 0),
        ("A", 1),
        ("A", 2),
        ("B", 0),
        ("B", 1),
        ("B", 2),
    }
    for body, _, between, x, y, depth in list(zip(*table.values(), strict=True))[::9]:
        loop = (A, B)["AB".index(body)]
        away = [point_curve(np.array([x, y, 0.0]), curve)[0] for curve in loop]
        two = [away[int(name[1:])] for name in between.split("/")]
        assert two == pytest.approx([depth, depth], abs=1e-9)
        assert min(away) == pytest.approx(depth, abs=1e-9)


def test_switches_are_on_the_external_lines():
    """Figs. 12 and 13: the opposing witness point is on the line between the two features."""
    simulation = chapter.SIMULATION
    for event in simulation.exact.events:
        assert off_line(simulation, event) <= 1e-12


def test_statements_hold():
    """All statements of the chapter, as the report prints them."""
    statements = [
        s for make in (figure_12, figure_13, figure_14, figure_15) for s in make().statements
    ]
    assert len(statements) >= 10
    assert [s for s in statements if s.holds is False] == []
    assert sum(s.holds is True for s in statements) >= 7


def test_the_automaton_s_picture_shows_every_switch():
    """Fig. 13: all modes named, all instants written, once each."""
    simulation = chapter.SIMULATION
    (axes,) = figure_13().draw().axes
    texts = [text.get_text() for text in axes.texts]
    for pair in {(stay.feature_a, stay.feature_b) for stay in simulation.paper.modes()}:
        assert sum(text.startswith(mode_name(*pair)) for text in texts) == 1
    written = sorted(line for text in texts for line in text.split("\n") if line.count(".") == 1)
    times = [f"{event.time:.3f}" for event in simulation.entered_events(simulation.paper)]
    assert set(times) <= set(written)
    assert sum(len(way.times) for way in ways(simulation)) == len(simulation.paper.modes()) - 1
    assert len(figure_13().tables["switches"]["time_s"]) == len(simulation.paper.events)


def test_pictures_are_drawn():
    """Figs. 14 and 15: twelve equal-axed panels; every stay's instant above its panel."""
    panels = figure_14().draw().axes
    assert len(panels) == 12
    assert all(axes.get_aspect() == 1.0 for axes in panels)
    simulation = chapter.SIMULATION
    texts = [text.get_text() for axes in figure_15().draw().axes for text in axes.texts]
    named_ones = [text for text in texts if "–" in text]
    assert len(named_ones) == len(named_stays(simulation, (0.0, 12.0)))
    assert [text for text in texts if "–" not in text] == list("abcdefghijkl")
    animation = figure_14().animation
    assert animation is not None
    assert animation.frames <= 100
    with style.settings():
        figure = style.new_figure(*animation.size)
        animation.draw(figure, animation.frames - 1)
    assert figure.axes[0].get_title().strip().startswith("12.00 s")


def test_written_instants_keep_apart():
    """The places of the labels: in order, apart, and where nothing presses, in place."""
    wanted = np.array([0.0, 1.0, 1.01, 1.02, 3.0])
    places = spread(wanted, LEAST_APART)
    assert np.diff(places).min() >= LEAST_APART - 1e-12
    assert places[[0, 4]].tolist() == [0.0, 3.0]
    assert places[1:4].mean() == pytest.approx(wanted[1:4].mean())
