"""A joint path proven to keep a clearance at every instant, or where it does not.

Every pair of pieces has the whole path as its first interval of time. An interval is proven by
bounding boxes and the greatest motion from its middle; where it has several pieces of the path, by
the distance in its middle; within one piece, by the distances at both ends and the accelerations in
between (`standoff.impact.search` has the argument). What is not proven is split.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from standoff.checks.numbers import not_negative, whole_number
from standoff.progress import Progress
from standoff.robots.certify_tolerances import ASKED_CLEARANCE, BRACKET, SHORTEST_STEP
from standoff.robots.limits import check_limits
from standoff.robots.motion_bounds import bends, least_speed, seen_from
from standoff.robots.motions import LinkFrames
from standoff.robots.paths import BoundedFunctionPath, JointPath, joint_path
from standoff.robots.proof import How, Names, PathCounts, PathProof, Span, Steps, Verdict, Witness
from standoff.robots.robot_model import RobotModel
from standoff.robots.sight import Middle, Separations, Sight, closing, some_of
from standoff.robots.watched import turned
from standoff.typing import Array, Bools, Ints

BATCH = 2048
"""Intervals that are looked at together, the earliest first: arrays of so many rows cost little
more than one row, and more would be looked at in vain behind a violation."""


def certify(
    robot: RobotModel,
    path: Any,
    clearance: float = ASKED_CLEARANCE,
    *,
    times: Any = None,
    max_steps: int = 1_000_000,
    workers: int = 1,
    progress: Progress | None = None,
) -> PathProof:
    """Prove that a robot on a joint path keeps a clearance at every instant.

    Raises TypeError, ValueError: a path with one waypoint, of another size, with NaN or outside the
    joints' limits; a function without its greatest speeds, or one that is faster; a negative
    clearance.

    Parameters
    ----------
    robot : Robot
    path : (n, nq) array, SciPy spline, or FunctionPath
        Waypoints, between which the joints move at constant velocities; a piecewise polynomial of
        time; or a function with its greatest speeds.
    clearance : float
        That all pairs must keep [length].
    times : (n,) array, optional
        Of the waypoints [s]; 0, 1, 2, ... if not given.
    max_steps : int
        Most intervals of pairs to look at.
    workers : int
        Threads that share the distances.
    progress : callable, optional
        Told how many intervals are proven, and of how many that are known.

    Returns
    -------
    PathProof
    """
    clearance = not_negative(clearance, "clearance")
    whole_number(max_steps, "max_steps")
    whole_number(workers, "workers")
    read = joint_path(path, robot.kinematics, times)
    search = _PathSearch(Sight(robot, workers), read, clearance, max_steps)
    return search.run(progress)


FEW = 64
"""Intervals of which so few are left are halved `DEEPER` times at once: a round takes as long for
one as for hundreds."""
DEEPER = 2


class _PathSearch:
    def __init__(self, sight: Sight, path: JointPath, clearance: float, budget: int) -> None:
        self.sight, self.path = sight, path
        self.clearance, self.budget = clearance, budget
        motions = sight.watched.motions
        self.speeds = motions.rates(path.piece_speeds)
        ways = self.speeds * np.diff(path.breaks)[:, None]
        self.gone = np.concatenate([np.zeros((1, ways.shape[1])), np.cumsum(ways, axis=0)])
        (begin,) = path.at(np.array([path.start]))
        self._at(path.extremes())
        self._check_kinematics()
        latest = max(abs(path.start), abs(path.end))
        self.doubt = sight.roundoff(
            begin, self.gone[-1], latest, float(self.speeds.max(initial=0.0))
        )
        self.least = SHORTEST_STEP * (path.end - path.start)
        self.tried = 0
        self.violation: tuple[float, int, Separations] | None = None
        self.proven: list[tuple[Intervals, Array, How]] = []
        self.brackets: list[Intervals] = []
        self.stuck: list[Intervals] = []
        self.vague = np.zeros(sight.pairs, dtype=bool)

    def _check_kinematics(self) -> None:
        """Hold the joints as read against the package: bounds alone may prove a whole path."""
        times = np.array([self.path.start, 0.5 * (self.path.start + self.path.end), self.path.end])
        q, frames, at = self._at(times)
        for k in at.tolist():
            self.sight.placed(q[k], frames, k)

    # --- the whole ----------------------------------------------------------------------------

    def run(self, progress: Progress | None) -> PathProof:
        waiting = self._whole()
        done = 0
        while len(waiting.pairs) and self.tried < self.budget:
            order = np.argsort(waiting.first, kind="stable")
            now, later = waiting.some(order[:BATCH]), waiting.some(order[BATCH:])
            self.tried += len(now.pairs)
            left = self._tried(now)
            done += len(now.pairs) - len(left.pairs)
            waiting = self._before_the_end(joined([self._split(left), later]))
            if progress is not None:
                progress(done, done + len(waiting.pairs))
        return self._answer(waiting)

    def _whole(self) -> Intervals:
        n, pieces = self.sight.pairs, len(self.path.breaks) - 1
        return Intervals(
            np.arange(n),
            np.full(n, self.path.start),
            np.full(n, self.path.end),
            np.tile([0, pieces], (n, 1)),
            np.full((n, 5), np.nan),
            np.full((n, 5), np.nan),
            np.full(n, np.inf),
        )

    def _before_the_end(self, waiting: Intervals) -> Intervals:
        """What begins before the first instant that is known to be bad."""
        end = math.inf if self.violation is None else self.violation[0]
        return waiting.some(waiting.first < end)

    # --- some intervals -----------------------------------------------------------------------

    def _tried(self, now: Intervals) -> Intervals:
        """Try to prove some intervals; what is left of them."""
        middles = self._middles(now)
        q, frames, at = self._at(middles)
        ways = self._ways(now, middles)
        middle = self.sight.middle(now.pairs, frames, at, ways)
        boxes = self.sight.by_boxes(now.pairs, frames, at, middle)
        bound = boxes.lower - closing(middle, boxes)
        left = self._note(now, bound, How.FAR)
        now, at, middle = now.some(left), at[left], some_of(middle, left)
        several = now.pieces[:, 1] - now.pieces[:, 0] > 1
        wide, narrow = np.flatnonzero(several), np.flatnonzero(~several)
        parts = [
            self._reached(now.some(wide), (q, frames, at[wide]), some_of(middle, wide)),
            self._chords(now.some(narrow), some_of(middle, narrow)),
        ]
        return joined(parts)

    def _reached(
        self, now: Intervals, where: tuple[Array, LinkFrames, Ints], middle: Middle
    ) -> Intervals:
        """Intervals over several pieces of the path: by the distance in their middle, if it can be
        enough."""
        ask = np.flatnonzero(middle.way < now.near - self.clearance)
        if not len(ask):
            return now
        q, frames, at = where
        asked, asking = now.some(ask), some_of(middle, ask)
        apart = self.sight.ask(asked.pairs, q, frames, at[ask])
        self._notice(asked.pairs, self._middles(asked), apart)
        bound = apart.lower - closing(asking, apart)
        near = now.near.copy()
        near[ask] = apart.upper + asking.way
        left = self._note(asked, bound, How.REACH)
        rest = np.ones(len(now.pairs), dtype=bool)
        rest[ask[~left]] = False
        return now._replace(near=near).some(rest)

    def _chords(self, now: Intervals, middle: Middle) -> Intervals:
        """Intervals within one piece of the path: by the distances at their ends."""
        if not len(now.pairs):
            return now
        q, frames, at = self._at(np.concatenate([now.first, now.last]))
        n = len(now.pairs)
        ends = at[:n], at[n:]
        before, after = self._asked(now, (q, frames, at))
        now = now._replace(before=before, after=after)
        sag = self._sags(now, frames, ends, middle)
        bound = lowest(before[:, 0] - self.clearance, after[:, 0] - self.clearance, sag)
        straight = 0.5 * (before[:, 0] + after[:, 0]) - self.clearance
        straight -= 0.5 * self._speed(now, middle) * (now.last - now.first)
        bound = np.maximum(bound, straight) + self.clearance
        return now.some(self._note(now, bound, How.CHORD))

    def _asked(self, now: Intervals, where: tuple[Array, LinkFrames, Ints]) -> tuple[Array, Array]:
        """What is known at the ends of the intervals, after asking where nothing was."""
        q, frames, at = where
        known = np.concatenate([now.before, now.after])
        ask = np.flatnonzero(np.isnan(known[:, 0]))
        if len(ask):
            pairs = np.concatenate([now.pairs, now.pairs])[ask]
            apart = self.sight.ask(pairs, q, frames, at[ask])
            self._notice(pairs, np.concatenate([now.first, now.last])[ask], apart)
            known[ask] = np.column_stack([apart.lower, apart.upper, apart.normals])
        return known[: len(now.pairs)], known[len(now.pairs) :]

    def _rates(self, now: Intervals, middle: Middle) -> tuple[Array, Array | None]:
        """Speeds and accelerations of the motions on each pair's chain, in the interval."""
        watched = self.sight.watched
        speeds, gains = self.path.speeds(now.first, now.last, now.pieces[:, 0])
        rates = watched.motions.rates(speeds)
        chain = middle.reaches.chain
        on_chain = np.take_along_axis(rates, chain, axis=1)
        if gains is None:
            return on_chain, None
        swerves = watched.motions.rates(gains) + watched.motions.swerves(rates)
        return on_chain, np.take_along_axis(swerves, chain, axis=1)

    def _speed(self, now: Intervals, middle: Middle) -> Array:
        return least_speed(middle.reaches, self._rates(now, middle)[0]).bound

    def _sags(
        self, now: Intervals, frames: LinkFrames, ends: tuple[Ints, Ints], middle: Middle
    ) -> Array:
        """How far below their chord the separations may sag: S of ``standoff.impact.search``, seen
        from the link where it is least; infinite of solids, which no plane need part."""
        rates, gains = self._rates(now, middle)
        if gains is None:
            return np.full(len(now.pairs), np.inf)
        cut = seen_from(bends(middle.reaches, rates, gains), middle.reaches)
        watched = self.sight.watched
        carrier = watched.chains.frames[watched.chain[now.pairs], cut.place]
        normals, centres, axes = [], [], []
        for at, known in zip(ends, (now.before, now.after), strict=True):
            turn = frames.rotations[at, carrier]
            back = np.swapaxes(turn, 1, 2)
            both = [watched.see(frames, at, p[now.pairs]) for p in (watched.a, watched.b)]
            normals.append(turned(back, known[:, 2:]))
            between = both[1].centres - both[0].centres
            centres.append(turned(back, between))
            axes.append([back @ each.axes for each in both])
        planes = watched.cores.planes
        endless = planes[watched.a[now.pairs]] | planes[watched.b[now.pairs]]
        turn = np.where(endless[:, None], 0.0, normals[1] - normals[0])
        total = np.einsum("ki,ki->k", turn, centres[1] - centres[0])
        for side in range(2):
            change = np.einsum("ki,kij->kj", turn, axes[1][side] - axes[0][side])
            total += np.einsum("kj,kj->k", np.abs(change), middle.half[side])
        span = now.last - now.first
        found: Array = total + 0.5 * span * span * cut.bound + self.doubt
        return np.where(self.sight.solid[now.pairs], np.inf, found)

    # --- times --------------------------------------------------------------------------------

    def _middles(self, now: Intervals) -> Array:
        """Where the intervals are split: between two pieces of the path, or halfway in one."""
        first, last = now.pieces.T
        breaks = self.path.breaks[(first + last) // 2]
        found: Array = np.where(last - first > 1, breaks, 0.5 * (now.first + now.last))
        return found

    def _at(self, times: Array) -> tuple[Array, LinkFrames, Ints]:
        """(configurations, frames, number of each time's) at times, each once."""
        unique, at = np.unique(times, return_inverse=True)
        q = self.path.at(unique)
        check_limits(self.sight.robot, q, "path", unique)
        if isinstance(self.path, BoundedFunctionPath):
            self.path.check_speeds(unique, q, self.sight.watched.motions)
        return q, self.sight.frames(q), at.reshape(-1)

    def _ways(self, now: Intervals, middles: Array) -> Array:
        """(n, nm + 1): how far each motion goes from the middle of an interval, at most."""
        several = now.pieces[:, 1] - now.pieces[:, 0] > 1
        at_first, at_middle, at_last = map(self._gone, (now.first, middles, now.last))
        found = np.maximum(at_middle - at_first, at_last - at_middle)
        inside = np.flatnonzero(~several)
        if len(inside):
            part = now.some(inside)
            speeds = self.path.speeds(part.first, part.last, part.pieces[:, 0])[0]
            half = np.maximum(middles[inside] - part.first, part.last - middles[inside])
            found[inside] = self.sight.watched.motions.rates(speeds) * half[:, None]
        return found

    def _gone(self, times: Array) -> Array:
        """(n, nm + 1): ways of the motions from the path's start."""
        k = np.clip(
            np.searchsorted(self.path.breaks, times, side="right") - 1, 0, len(self.speeds) - 1
        )
        found: Array = self.gone[k] + self.speeds[k] * (times - self.path.breaks[k])[:, None]
        return found

    # --- what is known ------------------------------------------------------------------------

    def _note(self, now: Intervals, bound: Array, how: How) -> Bools:
        """Keep what is proven: the rest is left."""
        proven = bound - self.clearance > self.doubt
        if proven.any():
            self.proven.append((now.some(proven), bound[proven] - self.doubt, how))
        return ~proven

    def _notice(self, pairs: Ints, times: Array, apart: Separations) -> None:
        """Keep the first instant at which a pair is proven to be nearer than the clearance."""
        bad = np.flatnonzero(apart.upper + self.doubt < self.clearance)
        if not len(bad):
            return
        k = int(bad[np.argmin(times[bad])])
        if self.violation is None or times[k] < self.violation[0]:
            one = Separations._make(each[k : k + 1] for each in apart)
            self.violation = float(times[k]), int(pairs[k]), one

    def _split(self, left: Intervals) -> Intervals:
        """Parts of what is left; what is too short is put aside. Of a pair that has undecided
        instants the proof is lost: only a violation is sought on, by longer steps."""
        known = left.after[:, 1] + self.doubt < self.clearance
        long = known | self.vague[left.pairs]
        short = left.last - left.first <= np.where(long, BRACKET / SHORTEST_STEP, 1.0) * self.least
        short &= left.pieces[:, 1] - left.pieces[:, 0] == 1
        if short.any():
            self.brackets.append(left.some(short & known))
            self.stuck.append(left.some(short & ~known))
            self.vague[self.stuck[-1].pairs] = True
            left = left.some(~short)
        for _ in range(1 if len(left.pairs) > FEW else DEEPER):
            left = self._halved(left)
        return left

    def _halved(self, left: Intervals) -> Intervals:
        middles = self._middles(left)
        several = left.pieces[:, 1] - left.pieces[:, 0] > 1
        place = (left.pieces[:, 0] + left.pieces[:, 1]) // 2
        none = np.full((len(left.pairs), 5), np.nan)
        early, late = left.pieces.copy(), left.pieces.copy()
        early[several, 1], late[several, 0] = place[several], place[several]
        return joined(
            [
                left._replace(last=middles, pieces=early, after=none),
                left._replace(first=middles, pieces=late, before=none),
            ]
        )

    def _answer(self, waiting: Intervals) -> PathProof:
        vague = self._before_the_end(joined([*self.stuck, waiting]))
        names = [self.sight.names(k) for k in range(self.sight.pairs)]
        steps = steps_of(self.proven, names)
        counts = PathCounts(
            self.sight.pairs,
            len(steps.start),
            self.tried,
            self.sight.configurations,
            self.sight.queries,
        )
        time, latest, witness = self._end(joined([*self.brackets, vague]))
        verdict = Verdict.PROVEN
        if witness is not None:
            verdict = Verdict.UNDECIDED if self.violation is None else Verdict.VIOLATED
        return PathProof(
            verdict=verdict,
            clearance=self.clearance,
            start=self.path.start,
            end=self.path.end,
            time=time,
            latest=latest,
            witness=witness,
            undecided=spans_of(vague, names, self.path.end if math.isnan(latest) else latest),
            proven=float(steps.bound.min(initial=math.inf)) if witness is None else math.nan,
            counts=counts,
            steps=steps,
        )

    def _end(self, left: Intervals) -> tuple[float, float, Witness | None]:
        """(proven until, proven to be violated at, the pair there) by what is not proven."""
        if self.violation is not None:
            latest, pair, apart = self.violation
            (q,) = self.path.at(np.array([latest]))
            time = min(float(left.first.min(initial=math.inf)), latest)
            return time, latest, self.sight.witness(pair, q, apart)
        if not len(left.pairs):
            return self.path.end, math.nan, None
        k = int(np.argmin(left.first))
        q, frames, at = self._at(left.first[k : k + 1])
        apart = self.sight.ask(left.pairs[k : k + 1], q, frames, at)
        return float(left.first[k]), math.nan, self.sight.witness(int(left.pairs[k]), q[0], apart)


# Intervals of time of single pairs, and what is proven of them.


class Intervals(NamedTuple):
    """Intervals of time of single pairs that are not proven yet: n rows.

    Attributes
    ----------
    pairs : (n,) array of int
    first, last : (n,) arrays
        Its ends [s].
    pieces : (n, 2) array of int
        The first of the path's pieces that it has a part in, and the one behind the last.
    before, after : (n, 5) arrays
        At its ends the certified distance's lower bound, upper bound, and normal; nan where it has
        not been asked.
    near : (n,) array
        The pair is no farther apart anywhere in it, as far as is known [length].
    """

    pairs: Ints
    first: Array
    last: Array
    pieces: Ints
    before: Array
    after: Array
    near: Array

    def some(self, which: Any) -> Intervals:
        """Some of the rows."""
        return Intervals(*(each[which] for each in self))


def lowest(before: Array, after: Array, sag: Array) -> Array:
    """(n,): the least of (1-λ) L0 + λ L1 - λ(1-λ) S for λ in [0, 1]; -inf where an end is not
    positive, as beside it nothing is proven."""
    least = np.minimum(before, after)
    with np.errstate(invalid="ignore", divide="ignore"):
        dip = before - (sag + before - after) ** 2 / (4.0 * sag)
        found = np.where(sag > np.abs(before - after), dip, least)
    return np.where((least > 0.0) & np.isfinite(sag), found, -np.inf)


def joined(parts: Sequence[Intervals]) -> Intervals:
    """All rows."""
    return Intervals(*(np.concatenate(each) for each in zip(*parts, strict=True)))


def spans_of(some: Intervals, names: Sequence[Names], end: float) -> tuple[Span, ...]:
    """Intervals up to an end; those of two bodies that follow each other are one."""
    found: list[Span] = []
    owners = [names[pair] for pair in some.pairs.tolist()]
    for own, first, last in sorted(
        zip(owners, some.first.tolist(), some.last.tolist(), strict=True)
    ):
        if found and found[-1].names == own and first <= found[-1].end:
            found[-1] = found[-1]._replace(end=max(min(last, end), found[-1].end))
        else:
            found.append(Span(first, min(last, end), own))
    return tuple(sorted(found))


def steps_of(proven: Sequence[tuple[Intervals, Array, How]], names: Sequence[Names]) -> Steps:
    """The steps of a proof: intervals, their bounds, and what proved them."""
    rows = [(some, bound, how) for some, bound, how in proven if len(bound)]
    if not rows:
        none = np.zeros(0)
        return Steps(none, none, none.astype(int), none, none.astype(int), tuple(names))
    some, bounds, hows = zip(*rows, strict=True)
    every = joined(some)
    how = np.repeat([each.value for each in hows], [len(each.pairs) for each in some])
    order = np.argsort(every.first, kind="stable")
    found = Steps(
        start=every.first[order],
        end=every.last[order],
        pair=every.pairs[order],
        bound=np.concatenate(bounds)[order],
        how=how[order],
        names=tuple(names),
    )
    for array in found[:5]:
        array.flags.writeable = False
    return found
