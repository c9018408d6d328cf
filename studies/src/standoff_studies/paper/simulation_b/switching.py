"""What Fig. 9 states, and what was measured."""

from __future__ import annotations

import math

import numpy as np

from standoff.bodies import shapes
from standoff.motion import Pose
from standoff.points import PointVisit
from standoff.tracking import Feature
from standoff_studies.paper.drawing import short_name
from standoff_studies.paper.figure import HYBRID, Statement
from standoff_studies.paper.held_features import CONTINUOUS, SHARED, held_distance
from standoff_studies.paper.pair_simulation import REST, anywhere
from standoff_studies.paper.resets import growth_statement, moves_of
from standoff_studies.paper.simulation_b.run import (
    ARRIVED,
    CONVERGED,
    DENSE,
    FRAME,
    GAIN,
    PAST,
    Run,
    arrivals,
    brute_modes,
    off_instants,
)
from standoff_studies.paper.unaided import Part, unaided

KINDS = ("medial", "crossing", "voronoi")
"""Of switches."""

WITHIN = 1e-7
"""Accuracy of an instant determined from the axis, points joined by a smooth line [s]."""
INSTANT, SLOPE = 1e-9, 1e-3
"""Accuracy of a located instant [s] if its switching function has a slope above the second number
[1/s]; otherwise the first divided by the slope."""


def statements(simulation: Run) -> tuple[Statement, ...]:
    """Fig. 9's statements."""
    paper = simulation.paper
    counts = {kind: sum(event.kind == kind for event in paper.events) for kind in KINDS}
    onto = sum(e.kind == "voronoi" and e.target.kind == "vertex" for e in paper.events)
    back = counts["voronoi"] - onto
    brute = brute_modes(simulation.body, paper.point[simulation.snapshots, :2])
    settled = paper.time[simulation.snapshots] > CONVERGED
    own = np.array([short_name(f) for f in paper.feature[simulation.snapshots]])
    agree = int((own == np.array(brute))[settled].sum())
    return (
        Statement(
            "Fig. 9",
            "both kinds of switches occur: jumps between curves inside; curve to vertex and "
            "vertex to curve outside",
            f"{counts['medial']} jumps over the medial axis, {counts['crossing']} crossing of the "
            f"boundary, {onto} switches from a curve to a vertex and {back} back",
            counts["medial"] >= 6 and onto >= 3 and back >= 3,
            "the motion is ours, chosen so that they occur",
            constructed=True,
        ),
        _curve_to_curve(simulation),
        Statement(
            "Fig. 9",
            "the active feature is that of the closest point",
            f"against a search over {simulation.body.n_edges * DENSE} points of the "
            f"boundary: the same in {agree} of {int(settled.sum())} snapshots after "
            f"{CONVERGED:g} s",
            agree == int(settled.sum()),
        ),
        _instants(simulation),
        *_starts(simulation),
        *_as_printed(simulation),
        _growth(simulation),
        _growth_by_resets(simulation),
    )


def _curve_to_curve(simulation: Run) -> Statement:
    said = "Fig. 9", "curve to curve outside"
    stays = [v for v in simulation.paper.modes() if not v.inside and v.feature.kind == "vertex"]
    if not stays:
        return Statement(*said, "no vertex is passed outside", False)
    first: PointVisit = stays[0]
    frames = [math.ceil(t / FRAME) for t in (first.start, first.end)]
    (source,) = (e.source for e in simulation.paper.events if e.time == first.start)
    (target,) = (e.target for e in simulation.paper.events if e.time == first.end)
    return Statement(
        *said,
        f"at {first.start:.4f} s: from {short_name(source)} by {short_name(first.feature)} "
        f"to {short_name(target)} in {1e3 * (first.end - first.start):.2f} ms, within one frame",
        frames[0] == frames[1] and source.kind == target.kind == "edge",
        "At a sharp vertex two curves' regions do not touch: the point passes the vertex at "
        f"{PAST} length, by a motion chosen for it, and its region within a step.",
        constructed=True,
    )


def _instants(simulation: Run) -> Statement:
    exact, off = simulation.exact.events, off_instants(simulation)
    near = [
        abs(e.value) <= INSTANT * (abs(e.slope) if abs(e.slope) > SLOPE else 1.0) for e in exact
    ]
    return Statement(
        "Fig. 9",
        "the point's place alone tells the switching instants",
        f"all {len(simulation.paper.events)} switches are those of the library's own law, which "
        f"finds each to {INSTANT:g} s as a root of a difference of distances: outside within "
        f"{off['voronoi']:.0e} s of it, at the boundary {off['crossing']:.0e} s, at the medial "
        f"axis computed before the run {off['medial']:.0e} s",
        all(near) and max(off.values()) < WITHIN,
    )


def growths(simulation: Run) -> dict[str, list[float]]:
    """By how much the feature after a switch is farther from the point than that before [length].

    At the located instants. At the medial axis this is the switching function itself; at the
    boundary the feature does not change.
    """
    events = simulation.exact.events
    found = {"medial": [e.value for e in events if e.kind == "medial"], "voronoi": []}
    for event in events:
        if event.kind == "voronoi":
            before, after = (
                _held(simulation, event.time, feature, other)
                for feature, other in (
                    (event.source, event.target),
                    (event.target, event.source),
                )
            )
            found["voronoi"].append(after - before)
    return found


def _held(simulation: Run, time: float, feature: Feature, other: Feature) -> float:
    """Distance to one feature only, found from the vertex that it shares with the other."""
    parameters: tuple[float, ...] = ()
    if feature.kind == "edge":
        curve = simulation.body.edge_parts[feature.index].curve
        parameters = (curve.first if other.index == feature.index else curve.last,)
    poses = Pose.identity(), simulation.path.pose(time)
    pair = simulation.body, shapes.point()
    return held_distance(pair, poses, (feature, parameters), (("vertex", 0), ()))


def _growth(simulation: Run) -> Statement:
    found = growths(simulation)
    grows = max(max(found["medial"]), max(found["voronoi"]))
    return Statement(
        HYBRID,
        "the distance between features never grows at a switch",
        f"at the instants of {len(found['medial'])} jumps and {len(found['voronoi'])} Voronoi "
        f"switches the feature after it is at most {grows:.0e} length farther away than the one "
        "before it",
        grows <= CONTINUOUS,
        f"outside {SHARED}; inside both are equally far away on the medial axis",
        simulation.own + ": the claim is of the closest points",
        constructed=True,
    )


def _growth_by_resets(simulation: Run) -> Statement:
    runs = simulation.paper, *simulation.others
    paths = REST, simulation.path
    moves = [move for one in runs for move in moves_of(one.outside, paths, GAIN)]
    return growth_statement(moves, len(runs), simulation.paper.by)


def _starts(simulation: Run) -> tuple[Statement, Statement]:
    """The claim on the switching times, outside and inside, from all starts and from t = 0."""
    claim = "for a body and a point the switching times do not depend on the continuous state"
    runs = [recording.events for recording in (simulation.paper, *simulation.others)]
    same = all([e[1:4] for e in run] == [e[1:4] for e in runs[0]] for run in runs)
    times = np.array([[event.time for event in run] for run in runs]) if same else np.empty((0, 0))
    outside = np.array([event.kind == "voronoi" for event in runs[0]])
    outer, inner = (
        float(np.ptp(times[:, kind], axis=0).max(initial=0.0)) if same else math.nan
        for kind in (outside, ~outside)
    )
    return (
        Statement(
            HYBRID,
            claim,
            f"outside, from {len(runs)} wrong starts: the same {int(outside.sum())} Voronoi "
            f"switches, instants within {outer:.0e} s",
            bool(same and outside.any() and outer < INSTANT),
        ),
        Statement(
            HYBRID,
            claim,
            f"inside, from {len(runs)} wrong starts: the same {int((~outside).sum())} switches, "
            f"instants within {inner:.0e} s, also while the errors still converge",
            same and inner < INSTANT,
            "which side of the medial axis the point is on is read from its place; the trackers "
            "are not asked",
            constructed=True,
        ),
    )


def _as_printed(simulation: Run) -> tuple[Statement, Statement]:
    """What happens from starts anywhere, and that nothing other than the law helps."""
    tried, runs = arrivals(), (simulation.paper, *simulation.others)
    return (
        anywhere(
            tried,
            "starts all over the three curves are at the distance to their curve to "
            f"{ARRIVED:g} after {CONVERGED:g} s",
        ),
        unaided(
            [Part.of(part) for one in runs for part in (*one.parts, one.outside)],
            simulation.paper.by,
            runs=len(runs),
        ),
    )
