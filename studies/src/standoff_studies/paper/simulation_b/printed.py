"""The printed system along the spiral: parallel trackers inside, one with Voronoi tests outside.

Inside, each curve has its own tracker from the start; the medial axis determines which of them is
active at the point's place. Where the point crosses the boundary, the active tracker's parameter is
handed over unchanged. Nothing is searched, added or corrected on the way.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from standoff.bodies import Body, shapes
from standoff.bodies.voronoi import VoronoiRegions
from standoff.motion import Spiral
from standoff.points import PointEvent, PointVisit
from standoff.points.planar_boundary import PlanarBoundary
from standoff.recording import RecordedEvent, Recording
from standoff.recording.track import track_along
from standoff.tracking import Feature, Tracker, TrackerState
from standoff.tracking.laws import PaperLaw
from standoff.typing import Array
from standoff_studies.paper.law_words import law_words
from standoff_studies.paper.many_starts import begun
from standoff_studies.paper.pair_simulation import AT_POINT, REST
from standoff_studies.paper.simulation_b.medial import MedialRegions, first_change


@dataclass(frozen=True, eq=False)
class PrintedRun:
    """A run by frame; row k of every array belongs to ``time[k]``. Lengths in the body's unit.

    Attributes
    ----------
    time : ndarray, shape (n,)
        s
    point, witness : ndarray, shape (n, 3)
    distance : ndarray, shape (n,)
        Negative inside.
    inside : ndarray of bool, shape (n,)
    feature : ndarray of Feature, shape (n,)
        The active one.
    parameter : ndarray, shape (n,)
        Of the active curve; nan at a vertex.
    curve_parameter, curve_distance : ndarray, shape (n, curves)
        Of the parallel trackers, distances without sign; outside, only of the active curve, else
        nan. A tracker follows one local minimum of the distance to its curve, not always the
        nearest.
    events : tuple of PointEvent
        In order of time. The value of a jump inside is the point's distance from the medial axis.
    parts : tuple of Recording
        Of the parallel trackers, one for each curve.
    body : Body
    outside : Recording
        From the frame on in which the point is outside.
    """

    time: Array
    point: Array
    witness: Array
    distance: Array
    inside: NDArray[np.bool_]
    feature: NDArray[np.object_]
    parameter: Array
    curve_parameter: Array
    curve_distance: Array
    events: tuple[PointEvent, ...]
    parts: tuple[Recording, ...] = field(repr=False)
    body: Body = field(repr=False)
    outside: Recording = field(repr=False)

    def __len__(self) -> int:
        return len(self.time)

    @property
    def by(self) -> str:
        """The law with which statements on the run were measured."""
        inside, outside = law_words(*self.parts), law_words(self.outside)
        within = f"inside, a tracker a curve and the medial axis, {inside}"
        return f"{within}; outside, {outside}; wrong start"

    def modes(self) -> list[PointVisit]:
        """Return the visited modes in order of time, without stays of zero length."""
        inside, feature, start = bool(self.inside[0]), self.feature[0], float(self.time[0])
        visits: list[PointVisit] = []
        for event in self.events:
            if event.time > start:
                visits.append(PointVisit(inside, feature, start, event.time))
                start = event.time
            inside, feature = inside ^ (event.kind == "crossing"), event.target
        visits.append(PointVisit(inside, feature, start, float(self.time[-1])))
        return visits


class Printed:
    """Runs the printed system of one body, from any start.

    Parameters
    ----------
    body : Body
    regions : VoronoiRegions
        Its regions, computed before the run.
    path : Spiral
        Of the point, from inside to outside.
    times : ndarray, shape (n,)
        Of the frames [s].
    gain : float
        K [1/s]
    """

    def __init__(
        self, body: Body, regions: VoronoiRegions, path: Spiral, times: Array, gain: float
    ) -> None:
        self.body, self.path, self.times = body, path, times
        self.medial, self.boundary = MedialRegions(body, regions), PlanarBoundary(body)
        dt, law = float(times[1] - times[0]), PaperLaw.as_printed(gain=gain)
        alone = PaperLaw(
            gain=gain, switching="none", saturation="zero", solve="plain", restarts=False
        )
        self.parallel = Tracker(body, shapes.point(), dt, law=alone)
        self.outside = Tracker(body, shapes.point(), dt, law=law)
        self.point = np.array([path.pose(t).translation for t in times.tolist()])
        inside = np.array([self.boundary.inside(x[:2]) is not False for x in self.point])
        self.leaves = int(inside.argmin())
        if not inside[0] or inside[self.leaves :].any():
            raise ValueError("the path must begin inside the body and leave it once")
        self.nearest = np.array(
            [self.medial.nearest_curve(x[:2]) for x in self.point[: self.leaves + 1]]
        )
        self.nearest[-1] = self.nearest[-2]  # outside: the curve through which it left

    def begun(self, law: Tracker, feature: Feature, parameter: float, frame: int) -> TrackerState:
        """Return a law's state at any parameter of a curve."""
        paths, time = (REST, self.path), float(self.times[frame])
        return begun(law, paths, (feature, (parameter,)), AT_POINT, time)

    def run(self, start: tuple[float, ...]) -> PrintedRun:
        """Track the point all the way from one parameter for each curve."""
        edges = [Feature("edge", curve) for curve in range(self.body.n_edges)]
        within = self.times[: self.leaves + 1]
        runs = [
            track_along(
                self.parallel, REST, self.path, within, state=self.begun(self.parallel, edge, u, 0)
            )
            for edge, u in zip(edges, start, strict=True)
        ]
        active = edges[self.nearest[-1]]
        u = float(runs[active.index].parameters_a[-1, 0])
        state = self.begun(self.outside, active, u, self.leaves)
        rest = track_along(self.outside, REST, self.path, self.times[self.leaves :], state=state)
        return self._joined(runs, rest)

    def _joined(self, runs: list[Recording], rest: Recording) -> PrintedRun:
        """The parallel runs up to the boundary, then the one from there on."""
        n, m, curves = len(self.times), self.leaves, self.body.n_edges
        parameters, away = np.full((n, curves), np.nan), np.full((n, curves), np.nan)
        for curve, run in enumerate(runs):
            parameters[:m, curve], away[:m, curve] = run.parameters_a[:m, 0], run.distance[:m]
        feature = np.empty(n, dtype=object)
        feature[:m] = [Feature("edge", int(curve)) for curve in self.nearest[:m]]
        feature[m:] = rest.feature_a
        for k in range(m, n):
            if feature[k].kind == "edge":
                parameters[k, feature[k].index] = rest.parameters_a[k - m, 0]
                away[k, feature[k].index] = rest.distance[k - m]
        rows, active = np.arange(m), self.nearest[:m]
        witness = np.array([run.point_a[:m] for run in runs])[active, rows]
        held = [
            parameters[k, f.index] if f.kind == "edge" else np.nan for k, f in enumerate(feature)
        ]
        return PrintedRun(
            time=self.times,
            point=self.point,
            witness=np.vstack([witness, rest.point_a]),
            distance=np.concatenate([-away[rows, active], rest.distance]),
            inside=np.arange(n) < m,
            feature=feature,
            parameter=np.array(held),
            curve_parameter=parameters,
            curve_distance=away,
            events=(*self._jumps(), self._crossing(runs), *map(_outer, rest.events)),
            parts=tuple(runs),
            body=self.body,
            outside=rest,
        )

    def _jumps(self) -> list[PointEvent]:
        """The point's crossings of the medial axis, from its path alone."""
        found = []
        for k in np.flatnonzero(np.diff(self.nearest)).tolist():
            time = first_change(self._region, float(self.times[k]), float(self.times[k + 1]))
            ends = int(self.nearest[k]), int(self.nearest[k + 1])
            x, v = self.path.pose(time).translation[:2], self.path.twist(time).v[:2]
            source, target = (Feature("edge", curve) for curve in ends)
            found.append(
                PointEvent(time, "medial", source, target, *self.medial.offset(*ends, x, v), True)
            )
        return found

    def _region(self, time: float) -> int:
        return self.medial.nearest_curve(self.path.pose(time).translation[:2])

    def _out(self, time: float) -> int:
        return int(self.boundary.inside(self.path.pose(time).translation[:2]) is False)

    def _crossing(self, runs: list[Recording]) -> PointEvent:
        """Where the point goes through the boundary, from its path alone."""
        low, high = self.times[self.leaves - 1 : self.leaves + 1].tolist()
        time, curve = first_change(self._out, low, high), int(self.nearest[-1])
        edge, v = Feature("edge", curve), self.path.twist(time).v[:2]
        u = float(runs[curve].parameters_a[self.leaves, 0])
        normal = self.boundary.normal(curve, u)
        x = self.path.pose(time).translation[:2]
        value = float(normal @ (x - self.boundary.point(curve, u)))
        return PointEvent(time, "crossing", edge, edge, value, float(normal @ v), True)


def _outer(event: RecordedEvent) -> PointEvent:
    """A switch of the recording outside."""
    return PointEvent(event.time, "voronoi", *event[3:])
