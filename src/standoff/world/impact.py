"""The first time at which any pair of a world comes to its clearance."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from standoff.checks.names import did_you_mean, one_of
from standoff.checks.numbers import positive, whole_number
from standoff.errors import StandoffError, StandoffTypeError
from standoff.impact import Impact, time_of_impact
from standoff.impact.answer import ImpactStatus
from standoff.impact.moment import EPS, BodyAtInstant, BodyBox
from standoff.impact.search import checked_clearance, checked_times
from standoff.impact.tolerances import POSE_ROUNDINGS, TIME_ROUNDINGS
from standoff.motion.bounds import bounds_of, breaks_of, known
from standoff.motion.moving import MotionLike, moving
from standoff.motion.paths import Fixed, Offset
from standoff.motion.pose import Pose
from standoff.motion.vectors import length
from standoff.tracking.inputs import matrix_and_mark
from standoff.typing import Array, Ints
from standoff.world.broad_phase import BroadPhase, pairs_of_boxes
from standoff.world.model import Model
from standoff.world.pieces import PieceUnion
from standoff.world.poses import check_level, check_names

# Where the pieces of a world may be while their bodies follow paths: which pairs may meet.

MOST_SPANS = 32
"""Spans of time into which a search is divided at most: a piece has a box in each."""


class Follower:
    """A piece and the path of its frame, from one time to another [s].

    Attributes
    ----------
    body : Body, Solid or PlanarSolid
    path
        One that knows its bounds.
    rests : bool
        Does it stay where it is, from the first time to the last?
    """

    def __init__(self, body: Any, path: Any, first: float, last: float) -> None:
        self.body, self.path = body, path
        self._box, self._first = BodyBox(body), first
        self.rests = not breaks_of(path, first, last)
        if self.rests:
            bound = bounds_of(path, first, last, self._box.middle)
            self.rests = bound.speed == bound.angular_speed == 0.0

    def boxes(self, times: Array) -> Array:
        """Boxes (n - 1, 6) that hold the piece between each two times: low (3), high (3)."""
        if self._box.plane:
            return np.tile([-np.inf] * 3 + [np.inf] * 3, (len(times) - 1, 1))
        if self.rests:
            whole = self._between(float(times[0]), float(times[-1]))
            return np.tile(whole, (len(times) - 1, 1))
        return np.array([self._over(a, b) for a, b in itertools.pairwise(times.tolist())])

    def _over(self, first: float, last: float) -> Array:
        """A box between two times, over the breaks of the path."""
        stops = [first, *breaks_of(self.path, first, last), last]
        each = [self._between(a, b) for a, b in itertools.pairwise(stops)]
        low, high = np.array(each)[:, :3].min(axis=0), np.array(each)[:, 3:].max(axis=0)
        return np.concatenate([low, high])

    def _between(self, first: float, last: float) -> Array:
        """A box between two times without a break.

        The middle of the piece's own box goes no farther from its two places together than its way,
        and no farther from the chord than its acceleration bends it.
        """
        own, span = self._box, last - first
        ends = [BodyAtInstant(own.middle, self.path, time) for time in (first, last)]
        bound = bounds_of(self.path, first, last, own.middle)
        a, b = ends[0].centre, ends[1].centre
        middle, way = 0.5 * (a + b), 0.5 * bound.speed * span
        sag = 0.125 * bound.acceleration * span**2
        low = np.maximum(middle - way, np.minimum(a, b) - sag)
        high = np.minimum(middle + way, np.maximum(a, b) + sag)
        turned = bound.angular_speed * span * own.reach
        half = np.minimum(own.reach, np.abs(ends[0].rotation) @ own.half + turned) + own.radius
        # of the poses, of the time, and of the sums here
        lengths = own.reach + own.radius + length(own.middle) + bound.lengths + way
        lengths += sum(length(x) for end in ends for x in (end.p, end.centre))
        speed = bound.speed + bound.angular_speed * own.reach
        late = max(abs(first), abs(last)) * speed
        half = half + EPS * (POSE_ROUNDINGS * lengths + TIME_ROUNDINGS * late)
        return np.concatenate([low - half, high + half])

    def under(self, box: Array) -> float:
        """How far a box is above this half-space, at least (length); 0 of one that moves."""
        if not self.rests:
            return 0.0
        at = BodyAtInstant(self._box.middle, self.path, self._first)
        normal = at.rotation @ self._box.normal
        middle, half = 0.5 * (box[3:] + box[:3]), 0.5 * (box[3:] - box[:3])
        reach = float(np.abs(normal) @ half) + self._box.radius
        lengths = length(middle) + length(at.centre) + length(at.p) + reach
        height = float(normal @ (middle - at.centre)) - reach
        return height - POSE_ROUNDINGS * EPS * lengths


class Meeting(NamedTuple):
    """A pair of pieces that may come as near as they must not.

    Attributes
    ----------
    time : float
        Up to it they are proven not to [s].
    p, q : int
        Their numbers.
    """

    time: float
    p: int
    q: int


def meetings(
    search: BroadPhase, followers: Sequence[Follower], first: float, last: float, clearance: float
) -> list[Meeting]:
    """The pairs of pieces that may come within the clearance, or within their margin where that is
    more (length), in the order of the times at which they may.

    At first each piece has one box for all the time; where many are near each other, the time is
    divided.
    """
    found = _near(search, followers, np.array([first, last]), clearance)
    moving = sum(not each.rests for each in followers)
    spans = min(MOST_SPANS, len(found) // max(moving, 1))
    if spans > 1:
        found = _near(search, followers, np.linspace(first, last, spans + 1), clearance)
    return found


def _near(
    search: BroadPhase, followers: Sequence[Follower], times: Array, clearance: float
) -> list[Meeting]:
    boxes = np.stack([each.boxes(times) for each in followers], axis=1)
    reach = max(clearance, search.rules.greatest_margin)
    found: dict[tuple[int, int], float] = {}
    for time, now in zip(times, boxes, strict=False):
        pairs = pairs_of_boxes(search, now, reach)
        near = _gaps(search, followers, now, pairs) <= _required(search, pairs, clearance)
        for p, q in pairs[near].tolist():
            found.setdefault((p, q), float(time))
    return sorted(Meeting(time, *pair) for pair, time in found.items())


def _required(search: BroadPhase, pairs: Ints, clearance: float) -> Array:
    """What each pair of pieces must keep (length)."""
    i, j = search.pieces.owners[pairs.T]
    return np.maximum(search.rules.margins_of(i * len(search.rules.kinds) + j), clearance)


def _gaps(search: BroadPhase, followers: Sequence[Follower], boxes: Array, pairs: Ints) -> Array:
    """The distances of boxes, and heights above half-spaces, rounded down (length)."""
    a, b = boxes[pairs[:, 0]], boxes[pairs[:, 1]]
    apart = np.maximum(0.0, np.maximum(b[:, :3] - a[:, 3:], a[:, :3] - b[:, 3:]))
    gaps: Array = np.sqrt((apart**2).sum(axis=1)) * (1.0 - POSE_ROUNDINGS * EPS)
    planes = search.pieces.planes[pairs]
    for k in np.flatnonzero(planes.any(axis=1)).tolist():
        p, q = pairs[k] if planes[k, 0] else pairs[k, ::-1]
        gaps[k] = max(0.0, followers[p].under(boxes[q]))
    return gaps


OPTIONS = frozenset(("clearance", "tolerance", "start", "max_evaluations"))
"""Of ``so.time_of_impact``, for every pair."""


@dataclass(frozen=True)
class WorldImpact:
    """The first time at which a pair of a world's bodies comes to its clearance, never late.

    Attributes
    ----------
    time : float
        Up to it all pairs are proven to keep their clearance: the one that was given, or their
        margin where that is more [s].
    status : ImpactStatus
        NO_IMPACT where all pairs keep it to the end.
    names : (str, str) or None
        The pair that comes first; None where none does.
    pieces : (str, str)
        Its pieces, by name; empty for a body that is no compound.
    impact : Impact or None
        Of that pair of pieces.
    searched : int
        Number of pairs of pieces that were searched: the others cannot meet before ``time``.
    """

    time: float
    status: ImpactStatus
    names: tuple[str, str] | None
    pieces: tuple[str, str]
    impact: Impact | None
    searched: int


def first_impact(
    world: Model, paths: Mapping[str, MotionLike], duration: float, options: Mapping[str, Any]
) -> WorldImpact:
    """See ``World.time_of_impact``: pairs that may meet are searched in the order of the times at
    which they may, each up to the earliest time found so far.

    Raises StandoffError: a path that is missing, or as ``so.time_of_impact``, with the names of the
    body or the pair.
    """
    given, (start, end) = _checked(world, paths, duration, options)
    parts = [
        part
        for (name, _), path in zip(world.listed, given, strict=True)
        for part in _parts(world, name, path, (start, end))
    ]
    clearance = options.get("clearance", 0.0)
    rules, owners = world.search.rules, world.search.pieces.owners
    best = WorldImpact(end, ImpactStatus.NO_IMPACT, None, ("", ""), None, 0)
    searched = 0
    for meeting in meetings(world.search, [part.follower for part in parts], start, end, clearance):
        if not best.time > max(meeting.time, start):
            break
        searched += 1
        a, b = parts[meeting.p], parts[meeting.q]
        required = max(clearance, rules.margin(*owners[[meeting.p, meeting.q]].tolist()))
        found = _searched(a, b, best.time - start, {**options, "clearance": required})
        if found.status is not ImpactStatus.NO_IMPACT:
            names, pieces = (a.name, b.name), (a.piece, b.piece)
            best = WorldImpact(found.time, found.status, names, pieces, found, 0)
    return replace(best, searched=searched)


def _checked(
    world: Model, paths: Mapping[str, MotionLike], duration: float, options: Mapping[str, Any]
) -> tuple[list[Any], tuple[float, float]]:
    """(the path of each body, times at which the search begins and ends [s]).

    Raises StandoffError as ``so.time_of_impact``, also where no pair is searched; with the name of
    the body.
    """
    for name in options.keys() - OPTIONS:
        raise StandoffTypeError(
            f"time_of_impact has no option {name!r}.{did_you_mean(name, OPTIONS)} It has "
            f"{one_of(sorted(OPTIONS))}.",
            name,
            options[name],
        )
    start, end = checked_times((), options.get("start", 0.0), duration)
    checked_clearance(options.get("clearance", 0.0))
    positive(options.get("tolerance", 1.0), "tolerance")
    whole_number(options.get("max_evaluations", 2), "max_evaluations", 2)
    check_names(paths, world.moving, "paths")
    given = {}
    for name in world.moving:
        given[name] = moving(paths[name], f"paths[{name!r}]")
        with _named(f"paths[{name!r}]"):
            end = min(end, checked_times((known(given[name]),), start, duration)[1])
            if world.planar:
                places = [matrix_and_mark(given[name].pose(t))[0] for t in (start, end)]
                check_level([name, name], places, "paths")
    for name, matrix in zip(world.fixed, world.poses_of_fixed, strict=True):
        given[name] = Fixed(Pose.of(matrix))
    return [given[name] for name, _ in world.listed], (start, end)


@contextmanager
def _named(what: str) -> Iterator[None]:
    """Say in an error what it is of."""
    try:
        yield
    except StandoffError as error:
        raise type(error)(f"{what}: {error}", error.argument, error.value) from error


class _MovingPiece(NamedTuple):
    """A piece of a body, and what follows its path."""

    name: str
    piece: str
    follower: Follower


def _parts(world: Model, name: str, path: Any, times: tuple[float, float]) -> list[_MovingPiece]:
    body: Any = world.listed[world.names.bodies[name]][1]
    with _named(f"paths[{name!r}]"):
        if not isinstance(body, PieceUnion):
            return [_MovingPiece(name, "", Follower(body, path, *times))]
        return [
            _MovingPiece(name, part, Follower(piece.body, Offset(path, piece.pose), *times))
            for part, piece in body.pieces.items()
        ]


def _searched(
    a: _MovingPiece, b: _MovingPiece, duration: float, options: Mapping[str, Any]
) -> Impact:
    """The impact of two pieces."""
    first, second = a.follower, b.follower
    with _named(f"The pair {(a.name, b.name)}"):
        return time_of_impact(first.body, second.body, first.path, second.path, duration, **options)


def pairs_that_count(world: Model) -> Iterator[tuple[str, str]]:
    """The names of all pairs that count."""
    for i, (name, _) in enumerate(world.listed):
        for j in world.search.rules.partners(i).tolist():
            yield name, world.listed[j][0]
