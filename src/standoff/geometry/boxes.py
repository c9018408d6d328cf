"""Boxes of parameters, many at once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.geometry.intervals import Interval
from standoff.typing import Array


class Boxes:
    """n boxes of d parameters: `low` and `high`, each (n, d)."""

    def __init__(self, low: Array, high: Array) -> None:
        self.low = low
        self.high = high

    def __len__(self) -> int:
        return len(self.low)

    def __getitem__(self, which: Any) -> Boxes:
        return Boxes(self.low[which], self.high[which])

    @property
    def middle(self) -> Array:
        return 0.5 * (self.low + self.high)

    @property
    def sides(self) -> list[Interval]:
        return [Interval(self.low[:, k], self.high[:, k]) for k in range(self.low.shape[1])]

    def halves(self, axis: NDArray[np.int64]) -> Boxes:
        """Each box halved along its `axis` (n,)."""
        rows = np.arange(len(self))
        middle = self.middle[rows, axis]
        left, right = self.high.copy(), self.low.copy()
        left[rows, axis] = middle
        right[rows, axis] = middle
        return Boxes(np.concatenate([self.low, right]), np.concatenate([left, self.high]))


def grid(domain: Sequence[float], sides: int) -> Boxes:
    """sides^d boxes that tile (u0, u1, v0, v1), or (t0, t1)."""
    cuts = [np.linspace(domain[k], domain[k + 1], sides + 1) for k in range(0, len(domain), 2)]
    low = np.stack([a.ravel() for a in np.meshgrid(*(c[:-1] for c in cuts), indexing="ij")], 1)
    high = np.stack([a.ravel() for a in np.meshgrid(*(c[1:] for c in cuts), indexing="ij")], 1)
    return Boxes(low, high)
