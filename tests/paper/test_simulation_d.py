"""Simulation D: the lens and a point on a helix, against the closed form of three balls."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import brentq

import standoff as so
from oracles import closed_forms
from standoff.motion import Helix
from standoff.recording.track import track_along
from standoff_studies import oracles as support
from standoff_studies.paper.held_features import (
    CONTINUOUS,
    greatest_growth,
    growth,
    held_distance,
)
from standoff_studies.paper.simulation_d import modes, parameters, runs, scene
from standoff_studies.paper.simulation_e.runs import SIMULATION as OTHER
from standoff_studies.paper.voronoi_drawing import region_sheets

AT_POINT = (("vertex", 0), ())
LENS = support.Lens(1.0, 0.45)
HOME = so.Pose.identity()
# Faces of the lens at each of its edges, as it was sewn: asserted in the first test.
EDGES = {frozenset((0, 1)): 0, frozenset((0, 2)): 1, frozenset((1, 2)): 2}
SLOW = 1e-4
TO_INSTANT = 1e-9
"""Seconds within which an instant is to be located, where the slope is above 1e-3 per second."""


@pytest.fixture(scope="module")
def run():
    return runs.SIMULATION


@pytest.fixture(scope="module")
def truth():
    """By brute force over all features, for every frame: the feature, distance, closest point."""
    points = [runs.HELIX.pose(t).translation for t in runs.SIMULATION.exact.time.tolist()]
    found = [closed_forms.point_lens(point, LENS) for point in points]
    return (
        [feature_of_foot(foot) for _, foot in found],
        np.array([distance for distance, _ in found]),
        np.array([foot for _, foot in found]),
    )


def feature_of_foot(foot):
    """The feature that a point of the lens is on, by the balls whose spheres it lies on."""
    on = [i for i, c in enumerate(LENS.centres) if abs(np.linalg.norm(foot - c) - 1.0) < 1e-9]
    if len(on) == 1:
        return so.Feature("face", on[0])
    if len(on) == 2:
        return so.Feature("edge", EDGES[frozenset(on)])
    return so.Feature("vertex", int(foot[2] > 0.0))


def stays(features):
    return tuple(b for a, b in pairwise([None, *features]) if a != b)


def crossing(helix, source, target, low, high):
    """The instant at which the closest point leaves one feature for another, in closed form.

    A face is left where the foot on its sphere reaches the next ball, an edge for a vertex where
    the foot on its circle does.
    """
    lower, higher = sorted((source, target), key=lambda f: ("vertex", "edge", "face").index(f.kind))
    pairs = {number: pair for pair, number in EDGES.items()}
    if lower.kind == "edge":
        (other,) = pairs[lower.index] - {higher.index}
    else:
        (other,) = {0, 1, 2} - pairs[higher.index]

    def beyond(t):
        point = helix.pose(t).translation
        if higher.kind == "face":
            centre = LENS.centres[higher.index]
            arm, radius = point - centre, 1.0
        else:
            centre, axis, radius = LENS.circle(*pairs[higher.index])
            arm = point - centre - ((point - centre) @ axis) * axis
        foot = centre + radius * arm / np.linalg.norm(arm)
        return np.linalg.norm(foot - LENS.centres[other]) - 1.0

    return brentq(beyond, low, high, xtol=1e-14, rtol=1e-15)


def exact_instants(helix, times, features):
    return np.array(
        [
            crossing(helix, *pair, *ends)
            for pair, ends in zip(pairwise(features), pairwise(times), strict=True)
            if pair[0] != pair[1]
        ]
    )


def test_edges_are_numbered_as_the_oracle_has_them(run):
    for faces, edge in EDGES.items():
        for face in range(3):
            on = edge in [number for number, _ in run.a.face_parts[face].loop]
            assert on == (face in faces)


def test_faces_edges_and_a_vertex_are_visited(run):
    """Fig. 16: faces, edges and a vertex; each switch is to a neighbour."""
    seen = runs.sequence(run.exact.modes())
    assert set(seen) == {*(f"{k} {i}" for k in ("face", "edge") for i in range(3)), "vertex 1"}
    assert len(seen) == 11
    assert [name.split()[0] for name in seen].count("edge") == 5


def test_modes_against_brute_force(run, truth):
    """Fig. 17: the mode of every frame, of the printed system too from its first frames on."""
    assert run.exact.feature_a.tolist() == truth[0]
    entered = round(run.entered / run.step) + 1
    for recording in run.printed:
        assert recording.feature_a[0] != truth[0][0]
        assert recording.feature_a[entered:].tolist() == truth[0][entered:]


def test_instants_are_located(run, truth):
    """Fig. 17: to 1e-9 s where the switching function crosses with a slope above 1e-3."""
    expected = exact_instants(runs.HELIX, run.exact.time.tolist(), truth[0])
    events = run.exact.events
    assert [event.target for event in events] == list(stays(truth[0]))[1:]
    assert all(event.located and abs(event.slope) > 1e-3 for event in events)
    np.testing.assert_allclose([event.time for event in events], expected, atol=TO_INSTANT, rtol=0)
    ends = [visit.end for visit in run.exact.modes()]
    np.testing.assert_allclose(ends[:-1], expected, atol=TO_INSTANT, rtol=0)


def test_instants_of_slow_crossings(run):
    """Fig. 17, on a helix ten thousand times slower: to 1e-9 s over the slope."""
    helix = Helix(
        radius=1.6,
        pitch=0.6,
        rate=2.0 * SLOW,
        centre=(-0.29, 0.05, 0.37),
        axis=(15.0, 0.0, 4.0),
        phase=np.radians(100.0),
    )
    recording = so.track(so.Tracker(run.a, run.b, 20.0), HOME, helix, run.duration / SLOW)
    features, times = recording.feature_a.tolist(), recording.time.tolist()
    expected = exact_instants(helix, times, features)
    assert len(recording.events) == len(expected) == 10
    for event, instant in zip(recording.events, expected, strict=True):
        assert abs(event.slope) < 1e-3
        assert abs(event.time - instant) <= TO_INSTANT / abs(event.slope)


def test_instants_do_not_depend_on_the_start(run, truth):
    """Section on the hybrid system: for a body and a point the switching times are the motion's."""
    expected = exact_instants(runs.HELIX, run.exact.time.tolist(), truth[0])
    starts = [recording.point_a[0] for recording in run.printed]
    assert min(np.linalg.norm(a - b) for a, b in pairwise(starts)) > 0.5
    for recording in run.printed:
        instants = [event.time for event in run.entered_events(recording)]
        np.testing.assert_allclose(instants, expected, atol=TO_INSTANT, rtol=0)
    assert run.furthest() <= TO_INSTANT
    assert np.isinf(run.late(OTHER.exact)).all()


def test_the_distance_never_grows_at_a_switch(run, truth):
    """Section on the hybrid system; beside the instants the measure can tell."""
    paths = run.paths
    assert greatest_growth(run.exact, paths) <= CONTINUOUS
    for event in run.exact.events:
        early, late = (growth(run.exact, paths, event, offset) for offset in (-0.02, 0.02))
        assert max(early, -late) > 1e-6
        # what is held before the instant is the closest point
        pose = runs.HELIX.pose(event.time - 0.02)
        place = run.exact.feature_a[event.frame - 21], run.exact.parameters_a[event.frame - 21]
        own = place[0], place[1][~np.isnan(place[1])]
        found = held_distance(run.exact.pair, (HOME, pose), own, AT_POINT)
        distance, _ = closed_forms.point_lens(pose.translation, LENS)
        assert found == pytest.approx(distance, abs=1e-12)


def test_the_figures_are_the_printed_systems(run):
    """One configuration, at a low gain; nothing searched, restarted, or taken from a solve."""
    for recording in run.printed:
        assert recording.info.law == so.PaperLaw.as_printed(gain=run.gain)
        counts = recording.total_counts()
        assert counts.restarts == counts.searches == counts.solved_parameters == 0
        assert counts.foot_points > 0
    tried = runs.arrivals()
    assert 0.4 < tried.arrived / tried.tried < 0.95
    # what does not arrive is on the right face, at a side of its patch, with M indefinite
    for ends in (tried, runs.arrivals(moving=False)):
        assert ends.placed == ends.pinned == ends.lost > 0


@pytest.mark.parametrize("law", ["exact", "paper"])
def test_parameters_are_constant_on_edges(run, law):
    """Fig. 18: stretches at exactly 0 or 1 where the point lies on an edge."""
    recording = run.exact if law == "exact" else run.paper
    faces = [runs.face_parameters(recording, face) for face in range(3)]
    first = runs.settling_steps(recording)
    checked = 0
    for visit in recording.modes():
        if visit.end <= recording.time[first]:
            continue
        frames = (recording.time >= visit.start) & (recording.time < visit.end)
        frames[:first] = False
        uv = np.array([face[frames] for face in faces])
        if visit.feature_a.kind == "edge":
            on = [face for face in range(3) if not np.isnan(uv[face]).any()]
            assert EDGES[frozenset(on)] == visit.feature_a.index
            assert sorted(np.unique(uv[on][..., 0])) == [0.0, 1.0]
            for face in on:
                assert np.ptp(uv[face][:, 0]) == 0.0
                assert np.ptp(uv[face][:, 1]) > 1e-3
            np.testing.assert_array_equal(uv[on[0]][:, 1], uv[on[1]][:, 1])
            checked += 1
        elif visit.feature_a.kind == "vertex":
            assert (uv[..., 1] == 1.0).all()
            assert np.isnan(uv[..., 0]).all()
        else:
            face = visit.feature_a.index
            # the paper's law begins its first step on a face at the edge it comes from
            inside = uv[face] if law == "exact" else uv[face][1:]
            assert (inside > 0.0).all()
            assert (inside < 1.0).all()
            assert np.isnan(np.delete(uv, face, axis=0)).all()
    assert checked == 5


def test_parameters_are_those_of_the_closest_point(run):
    """What Fig. 18 draws is where the closest point is, on every face that holds it."""
    surfaces = [part.charts[0] for part in run.a.face_parts]
    for face in range(3):
        uv = runs.face_parameters(run.exact, face)
        for k in np.flatnonzero(~np.isnan(uv[:, 1]))[::50]:
            u, v = uv[k]
            point = surfaces[face].jet(0.3 if np.isnan(u) else u, v)[0]
            np.testing.assert_allclose(point, run.exact.point_a[k], atol=1e-13)


def test_tracking_error_at_all_times(run, truth):
    """The default law against the closed form in every frame, and the paper's law."""
    _, distance, foot = truth
    assert run.exact.certified.all()
    assert np.abs(run.exact.distance - distance).max() < 1e-12
    assert np.abs(run.exact.point_a - foot).max() < 1e-10
    events = [event.frame for event in run.exact.events]
    for recording in run.printed:
        error = np.linalg.norm(recording.point_a - foot, axis=1)
        since = np.arange(len(recording))
        for frame in (0, *events):
            since[frame:] = np.arange(len(recording) - frame)
        # what a start and a switch leave decays as exp(-K t), to the law's own error
        late = since * run.step > 6.0 / run.gain
        assert error[late].max() < 3e-3
        assert error[since * run.step > 12.0 / run.gain].max() < 2e-5
        assert (recording.distance >= distance - 1e-12).all()


def test_wrong_starts_converge(run):
    """The errors fall at the rate K."""
    for recording in run.printed:
        assert recording.residual[0] > 1.0
        at = [round(t / run.step) for t in parameters.DECAY]
        error = np.linalg.norm(recording.point_a - run.exact.point_a, axis=1)[at]
        rate = np.log(error[0] / error[1]) / (parameters.DECAY[1] - parameters.DECAY[0])
        assert rate == pytest.approx(run.gain, rel=0.08)


def test_the_automaton_lists_what_was_taken(run):
    """Fig. 17: every switch is one of the lens's transitions, at the recording's own instant."""
    automaton = run.exact.automaton()
    assert automaton.restarts == ()
    assert len(automaton.visited) == 7
    assert automaton.modes == 8
    assert [time for time, _ in automaton.taken] == [event.time for event in run.exact.events]
    for (_, before), (_, after) in pairwise(automaton.taken):
        assert before.target == after.source
    table = modes.figure_17().tables["transitions"]
    assert sum(table["taken_times"]) == len(run.paper.events) == 12


def test_the_voronoi_surfaces_part_the_regions(run):
    """Fig. 16: a point of a surface has its closest point where the surface stands on the lens."""
    sheets = region_sheets(so.voronoi_regions(run.a), scene.REACH)
    assert len(sheets) == 12  # two along each edge, one at each end
    for sheet in sheets:
        for row in sheet[::3]:
            for point in row[2::2]:
                _, foot = closed_forms.point_lens(point, LENS)
                np.testing.assert_allclose(foot, row[0], atol=1e-7)


@pytest.mark.parametrize(
    "make", [scene.figure_16, modes.figure_17, parameters.figure_18], ids=["16", "17", "18"]
)
def test_figures(make):
    """Every statement holds, every table has columns of one length, and pictures are drawn."""
    artwork = make()
    fail = [s.stated for s in artwork.statements if s.holds is False]
    assert fail == (
        ["from a start anywhere on tiled convex bodies the errors converge"]
        if make is modes.figure_17
        else []
    )
    assert any(statement.holds for statement in artwork.statements)
    assert all(statement.by for statement in artwork.statements if statement.stated != "-")
    for table in artwork.tables.values():
        assert len({len(column) for column in table.values()}) == 1
    assert artwork.draw().axes
    if artwork.animation:
        from standoff_studies.paper import style

        for frame in (0, artwork.animation.frames - 1):
            figure = style.new_figure(*artwork.animation.size)
            artwork.animation.draw(figure, frame)
            assert figure.axes


def test_a_start_anywhere_converges(run):
    """Section on the hybrid system: a start anywhere on convex bodies converges."""
    rng = np.random.default_rng(4)
    law = so.Tracker(run.a, run.b, run.step, law=so.PaperLaw(switching="voronoi"))
    rest = run.paths[0]
    times = np.arange(120) * run.step
    motion = HOME, runs.HELIX.pose(0.0)
    for _ in range(15):
        start = law.start_from(
            *motion,
            (("face", int(rng.integers(3))), rng.uniform(0.02, 0.98, 2)),
            AT_POINT,
        )
        recording = track_along(law, rest, runs.HELIX, times, state=start)
        assert recording.residual[-1] < 1e-5
