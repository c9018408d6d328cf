"""The proven distance of two solids in space."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from standoff.errors import StandoffError
from standoff.kernels.solids import spatial_layout as S
from standoff.motion.pose import Pose
from standoff.solids.answer import MOST_OPEN, Continuum, PointPair, SolidProximity
from standoff.solids.asked import DEFAULT, Asked
from standoff.solids.parting import Gap, parted
from standoff.solids.spatial.contact import signed_minima_of
from standoff.solids.spatial.held import depth_bound
from standoff.solids.spatial.left_open import around, open_pairs
from standoff.solids.spatial.local_minima import local_minima
from standoff.solids.spatial.minimum import Found, Sought
from standoff.solids.spatial.models import as_model
from standoff.solids.spatial.overlap import ball_beside, common_ball
from standoff.solids.spatial.overlapping import closed, contact_reach, told_overlapping
from standoff.solids.spatial.pair import Place, PlacedPair, references_of
from standoff.solids.spatial.patches import patches_of
from standoff.solids.spatial.points import signed_distances
from standoff.solids.spatial.stationary import is_stationary
from standoff.solids.spatial.ties import continuum_of, distinct
from standoff.solids.spatial.told import UNDEFINED, Inside, Told, answer_of
from standoff.solids.spatial.tolerances import IN_CONTACT, PROOF_TOLERANCE
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
    a: Any, b: Any, pose_a: Any = None, pose_b: Any = None, asked: Asked = DEFAULT
) -> SolidProximity:
    """The proven distance of two solids at poses.

    Raises StandoffError: something that is no solid, or no pose.

    Parameters
    ----------
    a, b : Solid, Boundary or Body
    pose_a, pose_b : poses in the world
        The identity by default.
    asked : Asked, optional
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
    sought = Sought(proof, deadline, horizon, *reach_of_minima(minima, patch))
    found = pair.least(senses, sought)
    if found.met:
        return _meeting(pair, found, sought, senses)
    if within is not None and found.upper >= horizon and found.lower >= within:
        return answer_of(pair, replace(found, upper=np.inf), [], Told(Status.FAR))
    if found.upper >= horizon and not found.n_open:
        raise StandoffError(
            f"No pair of points of {pair.a!r} and {pair.b!r} was found: the normals of a boundary "
            "may be wrong; report the pair with its poses."
        )
    return told_apart(pair, found, senses, inside, sought)[0]


def reach_of_minima(minima: float | None, patch: float | None) -> tuple[float, bool, int, float]:
    """Of a search for local minima and their patches: up to where, and the rest of a `Sought`."""
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


def _places(pair: PlacedPair, found: Found, senses: tuple[int, int], above: float) -> list[Place]:
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
    found: Found,
    senses: tuple[int, int],
    inside: Inside,
    sought: Sought,
) -> tuple[SolidProximity, list[Place]]:
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
    told = Told(status, smoothness, continuum, None, inside, left, n_left, patches)
    return answer_of(pair, found, places, told), places


def _smoothness(near: list[Place], continuum: Continuum | None) -> Smoothness:
    if not near:
        return UNDEFINED
    if continuum:
        return Smoothness.PARTIAL
    return Smoothness.ONE_SIDED if len(near) > 1 else Smoothness.SMOOTH


def _meeting(
    pair: PlacedPair, found: Found, sought: Sought, senses: tuple[int, int]
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
        return answer_of(pair, found, [place], Told(Status.OVERLAPPING, overlap=overlap))
    return _touching(pair, sought._replace(below=np.inf, on_meeting=False), senses)


def _overlapping(pair: PlacedPair, found: Found, sought: Sought) -> SolidProximity | None:
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


def _touching(pair: PlacedPair, sought: Sought, senses: tuple[int, int]) -> SolidProximity:
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
            return answer_of(pair, found, near[:1], Told(Status.OVERLAPPING, overlap=overlap))
    places = near
    if sought.above > 0.0:
        others = _places(pair, pair.least(senses, sought), senses, sought.above)
        reach = sought.above - sought.patch
        beyond = near[-1].distance
        places = near + [each for each in others if beyond < each.distance <= reach]
    met = replace(found, lower=-way)
    if way < np.inf:
        told = Told(Status.TOUCHING, _smoothness(near, continuum), continuum)
        return answer_of(pair, met, places, told)
    left = around(pair, near)
    return answer_of(pair, met, places, Told(Status.WITHIN, open=left, n_open=len(left)))


def _nearest(found: Found) -> Array:
    return found.minima[found.minima[:, 0] <= found.upper + found.tolerance]


def _contacts(pair: PlacedPair, found: Found, senses: tuple[int, int]) -> Found:
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
    found = pair.least(OUTSIDE, Sought(tolerance or PROOF_TOLERANCE * pair.size))
    if found.met or not found.lower > 0.0:
        return None
    return found.lower, pair.place(found.best, OUTSIDE).normal
