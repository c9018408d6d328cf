"""Answers of two planar solids judged by the study's own curves.

The judge finds the least distance of both boundaries by samples, and downhill from all samples that
may be nearest: what it finds bounds the distance from above to a rounding. From below the samples
less their reaches bound it. A witness point is on a boundary, or it is not; a ball is inside both.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

import standoff as so
from standoff.solids import SolidProximity
from standoff_studies.soak import planar_truth
from standoff_studies.soak.planar_drawn import Judged, move_of
from standoff_studies.soak.planar_truth import Array

TOLERANCE = 1.01e-10
"""Of the larger size: how wide a proven interval may be."""
NOISE = 1e-12
"""Of both sizes and the distance: what roundings may do to a length."""
ON_IT = 1e-11
"""The same of a witness point, and of a ball."""

APART = (so.Status.CONVERGED, so.Status.CONTINUUM, so.Status.CONTAINED)
OPEN = (so.Status.WITHIN, so.Status.DEADLINE)


class Truth(NamedTuple):
    """Of a pair at its poses.

    Attributes
    ----------
    seen, least : float
        Between samples, and between the boundaries downhill from them.
    size : float
        The larger one.
    extent : float
        Both sizes, the distance between both origins, and theirs from the world's.
    reach : float
        The distance between the boundaries is at least `seen` less this.
    b_in_a, a_in_b : bool
        Is B's outer loop in A's material, A's in B's; where the boundaries are clearly apart.
    both : bool
        Is there material of both at one place, though the boundaries are apart?
    """

    seen: float
    least: float
    size: float
    extent: float
    reach: float
    b_in_a: bool
    a_in_b: bool
    both: bool


def truth_of(a: Judged, b: Judged, pose_a: so.Pose, pose_b: so.Pose) -> Truth:
    """What is true of a pair."""
    move = move_of(pose_a, pose_b)
    seen, least = planar_truth.least_distance(a.outline, b.outline, move)
    away = [float(np.linalg.norm(pose.translation)) for pose in (pose_a, pose_b)]
    extent = a.size + b.size + sum(away)
    back = planar_truth.inverse(move)
    in_a = _loops_inside(a, b, move)
    in_b = _loops_inside(b, a, back)
    both = bool(in_a.any() and in_b.any())
    reach = a.outline.reach + b.outline.reach
    size = max(a.size, b.size)
    return Truth(seen, least, size, extent, reach, bool(in_a.any()), bool(in_b.any()), both)


def _loops_inside(a: Judged, b: Judged, move: tuple[float, float, float, float]) -> Array:
    """Which loops of B begin in A's material."""
    first = b.outline.samples[b.outline.loops[:-1]]
    spots = [planar_truth.placed(move, float(x), float(y)) for x, y in first]
    return np.array([planar_truth.holds(a.outline, x, y) for x, y in spots])


def faults_of(
    a: Judged, b: Judged, pose_a: so.Pose, pose_b: so.Pose, told: SolidProximity, true: Truth
) -> list[tuple[str, str]]:
    """(kind, what was expected and told) of each fault; none if the answer is right."""
    noise = NOISE * true.extent
    if told.status is so.Status.OVERLAPPING:
        # a ball inside both proves it, wherever the descents between the boundaries have ended
        free = _free(a, b, pose_a, pose_b, told)
        found = [] if min(free) > ON_IT * true.extent else _status_faults(told, true)
        return found + _ball_faults(told, true, free)
    found = _status_faults(told, true)
    clear = true.seen > 2.0 * true.reach
    if told.lower_bound > true.least + noise:
        found.append(("bound", f"lower {told.lower_bound!r} above {true.least!r}"))
    if told.distance > true.least + TOLERANCE * true.size + noise and told.status not in OPEN:
        found.append(("distance", f"{told.distance!r} above {true.least!r}"))
    if told.upper_bound < true.seen - true.reach - noise:
        found.append(("bound", f"upper {told.upper_bound!r} below {true.seen - true.reach!r}"))
    if told.lower_bound > told.upper_bound:
        found.append(("bound", f"lower {told.lower_bound!r} above upper {told.upper_bound!r}"))
    wide = told.upper_bound - told.lower_bound
    if told.status in APART and not wide <= TOLERANCE * true.size + noise:
        found.append(("width", f"{wide!r}"))
    if clear and told.status in APART and told.inside != _inside(true):
        found.append(("inside", f"{told.inside!r}, not {_inside(true)!r}"))
    return found + _witness_faults(a, b, pose_a, pose_b, told, true)


def _inside(true: Truth) -> str:
    return "B" if true.b_in_a else "A" if true.a_in_b else ""


def _status_faults(told: SolidProximity, true: Truth) -> list[tuple[str, str]]:
    status = told.status
    meeting = TOLERANCE * true.size + NOISE * true.extent
    clear = true.seen > 2.0 * true.reach
    if clear:
        if true.both:
            right = {so.Status.OVERLAPPING}
        elif true.b_in_a or true.a_in_b:
            right = {so.Status.CONTAINED}
        else:
            right = {so.Status.CONVERGED, so.Status.CONTINUUM}
    elif true.least > meeting:
        right = {*APART, so.Status.OVERLAPPING} if true.both else {*APART}
    else:
        right = {so.Status.OVERLAPPING, so.Status.TOUCHING, *APART}
    if status in right or status in OPEN:
        return []
    return [("status", f"{status.name}, but by {true.least!r} it is {right}")]


def _frame(pose: so.Pose, point: Array) -> tuple[float, float]:
    R, p = np.asarray(pose.rotation), np.asarray(pose.translation)
    x, y = (R.T @ (np.asarray(point) - p))[:2]
    return float(x), float(y)


def _witness_faults(
    a: Judged, b: Judged, pose_a: so.Pose, pose_b: so.Pose, told: SolidProximity, true: Truth
) -> list[tuple[str, str]]:
    """Points on both boundaries at the distance that is told."""
    spare = ON_IT * true.extent
    found = []
    pairs = [(told.point_a, told.point_b, told.distance)]
    pairs += [(m.point_a, m.point_b, m.distance) for m in told.minima[1:4]]
    for k, (x, y, distance) in enumerate(pairs):
        off = max(
            float(planar_truth.to_boundary(a.outline, *_frame(pose_a, x))),
            float(planar_truth.to_boundary(b.outline, *_frame(pose_b, y))),
        )
        if not off <= spare:
            found.append(("witness", f"{off!r} off a boundary, place {k}"))
        length = float(np.linalg.norm(np.asarray(y) - np.asarray(x)))
        if not abs(length - distance) <= spare:
            found.append(("witness", f"{length!r} apart, not {distance!r}, place {k}"))
    return found


def _free(
    a: Judged, b: Judged, pose_a: so.Pose, pose_b: so.Pose, told: SolidProximity
) -> tuple[float, float]:
    """How far the middle of the common ball is inside A and B, negative outside; minus infinity
    without a ball."""
    if told.overlap is None:
        return -np.inf, -np.inf
    middle = told.overlap.common_point
    in_a, in_b = (
        _inside_by(one, *_frame(pose, middle)) for one, pose in ((a, pose_a), (b, pose_b))
    )
    return in_a, in_b


def _inside_by(one: Judged, x: float, y: float) -> float:
    free = float(planar_truth.to_boundary(one.outline, x, y))
    clear = free > 2.0 * one.outline.reach
    holds = planar_truth.holds if clear else planar_truth.holds_finely
    return free if holds(one.outline, x, y) else -free


def _ball_faults(
    told: SolidProximity, true: Truth, free: tuple[float, float]
) -> list[tuple[str, str]]:
    """A ball inside both, no larger than half the depth, and a way out."""
    spare = ON_IT * true.extent
    if told.overlap is None:
        # boundaries apart, and material of both: no ball is asked for there
        return [] if true.both else [("ball", "none")]
    radius, found = told.overlap.radius, []
    if not radius > 0.0:
        found.append(("ball", f"radius {radius!r}"))
    if not (told.distance == -told.overlap.depth <= spare - 2.0 * radius):
        found.append(("ball", f"radius {radius!r}, distance {told.distance!r}"))
    if not -np.inf < told.lower_bound <= told.distance:
        found.append(("ball", f"lower bound {told.lower_bound!r}"))
    for name, inside in zip("AB", free, strict=True):
        if inside < radius - spare:
            found.append(("ball", f"radius {radius!r}, but its middle is {inside!r} inside {name}"))
    return found
