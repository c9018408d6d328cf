"""What is kept of a sweep's rows."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from standoff.typing import Array


class Bins(NamedTuple):
    """A histogram of distances: equal bins, a row at the upper end not among them."""

    low: float
    high: float
    number: int

    @property
    def edges(self) -> Array:
        """(number + 1,) ends of the bins."""
        return np.linspace(self.low, self.high, self.number + 1)


class Keep(NamedTuple):
    """What is kept of the rows.

    Attributes
    ----------
    worst : int
        How many rows of least distance.
    below : float or None
        Rows that are not proven to be so far apart are kept [length].
    most_below : int
        How many of them; all are counted.
    bins : Bins or None
    """

    worst: int = 1000
    below: float | None = None
    most_below: int = 10_000
    bins: Bins | None = None

    def facts(self) -> dict[str, Any]:
        """Return plain data, as a job's file has it."""
        known: dict[str, Any] = {"worst": self.worst}
        if self.below is not None:
            known |= {"below": self.below, "most_below": self.most_below}
        if self.bins is not None:
            low, high, number = self.bins
            known["histogram"] = {"from": low, "to": high, "bins": number}
        return known
