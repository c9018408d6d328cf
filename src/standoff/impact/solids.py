"""The time of impact of solids that need not be convex: their distance changes no faster than they
move.

There need be no plane between solids, so the argument of `chord` does not hold. With the certified
distances L0 and L1 at both ends of an interval of the length T, and V the greatest speed of any
point of A plus that of any point of B, the distance at t within it is at least L0 - V t and at
least L1 - V (T - t), and so nowhere less than (L0 + L1 - V T) / 2.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from standoff.impact.moment import BodyBox, PairInstant
from standoff.impact.search import ImpactSearch
from standoff.motion.vectors import cross
from standoff.solids import PlanarSolid, SolidProximity, distance
from standoff.solids.spatial.models import as_model
from standoff.solids.tracked.tracker import SolidTracker, is_tracked
from standoff.tracking.inputs import flat_pose, flat_twist

SAFETY = 0.95
"""Part of the longest interval that is expected to be provable."""

ONE_STEP = 0.9
"""Part of the interval that the distance at its beginning proves alone."""


class InstantAnswer(NamedTuple):
    """What `Cold` was told at an instant."""

    proximity: SolidProximity


class Cold:
    """A pair of solids that no tracker keeps, asked from nothing at each instant."""

    def __init__(self, a: Any, b: Any, tolerance: float | None) -> None:
        self.a, self.b, self.tolerance = a, b, tolerance

    def start(self, pose_a: Any, pose_b: Any) -> InstantAnswer:
        """The answer at poses."""
        return InstantAnswer(distance(self.a, self.b, pose_a, pose_b, tolerance=self.tolerance))

    def step(
        self, before: InstantAnswer, pose_a: Any, pose_b: Any
    ) -> tuple[InstantAnswer, SolidProximity]:
        """The same; `before` is of no use."""
        del before
        now = self.start(pose_a, pose_b)
        return now, now.proximity


class SolidMoment(PairInstant):
    """Two solids at an instant."""

    def ask(self, tracker: Any, before: PairInstant | None) -> None:
        """Ask the tracker, from the earlier moment where there is one."""
        poses = self.a.pose, self.b.pose
        if before is None or before.state is None:
            self.state = tracker.start(*poses)
        else:
            self.state = tracker.step(before.state, *poses)[0]
        answer: Any = self.proximity
        self.lower, self.upper = answer.lower_bound, answer.upper_bound
        self.certified = answer.certified or answer.penetrating
        velocities = []
        for placed, point in ((self.a, answer.point_a), (self.b, answer.point_b)):
            twist = flat_twist(placed.twist, placed.pose)
            velocities.append(twist[:3] + cross(twist[3:], point - flat_pose(placed.pose)[9:]))
        self.rate = float(answer.normal @ (velocities[1] - velocities[0]))


class Lipschitz:
    """How far to look ahead where a gap changes no faster than a speed; nothing here is trusted."""

    bend = 0.0

    def __init__(self, speed: float) -> None:
        self.speed = speed

    def saw_sag(self, sag: float, span: float) -> None:
        """There is no sag."""

    def moved(self, time: float, gap: float, rate: float) -> None:
        """Nothing is learned from one interval for the next."""

    def ahead(self, gap: float, rate: float, target: float, longest: float) -> float:
        """A span after which the gap should still be `target`, and provable."""
        sure = ONE_STEP * gap / self.speed if self.speed > 0.0 else longest
        slope = max(rate, -self.speed) if math.isfinite(rate) else 0.0
        closing = self.speed - slope
        span = 2.0 * SAFETY * gap / closing if closing > 0.0 else longest
        if slope < 0.0:
            span = min(span, max((gap - target) / -slope, 0.5 * sure))
        return min(longest, max(span, 0.0))


class SolidSearch(ImpactSearch):
    """The search of two solids."""

    # faces that meet flat are proven to overlap only once they are deep in each other
    farther = 8.0

    def _seen(self, time: float) -> PairInstant:
        return SolidMoment(self.boxes, self.paths, time)

    def _paces(self) -> dict[bool, Any]:
        return {balls: Lipschitz(self.chords.speed) for balls in (True, False)}

    def _kept(self, first: PairInstant, last: PairInstant, balls: bool) -> bool:
        way = self.chords.speed * (last.time - first.time)
        return way < self.gap(first, balls) + self.gap(last, balls)

    def _slack(self, moment: PairInstant) -> float:
        answer: Any = moment.proximity
        return float(answer.slack)


def solid_search(
    a: Any, b: Any, paths: tuple[Any, Any], clearance: float, options: tuple[float, float, int]
) -> SolidSearch:
    """The search for the impact of two solids, or of one and a body.

    Raises TypeError, StandoffError: a pair of which no distance is known.

    Parameters
    ----------
    a, b : Solid, PlanarSolid, Boundary or Body
    paths : their paths, which know their bounds
    clearance : length
    options : the search's tolerance and that of its answers, relative, and its budget
    """
    tolerance, gap, budget = options
    planar = any(getattr(each, "dimension", 3) == 2 for each in (a, b))
    if planar:
        a, b = PlanarSolid.of(a, "a"), PlanarSolid.of(b, "b")
    models = (a, b) if planar else (as_model(a), as_model(b))
    size = sum(body.size for body in (a, b) if body.bounded)
    tracker: Any = Cold(a, b, gap * size)
    if not planar and is_tracked(*models):
        tracker = SolidTracker(a, b, tolerance=gap * size)
    return SolidSearch(
        tracker, (BodyBox(a), BodyBox(b)), size, paths, (clearance, tolerance, budget)
    )
