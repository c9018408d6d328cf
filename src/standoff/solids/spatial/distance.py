"""The proven distance of two solids in space."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Literal

import numpy as np

from standoff.bodies.features import NO_FEATURE
from standoff.errors import StandoffError
from standoff.geometry.validation import Array
from standoff.kernels.solids import spatial_layout as S
from standoff.motion.pose import Pose
from standoff.solids.answer import Continuum, Overlap, SolidCounts, SolidProximity
from standoff.solids.spatial.minimum import BUDGET, Found
from standoff.solids.spatial.overlap import common_ball
from standoff.solids.spatial.pair import Place, PlacedPair, reference_points, within_box
from standoff.solids.spatial.points import signed_distances
from standoff.solids.spatial.solid_model import SolidModel, as_model
from standoff.solids.spatial.ties import continuum_of, distinct
from standoff.solids.spatial.tolerances import PARTED, PROOF_TOLERANCE
from standoff.tracking.derivatives import Smoothness
from standoff.tracking.status import Status

# Reference points that are tried until one is off the other's boundary.
TRIED = 6
# Starts of the ascent to the largest common ball.
STARTS = 3
MOST_TIES = 64
UNDEFINED = Smoothness.UNDEFINED
# Of the tolerance: rounding of bounds that are proven to it.
PROVEN = 1.001


def spatial_distance(
    a: Any,
    b: Any,
    pose_a: Any = None,
    pose_b: Any = None,
    *,
    evaluations: int = BUDGET,
    within: float | None = None,
) -> SolidProximity:
    """The proven distance of two solids at poses.

    Parameters
    ----------
    a, b : Solid, Boundary or Body
    pose_a, pose_b : poses in the world
        The identity by default.
    evaluations : int
        Boxes that potentials are bounded over, at most: what is then open stays an interval.
    within : float, optional
        Horizon, length: of solids farther apart only that is proven, with the status FAR.

    Returns
    -------
    SolidProximity

    Raises
    ------
    StandoffError
        Something that is no solid, or no pose.
    """
    placed = [Pose.identity() if pose is None else Pose.of(pose) for pose in (pose_a, pose_b)]
    pair = PlacedPair(as_model(a), as_model(b), *placed)
    inside: Literal["A", "B", ""] = ""
    if _inside(pair, "A"):
        inside = "A"
    elif _inside(pair, "B"):
        inside = "B"
    senses = (
        S.INSIDE if inside == "B" else S.OUTSIDE,
        S.INSIDE if inside == "A" else S.OUTSIDE,
    )
    # two tolerances more, so that what lies beyond is proven to
    horizon = np.inf if within is None else within + 2.0 * PROOF_TOLERANCE * pair.size
    found = pair.least(senses, evaluations, horizon)
    if found.met:
        return _meeting(pair, found, senses)
    if np.isinf(found.upper):
        raise StandoffError(
            f"No pair of points of {pair.a!r} and {pair.b!r} was found: the normals of a boundary "
            "may be wrong; report the pair with its poses."
        )
    if within is not None and found.upper >= horizon and not inside:
        return _beyond(pair, found)
    return _apart(pair, found, senses, inside, evaluations)


def _inside(pair: PlacedPair, which: str) -> bool:
    """Is a point of one solid's boundary inside the other?"""
    own, other = (pair.a, pair.b) if which == "A" else (pair.b, pair.a)
    for point in _references(own):
        if which == "A":
            spot = pair.in_b(point @ pair.ra.T + pair.pa)
        else:
            spot = pair.in_a(point @ pair.rb.T + pair.pb)
        if not within_box(other, spot):
            return False
        told = signed_distances(other, spot[None])
        if float(told.upper_bound[0]) < 0.0:
            return True
        if float(told.lower_bound[0]) > 0.0:
            return False
    return False


def _references(solid: SolidModel) -> Array:
    if solid.references is None:
        solid.references = reference_points(solid, TRIED)
    return solid.references


def _places(pair: PlacedPair, found: Found, senses: tuple[int, int]) -> list[Place]:
    rows = [found.best, *found.minima[:MOST_TIES]]
    return distinct(pair, [pair.place(row, senses) for row in rows])


def _apart(
    pair: PlacedPair,
    found: Found,
    senses: tuple[int, int],
    inside: Literal["A", "B", ""],
    evaluations: int,
) -> SolidProximity:
    places = _places(pair, found, senses)
    continuum = continuum_of(pair, places, found, senses)
    if found.lower <= 0.0:
        # what stays open may be that the boundaries meet, so nothing is known below
        found = replace(found, lower=-np.inf)
    proven = found.upper - found.lower <= PROVEN * found.tolerance
    if not proven:
        status = Status.DEADLINE if found.counts[0] > evaluations else Status.WITHIN
    elif inside:
        status = Status.CONTAINED
    else:
        status = Status.CONTINUUM if continuum else Status.CONVERGED
    smoothness = Smoothness.SMOOTH
    if continuum:
        smoothness = Smoothness.PARTIAL
    elif len(places) > 1:
        smoothness = Smoothness.ONE_SIDED
    if not proven and found.lower <= 0.0:
        smoothness = Smoothness.UNDEFINED
    return _answer(pair, found, places, status, smoothness, continuum, None, inside)


def _meeting(pair: PlacedPair, found: Found, senses: tuple[int, int]) -> SolidProximity:
    """The boundaries meet: the solids overlap, or touch."""
    place = pair.place(found.best, senses)
    middle = 0.5 * (place.point_a + place.point_b)
    starts = [middle]
    for own, other, which in ((pair.a, pair.b, "A"), (pair.b, pair.a, "B")):
        for point in _references(own):
            world = point @ pair.ra.T + pair.pa if which == "A" else point @ pair.rb.T + pair.pb
            spot = pair.in_b(world) if which == "A" else pair.in_a(world)
            if within_box(other, spot):
                starts.append(world)
    overlap = common_ball(pair, np.array(starts[:STARTS]), found.tolerance)
    if overlap:
        return _answer(pair, found, [place], Status.OVERLAPPING, UNDEFINED, None, overlap, "")
    parted = _parted(pair, place, found.tolerance)
    status = Status.TOUCHING if parted < np.inf else Status.WITHIN
    met = replace(found, lower=-parted)
    return _answer(pair, met, [place], status, UNDEFINED, None, None, "")


def _parted(pair: PlacedPair, place: Place, tolerance: float) -> float:
    """A length by which moving B along the normal is proven to part the solids; inf where that is
    not proven of `PARTED` tolerances."""
    way = PARTED * tolerance
    moved = Pose(pair.rb, pair.pb + way * place.normal)
    beside = PlacedPair(pair.a, pair.b, Pose(pair.ra, pair.pa), moved)
    if _inside(beside, "A") or _inside(beside, "B"):
        return float(np.inf)
    found = beside.least((S.OUTSIDE, S.OUTSIDE), BUDGET)
    return way if not found.met and found.lower > 0.0 else float(np.inf)


def _beyond(pair: PlacedPair, found: Found) -> SolidProximity:
    """Solids beyond the horizon: only a bound is known."""
    unseen: Array = np.full(3, np.nan)
    boxes, steps, nodes, leaves, cuts = found.counts
    return SolidProximity(
        status=Status.FAR, distance=np.inf, lower_bound=found.lower - pair.a.slack - pair.b.slack,
        upper_bound=np.inf, slack=pair.a.slack + pair.b.slack, point_a=unseen, point_b=unseen,
        normal=unseen, feature_a=NO_FEATURE, feature_b=NO_FEATURE, parameters_a=(),
        parameters_b=(), minima=(), continuum=None, overlap=None, inside="",
        gradient_rows=np.full(12, np.nan), smoothness=UNDEFINED,
        counts=SolidCounts(boxes + 2 * steps, nodes, leaves, boxes, cuts),
        poses=(
            np.concatenate([pair.ra.ravel(), pair.pa]),
            np.concatenate([pair.rb.ravel(), pair.pb]),
        ),
    )  # fmt: skip


def _answer(
    pair: PlacedPair,
    found: Found,
    places: list[Place],
    status: Status,
    smoothness: Smoothness,
    continuum: Continuum | None,
    overlap: Overlap | None,
    inside: Literal["A", "B", ""],
) -> SolidProximity:
    place = places[0]
    distance, lower, upper = found.upper, found.lower, found.upper
    if overlap:
        distance = upper = -2.0 * overlap.radius
        lower = -np.inf
    minima = tuple(pair.nearest_pair(p, lower) for p in places)
    first = minima[0]
    boxes, steps, nodes, leaves, cuts = found.counts
    slack = pair.a.slack + pair.b.slack
    undefined = smoothness is Smoothness.UNDEFINED
    gradient = np.zeros(12) if undefined else pair.gradient(place)
    return SolidProximity(
        status=status, distance=distance, lower_bound=lower - slack, upper_bound=upper + slack,
        slack=slack, point_a=first.point_a, point_b=first.point_b,
        normal=first.normal, feature_a=first.feature_a, feature_b=first.feature_b,
        parameters_a=first.parameters_a, parameters_b=first.parameters_b, minima=minima,
        continuum=continuum, overlap=overlap, inside=inside, gradient_rows=gradient,
        smoothness=smoothness, counts=SolidCounts(boxes + 2 * steps, nodes, leaves, boxes, cuts),
        poses=(
            np.concatenate([pair.ra.ravel(), pair.pa]),
            np.concatenate([pair.rb.ravel(), pair.pb]),
        ),
    )  # fmt: skip
