"""The proven distance of two solids in space."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.features import NO_FEATURE, Feature
from standoff.errors import StandoffError
from standoff.kernels.entries.minima import greatest_gap
from standoff.kernels.entries.queries import on_face
from standoff.kernels.entries.solids import part_extents
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.spatial_progress import BOUND
from standoff.kernels.solids.spatial_tolerances import SURE_NORMAL, VALLEY
from standoff.motion.pose import Pose
from standoff.solids.answer import MOST_OPEN, Continuum, OpenPair, PointPair, SolidProximity
from standoff.solids.asked import DEFAULT, QueryOptions
from standoff.solids.parting import Gap, parted
from standoff.solids.spatial.contact import signed_minima_of
from standoff.solids.spatial.held import depth_bound
from standoff.solids.spatial.minimum import LeastFound, SearchOptions, leaf_jet_of
from standoff.solids.spatial.models import as_model
from standoff.solids.spatial.overlap import ball_beside, common_ball
from standoff.solids.spatial.overlapping import closed, contact_reach, told_overlapping
from standoff.solids.spatial.pair import NearestPlace, PlacedPair, references_of
from standoff.solids.spatial.patches import patches_of
from standoff.solids.spatial.points import distance_to_boundary, signed_distances
from standoff.solids.spatial.solid_model import SolidModel
from standoff.solids.spatial.stationary import is_minimum, is_stationary
from standoff.solids.spatial.ties import continuum_of, distinct, same_as, spots_of
from standoff.solids.spatial.told import UNDEFINED, AnswerFacts, Inside, answer_of
from standoff.solids.spatial.tolerances import IN_CONTACT, PROOF_TOLERANCE
from standoff.solids.spatial.tree import CORNERS
from standoff.tracking.derivatives import Smoothness
from standoff.tracking.status import Status
from standoff.typing import Array

# Common points of the boundaries beside which a point inside both is sought, where nothing parts
# the solids.
MOST_COMMON = 8
# Starts of the ascent to the largest common ball.
STARTS = 3
MOST_TIES = 64
# Of the tolerance: rounding of bounds that are proven to it.
PROVEN = 1.001
OUTSIDE = (S.OUTSIDE, S.OUTSIDE)


def spatial_distance(
    a: Any, b: Any, pose_a: Any = None, pose_b: Any = None, asked: QueryOptions = DEFAULT
) -> SolidProximity:
    """The proven distance of two solids at poses.

    Raises StandoffError: something that is no solid, or no pose.

    Parameters
    ----------
    a, b : Solid, Boundary or Body
    pose_a, pose_b : poses in the world
        The identity by default.
    asked : QueryOptions, optional
        The options of ``so.solids.distance``. To 1e-10 of both sizes together it is proven by
        default.

    Returns
    -------
    SolidProximity
    """
    within, tolerance, minima, deadline, patch = asked
    placed = [Pose.identity() if pose is None else Pose.of(pose) for pose in (pose_a, pose_b)]
    pair = PlacedPair(as_model(a), as_model(b), *placed)
    inside = inside_of(pair)
    senses = senses_of(inside)
    proof = pair.provable(PROOF_TOLERANCE * pair.size if tolerance is None else tolerance)
    # two tolerances more, so that what lies beyond is proven to; no wall is beyond the horizon
    horizon = np.inf if within is None or inside else within + 2.0 * proof
    sought = SearchOptions(proof, deadline, horizon, *reach_of_minima(minima, patch))
    found = pair.least(senses, sought)
    if found.met:
        return _meeting(pair, found, sought, senses)
    if within is not None and found.upper >= horizon and found.lower >= within:
        return answer_of(pair, replace(found, upper=np.inf), [], AnswerFacts(Status.FAR))
    if found.upper >= horizon and not found.n_open:
        raise StandoffError(
            f"No pair of points of {pair.a!r} and {pair.b!r} was found: the normals of a boundary "
            "may be wrong; report the pair with its poses."
        )
    return told_apart(pair, found, senses, inside, sought)[0]


def reach_of_minima(minima: float | None, patch: float | None) -> tuple[float, bool, int, float]:
    """Of a search for local minima and their patches: up to where, and more `SearchOptions`."""
    wider = patch or 0.0
    return (minima + wider if minima else 0.0), True, MOST_OPEN, wider


def inside_of(pair: PlacedPair) -> Inside:
    """Which solid is inside the other's material, if their boundaries do not meet."""
    return "A" if is_inside(pair, "A") else "B" if is_inside(pair, "B") else ""


def senses_of(inside: Inside) -> tuple[int, int]:
    """From where each boundary is seen."""
    return (
        S.INSIDE if inside == "B" else S.OUTSIDE,
        S.INSIDE if inside == "A" else S.OUTSIDE,
    )


def is_inside(pair: PlacedPair, which: str) -> bool:
    """Is a point of one solid's boundary inside the other?"""
    own, other = (pair.a, pair.b) if which == "A" else (pair.b, pair.a)
    for point in references_of(own):
        if which == "A":
            spot = pair.in_b(point @ pair.ra.T + pair.pa)
        else:
            spot = pair.in_a(point @ pair.rb.T + pair.pb)
        if not other.may_hold(spot):
            return False
        told = signed_distances(other, spot[None])
        if float(told.upper_bound[0]) < 0.0:
            return True
        if float(told.lower_bound[0]) > 0.0:
            return False
    return False


def _places(
    pair: PlacedPair, found: LeastFound, senses: tuple[int, int], above: float
) -> list[NearestPlace]:
    if not len(found.minima):
        return []
    if above > 0.0:
        return local_minima(pair, found, senses)
    rows = [found.best, *_spread(pair, found.minima)[:MOST_TIES]]
    return distinct(pair, pair.places(rows, senses))


def _spread(pair: PlacedPair, rows: Array) -> list[Array]:
    """Rows in an order in which each pair of features comes before any comes again."""
    seen: dict[tuple[int, int], int] = {}
    rank = []
    for row in rows:
        key = pair.a.leaves[int(row[1])].feature, pair.b.leaves[int(row[2])].feature
        rank.append(seen.get(key, 0))
        seen[key] = rank[-1] + 1
    return [rows[k] for k in np.argsort(rank, kind="stable")]


def told_apart(
    pair: PlacedPair,
    found: LeastFound,
    senses: tuple[int, int],
    inside: Inside,
    sought: SearchOptions,
) -> tuple[SolidProximity, list[NearestPlace]]:
    """The answer where the solids are apart, and the places of its minima."""
    places = _places(pair, found, senses, sought.above)
    patches: list[tuple[PointPair, ...]] = []
    if sought.patch > 0.0:
        least = sought.above - sought.patch
        places = [each for k, each in enumerate(places) if k == 0 or each.distance <= least]
        patches = patches_of(pair, places, found, senses, sought.patch)
    most = found.upper + found.tolerance
    near = [place for place in places if place.distance <= most]
    ties = near
    if sought.above > 0.0:  # of each set of nearest pairs only one is among the local minima
        tied = replace(found, minima=found.minima[found.minima[:, 0] <= most])
        ties = _places(pair, tied, senses, 0.0)
    continuum = continuum_of(pair, ties, found)
    if found.lower <= 0.0:
        # what stays open may be that the boundaries meet, so nothing is known below
        found = replace(found, lower=-np.inf)
    proven = found.upper - found.lower <= PROVEN * found.tolerance
    # a tie more is no loss, a local minimum is
    proven = proven and not (sought.above > 0.0 and found.lost)
    if not proven:
        status = Status.DEADLINE if found.told.evaluations > sought.deadline else Status.WITHIN
    elif inside:
        status = Status.CONTAINED
    else:
        status = Status.CONTINUUM if continuum else Status.CONVERGED
    smoothness = _smoothness(near, continuum)
    if not proven and found.lower <= 0.0:
        smoothness = UNDEFINED
    left, n_left = ((), 0) if proven else open_pairs(pair, found)
    told = AnswerFacts(status, smoothness, continuum, None, inside, left, n_left, patches)
    return answer_of(pair, found, places, told), places


def _smoothness(near: list[NearestPlace], continuum: Continuum | None) -> Smoothness:
    if not near:
        return UNDEFINED
    if continuum:
        return Smoothness.PARTIAL
    return Smoothness.ONE_SIDED if len(near) > 1 else Smoothness.SMOOTH


def _meeting(
    pair: PlacedPair, found: LeastFound, sought: SearchOptions, senses: tuple[int, int]
) -> SolidProximity:
    """The boundaries meet: the solids overlap, or touch."""
    told = _overlapping(pair, found, sought)
    if told:
        return told
    place = pair.place(found.best, senses)
    middle = 0.5 * (place.point_a + place.point_b)
    starts = [middle]
    for own, other, which in ((pair.a, pair.b, "A"), (pair.b, pair.a, "B")):
        for point in references_of(own):
            world = point @ pair.ra.T + pair.pa if which == "A" else point @ pair.rb.T + pair.pb
            spot = pair.in_b(world) if which == "A" else pair.in_a(world)
            if other.may_hold(spot):
                starts.append(world)
    spare = sought.deadline - found.told.evaluations
    overlap = common_ball(pair, np.array(starts[:STARTS]), found.tolerance, spare)
    if overlap:
        overlap = closed(pair, overlap, place, sought, gap_of)
        return answer_of(pair, found, [place], AnswerFacts(Status.OVERLAPPING, overlap=overlap))
    return _touching(pair, sought._replace(below=np.inf, on_meeting=False), senses)


def _overlapping(
    pair: PlacedPair, found: LeastFound, sought: SearchOptions
) -> SolidProximity | None:
    """The answer by the minima of the signed distance, where these prove that the solids
    overlap."""
    reach, minima = contact_reach(pair, sought), sought.above - sought.patch
    signed = signed_minima_of(pair, reach)
    told = told_overlapping(pair, signed, reach, minima or None, gap_of)
    if told is None:
        return None
    answer = told[0]
    counts = found.told._replace(evaluations=found.told.evaluations + answer.counts.evaluations)
    return replace(answer, counts=counts)


def _touching(pair: PlacedPair, sought: SearchOptions, senses: tuple[int, int]) -> SolidProximity:
    """No ball was found inside both: all places of contact, and whether they can be parted."""
    # local minima below the tolerance, so that nothing is to be closed
    common = pair.least(senses, sought._replace(above=0.5 * sought.tolerance))
    found = _contacts(pair, common, senses)
    near = _places(pair, found, senses, 0.0)
    continuum = continuum_of(pair, near, found)
    normals = np.array([each.normal for each in pair.places(_nearest(found), senses)])
    way = parted(normals, found.tolerance, lambda by: gap_of(pair.moved(by)) is not None)
    if way == np.inf:
        # what proves that they touch takes less than looking for a ball beside each common point
        way = depth_bound(pair, found.tolerance)
    if way == np.inf:
        spots = [0.5 * (each.point_a + each.point_b) for each in _places(pair, common, senses, 0.0)]
        spare = sought.deadline - common.told.evaluations
        overlap = ball_beside(pair, np.array(spots[:MOST_COMMON]), found.tolerance, spare)
        if overlap:
            overlap = closed(pair, overlap, near[0], sought, gap_of)
            return answer_of(
                pair, found, near[:1], AnswerFacts(Status.OVERLAPPING, overlap=overlap)
            )
    places = near
    if sought.above > 0.0:
        others = _places(pair, pair.least(senses, sought), senses, sought.above)
        reach = sought.above - sought.patch
        beyond = near[-1].distance
        places = near + [each for each in others if beyond < each.distance <= reach]
    met = replace(found, lower=-way)
    if way < np.inf:
        told = AnswerFacts(Status.TOUCHING, _smoothness(near, continuum), continuum)
        return answer_of(pair, met, places, told)
    left = around(pair, near)
    return answer_of(pair, met, places, AnswerFacts(Status.WITHIN, open=left, n_open=len(left)))


def _nearest(found: LeastFound) -> Array:
    return found.minima[found.minima[:, 0] <= found.upper + found.tolerance]


def _contacts(pair: PlacedPair, found: LeastFound, senses: tuple[int, int]) -> LeastFound:
    """Without the places where boundaries only cross, as those of a solid's face and of the sides
    of what stands on it, unless there is no other. Its distance is that of the nearest one left."""
    rows = _nearest(found)
    touch = [row for row in rows if is_stationary(pair, pair.place(row, senses), IN_CONTACT)]
    if not touch:
        return found
    farther = found.minima[len(rows) :]
    minima = np.concatenate([touch, farther])
    return replace(found, upper=float(touch[0][0]), minima=minima, best=touch[0])


def gap_of(pair: PlacedPair, tolerance: float | None = None) -> Gap | None:
    """How far two solids are apart, at least, and the normal there; None where it is not proven
    that they have no common point. `tolerance`: to what their distance is."""
    if is_inside(pair, "A") or is_inside(pair, "B"):
        return None
    found = pair.least(OUTSIDE, SearchOptions(tolerance or PROOF_TOLERANCE * pair.size))
    if found.met or not found.lower > 0.0:
        return None
    return found.lower, pair.place(found.best, OUTSIDE).normal


# What a search left open, as an answer tells it: pieces of both boundaries in boxes.


def open_pairs(pair: PlacedPair, found: LeastFound) -> tuple[tuple[OpenPair, ...], int]:
    """Those of a search that ended before all was closed, and how many there are; if more than are
    listed, with those that were closed by what was found later."""
    rows = found.left[found.left[:, -1] < found.upper - found.tolerance]
    count = len(rows) if found.n_open <= MOST_OPEN else found.n_open
    return tuple(_of_row(pair, row) for row in rows), count


def around(pair: PlacedPair, places: list[NearestPlace]) -> tuple[OpenPair, ...]:
    """The leaves of places at which boundaries meet."""
    rows = {tuple(place.row[1:3]): place for place in places[:MOST_OPEN]}
    found = []
    for leaf_a, leaf_b in rows:
        boxes = [s.leaves[int(k)].reals[:4] for s, k in ((pair.a, leaf_a), (pair.b, leaf_b))]
        row = np.concatenate([[leaf_a, leaf_b], *boxes, [-np.inf]])
        found.append(_of_row(pair, row))
    return tuple(found)


def _of_row(pair: PlacedPair, row: Array) -> OpenPair:
    feature_a, corners_a = _piece(pair.a, int(row[0]), row[2:6])
    feature_b, corners_b = _piece(pair.b, int(row[1]), row[6:10])
    return OpenPair(
        float(row[-1]) - pair.slack,
        feature_a,
        feature_b,
        corners_a @ pair.ra.T + pair.pa,
        corners_b @ pair.rb.T + pair.pb,
    )


def _piece(solid: SolidModel, leaf: int, box: Array) -> tuple[Feature, Array]:
    """(its feature, the corners (8, 3) of a box around it, own frame) of a part of a leaf, or of a
    node of the tree, -1 - leaf."""
    if leaf < 0:
        o = int(solid.own[S.R_NODES]) + S.NODE_REALS * (-1 - leaf)
        node = solid.numbers[o : o + S.NODE_REALS]
        axes = node[S.AXES : S.AXES + 9].reshape(3, 3)
        return NO_FEATURE, node[:3] + (CORNERS * node[S.HALF : S.HALF + 3]) @ axes
    part = solid.leaves[leaf]
    out = np.zeros(6)
    axes = np.ascontiguousarray(part.axes)
    part_extents(solid.packed, axes.ravel(), leaf, np.ascontiguousarray(box), out)
    # within the leaf's own box, which may be the narrower one
    low, high = axes @ out[:3] - out[3:], axes @ out[:3] + out[3:]
    middle = axes @ part.centre
    low, high = np.maximum(low, middle - part.half), np.minimum(high, middle + part.half)
    corners = 0.5 * (low + high) + CORNERS * np.maximum(0.5 * (high - low), 0.0)
    return solid.feature_of(leaf), corners @ axes


# Local minima of the distance of two solids in space: of the pairs that a search found, those that
# are one, each once.

# Where between two pairs the boundaries are looked at: what is half way may be on another piece of
# them by symmetry.
BETWEEN = np.array([0.5, 0.19, 0.81])


def local_minima(
    pair: PlacedPair, found: LeastFound, senses: tuple[int, int]
) -> list[NearestPlace]:
    """All that were found, the nearest first; of each set of nearest pairs one."""
    places = pair.places([found.best, *found.minima], senses)
    places = [each for k, each in enumerate(places) if k == 0 or is_minimum(pair, each)]
    spots = spots_of(places)

    def same(k: int) -> NDArray[np.bool_]:
        near = np.abs(spots[:k, 6] - spots[k, 6]) <= found.tolerance
        return np.asarray(near & same_as(spots, k, pair.size)[:k])

    sets = _sets(len(places), [(same, lambda k, i: True)])
    single = [_best(pair, [places[i] for i in each]) for each in sets]
    distances = np.array([place.distance for place in single])
    parts = np.unique(_parts_of(pair, single), axis=0, return_inverse=True)[1].ravel()

    def tied(k: int) -> NDArray[np.bool_]:
        return np.asarray(np.abs(distances[:k] - distances[k]) <= found.tolerance)

    def tied_alike(k: int) -> NDArray[np.bool_]:
        return np.asarray(tied(k) & (parts[:k] == parts[k]))

    def joined(k: int, i: int) -> bool:
        most = float(max(distances[k], distances[i])) + found.tolerance
        alike = bool(parts[k] == parts[i])
        return _greatest_gap(pair, single[k], single[i], alike, most) <= most

    # what is on the same parts of the boundaries first, as it takes least
    sets = _sets(len(single), [(tied_alike, joined), (tied, joined)])
    return [_best(pair, [single[i] for i in each]) for each in sets]


def _sets(
    n: int, passes: Sequence[tuple[Callable[[int], NDArray[np.bool_]], Callable[[int, int], bool]]]
) -> list[list[int]]:
    """Those of `n` that are one, or one with others that are; sets in the order of their first.
    `passes`: which before the k-th may be one with it, and whether two are."""
    first = np.arange(n)
    for may_be, are_one in passes:
        for k in range(n):
            for i in np.flatnonzero(may_be(k) & (first[:k] != first[k])).tolist():
                low, high = sorted((first[i], first[k]))
                if low < high and are_one(k, i):
                    first[first == high] = low
    return [np.flatnonzero(first == k).tolist() for k in np.unique(first)]


def _parts_of(pair: PlacedPair, places: Sequence[NearestPlace]) -> NDArray[np.int64]:
    """The parts of both boundaries, and the charts, that places are on: rows (n, 4)."""
    leaves = np.array([place.row[1:3] for place in places]).astype(np.int64)
    sides = [solid.leaf_table.chart[leaves[:, k]] for k, solid in enumerate((pair.a, pair.b))]
    return np.concatenate(sides, axis=1)


def _best(pair: PlacedPair, places: list[NearestPlace]) -> NearestPlace:
    """The nearest of some that are one, with the best bound that any of their pieces has; of those
    as near up to rounding the one on features with the fewest parameters."""
    least = min(place.distance for place in places)

    def rank(place: NearestPlace) -> tuple[bool, int]:
        dims = (solid.leaves[int(place.row[1 + k])].dim for k, solid in enumerate((pair.a, pair.b)))
        return place.distance > least + VALLEY * pair.size, sum(dims)

    best = min(places, key=rank)
    row = best.row.copy()
    row[0] = least
    row[BOUND] = max(float(place.row[BOUND]) for place in places)
    return replace(best, row=row)


def _greatest_gap(
    pair: PlacedPair, place: NearestPlace, other: NearestPlace, alike: bool, most: float
) -> float:
    """How far those between two pairs are apart, at most, as far as it matters whether this is more
    than `most`. `alike`: on the same parts."""
    if alike:
        rows = np.array([place.row[:7], other.row[:7]])
        return float(greatest_gap((pair.a.packed, pair.b.packed), pair.relative, rows, BETWEEN))
    gap = 0.0
    for share in BETWEEN:
        if gap <= most:
            gap = max(gap, _gap_between(pair, place, other, float(share)))
    return gap


def _gap_between(pair: PlacedPair, place: NearestPlace, other: NearestPlace, share: float) -> float:
    """How far two points are apart that are on the boundaries, a share of the way from one pair's
    to the other's; infinite where there are none."""
    spots = []
    for side, (solid, turn, shift) in enumerate(
        ((pair.a, pair.ra, pair.pa), (pair.b, pair.rb, pair.pb))
    ):
        spot = _between(solid, side, place.row, other.row, share)
        if spot is None:
            return float(np.inf)
        spots.append(spot @ turn.T + shift)
    return float(np.linalg.norm(spots[1] - spots[0]))


def _between(solid: SolidModel, side: int, row: Array, other: Array, share: float) -> Array | None:
    """The point a share of the way between two points, own frame: by the parameters of one feature,
    or else straight ahead. None where that is not on the boundary."""
    leaves = int(row[1 + side]), int(other[1 + side])
    start, end = (each[3 + 2 * side : 5 + 2 * side] for each in (row, other))
    at = (1.0 - share) * start + share * end
    parts = [solid.leaves[leaf] for leaf in leaves]
    if solid.part_of(leaves[0]) == solid.part_of(leaves[1]) and parts[0].chart == parts[1].chart:
        if parts[0].dim == 2:
            ints, reals = solid.boundary.ints, solid.boundary.reals
            if not on_face(ints, reals, parts[0].chart, float(at[0]), float(at[1])):
                return None
        return np.asarray(leaf_jet_of(solid.packed, leaves[0], float(at[0]), float(at[1]))[0])
    ends = [
        leaf_jet_of(solid.packed, leaf, *each)[0]
        for leaf, each in zip(leaves, (start, end), strict=True)
    ]
    spot = (1.0 - share) * ends[0] + share * ends[1]
    off = distance_to_boundary(solid, spot).upper
    return np.asarray(spot) if off <= SURE_NORMAL * solid.size else None
