"""The answer of two bodies of several pieces, from the answers of their pairs of pieces."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, Literal, NamedTuple

import numpy as np

from standoff.solids.answer import (
    MOST_OPEN,
    NearestPair,
    OpenPair,
    Overlap,
    SolidCounts,
    SolidProximity,
)
from standoff.solids.spatial.half_space import size_together
from standoff.solids.spatial.tolerances import PROOF_TOLERANCE
from standoff.tracking.derivatives import Smoothness
from standoff.tracking.status import Status


class OfPieces(NamedTuple):
    """What was found of a piece of A and one of B.

    Attributes
    ----------
    a, b : int
        Their numbers.
    names : (str, str)
        Theirs; empty for a body that is no compound.
    found : SolidProximity
    solids : (SolidModel or PlanarSolid, the same)
        The two pieces.
    """

    a: int
    b: int
    names: tuple[str, str]
    found: SolidProximity
    solids: tuple[Any, Any]


BallOf = Callable[[OfPieces], Overlap]
"""A ball inside the piece that is inside the other one."""


def answer_of_pieces(
    answers: Sequence[OfPieces], pieces: tuple[int, int], beyond: float, ball_of: BallOf
) -> SolidProximity:
    """The answer of two unions of pieces: the least over all pairs of pieces.

    In this order: a body each of whose pieces is inside a piece of the other's is CONTAINED; else
    any pair that overlaps, or of which one is inside the other, makes the whole OVERLAPPING, with
    the deepest pair's answer; else the nearest pair's answer is the whole's, with the least lower
    bound of all. A pair that stays open, and may be nearer, leaves the whole open.

    Parameters
    ----------
    answers : sequence of OfPieces
        At least one: those of all pairs that may be nearest, and of all that may meet.
    pieces : (int, int)
        How many pieces A and B have.
    beyond : float
        No pair of pieces that is not among the answers is nearer than this [length].
    ball_of : callable
    """
    answers = [each._replace(found=_with_names(each)) for each in answers]
    if pieces == (1, 1):
        return _whole(answers, answers[0])
    sides: tuple[Literal["A", "B"], ...] = ("A", "B")
    for side, number in zip(sides, pieces, strict=True):
        walls = _walls(answers, side, number)
        if walls is not None:
            return _whole(answers, _contained(walls))
    deep = [each for each in answers if each.found.status is Status.OVERLAPPING]
    if not deep:
        deep = [_overlapping(each, ball_of) for each in answers if each.found.inside]
    if deep:
        return _whole(answers, min(deep, key=lambda each: each.found.distance))
    return _whole(answers, _nearest(answers, beyond))


def _walls(
    answers: Sequence[OfPieces], side: Literal["A", "B"], pieces: int
) -> list[OfPieces] | None:
    """Of each piece of a body the pair with the thickest wall around it; None unless each is inside
    a piece of the other body."""
    thickest: dict[int, OfPieces] = {}
    for each in answers:
        if each.found.inside == side:
            number = each.a if side == "A" else each.b
            known = thickest.get(number)
            if known is None or each.found.distance > known.found.distance:
                thickest[number] = each
    return list(thickest.values()) if len(thickest) == pieces else None


def _contained(walls: Sequence[OfPieces]) -> OfPieces:
    """The thinnest of the walls, with the least of their bounds."""
    least = min(walls, key=lambda each: each.found.distance)
    lower = min(each.found.lower_bound for each in walls)
    return least._replace(found=replace(least.found, lower_bound=lower))


def _overlapping(each: OfPieces, ball_of: BallOf) -> OfPieces:
    """A piece inside another, of bodies that overlap by it."""
    ball, found = ball_of(each), each.found
    depth = -2.0 * ball.radius
    return each._replace(
        found=replace(
            found,
            status=Status.OVERLAPPING,
            distance=depth,
            lower_bound=-np.inf,
            upper_bound=depth + found.slack,
            continuum=None,
            overlap=ball,
            inside="",
            cavity="",
            open=(),
            gradient_rows=np.zeros(12),
            smoothness=Smoothness.UNDEFINED,
        )
    )


def _nearest(answers: Sequence[OfPieces], beyond: float) -> OfPieces:
    """The nearest pair; of several at one distance one with a continuum, if there is one. What may
    be nearer and is open leaves it open."""
    least = min(answers, key=lambda each: each.found.distance)
    # nearer to each other than they are proven to: as near as each other
    most = least.found.distance + PROOF_TOLERANCE * size_together(*least.solids)
    tied = [each for each in answers if each.found.distance <= most]
    nearest = next((each for each in tied if each.found.continuum), least)
    found = nearest.found
    undecided = [
        each.found
        for each in answers
        if not each.found.certified and each.found.lower_bound < found.lower_bound
    ]
    if undecided:
        # one that may be nearer has a lower bound below the nearest's own, which is none of these
        left = [*found.open, *(pair for each in undecided for pair in each.open)]
        found = replace(
            found,
            status=min(undecided, key=lambda each: each.lower_bound).status,
            open=tuple(sorted(left, key=lambda pair: pair.lower_bound)[:MOST_OPEN]),
        )
    lower = min(beyond, *(each.found.lower_bound for each in answers))
    several = len(tied) > 1 and found.smoothness is Smoothness.SMOOTH
    smoothness = Smoothness.ONE_SIDED if several else found.smoothness
    if undecided and lower <= 0.0:
        smoothness = Smoothness.UNDEFINED
    others = (each for each in tied if each is not nearest)
    minima = tuple(pair for each in (nearest, *others) for pair in each.found.minima)
    found = replace(found, lower_bound=lower, smoothness=smoothness, minima=minima)
    return nearest._replace(found=found)


def _with_names(each: OfPieces) -> SolidProximity:
    minima = tuple(pair._replace(pieces=each.names) for pair in each.found.minima)
    return replace(each.found, pieces=each.names, minima=minima)


def _whole(answers: Sequence[OfPieces], chosen: OfPieces) -> SolidProximity:
    """The chosen answer as that of the whole: with the slack of the worst, and what all took."""
    totals = (sum(column) for column in zip(*(each.found.counts for each in answers), strict=True))
    return replace(
        chosen.found,
        slack=max(each.found.slack for each in answers),
        counts=SolidCounts(*totals),
    )


def turned(found: SolidProximity) -> SolidProximity:
    """The answer of the pair (B, A)."""
    continuum = found.continuum
    if continuum is not None:
        continuum = continuum._replace(ends=tuple((b, a) for a, b in continuum.ends))
    other: dict[str, Literal["A", "B", ""]] = {"A": "B", "B": "A", "": ""}
    return replace(
        found,
        point_a=found.point_b,
        point_b=found.point_a,
        normal=-found.normal,
        feature_a=found.feature_b,
        feature_b=found.feature_a,
        parameters_a=found.parameters_b,
        parameters_b=found.parameters_a,
        minima=tuple(map(_turned_pair, found.minima)),
        continuum=continuum,
        inside=other[found.inside],
        cavity=other[found.cavity],
        open=tuple(map(_turned_open, found.open)),
        gradient_rows=np.concatenate([found.gradient_rows[6:], found.gradient_rows[:6]]),
        poses=found.poses[::-1],
        pieces=found.pieces[::-1],
    )


def _turned_pair(pair: NearestPair) -> NearestPair:
    return NearestPair(
        pair.distance,
        pair.lower_bound,
        pair.point_b,
        pair.point_a,
        -pair.normal,
        pair.feature_b,
        pair.feature_a,
        pair.parameters_b,
        pair.parameters_a,
        pair.pieces[::-1],
        tuple((y, x) for x, y in pair.patch),
        pair.key,
    )


def _turned_open(pair: OpenPair) -> OpenPair:
    return OpenPair(
        pair.lower_bound, pair.feature_b, pair.feature_a, pair.corners_b, pair.corners_a
    )
