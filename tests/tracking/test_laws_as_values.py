"""Each option of a law, from its one declaration through all that is made of it."""

from __future__ import annotations

import copy
import json
import pickle
import re
from dataclasses import FrozenInstanceError, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import standoff as so
from standoff.cli.arguments import parse
from standoff.cli.track import settings_of
from standoff.errors import StandoffTypeError
from standoff.kernels.pair.events import NO_LIMIT
from standoff.kernels.paper import integrators as I
from standoff.kernels.state import arrays as K
from standoff.motion import ConstantTwist
from standoff.scene import TrackSettings, load_scene
from standoff.scene.files import toml_tables
from standoff.scene.reader import SceneTable
from standoff.scene.settings import read_settings
from standoff.tracking.law_options import Choice, options_of
from standoff.tracking.laws import LAWS, every_option, law_of_facts
from standoff.tracking.options import pack_options

ROOT = Path(__file__).parents[2]
DT = 1e-2
COMMON: dict[str, Any] = {
    "tolerance": 1e-8,
    "depth": "local",
    "deadline": 40,
    "restarts": False,
    "within": 0.5,
}
VARIANT: dict[str, Any] = {
    "integrator": "rk4",
    "feedforward": False,
    "realisation": "integrated",
    "saturation": "zero",
    "switching": "voronoi",
    "solve": "plain",
    "reset": "nearest",
    "far_side": "kept",
    **COMMON,
}
ODD = [
    so.PredictorCorrector(predictor="secant", **COMMON),
    so.PaperLaw(gain=30.0, **VARIANT),
    so.PaperLaw(feedback=so.feedback.PI(20.0, 50.0), **VARIANT),
]
"""Laws with every option off its default: of gain and feedback one."""
BOX, POINT = so.shapes.box(1.0, 1.0, 1.0), so.shapes.point()


def test_no_option_is_forgotten_here() -> None:
    for name, law in LAWS.items():
        odd = {
            option
            for one in ODD
            if one.name == name
            for option, each in options_of(law).items()
            if getattr(one, option) != each.default
        }
        assert odd == set(options_of(law))


@pytest.mark.parametrize("law", ODD, ids=repr)
def test_a_law_is_a_value(law: Any) -> None:
    names = {cls.__name__: cls for cls in LAWS.values()} | {"PI": so.feedback.PI}
    for again in (eval(repr(law), names), pickle.loads(pickle.dumps(law)), copy.deepcopy(law)):
        assert again == law
        assert hash(again) == hash(law)
        assert repr(again) == repr(law)
    for name, each in options_of(law).items():
        if getattr(law, name) != each.default:
            given = {"saturation": None, "reset": "foot"} if name == "switching" else {}
            assert replace(law, **given, **{name: each.default}) != law
    with pytest.raises(FrozenInstanceError):
        law.depth = "global"
    assert law != type(law)()
    assert repr(type(law)()) == f"{type(law).__name__}()"


def test_values_are_kept_as_plain_python() -> None:
    law = so.PaperLaw(gain=np.float32(30), deadline=np.int64(40), feedforward=np.bool_(False))
    assert [type(x) for x in (law.gain, law.deadline, law.feedforward)] == [float, int, bool]


def test_choices_stand_in_the_order_of_the_kernels_numbers() -> None:
    numbers = {
        "predictor": [
            *(K.PREDICT_NONE, K.PREDICT_SECANT, K.PREDICT_FEEDFORWARD, K.PREDICT_FEEDFORWARD_2)
        ],
        "realisation": [K.EVALUATED, K.INTEGRATED],
        "saturation": [K.SATURATE_HOLD, K.SATURATE_ZERO],
        "switching": [K.SWITCH_MULTIPLIERS, K.SWITCH_VORONOI, K.SWITCH_NONE],
        "solve": [K.SOLVE_RANKED, K.SOLVE_PLAIN, K.SOLVE_COVARIANT],
        "reset": [K.RESET_FOOT, K.RESET_NEAREST],
        "far_side": [K.FAR_SIDE_LEFT, K.FAR_SIDE_KEPT],
        "depth": [K.DEPTH_GLOBAL, K.DEPTH_LOCAL],
        "integrator": list(range(len(I.NAMES))),
    }
    kinds = {name: each.kind for name, each in every_option().items()}
    choices = {name: kind.names for name, kind in kinds.items() if isinstance(kind, Choice)}
    assert {n: list(range(len(names))) for n, names in choices.items()} == numbers
    assert choices["integrator"] == I.NAMES
    assert choices["predictor"] == ("none", "secant", "feedforward", "feedforward-2")
    assert choices["switching"] == ("multipliers", "voronoi", "none")


def test_the_kernels_get_each_option() -> None:
    one, two, three = (pack_options(law.resolved(DT)) for law in ODD)
    common = {K.O_TOLERANCE: 1e-8, K.O_DEPTH: K.DEPTH_LOCAL, K.O_DEADLINE: 40, K.O_RESTARTS: 0.0}
    paper = common | {
        K.O_LAW: K.LAW_PAPER,
        K.O_PREDICTOR: K.PREDICT_NONE,
        K.O_INTEGRATOR: I.NAMES.index("rk4"),
        K.O_REALISATION: K.INTEGRATED,
        K.O_SATURATION: K.SATURATE_ZERO,
        K.O_SWITCHING: K.SWITCH_VORONOI,
        K.O_SOLVE: K.SOLVE_PLAIN,
        K.O_RESET: K.RESET_NEAREST,
    }
    for packed, wanted in (
        (one, common | {K.O_LAW: K.LAW_PC, K.O_PREDICTOR: K.PREDICT_SECANT}),
        (two, paper | {K.O_GAIN: 30.0, K.O_FEEDBACK: K.FEEDBACK_LINEAR}),
        (three, paper | {K.O_GAIN: 20.0, K.O_FEEDBACK: K.FEEDBACK_PI, K.O_DATA: 50.0 / 20.0}),
    ):
        assert not packed.flags.writeable
        for slot, value in wanted.items():
            assert packed[slot] == value, slot
    usual = pack_options(so.PaperLaw().resolved(DT))
    assert usual[K.O_GAIN] == 1.0 / DT
    assert usual[K.O_PREDICTOR] != K.PREDICT_NONE
    assert usual[K.O_DEADLINE] == NO_LIMIT
    assert usual[K.O_SATURATION] == K.SATURATE_HOLD


@pytest.mark.parametrize("law", [*ODD, so.PaperLaw(), so.PredictorCorrector()], ids=repr)
def test_an_option_alone_changes_what_the_kernels_get(law: Any) -> None:
    usual = pack_options(type(law)().resolved(DT))
    for name, each in options_of(law).items():
        value = getattr(law, name)
        voronoi = {"switching": "voronoi"} if value in ("zero", "nearest") else {}
        given = {name: value, **voronoi}
        changed = pack_options(type(law)(**given).resolved(DT))
        assert np.array_equal(changed, usual) == (value == each.default), name


@pytest.mark.parametrize("law", ODD, ids=repr)
def test_a_scene_says_each_option(law: Any) -> None:
    def toml(value: Any) -> str:
        if isinstance(value, dict):
            return "{" + ", ".join(f"{k} = {toml(v)}" for k, v in value.items()) + "}"
        return json.dumps(value)

    facts = {name: value for name, value in law.facts().items() if value is not None}
    text = "\n".join(f"{name} = {toml(value)}" for name, value in facts.items())
    assert read_settings(SceneTable(toml_tables(text))).law == law
    assert TrackSettings().overridden(facts).law == law
    assert law_of_facts(json.loads(json.dumps(facts))) == law
    with pytest.raises(ValueError, match="zzz is not an option of the law"):
        law_of_facts(facts | {"zzz": 1})


@pytest.mark.parametrize("law", ODD, ids=repr)
def test_the_command_line_says_each_option(law: Any) -> None:
    words = ["--law", law.name]
    for name, value in law.facts().items():
        if value is None or name == "law":
            continue
        text = '{ kind = "pi", gain = 20.0, integral = 50.0 }' if name == "feedback" else str(value)
        words += [f"--{name}", text.lower() if isinstance(value, bool) else text]
    scene = load_scene(ROOT / "examples" / "demo.toml")
    assert settings_of(scene, parse(["track", "demo.toml", *words])).law == law


def test_the_help_names_each_option(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        parse(["track", "--help"])
    told = re.sub(r"[\s│]+", " ", capsys.readouterr().out)
    for name, each in every_option().items():
        assert f"--{name.replace('_', '-')} " in told
        assert each.help[:40] in told


@pytest.mark.parametrize("law", ODD, ids=repr)
def test_a_recording_keeps_each_option(law: Any, tmp_path: Path) -> None:
    path = ConstantTwist(so.Pose(np.eye(3), (2.0, 0.1, 0.2)), so.Twist((-1.0, 0, 0), (0, 0, 1)))
    tracker = so.Tracker(BOX, so.shapes.sphere(0.3), DT, law)
    assert tracker.law is law
    recording = so.track(tracker, so.Pose.identity(), path, 0.1)
    recording.save(tmp_path / "run.parquet")
    again = so.open_recording(tmp_path / "run.parquet")
    for info in (recording.info, again.info):
        assert info.law == law.resolved(DT)
        assert set(options_of(law)) < set(info.options)
    assert again.info.options == recording.info.options


def test_a_resolved_law_has_what_was_left_open() -> None:
    law = so.PaperLaw().resolved(DT)
    assert law == so.PaperLaw(gain=1.0 / DT, saturation="hold")
    assert so.PaperLaw(switching="none").resolved(DT).saturation == "zero"
    most = so.PaperLaw(feedback=so.feedback.FiniteTime(5.0, 0.5, 0.01)).resolved(DT).feedback.most
    assert most == 1.0 / DT
    assert so.PredictorCorrector().resolved(DT) == so.PredictorCorrector()


@pytest.mark.parametrize("page", ["options.md", "scene-format.md"])
def test_the_pages_name_each_option(page: str) -> None:
    """A row each, with all its values and its default."""
    rows: dict[str, list[str]] = {}
    for line in (ROOT / "docs" / page).read_text(encoding="utf-8").splitlines():
        found = re.match(r"\| `(\w+)` \|", line)
        if found:  # other tables have a `restarts`, or a `tolerance`, too
            rows.setdefault(found[1], []).append(line)
    for name, each in every_option().items():
        words = [f'`"{word}"`' for word in getattr(each.kind, "names", ())]
        default = each.default
        shown = str(default).lower() if isinstance(default, bool) else str(default)
        shown = "" if default is None else shown
        assert any(
            all(word in row for word in words) and shown in row.rsplit("|", 2)[1]
            for row in rows[name]
        ), (name, words, shown)


def test_one_file_beside_the_kernels_knows_their_slots() -> None:
    slot = re.compile(r"(?<!os\.)\bO_[A-Z]+\b")
    files = {
        str(f.relative_to(source))
        for source in (ROOT / "src", ROOT / "studies" / "src")
        for f in source.rglob("*.py")
        if slot.search(f.read_text())
    }
    beside = {name for name in files if not name.startswith("standoff/kernels/")}
    # the C interface hands them on by name, and reads them nowhere
    assert beside == {"standoff/tracking/options.py", "standoff/c_interface/library.py"}


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (
            lambda: so.PaperLaw(gian=3.0),
            r"no option 'gian'\. Did you mean 'gain'\?",
        ),
        (
            lambda: so.PredictorCorrector(gain=3.0),
            r"no option 'gain'\. .*has the options tol",
        ),
        (lambda: so.PaperLaw("heun"), "'heun'.*options are given by name"),
    ],
    ids=["misspelt", "of the other law", "by position"],
)
def test_an_option_that_a_law_does_not_have_is_named(call, words):
    with pytest.raises(StandoffTypeError, match=words) as told:
        call()
    assert told.value.argument in ("gian", "gain", "law")
