"""Which statements of which figure detect a break, compared with those without it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cache
from typing import NamedTuple

from standoff_studies.paper.broken_on_purpose.breaks import BREAKS, Break, broken
from standoff_studies.paper.catalogue import chosen, make
from standoff_studies.paper.figure import NOTHING, Statement
from standoff_studies.paper.promises import faults
from standoff_studies.paper.verdicts import Verdict

FIGURES = tuple(entry.key for entry in chosen(["6-7", "9-11", "13-20"]))
"""The figures for which the paper's law ran; Figs. 8 and 12 show only the bodies."""

GOOD = (Verdict.HOLDS, Verdict.CONSTRUCTED)


class Noticed(NamedTuple):
    """The effect of a break on one figure.

    Attributes
    ----------
    key : str
    failed : tuple of str
        Its statements that held and now fail.
    open : tuple of str
        Those that held and can no longer be judged.
    mended : tuple of str
        Those that failed and now hold.
    words : bool
        The words for the law that ran are different.
    error : str
        Why it could not be made; empty if it could.
    rows : tuple of str
        Sentences of ``promises.toml`` that are no longer true.
    """

    key: str
    failed: tuple[str, ...] = ()
    open: tuple[str, ...] = ()
    mended: tuple[str, ...] = ()
    words: bool = False
    error: str = ""
    rows: tuple[str, ...] = ()


@cache
def sound(key: str) -> tuple[Statement, ...]:
    """Return a figure's statements of the law as it is."""
    return statements_of(key)


def statements_of(key: str) -> tuple[Statement, ...]:
    """Return a figure's statements; nothing is drawn."""
    (entry,) = chosen([key])
    return make(entry).statements


def noticed(
    one: Break, figures: Sequence[str] = FIGURES, *, trials: bool = True
) -> tuple[Noticed, ...]:
    """Return the effect of a break on some figures.

    Parameters
    ----------
    one : Break
    figures : sequence of str
        Their keys.
    trials : bool
        As in `broken`.
    """
    before = {key: sound(key) for key in figures}
    with broken(one, trials=trials):
        return tuple(_compared(key, before[key]) for key in figures)


def _compared(key: str, before: tuple[Statement, ...]) -> Noticed:
    try:
        after = statements_of(key)
    except Exception as error:
        return Noticed(key, error=f"{type(error).__name__}: {error}")
    pairs = list(zip(before, after, strict=True))
    verdicts = [(s.stated, Verdict.of(s), Verdict.of(t)) for s, t in pairs if s.stated != NOTHING]
    return Noticed(
        key,
        tuple(said for said, was, now in verdicts if was in GOOD and now is Verdict.FAILS),
        tuple(said for said, was, now in verdicts if was in GOOD and now is Verdict.OPEN),
        tuple(said for said, was, now in verdicts if was is Verdict.FAILS and now in GOOD),
        any(s.by != t.by for s, t in pairs),
        rows=tuple(row.says for row, _ in faults(key, after)),
    )


Matrix = dict[str, tuple[Noticed, ...]]


def matrix(breaks: Iterable[Break] = BREAKS) -> Matrix:
    """Return the effect of every break on every figure, by the break's key."""
    return {one.key: noticed(one) for one in breaks}


def markdown(found: Matrix) -> str:
    """Return the matrix: a table of how many statements fail, then each of them."""
    breaks = {one.key: one for one in BREAKS}
    lines = [
        "| break | " + " | ".join(f"Fig. {key}" for key in FIGURES) + " |",
        "|---|" + "---|" * len(FIGURES),
    ]
    for key, row in found.items():
        one = breaks[key]
        cells = [_cell(each, each.key in one.claimed_by) for each in row]
        lines.append(f"| {key} ({one.told}) | {' | '.join(cells)} |")
    lines += ["", LEGEND, ""]
    for key, row in found.items():
        lines += [f"## {key}", ""]
        lines += [f"- Fig. {one.key}: {text}" for one in row for text in _told(one)]
        lines.append("")
    return "\n".join(lines)


LEGEND = (
    "Numbers: statements that hold without the break and fail with it; bold where the figure "
    "claims what the break changes. by: the words of the law that ran tell it. –: nothing changes."
)


def _cell(one: Noticed, claimed: bool) -> str:
    if one.error:
        return "dies"
    number = f"✗ {len(one.failed)}" if one.failed else "✗ 0" if claimed else ""
    parts = [f"**{number}**" if claimed else number, "by" if one.words else ""]
    return " ".join(filter(None, parts)) or "–"


def _told(one: Noticed) -> list[str]:
    return [
        *(f"✓ → ✗ {said}" for said in one.failed),
        *(f"✓ → – {said}" for said in one.open),
        *(f"✗ → ✓ {said}" for said in one.mended),
        *(f"promise: {said}" for said in dict.fromkeys(one.rows)),
        *([f"could not be made: {one.error}"] if one.error else []),
    ]
