"""The answer of two solids that overlap: the depth of each place, with what is proven of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.hulls.fewer_points import directions
from standoff.kernels.solids.minima_sets import SET_BRANCH
from standoff.kernels.solids.spatial_progress import BOUND
from standoff.solids.answer import NEAR_BOUNDS, Overlap, SolidProximity
from standoff.solids.parting import Gap, least_way_out, shortest
from standoff.solids.spatial.contact import (
    MOST_REGIONS,
    Region,
    SignedMinima,
    ball_of,
    bound_of,
    place_of,
    regions_of,
)
from standoff.solids.spatial.held import depth_bound
from standoff.solids.spatial.minimum import LeastFound, SearchOptions
from standoff.solids.spatial.overlap import ball_beside, common_ball, deepened
from standoff.solids.spatial.pair import NearestPlace, PlacedPair
from standoff.solids.spatial.patches import patch_told
from standoff.solids.spatial.told import AnswerFacts, answer_of
from standoff.solids.spatial.tolerances import (
    BALL_STEPS,
    CONTACT_REACH,
    HELD_WAY,
    PARTED_SPARE,
    PROOF_ROUNDING,
)
from standoff.solids.tolerances import PARTED_BY
from standoff.tracking.status import Status
from standoff.typing import Array

Answered = tuple[SolidProximity, list[NearestPlace]]
"""An answer, and the places of its minima."""
NO_ROWS = np.empty((0, 11))


def contact_reach(pair: PlacedPair, sought: SearchOptions) -> SearchOptions:
    """The same with how deep an overlap is looked for at least."""
    return sought._replace(above=max(sought.above, CONTACT_REACH * pair.size + sought.patch))


def told_overlapping(
    pair: PlacedPair,
    signed: SignedMinima,
    sought: SearchOptions,
    minima: float | None,
    gap_of: GapOf,
) -> Answered | None:
    """The answer where minima of the signed distance prove that the solids overlap; None where none
    does.

    Parameters
    ----------
    minima : float or None
        Up to which distance minima are told that are no overlap; None: only the deepest place is.
    gap_of : callable
        It is asked with B moved by the shortest vector that opens all places, to first order; and
        depths are proven as far as they can be.
    """
    regions = regions_of(pair, signed, sought.tolerance)
    if not regions:
        return None
    places, overlap = [region.place for region in regions], _overlap(pair, signed, regions)
    spare = max(PARTED_BY * sought.tolerance, PARTED_SPARE * -places[0].distance)
    way = way_apart(places, spare)
    if way is not None and gap_of(pair.moved(way), 0.5 * spare):
        overlap = overlap._replace(parting=way)
    overlap = overlap._replace(depth=max(overlap.depth, *(_deep(pair, p) for p in places)))
    overlap = closed(pair, overlap, places[0], sought, gap_of)
    # what is deeper than a way that parts the solids is another way out of a region
    most = max(overlap.most, -places[-1].distance)
    rows = [region.row for region in regions if -region.place.distance <= most]
    if minima is None:
        rows = rows[:1]
    else:
        rows += [row for row in signed.sets if 0.0 <= row[0] <= minima]
    return _told(pair, signed, overlap, rows, sought)


def closed(
    pair: PlacedPair, overlap: Overlap, place: NearestPlace, sought: SearchOptions, gap_of: GapOf
) -> Overlap:
    """An overlap whose bounds are brought near to each other, where they are not: by a shorter way
    out, by a depth elsewhere than at its deepest place, and by what holds all round. Where no ball
    was found at that place, one is looked for elsewhere."""

    def is_far() -> bool:
        return overlap.most > NEAR_BOUNDS * max(overlap.depth, -place.distance)

    if overlap.most > NEAR_BOUNDS * overlap.depth:
        both = deepened(pair, place, sought.deadline)
        overlap = overlap._replace(depth=max(overlap.depth, both.depth))
    if is_far():
        overlap = overlap._replace(parting=short_way(pair, gap_of, overlap.parting))
    if is_far() or overlap.radius == 0.0:
        ends = np.array([place.point_a, place.point_b, 0.5 * (place.point_a + place.point_b)])
        ball = common_ball(pair, ends[:1], sought.tolerance, sought.deadline)
        if not ball and overlap.radius == 0.0:
            steps = [part * abs(place.distance) for part in BALL_STEPS]
            ball = ball_beside(pair, ends, sought.tolerance, sought.deadline, steps)
        if ball:
            larger = ball if ball.radius > overlap.radius else overlap
            depth = max(ball.depth, overlap.depth)
            overlap = larger._replace(depth=depth, parting=overlap.parting)
    about = max(overlap.depth, -place.distance)
    if overlap.most > HELD_WAY * about:
        overlap = overlap._replace(held=depth_bound(pair, sought.tolerance, about))
    return overlap


def told_in_contact(
    pair: PlacedPair,
    signed: SignedMinima,
    felt: NDArray[np.bool_],
    proven: float,
    parting: Array,
    sought: SearchOptions,
    minima: float | None,
) -> SolidProximity:
    """The answer of a frame by the places that are followed, of which one that is felt proves that
    the solids overlap.

    Parameters
    ----------
    felt : (m,) array of bool
        Of each minimum, has it come from above 0?
    proven : float
        No translation shorter than this parts the solids, length.
    parting : (3,) array
        One that does, A's frame.
    minima : float or None
        As of `told_overlapping`; places that are not felt are told last.
    """
    depth = signed.sets[:, 0]
    rows = list(signed.sets[felt & (depth < 0.0)][:MOST_REGIONS])
    ball = ball_of(pair, signed, rows[0])
    # a smaller ball is inside both too, and its radius is told to be half the depth at most
    radius = min(ball.radius, 0.5 * proven)
    overlap = Overlap(ball.common_point, radius, proven, pair.ra @ parting)
    if minima is None:
        return _told(pair, signed, overlap, rows[:1], sought)[0]
    rows += list(signed.sets[(depth >= 0.0) & (depth <= minima)])
    ways = list(signed.sets[~felt & (depth < 0.0)])
    answer, _ = _told(pair, signed, overlap, rows + ways, sought)
    named = zip(answer.minima, rows + ways, strict=True)
    told = [m._replace(key=int(row[SET_BRANCH])) for m, row in named]
    told[len(rows) :] = [m._replace(felt=False) for m in told[len(rows) :]]
    return replace(answer, minima=tuple(told))


def _overlap(pair: PlacedPair, signed: SignedMinima, regions: Sequence[Region]) -> Overlap:
    """What is proven of the regions, the deepest first."""
    ball = ball_of(pair, signed, regions[0].row)
    return ball._replace(depth=max(ball.depth, *(each.depth for each in regions)))


def _told(
    pair: PlacedPair,
    signed: SignedMinima,
    overlap: Overlap,
    rows: Sequence[Array],
    sought: SearchOptions,
) -> Answered:
    """The answer that tells these minima, rows of sets, of which the first is its own."""
    places = [place_of(pair, signed, row) for row in rows]
    for row, place in zip(rows, places, strict=True):
        if place.distance < 0.0:
            place.row[BOUND] = bound_of(pair, signed, row, sought)
    patches = [patch_told(pair, row) for row in rows] if sought.patch > 0.0 else []
    told = AnswerFacts(Status.OVERLAPPING, overlap=overlap, patches=patches)
    return answer_of(pair, _found(places[0], signed, sought), places, told), places


def _deep(pair: PlacedPair, place: NearestPlace) -> float:
    """How deep a place's point of one boundary is in the other solid, proven as far as can be."""
    return max(pair.depths(place.point_b)[0], pair.depths(place.point_a)[1])


def _found(first: NearestPlace, signed: SignedMinima, sought: SearchOptions) -> LeastFound:
    row, counts = first.row, (signed.evaluations, 0, 0, 0, 0)
    return LeastFound(
        -np.inf, -np.inf, sought.tolerance, True, row[None], row, NO_ROWS, 0, counts, 0
    )  # fmt: skip


def way_apart(places: Sequence[NearestPlace], spare: float) -> Array | None:
    """The shortest vector by which B is moved so that it is clear of all places by `spare`, to
    first order; None where there is none."""
    normals = np.array([place.normal for place in places])
    return least_way_out(normals, np.array([spare - place.distance for place in places]))


# A short way by which one of two solids that overlap is proven to be parted from the other.

GapOf = Callable[[PlacedPair, float], Gap | None]
"""How far a pair is apart, proven to a tolerance, and the normal there; None where it is not."""
ALL_ROUND = 96
"""Directions that are looked along."""


def short_way(pair: PlacedPair, gap_of: GapOf, known: Array | None = None) -> Array:
    """A world vector: B, moved by it, is proven to be apart from A. It is no longer than one that
    is `known`."""
    ways = directions(ALL_ROUND)
    if not (pair.a.has_end and pair.b.has_end):
        ways = pair.ra[None, :, 2] if pair.b.has_end else -pair.rb[None, :, 2]
    spare = 4.0 * PROOF_ROUNDING * (pair.size + float(np.linalg.norm(pair.relative[9:])))
    lengths = pair.a.heights(ways @ pair.ra) + pair.b.heights(-ways @ pair.rb) + spare
    lengths -= ways @ (pair.pb - pair.pa)

    def gap_by(way: Array) -> Gap | None:
        return gap_of(pair.moved(way), 0.5 * PARTED_SPARE * float(np.linalg.norm(way)))

    return shortest(ways, lengths, gap_by, known)
