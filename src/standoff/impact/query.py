"""The time of impact of any two bodies."""

from __future__ import annotations

from typing import Any

from standoff.bodies.body import Body
from standoff.bodies.boundary import Boundary
from standoff.checks.numbers import positive, whole_number
from standoff.impact.answer import Impact
from standoff.impact.moment import BodyBox
from standoff.impact.search import ImpactSearch, checked_clearance, checked_times
from standoff.impact.tolerances import TRACKER_SHARE, TRACKER_TOLERANCE
from standoff.motion.bounds import known
from standoff.motion.moving import MotionLike, moving
from standoff.tracking.laws import PredictorCorrector
from standoff.tracking.tracker import Tracker


def time_of_impact(  # noqa: PLR0913 - four of them are keywords with defaults
    a: Any,
    b: Any,
    path_a: MotionLike,
    path_b: MotionLike,
    duration: float,
    *,
    clearance: float = 0.0,
    tolerance: float = 1e-9,
    start: float = 0.0,
    max_evaluations: int = 10_000,
) -> Impact:
    """The first time at which two moving bodies come to a clearance: never later than the true one.

    Each interval of time is proven free by the certified bounds at its ends and the greatest
    accelerations within it, or of solids the greatest speeds (docs/impact-proof.md).

    Raises TypeError: not a body, neither path nor pose, or a path of which no bounds are known.
    Raises ValueError: a negative clearance, a tolerance or duration that is not positive, a budget
    that is not a whole number of at least 2, times beyond 1e50 s, a duration that is negligible
    compared with the start, a pair that cannot be tracked, or a time that a path refuses.

    Parameters
    ----------
    a, b : Body, Solid, Boundary or PlanarSolid
        Two spatial bodies, or two planar ones.
    path_a, path_b : path or pose
        A path of ``standoff.motion``; with a pose the body is at rest. A path of your own, or a
        function of time that returns a pose, is wrapped in ``standoff.motion.Bounded``, which says
        how fast it can be.
    duration : float
        Time to search [s]; ``start + duration`` must differ from ``start`` in floating point.
    clearance : float
        Distance that counts as impact, zero for contact [length].
    tolerance : float
        The search ends within this distance of the clearance, relative to the sum of the bodies'
        sizes (without a half-space's).
    start : float
        Time on the paths' clock at which the search begins [s].
    max_evaluations : int
        Greatest number of instants to look at.

    Returns
    -------
    Impact
    """
    paths = moving(path_a, "path_a"), moving(path_b, "path_b")
    for path in paths:
        known(path)
    begin, end = checked_times(paths, start, duration)
    clearance = checked_clearance(clearance)
    tolerance = positive(tolerance, "tolerance")
    whole_number(max_evaluations, "max_evaluations", 2)
    gap = min(TRACKER_TOLERANCE, TRACKER_SHARE * tolerance)
    asked = clearance, tolerance, max_evaluations
    if is_solid(a) or is_solid(b):
        from standoff.impact.solids import solid_search

        return solid_search(a, b, paths, clearance, (tolerance, gap, max_evaluations)).run(
            begin, end
        )
    tracker = Tracker(a, b, law=PredictorCorrector(tolerance=gap))
    size = sum(body.size for body in (tracker.a, tracker.b) if body.bounded)
    return ImpactSearch(tracker, (BodyBox(a), BodyBox(b)), size, paths, asked).run(begin, end)


def is_solid(body: Any) -> bool:
    """Is it a solid that need not be convex, or a boundary that was not proven to be?"""
    return hasattr(body, "cold_query") or (
        isinstance(body, Boundary) and not isinstance(body, Body)
    )
