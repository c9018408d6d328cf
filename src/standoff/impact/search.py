"""The search: intervals proven one after the other, until the clearance or the end is reached."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from standoff.bodies.body import Body
from standoff.checks.numbers import number, positive, whole_number
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
    TRACKER_SHARE,
    TRACKER_TOLERANCE,
)
from standoff.motion.bounds import breaks_of, known
from standoff.motion.moving import MotionLike, moving
from standoff.tracking.laws import PredictorCorrector
from standoff.tracking.tracker import Tracker

BALLS_APART = 0.3
"""Bounding balls farther apart than this part of their radii stand for the bodies."""

BALLS_AIM = 0.2
"""There the search aims at this part of the radii."""

PROBES = 8
"""Instants looked at beyond the bracket's beginning for one that is proven to be in contact, each
twice as far as the one before."""


def time_of_impact(  # noqa: PLR0913 - four of them are keywords with defaults
    a: Body,
    b: Body,
    path_a: MotionLike,
    path_b: MotionLike,
    duration: float,
    *,
    clearance: float = 0.0,
    tolerance: float = 1e-9,
    start: float = 0.0,
    max_evaluations: int = 10_000,
) -> Impact:
    """The first time at which two moving bodies come to a clearance: never later than the true one.

    Each interval of time is proven free by the certified bounds at its ends and the greatest
    accelerations within it (docs/impact-proof.md).

    Parameters
    ----------
    a, b : Body
        Two spatial bodies, or two planar ones.
    path_a, path_b : path or pose
        A path of ``standoff.motion``; with a pose the body is at rest. A path of your own, or a
        function of time that returns a pose, is wrapped in ``standoff.motion.Bounded``, which says
        how fast it can be.
    duration : float
        Time to search [s]; ``start + duration`` must differ from ``start`` in floating point.
    clearance : float
        Distance that counts as impact, zero for contact [length].
    tolerance : float
        The search ends within this distance of the clearance, relative to the sum of the bodies'
        sizes (without a half-space's).
    start : float
        Time on the paths' clock at which the search begins [s].
    max_evaluations : int
        Greatest number of instants to look at.

    Returns
    -------
    Impact

    Raises
    ------
    TypeError
        Not a body, neither path nor pose, or a path of which no bounds are known.
    ValueError
        A negative clearance, a tolerance or duration that is not positive, a budget that is not a
        whole number of at least 2, times beyond 1e50 s, a duration that is negligible compared with
        the start, a pair that cannot be tracked, or a time that a path refuses.
    """
    paths = moving(path_a, "path_a"), moving(path_b, "path_b")
    for path in paths:
        known(path)
    begin, end = checked_times(paths, start, duration)
    clearance = checked_clearance(clearance)
    tolerance = positive(tolerance, "tolerance")
    whole_number(max_evaluations, "max_evaluations", 2)
    search = _Search(_tracker(a, b, tolerance), paths, clearance, tolerance, max_evaluations)
    return search.run(begin, end)


def _tracker(a: Body, b: Body, tolerance: float) -> Tracker:
    """A tracker whose bounds are closer than the search's tolerance."""
    gap = min(TRACKER_TOLERANCE, TRACKER_SHARE * tolerance)
    return Tracker(a, b, law=PredictorCorrector(tolerance=gap))


def checked_clearance(clearance: float) -> float:
    """A distance that counts as impact, zero or more (length).

    Raises
    ------
    TypeError, ValueError
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

    Raises
    ------
    TypeError, ValueError
        If a path ends before, or no time is left between the start and the end.
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


class _Search:
    def __init__(
        self,
        tracker: Tracker,
        paths: tuple[Any, Any],
        clearance: float,
        tolerance: float,
        budget: int,
    ) -> None:
        self.tracker, self.paths = tracker, paths
        self.boxes = Box(tracker.a), Box(tracker.b)
        self.clearance, self.relative, self.budget = clearance, tolerance, budget
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
        size = sum(body.size for body in (self.tracker.a, self.tracker.b) if body.bounded)
        self.tolerance = self.relative * (size or abs(self.now.ball.lower))
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
        self.paces = {
            balls: Pace(self.chords.first_sag(self.now, balls)) for balls in (True, False)
        }
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

    def _ahead_by_balls(self, longest: float) -> float:
        """How far the bounding balls prove, where they are apart though near: beside a corner."""
        gap = self.gap(self.now, balls=True)
        return self.paces[True].ahead(gap, self.now.ball.rate, 0.5 * gap, longest)

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
            before, after = self.gap(first, balls), self.gap(last, balls)
            if min(before, after) <= 0.0:
                continue
            sag = self.chords.sag(first, last, balls)
            self.paces[balls].saw_sag(sag, last.time - first.time)
            if sag < (math.sqrt(before) + math.sqrt(after)) ** 2:
                return True
        return False

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
        return self._answer(ImpactStatus.GRAZING, near)

    def _probe(self, tolerance: float) -> float:
        """Look soon after the present instant for one proven to be in contact.

        Returns the last instant proven to be within the tolerance of the clearance.
        """
        now, rate = self.now, self.now.rate
        near = now.time
        if not rate < 0.0:
            return near
        bend = self.paces[False].bend
        turn = -rate / bend if bend > 0.0 else math.inf
        left = max(now.upper - self.clearance, tolerance)
        first = 1.5 * left / -rate
        for k in range(PROBES):
            span = min(first * 2.0**k, turn)
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
