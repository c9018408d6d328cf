"""The words of a law follow the record of what ran; so does the claim that nothing helped it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

import standoff as so
from standoff.points import PointTracker
from standoff_studies.paper import law_words as words
from standoff_studies.paper.bodies import planar_body
from standoff_studies.paper.law_words import law_words
from standoff_studies.paper.unaided import Part, unaided
from standoff_studies.paper.verdicts import Verdict

PRINTED = so.PaperLaw.as_printed(gain=25.0)
BALL, POINT = so.shapes.sphere(1.0), so.shapes.point()


def tracker(**options: Any) -> so.Tracker:
    return so.Tracker(BALL, POINT, 1e-3, law=replace(PRINTED, **options))


def test_the_printed_law() -> None:
    assert law_words(tracker(), told="wrong start") == (
        "so.PaperLaw.as_printed: Heun, K = 25/s, 1 ms, M as it is, Voronoi tests; wrong start"
    )


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"solve": "ranked"}, "M by the rank rule"),
        ({"solve": "covariant"}, "M covariant"),
        ({"far_side": "left"}, "faces left on the far side"),
        ({"gain": 12.5}, "K = 12.5/s"),
        ({"feedforward": False}, "no feedforward"),
        ({"reset": "foot"}, "resets to the foot point"),
        ({"restarts": True}, ", restarts"),
        ({"realisation": "integrated"}, "Ψ integrated"),
        ({"integrator": "rk4"}, "RK4"),
        ({"switching": "none", "reset": "foot"}, "no switching"),
        ({"saturation": "hold"}, "edges held"),
        ({"tolerance": 1e-3}, "tolerance=0.001"),
    ],
)
def test_a_replaced_option_is_told(options: dict[str, Any], told: str) -> None:
    found = law_words(tracker(**options))
    assert told in found
    assert told not in law_words(tracker())
    still = not options.keys() - {"gain", "integrator", "far_side"}
    assert ("as_printed" in found) is still


def test_a_value_without_words_is_told_by_its_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(words.WORDS, "solve", {"ranked": "M by the rank rule"})
    assert "solve='plain'" in law_words(tracker())


def test_a_recording_has_the_words_of_its_tracker() -> None:
    ran = tracker(solve="ranked", reset="foot")
    assert law_words(so.track(ran, *paths(), 0.01)) == law_words(ran)


def test_what_differs_is_left_to_the_statement() -> None:
    found = law_words(tracker(), tracker(gain=50.0))
    assert found == law_words(tracker()).replace("K = 25/s", "K = 25 or 50/s")
    many = law_words(*(tracker(gain=gain) for gain in (10.0, 20.0, 30.0, 40.0)))
    assert many == law_words(tracker()).replace("K = 25/s", "K as named")
    both = law_words(tracker(), tracker(solve="ranked"))
    assert "solve as named" in both
    assert "as_printed" not in both


def test_the_library_s_own_law() -> None:
    own = "the library's own law, so.PredictorCorrector, 1 ms"
    assert law_words(so.Tracker(BALL, POINT)) == own
    assert law_words(PointTracker(planar_body(), 1e-3)) == own
    other = so.PredictorCorrector(predictor="none")
    assert law_words(so.Tracker(BALL, POINT, law=other)) == f"{own}, predictor='none'"


def paths() -> tuple[Any, Any]:
    """The ball at rest, and a point that goes past it."""
    start = so.Pose.exp((0.0, 0.0, 0.0), (0.5, 0.0, 2.0))
    return so.Pose.identity(), so.motion.ConstantTwist(start, so.Twist((1.0, 0, 0), (0, 0, 0)))


def part(law: so.PaperLaw | so.PredictorCorrector = PRINTED, **counts: int) -> Part:
    found = Part.of(so.track(so.Tracker(BALL, POINT, 1e-3, law=law), *paths(), 0.01))
    return found._replace(counts=found.counts._replace(**counts))


@pytest.mark.parametrize("name", ["restarts", "searches", "solved_parameters", "regularised"])
def test_whatever_is_counted_fails_the_claim(name: str) -> None:
    assert Verdict.of(unaided([part()], "-")) is Verdict.HOLDS
    assert Verdict.of(unaided([part(), part(**{name: 1})], "-")) is Verdict.FAILS


@pytest.mark.parametrize(
    "law",
    [
        replace(PRINTED, solve="ranked"),
        replace(PRINTED, solve="covariant"),
        replace(PRINTED, reset="foot"),
        replace(PRINTED, restarts=True),
        so.PredictorCorrector(),
    ],
    ids=str,
)
def test_a_law_that_may_be_helped_fails_the_claim(law: so.PaperLaw | so.PredictorCorrector) -> None:
    """Also where it never came to that: the record is enough."""
    found = unaided([part(law)._replace(counts=part().counts)], "-")
    assert Verdict.of(found) is Verdict.FAILS
    assert "the law on record has" in found.measured
    alone = replace(PRINTED, switching="none", reset="foot")
    assert Verdict.of(unaided([part(alone)], "-")) is Verdict.HOLDS
