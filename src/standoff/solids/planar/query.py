"""The proven distance of two planar solids at two poses."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.features import NO_FEATURE
from standoff.kernels.entries import planar_solids as entries
from standoff.kernels.entries.solids import gradient as write_gradient
from standoff.kernels.solids import planar_search as S
from standoff.motion import PoseLike
from standoff.solids.answer import (
    MOST_OPEN,
    Continuum,
    NearestPair,
    OpenPair,
    Overlap,
    SolidCounts,
    SolidProximity,
)
from standoff.solids.asked import DEFAULT, QueryOptions
from standoff.solids.parting import Gap, parted, shortest
from standoff.solids.planar.continua import continuum_of, distinct
from standoff.solids.planar.pair import PlanarPair, PlanarShape
from standoff.solids.planar.tolerances import BALL_PART, BOUND_ROUNDED, PROVEN_TO
from standoff.tracking.derivatives import Smoothness
from standoff.tracking.inputs import check_in_plane, flat_pose
from standoff.tracking.status import Status
from standoff.typing import Array

CAPACITY = 1 << 17  # pairs of pieces that may be open or were
MOST_FOUND = 2048
MOST_SQUARES = 1200
ALL_ROUND = 64
"""Directions in the plane that are looked along for a way out."""
UNSEEN: Array = np.full(3, np.nan)


class Searched(NamedTuple):
    """What a search has come to; lengths, and the rows of `planar_search.N_FOUND` numbers."""

    ended: int
    proven: float
    least: float
    found: Array
    counts: NDArray[np.int64]
    left: Array


def planar_distance(
    first: PlanarShape,
    second: PlanarShape,
    pose_a: PoseLike,
    pose_b: PoseLike,
    asked: QueryOptions = DEFAULT,
) -> SolidProximity:
    """See ``so.solids.distance``."""
    within, tolerance, minima, deadline, _ = asked
    flat_a, flat_b = flat_pose(pose_a), flat_pose(pose_b)
    check_in_plane(flat_a, flat_b)
    apart = float(np.linalg.norm(flat_b[9:] - flat_a[9:]))
    extent = first.outline.extent + second.outline.extent + apart
    size = max(first.size, second.size)
    proof = PROVEN_TO * size if tolerance is None else tolerance
    proof = max(proof, 4.0 * BOUND_ROUNDED * extent)
    pair = PlanarPair(first, second, np.concatenate([flat_a, flat_b]), proof, extent, deadline)
    horizon = np.inf if within is None else within
    searched = search(pair, minima or 0.0, horizon, meeting=proof)
    if searched.ended == S.BEYOND:
        return _beyond(pair, searched)
    if searched.ended == S.MET:
        return _meeting(pair, minima or 0.0)
    inside = _inside(pair) if searched.proven > 0.0 else (False, False)
    if all(inside):
        return _overlapping(pair, searched)
    return _apart(pair, searched, ("B" if inside[0] else "A") if any(inside) else "", minima)


def search(pair: PlanarPair, above: float, horizon: float, meeting: float) -> Searched:
    """The nearest pairs of the boundaries, and what is proven of their distance."""
    rows, heap = np.empty(CAPACITY * S.N_ROW), np.empty(CAPACITY, dtype=np.int64)
    found, counts = np.empty(MOST_FOUND * S.N_FOUND), np.zeros(S.N_COUNT, dtype=np.int64)
    sought = (pair.tolerance, pair.roundoff, pair.extent, above, horizon, meeting)
    ended, proven, least, n = entries.nearest(
        pair.a.outline.arrays,
        pair.b.outline.arrays,
        pair.poses,
        sought,
        pair.budget,
        (rows, heap, found),
        counts,
    )
    pairs = found[: n * S.N_FOUND].reshape(n, S.N_FOUND)
    left = rows.reshape(-1, S.N_ROW)[heap[: counts[S.OPEN]]]
    return Searched(
        ended,
        proven,
        least,
        pairs[np.argsort(pairs[:, 0], kind="stable")],
        counts,
        left[np.argsort(left[:, 0], kind="stable")],
    )


def _inside(pair: PlanarPair) -> tuple[bool, bool]:
    """(is a loop of B inside A's material, is one of A inside B's), of boundaries that do not
    meet: one point of each loop decides."""
    R_a, R_b = (pair.poses[k : k + 9].reshape(3, 3)[:2, :2] for k in (0, 12))
    p_a, p_b = pair.poses[9:11], pair.poses[21:23]
    points_a = (np.array([_first(loop) for loop in pair.a.loops]) @ R_a.T + p_a - p_b) @ R_b
    points_b = (np.array([_first(loop) for loop in pair.b.loops]) @ R_b.T + p_b - p_a) @ R_a
    in_a = pair.a.outline.foot(np.ascontiguousarray(points_b), pair.tolerance)[1]
    in_b = pair.b.outline.foot(np.ascontiguousarray(points_a), pair.tolerance)[1]
    return bool(in_a.any()), bool(in_b.any())


def _first(loop: Any) -> Array:
    curve = loop.curves[0]
    point: Array = curve.point(curve.first)[:2]
    return point


def _counts(counts: NDArray[np.int64]) -> SolidCounts:
    jets, nodes, leaves, boxes, cuts, _ = (int(n) for n in counts)
    return SolidCounts(jets + nodes + boxes, nodes, leaves, boxes, cuts)


def _open(pair: PlanarPair, searched: Searched) -> tuple[tuple[OpenPair, ...], int]:
    """What a search left: pieces in boxes, the nearest first; and how many."""
    rows = searched.left[searched.left[:, 0] < searched.least - pair.tolerance]
    listed = tuple(
        OpenPair(
            float(row[0]) - pair.slack,
            *(NO_FEATURE, NO_FEATURE),
            *(_corners(pair, row[at : at + 8]) for at in (1, 9)),
        )
        for row in rows[:MOST_OPEN]
    )
    return listed, len(rows)


def _corners(pair: PlanarPair, piece: Array) -> Array:
    """(4, 3) of a box around a piece, which is a chord's capsule, world axes."""
    ends, radius = piece[3:7].reshape(2, 2), float(piece[7])
    along = ends[1] - ends[0]
    size = float(np.linalg.norm(along))
    along = along / size if size > 0.0 else np.array([1.0, 0.0])
    across = np.array([-along[1], along[0]])
    spots = [
        end + radius * (s * along + t * across)
        for end, s in zip(ends, (-1.0, 1.0), strict=True)
        for t in (-1.0, 1.0)
    ]
    return np.array([pair.world(spot) for spot in spots])


def _pairs(pair: PlanarPair, rows: Array) -> tuple[NearestPair, ...]:
    return tuple(_nearest(pair, row) for row in rows)


def _nearest(pair: PlanarPair, row: Array) -> NearestPair:
    feature_a, at_a = pair.a.feature_at(int(row[10]), float(row[8]))
    feature_b, at_b = pair.b.feature_at(int(row[11]), float(row[9]))
    return NearestPair(
        float(row[0]),
        float(min(row[1], row[0])) - pair.slack,
        pair.world(row[2:4]),
        pair.world(row[4:6]),
        pair.turned(row[6:8]),
        feature_a,
        feature_b,
        at_a,
        at_b,
    )


def _apart(
    pair: PlanarPair, searched: Searched, inside: str, minima: float | None
) -> SolidProximity:
    """Boundaries that do not meet: apart, one in a hole of the other, or one in its material."""
    near = searched.found[searched.found[:, 0] <= searched.least + pair.tolerance]
    rows = distinct(pair, searched.found if minima else near)
    continuum = continuum_of(pair, near, searched.least)
    # what a bound near 0 leaves open is whether the boundaries meet, and so which case it is
    apart = searched.proven > 0.0
    proven = searched.least - searched.proven <= pair.tolerance + 2.0 * pair.roundoff
    if not (apart and proven):
        status = Status.DEADLINE if searched.ended == S.SPENT else Status.WITHIN
    elif inside:
        status = Status.CONTAINED
    else:
        status = Status.CONTINUUM if continuum else Status.CONVERGED
    pairs = _pairs(pair, rows)
    ties = int(np.count_nonzero(rows[:, 0] <= searched.least + pair.tolerance))
    smooth = Smoothness.SMOOTH
    if continuum:
        smooth = Smoothness.PARTIAL
    elif ties > 1:
        smooth = Smoothness.ONE_SIDED
    bounds = searched.proven if apart else -np.inf, searched.least
    found = _answer(
        pair, status, bounds, pairs, smooth, _counts(searched.counts), continuum, inside
    )
    if apart and proven:
        return found if inside else replace(found, cavity=_in_hole(pair, found))
    listed, count = _open(pair, searched)
    return replace(found, open=listed, counts=found.counts._replace(open=count))


def _answer(
    pair: PlanarPair,
    status: Status,
    bounds: tuple[float, float],
    pairs: tuple[NearestPair, ...],
    smooth: Smoothness,
    counts: SolidCounts,
    more: Continuum | Overlap | None = None,
    inside: str = "",
) -> SolidProximity:
    lower, distance = bounds
    continuum = more if isinstance(more, Continuum) else None
    overlap = more if isinstance(more, Overlap) else None
    side: Literal["A", "B", ""] = "A" if inside == "A" else "B" if inside == "B" else ""
    best = pairs[0] if pairs else _unseen()
    gradient = np.full(12, np.nan)
    if pairs:
        arms = np.concatenate(
            [
                best.normal,
                best.point_a - pair.poses[9:12],
                best.point_b - pair.poses[21:24],
            ]
        )
        write_gradient(arms, True, gradient)
    if overlap is None and status is not Status.TOUCHING and lower > -np.inf:
        lower = max(lower, 0.0)
    lower -= pair.slack
    return SolidProximity(
        status=status,
        distance=distance,
        lower_bound=lower,
        upper_bound=distance + pair.slack,
        slack=pair.slack,
        point_a=best.point_a,
        point_b=best.point_b,
        normal=best.normal,
        feature_a=best.feature_a,
        feature_b=best.feature_b,
        parameters_a=best.parameters_a,
        parameters_b=best.parameters_b,
        minima=pairs,
        continuum=continuum,
        overlap=overlap,
        inside=side,
        open=(),
        gradient_rows=gradient,
        smoothness=smooth if pairs else Smoothness.UNDEFINED,
        counts=counts,
        poses=(pair.poses[:12], pair.poses[12:]),
    )


def _in_hole(pair: PlanarPair, found: SolidProximity) -> Literal["A", "B", ""]:
    """Which solid is in a hole of the other: the nearest point is then on that loop, as nothing is
    between."""
    if found.feature_b.index >= len(pair.b.loops[0].curves):
        return "A"
    return "B" if found.feature_a.index >= len(pair.a.loops[0].curves) else ""


def _unseen() -> NearestPair:
    empty = UNSEEN.copy()
    return NearestPair(np.nan, np.nan, empty, empty, empty, NO_FEATURE, NO_FEATURE, (), ())


def _beyond(pair: PlanarPair, searched: Searched) -> SolidProximity:
    bounds = searched.proven, np.inf
    return _answer(pair, Status.FAR, bounds, (), Smoothness.UNDEFINED, _counts(searched.counts))


def _meeting(pair: PlanarPair, above: float) -> SolidProximity:
    """Boundaries that meet: all places, then the largest ball found inside both."""
    searched = search(pair, above, np.inf, meeting=-1.0)
    overlap = common_ball(pair, searched)
    if overlap is not None and overlap.radius > pair.tolerance:
        return _overlapping(pair, searched, overlap)
    near = searched.found[searched.found[:, 0] <= searched.least + pair.tolerance]
    rows = distinct(pair, searched.found if above else near)
    continuum = continuum_of(pair, near, searched.least)
    smooth = Smoothness.PARTIAL if continuum else Smoothness.SMOOTH
    if len(rows) > 1 and not continuum:
        smooth = Smoothness.ONE_SIDED
    pairs, counts = _pairs(pair, rows), _counts(searched.counts)
    normals = np.array([each.normal for each in pairs]).reshape(-1, 3)
    way = parted(normals, pair.tolerance, lambda by: _gap(pair, by) is not None)
    status = Status.TOUCHING if way < np.inf else Status.WITHIN
    bounds = -way, searched.least
    return _answer(pair, status, bounds, pairs, smooth, counts, continuum)


def _gap(pair: PlanarPair, by: Array) -> Gap | None:
    """How far the solids are apart, at least, with B moved by a world vector, and the normal there;
    None where it is not proven that they have no common point."""
    poses = pair.poses.copy()
    poses[21:24] += by
    beside = pair._replace(poses=poses)
    found = search(beside, 0.0, np.inf, meeting=0.0)
    if found.ended == S.MET or not found.proven > 0.0 or any(_inside(beside)):
        return None
    return found.proven, pair.turned(found.found[0, 6:8])


def _way_out(pair: PlanarPair) -> Array:
    """A world vector: B, moved by it, is proven to be apart from A."""
    angles = 2.0 * np.pi * np.arange(ALL_ROUND) / ALL_ROUND
    ways, away = np.column_stack([np.cos(angles), np.sin(angles)]), pair.poses[21:23]
    R_a, R_b = (pair.poses[k : k + 9].reshape(3, 3)[:2, :2] for k in (0, 12))
    lengths = pair.a.outline.heights(ways @ R_a) + pair.b.outline.heights(-ways @ R_b)
    lengths += ways @ (pair.poses[9:11] - away) + 4.0 * pair.roundoff
    return shortest(np.pad(ways, ((0, 0), (0, 1))), lengths, lambda by: _gap(pair, by))


def _deepest(pair: PlanarPair, ball: Overlap) -> float:
    """No translation shorter than this parts the solids: the ball's diameter, or how deep an end of
    one's leaves is in the other."""
    depth, there = ball.depth, (pair.poses[:12], pair.poses[12:])
    for own, other, (one, two) in (
        (pair.a.outline, pair.b.outline, there), (pair.b.outline, pair.a.outline, there[::-1])
    ):  # fmt: skip
        R_one, R_two = one[:9].reshape(3, 3)[:2, :2], two[:9].reshape(3, 3)[:2, :2]
        spots = (own.starts @ R_one.T + one[9:11] - two[9:11]) @ R_two
        distances, inside, _ = other.foot(np.ascontiguousarray(spots), pair.tolerance)
        depths = np.where(inside == 1, distances - pair.tolerance - pair.roundoff, 0.0)
        depth = max(depth, float(depths.max(initial=0.0)))
    return depth


def common_ball(pair: PlanarPair, searched: Searched) -> Overlap | None:
    """The largest ball found inside both, proven to be there."""
    R = pair.poses[:9].reshape(3, 3)[:2, :2].T @ pair.poses[12:21].reshape(3, 3)[:2, :2]
    shift = pair.poses[:9].reshape(3, 3)[:2, :2].T @ (pair.poses[21:23] - pair.poses[9:11])
    a, b = pair.a.outline, pair.b.outline
    corners = np.array([(x, y) for x in (b.low[0], b.high[0]) for y in (b.low[1], b.high[1])])
    corners = corners @ R.T + shift
    low = np.maximum(a.low, corners.min(axis=0))
    high = np.minimum(a.high, corners.max(axis=0))
    if (low > high).any():
        return None
    middle, half = 0.5 * (low + high), 0.5 * float((high - low).max())
    rows, heap = np.empty((4 * MOST_SQUARES) * S.N_ROW), np.empty(4 * MOST_SQUARES, dtype=np.int64)
    found = np.ascontiguousarray(searched.found).ravel()
    sought = (*middle, half, pair.tolerance, pair.extent, BALL_PART)
    x, y, radius, _ = entries.common_ball(
        a.arrays,
        b.arrays,
        pair.poses,
        sought,
        len(searched.found),
        MOST_SQUARES,
        (rows, heap, found),
    )
    radius -= pair.roundoff
    if not radius > 0.0:
        return None
    return Overlap(pair.world((x, y)), float(radius), 2.0 * float(radius))


def _overlapping(
    pair: PlanarPair, searched: Searched, overlap: Overlap | None = None
) -> SolidProximity:
    ball = overlap or common_ball(pair, searched)
    way = _way_out(pair)
    if ball is not None:
        ball = ball._replace(depth=_deepest(pair, ball), parting=way)
    bounds = -float(np.linalg.norm(way)), 0.0 if ball is None else -ball.depth
    rows = distinct(pair, searched.found[:1])[:1] if len(searched.found) else ()
    pairs = _pairs(pair, np.asarray(rows))
    counts = _counts(searched.counts)
    return _answer(
        pair,
        Status.OVERLAPPING,
        bounds,
        pairs,
        Smoothness.UNDEFINED,
        counts,
        ball,
    )
