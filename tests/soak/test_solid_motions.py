"""The soaks of long and of leaping motions: what they count, and that a planted fault is seen."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from standoff.solids import SolidFrameBuffer, SolidTracker
from standoff_studies.soak import solid_leaps
from standoff_studies.soak.solid_leaps import judged_leaps
from standoff_studies.soak.solid_motions import judged_motion

PAIR = [("bolt", "plate")]


@pytest.fixture(autouse=True)
def few_frames(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(solid_leaps, "BLOCK", 30)


def raised(monkeypatch: pytest.MonkeyPatch, name: str, told: Any) -> None:
    """Let a tracker claim more than is true."""
    own = getattr(SolidTracker, name)

    def wrong(*given: Any) -> Any:
        state, answers = own(*given)
        return state, told(answers)

    monkeypatch.setattr(SolidTracker, name, wrong)


def beyond(answer: Any) -> Any:
    return replace(answer, lower_bound=answer.upper_bound + 1e-6)


@pytest.mark.parametrize("deadline", [None, 40])
def test_a_long_motion_is_judged(deadline: int | None) -> None:
    verdict, lines = judged_motion(0, 3, PAIR, 300, deadline)
    assert lines == []
    assert verdict.sound
    assert verdict.frames == 300
    assert ("DEADLINE" in verdict.statuses) == (deadline is not None)
    assert verdict.minima > 0


@pytest.mark.parametrize("deadline", [None, 40])
def test_leaps_are_judged_and_repeated(deadline: int | None) -> None:
    verdict, lines = judged_leaps(0, 2, PAIR, deadline)
    assert lines == []
    assert verdict.sound
    assert verdict.frames == 30
    assert verdict.sampled > 10
    assert verdict.leaps > 5
    assert verdict.statuses["OVERLAPPING"] > 0
    assert ("DEADLINE" in verdict.statuses) == (deadline is not None)
    again = judged_leaps(0, 2, PAIR, deadline)[0]
    assert replace(again, seconds=0.0) == replace(verdict, seconds=0.0)


def test_an_interval_under_a_budget_must_be_true(monkeypatch: pytest.MonkeyPatch) -> None:
    raised(monkeypatch, "step", beyond)
    verdict, lines = judged_leaps(0, 2, PAIR, 40)
    assert verdict.wrong > 0
    assert not verdict.sound
    assert "seed 2, block 0, bolt" in lines[0]


def test_a_frame_in_place_that_differs_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    own = SolidFrameBuffer.step

    def off(buffer: SolidFrameBuffer) -> float:
        distance = own(buffer)
        buffer.distance += 1e-15
        return distance

    monkeypatch.setattr(SolidFrameBuffer, "step", off)
    verdict, _ = judged_leaps(0, 2, PAIR)
    assert verdict.otherwise > 0
    assert not verdict.sound
