"""Fig. 20: the face parameters of both witness points against time, over two edges."""

from __future__ import annotations

import math
from itertools import cycle
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from standoff.typing import Array
from standoff_studies.paper import style
from standoff_studies.paper.figure import HYBRID, Artwork, Statement, measured_by, own_statement
from standoff_studies.paper.held_features import growth
from standoff_studies.paper.many_starts import INDEFINITE
from standoff_studies.paper.pair_simulation import Simulation, anywhere, follows, never_grows
from standoff_studies.paper.panels import draw_errors, name_above, tint, unit_interval
from standoff_studies.paper.patch_places import short
from standoff_studies.paper.resets import growth_statement, reset_statement, reset_table
from standoff_studies.paper.simulation_e.own_point import AROUND, POINTS, decisions
from standoff_studies.paper.simulation_e.runs import (
    ARRIVED,
    PATIENCE,
    SIMULATION,
    TRIED,
    arrivals,
    face_parameters,
    features_of,
    moves_by_resets,
)
from standoff_studies.paper.start_decay import decay_statement
from standoff_studies.paper.unaided import Part, unaided

BESIDE = 0.2
"""By how much our instants may differ from the paper's [s]."""

DECAY = (0.02, 0.2)
"""Times between which the decay of the start is measured [s]: later the law's error dominates."""

LEAST_DRAWN = 1e-10
"""Witness errors below this are drawn at this value [length]: those of the other law."""

SHADES = ("#FFFFFF", "#ECECEC")
"""Backgrounds of the modes, in turn."""


def figure_20() -> Artwork:
    """Draw the parameters of both witness points."""
    runs = SIMULATION
    return Artwork(
        caption=(
            "Simulation E: the parameters u, v of A's patch and r, s of B's (solid, dashed) that "
            f"the witness points are on, by the printed system at 1 kHz, K = {runs.gain:g}/s, from "
            "a wrong start on another pair of faces, which the switching leaves in the first "
            "frame; thin and dark, the library's own law. The modes are shaded in turn and named "
            "on top, A's feature first; thin lines mark the switching instants. On an edge (bar) "
            "the point keeps the parameters of the patch that it came from, and u or r stays at 1; "
            "when it leaves to the next patch they jump to that one's. Below: the distance, how "
            "far the worse witness point is off, in the radius of A's faces, and the projection "
            "errors |Ψ|; rings are what each reset makes of them."
        ),
        text=(
            "Two panels of parameters between 0 and 1, one a body. In each, u rises to 1, stays "
            "there while the point is on an edge, then jumps to 0 on the next patch and rises "
            "again. The third panel shows the distance, a smooth curve through all switches, the "
            "last the errors, which fall from the start and again after each switch."
        ),
        draw=_draw,
        tables={
            "parameters": _parameter_table(runs),
            "switches": _switch_table(runs),
            "resets": reset_table(runs.resets),
        },
        statements=measured_by(runs.by, _statements(runs)),
    )


def passes_an_edge(features: tuple[str, ...]) -> bool:
    """Does a witness point go from a face into an edge and out to another face?"""
    kinds = "".join(name[0] for name in features)
    at = kinds.find("FEF")
    return at >= 0 and features[at] != features[at + 2]


def _statements(runs: Simulation) -> tuple[Statement, ...]:
    paths = {body: features_of(runs.stays, body) for body in "AB"}
    offsets = edge_offsets(runs)
    late = runs.late()
    slopes = [abs(event.slope) for event in runs.exact.events]
    stay = edge_stay(runs)
    return (
        Statement(
            "Fig. 20",
            "a witness point enters an edge and leaves it to the next face",
            "; ".join(f"{body}: {' → '.join(path)}" for body, path in paths.items()),
            all(passes_an_edge(path) for path in paths.values()),
            "the motion is ours, chosen so that both do",
            constructed=True,
        ),
        Statement(
            "Fig. 20",
            "u or r is constant, 0 or 1, while the point is on the patch's boundary curve",
            f"in {len(offsets)} frames on an edge it is off 1 by {offsets.max(initial=0.0):.0e}",
            bool(len(offsets) and offsets.max() == 0.0),
            "on an edge it is read from the edge's own line in the parameters",
            constructed=True,
        ),
        Statement(
            "Fig. 20",
            "a second on the boundary curve, from 2.67 s to 3.66 s",
            f"A's witness point from {stay[0]:.2f} s to {stay[1]:.2f} s",
            abs(stay[0] - 2.67) < BESIDE and abs(stay[1] - 3.66) < BESIDE,
            f"the motion is ours, chosen to come within {BESIDE:g} s of the paper's",
            constructed=True,
        ),
        *_as_printed(runs),
        decay_statement(runs.paper, runs.paths, DECAY, runs.gain, runs.by),
        reset_statement(runs.resets, runs.by),
        never_grows(
            runs,
            "the features after the switch are at most {} of the radius farther apart than those "
            "before it",
        ),
        growth_statement(moves_by_resets(), TRIED, runs.by),
        own_statement(
            "Fig. 20",
            f"the default law locates all {len(runs.exact.events)} switches, whose functions "
            f"cross 0 at {min(slopes):.1f} to {max(slopes):.1f} per second; the printed system "
            f"switches at most {1e6 * np.abs(late).max():.2f} µs off",
            by=runs.own,
        ),
    )


def _as_printed(runs: Simulation) -> tuple[Statement, ...]:
    """The order of the modes, what happens from starts anywhere, and that nothing helps the law."""
    tried = arrivals()
    printed, own = decisions("voronoi"), decisions("multipliers")
    return (
        follows(runs),
        anywhere(
            tried,
            f"random starts on both bodies are at the distance to {ARRIVED:g} after {PATIENCE:g} "
            f"s; of the {tried.lost} others {tried.placed} are on the features of the closest "
            f"points, and {tried.pinned} are held at a side of a patch with M indefinite",
            INDEFINITE,
        ),
        Statement(
            HYBRID,
            "the switching tests of one body do not depend on its own witness point",
            f"at each switch, {AROUND} frames before and after it, from {POINTS} own points "
            f"anywhere on the feature: {printed.right} of {printed.tried} decisions are those of "
            f"the closest points; by multipliers at the own point {own.right} of {own.tried}",
            printed.right == printed.tried,
            by=printed.by,
        ),
        unaided([Part.of(runs.paper)], runs.by),
    )


def edge_stay(runs: Simulation) -> tuple[float, float]:
    """Return when A's witness point enters its edge, and when it leaves it [s].

    Both are nan if it does not.
    """
    on = [visit for visit in runs.stays if visit.feature_a.kind == "edge"]
    return (on[0].start, on[-1].end) if on else (math.nan, math.nan)


def edge_offsets(runs: Simulation) -> Array:
    """Return |u - 1| in the frames in which a witness point is on an edge, for both bodies."""
    found = []
    for body in "AB":
        places = face_parameters(runs.paper, body)
        found.append(np.abs(places.u[places.on_edge] - 1.0))
    return np.concatenate(found)


def _parameter_table(runs: Simulation) -> dict[str, Array | list[str]]:
    table: dict[str, Array | list[str]] = {"time_s": runs.paper.time}
    for body in "AB":
        places = face_parameters(runs.paper, body)
        names = ("u", "v") if body == "A" else ("r", "s")
        table |= dict(zip(names, (places.u, places.v), strict=True))
        table[f"face_{body.lower()}"] = places.face.astype(float)
    table["feature_a"] = [short(feature) for feature in runs.paper.feature_a]
    table["feature_b"] = [short(feature) for feature in runs.paper.feature_b]
    table["distance"] = runs.paper.distance
    return table


def _switch_table(runs: Simulation) -> dict[str, Array | list[str]]:
    events = runs.exact.events
    return {
        "body": [event.body for event in events],
        "source": [short(event.source) for event in events],
        "target": [short(event.target) for event in events],
        "time_s": np.array([event.time for event in events]),
        "time_paper_law_s": np.array([event.time for event in events]) + runs.late(),
        "slope_per_s": np.array([event.slope for event in events]),
        "distance_growth": np.array([growth(runs.exact, runs.paths, event) for event in events]),
    }


def _draw() -> Figure:
    runs = SIMULATION
    figure = style.new_figure(style.WIDTH, 9.0)
    panels = figure.subplots(4, 1, sharex=True, height_ratios=[1.0, 1.0, 0.8, 1.3])
    for axes, body in zip(panels, "AB", strict=False):
        _shade(axes, runs)
        _draw_parameters(axes, runs, body)
    _shade(panels[2], runs)
    panels[2].plot(runs.paper.time, runs.paper.distance, color=style.GREEN)
    panels[2].plot(
        runs.exact.time,
        runs.exact.distance,
        color=style.BLACK,
        linewidth=0.6,
        label="library's law",
    )
    panels[2].legend(frameon=False)
    panels[2].set_ylabel("distance [radius]")
    _shade(panels[3], runs)
    draw_errors(panels[3], runs, least=LEAST_DRAWN, label="witness points")
    panels[3].set_ylim(0.5 * LEAST_DRAWN, 300.0)
    panels[3].set(xlabel="time [s]", ylabel="error [radius], |Ψ| [radius²]")
    panels[2].set_xlim(0.0, runs.paper.time[-1])
    names = [f"{short(s.feature_a)}–{short(s.feature_b)}" for s in runs.exact.modes()]
    name_above(panels[0], zip(runs.exact.modes(), names, strict=True))
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3, frameon=False)
    figure.align_ylabels()
    return figure


def _draw_parameters(axes: Axes, runs: Simulation, body: str) -> None:
    places, exact = face_parameters(runs.paper, body), face_parameters(runs.exact, body)
    time, names = runs.paper.time, {"A": "u, v", "B": "r, s"}[body]
    for piece in places.pieces:
        first = piece == places.pieces[0]
        label = ("u of A, r of B", "v of A, s of B") if first else (None, None)
        for own in (exact.u, exact.v):
            axes.plot(time[piece], own[piece], color=style.BLACK, linewidth=0.6, zorder=3)
        axes.plot(time[piece], places.u[piece], color=style.BLUE, label=label[0])
        axes.plot(time[piece], places.v[piece], color=style.RED, linestyle="--", label=label[1])
        where: dict[str, Any] = {"ha": "left", "va": "center", "color": "#303030"}
        axes.text(time[piece.start] + 0.02, 0.27, f"{body} F{places.face[piece.start]}", **where)
    on = np.flatnonzero(places.on_edge)
    axes.axvspan(
        time[on[0]], time[on[-1]], ymin=0.0, ymax=0.07, color=style.ORANGE, label="on an edge"
    )
    unit_interval(axes, f"{body}: {names} [–]")


def _shade(axes: Axes, runs: Simulation) -> None:
    stays = runs.exact.modes()
    tint(axes, zip(stays, cycle(SHADES), strict=False))
    for stay in stays[1:]:
        axes.axvline(stay.start, color=style.QUIET, linewidth=0.8, zorder=1)
