"""Frame times, and that a run is the tracker's own answers, frame by frame."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import standoff as so
from standoff.motion import ConstantTwist
from standoff.scene import Scene, SceneError, TrackSettings, query, record

LoadText = Callable[[str], Scene]

HEAD = """version = 1
[bodies.tool]
shape = "ellipsoid"
semi_axes = [0.3, 0.1, 0.1]
[bodies.part]
shape = "box"
size = [1.0, 1.0, 1.0]
[pair]
a = "tool"
b = "part"
"""
TWIST = """
[placements.tool]
position = [-1.0, 0.2, 0.9]
[motions.tool]
kind = "twist"
linear = [1.0, 0.0, 0.0]
angular = [0.0, 0.5, 1.0]
"""
SAMPLED = '[motions.tool]\nkind = "samples"\nfile = "tool.tum"\nstart = "file"\n'
BOTH = f'{SAMPLED}[motions.part]\nkind = "samples"\nfile = "part.tum"\nstart = "file"\n'


@pytest.fixture(autouse=True)
def _samples(tmp_path: Path) -> None:
    """The tool from 1 s to 3 s at uneven times; the part from 1.5 s to 4 s."""
    poses = [(1.0, -1.0), (1.25, -0.9), (2.0, -0.8), (3.0, -0.9)]
    (tmp_path / "tool.tum").write_text("".join(f"{t} {x} 0 2 0 0 0 1\n" for t, x in poses))
    (tmp_path / "part.tum").write_text(
        "".join(f"{t} 0 0 0 0 0 0 1\n" for t in (1.5, 2.0, 2.5, 4.0))
    )
    (tmp_path / "late.tum").write_text("9 0 0 0 0 0 0 1\n10 0 0 0 0 0 0 1\n")


def test_steps_are_even_and_end_within_the_duration(load_text: LoadText) -> None:
    scene = load_text(f"{HEAD}{TWIST}[track]\nstart = 2.0\nstep = 0.1\nduration = 0.35\n")
    np.testing.assert_allclose(scene.times(), [2.0, 2.1, 2.2, 2.3], rtol=1e-15)


def test_a_whole_number_of_steps_is_not_lost_to_rounding(load_text: LoadText) -> None:
    scene = load_text(f"{HEAD}{TWIST}[track]\nstep = 0.1\nduration = 0.3\n")
    assert 0.3 / 0.1 < 3.0
    assert len(scene.times()) == 4
    assert scene.times()[-1] == 0.3


def test_default_step_is_a_millisecond(load_text: LoadText) -> None:
    times = load_text(f"{HEAD}{TWIST}[track]\nduration = 0.01\n").times()
    np.testing.assert_allclose(np.diff(times), 1e-3, rtol=1e-9)


def test_frames_are_the_samples_by_default(load_text: LoadText) -> None:
    np.testing.assert_array_equal(load_text(HEAD + SAMPLED).times(), [1.0, 1.25, 2.0, 3.0])
    scene = load_text(f'{HEAD}{SAMPLED}[track]\nstep = "samples"\nstart = 1.1\nduration = 1\n')
    np.testing.assert_array_equal(scene.times(), [1.25, 2.0])


def test_two_recordings_share_their_times(load_text: LoadText) -> None:
    np.testing.assert_array_equal(load_text(HEAD + BOTH).times(), [1.5, 2.0, 2.5, 3.0])


def test_a_step_through_samples_ends_with_them(load_text: LoadText) -> None:
    scene = load_text(f"{HEAD}{SAMPLED}[track]\nstep = 0.1\n")
    times = scene.times()
    assert times[0] == 1.0
    assert times[-1] == 3.0
    assert len(times) == 21
    assert record(scene).certified.all()


@pytest.mark.parametrize(
    ("text", "key", "piece"),
    [
        (f"{TWIST}", "track.duration", "duration = 10.0"),
        (f'{TWIST}[track]\nduration = 1\nstep = "samples"', "track.step", "step = 0.001"),
        (f"{TWIST}[track]\nduration = 1\nstep = 2", "track.duration", "1 frames"),
        (f"{TWIST}[track]\nduration = 1e5\nstep = 1e-4", "track.step", "1e+09 frames"),
        (f"{SAMPLED}[track]\nduration = 2.5", "track.duration", "give at most 2"),
        (f"{SAMPLED}[track]\nstart = 0.5", "track.start", "0.5 s is outside"),
        (f"{SAMPLED}[track]\nstart = 3.5", "track.start", "from 1 s to 3 s"),
        (
            f'{SAMPLED}[motions.part]\nkind = "samples"\nfile = "late.tum"\nstart = "file"',
            "motions",
            "no time in common",
        ),
    ],
)
def test_times_that_are_refused(load_text: LoadText, text: str, key: str, piece: str) -> None:
    scene = load_text(HEAD + text)
    with pytest.raises(SceneError) as caught:
        record(scene)
    assert caught.value.key == key
    assert piece in caught.value.problem
    assert caught.value.file == scene.file


def test_a_run_is_the_tracker_s_own_answers(load_text: LoadText) -> None:
    scene = load_text(f'{HEAD}{TWIST}[track]\nstep = 0.02\nduration = 2\npredictor = "feedforward"')
    recording = record(scene)
    a, b = so.shapes.ellipsoid(0.3, 0.1, 0.1), so.shapes.box(1.0, 1.0, 1.0)
    twist = so.Twist((1.0, 0.0, 0.0), (0.0, 0.5, 1.0))
    path = ConstantTwist(so.Pose(np.eye(3), (-1.0, 0.2, 0.9)), twist)
    rest, still = so.Pose.identity(), so.Twist.zero()
    steps = np.diff(recording.time)
    tracker = so.Tracker(
        a, b, dt=float(steps.max()), law=so.PredictorCorrector(predictor="feedforward")
    )
    state = tracker.start(path.pose(0.0), rest, path.twist(0.0), still)
    answers = [state.proximity]
    for time, step in zip(recording.time[1:].tolist(), steps.tolist(), strict=True):
        state, answer = tracker.step(state, path.pose(time), rest, path.twist(time), still, step)
        answers.append(answer)
    assert len(answers) == 101
    assert recording.certified.all()
    for name in ("distance", "lower_bound", "point_a", "point_b", "normal", "rate", "residual"):
        np.testing.assert_array_equal(
            getattr(recording, name), [getattr(answer, name) for answer in answers]
        )
    assert recording.feature_b.tolist() == [answer.feature_b for answer in answers]
    assert [tuple(row) for row in recording.counts] == [answer.counts for answer in answers]
    told = [(k, *event[1:4]) for k, answer in enumerate(answers) for event in answer.events]
    assert [(e.frame, e.body, e.source, e.target) for e in recording.events] == told
    assert recording.events
    assert recording.closest() == int(np.argmin(recording.distance))
    assert recording.widest_gap() == int(np.argmax(recording.distance - recording.lower_bound))
    assert recording.total_counts().evaluations == sum(a.counts.evaluations for a in answers)


def test_parameters_fill_as_many_columns_as_the_feature_has(load_text: LoadText) -> None:
    recording = record(load_text(f"{HEAD}{TWIST}[track]\nstep = 0.02\nduration = 2\n"))
    wanted = {"face": 2, "edge": 1, "vertex": 0}
    seen = [wanted[feature.kind] for feature in recording.feature_b]
    assert (~np.isnan(recording.parameters_b)).sum(axis=1).tolist() == seen
    assert len(set(seen)) > 1


def test_progress_is_told_to_the_end(load_text: LoadText) -> None:
    told: list[tuple[int, int]] = []
    scene = load_text(f"{HEAD}{TWIST}[track]\nstep = 0.005\nduration = 2\n")
    recording = record(scene, progress=lambda done, total: told.append((done, total)))
    assert len(recording) == 401
    assert len(told) > 2
    assert told == sorted(told)
    assert {total for _, total in told} == {401}
    assert told[-1][0] == 401


def test_penetration_has_a_distance(load_text: LoadText) -> None:
    recording = record(load_text(f"{HEAD}[track]\nstep = 0.1\nduration = 0.2\n"))
    assert (recording.distance < 0.0).all()
    assert recording.status_frames() == {so.Status.GLOBAL: 3}
    assert recording.certified.all()


def test_query_is_the_cold_distance(load_text: LoadText) -> None:
    scene = load_text(HEAD + TWIST)
    a, b = so.shapes.ellipsoid(0.3, 0.1, 0.1), so.shapes.box(1.0, 1.0, 1.0)
    time, answer = query(scene)
    direct = so.distance(a, b, so.Pose(np.eye(3), (-1.0, 0.2, 0.9)), so.Pose.identity())
    assert (time, answer.distance) == (0.0, direct.distance)
    time, answer = query(scene, 0.5)
    path = scene.motions["tool"].path
    assert answer.distance == so.distance(a, b, path.pose(0.5), so.Pose.identity()).distance
    assert query(load_text(HEAD + SAMPLED))[0] == 1.0


@pytest.mark.parametrize("time", [0.5, 3.01, float("nan")])
def test_query_outside_the_samples(load_text: LoadText, time: float) -> None:
    with pytest.raises(SceneError) as caught:
        query(load_text(HEAD + SAMPLED), time)
    assert caught.value.key == "time"


TIMED = {
    "a duration": (HEAD + TWIST + "[track]\nduration = 0.8\n", 0.0, 0.8),
    "a start": (HEAD + TWIST + "[track]\nstart = 0.7\nduration = 0.1\n", 0.7, 0.8),
    "no end": (HEAD + TWIST, 0.0, math.inf),
    "samples": (HEAD + SAMPLED, 1.0, 3.0),
    "samples, cut": (HEAD + SAMPLED + "[track]\nstart = 1.5\nduration = 1\n", 1.5, 2.5),
    "samples, too long": (HEAD + SAMPLED + "[track]\nstart = 1.5\nduration = 9\n", 1.5, 3.0),
}


@pytest.mark.parametrize("name", TIMED)
def test_an_instant_outside_the_scene_s_times_is_refused(load_text: LoadText, name: str) -> None:
    text, start, end = TIMED[name]
    scene = load_text(text)
    inside = [start, end if math.isfinite(end) else 1e6]
    for time in inside:
        assert scene.instant(time) == time
    outside = [start - 1e-6, -99.0, *([end + 1e-6, end + 99.0] if math.isfinite(end) else ())]
    for time in outside:
        with pytest.raises(SceneError, match=r"outside the (scene's times|pose samples)") as caught:
            query(scene, time)
        assert caught.value.key == "time"
        assert caught.value.file == scene.file
        if "duration" in text and f"{time:g} s is outside the scene's" in caught.value.problem:
            assert f"from {start:g} s to {end:g} s, a duration of" in caught.value.problem


def test_settings_given_in_place_of_the_scene_s(load_text: LoadText) -> None:
    scene = load_text(f'{HEAD}{TWIST}[track]\nlaw = "paper"\nstep = 0.1\nduration = 1\n')
    settings = scene.settings.overridden({"step": 0.05, "law": None})
    assert settings == TrackSettings(so.PaperLaw(), step=0.05, duration=1.0)
    with pytest.raises(SceneError, match=r"^step: must be above zero, got -1$"):
        scene.settings.overridden({"step": -1.0})


def test_the_tracker_s_refusals_name_the_scene(load_text: LoadText) -> None:
    scene = load_text(f'{HEAD}{TWIST}[track]\nlaw = "paper"\nstep = 0.1\nduration = 1\ngain = 50\n')
    with pytest.raises(SceneError, match="gain = 50") as caught:
        record(scene)
    assert (caught.value.key, caught.value.file) == ("track", scene.file)


def test_an_uneven_gain_is_judged_by_the_longest_step(load_text: LoadText) -> None:
    # Samples 0.25 s, 0.75 s and 1 s apart: 2/1 s bounds Heun's gain, not 2/0.25 s.
    scene = load_text(f'{HEAD}{SAMPLED}[track]\nlaw = "paper"\ngain = 2.5\n')
    with pytest.raises(SceneError, match="stay below 2"):
        record(scene)


def test_a_planar_body_that_leaves_its_plane(load_text: LoadText) -> None:
    scene = load_text("""
    version = 1
    [bodies.a]
    shape = "planar_loop"
    curves = [{kind = "ellipse", centre = [0, 0], semi_axes = [2, 1]}]
    [bodies.b]
    shape = "point"
    [motions.b]
    kind = "twist"
    linear = [0, 0, 1]
    [placements.b]
    position = [5, 0]
    [pair]
    a = "a"
    b = "b"
    [track]
    step = 0.1
    duration = 1
    """)
    assert query(scene)[1].distance == pytest.approx(3.0, rel=1e-14)
    with pytest.raises(SceneError, match="z = 0") as caught:
        record(scene)
    assert caught.value.key == "pair"


def test_bodies_that_are_no_pair(load_text: LoadText) -> None:
    scene = load_text(
        HEAD.replace(
            'shape = "box"\nsize = [1.0, 1.0, 1.0]',
            """shape = "planar_loop"
    curves = [{kind = "ellipse", centre = [0, 0], semi_axes = [2, 1]}]""",
        )
    )
    with pytest.raises(SceneError, match="planar") as caught:
        query(scene)
    assert caught.value.key == "pair"
