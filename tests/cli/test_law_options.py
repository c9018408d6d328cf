"""`standoff track` with feedbacks and variants of the paper's law."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import standoff as so
from standoff.scene import load_scene, record

Standoff = Callable[..., Any]

PI = 'feedback = { kind = "pi", gain = 20.0, integral = 50.0 }\n'


@pytest.fixture
def fed(passing: Path) -> Path:
    """The tool past the box by the paper's law with PI feedback."""
    passing.write_text(f'{passing.read_text()}law = "paper"\n{PI}')
    return passing


def law(out: str) -> str:
    (line,) = (line for line in out.splitlines() if line.startswith("law "))
    return line[14:]


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ([], "paper, integrator heun, feedback pi (gain 20, integral 50)"),
        (["--gain", "30"], "paper, integrator heun, gain 30 1/s"),
        (
            ["--realisation", "integrated", "--feedforward", "false"],
            "paper, integrator heun, feedback pi (gain 20, integral 50), feedforward false, "
            "realisation integrated",
        ),
        (
            ["--switching", "voronoi", "--gain", "30"],
            "paper, integrator heun, gain 30 1/s, saturation zero, switching voronoi",
        ),
        (
            ["--switching", "voronoi", "--saturation", "hold", "--gain", "30"],
            "paper, integrator heun, gain 30 1/s, switching voronoi",
        ),
        (
            ["--solve", "plain", "--switching", "multipliers", "--gain", "30"],
            "paper, integrator heun, gain 30 1/s, solve plain",
        ),
    ],
)
def test_the_summary_names_what_is_not_the_default(
    standoff: Standoff, fed: Path, options: list[str], told: str
) -> None:
    ended = standoff("track", fed, *options)
    assert (ended.code, ended.err) == (3, "")  # the law lags behind a corner by more than 1e-10
    assert law(ended.out) == told


def test_another_law_leaves_what_it_has_not(standoff: Standoff, fed: Path) -> None:
    ended = standoff("track", fed, "--law", "predictor-corrector", "--deadline", 30)
    assert law(ended.out) == "predictor-corrector, deadline 30, predictor feedforward-2"


def test_a_feedback_in_a_line(standoff: Standoff, fed: Path) -> None:
    ended = standoff("track", fed, "--feedback", '{ kind = "motion", error = 1e-3 }')
    assert law(ended.out).startswith("paper, integrator heun, feedback motion (error 0.001")


def test_options_reach_the_run_and_its_files(standoff: Standoff, fed: Path) -> None:
    target = fed.with_name("run.parquet")
    options = {"realisation": "integrated", "switching": "none", "solve": "plain"}
    words = [word for name, value in options.items() for word in (f"--{name}", value)]
    facts = json.loads(standoff("track", fed, *words, "--json", "-o", target).out)
    scene = load_scene(fed)
    direct = record(scene, scene.settings.overridden(options))
    kept = so.open_recording(target)
    np.testing.assert_array_equal(kept.distance, direct.distance)
    assert not np.array_equal(kept.distance, record(scene).distance)
    feedback = {"kind": "pi", "gain": 20.0, "integral": 50.0}
    wanted = options | {"law": "paper", "saturation": None, "feedback": feedback, "gain": None}
    assert {name: facts["settings"][name] for name in wanted} == wanted
    assert kept.info.source["settings"] == facts["settings"]
    assert kept.info.source["scene_text"] == fed.read_text()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--realisation", "x"], "--realisation: unknown realisation 'x'; known here: "),
        (["--saturation", "cero"], "--saturation: unknown saturation 'cero'; did you mean 'zero'?"),
        (["--switching", "non"], "--switching: unknown switching 'non'; did you mean 'none'?"),
        (["--solve", "plane"], "--solve: unknown solve 'plane'; did you mean 'plain'?"),
        (["--saturation", "zero"], "--saturation: saturation='zero' keeps a witness point"),
        (
            ["--switching", "none", "--saturation", "hold"],
            "--saturation: saturation='hold' enters the edge it meets",
        ),
        (
            ["--law", "predictor-corrector", "--solve", "plain"],
            "--solve: is an option of the law 'paper', and law is 'predictor-corrector': leave it "
            "out, or take law = 'paper'",
        ),
        (["--feedback", '{ kind = "pi" }'], "--feedback: 'gain' is missing"),
        (["--integrator", "euler", "--step", "0.2"], "feedback = PI(gain=20.0, integral=50.0) is"),
    ],
)
def test_refused_before_anything_is_written(
    standoff: Standoff, fed: Path, options: list[str], message: str
) -> None:
    ended = standoff("track", fed, *options, "-o", fed.with_name("run.parquet"))
    assert (ended.code, ended.out) == (2, "")
    assert ended.err.count("\n") == 1
    assert message in ended.err
    assert [path.name for path in fed.parent.iterdir()] == ["passing.toml"]


def test_a_scene_with_options_of_another_law(standoff: Standoff, passing: Path) -> None:
    passing.write_text(passing.read_text() + PI)
    for command in ("track", "distance"):
        ended = standoff(command, passing)
        assert (ended.code, ended.out) == (2, "")
        assert ended.err.startswith(f"standoff: {passing}: track.feedback: is an option of the")


def test_the_automaton_of_a_scene_with_options(standoff: Standoff, fed: Path) -> None:
    fed.write_text(f'{fed.read_text()}switching = "voronoi"\nrealisation = "integrated"\n')
    recording = record(load_scene(fed))
    ended = standoff("automaton", fed, "--visited")
    assert f"visited from 0 s to 2 s: {len({v[:2] for v in recording.modes()})} of 26" in ended.out
