"""For all tests of servos."""

from __future__ import annotations

import pytest


@pytest.fixture(autouse=True)
def patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine that others use holds up a loop without a priority now and then."""
    monkeypatch.setattr("standoff.servo.loop.LONGEST_GAP", 2.0)
