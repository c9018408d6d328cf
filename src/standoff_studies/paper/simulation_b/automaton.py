"""Fig. 9: the automaton of body and point, its modes inside and outside, and the motion's way."""

from __future__ import annotations

import math
from collections import defaultdict
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from standoff.bodies import shapes
from standoff.motion import Pose
from standoff.points import PointEvent, PointVisit
from standoff.tracking import Feature
from standoff_studies.paper import style
from standoff_studies.paper.drawing import planar_features, short_name
from standoff_studies.paper.figure import Artwork, Statement
from standoff_studies.paper.held_features import CONTINUOUS, held_distance
from standoff_studies.paper.simulation_b.run import (
    CONVERGED,
    DENSE,
    FRAME,
    GAIN,
    PAST,
    Run,
    brute_modes,
    late,
    run,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Mode = tuple[bool, Feature]
"""Inside?, and the active feature."""

OUTER, INNER = 3.0, 1.25
"""Radii of the rings of modes in the picture [inches]."""
BEND = 0.13
"""Of the arrows, so that both ways of a switch can be seen."""
KINDS = {
    "medial": ("medial-axis jump, inside", "--", style.RED),
    "crossing": ("through the boundary", ":", style.BLACK),
    "voronoi": ("Voronoi switch, outside", "-", style.BLUE),
}
"""Names, dashes and colours of the three kinds of switches."""
FILLS = {True: "#F8E3CF", False: "#D3E8F6"}
"""Behind a visited mode inside and outside."""
INSTANT, SLOPE = 1e-9, 1e-3
"""To what an instant is located [s], where its switching function has a slope above that [1/s];
else to the first over the slope."""


class Switch(NamedTuple):
    """A switch that the automaton allows, and when it was taken [s]."""

    source: Mode
    target: Mode
    kind: str
    times: tuple[float, ...]


def figure_9() -> Artwork:
    """Make Fig. 9."""
    simulation = run()
    return Artwork(
        caption=(
            "Automaton of body and point. The inner modes are those of a point inside, where three "
            "trackers run in parallel and the nearest curve wins; the outer ring is that of a "
            "point outside, on curves or anchored at vertices. Filled modes were visited, with the "
            "time spent there; coloured arrows were taken, with the switching instants [s]: dashed "
            "a jump over the medial axis, dotted through the boundary, solid over a Voronoi line."
        ),
        text=(
            "Three inner modes in a triangle joined by dashed arrows, six outer modes in a ring "
            "joined by solid arrows, one dotted arrow from inside to outside at C0."
        ),
        draw=lambda: _draw(simulation),
        tables={"stays": _stays(simulation), "switches": _switches(simulation)},
        statements=_statements(simulation),
    )


def switches(simulation: Run) -> list[Switch]:
    """Return every switch that the automaton allows, with the times at which it was taken."""
    taken: dict[tuple[Mode, Mode], list[float]] = defaultdict(list)
    for event in simulation.paper.events:
        source, target = _modes(event)
        taken[source, target].append(event.time)
    ring = planar_features(simulation.body)
    curves = [feature for feature in ring if feature.kind == "edge"]
    allowed = [((True, a), (True, b), "medial") for a in curves for b in curves if a != b]
    allowed += [((side, c), (not side, c), "crossing") for c in curves for side in (True, False)]
    for a, b in zip(ring, (*ring[1:], ring[0]), strict=True):
        allowed += [((False, a), (False, b), "voronoi"), ((False, b), (False, a), "voronoi")]
    unknown = set(taken) - {(source, target) for source, target, _ in allowed}
    if unknown:
        raise ArithmeticError(
            f"The motion took switches that the automaton does not have: {unknown}."
        )
    return [Switch(s, t, kind, tuple(taken.get((s, t), ()))) for s, t, kind in allowed]


def _modes(event: PointEvent) -> tuple[Mode, Mode]:
    """The modes before and after an event."""
    if event.kind == "crossing":
        inside = event.slope < 0.0  # the signed distance falls
        return (not inside, event.source), (inside, event.target)
    inside = event.kind == "medial"
    return (inside, event.source), (inside, event.target)


def _stays(simulation: Run) -> dict[str, ArrayLike]:
    visits = simulation.paper.modes()
    return {
        "side": ["inside" if visit.inside else "outside" for visit in visits],
        "feature": [short_name(visit.feature) for visit in visits],
        "start_s": [visit.start for visit in visits],
        "end_s": [visit.end for visit in visits],
    }


def _switches(simulation: Run) -> dict[str, ArrayLike]:
    events = simulation.paper.events
    return {
        "time_s": [event.time for event in events],
        "kind": [event.kind for event in events],
        "source": [short_name(event.source) for event in events],
        "target": [short_name(event.target) for event in events],
        "switching_function": [event.value for event in events],
        "slope_per_s": [event.slope for event in events],
    }


def _statements(simulation: Run) -> tuple[Statement, ...]:
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
        ),
        _curve_to_curve(simulation),
        Statement(
            "Fig. 9",
            "-",
            f"modes against a search over {simulation.body.n_edges * DENSE} points of the "
            f"boundary: the same in {agree} of {int(settled.sum())} snapshots after the wrong "
            "start",
            agree == int(settled.sum()),
        ),
        _instants(simulation),
        _growth(simulation),
        *_starts(simulation),
    )


def _curve_to_curve(simulation: Run) -> Statement:
    stays = [v for v in simulation.paper.modes() if not v.inside and v.feature.kind == "vertex"]
    first: PointVisit = stays[0]
    frames = [math.ceil(t / FRAME) for t in (first.start, first.end)]
    (source,) = (e.source for e in simulation.paper.events if e.time == first.start)
    (target,) = (e.target for e in simulation.paper.events if e.time == first.end)
    return Statement(
        "Fig. 9",
        "curve to curve outside",
        f"at {first.start:.4f} s: from {short_name(source)} by {short_name(first.feature)} "
        f"to {short_name(target)} in {1e3 * (first.end - first.start):.2f} ms, within one frame",
        frames[0] == frames[1] and source.kind == target.kind == "edge",
        "At a sharp vertex two curves' regions do not touch: the point passes the vertex at "
        f"{PAST} length, and its region within a step.",
    )


def _instants(simulation: Run) -> Statement:
    exact = simulation.exact.events
    near = [
        abs(e.value) <= INSTANT * (abs(e.slope) if abs(e.slope) > SLOPE else 1.0) for e in exact
    ]
    own = late(simulation.paper)
    off = [abs(a.time - b.time) for a, b in zip(own, late(simulation.exact), strict=True)]
    return Statement(
        "Fig. 9",
        "switching instants",
        f"{len(exact)} instants, each a root of its switching function, where it is "
        f"{max(abs(event.value) for event in exact):.0e} and its slope at least "
        f"{min(abs(event.slope) for event in exact):.2g} per s, so within {INSTANT:g} s; the "
        f"paper's law at K = {GAIN:g} per s switches within {max(off):.1e} s of them",
        all(near),
        "Voronoi switches and the crossing do not depend on the parameters. A jump does where a "
        "parameter has just left its bound: the law sets off before its curve is nearest.",
    )


def growths(simulation: Run) -> dict[str, list[float]]:
    """By how much the feature after a switch is farther from the point than that before [length].

    At the located instants. Over the medial axis that is the switching function itself; at the
    boundary the feature stays.
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
    """Distance to one feature alone, sought from the vertex that it shares with the other."""
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
        "Section on the hybrid system",
        "the distance between features never grows at a switch",
        f"at the instants of {len(found['medial'])} jumps and {len(found['voronoi'])} Voronoi "
        f"switches the feature after it is at most {grows:.0e} length farther away than the one "
        "before it",
        grows <= CONTINUOUS,
    )


def _starts(simulation: Run) -> tuple[Statement, Statement]:
    """The claim on the switching times, outside, where it holds, and inside."""
    claim = "for a body and a point the switching times do not depend on the continuous state"
    runs = [late(recording) for recording in (simulation.paper, *simulation.others)]
    same = all([e[1:4] for e in run] == [e[1:4] for e in runs[0]] for run in runs)
    times = np.array([[event.time for event in run] for run in runs]) if same else np.empty((0, 0))
    outside = np.array([event.kind == "voronoi" for event in runs[0]])
    outer, inner = (
        float(np.ptp(times[:, kind], axis=0).max()) if same else math.nan
        for kind in (outside, ~outside)
    )
    counts = [
        sum(event.kind == "medial" for event in recording.events)
        for recording in (simulation.exact, simulation.paper, *simulation.others)
    ]
    return (
        Statement(
            "Section on the hybrid system",
            claim,
            f"outside, from {len(runs)} wrong starts: the same {int(outside.sum())} Voronoi "
            f"switches, instants within {outer:.0e} s",
            same and outer < INSTANT,
        ),
        Statement(
            "Section on the hybrid system",
            claim,
            f"inside: {counts[0]} jumps over the medial axis from the right start, "
            f"{', '.join(str(count) for count in counts[1:])} from the wrong ones; those after "
            f"{CONVERGED} s, when all have converged, are the same within {inner:.0e} s",
            len(set(counts)) == 1,
            "A jump compares the distances that the trackers have, so while they converge it "
            "depends on their parameters.",
        ),
    )


def _places(simulation: Run) -> dict[Mode, tuple[float, float]]:
    """Where modes stand: two rings, turned as the body's features are."""
    ring = planar_features(simulation.body)
    places = {}
    for k, feature in enumerate(ring):
        angle = math.tau * k / len(ring)
        places[False, feature] = OUTER * math.cos(angle), OUTER * math.sin(angle)
        if feature.kind == "edge":
            places[True, feature] = INNER * math.cos(angle), INNER * math.sin(angle)
    return places


def _draw(simulation: Run) -> Figure:
    with style.settings():
        figure = style.new_figure(style.WIDTH, 7.4)
        axes = figure.subplots()
        places = _places(simulation)
        for switch in sorted(switches(simulation), key=lambda s: len(s.times)):
            _draw_switch(axes, switch, places)
        times: dict[Mode, float] = defaultdict(float)
        for visit in simulation.paper.modes():
            times[visit.inside, visit.feature] += visit.end - visit.start
        for mode, place in places.items():
            _draw_mode(axes, mode, place, times.get(mode))
        first = simulation.paper.answers[0]
        x, y = places[first.inside, first.feature]
        axes.text(x - 0.62, y, "start", ha="center", va="center", fontweight="bold", zorder=6)
        for name, dashes, colour in KINDS.values():
            axes.plot([], [], linestyle=dashes, color=colour, linewidth=2.0, label=name)
        axes.plot([], [], color=style.QUIET, linewidth=0.8, label="not taken")
        axes.set_xlim(-3.75, 3.75)
        axes.set_ylim(-3.35, 3.35)
        axes.set_aspect("equal")
        axes.set_axis_off()
        figure.legend(loc="outside lower center", ncols=2, frameon=False, handlelength=3.5)
    return figure


def _draw_mode(axes: Axes, mode: Mode, place: tuple[float, float], time: float | None) -> None:
    inside, feature = mode
    label = short_name(feature) + ("\ninside" if inside else "\noutside")
    axes.text(
        *place,
        label if time is None else f"{label}\n{time:.2f} s",
        ha="center",
        va="center",
        fontsize=style.FONT - 0.5,
        zorder=5,
        bbox={
            "boxstyle": "circle,pad=0.35" if feature.kind == "vertex" else "round,pad=0.4",
            "facecolor": "white" if time is None else FILLS[inside],
            "edgecolor": style.QUIET if time is None else style.BLACK,
            "linewidth": 0.8 if time is None else 1.4,
        },
    )


def _draw_switch(axes: Axes, switch: Switch, places: dict[Mode, tuple[float, float]]) -> None:
    from matplotlib.patches import FancyArrowPatch

    _, dashes, colour = KINDS[switch.kind]
    taken = bool(switch.times)
    start, end = places[switch.source], places[switch.target]
    # The line and its head apart: dashes would break the head, too.
    for arrow, line, width in (("-", dashes, 2.0 if taken else 0.8), ("-|>", "-", 0.0)):
        axes.add_patch(
            FancyArrowPatch(
                start,
                end,
                arrowstyle=arrow,
                linestyle=line,
                linewidth=width,
                connectionstyle=f"arc3,rad={BEND}",
                color=colour if taken else style.QUIET,
                mutation_scale=18.0 if taken else 11.0,
                shrinkA=27.0,
                shrinkB=27.0,
                zorder=3 if taken else 2,
            )
        )
    if taken:
        _write_times(axes, switch.times, start, end, colour)


def _write_times(
    axes: Axes,
    times: tuple[float, ...],
    start: tuple[float, float],
    end: tuple[float, float],
    colour: str,
) -> None:
    """Beside the middle of an arrow, on the side to which it bends."""
    along = np.subtract(end, start)
    aside = np.array([along[1], -along[0]]) / np.linalg.norm(along)
    middle = 0.5 * np.add(start, end) + (0.5 * BEND * np.linalg.norm(along) + 0.3) * aside
    axes.text(
        float(middle[0]),
        float(middle[1]),
        "\n".join(f"{time:.3f}" for time in times),
        ha="center",
        va="center",
        color=colour,
        fontsize=style.FONT - 1.0,
        zorder=6,
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.8, "alpha": 0.9},
    )
