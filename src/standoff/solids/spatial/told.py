"""An answer as it is told of what was found at places of two solids in space."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

from standoff.bodies.features import NO_FEATURE
from standoff.solids.answer import (
    Continuum,
    NearestPair,
    OpenPair,
    Overlap,
    PointPair,
    SolidProximity,
)
from standoff.solids.spatial.minimum import LeastFound
from standoff.solids.spatial.pair import NearestPlace, PlacedPair
from standoff.tracking.derivatives import Smoothness
from standoff.tracking.status import Status

UNDEFINED = Smoothness.UNDEFINED
Inside = Literal["A", "B", ""]


class AnswerFacts(NamedTuple):
    """What an answer says beside its numbers."""

    status: Status
    smoothness: Smoothness = UNDEFINED
    continuum: Continuum | None = None
    overlap: Overlap | None = None
    inside: Inside = ""
    open: tuple[OpenPair, ...] = ()
    n_open: int = 0
    patches: Sequence[tuple[PointPair, ...]] = ()


UNSEEN = NearestPair(
    np.nan, np.nan, *(np.full(3, np.nan),) * 3, NO_FEATURE, NO_FEATURE, (), ()
)  # fmt: skip


def answer_of(
    pair: PlacedPair, found: LeastFound, places: list[NearestPlace], told: AnswerFacts
) -> SolidProximity:
    distance, lower, upper = found.upper, found.lower, found.upper
    if told.overlap:
        upper = -told.overlap.depth
        lower = -told.overlap.most
        distance = min(upper, max(lower, places[0].distance))
    minima = tuple(pair.nearest_pair(p, -np.inf if told.overlap else lower) for p in places)
    if told.patches:
        named = zip(minima, told.patches, strict=True)
        minima = tuple(each._replace(patch=patch) for each, patch in named)
    first = minima[0] if minima else UNSEEN
    if not minima:
        distance = upper = np.inf
    gradient = np.full(12, np.nan)
    if told.smoothness is not UNDEFINED:
        gradient = pair.gradient(places[0])
    return SolidProximity(
        status=told.status, distance=distance, lower_bound=lower - pair.slack,
        upper_bound=upper + pair.slack, slack=pair.slack, point_a=first.point_a,
        point_b=first.point_b, normal=first.normal, feature_a=first.feature_a,
        feature_b=first.feature_b, parameters_a=first.parameters_a,
        parameters_b=first.parameters_b, minima=minima, continuum=told.continuum,
        overlap=told.overlap, inside=told.inside, open=told.open, gradient_rows=gradient,
        smoothness=told.smoothness, counts=found.told._replace(open=told.n_open), poses=pair.poses,
        cavity=_cavity(pair, told.status, first),
    )  # fmt: skip


def _cavity(pair: PlacedPair, status: Status, nearest: NearestPair) -> Inside:
    """Which solid is in a cavity of the other: the nearest point is then on the cavity's shell, as
    nothing is between."""
    if status not in (Status.CONVERGED, Status.CONTINUUM):
        return ""
    if pair.b.in_cavity(nearest.feature_b):
        return "A"
    return "B" if pair.a.in_cavity(nearest.feature_a) else ""
