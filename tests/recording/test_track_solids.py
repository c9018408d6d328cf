"""Runs of solids that need not be convex: recorded as those of convex bodies are."""

from __future__ import annotations

import json
from dataclasses import fields
from functools import cache
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from moving_pairs import REST, Tumbling, straight

import standoff as so
from families.solid_shapes import bracket, prism
from standoff.recording import Recording
from standoff.tracking.branches import Birth, End
from standoff.view.export import save_page


@cache
def feet() -> so.Solid:
    """A bridge upside down: two feet at y = 1, and a floor between them at y = 0.5."""
    return prism([(0, 0), (3, 0), (3, 1), (2, 1), (2, 0.5), (1, 0.5), (1, 1), (0, 1)], 1.0)


BALL = so.shapes.sphere(0.3)
ACROSS = straight((0.2, 1.5, 0.5), (1.0, 0.0, 0.0))
"""At 1 a second from one foot over the floor to the other, 0.5 above their tops."""
STEP = 0.0127


@pytest.fixture(scope="module")
def run() -> Recording:
    tracker = so.Tracker(feet(), BALL, STEP, minima=0.75)
    return so.track(tracker, REST, ACROSS, 2.6)


def test_switches_are_dated_by_hand(run: Recording) -> None:
    """The ball leaves the first foot's top at x = 1 for its edge, is half way at x = 1.5, and comes
    onto the second top at x = 2."""
    assert len(run) == 205  # more than one block of frames
    times = [event.time for event in run.events]
    assert all(event.located and event.body == "A" for event in run.events)
    assert times == pytest.approx([0.8, 1.3, 1.8], abs=1e-6)
    assert [e.source.kind for e in run.events] == ["face", "edge", "edge"]
    assert [e.target.kind for e in run.events] == ["edge", "edge", "face"]
    for event in run.events:
        assert run.time[event.frame - 1] < event.time <= run.time[event.frame]
    assert run.counts[:, 2].sum() == 3
    stays = run.modes()
    assert [stay.end for stay in stays] == pytest.approx([0.8, 1.3, 1.8, run.time[-1]], abs=1e-6)


def test_distances_and_rates_are_those_by_hand(run: Recording) -> None:
    x = 0.2 + run.time
    past = np.maximum(np.minimum(x, 3.0 - x) - 1.0, 0.0)
    expected = np.hypot(past, 0.5) - 0.3
    sign = np.where(x < 1.5, 1.0, -1.0)
    rates = sign * past / np.hypot(past, 0.5)
    assert run.certified.all()
    assert run.distance == pytest.approx(expected, abs=1e-9)
    assert (run.lower_bound <= expected + 1e-14).all()
    assert (expected - 1e-14 <= run.upper_bound).all()
    assert run.rate == pytest.approx(rates, abs=1e-6)
    assert np.isnan(run.residual).all()
    assert np.isnan(run.velocity_a).all()


def test_rates_where_both_move() -> None:
    rng = np.random.default_rng(20261128)
    a, b = Tumbling(rng, np.zeros(3)), Tumbling(rng, (3.0, 1.0, 0.0))
    run = so.track(so.Tracker(bracket(), feet(), 1e-3), a, b, 0.2)
    smooth = np.ones(len(run), dtype=bool)
    for event in run.events:
        smooth[event.frame - 2 : event.frame + 2] = False
    slopes = np.gradient(run.distance, run.time)
    assert np.abs(run.rate).max() > 0.1
    assert run.rate[smooth][1:-1] == pytest.approx(slopes[smooth][1:-1], abs=1e-4)


def test_a_frame_is_that_of_a_run(run: Recording) -> None:
    tracker = so.Tracker(feet(), BALL, minima=0.75)
    poses = np.array([ACROSS.pose(t).matrix for t in run.time])
    state = tracker.start(np.eye(4), poses[0])
    _, answers = tracker.run(state, np.eye(4), poses[1:])
    assert run.distance[1:].tolist() == answers.distance.tolist()
    assert run.lower_bound[1:].tolist() == answers.lower_bound.tolist()
    assert run.status[1:].tolist() == answers.status.tolist()
    assert [*run.feature_a[1:]] == [answer.feature_a for answer in answers]
    told = [[*row[~np.isnan(row)]] for row in run.parameters_a[1:]]
    assert told == [[*answer.parameters_a] for answer in answers]
    first = int((run.minima.frame == 0).sum())
    assert run.minima.frame[first:].tolist() == (answers.minima.frame + 1).tolist()
    assert run.minima.key[first:].tolist() == answers.minima.key.tolist()
    assert run.minima.distance[first:].tolist() == answers.minima.distance.tolist()
    begun = [e for e in run.minima_events if e.frame == 0]
    assert [(e.kind, e.key, e.reason) for e in begun] == [("birth", 0, Birth.START)]
    later = [e._replace(frame=e.frame - 1) for e in run.minima_events if e.frame]
    assert later == list(answers.events)
    ends = {e.key: e.reason for e in later if e.kind == "end"}
    assert ends == {0: End.FAR, 1: End.LEFT}


def test_a_file_holds_all_of_it(run: Recording, tmp_path: Path) -> None:
    run.save(tmp_path / "run.parquet")
    again = so.open_recording(tmp_path / "run.parquet")
    for field in fields(run):
        if field.name in ("pair", "paths", "events", "minima"):
            continue
        was, read = getattr(run, field.name), getattr(again, field.name)
        if isinstance(was, np.ndarray) and was.dtype != object:
            np.testing.assert_array_equal(was, read)
        elif isinstance(was, np.ndarray):
            assert was.tolist() == read.tolist()
        else:
            assert was == read, field.name
    assert str(again.events) == str(run.events)
    for was, read in zip(run.minima, again.minima, strict=True):
        assert was.tolist() == read.tolist()
        assert was.dtype == read.dtype
    table = pq.read_table(tmp_path / "run.parquet")
    told = json.loads(table.schema.metadata[b"standoff"])
    assert told["format_version"] == 5
    assert told["a_sha256"] == feet().boundary.digest
    assert told["b_sha256"] == BALL.digest
    assert told["options"]["tolerance"] == 1e-10
    assert told["options"]["minima"] == 0.75
    assert again.info.of_solids
    with pytest.raises(so.StandoffError, match="follow no law"):
        _ = again.info.law


def test_the_same_run_gives_the_same_bytes(tmp_path: Path) -> None:
    for name in ("1.parquet", "2.parquet"):
        short = so.track(so.Tracker(feet(), BALL, 0.1, minima=0.75), REST, ACROSS, 1.0)
        short.save(tmp_path / name)
    assert (tmp_path / "1.parquet").read_bytes() == (tmp_path / "2.parquet").read_bytes()


def test_pictures_and_tables(run: Recording, tmp_path: Path) -> None:
    figure = run.plot(tmp_path / "run.png")
    names = [text.get_text() for axes in figure.axes if axes.get_legend() is not None
             for text in axes.get_legend().get_texts()]  # fmt: skip
    assert "local minima" in names
    assert "residual" not in names
    frame = run.to_pandas()
    assert len(frame) == len(run)
    assert frame.attrs["standoff"]["options"]["minima"] == 0.75
    save_page(run, tmp_path / "run.html")
    assert (tmp_path / "run.html").stat().st_size > 100_000
    with pytest.raises(so.StandoffError, match="save_page"):
        run.animate()
    with pytest.raises(so.StandoffError, match="save_page"):
        so.view(run)


def test_through_contact(tmp_path: Path) -> None:
    """A pad comes down onto a lid and through it, tilted a little: depths are signed distances."""
    lid, pad = so.Solid(so.shapes.box((4, 4, 1))), so.shapes.box((1, 1, 1))
    down = straight((0.02, 0.03, 1.055), (0.0, 0.0, -0.1))
    tilt = so.Pose.exp((0.02, 0.03, 0.0))
    tracker = so.Tracker(lid, pad, 0.05, minima=0.2)
    run = so.track(tracker, REST, lambda t: down.pose(t) @ tilt, 1.0)
    corner = np.array([[x, y, -0.5] for x in (-0.5, 0.5) for y in (-0.5, 0.5)])
    low = (corner @ tilt.rotation.T)[:, 2].min()
    assert run.distance == pytest.approx(1.055 - 0.1 * run.time + low - 0.5, abs=1e-9)
    assert run.penetrating.any()
    assert not run.penetrating.all()
    assert run.rate[~run.penetrating] == pytest.approx(-0.1, abs=1e-6)
    assert np.isnan(run.rate[run.penetrating]).all()
    assert {event.kind for event in run.minima_events} == {"birth"}
    run.plot(tmp_path / "run.png")
    run.save(tmp_path / "run.parquet")
    assert so.open_recording(tmp_path / "run.parquet").status.tolist() == run.status.tolist()


def test_where_pairs_tie_there_is_no_rate() -> None:
    lid, pad = so.Solid(so.shapes.box((4, 4, 1))), so.shapes.box((1, 1, 1))
    run = so.track(so.Tracker(lid, pad, 0.1), REST, straight((0, 0, 1.5), (0, 0, -1.0)), 0.3)
    assert {status.name for status in run.status} == {"CONTINUUM"}
    assert np.isnan(run.rate).all()
    assert run.minima is None
    assert run.minima_events == ()


def test_features_are_told_without_minima_too(run: Recording) -> None:
    alone = so.track(so.Tracker(feet(), BALL, STEP), REST, ACROSS, 2.6)
    assert [event[:5] for event in alone.events] == [event[:5] for event in run.events]
    assert alone.feature_a.tolist() == run.feature_a.tolist()
    assert alone.distance == pytest.approx(run.distance, abs=1e-12)
    assert alone.minima is None
    assert alone.info.options["minima"] is None


def test_it_begins_at_a_state(run: Recording) -> None:
    tracker = so.Tracker(feet(), BALL, STEP)
    state = tracker.start(REST, ACROSS.pose(0.0))
    other = so.Tracker(bracket(), BALL, STEP).start(REST, ACROSS.pose(0.0))
    from standoff.recording.track import track_along

    times, told = run.time[:5], []
    begun = track_along(tracker, so.motion.Fixed(REST), ACROSS, times, state=state,
                        progress=lambda done, total: told.append((done, total)))  # fmt: skip
    assert begun.distance.tolist() == run.distance[:5].tolist()
    assert told == [(1, 5), (5, 5)]
    with pytest.raises(so.StandoffError, match="another pair"):
        track_along(tracker, so.motion.Fixed(REST), ACROSS, times, state=other)


def test_without_looking_into_the_steps(run: Recording) -> None:
    dated = so.track(so.Tracker(feet(), BALL, STEP, minima=0.75), REST, ACROSS, 2.6, locate=False)
    assert [event.frame for event in dated.events] == [event.frame for event in run.events]
    assert [event.time for event in dated.events] == [dated.time[e.frame] for e in run.events]
    assert not any(event.located for event in dated.events)
    with pytest.raises(TypeError, match="is not a Tracker"):
        so.track(feet(), REST, ACROSS, 1.0)
