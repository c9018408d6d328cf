"""Every pair of every frame of a drawn world, judged against the truth of its pieces."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import standoff as so
from standoff.kernels.world.pairs import KEPT_BEYOND
from standoff.tracking.status import Status
from standoff.typing import Array
from standoff.world.answer import WorldAnswer
from standoff.world.state import WorldState
from standoff_studies.soak.checks import PROVEN
from standoff_studies.soak.drawn_worlds import Chapter, draw_world
from standoff_studies.soak.tally import Tally
from standoff_studies.soak.world_truth import NONE, Pieces, Truth, ask, bounds_of, placed_pieces

Ints = NDArray[np.int64]

CONVERGED, GLOBAL, LOCAL = Status.CONVERGED.value, Status.GLOBAL.value, Status.LOCAL.value
UNKNOWN = Status.NOT_CERTIFIED.value

BOX_PART = 2.0
"""Half a body's own box, as a multiple of the radius by support functions: boxes of curved bodies
are bounds."""

PADDED_PART = 8.0
"""Half a padded box's diagonal, as a multiple of that radius: its pad is at most twice its half,
along each axis, and its piece may stand at its rim."""


class WorldFault(NamedTuple):
    """A failed check of a frame; `pair` is empty where it is of the whole frame."""

    chapter: int
    frame: int
    pair: tuple[str, ...]
    what: str
    value: float
    allowed: float


class Told(NamedTuple):
    """What a world said of all pairs that count, (m, g) each; of FAR ones distance is inf."""

    distance: Array
    lower: Array
    upper: Array
    status: Ints
    near: NDArray[np.bool_]


def run_world(seed: int, number: int, frames: int) -> tuple[Tally, list[WorldFault]]:
    """Draw a world, answer its frames, and judge all pairs of all of them."""
    tally, faults = Tally(), []
    tally.count("worlds", 1)
    last = None
    for k, chapter in enumerate(draw_world(seed, number, frames)):
        states = answered(chapter, last)
        last = chapter.world, states[-1]
        answers = [chapter.world.answer(state) for state in states]
        found = judge(chapter, answers, tally)
        faults += [fault._replace(chapter=k) for fault in found]
    return tally, faults


def answered(chapter: Chapter, last: tuple[so.World, WorldState] | None = None) -> list[WorldState]:
    """The states of all frames; the first from the last one of another chapter, or from nothing."""
    world, flight = chapter.world, chapter.flight
    rows = world.model.moving_rows
    poses = flight.poses[:, rows]
    twists = [None] * len(poses) if flight.twists is None else list(flight.twists[:, rows])
    if last is None:
        states = [world.start(poses[0], twists[0])]
    else:
        states = [world.start_from(*last, dict(zip(world.moving, poses[0], strict=True)))]
    for k in range(1, len(poses)):
        h, workers = float(flight.steps[k]), int(flight.workers[k])
        states.append(world.step(states[-1], poses[k], twists[k], h, workers=workers)[0])
    return states


def judge(chapter: Chapter, answers: list[WorldAnswer], tally: Tally) -> list[WorldFault]:
    """What is wrong with answers, after all frames are made: their states must have lasted."""
    pieces = placed_pieces(chapter)
    checks = _Checks(chapter, answers)
    checks.same_again()
    truth = bounds_of(chapter, pieces)
    g, m = len(chapter.counted), len(answers)
    tally.count("chapters", 1)
    tally.count("frames", m)
    tally.count("pair-frames", m * g)
    if g:
        told = checks.told()
        cold = ask(pieces, truth, checks.doubtful(truth, told))
        tally.count("cold queries", cold)
        tally.count("near pair-frames", int(told.near.sum()))
        tally.count("near pair-frames in penetration", int((told.near & (told.distance < 0)).sum()))
        tally.count("uncertified", int((told.near & ~_proven(told.status)).sum()))
        checks.bounds(truth, told)
        checks.distances(truth, told)
        checks.nearest(truth, told)
        checks.minima(truth, tally)
        checks.memory(pieces, truth)
    else:
        checks.nothing()
    for answer in answers:
        for name in ("tracked", "started", "resting", "sought"):
            tally.count(f"pairs or pieces {name}", getattr(answer.counts, name))
    return checks.faults


def _proven(status: Ints) -> NDArray[np.bool_]:
    return np.asarray((status == CONVERGED) | (status == GLOBAL))


class _Checks:
    """The checks of a chapter in progress."""

    def __init__(self, chapter: Chapter, answers: list[WorldAnswer]) -> None:
        self.chapter, self.answers = chapter, answers
        self.names = list(chapter.world.bodies)
        n = len(self.names)
        self.number = {i * n + j: k for k, (i, j) in enumerate(chapter.counted.tolist())}
        self.faults: list[WorldFault] = []

    def fail(self, what: str, frame: int, value: Any, allowed: Any, group: int = -1) -> None:
        pair = (self.names[k] for k in self.chapter.counted[group]) if group >= 0 else ()
        self.faults.append(WorldFault(0, frame, tuple(pair), what, float(value), float(allowed)))

    def expect(self, what: str, value: Any, allowed: Any, where: Any = True) -> None:
        """Note the first frame and pair, (m, g), where a value is above what is allowed."""
        wrong = np.argwhere(~(value <= allowed) & where)
        if len(wrong):
            f, k = wrong[0].tolist()
            limit = np.broadcast_to(allowed, value.shape)[f, k]
            self.fail(what, f, value[f, k], limit, k)

    def told(self) -> Told:
        """Read the answers of all pairs; the pairs that are listed must count."""
        m, g = len(self.answers), len(self.chapter.counted)
        found = Told(
            np.full((m, g), np.inf),
            np.empty((m, g)),
            np.full((m, g), np.inf),
            np.full((m, g), Status.FAR.value),
            np.zeros((m, g), dtype=bool),
        )
        pairs = [(self.names[i], self.names[j]) for i, j in self.chapter.counted.tolist()]
        for f, answer in enumerate(self.answers):
            bodies = np.sort(answer.pairs.bodies, axis=1)
            keys = (bodies[:, 0] * len(self.names) + bodies[:, 1]).tolist()
            at = [self.number.get(key, -1) for key in keys]
            if -1 in at or len(set(at)) != len(at):
                self.fail("a pair that does not count, or one twice", f, 1.0, 0.0)
                continue
            found.near[f, at] = True
            found.distance[f, at] = answer.pairs.distance
            found.lower[f, at], found.upper[f, at] = (
                answer.pairs.lower_bound,
                answer.pairs.upper_bound,
            )
            found.status[f, at] = [one.value for one in answer.pairs.status]
            for k in np.flatnonzero(~found.near[f]).tolist():
                one = answer[pairs[k]]
                found.lower[f, k] = one.lower_bound
                if not one.far:
                    self.fail("not listed, but not FAR", f, one.distance, np.inf, k)
        return found

    def doubtful(self, truth: Truth, told: Told) -> NDArray[np.bool_]:
        """Which pairs of pieces the support functions do not settle."""
        sizes = np.diff([*truth.first, len(truth.a)])
        needed = np.maximum(self.chapter.horizons, told.lower)
        needed = np.where(told.near, np.maximum(needed, told.upper), needed)
        least = np.minimum.reduceat(truth.upper, truth.first, axis=1)
        most = np.maximum(least, np.minimum(self.chapter.minima, needed))
        limit = np.repeat(np.minimum(needed, most), sizes, axis=1)
        return np.asarray(truth.lower <= limit + truth.noise)

    def bounds(self, truth: Truth, told: Told) -> None:
        """None is missed below its horizon; no bound is above the truth; none claims too much."""
        upper = np.minimum.reduceat(truth.upper, truth.first, axis=1)
        lower = np.minimum.reduceat(truth.lower, truth.first, axis=1)
        noise = np.maximum.reduceat(truth.noise, truth.first, axis=1)
        gap = np.maximum.reduceat(truth.gap, truth.first, axis=1)
        horizons = np.broadcast_to(self.chapter.horizons, upper.shape)
        self.expect("a pair below its horizon is missed", horizons - upper, noise, ~told.near)
        self.expect("the lower bound is above the distance", told.lower - upper, noise)
        self.expect("the upper bound is below the distance", lower - told.upper, noise)
        self.expect("listed, but beyond its horizon", lower - horizons, gap, told.near)
        clearances = np.array([answer.clearance for answer in self.answers])[:, None]
        self.expect("the clearance is above a distance", clearances - upper, noise)
        self.expect("the clearance is above a bound", clearances - told.lower, 0.0 * noise)
        self.expect(
            "the clearance is beyond all horizons", clearances, np.max(horizons, keepdims=True)
        )
        floor = np.minimum(told.lower.min(axis=1), horizons.max())[:, None]
        loose = floor - clearances
        # of FAR pairs the boxes may say more when they are asked than the table did
        self.expect("the clearance is less than every bound", loose, 0.0 * loose, told.near.all())

    def distances(self, truth: Truth, told: Told) -> None:
        """Each listed distance is the least of the pieces', as far as both are proven."""
        known = truth.status != NONE
        each = np.where(known, truth.distance, np.inf)
        least = np.minimum.reduceat(each, truth.first, axis=1)
        sound = np.where(known, _proven(truth.status), True)
        proven = np.minimum.reduceat(sound, truth.first, axis=1) & _proven(told.status)
        gap = np.maximum.reduceat(truth.gap, truth.first, axis=1)
        with np.errstate(invalid="ignore"):
            off = np.abs(told.distance - least)
            allowed = gap + PROVEN * np.maximum(0.0, -np.minimum(least, told.distance))
        self.expect("the distance is not that of a query", off, allowed, told.near & proven)
        numbers = np.isfinite(told.distance) & ~np.isnan(told.lower)
        self.expect("a number that is none", 1.0 - numbers, 0.0 * gap, told.near)

    def nearest(self, truth: Truth, told: Told) -> None:
        """`closest` is the least of the listed, and the pieces named are the nearest."""
        each = np.where(truth.status != NONE, truth.distance, np.inf)
        ends = [*truth.first[1:].tolist(), len(truth.a)]
        parts = self.chapter.parts
        several = [
            k for k, (i, j) in enumerate(self.chapter.counted) if len(parts[i]) * len(parts[j]) > 1
        ]
        for f, answer in enumerate(self.answers):
            closest, least = answer.closest, told.distance[f].min()
            if (closest is None) != (not told.near[f].any()):
                self.fail("closest is missing, or of no pair", f, least, np.inf)
            elif closest is not None and closest.distance != least:
                self.fail("closest is not the least", f, closest.distance, least)
            for k in several:
                if not told.near[f, k]:
                    continue
                i, j = self.chapter.counted[k]
                one = answer[self.names[i], self.names[j]]
                if one.distance != told.distance[f, k]:
                    self.fail(
                        "one pair and its row differ", f, one.distance, told.distance[f, k], k
                    )
                at = truth.first[k] + self._piece(i, j, one.pieces)
                wanted = each[f, truth.first[k] : ends[k]].min()
                slack = truth.gap[f, at] + PROVEN * max(0.0, -wanted)
                proven = one.certified and _proven(truth.status[f, at : at + 1])[0]
                if proven and each[f, at] - wanted > slack:
                    self.fail("the pieces named are not the nearest", f, each[f, at], wanted, k)

    def _piece(self, i: int, j: int, names: tuple[str, str]) -> int:
        """Where a pair of pieces stands among those of its bodies."""
        rows = [[part.name for part in self.chapter.parts[x]] for x in (i, j)]
        return rows[0].index(names[0]) * len(rows[1]) + rows[1].index(names[1])

    def minima(self, truth: Truth, tally: Tally) -> None:
        """All pairs of pieces below `minima` are there, with their own distances."""
        if self.chapter.minima == -np.inf:
            return
        ends = [*truth.first[1:].tolist(), len(truth.a)]
        for k, (i, j) in enumerate(self.chapter.counted.tolist()):
            if ends[k] - truth.first[k] < 2:
                continue
            pieces = range(int(truth.first[k]), ends[k])
            limit = min(self.chapter.minima, self.chapter.horizons[k])
            for f, answer in enumerate(self.answers):
                kept = answer.minima((self.names[i], self.names[j]))
                there = {truth.first[k] + self._piece(i, j, x.pieces): x.distance for x in kept}
                tally.count("minima", len(there))
                for at in pieces:
                    true, gap = truth.distance[f, at], truth.gap[f, at]
                    if at not in there and true < limit - gap:
                        self.fail("a local minimum is missing", f, true, limit, k)
                    elif at in there and _proven(truth.status[f, at : at + 1])[0]:
                        off = abs(there[at] - true)
                        loose = gap + PROVEN * max(0.0, -true)
                        one = next(x for x in kept if x.distance == there[at])
                        if one.certified and off > loose:
                            self.fail("a local minimum is none", f, off, loose, k)

    def memory(self, pieces: Pieces, truth: Truth) -> None:
        """What is kept grows with the pairs that are near."""
        radii = np.array([extent.radius for extent in pieces.extents])
        away = np.linalg.norm(pieces.centres[:, truth.b] - pieces.centres[:, truth.a], axis=2)
        both = radii[truth.a] + radii[truth.b]
        reach = max(self.chapter.horizons.max(), self.chapter.world.model.search.reach)
        for f, answer in enumerate(self.answers):
            state = answer.state
            open_, table = answer.counts.open, len(state.ints)
            kept = int(np.count_nonzero(away[f] - (BOX_PART + KEPT_BEYOND) * both <= 1.01 * reach))
            if open_ > kept:
                self.fail("more pairs open than near", f, open_, kept)
            rows = sum(len(page) for page in state.pages)
            if rows > 2 * open_:
                self.fail("rows kept that no pair has", f, rows, 2 * open_)
            found = np.count_nonzero(away[f] - PADDED_PART * both <= 1.01 * reach)
            # a pair goes when one of its pieces leaves its padded box, at the latest
            if f == 0 and table > found:
                self.fail("more pairs in the table than near", f, table, found)
            if state.repaired:
                self.fail("a pose was repaired", f, state.repaired, 0.0)

    def nothing(self) -> None:
        """Where no pair counts, none is listed, and the clearance is the horizon."""
        for f, answer in enumerate(self.answers):
            if len(answer.pairs) or answer.closest is not None:
                self.fail("a pair that does not count", f, len(answer.pairs), 0.0)

    def same_again(self) -> None:
        """A step from an old state is what it was, to the last bit, with other workers."""
        answers, flight = self.answers, self.chapter.flight
        if len(answers) < 3:
            return
        rows = self.chapter.world.model.moving_rows
        for k in (1, len(answers) // 2):
            twists = None if flight.twists is None else flight.twists[k][rows]
            _, again = self.chapter.world.step(
                answers[k - 1].state,
                flight.poses[k][rows],
                twists,
                float(flight.steps[k]),
                workers=3 - int(flight.workers[k]),
            )
            if not _same(answers[k], again):
                self.fail("a step from an old state differs", k, 1.0, 0.0)


def _same(one: WorldAnswer, other: WorldAnswer) -> bool:
    names: tuple[Any, ...] = ("bodies", "distance", "lower_bound", "upper_bound", "point_a", "rate")
    known = np.array_equal(one.state.known[:, :3], other.state.known[:, :3], equal_nan=True)
    return known and all(
        np.array_equal(getattr(one.pairs, name), getattr(other.pairs, name), equal_nan=True)
        for name in names
    )
