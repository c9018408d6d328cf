"""Rows of a sweep with their answers, as arrays and as plain data."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from standoff.kernels.state import arrays as K
from standoff.tracking.status import BY_NUMBER, Status
from standoff.typing import Array, Ints

NO_PAIR = -1
"""In place of a pair's number: there is one pair only, or none was within the horizon."""


class Rows(NamedTuple):
    """Some rows, each with its number and its answer, (n,) each.

    Attributes
    ----------
    row : array of int
    distance, lower_bound : arrays
        nan where there is none.
    status : array of int
        Numbers of `Status`.
    pair : array of int
        The subject's number of the nearest pair, or `NO_PAIR`.
    """

    row: Ints
    distance: Array
    lower_bound: Array
    status: Ints
    pair: Ints

    @classmethod
    def none(cls) -> Rows:
        whole = np.empty(0, np.int64)
        return cls(whole, np.empty(0), np.empty(0), whole, whole)

    @classmethod
    def of(cls, first: int, answers: Array) -> Rows:
        """Return the rows from `first` on of a batch's answers, as the kernels write them."""
        given = answers[:, K.STATUS]
        status = np.where(np.isnan(given), Status.REFUSED.value, given).astype(np.int64)
        numbers = np.arange(first, first + len(answers))
        distance, lower_bound = (answers[:, k].copy() for k in (K.DISTANCE, K.LOWER_BOUND))
        return cls(numbers, distance, lower_bound, status, np.full(len(answers), NO_PAIR))

    def at(self, which: Any) -> Rows:
        """Return some of them."""
        return Rows(*(column[which] for column in self))

    def with_more(self, more: Rows) -> Rows:
        """Return these, followed by others."""
        return Rows(*(np.concatenate(both) for both in zip(self, more, strict=True)))

    def facts(self) -> dict[str, list[Any]]:
        """Return plain data that JSON can hold: None for nan, statuses by name.

        There are no pairs in it where no row has one.
        """
        pairs = {"pair": self.pair.tolist()} if (self.pair != NO_PAIR).any() else {}
        return {
            "row": self.row.tolist(),
            "distance": _finite(self.distance),
            "lower_bound": _finite(self.lower_bound),
            "status": [BY_NUMBER[k].name for k in self.status.tolist()],
            **pairs,
        }

    @classmethod
    def from_facts(cls, facts: Mapping[str, Any]) -> Rows:
        none = [NO_PAIR] * len(facts["row"])
        return cls(
            np.array(facts["row"], dtype=np.int64),
            np.array(facts["distance"], dtype=np.float64),
            np.array(facts["lower_bound"], dtype=np.float64),
            np.array([Status[name].value for name in facts["status"]], dtype=np.int64),
            np.array(facts.get("pair", none), dtype=np.int64),
        )


def _finite(values: Array) -> list[float | None]:
    return [x if math.isfinite(x) else None for x in values.tolist()]
