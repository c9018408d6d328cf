"""The first time at which any pair of a world comes to its clearance."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

from standoff.checks.names import did_you_mean, one_of
from standoff.checks.numbers import positive, whole_number
from standoff.errors import StandoffError, StandoffTypeError
from standoff.impact import Impact, time_of_impact
from standoff.impact.answer import ImpactStatus
from standoff.impact.search import checked_clearance, checked_times
from standoff.motion.bounds import known
from standoff.motion.moving import MotionLike, moving
from standoff.motion.paths import Fixed, Offset
from standoff.motion.pose import Pose
from standoff.tracking.inputs import matrix_and_mark
from standoff.world.model import Model
from standoff.world.pieces import PieceUnion
from standoff.world.poses import check_level, check_names
from standoff.world.swept import Follower, meetings

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


class _Part(NamedTuple):
    """A piece of a body, and what follows its path."""

    name: str
    piece: str
    follower: Follower


def _parts(world: Model, name: str, path: Any, times: tuple[float, float]) -> list[_Part]:
    body: Any = world.listed[world.names.bodies[name]][1]
    with _named(f"paths[{name!r}]"):
        if not isinstance(body, PieceUnion):
            return [_Part(name, "", Follower(body, path, *times))]
        return [
            _Part(name, part, Follower(piece.body, Offset(path, piece.pose), *times))
            for part, piece in body.pieces.items()
        ]


def _searched(a: _Part, b: _Part, duration: float, options: Mapping[str, Any]) -> Impact:
    """The impact of two pieces."""
    first, second = a.follower, b.follower
    with _named(f"The pair {(a.name, b.name)}"):
        return time_of_impact(first.body, second.body, first.path, second.path, duration, **options)


def pairs_that_count(world: Model) -> Iterator[tuple[str, str]]:
    """The names of all pairs that count."""
    for i, (name, _) in enumerate(world.listed):
        for j in world.search.rules.partners(i).tolist():
            yield name, world.listed[j][0]
