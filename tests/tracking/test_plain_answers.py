"""Answers as plain data, as JSON, and on one line."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest

import standoff as so
from standoff.bodies.plain_data import PlainData, json_text, plain, without_roundoff
from standoff.motion import ConstantTwist

HOME = np.eye(4)
LINE = 100
"""Longest repr, in characters."""


def apart(x: float) -> so.Pose:
    return so.Pose(np.eye(3), [x, 0.1, -0.2])


@pytest.fixture(scope="module")
def answers() -> dict[str, Any]:
    a, b = so.shapes.ellipsoid(0.5, 0.4, 0.3), so.shapes.box(1.0, 1.0, 1.0)
    moving = ConstantTwist(apart(-3.0), so.Twist([1.0, 0.0, 0.0], [0.0, 0.0, 0.0]))
    loop = so.shapes.planar_loop([so.geometry.ConicArc((0, 0), (1, 0), (0, 1))])
    tracker = so.Tracker(a, b)
    poses = np.stack([apart(x).matrix for x in (-3.0, -2.99)])
    return {
        "apart": so.distance(a, b, apart(-2.0), HOME),
        "overlap": so.distance(a, b, apart(0.1), HOME),
        "touching": so.distance(b, b, HOME, so.Pose(np.eye(3), [1.0, 0.0, 0.0])),
        "tracked": tracker.step(tracker.start(apart(-3.0), HOME), apart(-2.9), HOME)[1],
        "many": tracker.run(tracker.start(apart(-3.0), HOME), poses, HOME)[1],
        "impact": so.time_of_impact(a, b, moving, HOME, duration=4.0),
        "no impact": so.time_of_impact(a, b, moving, HOME, duration=0.5),
        "inside": so.PointTracker(loop).start([0.1, 0.2, 0.0]).proximity,
        "in space": so.PointTracker(b).start([0.1, 0.2, 0.0]).proximity,
        "recording": so.track(so.Tracker(a, b), moving, HOME, 0.1),
    }


PLAIN = ("apart", "overlap", "touching", "tracked", "impact", "no impact", "inside", "in space")


def leaves(value: Any) -> list[Any]:
    if isinstance(value, dict):
        assert all(type(key) is str for key in value)
        value = list(value.values())
    if isinstance(value, list):
        return [leaf for item in value for leaf in leaves(item)]
    return [value]


@pytest.mark.parametrize("kind", PLAIN)
def test_an_answer_is_plain_data_to_the_last_bit(answers: dict[str, Any], kind: str) -> None:
    answer = answers[kind]
    assert isinstance(answer, PlainData)
    facts = answer.as_dict()
    allowed = (bool, int, float, str, type(None))
    assert all(type(leaf) in allowed for leaf in leaves(facts))
    for name, value in facts.items():
        own = getattr(answer, name)
        if isinstance(own, float):
            np.testing.assert_equal(value, own)
        elif isinstance(own, np.ndarray):
            np.testing.assert_array_equal(value, own)
    zeros = [x for x in leaves(facts) if type(x) is float and x == 0.0]
    assert all(math.copysign(1.0, zero) == 1.0 for zero in zeros)


@pytest.mark.parametrize("kind", PLAIN)
def test_an_answer_as_json_is_strict_and_comes_back(answers: dict[str, Any], kind: str) -> None:
    def refuse(word: str) -> None:
        raise AssertionError(word)

    facts = answers[kind].as_dict()
    for indent in (None, 2):
        again = json.loads(answers[kind].to_json(indent), parse_constant=refuse)
        finite = [None if type(x) is float and not math.isfinite(x) else x for x in leaves(facts)]
        assert leaves(again) == finite
    assert "\n" not in answers[kind].to_json()


def test_what_an_answer_s_plain_data_says(answers: dict[str, Any]) -> None:
    facts = answers["tracked"].as_dict()
    answer = answers["tracked"]
    assert (facts["feature_a"], facts["status"]) == (str(answer.feature_a), "CONVERGED")
    assert facts["counts"]["evaluations"] == answer.counts.evaluations
    np.testing.assert_array_equal(facts["poses"], [apart(-2.9).matrix, HOME])
    assert math.isnan(facts["rate"])
    assert json.loads(answer.to_json())["rate"] is None
    assert answers["impact"].as_dict()["proximity"] == answers["impact"].proximity.as_dict()
    assert plain({"event": so.Event(-0.0, "A", answer.feature_a, answer.feature_b, 0.5, np.inf)})[
        "event"
    ]["source"] == str(answer.feature_a)
    assert json_text({"x": [math.nan, -math.inf, -0.0]}) == '{"x": [null, null, 0.0]}'


def test_every_answer_fits_a_line_and_shows_no_roundoff(answers: dict[str, Any]) -> None:
    for kind, answer in answers.items():
        text = repr(answer)
        assert len(text) <= LINE, text
        assert text.isprintable(), text
        assert "-0" not in text.replace("-0.", ""), text
        assert kind != "touching" or "distance=0," in text
    assert abs(answers["touching"].distance) < 1e-15


def test_the_longest_line_of_an_answer_fits(answers: dict[str, Any]) -> None:
    longest = "Proximity(distance=-1.23456789012e-123, gap=-1.2e-123, "
    assert len(f"{longest}vertex 1234 - vertex 1234, NOT_CERTIFIED)") <= LINE
    times = "Impact(time=-1.23456789012e-123, latest=-1.23456789012e-123, "
    assert len(f"{times}NO_IMPACT, distance=-1.23457e-123)") <= LINE


def test_roundoff_is_shown_as_zero_and_nothing_else() -> None:
    shown = without_roundoff([1e-17, -0.0, -3e-16, 2e-15, np.nan, np.inf], 1.0)
    np.testing.assert_array_equal(shown, [0.0, 0.0, 0.0, 2e-15, np.nan, np.inf])
    assert not np.signbit(shown[:3]).any()
    assert without_roundoff([1e-17], 1e-9)[0] == 1e-17
