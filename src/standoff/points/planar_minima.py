"""The minima of a planar body: of the distance from a point to each of its curves.

Outside the hybrid automaton of `Tracker` answers. Inside, the depth is the least of the distances
to the curves: a branch for each local minimum, and the least wins, proven by chords of the
boundary. The switches between them are on the medial axis.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from standoff.bodies import shapes
from standoff.bodies.body import Body
from standoff.bodies.features import Feature
from standoff.checks.arrays import finite
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError
from standoff.points.answer import Minimum
from standoff.points.minima import HOME, PointMinima, pose_of, twists
from standoff.points.planar_boundary import INTERVALS, PlanarBoundary, without_radius
from standoff.points.state import AnswerDraft, Leg, PointState
from standoff.points.tolerances import (
    ENTRY_INSTANT,
    PARAMETER_AT_REST,
    SAME_PARAMETER,
    SETTLED_RESIDUAL,
    TIE,
)
from standoff.tracking.branches import Birth, Branch, Branches, BranchPlace, End
from standoff.tracking.law_options import Law
from standoff.tracking.laws import PaperLaw
from standoff.tracking.state import TrackerState
from standoff.tracking.status import Status
from standoff.tracking.tracker import Tracker
from standoff.typing import Array

# A local minimum of the distance from a point to one curve of a planar body.

MINIMUM_STEPS = 60
"""Most Newton steps to a minimum: more than any start between two samples was seen to need."""

STEP_HALVINGS = 40
"""Most halvings of one step: then it is below roundoff."""


class OnCurve(NamedTuple):
    """Where a minimum stands.

    Attributes
    ----------
    edge : int
        Its curve.
    t : float
        Its parameter.
    distance : float
        Without sign [length].
    residual : float
        As in `Minimum` [length].
    law : TrackerState or None
        Of the paper's law that keeps it; None where it is descended to.
    """

    edge: int
    t: float
    distance: float
    residual: float
    law: TrackerState | None


def descend(boundary: PlanarBoundary, edge: int, t: float, x: Array) -> float:
    """Return the parameter of the local minimum that a start leads to, by safeguarded Newton.

    Parameters
    ----------
    boundary : PlanarBoundary
    edge : int
    t : float
        Start.
    x : ndarray, shape (2,)
        The point, in the body's frame.
    """
    curve = boundary.curves[edge]
    span = curve.last - curve.first
    for _ in range(MINIMUM_STEPS):
        c, c1, c2 = curve.jet(t)
        away = c[:2] - x
        slope = float(c1[:2] @ away)
        bend = abs(float(c1[:2] @ c1[:2] + c2[:2] @ away))
        step = -slope / bend if bend > 0.0 else -math.copysign(span, slope)
        energy = float(away @ away)
        for _ in range(STEP_HALVINGS):
            new = within(boundary, edge, t + step)
            rest = boundary.point(edge, new) - x
            if float(rest @ rest) <= energy:
                break
            step *= 0.5
        else:
            return t
        moved, t = abs(step) if new != t else 0.0, new
        if moved <= PARAMETER_AT_REST * span:
            break
    return t


def within(boundary: PlanarBoundary, edge: int, t: float) -> float:
    """Return a parameter within its curve's range; on a closed curve by whole turns."""
    curve = boundary.curves[edge]
    if curve.closed:
        return curve.first + (t - curve.first) % (curve.last - curve.first)
    return min(max(t, curve.first), curve.last)


def standing(
    boundary: PlanarBoundary, edge: int, t: float, x: Array, law: TrackerState | None = None
) -> OnCurve:
    """Return what there is at a parameter of a curve, seen from a point, (2,)."""
    curve = boundary.curves[edge]
    c, c1, _ = curve.jet(t)
    away = c[:2] - x
    slope = float(c1[:2] @ away) / math.hypot(*c1[:2])
    held = not curve.closed and (
        (t <= curve.first and slope >= 0.0) or (t >= curve.last and slope <= 0.0)
    )
    return OnCurve(edge, float(t), math.hypot(*away), 0.0 if held else abs(slope), law)


def apart(boundary: PlanarBoundary, edge: int, t: float, s: float) -> float:
    """Return the part of a curve's range between two parameters; on a closed one the lesser."""
    curve = boundary.curves[edge]
    away = abs(t - s) / (curve.last - curve.first)
    return min(away, 1.0 - away) if curve.closed else away


def slope_into(
    boundary: PlanarBoundary, leg: Leg
) -> Callable[[Array, Array | None], tuple[float, float]] | None:
    """Return the switching function of a leg between a curve and the vertex at its end; else None.

    It is the slope of the distance at the vertex along the curve into it [-], and its rate [1/s],
    of a place and a velocity, (3,); negative in the curve's region.
    """
    vertex = next((f.index for f in leg[:2] if f.kind == "vertex"), None)
    edge = next((f.index for f in leg[:2] if f.kind == "edge"), None)
    if vertex is None or edge is None:
        return None
    part, corner = boundary.body.edge_parts[edge], boundary.body.vertex_points[vertex]
    first = part.first == vertex
    tangent = part.curve.jet(part.curve.first if first else part.curve.last)[1]
    into = tangent / (math.hypot(*tangent) * (1.0 if first else -1.0))

    def slope(x: Array, v: Array | None) -> tuple[float, float]:
        away = x - corner
        d = math.hypot(*away)
        if d == 0.0:
            return math.nan, math.nan
        n = away / d
        rate = math.nan if v is None else float(-into @ (v - n * (n @ v)) / d)
        return float(-into @ n), rate

    return slope


Minima = Branches[OnCurve]

POINT = ("vertex", 0)

MOST_RESTARTS = 4
"""Nearer points, met by the proof, that one frame follows up."""

LAG = 1.5 / INTERVALS
"""How far, in parts of a curve's range, a branch may be from the minimum that it follows: it is
known to half a sample, and the paper's law lags."""


class PlanarMinima(PointMinima[OnCurve]):
    """Finds, follows and proves the minima of a planar body.

    Raises ValueError: a law without switching; otherwise as `Tracker`.

    Parameters
    ----------
    body : Body
    dt : float
        Frame time [s].
    law : PredictorCorrector or PaperLaw
        In the paper's law each minimum is kept by its feedback; else it is descended to.
    """

    def __init__(self, body: Body, dt: float, law: Law) -> None:
        paper = isinstance(law, PaperLaw)
        if isinstance(law, PaperLaw) and law.switching == "none":
            raise StandoffError(
                "switching='none' stays on one feature: give 'multipliers' or 'voronoi'.",
                "law",
                law,
            )
        self.size, self.radius = body.size, body.radius
        core = without_radius(body)
        self.boundary = PlanarBoundary(core)
        self.outer = Tracker(core, shapes.point(), dt, law)
        self.law, self.inner = law, None
        if isinstance(law, PaperLaw):
            held = replace(law, tolerance=math.inf, switching="none", saturation=None)
            self.inner = Tracker(core, shapes.point(), dt, held)
        self.doubt = Status.TRACKING if paper else Status.NOT_CERTIFIED

    def read(self, value: Any, name: str) -> Array:
        """A point or velocity, (3,), in z = 0."""
        shape = (2,) if np.shape(value) == (2,) else (3,)
        given = finite(value, name, shape)
        if shape == (3,) and given[2] != 0.0:
            raise StandoffError(
                f"{name} = {given} is out of z = 0, where a planar body is.", name, value
            )
        return np.append(given[:2], 0.0)

    def begun(self, x: Array, v: Array | None) -> AnswerDraft:
        """All minima, and the least of them."""
        brackets = self.boundary.brackets(x[:2])
        places = []
        for edge in range(len(self.boundary.curves)):
            starts = [b.middle for b in brackets if b.edge == edge]
            starts = starts or [self.boundary.nearest_sample(edge, x[:2])]
            places += [(edge, descend(self.boundary, edge, t, x[:2])) for t in starts]
        return self._begun(places, x, v, None)

    def begun_from(
        self,
        x: Array,
        v: Array | None,
        parameters: Sequence[float] | Mapping[int, float],
        feature: Feature | tuple[str, int] | None,
    ) -> AnswerDraft:
        """Begin at one parameter of each curve, and outside at a feature."""
        table = parameters if isinstance(parameters, Mapping) else dict(enumerate(parameters))
        curves = self.boundary.curves
        if sorted(table) != list(range(len(curves))):
            raise StandoffError(
                f"parameters = {shown(parameters)}: give one for each of {len(curves)} curves.",
                "parameters",
                parameters,
            )
        for edge, curve in enumerate(curves):
            if not curve.first <= table[edge] <= curve.last:
                raise StandoffError(
                    f"Parameter {table[edge]} lies outside curve {edge}: "
                    f"[{curve.first}, {curve.last}].",
                    "parameters",
                    parameters,
                )
        places = [(edge, float(table[edge])) for edge in range(len(curves))]
        if self.inner is None:
            places = [(edge, descend(self.boundary, edge, t, x[:2])) for edge, t in places]
        return self._begun(places, x, v, feature)

    def _begun(
        self,
        places: Iterable[tuple[int, float]],
        x: Array,
        v: Array | None,
        feature: Feature | tuple[str, int] | None,
    ) -> AnswerDraft:
        branches = self._joined(Minima(), places, Birth.START, x, v)
        if self.boundary.inside(x[:2]) is not False:
            return self._inside(branches, x, v)
        return self._outside(branches, None, feature, x, v, self.outer.dt)

    def stepped(self, state: PointState, x: Array, v: Array | None, h: float) -> AnswerDraft:
        """Follow all minima, add those that samples show, and answer with the least."""
        side = self.boundary.inside(x[:2])
        inside = state.inside if side is None else side
        branches = self._covered(self._carried(state.branches, x, v, h), state.point, x, v)
        if inside:
            return self._inside(branches, x, v)
        return self._outside(branches, state.pair, None, x, v, h)

    def _carried(self, branches: Minima, x: Array, v: Array | None, h: float) -> Minima:
        def follow(branch: Branch[OnCurve]) -> BranchPlace[OnCurve]:
            state = branch.state
            if self.inner is None or state.law is None:
                new = self.at(state, x)
            else:
                law, answer = self.inner.step(state.law, HOME, pose_of(x), *twists(v), dt=h)
                # a walk to the bound may end a rounding beyond it
                t = within(self.boundary, state.edge, answer.parameters_a[0])
                new = standing(self.boundary, state.edge, t, x[:2], law)
            moved = apart(self.boundary, state.edge, state.t, new.t)
            return BranchPlace(new.distance, new, moved)

        return branches.carried(follow, self.same)

    def _covered(self, branches: Minima, before: Array, x: Array, v: Array | None) -> Minima:
        """With the minima that samples show and no branch follows; without the ends of curves that
        have minima inside.

        A curve whose branches are still on their way is left alone, unless a minimum is new since
        the place before.
        """
        brackets, old = self.boundary.brackets(x[:2]), self.boundary.brackets(before[:2])
        for edge, curve in enumerate(self.boundary.curves):
            shown = [b.middle for b in brackets if b.edge == edge]
            new = len(shown) > sum(b.edge == edge for b in old)
            if not new and not self._at_rest(branches, edge):
                continue
            places = [
                (edge, descend(self.boundary, edge, t, x[:2]))
                for t in shown
                if not self._followed(branches, edge, t)
            ]
            branches = self._joined(branches, places, Birth.SEARCH, x, v)
            ends = () if curve.closed else (curve.first, curve.last)
            own = [b for b in branches if b.state.edge == edge]
            at_ends = [b.key for b in own if b.state.t in ends]
            if len(at_ends) < len(own):
                gone = [key for key in at_ends if key != branches.active]
                branches = branches.ended(gone, End.LEFT)
        return branches

    def _joined(
        self,
        branches: Minima,
        places: Iterable[tuple[int, float]],
        reason: Birth,
        x: Array,
        v: Array | None,
    ) -> Minima:
        """With branches that begin at some places, as they stand."""
        found = []
        for edge, t in places:
            law = None
            if self.inner is not None:
                feature = Feature("edge", edge)
                law = self.inner.start_from(
                    HOME, pose_of(x), (feature, (t,)), (POINT, ()), *twists(v), settle=False
                )
            new = standing(self.boundary, edge, t, x[:2], law)
            found.append((new.distance, new))
        return branches.joined(found, reason, self.same)

    def _followed(self, branches: Minima, edge: int, t: float) -> bool:
        """Is a parameter one that a branch stands at, or lags behind by a sample or so?"""
        own = [b.state.t for b in branches if b.state.edge == edge]
        return any(apart(self.boundary, edge, t, s) <= LAG for s in own)

    def _at_rest(self, branches: Minima, edge: int) -> bool:
        """Have a curve's branches settled on their minima?"""
        least = math.inf if self.inner is None else SETTLED_RESIDUAL * self.size
        return all(b.state.residual <= least for b in branches if b.state.edge == edge)

    def _inside(self, branches: Minima, x: Array, v: Array | None) -> AnswerDraft:
        """The least minimum, proven; nearer points that the proof meets are followed."""
        restarts = samples = 0
        while True:
            branches = branches.settled(TIE * self.size)
            best = branches.least.state
            goal = best.distance - self.law.tolerance * self.size
            if self.law.depth == "local":
                depth = 0.0
                break
            bounds = self.boundary.bounds(x[:2], (best.edge, best.t), goal)
            depth, samples = bounds.depth, samples + bounds.samples
            if bounds.distance >= goal or restarts == MOST_RESTARTS:
                break
            edge, t = bounds.nearest
            on_the_way = not self._at_rest(branches, edge)
            if on_the_way or (self.inner is not None and self._followed(branches, edge, t)):
                break  # the law will come to it
            restarts += 1
            place = edge, descend(self.boundary, edge, t, x[:2])
            branches = self._joined(branches, [place], Birth.PROOF, x, v)
        proven = best.distance - depth <= self.law.tolerance * self.size
        doubt = Status.LOCAL if self.inner is None else self.doubt
        status = Status.GLOBAL if proven else doubt
        found = self._at_least(branches, x, -1.0, (-best.distance, -depth), status)
        return found._replace(restarts=restarts, samples=samples)

    def _at_least(
        self,
        branches: Minima,
        x: Array,
        side: float,
        bounds: tuple[float, float],
        status: Status,
    ) -> AnswerDraft:
        """The answer at the least minimum; `side` is −1 inside and 1 outside."""
        best = branches.least.state
        normal = self.height(best, x)[1]
        return AnswerDraft(
            inside=side < 0.0,
            distance=side * best.distance - self.radius,
            bounds=(bounds[0] - self.radius, bounds[1] - self.radius),
            witness=self._foot(best) + self.radius * normal,
            normal=normal,
            feature=self.feature(best),
            parameters=(best.t,),
            residual=best.residual,
            status=status,
            branches=branches,
            pair=None,
        )

    def _outside(
        self,
        branches: Minima,
        before: TrackerState | None,
        feature: Feature | tuple[str, int] | None,
        x: Array,
        v: Array | None,
        h: float,
    ) -> AnswerDraft:
        """The automaton's answer; it is entered at the least minimum, or at a given feature."""
        branches = branches.settled(TIE * self.size)
        best, pose = branches.least.state, pose_of(x)
        if before is None:
            at = self.feature(best) if feature is None else Feature(*feature)
            own = [b.state for b in branches if self.feature(b.state) == at]
            t = (min(own, key=lambda s: s.distance).t,) if own else ()
            outside = self.outer.start_from(HOME, pose, (at, t), (POINT, ()), *twists(v))
            answer = outside.proximity
            if self.inner is not None and feature is None:
                instant = ENTRY_INSTANT * self.outer.dt
                outside, answer = self.outer.step(outside, HOME, pose, *twists(v), dt=instant)
        else:
            outside, answer = self.outer.step(before, HOME, pose, *twists(v), dt=h)
        gap = self.law.tolerance * self.size
        if answer.status.penetrating:  # within roundoff of the boundary
            status = Status.CONVERGED if best.distance <= gap else self.doubt
            return self._at_least(branches, x, 1.0, (0.0, best.distance), status)
        away = x - answer.point_a
        d = float(np.linalg.norm(away))
        at_vertex = answer.feature_a.kind == "vertex" and d > 0.0
        shown = best
        if answer.feature_a.kind == "edge":
            shown = best._replace(edge=answer.feature_a.index, t=answer.parameters_a[0])
        normal = away / d if at_vertex else self.height(shown, x)[1]
        lower = max(answer.lower_bound, 0.0)
        doubt = self.doubt if answer.status is not Status.NOT_RESTARTED else answer.status
        return AnswerDraft(
            inside=False,
            distance=answer.distance - self.radius,
            bounds=(lower - self.radius, answer.distance - self.radius),
            witness=answer.point_a + self.radius * normal,
            normal=normal,
            feature=answer.feature_a,
            parameters=answer.parameters_a,
            residual=answer.residual,
            status=Status.CONVERGED if answer.distance - lower <= gap else doubt,
            branches=branches,
            pair=outside,
            told=tuple(Leg(e.source, e.target) for e in answer.events if e.body == "A"),
            restarts=answer.counts.restarts if before is not None else 0,
        )

    def _foot(self, state: OnCurve) -> Array:
        return np.append(self.boundary.point(state.edge, state.t), 0.0)

    def shown(self, branch: Branch[OnCurve]) -> Minimum:
        state = branch.state
        normal = np.append(self.boundary.normal(state.edge, state.t), 0.0)
        return Minimum(
            self.feature(state),
            (state.t,),
            state.distance,
            self._foot(state),
            normal,
            state.residual,
            branch.key,
        )

    def same(self, one: OnCurve, other: OnCurve) -> bool:
        if one.edge != other.edge:
            return False
        return apart(self.boundary, one.edge, one.t, other.t) <= SAME_PARAMETER

    def at(self, state: OnCurve, x: Array) -> OnCurve:
        t = descend(self.boundary, state.edge, state.t, x[:2])
        return standing(self.boundary, state.edge, t, x[:2])

    def feature(self, state: OnCurve) -> Feature:
        return Feature("edge", state.edge)

    def depth(self, state: OnCurve, x: Array) -> tuple[float, Array]:
        to = self._foot(state) - x
        d = math.hypot(*to)
        return state.distance, to / d if d > 0.0 else np.zeros(3)

    def height(self, state: OnCurve, x: Array) -> tuple[float, Array]:
        normal = np.append(self.boundary.normal(state.edge, state.t), 0.0)
        return float(normal @ (x - self._foot(state))), normal

    def least_of_both(
        self, before: PointState, after: PointState, x: Array
    ) -> tuple[OnCurve | None, OnCurve | None]:
        if self.inner is None:
            return super().least_of_both(before, after, x)
        left = before.branches.least
        source = after.branches.of_key(left.key)
        # of branches that have begun since, one key may be another curve's
        known = source is not None and source.state.edge == left.state.edge
        return source.state if source and known else None, after.branches.least.state

    def function(self, before: PointState, after: PointState) -> Callable[[Array], float] | None:
        # the paper's law switches where it does, not where it should
        return None if self.inner is not None else super().function(before, after)

    def legs(self, before: PointState, after: PointState, told: Sequence[Leg]) -> list[Leg]:
        """The way that was told, if it leads from one feature to the other, else the one leg."""
        if before.inside and after.inside:
            return []
        one, other = before.proximity.feature, after.proximity.feature
        if before.inside:
            one = self.feature(after.branches.least.state)
        if one == other:
            return []
        joined = all(a.target == b.source for a, b in pairwise(told))
        if told and joined and told[0].source == one and told[-1].target == other:
            return list(told)
        return [Leg(one, other)]

    def line(self, leg: Leg) -> Callable[[Array, Array | None], tuple[float, float]] | None:
        return slope_into(self.boundary, leg)
