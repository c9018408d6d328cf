"""The search: intervals proven one after the other, until the clearance or the end is reached."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np

from standoff.checks.numbers import number, positive
from standoff.errors import StandoffError
from standoff.impact.answer import Impact, ImpactStatus
from standoff.impact.moment import EPS, BodyBox, PairInstant
from standoff.impact.tolerances import (
    AIM,
    LEAST_TOLERANCE,
    NEIGHBOURS,
    SHORTEST_TIME,
)
from standoff.motion.bounds import MotionBounds, bounds_of, breaks_of
from standoff.motion.vectors import cross, length
from standoff.typing import Array

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


class ImpactSearch:
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
        boxes: tuple[BodyBox, BodyBox],
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
        self.known: PairInstant | None = (
            None  # the last proven instant at which the tracker was asked
        )
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

    def look(self, time: float) -> PairInstant:
        if self.evaluations >= self.budget:
            raise _Spent
        self.evaluations += 1
        return self._seen(time)

    def _seen(self, time: float) -> PairInstant:
        return PairInstant(self.boxes, self.paths, time)

    def ask(self, moment: PairInstant) -> None:
        """Ask the tracker, from the last proven instant at which it was asked."""
        if moment.asked:
            return
        self.queries += 1
        moment.ask(self.tracker, self.known)
        if self.touches(moment):
            self.latest = min(self.latest, moment.time)

    def touches(self, moment: PairInstant) -> bool:
        """Is it proven to be in contact, also at the poses that rounding has moved?"""
        return moment.upper + moment.doubt <= self.clearance

    def gap(self, moment: PairInstant, balls: bool = False) -> float:
        """Certified distance beyond the clearance, less what rounding may do."""
        lower = moment.ball.lower if balls else moment.lower
        return lower - self.clearance - moment.rounding

    # --- one piece of time without a break --------------------------------------------------

    def _cross(self, start: float, stop: float) -> Impact | None:
        """Prove time from the present instant up to `stop`; what was found on the way, or None."""
        self.chords.prepare(self.now, stop)
        self.paces = self._paces()
        ahead: list[PairInstant] = []
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

    def _move_to(self, moment: PairInstant) -> None:
        self.now = moment
        self.steps += 1

    def _free(self, first: PairInstant, last: PairInstant) -> bool:
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

    def _kept(self, first: PairInstant, last: PairInstant, balls: bool) -> bool:
        """The same by the bodies, or their balls, at two instants at which they keep it."""
        sag = self.chords.sag(first, last, balls)
        self.paces[balls].saw_sag(sag, last.time - first.time)
        return sag < (math.sqrt(self.gap(first, balls)) + math.sqrt(self.gap(last, balls))) ** 2

    def _useful(self, moment: PairInstant) -> bool:
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

    def _near(self, moment: PairInstant, tolerance: float) -> bool:
        """Is the distance proven to be within the tolerance of the clearance, but for what the
        lower bound is less by where all is well?"""
        return moment.upper - self.clearance <= 2.0 * (tolerance + self._slack(moment))

    def _slack(self, moment: PairInstant) -> float:
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


# How far below their chord the separations of two instants can sag between them.
#
# Let x be any point fixed in A, y one of B, z = y - x, n0 and n1 the unit normals at the times t0
# and t1 with n0·z(t0) >= L0 and n1·z(t1) >= L1 for all x, y. At t = t0 + λ (t1 - t0) take
# n = (1-λ) n0 + λ n1. Each point's way differs from its chord by at most ½ λ(1-λ) (t1-t0)² times
# its greatest acceleration along n, and |n| <= 1, so that
#
# n·z(t) >= (1-λ) L0 + λ L1 - λ(1-λ) S,
# S = max (n1 - n0)·(z(t1) - z(t0)) + ½ (t1 - t0)² max (|x''| + |y''|).
#
# The acceleration of a point of a body on a screw has no part along the screw's axis, which leaves
# |n × axis| of it. The maximum over x and y in the bodies' boxes is a sum of three absolute values
# a body. As the distance is at least n·z/|n|, the bodies are apart in between if the right-hand
# side is positive: for L0, L1 > 0 if and only if S < (√L0 + √L1)². Both terms of S are of second
# order in t1 - t0.
#
# Where one body is a half-space, n is its own normal and everything is seen from it: then
# n1 - n0 = 0, and the accelerations are those relative to its turning frame.

STALE = 4.0
"""Bounds on the motion are taken anew where they hold for an interval this many times as long."""


class Chords:
    """Bounds the sag of one pair on two paths, within a piece of time without a break."""

    def __init__(self, boxes: tuple[BodyBox, BodyBox], paths: tuple[Any, Any]) -> None:
        self.boxes, self.paths = boxes, paths
        self.first, self.last = 0.0, -1.0

    def prepare(self, start: PairInstant, last: float) -> None:
        """Make the bounds those of the time from a moment to `last`, or of little more."""
        within = self.first <= start.time and last <= self.last
        if within and self.last - self.first <= STALE * (last - start.time):
            return
        self.first, self.last = start.time, last
        self.bounds = tuple(
            bounds_of(path, start.time, last, point)
            for path, point in zip(self.paths, start.points, strict=True)
        )
        self.speed = sum(
            bound.speed + bound.angular_speed * box.reach
            for bound, box in zip(self.bounds, self.boxes, strict=True)
        )

    def sag(self, start: PairInstant, end: PairInstant, balls: bool) -> float:
        """S between two moments in `prepare`'s time: of the bodies, or of their bounding balls."""
        span = end.time - start.time
        bend = 0.5 * span * span
        ends = start.ball if balls else start, end.ball if balls else end
        normals = ends[0].normal, ends[1].normal
        if self.boxes[0].plane or self.boxes[1].plane:
            return bend * self._seen_from_plane(normals, balls)
        acceleration = sum(
            _along(bound, normals) * (bound.acceleration + _turning(bound) * (0.0 if balls else r))
            for bound, r in zip(self.bounds, (box.reach for box in self.boxes), strict=True)
        )
        way = (end.b.centre - start.b.centre) - (end.a.centre - start.a.centre)
        turn = normals[1] - normals[0]
        total = float(turn @ way) + bend * acceleration
        if not balls:
            # R changes by R1 - R0; the greatest turn·(R1 - R0)(x - middle) over a box
            for box, before, after in (
                (self.boxes[0], start.a.rotation, end.a.rotation),
                (self.boxes[1], start.b.rotation, end.b.rotation),
            ):
                total += float(np.abs(turn @ (after - before)) @ box.half)
        return total

    def first_sag(self, start: PairInstant, balls: bool) -> float:
        """A guess of S over the square of the span [length/s²], before any was seen."""
        spread = abs(start.ball.lower) + sum(box.reach for box in self.boxes)
        total = sum(bound.acceleration for bound in self.bounds)
        if not balls:
            bounds = zip(self.bounds, self.boxes, strict=True)
            total += sum(_turning(bound) * box.reach for bound, box in bounds)
        return 0.5 * total + (self.speed**2 / spread if spread > 0.0 else 0.0)

    def _seen_from_plane(self, normals: tuple[Array, Array], balls: bool) -> float:
        """Acceleration of the other body's points in the half-space's frame.

        With z from the half-space's own point that was beside the body at the start of the bounds,
        it is z'' - α × z - 2 ω × z' + ω × (ω × z).
        """
        k = 0 if self.boxes[0].plane else 1
        wall, other = self.bounds[k], self.bounds[1 - k]
        reach = 0.0 if balls else self.boxes[1 - k].reach
        own = other.acceleration + _turning(other) * reach
        if wall.angular_speed == 0.0:  # the normal is the same all the time
            return _along(other, normals) * own + _along(wall, normals) * wall.acceleration
        speed = wall.speed + other.speed + other.angular_speed * reach
        away = reach + (self.last - self.first) * speed
        turning = _turning(wall) * away + 2.0 * wall.angular_speed * speed
        return own + wall.acceleration + turning


def _turning(bound: MotionBounds) -> float:
    return bound.angular_acceleration + bound.angular_speed**2


def _along(bound: MotionBounds, normals: tuple[Array, Array]) -> float:
    """The part of the accelerations that can lie along a direction between two unit normals."""
    if bound.axis is None:
        return 1.0
    return min(1.0, max(length(cross(bound.axis, normal)) for normal in normals))


# How far to look ahead: a model of the gap that proposes times. Nothing here is trusted.

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
