"""What is broken on purpose the report says: the law, the gain, a normal's sign, a reset."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import pytest

from shares import only
from standoff.tracking import Tracker
from standoff_studies.paper import pair_simulation
from standoff_studies.paper.broken_on_purpose import BREAKS, FIGURES, Break, Noticed, noticed
from standoff_studies.paper.broken_on_purpose.matrix import markdown, sound
from standoff_studies.paper.figure import Statement, missing_words
from standoff_studies.paper.promises import PROMISES, faults
from standoff_studies.paper.simulation_c import regions as regions_c
from standoff_studies.paper.simulation_c import run as c
from standoff_studies.paper.simulation_d import runs as d
from standoff_studies.paper.simulation_e import runs as e
from standoff_studies.paper.verdicts import Verdict


def saying(statements: tuple[Statement, ...], words: str) -> Statement:
    (found,) = (statement for statement in statements if words in statement.stated)
    return found


KEPT = {
    "gain halved": ("10",),
    "gain x 1.2": ("18", "20"),
    "no feedforward": ("7", "13", "15"),
    "b's sign": ("10",),
    "M definite": ("9",),
    "no guards": ("9", "11", "13", "14", "16", "17", "18", "19", "20"),
    "exact reset": ("9", "13", "17", "18", "20"),
    "restarts": ("7",),
}
"""By the break, figures that are made with it: each break and each claim at least once. The others
are for `make soak`."""

LONGEST = ("gain x 1.2", "no feedforward", "no guards", "exact reset", "restarts")
"""Breaks whose figures take longest, three minutes of one core together: for `make soak` too."""


def resting_on(figure: str, words: str) -> set[str]:
    """Sentences of the promises whose row quotes a statement with these words."""
    stated = [s for s in sound(figure) if words in s.stated]
    rows = [row for section in PROMISES.values() for row in section]
    quoted = [(row.says, one) for row in rows for one in row.shown if one.key == figure]
    return {says for says, one in quoted for s in stated if one.is_of(s)}


def check_that_it_is_noticed(one: Break, figures: Iterable[str]) -> None:
    """Each figure that claims what is broken says so in that statement, and none dies of it."""
    found = {row.key: row for row in noticed(one, sorted(figures, key=int), trials=False)}
    assert [(row.key, row.error) for row in found.values() if row.error] == []
    for figure, words in one.claims:
        if figure in found:
            assert sum(words in stated for stated in found[figure].failed) == 1, (figure, words)
            assert resting_on(figure, words) <= {*found[figure].rows}
    # the law on record is another one, but for twists that it was told wrong
    assert [row.key for row in found.values() if row.words != (not one.backwards)] == []


@pytest.mark.parametrize(
    "one",
    [
        pytest.param(one, id=one.key, marks=[pytest.mark.soak] if one.key in LONGEST else [])
        for one in BREAKS
    ],
)
def test_what_is_claimed_is_noticed(one: Break) -> None:
    check_that_it_is_noticed(one, KEPT[one.key])


@pytest.mark.soak
@pytest.mark.parametrize("one", BREAKS, ids=lambda one: one.key)
def test_what_is_claimed_is_noticed_by_all_its_figures(one: Break) -> None:
    check_that_it_is_noticed(one, one.claimed_by - {*KEPT[one.key]})


def test_every_claim_is_tried_in_every_run() -> None:
    claims = {claim for one in BREAKS for claim in one.claims}
    assert claims == {x for one in BREAKS for x in one.claims if x[0] in KEPT[one.key]}
    assert {*KEPT} == {one.key for one in BREAKS}
    assert all({*KEPT[one.key]} <= one.claimed_by for one in BREAKS)


@pytest.mark.parametrize("figure", only(["18"], ["18", "20"]))
def test_nothing_is_noticed_where_nothing_is_broken(figure: str) -> None:
    """The matrix by itself breaks nothing, nor does it leave anything broken behind."""
    times = [one.SIMULATION.paper.time for one in (d, e)]
    for row in noticed(Break("none", "the law as it is"), (figure,), trials=False):
        assert row == Noticed(row.key)
    for one, time in zip((d, e), times, strict=True):
        assert one.SIMULATION.paper.time is time
    assert pair_simulation.Tracker is Tracker


def test_the_table_tells_every_break() -> None:
    """One row a break and one column a figure; what a figure fails to notice is a bold 0."""
    blind = Noticed("20")
    rows = {one.key: (*map(Noticed, FIGURES[:-1]), blind) for one in BREAKS}
    lines = markdown(rows).splitlines()
    assert lines[0].count("|") == len(FIGURES) + 2
    assert len([line for line in lines if line.startswith("| ")]) == 1 + len(BREAKS)
    halved = next(line for line in lines if line.startswith("| gain halved"))
    assert halved.count("**✗ 0**") == len(BREAKS[0].claimed_by)
    seen = Noticed("7", failed=("it decays",), mended=("it arrives",), words=True)
    text = markdown({"gain halved": (seen,)})
    assert "**✗ 1** by" in text
    assert "- Fig. 7: ✓ → ✗ it decays" in text
    assert "- Fig. 7: ✗ → ✓ it arrives" in text


def test_a_normal_of_the_wrong_sign_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """External lines that go inwards: the switches are no longer on them."""
    words = "where the opposing witness point crosses"
    assert saying(regions_c._statements(c.SIMULATION), words).holds is True
    turned = tuple(
        replace(
            one,
            external=tuple(line._replace(directions=-line.directions) for line in one.external),
        )
        for one in regions_c.regions()
    )
    monkeypatch.setattr(regions_c, "regions", lambda: turned)
    assert Verdict.of(saying(regions_c._statements(c.SIMULATION), words)) is Verdict.FAILS


@pytest.mark.parametrize(
    "key", [pytest.param(k, marks=[pytest.mark.soak] if k in ("7", "17") else []) for k in FIGURES]
)
def test_every_statement_names_its_law(key: str) -> None:
    """`make docs` asks the same of all that "standoff paper all" makes."""
    assert [(one.stated, missing_words(one)) for one in sound(key) if missing_words(one)] == []


@pytest.mark.parametrize(
    "key", [pytest.param(k, marks=[pytest.mark.soak] if k in ("7", "17") else []) for k in FIGURES]
)
def test_the_promises_quote_what_was_measured(key: str) -> None:
    assert faults(key, sound(key)) == []


def test_what_a_statement_does_not_say_is_noticed() -> None:
    whole = Statement("Fig. 7", "it holds", "it does", True, "by its making", "a law", True)
    assert missing_words(whole) == ""
    assert missing_words(whole._replace(measured="")) == "what was measured"
    assert missing_words(whole._replace(by="")) == "the law that it was measured with"
    assert missing_words(whole._replace(why="")) == "why it cannot fail"
    assert missing_words(whole._replace(why="", constructed=False)) == ""
