"""The first time at which any pair of a world comes to its clearance."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from standoff.bodies.body import Body
from standoff.checks.names import did_you_mean, one_of
from standoff.checks.numbers import number, positive
from standoff.errors import StandoffError, StandoffTypeError
from standoff.impact import Impact, time_of_impact
from standoff.impact.answer import ImpactStatus
from standoff.motion.moving import MotionLike, moving
from standoff.motion.paths import Fixed, Offset
from standoff.motion.pose import Pose
from standoff.world.compound import Compound
from standoff.world.model import Model
from standoff.world.poses import check_names

OPTIONS = frozenset(("clearance", "tolerance", "start", "max_evaluations"))
"""Of ``so.time_of_impact``, for every pair."""


@dataclass(frozen=True)
class WorldImpact:
    """The first time at which a pair of a world's bodies comes to its clearance, never late.

    Attributes
    ----------
    time : float
        Up to it all pairs are proven to keep the clearance [s].
    status : ImpactStatus
        NO_IMPACT where all pairs keep it to the end.
    names : (str, str) or None
        The pair that comes first; None where none does.
    pieces : (str, str)
        Its pieces, by name; empty for a body that is no compound.
    impact : Impact or None
        Of that pair of pieces.
    searched : int
        Number of pairs of pieces that were searched.
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
    """See ``World.time_of_impact``: each pair is searched up to the earliest time found so far.

    Raises
    ------
    StandoffError
        A path that is missing, or as ``so.time_of_impact``, with the names of the pair.
    """
    check_names(paths, world.moving, "paths")
    given = {name: moving(paths[name], f"paths[{name!r}]") for name in world.moving}
    for name, matrix in zip(world.fixed, world.poses_of_fixed, strict=True):
        given[name] = Fixed(Pose.of(matrix))
    duration, start = positive(duration, "duration"), number(options.get("start", 0.0), "start")
    for name in options.keys() - OPTIONS:
        raise StandoffTypeError(
            f"time_of_impact has no option {name!r}.{did_you_mean(name, OPTIONS)} It has "
            f"{one_of(sorted(OPTIONS))}.",
            name,
            options[name],
        )
    found = WorldImpact(start + duration, ImpactStatus.NO_IMPACT, None, ("", ""), None, 0)
    searched = 0
    for a, b in pairs_that_count(world):
        for piece_a, body_a, path_a in _pieces(world, a, given[a]):
            for piece_b, body_b, path_b in _pieces(world, b, given[b]):
                left = found.time - start
                if not left > 0.0:
                    break
                searched += 1
                try:
                    impact = time_of_impact(body_a, body_b, path_a, path_b, left, **options)
                except StandoffError as error:
                    told = f"The pair {(a, b)}: {error}"
                    raise type(error)(told, error.argument, error.value) from error
                if impact.status is not ImpactStatus.NO_IMPACT:
                    names, pieces = (a, b), (piece_a, piece_b)
                    found = WorldImpact(impact.time, impact.status, names, pieces, impact, 0)
    return WorldImpact(found.time, found.status, found.names, found.pieces, found.impact, searched)


def pairs_that_count(world: Model) -> Iterator[tuple[str, str]]:
    """The names of all pairs that count."""
    for i, j in itertools.combinations(range(len(world.listed)), 2):
        if world.search.rules.counts(i, j):
            yield world.listed[i][0], world.listed[j][0]


def _pieces(world: Model, name: str, path: Any) -> list[tuple[str, Body, Any]]:
    """(name, body, path) of each piece of a body."""
    body = world.listed[world.names.bodies[name]][1]
    if not isinstance(body, Compound):
        return [("", body, path)]
    return [(part, piece.body, Offset(path, piece.pose)) for part, piece in body.pieces.items()]
