"""Calls from Python beside Coal: rows, errors and what is missing; no time is judged."""

import sys

import numpy as np
import pytest
from benchmarks import regression_work
from benchmarks.bench.motion import all_pairs, motion
from benchmarks.from_python import (
    AGAINST_BEFORE,
    GOALS,
    GUESS,
    IN_OVERLAP,
    NAMED,
    STEP,
    Effort,
    Goal,
    Line,
    held,
    lines_of,
    seen_from_a,
    table,
)

import standoff as so

OURS = 1e-12
"""Greatest error of a distance of the library, over the size."""
DIFFERENCES = 1e-9
"""Error of central differences, over the size."""
pytestmark = pytest.mark.usefixtures("quick_collections")
TINY = Effort(frames=8, rounds=1)
PAIR = all_pairs()[0]


def test_every_goal_has_its_row_and_its_errors():
    lines = list(lines_of(TINY, gaps=(0.1,)))
    titles = {line.title for line in lines}
    assert [line.goal for line in lines] == [*GOALS, *GOALS, *GOALS, IN_OVERLAP]
    assert len(titles) == 4
    for line in lines:
        if line.missing:
            continue
        assert len(line.times) == len(line.against) == TINY.rounds
        assert line.error < (DIFFERENCES if line.goal is IN_OVERLAP else OURS), line.title
    assert len(table(lines)) == 2 + len(lines)


def test_a_gap_is_held_in_every_frame():
    for gap in (1e-3, 0.5, 20.0):
        frames = held(PAIR, motion(PAIR.far, 5), gap)
        for poses in frames.pairs:
            found = so.distance(PAIR.a.body, PAIR.b.body, *poses).distance
            assert found == pytest.approx(gap, rel=1e-9)


def test_one_body_at_rest_is_the_same_motion():
    frames = motion(PAIR.far, 5)
    seen = seen_from_a(frames)
    for own, other in zip(frames.pairs, seen.pairs, strict=True):
        found = [so.distance(PAIR.a.body, PAIR.b.body, *poses).distance for poses in (own, other)]
        assert found[0] == pytest.approx(found[1], rel=1e-13)
        assert other[0] is seen.pairs[0][0]


def test_a_ratio_is_the_median_of_those_of_each_round():
    """A machine twice as slow in one round changes both times."""
    line = Line("bodies", Goal(STEP, GUESS, 1.0), (2e-6, 4e-6, 1e-6), (1e-6, 2e-6, 2e-6), 0.0, 1e-7)
    assert line.ratio == 2.0
    row = table([line])[-1]
    assert "| ≤ 1 | **2** | 0.5 to 2 | 2 | 2 | 0 | 1e-07 | **not met** |" in row
    met = Line("bodies", Goal(STEP, GUESS, 2.0), line.times, line.against)
    assert table([met])[-1].endswith("| met |")


def test_without_coal_its_rows_say_so(monkeypatch):
    monkeypatch.setitem(sys.modules, "coal", None)
    lines = list(lines_of(TINY, gaps=()))
    missing = [line for line in lines if line.missing]
    assert [line.goal for line in missing] == 2 * list(GOALS[:3])
    for line, row in zip(missing, table(missing)[2:], strict=True):
        assert "standoff-studies[peers]" in line.missing
        assert f"missing: {line.missing}" in row


def test_the_work_against_another_commit_is_named_so_and_is_what_it_says():
    pieces = {name for name in regression_work.PIECES if NAMED in name}
    assert {name.partition(": ")[0] for name in AGAINST_BEFORE} == pieces
    assert not any(NAMED in name for name in regression_work.pairs())
    box, tool, poses = regression_work.along_an_edge(400)
    tracker = so.Tracker(box, tool, regression_work.DT)
    state = tracker.start(np.eye(4), poses[0])
    for pose in poses[1:]:
        state, answer = tracker.step(state, np.eye(4), pose)
        assert answer.feature_a.kind == "edge"
        assert answer.status is so.Status.CONVERGED
