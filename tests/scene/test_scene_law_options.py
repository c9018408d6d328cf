"""Feedbacks and variants of the paper's law in scenes: read, refused, recorded, overridden."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import standoff as so
from standoff.motion import ConstantTwist
from standoff.scene import Scene, SceneError, TrackSettings, record
from standoff.tracking.feedback_facts import KINDS, feedback_facts, feedback_text

LoadText = Callable[[str], Scene]

BODIES = """version = 1
[bodies.tool]
shape = "ellipsoid"
semi_axes = [0.3, 0.1, 0.1]
[bodies.part]
shape = "lens"
radius = 1.0
offset = 0.45
[placements.tool]
position = [-1.0, 0.2, 1.2]
[motions.tool]
kind = "twist"
linear = [1.0, 0.0, 0.0]
angular = [0.0, 0.5, 1.0]
"""
PAIR = '[pair]\na = "tool"\nb = "part"\n'
TRACK = '[track]\nlaw = "paper"\nstep = 0.02\nduration = 2.0\n'
OWN = '[[pairs]]\na = "tool"\nb = "part"\n'
PI = 'feedback = { kind = "pi", gain = 20.0, integral = 50.0 }\n'
ROWS = [[30.0, 1.0, 0.0, 0.0], [0.0, 30.0, 0.0, 0.0], [0.0, 0.0, 20.0, 0.0], [0.0, 0.0, 0.0, 20.0]]

FEEDBACKS = [
    ('kind = "linear", gain = 30', so.feedback.Linear(30.0), "linear (gain 30)"),
    (
        'kind = "matrix", gains = [30, 30, 20, 20]',
        so.feedback.GainMatrix([30.0, 30.0, 20.0, 20.0]),
        "matrix (gains [[30, 0, 0, 0], [0, 30, 0, 0], [0, 0, 20, 0], [0, 0, 0, 20]])",
    ),
    (
        f'kind = "matrix", gains = {ROWS}',
        so.feedback.GainMatrix(ROWS),
        "matrix (gains [[30, 1, 0, 0], [0, 30, 0, 0], [0, 0, 20, 0], [0, 0, 0, 20]])",
    ),
    (
        'kind = "pi", gain = 20.0, integral = 50.0',
        so.feedback.PI(20.0, 50.0),
        "pi (gain 20, integral 50)",
    ),
    (
        'kind = "finite-time", gain = 5.0, power = 0.5, reference = 0.01',
        so.feedback.FiniteTime(5.0, 0.5, 0.01),
        "finite-time (gain 5, power 0.5, reference 0.01)",
    ),
    (
        'kind = "finite-time", gain = 5.0, power = 0.5, reference = 0.01, most = 40',
        so.feedback.FiniteTime(5.0, 0.5, 0.01, 40.0),
        "finite-time (gain 5, power 0.5, reference 0.01, most 40)",
    ),
    ('kind = "motion", error = 1e-3', so.feedback.MotionGain(1e-3), "motion (error 0.001)"),
    (
        'kind = "motion", error = 1e-3, least = 2, most = 60',
        so.feedback.MotionGain(1e-3, 2.0, 60.0),
        "motion (error 0.001, least 2, most 60)",
    ),
]
OPTIONS: list[tuple[str, dict[str, Any]]] = [
    (PI, {"feedback": so.feedback.PI(20.0, 50.0)}),
    ('realisation = "integrated"\n', {"realisation": "integrated"}),
    ('switching = "voronoi"\n', {"switching": "voronoi"}),
    (
        'switching = "voronoi"\nsaturation = "hold"\n',
        {"switching": "voronoi", "saturation": "hold"},
    ),
    ('switching = "none"\nsaturation = "zero"\n', {"switching": "none", "saturation": "zero"}),
    ('solve = "plain"\n', {"solve": "plain"}),
]


@pytest.mark.parametrize(("text", "feedback", "words"), FEEDBACKS)
def test_each_feedback(
    load_text: LoadText, text: str, feedback: so.feedback.Feedback, words: str
) -> None:
    scene = load_text(f"{BODIES}{PAIR}{TRACK}feedback = {{ {text} }}\n")
    assert scene.settings.law.feedback == feedback
    assert type(scene.settings.law.feedback) is type(feedback)
    assert feedback_text(feedback_facts(feedback)) == words
    # What a recording keeps of it is again a table of a scene.
    kept = json.loads(json.dumps(feedback_facts(feedback)))
    assert TrackSettings(so.PaperLaw()).overridden({"feedback": kept}).law.feedback == feedback
    recording = record(scene)
    dt = recording.info.options["dt"]
    assert recording.info.law == so.PaperLaw(feedback=feedback).resolved(dt)


def test_every_feedback_of_the_library_has_a_kind() -> None:
    assert set(KINDS.values()) == {type(f) for _, f, _ in FEEDBACKS}


def test_a_table_of_its_own(load_text: LoadText) -> None:
    text = f'{TRACK}[track.feedback]\nkind = "pi"\ngain = 20\nintegral = 50\n'
    assert load_text(BODIES + PAIR + text).settings.law.feedback == so.feedback.PI(20.0, 50.0)


@pytest.mark.parametrize(("text", "options"), OPTIONS)
def test_the_tracker_gets_what_the_scene_says(
    load_text: LoadText, text: str, options: dict[str, Any]
) -> None:
    gain = "" if "feedback" in options else "gain = 20.0\n"
    recording = record(load_text(BODIES + PAIR + TRACK + gain + text))
    usual = record(load_text(f"{BODIES}{PAIR}{TRACK}gain = 20.0\n"))
    path = ConstantTwist(
        so.Pose(np.eye(3), (-1.0, 0.2, 1.2)), so.Twist((1.0, 0.0, 0.0), (0.0, 0.5, 1.0))
    )
    direct = so.track(
        so.Tracker(
            so.shapes.ellipsoid(0.3, 0.1, 0.1),
            so.shapes.lens(1.0, 0.45),
            0.02,
            law=so.PaperLaw(gain=20.0 if gain else None, **options),
        ),
        path,
        so.Pose.identity(),
        2.0,
    )
    np.testing.assert_array_equal(recording.distance, direct.distance)
    told = dict(recording.info.options) | {"dt": direct.info.options["dt"]}
    assert told == direct.info.options
    assert told != dict(usual.info.options) | {"dt": told["dt"]}


def test_a_pair_s_own_options(load_text: LoadText) -> None:
    second_own = f'{OWN}name = "second"\nrealisation = "integrated"\n'
    scene = load_text(f'{BODIES}{OWN}gain = 30\n{second_own}{TRACK}{PI}solve = "plain"\n')
    first, second = (pair.settings for pair in scene.pairs)
    times = {"step": 0.02, "duration": 2.0}
    # in place of the common feedback
    assert first == TrackSettings(so.PaperLaw(gain=30.0, solve="plain"), **times)
    pi = so.feedback.PI(20.0, 50.0)
    law = so.PaperLaw(feedback=pi, solve="plain", realisation="integrated")
    assert second == TrackSettings(law, **times)
    scene = load_text(f"{BODIES}{OWN}{PI}{TRACK}gain = 30\n")
    assert scene.settings.law == so.PaperLaw(feedback=pi)


def test_options_of_the_paper_s_law_under_another_common_law(load_text: LoadText) -> None:
    common = '[track]\nswitching = "voronoi"\nduration = 1\n'
    law = load_text(f'{BODIES}{OWN}law = "paper"\n{common}').settings.law
    assert law == so.PaperLaw(switching="voronoi")


def test_a_pair_s_own_law_takes_what_it_has_of_the_common_one(load_text: LoadText) -> None:
    own = f'{OWN}law = "predictor-corrector"\npredictor = "secant"\n'
    text = f"{BODIES}{own}{TRACK}{PI}tolerance = 1e-8\ndeadline = 40\n"
    law = so.PredictorCorrector(predictor="secant", tolerance=1e-8, deadline=40)
    assert load_text(text).settings == TrackSettings(law, step=0.02, duration=2.0)


def test_an_infinite_tolerance_and_no_feedforward(load_text: LoadText) -> None:
    law = load_text(BODIES + tracked("tolerance = inf\nfeedforward = false\n")).settings.law
    assert law == so.PaperLaw(tolerance=np.inf, feedforward=False)


def tracked(text: str) -> str:
    return PAIR + TRACK + text


def fed(text: str) -> str:
    return tracked(f"feedback = {{ {text} }}\n")


def predicted(text: str) -> str:
    return tracked(text).replace('"paper"', '"predictor-corrector"')


REFUSED = [
    (tracked('realisation = "integratd"'), "track.realisation", ["mean 'integrated'?"]),
    (tracked('saturation = "cero"'), "track.saturation", ["did you mean 'zero'?"]),
    (tracked('switching = "voronoy"'), "track.switching", ["did you mean 'voronoi'?"]),
    (tracked("solve = 1"), "track.solve", ["string in quotes", "got 1"]),
    (tracked('switchin = "none"'), "track.switchin", ["did you mean 'switching'?"]),
    (tracked('feedback = "pi"'), "track.feedback", ["[track.feedback]", "got 'pi'"]),
    (fed("gain = 1"), "track.feedback", ["'kind' is missing", 'kind = "linear"']),
    (fed('kind = "pid", gain = 1'), "track.feedback.kind", ["'pid'", "did you mean 'pi'?"]),
    (fed('kind = "pi", gain = 1'), "track.feedback", ["'integral' is missing", "integral = 1.0"]),
    (
        fed('kind = "pi", gain = 1, integal = 1'),
        "track.feedback.integal",
        ["did you mean 'integral'?"],
    ),
    (
        fed('kind = "linear", gain = 1, integral = 1'),
        "track.feedback.integral",
        ["unknown key 'integral'"],
    ),
    (
        fed('kind = "pi", gain = 0, integral = 1'),
        "track.feedback.gain",
        ["above zero", "got 0"],
    ),
    (fed('kind = "motion", error = "1"'), "track.feedback.error", ["must be a number", "'1'"]),
    (
        fed('kind = "finite-time", gain = 1, power = 1.5, reference = 1'),
        "track.feedback.power",
        ["power = 1.5", "below 1"],
    ),
    (
        fed('kind = "finite-time", gain = 5, power = 0.5, reference = 1, most = 2'),
        "track.feedback",
        ["most = 2", "less than gain = 5"],
    ),
    (
        fed('kind = "matrix", gains = [1, 2]'),
        "track.feedback.gains",
        ["4 numbers", "got [1, 2]"],
    ),
    (
        fed('kind = "matrix", gains = [[1, 0, 0, 0], [0, 1, 0, 0]]'),
        "track.feedback.gains",
        ["4×4", "got 2 rows"],
    ),
    (fed('kind = "matrix", gains = [1, 1, 1, -1]'), "track.feedback.gains", ["do not decay"]),
    (tracked(f"gain = 1\n{PI}"), "track", ["'gain' and 'feedback'", "keep one"]),
    (
        tracked('saturation = "zero"'),
        "track.saturation",
        ["saturation='zero'", "take switching='voronoi' or 'none'"],
    ),
    (
        tracked('switching = "none"\nsaturation = "hold"'),
        "track.saturation",
        ["saturation='hold'", "take saturation='zero'"],
    ),
    (
        predicted(PI),
        "track.feedback",
        ["is an option of the law 'paper', and law is 'predictor-corrector'", "take law = 'paper'"],
    ),
    (
        predicted('realisation = "evaluated"'),
        "track.realisation",
        ["option of the law 'paper'", "leave it out"],
    ),
    (predicted('switching = "voronoi"'), "track.switching", ["option of the law 'paper'"]),
    (predicted('solve = "plain"'), "track.solve", ["take law = 'paper'"]),
    (predicted("gain = 30"), "track.gain", ["option of the law 'paper'"]),
    (tracked('predictor = "secant"'), "track.predictor", ["leave it out"]),
    (tracked("feedforward = 0"), "track.feedforward", ["must be true or false, got 0"]),
    (tracked("tolerance = -inf"), "track.tolerance", ["must be a finite number"]),
    (tracked("deadline = 0"), "track.deadline", ["whole number above zero"]),
    (
        f'{OWN}law = "predictor-corrector"\nsolve = "plain"\n{TRACK}',
        "pairs[0].solve",
        ["option of the law 'paper'"],
    ),
    (
        f'{OWN}saturation = "zero"\n{TRACK}',
        "pairs[0].saturation",
        ["take switching='voronoi' or 'none'"],
    ),
    (
        f'{OWN}law = "predictor-corrector"\n{OWN}name = "2"\nsolve = "plain"\n[track]\nstep = 1\n',
        "pairs[1].solve",
        ["of the law 'paper'"],
    ),
    (
        f'{OWN}switching = "multipliers"\n{TRACK}switching = "none"\nsaturation = "zero"\n',
        "pairs[0].switching",
        ["saturation='zero'"],
    ),
]


@pytest.mark.parametrize(("text", "key", "pieces"), REFUSED)
def test_refused(load_text: LoadText, text: str, key: str, pieces: list[str]) -> None:
    with pytest.raises(SceneError) as caught:
        load_text(BODIES + text)
    assert caught.value.key == key
    assert caught.value.file is not None
    for piece in pieces:
        assert piece in caught.value.problem


@pytest.mark.parametrize(
    ("text", "piece"),
    [
        ('kind = "pi", gain = 1e3, integral = 1.0', r"feedback = PI\(gain=1000.0.*not stable"),
        ('kind = "linear", gain = 1e3', r"gain = 1000.* not stable for heun.* below 100"),
        ('kind = "motion", error = 1, least = 9, most = 3', "least gain 9 is above its greatest 3"),
    ],
)
def test_an_unstable_feedback_is_refused_before_the_run(
    load_text: LoadText, text: str, piece: str
) -> None:
    with pytest.raises(SceneError, match=piece) as caught:
        record(load_text(BODIES + fed(text)))
    assert caught.value.key == "track"


def test_overridden(load_text: LoadText) -> None:
    settings = load_text(BODIES + tracked(f'{PI}switching = "voronoi"\n')).settings
    assert settings.overridden({}) == settings
    changed = settings.overridden({"switching": "none", "solve": "plain", "saturation": None})
    pi = settings.law.feedback
    assert changed.law == so.PaperLaw(feedback=pi, switching="none", solve="plain")
    assert changed.overridden({"gain": 9.0}).law.feedback is None
    again = changed.overridden({"gain": 9.0}).overridden(
        {"feedback": {"kind": "linear", "gain": 8}}
    )
    assert (again.law.gain, again.law.feedback) == (None, so.feedback.Linear(8.0))
    # another law takes what it has too
    other = changed.overridden({"deadline": 40}).overridden({"law": "predictor-corrector"})
    assert other.law == so.PredictorCorrector(deadline=40)


@pytest.mark.parametrize(
    ("given", "key", "piece"),
    [
        ({"solve": "plane"}, "solve", "did you mean 'plain'?"),
        ({"switching": "multipliers", "saturation": "zero"}, "saturation", "saturation='zero'"),
        ({"saturation": "hold", "switching": "none"}, "saturation", "take saturation='zero'"),
        ({"predictor": "none"}, "predictor", "leave it out"),
        ({"law": "predictor-corrector", "gain": 1.0}, "gain", "is an option of the law 'paper'"),
        ({"feedback": {"kind": "linear"}}, "feedback", "'gain' is missing"),
    ],
)
def test_what_does_not_go_with_the_scene(
    load_text: LoadText, given: dict[str, object], key: str, piece: str
) -> None:
    settings = load_text(BODIES + tracked(f'{PI}switching = "voronoi"\n')).settings
    with pytest.raises(SceneError) as caught:
        settings.overridden(given)
    assert (caught.value.key, caught.value.file) == (key, None)
    assert piece in caught.value.problem


def test_a_recording_keeps_the_scene_and_its_options(load_text: LoadText, tmp_path: Path) -> None:
    scene = load_text(BODIES + tracked(f'{PI}switching = "none"\nrealisation = "integrated"\n'))
    recording = record(scene, scene.settings.overridden({"solve": "plain", "step": 0.1}))
    recording.save(tmp_path / "run.parquet")
    info = so.open_recording(tmp_path / "run.parquet").info
    assert info.source == recording.info.source
    assert load_text(info.source["scene_text"]).settings == scene.settings
    used = info.source["settings"]
    assert used["feedback"] == {"kind": "pi", "gain": 20.0, "integral": 50.0}
    assert (used["solve"], used["switching"], used["saturation"]) == ("plain", "none", None)
    assert info.options["saturation"] == "zero"
    assert TrackSettings().overridden(used) == scene.settings.overridden(
        {"solve": "plain", "step": 0.1}
    )
