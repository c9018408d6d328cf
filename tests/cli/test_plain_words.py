"""What the command line says: help that can be read, counts in words, units, misspelt commands."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import standoff as standoff_package
from draws import draws
from standoff.cli.arguments import OWN
from standoff.wording import at_least, at_most, counted

Standoff = Callable[..., Any]
WIDTH = 100


def test_help_has_one_line_a_command_and_examples(standoff: Standoff) -> None:
    helped = standoff("--help")
    assert helped.code == 0
    for name in (*OWN, "paper", "soak", "accuracy"):
        (found,) = re.findall(rf"^  {name} +(.*)$", helped.out, re.MULTILINE)
        assert found.endswith(".")
    assert max(map(len, helped.out.splitlines())) <= WIDTH
    assert "\nExamples:\n  standoff distance " in helped.out
    assert standoff().out == standoff("-h").out == helped.out


@pytest.mark.parametrize("name", sorted(set(OWN) - {"warmup"}))
def test_help_of_a_command_has_an_example(standoff: Standoff, name: str) -> None:
    assert f"Example: standoff {name} " in standoff(name, "--help").out


def test_options_of_track_are_in_groups(standoff: Standoff) -> None:
    told = standoff("track", "--help").out
    places = [told.index(f" {group} options ") for group in ("file", "report", "time", "law")]
    paper = told.index(" paper law options ")
    assert sorted(places) == places
    assert told.index("--deadline") < paper < told.index("--integrator")


@pytest.mark.parametrize(
    ("given", "meant"), [("trak", "track"), ("distanc", "distance"), ("sok", "soak")]
)
def test_a_misspelt_command_gets_a_suggestion(standoff: Standoff, given: str, meant: str) -> None:
    ended = standoff(given, "x.toml")
    assert (ended.code, ended.out) == (2, "")
    assert ended.err == (
        f"standoff: unknown command '{given}'; did you mean '{meant}'? "
        "standoff --help lists the commands\n"
    )


def test_a_word_like_no_command_gets_none(standoff: Standoff) -> None:
    ended = standoff("zzzz")
    assert ended.err == ("standoff: unknown command 'zzzz'; standoff --help lists the commands\n")


def test_counts_are_told_where_they_are_not_zero(standoff: Standoff, passing: Path) -> None:
    def work(*options: str) -> dict[str, int]:
        told = standoff("distance", passing, *options).out
        (line,) = re.findall(r"^work +(.*)$", told, re.MULTILINE)
        return {name: int(n) for n, name in re.findall(r"(\d+) ([a-z ]+)", line)}

    few, every = work(), work("--verbose")
    assert 0 < len(few) < len(every) == 11
    assert few == {name: n for name, n in every.items() if n}
    assert "regularised solves" in every


def test_one_is_no_plural() -> None:
    told = [counted(n, "query", "queries") for n in (0, 1, 2)]
    assert told == ["0 queries", "1 query", "2 queries"]
    assert counted(1, "frame") == "1 frame"


# A number written before a noun by itself would be "1 parts".
SOURCE = Path(standoff_package.__file__).parent
REPORTS = ("automaton", "cad", "clearance", "cli", "servo", "sweep")
UNCOUNTED = re.compile(r"\{(?:len\([^{}]*\)|_?grouped\([^{}]*\)|[\w.]+)\} (?:more )?([a-z]+)\b")
COUNTED = re.compile(r"""counted\([^"']*["']([a-z ]+)["']""")
NEVER_ONE = {
    ("automaton/branch_text.py", "switch"): "more than can be listed",
    ("automaton/picture.py", "feature"): "shown where not all of several are",
    ("automaton/picture.py", "mode"): "as many as fill a picture",
    ("cad/making.py", "face"): "more than can be read",
    ("clearance/report.py", "pair"): "of a fit that covers several",
    ("cli/summary.py", "event"): "the first eight",
    ("cli/summary.py", "part"): "what a translation does",
    ("sweep/reading.py", "row"): "more than can be swept",
    ("sweep/subject_tables.py", "pair"): "of which one must be named",
}
"""Where such a number is more than one, or the word no noun."""


def test_what_is_counted_in_reports_is_no_plural_of_one() -> None:
    files = [file for part in REPORTS for file in sorted((SOURCE / part).rglob("*.py"))]
    texts = {file.relative_to(SOURCE).as_posix(): file.read_text("utf-8") for file in files}
    nouns = {noun.split()[-1] for text in texts.values() for noun in COUNTED.findall(text)}
    assert {"row", "pair", "part"} <= nouns
    many = {noun + end: noun for noun in nouns for end in ("s", "es")}
    found = {
        (name, many[word])
        for name, text in texts.items()
        for word in UNCOUNTED.findall(text)
        if word in many
    }
    assert found == set(NEVER_ONE)


@pytest.mark.parametrize(
    ("bound", "digits", "least", "most"),
    [
        (0.29999999999738564, 6, "0.299999999997", "0.3"),
        (0.04 - 1e-15, 6, "0.0399999999999", "0.04"),
        (0.3, 6, "0.3", "0.3"),
        (0.5 + 1e-13, 6, "0.5", "0.500000000001"),
        (29.3767, 3, "29.3", "29.4"),
        (-0.25, 6, "-0.25", "-0.25"),
        (-0.123456789, 3, "-0.124", "-0.123"),
        (0.1234567, 15, "0.1234567", "0.1234567"),
        (999999.5, 6, "999999", "1e+06"),
        (-0.0, 6, "0", "0"),
        (math.inf, 6, "inf", "inf"),
        (-math.inf, 6, "-inf", "-inf"),
    ],
)
def test_a_bound_is_rounded_to_its_safe_side(
    bound: float, digits: int, least: str, most: str
) -> None:
    assert (at_least(bound, digits), at_most(bound, digits)) == (least, most)


def test_no_bound_is_shown_beyond_what_it_is(rng: np.random.Generator) -> None:
    for _ in range(draws(3000)):
        round_number = round(rng.uniform(-10.0, 10.0), int(rng.integers(0, 6)))
        near = round_number * (1.0 + rng.choice([0.0, 1e-16, -1e-13, 1e-9, -1e-12]))
        bound = rng.choice([near, rng.uniform(-1.0, 1.0) * 10.0 ** rng.integers(-20, 20)])
        digits = int(rng.choice([2, 3, 6, 9, 15]))
        low, high = Decimal(at_least(bound, digits)), Decimal(at_most(bound, digits))
        exact = Decimal(repr(float(bound)))
        assert low <= exact <= high
        assert high - low <= abs(exact) * Decimal(10) ** (1 - digits)


def test_no_tolerance_is_told_as_none(standoff: Standoff, passing: Path) -> None:
    told = standoff("track", passing, "--tolerance", "inf").out
    assert ", no tolerance given\n" in told


def test_coordinates_at_roundoff_are_zeros(standoff: Standoff, passing: Path) -> None:
    text = passing.read_text().replace("-1.0, 0.2, 0.9", "-1.0, 1e-18, -1e-19")
    passing.write_text(text)
    told = standoff("distance", passing).out
    assert re.search(r"^normal +\(1, 0, 0\) from tool to part$", told, re.MULTILINE)
    assert "e-1" not in told.replace("1e-10 of the pair", "")
