"""Every sentence of the paper that promises or claims something, and what became of it.

The rows are in ``promises.toml``. Each quotes what it rests on: a part of what a figure's statement
measured, with that statement's verdict, or words of a page. So a row that is no longer true is
told: `faults` compares, and the pages and the tests ask it of every figure. Each quotation names
the change that turns it; ``broken_on_purpose.changes`` makes these changes.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping
from enum import Enum
from importlib.resources import files
from itertools import groupby
from typing import Any, NamedTuple

from standoff_studies.paper.catalogue import CATALOGUE
from standoff_studies.paper.figure import Statement
from standoff_studies.paper.verdicts import Verdict

OF_A_PAGE = ".md"
"""How the key of a page ends, its path from the pages of the paper."""

PAGES = {
    "Beyond convex bodies": "nonconvex",
    "Control theory": "control",
    "Reference [28]": "normals",
    "The field": "field",
    "variants": "variants",
    "cost": "verdict",
    "verdict": "verdict",
}
"""Pages whose name is not that of their chapter, by chapter or by key."""


class Kept(Enum):
    """What became of a sentence."""

    DONE = "carried out"
    OTHERWISE = "carried out otherwise"
    REFUTED = "refuted"


class Shown(NamedTuple):
    """What shows it.

    Attributes
    ----------
    verdict : Verdict or None
        The statement's; None of a page.
    key : str
        Of a figure, as ``standoff paper`` takes it; or the path of a page.
    number : str
        A part of what the statement measured, or of the page; the row quotes it.
    words : str
        Words of what the paper states there, if the number alone does not tell which statement is
        meant; quoted if there is no number, as where it is a time of the machine.
    turned_by : str
        The change that turns it: its name in ``broken_on_purpose.changes``.
    fixed : str
        Why no change turns it; "" if one does.
    """

    verdict: Verdict | None
    key: str
    number: str
    words: str = ""
    turned_by: str = ""
    fixed: str = ""

    @property
    def text(self) -> str:
        """What the row quotes, with the verdict's sign."""
        sign = f"{self.verdict.sign} " if self.verdict else ""
        return f"{sign}{self.number or self.words}"

    def is_of(self, statement: Statement) -> bool:
        """Is it a part of this statement?"""
        return self.words in statement.stated and self.number in statement.measured

    def fault(self, statements: Iterable[Statement]) -> str:
        """Return what of it is not so among the figure's statements; "" if all is."""
        found = [s for s in statements if self.is_of(s)]
        if len(found) != 1:
            return f'{len(found)} statements with "{self.words}", "{self.number}"'
        is_now = Verdict.of(found[0])
        return "" if is_now is self.verdict else f'"{self.text}" is {is_now.sign}'


class Promise(NamedTuple):
    """A sentence of the paper.

    Attributes
    ----------
    says : str
        The sentence, in short.
    where : str
        Its equation or figure; "" if it has none.
    kept : Kept
    why : str
        Why it is done otherwise, or what is true in its place.
    shown : tuple of Shown
    """

    says: str
    where: str
    kept: Kept
    why: str
    shown: tuple[Shown, ...]

    @property
    def figures(self) -> tuple[str, ...]:
        """Keys of the figures that show it."""
        keys = [one.key for one in self.shown if one.verdict]
        return tuple(dict.fromkeys(keys))

    @property
    def fault(self) -> str:
        """What of its verdict does not follow from what it rests on; "" if all does."""
        verdicts = {one.verdict for one in self.shown}
        if not self.shown:
            return "nothing shows it"
        if self.kept is Kept.DONE:
            return "it rests on what fails" if verdicts & {Verdict.FAILS, Verdict.OPEN} else ""
        return "" if self.why else "it does not say why"


_FILE = tomllib.loads((files(__package__) / "promises.toml").read_text("utf-8"))
_TURNED_BY: Mapping[str, Mapping[str, list[str]]] = _FILE.pop("turned by")
_FIXED: Mapping[str, str] = _FILE.pop("turned by nothing")
_SIGNS = {"": None, **{verdict.sign: verdict for verdict in Verdict}}


def _read(row: dict[str, Any]) -> Promise:
    shown = tuple(_quoted(*texts) for texts in row["shown"])
    return Promise(row["says"], row.get("where", ""), Kept(row["here"]), row.get("why", ""), shown)


def _quoted(sign: str, key: str, number: str, words: str = "") -> Shown:
    """A quotation, with the first change of its figure that names a part of it, or all."""
    fixed = _FIXED.get(number, "")
    names = (
        name
        for name, parts in _TURNED_BY.get(key, {}).items()
        if not fixed and (not parts or any(part in number or part in words for part in parts))
    )
    return Shown(_SIGNS[sign], key, number, words, next(names, ""), fixed)


PROMISES: Mapping[str, tuple[Promise, ...]] = {
    section: tuple(map(_read, rows)) for section, rows in _FILE.items()
}
"""By the section of the paper."""


def faults(key: str, statements: Iterable[Statement]) -> list[tuple[Promise, str]]:
    """Return rows that quote of a figure what its statements do not say, and what is wrong.

    Parameters
    ----------
    key : str
        Of the figure.
    statements : iterable of Statement
        All of its statements.
    """
    made = tuple(statements)
    rows = [row for section in PROMISES.values() for row in section]
    found = [(row, one.fault(made)) for row in rows for one in row.shown if one.key == key]
    return [(row, fault) for row, fault in found if fault]


def page_of(key: str) -> str:
    """Return the page on which a figure stands."""
    (entry,) = (one for one in CATALOGUE if one.key == key)
    usual = entry.chapter.casefold().replace(" ", "-")
    return PAGES.get(key, PAGES.get(entry.chapter, usual.split("-regions")[0])) + OF_A_PAGE


def markdown() -> str:
    """Return what the page has of the rows: their number by verdict, and a table a section."""
    counts = counted()
    numbers = ", ".join(f"{count} {kept.value}" for kept, count in counts.items())
    cells = _said, _kept, _shown, _turned
    tables = [
        "\n".join(
            [
                f"## {section}\n\n| the paper says | here | shown by | turned by |",
                "|---|---|---|---|",
                *(f"| {' | '.join(cell(row) for cell in cells)} |" for row in rows),
            ]
        )
        for section, rows in PROMISES.items()
    ]
    return "\n\n".join([f"Of {sum(counts.values())} sentences, {numbers}.", *tables])


def counted() -> dict[Kept, int]:
    """Return how many sentences were kept in which way."""
    found = [row.kept for rows in PROMISES.values() for row in rows]
    return {kept: found.count(kept) for kept in Kept}


def _said(row: Promise) -> str:
    return f"“{row.says}”" + (f", {row.where}" if row.where else "")


def _kept(row: Promise) -> str:
    return f"**{row.kept.value}**" + (f": {row.why}" if row.why else "")


def _shown(row: Promise) -> str:
    """Quotations by figure and page, each with its command or its link."""
    parts = []
    for key, group in groupby(row.shown, key=lambda one: one.key):
        quoted = "; ".join(one.text.replace("|", r"\|").replace("*", r"\*") for one in group)
        name = key.removesuffix(OF_A_PAGE).removeprefix("../")
        link = f"[{name}]({key})" if name != key else f"[`standoff paper {key}`]({page_of(key)})"
        parts.append(f"{link}: {quoted}")
    return "<br>".join(parts)


def _turned(row: Promise) -> str:
    """The changes that turn its quotations."""
    return "<br>".join(dict.fromkeys(one.turned_by for one in row.shown if one.turned_by))
