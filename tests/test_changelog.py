"""What the changelog says of versions, and what it tells users to change."""

from __future__ import annotations

import re
from pathlib import Path

import standoff as so

ROOT = Path(__file__).parents[1]
TEXT = (ROOT / "CHANGELOG.md").read_text("utf-8")


def test_the_version_is_the_one_that_the_changelog_begins_with() -> None:
    (version, date), *_ = re.findall(r"^## \[([\d.]+)\] - ([\d-]+)$", TEXT, re.MULTILINE)
    cited = (ROOT / "CITATION.cff").read_text("utf-8")
    assert so.__version__ == version
    assert f"\nversion: {version}\n" in cited
    assert f"\ndate-released: {date}\n" in cited
