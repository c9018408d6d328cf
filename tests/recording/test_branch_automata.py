"""The automaton of solids: a branch for each local minimum, and what happens between branches."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread
from moving_pairs import REST, straight

import standoff as so
from families.solid_shapes import prism, ring
from standoff.automaton import BranchAutomaton, SolidAutomaton
from standoff.automaton.branch_text import branches_mermaid
from standoff.automaton.graph import body_transitions, features_of
from standoff.automaton.parallel import solid_automaton
from standoff.automaton.text import moves
from standoff.recording import Recording
from standoff.tracking.branches import Birth, End

FEET = prism([(0, 0), (3, 0), (3, 1), (2, 1), (2, 0.5), (1, 0.5), (1, 1), (0, 1)], 1.0)
"""A bridge upside down: two feet at y = 1, and a floor between them at y = 0.5."""
BALL = so.shapes.sphere(0.3)
STEP = 0.0127


@pytest.fixture(scope="module")
def run() -> Recording:
    """The ball goes at 1 a second from x = 0.2 to 2.8, 0.5 above the feet."""
    path = straight((0.2, 1.5, 0.5), (1.0, 0.0, 0.0))
    return so.track(so.Tracker(FEET, BALL, STEP, minima=0.75), REST, path, 2.6)


@pytest.fixture(scope="module")
def found(run: Recording) -> SolidAutomaton:
    return run.automaton()


@pytest.fixture(scope="module")
def merging() -> Recording:
    """A level rod rolls outwards over a ring: its two places come together at the top."""
    across = so.Pose.exp((0, np.pi / 2, 0))

    def rolling(t: float) -> so.Pose:
        return so.Pose.exp((0, 0, 0), (0, 0.9 + t, 0.45)) @ across

    tracker = so.Tracker(ring(1.0, 0.2), so.shapes.capsule(0.1, 3.0), 0.005, minima=0.75)
    return so.track(tracker, REST, rolling, 0.4)


@pytest.fixture(scope="module")
def sinking() -> Recording:
    """The ball sinks into a foot so deep that no place is told, and comes up again."""

    def path(t: float) -> so.Pose:
        x, y = {1.0: (0.5, 1.35), 2.0: (1.5, 0.25), 3.0: (0.5, 1.35)}.get(t, (0.5, 1.4))
        return so.Pose(np.eye(3), (x, y, 0.5))

    return so.track(so.Tracker(FEET, BALL, 1.0, minima=0.25), REST, path, 4.0)


def first_frame(run: Recording, when: float) -> float:
    """The time of the first frame that is not before an instant [s]."""
    return float(run.time[np.searchsorted(run.time, when)])


def spans(visits: tuple[so.automaton.Visit, ...]) -> list[tuple[str, str, float, float]]:
    return [(v.feature_a.kind, v.feature_b.kind, v.start, v.end) for v in visits]


def test_the_ball_goes_through_modes_at_the_times_by_hand(
    run: Recording, found: SolidAutomaton
) -> None:
    """It leaves the first top at x = 1 and comes onto the second one at x = 2; the edges are
    within reach, 0.75, up to sqrt(1.05² - 0.5²) from them; the floor is below it in between."""
    reach = np.sqrt(1.05**2 - 0.5**2)
    first, floor, second = found.branches
    exactly = {"abs": 1e-6}
    gone = first_frame(run, 0.8 + reach)
    for (*_, start, end), told in zip(spans(first.visits), [(0.0, 0.8), (0.8, gone)], strict=True):
        assert (start, end) == pytest.approx(told, **exactly)
    assert [v.feature_a.kind for v in first.visits] == ["face", "edge"]
    assert spans(floor.visits) == [("face", "vertex", first_frame(run, 0.8), first_frame(run, 1.8))]
    seen = first_frame(run, 1.8 - reach)
    for (*_, start, end), told in zip(
        spans(second.visits), [(seen, 1.8), (1.8, run.time[-1])], strict=True
    ):
        assert (start, end) == pytest.approx(told, **exactly)
    assert [v.feature_a.kind for v in second.visits] == ["edge", "face"]
    kinds = [[t.kind for _, t in branch.taken] for branch in found.branches]
    assert kinds == [["boundary"], [], ["release"]]
    assert [t for t, _ in found.taken] == pytest.approx([0.8, 1.8], **exactly)


def test_the_nearest_is_handed_over_half_way(run: Recording, found: SolidAutomaton) -> None:
    """Between the frames at which the order of both distances changes, and at x = 1.5 by hand."""
    (handover,) = (event for event in found.events if event.kind == "handover")
    assert (handover.other, handover.key, handover.located) == (0, 2, True)
    assert handover.time == pytest.approx(1.3, abs=1e-6)
    told = run.minima
    by_key = [dict(zip(told.frame[told.key == k], told.distance[told.key == k], strict=True))
              for k in (0, 2)]  # fmt: skip
    both = sorted(set(by_key[0]) & set(by_key[1]))
    ahead = next(k for k in both if by_key[1][k] < by_key[0][k])
    assert run.time[ahead - 1] < handover.time <= run.time[ahead]
    first, floor, second = found.branches
    assert first.nearest == ((0.0, handover.time),)
    assert floor.nearest == ()
    assert second.nearest == ((handover.time, run.time[-1]),)


def events_agree(recording: Recording) -> None:
    """What begins and ends is what the recording tells, at the times of its frames."""
    told = [e for e in recording.minima_events if e.kind in ("birth", "end")]
    events = [e for e in recording.automaton().events if e.kind != "handover"]
    assert [(e.kind, e.key, e.reason, e.other, e.mode, e.distance, e.time) for e in events] == [
        (e.kind, e.key, e.reason, e.other, e.features, e.distance, recording.time[e.frame])
        for e in told
    ]


def lives(branch: BranchAutomaton, last: float) -> list[tuple[float, float]]:
    """From when to when a branch lives [s]; to the `last` frame if it does not end."""
    births = [event.time for event in branch.events if event.kind == "birth"]
    ends = [event.time for event in branch.events if event.kind == "end"]
    return list(zip(births, [*ends, last][: len(births)], strict=True))


def test_visits_tile_the_lives_of_branches(
    run: Recording, merging: Recording, sinking: Recording
) -> None:
    for recording in (run, merging, sinking):
        events_agree(recording)
        automaton = recording.automaton()
        for branch in automaton.branches:
            ((start, end),) = lives(branch, recording.time[-1])
            assert branch.visits[0].start == start
            assert branch.visits[-1].end == end
            for before, after in pairwise(branch.visits):
                assert before.end == after.start
                assert before[:2] != after[:2]
            switched = {time for time, _ in branch.taken}
            assert {visit.start for visit in branch.visits[1:]} <= switched
        spans = sorted(span for branch in automaton.branches for span in branch.nearest)
        assert all(one[1] <= two[0] for one, two in pairwise(spans))


def test_modes_are_those_of_the_minima_in_each_frame(run: Recording, merging: Recording) -> None:
    for recording in (run, merging):
        automaton, told = recording.automaton(), recording.minima
        for row in np.flatnonzero(told.key >= 0):
            time = recording.time[told.frame[row]]
            if time == recording.time[-1]:
                continue
            here = [
                visit[:2]
                for visit in automaton.branch(int(told.key[row])).visits
                if visit.start <= time < visit.end
            ]
            assert here == [(told.feature_a[row], told.feature_b[row])]


def test_a_branch_may_merge_into_another_one(merging: Recording) -> None:
    automaton = merging.automaton()
    (ended,) = (event for event in automaton.events if event.reason is End.MERGED)
    assert ended.time == pytest.approx(0.1, abs=0.0051)  # it lies over the top at y = 1
    assert {ended.key, ended.other} == {0, 1}
    assert automaton.branch(ended.other).visits[-1].end == merging.time[-1]
    assert f"{ended.key} ends, MERGED into {ended.other}" in automaton.text()
    assert f'==>|"{ended.time:.4g} s MERGED"| b{ended.other}_' in branches_mermaid(automaton)


def test_all_branches_end_where_the_solids_meet_too_deep(sinking: Recording) -> None:
    automaton = sinking.automaton()
    met = [event for event in automaton.events if event.reason is End.MET]
    again = [e for e in automaton.events if e.reason is Birth.START and e.time > 0.0]
    assert {event.time for event in met} == {2.0}
    assert {event.time for event in again} == {3.0}
    spans = sorted(span for branch in automaton.branches for span in branch.nearest)
    assert (spans[0][0], spans[-1][1]) == (0.0, 4.0)
    assert not any(start < 2.5 < end for start, end in spans)


def test_what_the_solids_allow_is_listed_as_of_bodies(found: SolidAutomaton) -> None:
    """Every edge bounds two faces and has two ends, and each is entered and left; at each of the
    two vertices of the floor's ends one face has a wide angle, at both ends of the prism."""
    assert found.listed
    assert found.modes == (10 + 24 + 16) * 1
    assert found.features_a == features_of(FEET.boundary)
    assert len(found.of("A")) == 4 * 24 + 4 * 24 + 4
    assert found.of("B") == ()
    assert {t for _, t in found.taken} <= set(found.transitions)
    box = so.shapes.box(1.0, 0.8, 0.6, rounding=0.1)
    listed = solid_automaton(so.Solid(box).given, FEET.boundary)
    assert listed.of("A") == tuple(body_transitions(box, "A"))
    assert listed.branches == ()
    assert "modes of each local minimum: 26 features of A × 50 of B = 1300" in listed.text()


def test_several_boundaries_at_once_are_no_transition(run: Recording) -> None:
    """As if the ball went from the first top to the second one within a frame: the kind of a switch
    is told only where there is a transition."""
    edge, other_edge, top = so.Feature("edge", 22), so.Feature("edge", 19), so.Feature("face", 4)
    for far, kind in ((edge, "boundary"), (other_edge, None), (top, None)):
        events = tuple(
            e._replace(features=(far, e.features[1])) if (e.kind, e.key) == ("switch", 0) else e
            for e in run.minima_events
        )
        again = object.__new__(Recording)
        again.__dict__.update(run.__dict__, minima_events=events)
        ((time, switch),) = again.automaton().branch(0).taken
        assert (switch.kind, switch.target) == (kind, far)
        # what was dated leads elsewhere, so that only the frame is known
        assert (time in run.time) == (kind is None)


def test_an_opened_recording_has_the_same_branches(
    run: Recording, found: SolidAutomaton, merging: Recording, tmp_path: Path
) -> None:
    for k, recording in enumerate((run, merging)):
        recording.save(tmp_path / f"{k}.parquet")
        was = recording.automaton()
        read = so.open_recording(tmp_path / f"{k}.parquet").automaton()
        assert not read.listed
        assert read.events == was.events
        assert read.visits == was.visits
        assert [b.nearest for b in read.branches] == [b.nearest for b in was.branches]
        assert [(t, *s[:3]) for t, s in read.taken] == [(t, *s[:3]) for t, s in was.taken]
        assert "are not in the recording" in read.text()
        assert read.text().splitlines()[-1] == was.text().splitlines()[-1]
    read = so.open_recording(tmp_path / "0.parquet").automaton()
    # a face and an edge show which way a switch goes
    assert [s.kind for _, s in read.taken] == [s.kind for _, s in found.taken]


def test_it_tells_in_a_line_what_it_is(found: SolidAutomaton) -> None:
    assert repr(found) == "<SolidAutomaton of prism and sphere: 3 branches, 5 modes visited>"
    assert repr(found.branch(1)) == "<BranchAutomaton 1: 1 mode visited>"


def test_it_needs_the_local_minima(run: Recording) -> None:
    path = straight((0.2, 1.5, 0.5), (1.0, 0.0, 0.0))
    plain = so.track(so.Tracker(FEET, BALL, 0.1), REST, path, 0.2)
    with pytest.raises(so.StandoffError, match=r"minima=LENGTH"):
        plain.automaton()
    with pytest.raises(LookupError, match="No branch has the key 7; there are 0, 1, 2"):
        run.automaton().branch(7)


@pytest.mark.parametrize("ending", ["svg", "png"])
def test_pictures(
    found: SolidAutomaton, merging: Recording, sinking: Recording, tmp_path: Path, ending: str
) -> None:
    for k, drawn in enumerate((found, merging.automaton(), sinking.automaton())):
        target = tmp_path / f"{k}.{ending}"
        drawn.plot(target)
        if ending == "png":
            assert imread(target).std() > 0.02
            continue
        text = target.read_text()
        for branch in drawn.branches:
            assert f"<!-- branch {branch.key} -->" in text
        for event in drawn.events:
            assert event.reason is None or f"<!-- {event.reason.name}" in text
    with pytest.raises(ValueError, match="ends in"):
        found.plot(tmp_path / "a.gif")


def test_mermaid_names_each_node_before_its_arrows(
    found: SolidAutomaton, merging: Recording
) -> None:
    for drawn in (found, merging.automaton(), solid_automaton(FEET.boundary, BALL)):
        lines = [line.strip() for line in branches_mermaid(drawn, ("feet", "ball")).splitlines()]
        assert lines[0] == "flowchart LR"
        assert sum(line.startswith("subgraph") for line in lines) == lines.count("end")
        known: set[str] = set()
        arrows = 0
        for line in lines:
            words = line.split()
            if line.startswith(("b", "A_", "B_")) and len(words) > 2 and words[1][:1] in "-=":
                assert {words[0], words[-1]} <= known
                arrows += 1
            elif line.startswith(("b", "A_", "B_")):
                known.add(line[: min(line.index(c) for c in "[(" if c in line)])
        changes = sum(len(moves(branch.visits)) for branch in drawn.branches)
        assert arrows == changes + len(drawn.events)
