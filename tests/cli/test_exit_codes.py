"""A command whose answers are not certified ends with the code 3: of each that has answers."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cli.conftest import Standoff
from cli.test_robot_command import ARM
from cli.test_track_world import SCENE
from standoff.clearance.report import Report
from standoff.cli import impact, sweep
from standoff.impact import ImpactStatus
from standoff.robots.answer import RobotAnswer
from standoff.simulation import SystemRun
from standoff.tracking import Proximity

BOUNCE = Path(__file__).parents[2] / "examples" / "simulation" / "bounce.toml"


class Undecided:
    """An impact that is as it is, but for its status."""

    status = ImpactStatus.UNDECIDED

    def __init__(self, found: Any) -> None:
        self.found = found

    def __getattr__(self, name: str) -> Any:
        return getattr(self.found, name)


def undecided(found: Callable[..., Any]) -> Callable[..., Any]:
    return lambda *given: Undecided(found(*given))


def never(kind: Any) -> tuple[Any, str, Any]:
    """Its answers are never certified."""
    return kind, "certified", property(lambda answer: False)


CASES: dict[str, tuple[tuple[object, ...], tuple[Any, str, Any]]] = {
    "distance": (("passing.toml",), never(Proximity)),
    "track": (("world.toml",), never(Report)),
    "impact": (("passing.toml", "--clearance", 0.3), (impact, "_found", undecided(impact._found))),
    "robot": (("arm.xml",), never(RobotAnswer)),
    "sweep": (("job.toml", "--row", 7), (sweep, "PROVEN", np.zeros(64, bool))),
    "simulate": (
        (BOUNCE, "--duration", 0.01),
        (SystemRun, "uncertified", property(lambda run: 1)),
    ),
}
"""By command: what is asked of it, and what is changed for it not to be certified."""


@pytest.mark.parametrize("command", CASES)
def test_what_is_not_certified_ends_with_3(
    standoff: Standoff,
    monkeypatch: pytest.MonkeyPatch,
    passing: Path,
    job: Path,
    command: str,
) -> None:
    folder = passing.parent
    (folder / "world.toml").write_text(SCENE)
    (folder / "arm.xml").write_text(ARM)
    monkeypatch.chdir(folder)
    given, change = CASES[command]
    assert standoff(command, *given).code == 0
    monkeypatch.setattr(*change)
    ended = standoff(command, *given)
    assert ended.code == 3, ended.err
