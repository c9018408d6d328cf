"""Solids that tumble stay above what they fall on, however much deeper than it is meant for a
contact is pressed."""

from __future__ import annotations

import pytest

from shares import only
from standoff_studies.soak import falling_solids
from standoff_studies.soak.falling_solids import SCENES, judged_drop

FELL = (0, 20, 29)
"""A cube on the slab, a half ball in the bowl, an L in the corner: each fell when places were
looked for up to eight depths alone."""


@pytest.mark.parametrize("number", only(FELL, range(3 * len(SCENES))))
def test_a_drop_is_held(number: int) -> None:
    verdict, lines = judged_drop(number, 1, 4000 if number in FELL else falling_solids.TICKS)
    assert verdict.sound, lines
    assert (verdict.jumps, verdict.crossings) == (0, 0), lines


def test_the_judge_tells_a_fall(monkeypatch: pytest.MonkeyPatch) -> None:
    """With springs that hold nothing."""
    monkeypatch.setattr(falling_solids, "STIFFNESS", 1.0)
    monkeypatch.setattr(falling_solids, "deepest_of", lambda energy: 5e-3)
    verdict, (line,) = judged_drop(0, 1, 4000)
    assert verdict.fell == 1
    assert "mm deep" in line
