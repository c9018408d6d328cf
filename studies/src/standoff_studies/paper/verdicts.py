"""The verdict on a statement: it was measured and holds or not, it is true by construction, it is
our own, or there is none."""

from __future__ import annotations

from collections.abc import Iterable
from enum import Enum

from standoff_studies.paper.figure import NOTHING, Statement


class Verdict(Enum):
    """The verdicts, each with a sign and words, so that no colour is needed."""

    HOLDS = "holds", "✓", "holds"
    FAILS = "does_not_hold", "✗", "does not hold"
    OPEN = "open", "–", "no verdict"
    CONSTRUCTED = "by_construction", "≡", "true by construction"
    OWN = "own", "○", "own measurement"

    def __init__(self, key: str, sign: str, words: str) -> None:
        self.key = key
        self.sign = sign
        self.words = words

    @classmethod
    def of(cls, statement: Statement) -> Verdict:
        """Return a statement's verdict; a measurement of our own has a separate one."""
        if statement.stated == NOTHING:
            return cls.OWN
        if statement.constructed and statement.holds:
            return cls.CONSTRUCTED
        if statement.holds is None:
            return cls.OPEN
        return cls.HOLDS if statement.holds else cls.FAILS


def counted(statements: Iterable[Statement]) -> dict[Verdict, int]:
    """Return how many statements have each verdict."""
    found = [Verdict.of(statement) for statement in statements]
    return {verdict: found.count(verdict) for verdict in Verdict}
