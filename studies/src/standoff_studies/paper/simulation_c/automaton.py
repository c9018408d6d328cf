"""Fig. 13: the automaton of the pair, its modes in a grid, with the motion's path through it."""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from typing import Any, NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from standoff.tracking import Feature
from standoff_studies.paper import style
from standoff_studies.paper.drawing import (
    Spot,
    draw_arrow,
    draw_box,
    planar_features,
    short_name,
)
from standoff_studies.paper.figure import Artwork, Statement, measured_by, own_statement
from standoff_studies.paper.held_features import growth
from standoff_studies.paper.keys import key_below
from standoff_studies.paper.many_starts import Ends
from standoff_studies.paper.pair_simulation import Simulation, anywhere, follows, never_grows
from standoff_studies.paper.resets import growth_statement, moves_of
from standoff_studies.paper.simulation_c.kinds import FILLS, KINDS, kind_of, show_kinds
from standoff_studies.paper.simulation_c.kinds import mode_name as name_of
from standoff_studies.paper.simulation_c.run import (
    ARRIVED,
    SIMULATION,
    arrivals,
    snapshots,
)
from standoff_studies.paper.unaided import Part, unaided

Mode = tuple[Feature, Feature]
TAKEN: dict[str, Any] = {"color": style.BLUE, "linewidth": 2.2}
"""Look of the arrow of a switch that was taken."""

HALF_WIDTH, HALF_HEIGHT = 0.29, 0.25
"""Size of a mode's box, in steps of the grid."""
STUBS = (0.38, 0.24)
"""Lengths of an arrow that leaves the grid at one side and comes back at the other, in steps:
along a row, where its times must fit above it, and along a column."""


class Way(NamedTuple):
    """A switch of the product: from mode to mode, with the times [s] at which it was taken."""

    source: Mode
    target: Mode
    times: tuple[float, ...]


def figure_13() -> Artwork:
    """Make Fig. 13."""
    simulation = SIMULATION
    return Artwork(
        caption=(
            "Automaton of the pair: rows are A's features, columns are B's, both in the order of "
            "the loop, so that every switch goes to a neighbour, and over the edge of the grid to "
            f"its other side. The printed system at K = {simulation.gain:g}/s ran through it from "
            "a wrong start: framed modes were visited, with the time spent in them; blue arrows "
            f"were taken, at the times beside them [s]; those before {simulation.entered:g} s are "
            "of the start. Grey lines were not taken. Letters are the snapshots of Fig. 14."
        ),
        text=(
            "A grid of six rows and six columns of modes; arrows lead through the visited ones, "
            "each with its switching times."
        ),
        draw=lambda: _draw(simulation),
        tables={
            "stays": _stays(simulation),
            "switches": _switches(simulation),
            "growth": _growths(simulation),
        },
        statements=measured_by(simulation.by, _statements(simulation)),
    )


def ways(simulation: Simulation) -> list[Way]:
    """Return the switches that were taken, each with all its times."""
    times: dict[tuple[Mode, Mode], list[float]] = defaultdict(list)
    for before, after in zip(simulation.paper.modes(), simulation.paper.modes()[1:], strict=False):
        source = before.feature_a, before.feature_b
        times[source, (after.feature_a, after.feature_b)].append(after.start)
    return [Way(source, target, tuple(at)) for (source, target), at in times.items()]


def _stays(simulation: Simulation) -> dict[str, ArrayLike]:
    stays = simulation.paper.modes()
    modes = [(stay.feature_a, stay.feature_b) for stay in stays]
    return {
        "feature_a": [short_name(a) for a, _ in modes],
        "feature_b": [short_name(b) for _, b in modes],
        "kind": [KINDS[kind_of(*mode)] for mode in modes],
        "start_s": [stay.start for stay in stays],
        "end_s": [stay.end for stay in stays],
    }


def _switches(simulation: Simulation) -> dict[str, ArrayLike]:
    """For the printed system; nan for switches that the library's own law does not have."""
    events = simulation.paper.events
    ours, own = map(simulation.entered_events, (simulation.paper, simulation.exact))
    due = [math.nan] * (len(events) - len(ours))
    due += [event.time if len(ours) == len(own) else math.nan for event in own]
    return {
        "time_s": [event.time for event in events],
        "time_by_own_law_s": (due + [math.nan] * len(events))[: len(events)],
        "body": [event.body for event in events],
        "source": [short_name(event.source) for event in events],
        "target": [short_name(event.target) for event in events],
        "switching_function": [event.value for event in events],
        "switching_function_slope_per_s": [event.slope for event in events],
    }


def _growths(simulation: Simulation) -> dict[str, ArrayLike]:
    """At the switches of the closest points."""
    events = simulation.exact.events
    return {
        "time_s": [event.time for event in events],
        "distance_growth_length": [
            growth(simulation.exact, simulation.paths, event) for event in events
        ],
    }


def _statements(simulation: Simulation) -> tuple[Statement, ...]:
    stays = simulation.paper.modes()
    kinds = Counter(kind_of(stay.feature_a, stay.feature_b) for stay in stays)
    modes = {(stay.feature_a, stay.feature_b) for stay in stays}
    every = len(planar_features(simulation.a)) * len(planar_features(simulation.b))
    settled = len(simulation.entered_events(simulation.paper))
    return (
        Statement(
            "Fig. 13",
            "the modes are vertex–vertex, vertex–curve and curve–curve",
            "stays: " + ", ".join(f"{kinds[k]} {KINDS[k]}" for k in range(3)),
            min(kinds[k] for k in range(3)) >= 2,
            "the motion is ours, chosen so that all three occur",
            constructed=True,
        ),
        own_statement(
            "Fig. 13",
            f"{len(modes)} of {every} modes visited in {len(stays)} stays, "
            f"{len(simulation.paper.events)} switches, {len(simulation.paper.events) - settled} "
            "of them those of the wrong start",
        ),
        _sequence(simulation),
        *_as_printed(simulation, arrivals()),
        never_grows(
            simulation,
            "the features after the switch are at most {} length farther apart than those before "
            "it",
        ),
        growth_statement(
            moves_of(simulation.paper, simulation.paths, simulation.gain), 1, simulation.by
        ),
    )


def _sequence(simulation: Simulation) -> Statement:
    """The order of the modes after the start, and what a low gain might leave out."""
    short = [v for v in simulation.exact.modes() if v.end - v.start < 3.0 / simulation.gain]
    more = f"; none is skipped, not even the {len(short)} stays shorter than 3/K"
    same = simulation.furthest() < math.inf
    return follows(simulation, f"after {simulation.entered:g} s ", more if same else "")


def _as_printed(simulation: Simulation, tried: Ends) -> tuple[Statement, Statement]:
    """What happens from starts anywhere, and that nothing other than the law helps."""
    return (
        anywhere(
            tried,
            f"random starts on both bodies are at the distance to {ARRIVED:g} after "
            f"{simulation.entered:g} s",
        ),
        unaided([Part.of(simulation.paper)], simulation.by),
    )


def _draw(simulation: Simulation) -> Figure:
    figure = style.new_figure(style.WIDTH, 8.6)
    axes = figure.subplots()
    features_a, features_b = planar_features(simulation.a), planar_features(simulation.b)
    places = {
        (a, b): (float(column), float(row))
        for row, a in enumerate(features_a)
        for column, b in enumerate(features_b)
    }
    _draw_lines(axes, len(features_b), len(features_a))
    for way in ways(simulation):
        _draw_way(axes, places[way.source], places[way.target], way.times)
    for mode, place in places.items():
        _draw_mode(axes, simulation, mode, place)
    axes.tick_params(labeltop=True, labelbottom=False, length=0.0)
    axes.grid(visible=False)
    axes.set_xticks(range(len(features_b)), [f"B {short_name(f)}" for f in features_b])
    axes.set_yticks(range(len(features_a)), [f"A {short_name(f)}" for f in features_a])
    axes.set_xlim(-0.72, len(features_b) - 0.28)
    axes.set_ylim(len(features_a) - 0.42, -0.58)
    for spine in axes.spines.values():
        spine.set_visible(False)
    for word, stay in (
        ("start", simulation.paper.modes()[0]),
        ("end", simulation.paper.modes()[-1]),
    ):
        x, y = places[stay.feature_a, stay.feature_b]
        corner = x - 0.04, y - HALF_HEIGHT - 0.03
        axes.text(*corner, word, ha="right", va="bottom", fontweight="bold")
    key_below(figure, show_kinds(), len(KINDS))
    return figure


def _draw_lines(axes: Axes, columns: int, rows: int) -> None:
    """Every switch that the pair allows: along rows and columns, and across the sides."""
    for row in range(rows):
        axes.plot([-0.5, columns - 0.5], [row, row], color=style.QUIET, linewidth=0.7, zorder=1)
    for column in range(columns):
        axes.plot([column, column], [-0.5, rows - 0.5], color=style.QUIET, linewidth=0.7, zorder=1)


def _draw_mode(axes: Axes, simulation: Simulation, mode: Mode, place: Spot) -> None:
    x, y = place
    stays = [s for s in simulation.paper.modes() if (s.feature_a, s.feature_b) == mode]
    letters = ", ".join(s.letter for s in snapshots() if s[3:] == mode)
    kind = kind_of(*mode)
    draw_box(
        axes,
        place,
        (HALF_WIDTH, HALF_HEIGHT),
        0.06,
        facecolor=FILLS[kind] if stays else "white",
        edgecolor=style.BLACK if stays else style.QUIET,
        linestyle="-" if stays else ":",
        linewidth=1.2 if stays else 0.8,
    )
    text = name_of(*mode)
    if stays:
        text += f"\n{sum(s.end - s.start for s in stays):.2f} s"
    text += f"\n({letters})" if letters else ""
    axes.text(
        x,
        y,
        text,
        ha="center",
        va="center",
        color=style.BLACK if stays else "#606060",
        fontweight="bold" if stays else "normal",
        fontsize=style.FONT - 0.5,
        zorder=4,
    )


def _draw_way(axes: Axes, source: Spot, target: Spot, times: tuple[float, ...]) -> None:
    """An arrow between two neighbours; across the side of the grid, the two ends of one."""
    label = "\n".join(f"{time:.3f}" for time in times)
    along = 0 if source[1] == target[1] else 1
    half = (HALF_WIDTH, HALF_HEIGHT)[along]
    step = target[along] - source[along]
    near = abs(step) == 1.0
    forward = step if near else -step / abs(step)
    start, end = _aside(source, along, forward * half), _aside(target, along, -forward * half)
    if near:
        draw_arrow(axes, start, end, **TAKEN)
        middle = _aside(start, along, 0.5 * (end[along] - start[along]))
    else:
        stub = forward * STUBS[along]
        draw_arrow(axes, start, _aside(start, along, stub), **TAKEN, arrowstyle="-")
        draw_arrow(axes, _aside(end, along, -stub), end, **TAKEN)
        middle = _aside(start, along, 0.5 * stub)
    x, y = middle
    small = style.FONT - 3.0
    if along == 0:
        axes.text(x, y - 0.03, label, ha="center", va="bottom", color=style.BLUE, fontsize=small)
    else:
        axes.text(x + 0.04, y, label, ha="left", va="center", color=style.BLUE, fontsize=small)


def _aside(place: Spot, along: int, by: float) -> Spot:
    return (place[0] + by, place[1]) if along == 0 else (place[0], place[1] + by)
