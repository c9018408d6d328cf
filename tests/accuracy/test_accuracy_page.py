"""The committed tables are those that the command would print now, but for their digits."""

import re
from pathlib import Path

from standoff.accuracy.cases import pairs
from standoff.accuracy.peers.all_peers import all_peers
from standoff.accuracy.report import ENGINE_HEADER, PAIR_HEADER
from standoff.accuracy.solids import KINDS

PAGE = Path(__file__).parents[2] / "docs" / "accuracy-report" / "accuracy.md"


def rows(heading: str) -> list[list[str]]:
    """The cells of the table below a heading, its own header first."""
    section = PAGE.read_text("utf-8").split(f"## {heading}\n")[1].split("\n## ")[0]
    lines = re.findall(r"^\| (.*) \|$", section, re.MULTILINE)
    return [line.split(" | ") for line in lines if not line.startswith("---")]


def test_pairs_are_those_of_the_catalogue() -> None:
    header, *lines = rows("By pair")
    assert header == list(PAIR_HEADER)
    names = [f"{first.name} – {second.name}" for first, second in pairs(KINDS)]
    assert [line[0] for line in lines] == names


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
