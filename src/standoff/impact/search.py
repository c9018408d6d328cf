"""The search: intervals proven one after the other, until the clearance or the end is reached."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from standoff.checks.numbers import number, positive
from standoff.errors import StandoffError
from standoff.impact.answer import Impact, ImpactStatus
from standoff.impact.chord import Chords
from standoff.impact.moment import EPS, Box, Moment
from standoff.impact.pace import SHORTEN, Pace
from standoff.impact.tolerances import (
    AIM,
    LEAST_TOLERANCE,
    NEIGHBOURS,
    SHORTEST_TIME,
)
from standoff.motion.bounds import breaks_of

BALLS_APART = 0.3
"""Bounding balls farther apart than this part of their radii stand for the bodies."""

BALLS_AIM = 0.2
"""There the search aims at this part of the radii."""

PROBES = 8
"""Instants looked at beyond the bracket's beginning for one that is proven to be in contact."""


def checked_clearance(clearance: float) -> float:
    """A distance that counts as impact, zero or more (length).

    Raises TypeError, ValueError.
    """
    clearance = number(clearance, "clearance")
    if clearance < 0.0:
        raise StandoffError(
            f"clearance = {clearance}: give zero or more. The time at which overlapping bodies "
            "reach a depth is not searched for, because a smaller depth than the one found may "
            "exist.",
            "clearance",
            clearance,
        )
    return clearance


def checked_times(paths: Iterable[Any], start: float, duration: float) -> tuple[float, float]:
    """The times at which the search begins and ends [s]; a rounding beyond a path's end is not a
    time beyond it.

    Raises TypeError, ValueError if a path ends before, or no time is left between the start and the
    end.
    """
    duration, start = positive(duration, "duration"), number(start, "start")
    end = start + duration
    if not end > start:
        raise StandoffError(
            f"start + duration = {start!r} + {duration!r} is no later than the start, because "
            f"times there are {math.ulp(start):.2g} s apart: give a longer duration, or a start "
            "nearer to zero (PoseSamples.starting_at moves samples of a distant epoch)."
        )
    for path in paths:
        last = float(getattr(path, "end", math.inf))
        if start < last < end <= last + NEIGHBOURS * EPS * max(abs(last), abs(start)):
            end = last
        if last < end:
            advice = "shorter duration" if start < last else "start before that"
            raise StandoffError(
                f"start + duration = {end!r}, but a path ends at {last!r}: give a {advice}."
            )
    return start, end


class _Spent(Exception):
    """The budget of evaluations ran out."""


class Search:
    """The search of one pair, by what a tracker proves at instants.

    Parameters
    ----------
    tracker : with the calls `start` and `step` of `Tracker`
    boxes : of both bodies
    size : of both together, without a half-space's, length
    paths : of both
    asked : the clearance, length; the tolerance, relative; the budget of instants
    """

    farther = 2.0
    """How many times as far as the one before each of `PROBES` is."""

    def __init__(
        self,
        tracker: Any,
        boxes: tuple[Box, Box],
        size: float,
        paths: tuple[Any, Any],
        asked: tuple[float, float, int],
    ) -> None:
        self.tracker, self.paths = tracker, paths
        self.boxes, self.size = boxes, size
        self.clearance, self.relative, self.budget = asked
        self.chords = Chords(self.boxes, paths)
        self.reach = sum(box.reach + box.radius for box in self.boxes)
        self.steps = self.evaluations = self.queries = 0
        self.latest = math.inf  # the first instant known to be in contact
        self.end = math.nan

    def run(self, start: float, end: float) -> Impact:
        self.end = end
        stops = sorted({*(t for path in self.paths for t in breaks_of(path, start, end)), end})
        self.now = self.look(start)
        self.chords.prepare(self.now, stops[0])
        self.known: Moment | None = None  # the last proven instant at which the tracker was asked
        self.tolerance = self.relative * (self.size or abs(self.now.ball.lower))
        try:
            for stop in stops:
                found = self._cross(start, stop)
                if found is not None:
                    return found
        except _Spent:
            return self._answer(ImpactStatus.UNDECIDED, self.latest)
        return self._answer(ImpactStatus.NO_IMPACT, math.inf)

    # --- the pair at an instant -------------------------------------------------------------

    def look(self, time: float) -> Moment:
        if self.evaluations >= self.budget:
            raise _Spent
        self.evaluations += 1
        return self._seen(time)

    def _seen(self, time: float) -> Moment:
        return Moment(self.boxes, self.paths, time)

    def ask(self, moment: Moment) -> None:
        """Ask the tracker, from the last proven instant at which it was asked."""
        if moment.asked:
            return
        self.queries += 1
        moment.ask(self.tracker, self.known)
        if self.touches(moment):
            self.latest = min(self.latest, moment.time)

    def touches(self, moment: Moment) -> bool:
        """Is it proven to be in contact, also at the poses that rounding has moved?"""
        return moment.upper + moment.doubt <= self.clearance

    def gap(self, moment: Moment, balls: bool = False) -> float:
        """Certified distance beyond the clearance, less what rounding may do."""
        lower = moment.ball.lower if balls else moment.lower
        return lower - self.clearance - moment.rounding

    # --- one piece of time without a break --------------------------------------------------

    def _cross(self, start: float, stop: float) -> Impact | None:
        """Prove time from the present instant up to `stop`; what was found on the way, or None."""
        self.chords.prepare(self.now, stop)
        self.paces = self._paces()
        ahead: list[Moment] = []
        before = math.inf  # the next instant to look at is before this one
        while self.now.time < stop:
            tolerance = max(self.tolerance, LEAST_TOLERANCE * self.now.rounding)
            gap = self.gap(self.now, balls=True)
            balls = gap > max(BALLS_APART * self.reach, 2.0 * tolerance)
            target = BALLS_AIM * self.reach
            if not balls:
                found = self._at_clearance(start, tolerance)
                if found is not None:
                    return found
                gap, target = self.gap(self.now), AIM * tolerance
            rate = self.now.ball.rate if balls else self.now.rate
            pace = self.paces[balls]
            pace.moved(self.now.time, gap, rate)
            if ahead and self._free(self.now, ahead[-1]):
                self._move_to(ahead.pop())
                before = ahead[-1].time if ahead else math.inf
                continue
            if ahead:
                before = ahead[-1].time
                if not self._useful(ahead[-1]):
                    ahead.pop()
            # A short time before the stop is looked at as any other; only where an instant was
            # refused is there nothing left to look at.
            least = max(NEIGHBOURS * EPS * abs(self.now.time), SHORTEST_TIME)
            left, longest = stop - self.now.time, SHORTEN * (before - self.now.time)
            if longest <= least:
                return self._stuck(before)
            longest = min(left, longest)
            span = max(least, pace.ahead(gap, rate, target, longest))
            if not balls and self.gap(self.now, balls=True) > 0.0:
                span = max(span, self._ahead_by_balls(longest))
            time = stop if span >= left else self.now.time + span
            ahead.append(self.look(time))
        return None

    def _paces(self) -> dict[bool, Any]:
        """How far to look ahead, by the bodies and by their balls."""
        return {balls: Pace(self.chords.first_sag(self.now, balls)) for balls in (True, False)}

    def _ahead_by_balls(self, longest: float) -> float:
        """How far the bounding balls prove, where they are apart though near: beside a corner."""
        gap = self.gap(self.now, balls=True)
        return float(self.paces[True].ahead(gap, self.now.ball.rate, 0.5 * gap, longest))

    def _move_to(self, moment: Moment) -> None:
        self.now = moment
        self.steps += 1

    def _free(self, first: Moment, last: Moment) -> bool:
        """Is all the time between two instants proven to keep the clearance?"""
        self.chords.prepare(first, last.time)
        for balls in (True, False):
            if not balls:
                self.ask(first)
                self.known = first
                self.ask(last)
            if min(self.gap(first, balls), self.gap(last, balls)) <= 0.0:
                continue
            if self._kept(first, last, balls):
                return True
        return False

    def _kept(self, first: Moment, last: Moment, balls: bool) -> bool:
        """The same by the bodies, or their balls, at two instants at which they keep it."""
        sag = self.chords.sag(first, last, balls)
        self.paces[balls].saw_sag(sag, last.time - first.time)
        return sag < (math.sqrt(self.gap(first, balls)) + math.sqrt(self.gap(last, balls))) ** 2

    def _useful(self, moment: Moment) -> bool:
        """Will it serve once more: it is clear of the clearance, or known to be in contact?"""
        return self.gap(moment) > 0.0 or self.touches(moment)

    # --- the end ----------------------------------------------------------------------------

    def _at_clearance(self, start: float, tolerance: float) -> Impact | None:
        """The answer where the present instant is within the tolerance of the clearance."""
        self.ask(self.now)
        self.known = self.now
        if self.gap(self.now) > tolerance:
            return None
        if self.now.time == start and self.touches(self.now):
            return self._answer(ImpactStatus.AT_START, start)
        near = self._probe(tolerance)
        if self.latest < math.inf:
            return self._answer(ImpactStatus.IMPACT, self.latest)
        if not near < math.inf:  # whether they are so near at all is not proven
            return self._answer(ImpactStatus.UNDECIDED, self.latest)
        return self._answer(ImpactStatus.GRAZING, near)

    def _probe(self, tolerance: float) -> float:
        """Look soon after the present instant for one proven to be in contact.

        Returns the last instant proven to be within the tolerance of the clearance; inf for none.
        """
        now, rate = self.now, self.now.rate
        near = now.time if self._near(now, tolerance) else math.inf
        if not rate < 0.0:
            return near
        bend = self.paces[False].bend
        turn = -rate / bend if bend > 0.0 else math.inf
        left = max(now.upper - self.clearance, tolerance)
        first = 1.5 * left / -rate
        for k in range(PROBES):
            span = min(first * self.farther**k, turn)
            time = now.time + span
            if not now.time < time <= self.end or time >= self.latest:
                break
            try:
                moment = self.look(time)
            except _Spent:
                break
            self.ask(moment)
            if self.touches(moment):
                break
            if moment.upper <= self.clearance + tolerance:
                near = time
            if span == turn:
                break
        return near

    def _near(self, moment: Moment, tolerance: float) -> bool:
        """Is the distance proven to be within the tolerance of the clearance, but for what the
        lower bound is less by where all is well?"""
        return moment.upper - self.clearance <= 2.0 * (tolerance + self._slack(moment))

    def _slack(self, moment: Moment) -> float:
        """Of both bodies, length."""
        return float(sum(body.report.slack for body in (self.tracker.a, self.tracker.b)))

    def _stuck(self, before: float) -> Impact:
        """The answer where no time is left between the present instant and a refused one."""
        if self.latest <= before < math.inf:
            return self._answer(ImpactStatus.IMPACT, self.latest)
        return self._answer(ImpactStatus.UNDECIDED, self.latest)

    def _answer(self, status: ImpactStatus, latest: float) -> Impact:
        self.ask(self.now)
        return Impact(
            self.now.time,
            latest if latest < math.inf else math.nan,
            status,
            self.now.proximity,
            self.clearance,
            max(self.tolerance, LEAST_TOLERANCE * self.now.rounding),
            self.steps,
            self.evaluations,
            self.queries,
        )
