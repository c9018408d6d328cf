"""Local minima of the distance from a point inside a spatial body to its boundary, tracked."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies import shapes
from standoff.bodies.body import Body
from standoff.points.parallel_minima import HOME, pose_of
from standoff.points.tolerances import DEPTH_ROUNDOFF, RAY_WITHIN, SAME_NORMAL
from standoff.tracking.laws import PredictorCorrector
from standoff.tracking.state import TrackerState
from standoff.tracking.tracker import Tracker

Array = NDArray[np.float64]


FAR = 4.0
"""Where a ray is surely outside a bounded body, in sizes of the body."""


RAY_STEPS = 40
"""Most steps of a ray to the boundary."""

RAY_DIRECTIONS = np.array(
    [d for d in product((-1.0, 0.0, 1.0), repeat=3) if sum(map(abs, d)) in (1, 3)]
)
"""Along the axes and the space diagonals, not of unit length."""


class Branch(NamedTuple):
    """One local minimum with the state of the tracker that follows it."""

    key: int
    state: TrackerState

    @property
    def depth(self) -> float:
        """Distance to the boundary, positive inside [length]."""
        return -self.state.proximity.distance

    @property
    def normal(self) -> Array:
        """Outward unit normal, (3,)."""
        return self.state.proximity.normal


class DepthBranches:
    """Finds and follows the local minima of one body.

    A prediction may lead into another minimum's basin; without any, the descent stays in its own.
    """

    def __init__(self, body: Body) -> None:
        self.size = body.size
        law = PredictorCorrector(predictor="none", depth="local")
        self.local = Tracker(body, shapes.point(), law=law)

    def cold(self, x: Array) -> TrackerState:
        """The least minimum at a point, (3,), with its proof; outside the distance."""
        return self.local.start(HOME, pose_of(x))

    def at(self, state: TrackerState, x: Array) -> TrackerState:
        """The minimum of a state, followed to a point, (3,)."""
        return self.local.step(state, HOME, pose_of(x))[0]

    def carried(
        self, branches: Sequence[Branch], start: Array, x: Array, next_key: int
    ) -> tuple[list[Branch], int]:
        """The branches at the next point; what has jumped to another minimum gets a new key.

        A branch's depth changes by no more than the point moves. Of branches that have come to
        one minimum, the one stays whose normal has turned least.
        """
        reach = float(np.linalg.norm(x - start)) + DEPTH_ROUNDOFF * self.size
        moved: list[tuple[float, Branch]] = []
        for branch in branches:
            state = self.at(branch.state, x)
            new = Branch(branch.key, state)
            if new.depth <= 0.0:
                continue
            if abs(new.depth - branch.depth) > reach:
                new, next_key = Branch(next_key, state), next_key + 1
                moved.append((np.inf, new))
            else:
                moved.append((float(np.linalg.norm(new.normal - branch.normal)), new))
        kept: list[Branch] = []
        for _, branch in sorted(moved, key=lambda pair: pair[0]):
            if known(kept, branch.state) is None:
                kept.append(branch)
        return sorted(kept, key=lambda b: b.key), next_key

    def joined(
        self, branches: list[Branch], states: Sequence[TrackerState], next_key: int
    ) -> tuple[list[Branch], int]:
        """The branches with those of further states that are not among them."""
        found = list(branches)
        for state in states:
            if state.proximity.distance < 0.0 and known(found, state) is None:
                found.append(Branch(next_key, state))
                next_key += 1
        return found, next_key

    def seeds(self, x: Array) -> list[TrackerState]:
        """Minima at a point, (3,), followed back from where rays meet the boundary."""
        if not np.isfinite(self.size):
            return []  # a half-space has one minimum
        return [self.at(self._ray(x, d / np.linalg.norm(d)), x) for d in RAY_DIRECTIONS]

    def _ray(self, x: Array, direction: Array) -> TrackerState:
        """The state just within the boundary where a ray leaves the body.

        The signed distance is convex along it: Newton's method comes to the boundary from outside
        and never passes it.
        """
        way = FAR * self.size
        for _ in range(RAY_STEPS):
            p = self.cold(x + way * direction).proximity
            if p.distance <= RAY_WITHIN * self.size:
                break
            way -= p.distance / float(p.normal @ direction)
        return self.cold(x + (1.0 - RAY_WITHIN) * way * direction)


def known(branches: Sequence[Branch], state: TrackerState) -> Branch | None:
    """The branch that is at a state's minimum, if one is."""
    normal = state.proximity.normal
    for branch in branches:
        if float(np.linalg.norm(branch.normal - normal)) <= SAME_NORMAL:
            return branch
    return None
