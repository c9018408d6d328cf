"""The minima of a spatial body: of the distance from a point inside to the boundary.

Outside the tracker of the pair answers. Inside, the depth is the least of several local minima: a
branch for each, and the least wins. The switches between them are on the medial axis.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import product
from typing import Any

import numpy as np

from standoff.bodies import shapes
from standoff.bodies.body import Body
from standoff.bodies.features import Feature
from standoff.checks.arrays import finite
from standoff.errors import StandoffError
from standoff.points.answer import Minimum
from standoff.points.minima import HOME, PointMinima, pose_of, twists
from standoff.points.state import AnswerDraft, Leg, PointState
from standoff.points.tolerances import DEPTH_ROUNDOFF, RAY_WITHIN, SAME_NORMAL, TIE
from standoff.tracking.branches import Birth, Branch, Branches, BranchPlace, End
from standoff.tracking.law_options import Law
from standoff.tracking.laws import PredictorCorrector
from standoff.tracking.state import TrackerState
from standoff.tracking.tracker import Tracker
from standoff.typing import Array

Minima = Branches[TrackerState]

FAR = 4.0
"""Where a ray is surely outside a bounded body, in sizes of the body."""

RAY_STEPS = 40
"""Most steps of a ray to the boundary."""

RAY_DIRECTIONS = np.array(
    [d for d in product((-1.0, 0.0, 1.0), repeat=3) if sum(map(abs, d)) in (1, 3)]
)
"""Along the axes and the space diagonals, not of unit length."""


class SpatialMinima(PointMinima[TrackerState]):
    """Finds, follows and proves the minima of a spatial body; a state is a pair tracker's.

    A prediction may lead into another minimum's basin; without any, the descent stays in its own.

    Raises ValueError: another law; otherwise as `Tracker`.

    Parameters
    ----------
    body : Body
    dt : float
        Frame time [s].
    law : PredictorCorrector
        Of the pair, outside and for the proof inside.
    """

    def __init__(self, body: Body, dt: float, law: Law) -> None:
        if not isinstance(law, PredictorCorrector):
            raise StandoffError(
                "The paper's law keeps points on a planar body's curves; for a spatial body give "
                "so.PredictorCorrector.",
                "law",
                law,
            )
        self.size, self.law = body.size, law
        alone = PredictorCorrector(predictor="none", depth="local")
        self.local = Tracker(body, shapes.point(), law=alone)
        self.outer = Tracker(body, self.local.b, dt, law)

    def read(self, value: Any, name: str) -> Array:
        """A point or a velocity, (3,), writable: the kernels are compiled for such arrays."""
        return finite(value, name, (3,)).copy()

    def begun(self, x: Array, v: Array | None) -> AnswerDraft:
        """The least minimum, with its proof, and others."""
        proof = self.outer.start(HOME, pose_of(x), *twists(v))
        return self._answered(self._entered(Minima(), Birth.START, proof, x), proof)

    def stepped(self, state: PointState, x: Array, v: Array | None, h: float) -> AnswerDraft:
        """Outside the pair's frame; inside all minima followed, and the least proven."""
        pose, proven = pose_of(x), self.law.depth == "global"
        if state.pair is None:
            raise StandoffError(
                "The state has no pair: it belongs to a planar body.", "state", state
            )
        if proven and state.inside:
            proof = self.outer.start(HOME, pose, *twists(v))
        else:
            proof = self.outer.step(state.pair, HOME, pose, *twists(v), dt=h)[0]
            if proven and proof.proximity.distance < 0.0:
                proof = self.outer.start(HOME, pose, *twists(v))
        branches = state.branches.at_frame()
        if proof.proximity.distance >= 0.0:
            branches = branches.ended([b.key for b in branches], End.LEFT)
        elif state.inside:
            branches = self._carried(branches, state.point, x)
            branches = self._joined(branches, [proof], Birth.PROOF)
        else:
            branches = self._entered(branches, Birth.SEARCH, proof, x)
        return self._answered(branches, proof)

    def _entered(self, branches: Minima, reason: Birth, proof: TrackerState, x: Array) -> Minima:
        """With the proof's own minimum and what rays find; with none outside."""
        if proof.proximity.distance >= 0.0:
            return branches
        return self._joined(branches, [proof, *self._seeds(x)], reason)

    def _carried(self, branches: Minima, start: Array, x: Array) -> Minima:
        """The branches at the next point.

        A branch's depth changes by no more than the point moves: what has changed by more has
        jumped to another minimum.
        """
        reach = float(np.linalg.norm(x - start)) + DEPTH_ROUNDOFF * self.size

        def follow(branch: Branch[TrackerState]) -> BranchPlace[TrackerState]:
            state = self.at(branch.state, x)
            depth, normal = self.depth(state, x)
            turn = float(np.linalg.norm(normal - self.depth(branch.state, start)[1]))
            end = End.JUMPED if abs(depth - branch.value) > reach else None
            return BranchPlace(depth, state, turn, End.LEFT if depth <= 0.0 else end)

        return branches.carried(follow, self.same)

    def _joined(self, branches: Minima, states: Sequence[TrackerState], reason: Birth) -> Minima:
        inner = [(-s.proximity.distance, s) for s in states if s.proximity.distance < 0.0]
        return branches.joined(inner, reason, self.same)

    def _answered(self, branches: Minima, proof: TrackerState) -> AnswerDraft:
        """The least minimum inside, the pair's answer outside."""
        branches = branches.settled(TIE * self.size)
        inside = len(branches) > 0
        whole = proof.proximity
        p = branches.least.state.proximity if inside else whole
        return AnswerDraft(
            inside=inside,
            distance=p.distance,
            bounds=(p.lower_bound, max(p.distance, whole.upper_bound)),
            witness=p.point_a.copy(),
            normal=p.normal.copy(),
            feature=p.feature_a,
            parameters=p.parameters_a,
            residual=p.residual,
            status=whole.status,
            branches=branches,
            pair=proof,
            told=tuple(Leg(*e[2:]) for e in whole.events if e.body == "A"),
            restarts=0 if inside else whole.counts.restarts,
            samples=whole.counts.evaluations,
        )

    def _seeds(self, x: Array) -> list[TrackerState]:
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
            p = self._cold(x + way * direction).proximity
            if p.distance <= RAY_WITHIN * self.size:
                break
            way -= p.distance / float(p.normal @ direction)
        return self._cold(x + (1.0 - RAY_WITHIN) * way * direction)

    def _cold(self, x: Array) -> TrackerState:
        """The least minimum at a point, (3,), with its proof; outside the distance."""
        return self.local.start(HOME, pose_of(x))

    def at(self, state: TrackerState, x: Array) -> TrackerState:
        return self.local.step(state, HOME, pose_of(x))[0]

    def shown(self, branch: Branch[TrackerState]) -> Minimum:
        p = branch.state.proximity
        place, normal = p.point_a.copy(), p.normal.copy()
        return Minimum(
            p.feature_a, p.parameters_a, -p.distance, place, normal, p.residual, branch.key
        )

    def same(self, one: TrackerState, other: TrackerState) -> bool:
        turn = one.proximity.normal - other.proximity.normal
        return float(np.linalg.norm(turn)) <= SAME_NORMAL

    def feature(self, state: TrackerState) -> Feature:
        return state.proximity.feature_a

    def depth(self, state: TrackerState, x: Array) -> tuple[float, Array]:
        return -state.proximity.distance, state.proximity.normal

    def height(self, state: TrackerState, x: Array) -> tuple[float, Array]:
        return state.proximity.distance, state.proximity.normal

    def changed(self, before: PointState, after: PointState, known: int) -> bool:
        # the pair's tracker tells changes of feature outside, and dates them to its frame
        return (before.inside or after.inside) and super().changed(before, after, known)

    def line(self, leg: Leg) -> Callable[[Array, Array | None], tuple[float, float]] | None:
        return None

    def legs(self, before: PointState, after: PointState, told: Sequence[Leg]) -> list[Leg]:
        return [] if before.inside or after.inside else list(told)
