"""Each sentence of the paper as a row: its verdict, what it quotes, and that a change is told."""

import re
from pathlib import Path

import pytest

from standoff_studies.paper.broken_on_purpose.matrix import FIGURES, statements_of
from standoff_studies.paper.catalogue import CATALOGUE
from standoff_studies.paper.figure import Statement
from standoff_studies.paper.promises import (
    PROMISES,
    Kept,
    Promise,
    Shown,
    faults,
    markdown,
    page_of,
)
from standoff_studies.paper.verdicts import Verdict

PAGES = Path(__file__).parents[2] / "docs" / "paper"
ROWS = [row for rows in PROMISES.values() for row in rows]
QUOTED = [one for row in ROWS for one in row.shown]
KEYS = {entry.key for entry in CATALOGUE}

QUICK = ("2", "arrivals", "stability")
"""Figures whose rows are compared in every run. The others' are compared when the pages are built;
those of simulations A to E in test_broken_on_purpose.py too, which makes them."""


def test_the_page_has_every_row() -> None:
    assert markdown() in (PAGES / "promises.md").read_text("utf-8")


def test_every_verdict_follows_from_what_is_quoted() -> None:
    assert [(row.says, row.fault) for row in ROWS if row.fault] == []
    assert len({row.says for row in ROWS}) == len(ROWS)
    assert {row.kept for row in ROWS} == {*Kept}


def test_sentences_are_short() -> None:
    """At most fourteen words of the paper, with the section or the equation."""
    assert [row.says for row in ROWS if len(re.findall(r"[\w–-]+", row.says)) > 16] == []


def test_every_figure_of_the_paper_shows_something() -> None:
    shown = {key for row in ROWS for key in row.figures}
    assert shown <= KEYS
    assert {key for key in KEYS if key.isdecimal()} <= shown


def test_commands_lead_to_the_figures_page() -> None:
    for key in {key for row in ROWS for key in row.figures}:
        assert f"{{paper-figure}} {key}\n" in (PAGES / page_of(key)).read_text("utf-8")


def test_pages_have_the_words_that_are_quoted() -> None:
    pages = [one for one in QUOTED if one.verdict is None]
    for one in pages:
        assert one.number in " ".join((PAGES / one.key).read_text("utf-8").split()), one
    assert len(pages) > 20


@pytest.mark.parametrize(
    "key",
    [
        pytest.param(k, marks=[] if k in QUICK else [pytest.mark.soak])
        for k in sorted(KEYS - {*FIGURES})
    ],
)
def test_rows_quote_what_was_measured(key: str) -> None:
    assert faults(key, statements_of(key)) == []


@pytest.mark.parametrize("key", ["2", "arrivals"])
def test_another_verdict_or_number_is_told(key: str) -> None:
    statements = statements_of(key)
    for one in [one for one in QUOTED if one.key == key]:
        (its,) = (s for s in statements if one.is_of(s))
        others = [s for s in statements if s is not its]
        if one.number:
            assert faults(key, [*others, its._replace(measured="otherwise")])
        if one.verdict is not Verdict.OWN:
            assert faults(key, [*others, its._replace(holds=not its.holds)])
        assert faults(key, others)


def row(kept: Kept, why: str, *signs: Verdict) -> Promise:
    return Promise("a sentence", "", kept, why, tuple(Shown(sign, "6", "1") for sign in signs))


@pytest.mark.parametrize(
    ("promise", "fault"),
    [
        (row(Kept.DONE, "", Verdict.HOLDS, Verdict.OWN), ""),
        (row(Kept.DONE, "", Verdict.HOLDS, Verdict.FAILS), "it rests on what fails"),
        (row(Kept.DONE, "", Verdict.OPEN), "it rests on what fails"),
        (row(Kept.OTHERWISE, "better", Verdict.FAILS), ""),
        (row(Kept.OTHERWISE, "", Verdict.HOLDS), "it does not say why"),
        (row(Kept.REFUTED, "", Verdict.FAILS), "it does not say why"),
        (row(Kept.DONE, ""), "nothing shows it"),
    ],
)
def test_a_verdict_that_does_not_follow_is_told(promise: Promise, fault: str) -> None:
    assert promise.fault == fault


def test_a_quotation_must_be_of_one_statement() -> None:
    made = Statement("Fig. 6", "it holds", "1 of 2", True)
    assert Shown(Verdict.HOLDS, "6", "1 of 2").fault([made]) == ""
    assert "2 statements" in Shown(Verdict.HOLDS, "6", "1 of 2").fault([made, made])
    assert "0 statements" in Shown(Verdict.HOLDS, "6", "1 of 2", "it fails").fault([made])
    assert Shown(Verdict.OWN, "6", "1 of 2").fault([made]) == '"○ 1 of 2" is ✓'
