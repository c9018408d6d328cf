"""The committed tables are those that the command would print now, but for their digits."""

import re
from pathlib import Path

import pytest

from standoff_studies.accuracy.cases import DEPTHS, GAPS, pairs
from standoff_studies.accuracy.measuring import Row
from standoff_studies.accuracy.peers.all_peers import all_peers
from standoff_studies.accuracy.report import ENGINE_HEADER, LEVEL_HEADER, PAIR_HEADER, level_name
from standoff_studies.accuracy.solids import KINDS

DOCS = Path(__file__).parents[2] / "docs"
REPORT = DOCS / "accuracy-report"
PAGE = REPORT / "accuracy.md"


def rows(heading: str, page: Path = PAGE) -> list[list[str]]:
    """The cells of the table below a heading, its own header first."""
    section = page.read_text("utf-8").split(f"## {heading}\n")[1].split("\n## ")[0]
    lines = re.findall(r"^\| (.*) \|$", section, re.MULTILINE)
    return [line.split(" | ") for line in lines if not line.startswith("---")]


def test_pairs_are_those_of_the_catalogue() -> None:
    header, *lines = rows("By pair")
    assert header == list(PAIR_HEADER)
    names = [f"{first.name} – {second.name}" for first, second in pairs(KINDS)]
    assert [line[0] for line in lines] == names


@pytest.mark.parametrize(("name", "levels"), [("gaps", GAPS), ("depths", [-d for d in DEPTHS])])
def test_every_pair_has_median_and_worst_at_each_level(name, levels) -> None:
    page = REPORT / f"{name}.md"
    assert page.read_text("utf-8").count("\n## ") == len(levels)
    wanted = [
        f"{first.name} – {second.name}"
        for first, second in pairs(KINDS)
        if name == "gaps" or not (first.flat and second.flat)
    ]
    for level in levels:
        header, *lines = rows(level_name(level).capitalize(), page)
        assert header == list(LEVEL_HEADER)
        assert [line[0] for line in lines] == wanted
        for line in lines:
            if line[1:4] == ["– / –"] * 3:
                continue  # all cases have another least depth than the constructed one
            both = [[float(x) for x in cell.split(" / ")] for cell in line[1:4]]
            assert all(middle <= worst for middle, worst in both), line


def test_the_columns_of_the_file_are_documented() -> None:
    section = (DOCS / "accuracy.md").read_text("utf-8").split("## The Parquet file\n")[1]
    lines = re.findall(r"^\| (`.*?) \|", section.split("\n## ")[0], re.MULTILINE)
    names = [name for line in lines for name in re.findall(r"`(\w+)`", line)]
    assert names == list(Row.__annotations__)


def test_engines_are_those_of_the_command() -> None:
    header, *lines = rows("By engine")
    assert header == list(ENGINE_HEADER)
    names = list(dict.fromkeys(line[0] for line in lines))
    assert names == ["Standoff", *(peer.name for peer in all_peers())]
    levels = ["gap 1e-6", "gap 1e-3", "gap 1", "depth 1e-6", "depth 1e-3", "depth 1e-1"]
    assert [line[1] for line in lines if line[0] == "Standoff"] == levels


def test_the_command_is_named() -> None:
    first = PAGE.read_text("utf-8").splitlines()[0]
    assert re.match(r"Made by `standoff accuracy --cases \d+ --seed \d+ --peers`: ", first)
