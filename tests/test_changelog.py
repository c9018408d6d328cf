"""What the changelog says of versions, and what it tells users to change: it works as told."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

import standoff as so
from standoff.motion import Helix

ROOT = Path(__file__).parents[1]
TEXT = (ROOT / "CHANGELOG.md").read_text("utf-8")
NEWEST = "version 0.2", "version 0.3"


def rows(old: str, new: str) -> list[list[str]]:
    """The rows [line of `old`, line of `new`] of the tables that are headed so."""
    heading = re.escape(f"| {old} | {new} |\n|---|---|\n")
    tables = re.findall(rf"^{heading}((?:\|.*\n)+)", TEXT, re.MULTILINE)
    lines = "".join(tables).splitlines()
    return [re.findall(r"^\| `(.*)` \| `(.*)` \|$", line)[0] for line in lines]


def test_the_version_is_the_one_that_the_changelog_begins_with() -> None:
    (version, date), *_ = re.findall(r"^## \[([\d.]+)\] - ([\d-]+)$", TEXT, re.MULTILINE)
    cited = (ROOT / "CITATION.cff").read_text("utf-8")
    assert so.__version__ == version
    assert f"\nversion: {version}\n" in cited
    assert f"\ndate-released: {date}\n" in cited


@pytest.fixture(scope="module")
def names() -> dict[str, Any]:
    """What the lines take for granted."""
    a, b, dt = so.shapes.lens(1.0, 0.45), so.shapes.ellipsoid(0.15, 0.30, 0.20), 1e-2
    return {
        "so": so,
        "a": a,
        "b": b,
        "dt": dt,
        "path_a": so.Pose.identity(),
        "path_b": Helix(radius=1.2, pitch=0.4, rate=2.0),
        "tracker": so.Tracker(a, b, dt),
    }


def test_the_table_is_read() -> None:
    assert len(rows(*NEWEST)) >= 2


@pytest.mark.parametrize(("old", "new"), rows(*NEWEST))
def test_what_no_longer_works_does_as_told(old: str, new: str, names: dict[str, Any]) -> None:
    with pytest.raises((AttributeError, ImportError, TypeError)):
        exec(old, dict(names))
    exec(new, dict(names))
