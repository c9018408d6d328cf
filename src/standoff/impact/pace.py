"""How far to look ahead: a model of the gap that proposes times. Nothing here is trusted."""

from __future__ import annotations

import math

SAFETY = 0.9
"""Part of the longest interval that the model expects to be provable."""

SHORTEN = 0.7
"""A refused interval is made at least this much shorter."""

TRIES = 200
"""Shortenings within one proposal: `SHORTEN` to this power is below any ratio of float64 times."""


class Pace:
    """The gap ahead, g + r t + ½ q t² with an error β t², and the sag κ t² of an interval t.

    Parameters
    ----------
    sag : float
        First guess of κ [length/s²].
    """

    def __init__(self, sag: float) -> None:
        self.sag = self.doubt = sag
        self.bend = 0.0
        self._before: tuple[float, float, float] | None = None

    def saw_sag(self, sag: float, span: float) -> None:
        """Learn from the sag of an interval; nothing from one whose square is not a number."""
        square = span * span
        if square > 0.0 and math.isfinite(sag):
            self.sag = max(sag, 0.0) / square

    def moved(self, time: float, gap: float, rate: float) -> None:
        """Learn from the gap and its rate at the time that is proven now."""
        if self._before is not None and time > self._before[0] and math.isfinite(rate):
            last_time, last_gap, last_rate = self._before
            span = time - last_time
            square = span * span
            if square > 0.0:
                told = last_gap + (last_rate + 0.5 * self.bend * span) * span
                self.doubt = abs(gap - told) / square
                self.bend = (rate - last_rate) / span
        self._before = (time, gap, rate) if math.isfinite(rate) else None

    def ahead(self, gap: float, rate: float, target: float, longest: float) -> float:
        """A span after which the gap should still be `target`, and provable."""
        slope = rate if math.isfinite(rate) else 0.0
        span = min(longest, first_root(0.5 * self.bend - self.doubt, slope, gap - target))
        root = math.sqrt(self.sag)
        for _ in range(TRIES):
            then = gap + (slope + 0.5 * self.bend * span) * span
            if root * span < SAFETY * (math.sqrt(gap) + math.sqrt(max(then, 0.0))):
                break
            span *= SHORTEN
        return span


def first_root(a: float, b: float, c: float) -> float:
    """The least t > 0 with a t² + b t + c = 0 for c > 0; inf if there is none."""
    if c <= 0.0:
        return 0.0
    inside = b * b - 4.0 * a * c
    if inside < 0.0:
        return math.inf
    # -b and the root have one sign in the sum: no digits are lost
    if b <= 0.0:
        below = -b + math.sqrt(inside)
        return 2.0 * c / below if below > 0.0 else math.inf
    return (-b - math.sqrt(inside)) / (2.0 * a) if a < 0.0 else math.inf
