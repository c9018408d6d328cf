"""Fig. 9: the automaton of body and point, its modes inside and outside, and the motion's path."""

from __future__ import annotations

import math
from collections import defaultdict
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from standoff.points import PointEvent
from standoff.tracking import Feature
from standoff_studies.paper import style
from standoff_studies.paper.drawing import draw_arrow, planar_features, short_name
from standoff_studies.paper.figure import Artwork, measured_by
from standoff_studies.paper.simulation_b.run import GAIN, Run, run
from standoff_studies.paper.simulation_b.switching import statements

Mode = tuple[bool, Feature]
"""Inside?, and the active feature."""

OUTER, INNER = 3.0, 1.25
"""Radii of the rings of modes in the picture [inches]."""
BEND = 0.13
"""Bend of the arrows, so that both directions of a switch are visible."""
KINDS = {
    "medial": ("medial-axis jump, inside", "--", style.RED),
    "crossing": ("through the boundary", ":", style.BLACK),
    "voronoi": ("Voronoi switch, outside", "-", style.BLUE),
}
"""Names, dashes and colours of the three kinds of switches."""
FILLS = {True: "#F8E3CF", False: "#D3E8F6"}
"""Behind a visited mode inside and outside."""


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
            f"Automaton of body and point, and the way of the printed system at K = {GAIN:g}/s "
            "from a wrong start. The inner modes are those of a point inside, where three "
            "trackers run in parallel and the medial axis tells which is the active one; the outer "
            "ring is that of a "
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
        statements=measured_by(simulation.paper.by, statements(simulation)),
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


def _places(simulation: Run) -> dict[Mode, tuple[float, float]]:
    """The places of the modes: two rings, at the angles of the body's features."""
    ring = planar_features(simulation.body)
    places = {}
    for k, feature in enumerate(ring):
        angle = math.tau * k / len(ring)
        places[False, feature] = OUTER * math.cos(angle), OUTER * math.sin(angle)
        if feature.kind == "edge":
            places[True, feature] = INNER * math.cos(angle), INNER * math.sin(angle)
    return places


def _draw(simulation: Run) -> Figure:
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
    x, y = places[bool(simulation.paper.inside[0]), simulation.paper.feature[0]]
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
    _, dashes, colour = KINDS[switch.kind]
    taken = bool(switch.times)
    start, end = places[switch.source], places[switch.target]
    # the line and its head separately: dashes would break the head too
    look: dict[str, Any] = {"connectionstyle": f"arc3,rad={BEND}", "shrinkA": 27.0, "shrinkB": 27.0}
    look |= (
        {"color": colour, "mutation_scale": 18.0, "zorder": 3} if taken else {"color": style.QUIET}
    )
    width = 2.0 if taken else 0.8
    draw_arrow(axes, start, end, arrowstyle="-", linestyle=dashes, linewidth=width, **look)
    draw_arrow(axes, start, end, linewidth=0.0, **look)
    if taken:
        _write_times(axes, switch.times, start, end, colour)


def _write_times(
    axes: Axes,
    times: tuple[float, ...],
    start: tuple[float, float],
    end: tuple[float, float],
    colour: str,
) -> None:
    """Next to the middle of an arrow, on the side to which it bends."""
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
