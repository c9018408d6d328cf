"""Fig. 17: the automaton of the lens and a point, with visited modes and switching instants."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from standoff.automaton import Automaton, Transition
from standoff.bodies import Boundary
from standoff.bodies.tessellation import edge_lines
from standoff.tracking import Feature, distance
from standoff.typing import Array
from standoff_studies.paper import style
from standoff_studies.paper.drawing import draw_arrow
from standoff_studies.paper.figure import HYBRID, Artwork, Statement, measured_by
from standoff_studies.paper.keys import key_below, key_line
from standoff_studies.paper.many_starts import INDEFINITE
from standoff_studies.paper.pair_simulation import Simulation, anywhere, never_grows
from standoff_studies.paper.patch_places import short
from standoff_studies.paper.resets import growth_statement
from standoff_studies.paper.simulation_d.runs import (
    ARRIVED,
    PATIENCE,
    SIMULATION,
    arrivals,
    moves_by_resets,
    tried,
)
from standoff_studies.paper.unaided import Part, unaided

RING, OUTER = 1.0, 1.62
"""Radii of faces and edges around the upper vertex, and of the circle of the lower vertex."""

FILL = "#D6E9F5"
"""Background of a visited feature's name."""

NODE = 0.21
"""Radius around a feature's middle that arrows leave free."""

INSTANT = 1e-9
"""Instants that differ by less are the same [s]: the accuracy of their location."""

PROBES = 267
"""Every how many frames the mode is compared with a separate global search."""


def figure_17() -> Artwork:
    """Draw the automaton with what the run visited."""
    runs = SIMULATION
    automaton = _automaton(runs)
    return Artwork(
        caption=(
            f"Simulation D, the printed system at K = {runs.gain:g}/s from a wrong start on F0: "
            "the hybrid automaton of the lens and the point, laid out as the lens is seen from "
            "above: its upper vertex V1 in the middle, faces F and edges E around it, the lower "
            "vertex V0 as the outer circle. Grey arrows are the switches that the automaton "
            "allows; blue ones were taken, at the instants [s] beside them, in the order of their "
            "numbers; the first two are those of the wrong start, whose face is not the closest "
            "one. Below each visited feature stands the time spent on it."
        ),
        text=(
            "A ring of three faces and three edges around a vertex. The run goes at once to face "
            "1, from there around the ring by way of edge 2, face 2, edge 1, face 0 and edge 0 "
            "back to face 1, then over edge 0 to the vertex and over edge 1 to face 0."
        ),
        draw=_draw,
        tables={"stays": _stays(runs), "transitions": _transitions(automaton)},
        statements=measured_by(runs.by, _statements(runs, automaton)),
    )


def _automaton(runs: Simulation) -> Automaton:
    found = runs.paper.automaton()
    assert isinstance(found, Automaton)  # the lens and the point are convex
    return found


def _stays(runs: Simulation) -> dict[str, list[Any]]:
    visits = runs.paper.modes()
    return {
        "feature": [str(visit.feature_a) for visit in visits],
        "start_s": [visit.start for visit in visits],
        "end_s": [visit.end for visit in visits],
    }


def _transitions(automaton: Automaton) -> dict[str, list[Any]]:
    return {
        "source": [str(t.source) for t in automaton.of("A")],
        "target": [str(t.target) for t in automaton.of("A")],
        "kind": [str(t.kind) for t in automaton.of("A")],
        "when": [t.switching for t in automaton.of("A")],
        "reset": [t.reset for t in automaton.of("A")],
        "taken_times": [len(_instants(automaton, t)) for t in automaton.of("A")],
        "taken_at_s": [
            "; ".join(f"{time:.9f}" for _, time in _instants(automaton, t))
            for t in automaton.of("A")
        ],
    }


def _instants(automaton: Automaton, transition: Transition) -> list[tuple[int, float]]:
    """Numbers (from 1) and instants [s] of a transition that was taken."""
    return [
        (number, time)
        for number, (time, taken) in enumerate(automaton.taken, start=1)
        if taken == transition
    ]


def _statements(runs: Simulation, automaton: Automaton) -> tuple[Statement, ...]:
    paper = runs.paper
    frames = np.linspace(round(runs.entered / runs.step), len(paper) - 1, PROBES)
    frames = frames.astype(int).tolist()
    found = [distance(runs.a, runs.b, np.eye(4), _at(paper.point_b[k])).feature_a for k in frames]
    agree = sum(
        feature == mode for feature, mode in zip(found, paper.feature_a[frames], strict=True)
    )
    off = runs.furthest()
    return (
        Statement(
            "Fig. 17",
            "the visited modes and the switching instants are marked in the automaton",
            f"{len(automaton.visited)} of {automaton.modes} modes visited, "
            f"{len(automaton.taken)} switches, each one that the automaton lists",
            len(automaton.taken) == len(paper.events) and not automaton.restarts,
            "the picture is drawn from the list of switches",
            constructed=True,
        ),
        Statement(
            HYBRID,
            "the active feature is that of the closest point",
            f"from {1e3 * runs.entered:g} ms on the mode is that of a global search in {agree} of "
            f"{len(frames)} frames",
            agree == len(frames),
        ),
        Statement(
            HYBRID,
            "for a body and a point the switching times do not depend on the continuous state",
            f"from {len(runs.starts)} wrong starts the same switches after {1e3 * runs.entered:g} "
            f"ms, at the instants of the library's own law to {off:.1e} s",
            off < INSTANT,
            "the projection errors of the starts take 0.4 s to fall below a ten-thousandth",
        ),
        *_as_printed(runs),
        never_grows(
            runs,
            "the feature after the switch is at most {} of the radius farther from the point than "
            "the one before it",
        ),
        growth_statement(moves_by_resets(), len(tried()), runs.by),
    )


def _as_printed(runs: Simulation) -> tuple[Statement, Statement]:
    """What happens from starts anywhere, and that nothing other than the law helps."""
    tried, still = arrivals(), arrivals(moving=False)
    return (
        anywhere(
            tried,
            "starts on the three faces are at the closest point "
            f"to {ARRIVED:g} after {PATIENCE:g} s; of the {tried.lost} others {tried.placed} are "
            f"on the right face, and {tried.pinned} are held at a side of a patch with M "
            f"indefinite. If the point stays where it begins {still.arrived} arrive, and of the "
            f"{still.lost} others it is {still.placed} and {still.pinned}",
            INDEFINITE,
        ),
        unaided([Part.of(one) for one in runs.printed], runs.by),
    )


def _at(point: Array) -> Array:
    pose = np.eye(4)
    pose[:3, 3] = point
    return pose


def _draw() -> Figure:
    automaton = _automaton(SIMULATION)
    places = _places(automaton.a)
    figure = style.new_figure(style.WIDTH, 7.0)
    axes = figure.add_subplot()
    angles = np.linspace(0.0, 2.0 * np.pi, 181)
    axes.plot(OUTER * np.cos(angles), OUTER * np.sin(angles), color=style.QUIET, linewidth=1.0)
    for transition in automaton.of("A"):
        _arrow(axes, automaton, places, transition)
    for feature in automaton.features_a:
        _node(axes, automaton, places, feature)
    _ends(axes, automaton, places)
    axes.set_aspect("equal")
    axes.set_xlim(-1.85, 1.85)
    axes.set_ylim(-1.78, 1.78)
    axes.set_axis_off()
    keys = [
        key_line("switch taken, number: instant [s]", style.BLUE, 2.2),
        key_line("switch allowed", style.QUIET, 0.8),
    ]
    key_below(figure, keys, 2)
    return figure


def _places(lens: Boundary) -> dict[Feature, Array]:
    """The place of each feature: at its azimuth about z, with the upper vertex in the middle."""
    places: dict[Feature, Array] = {}
    for face, part in enumerate(lens.face_parts):
        places[Feature("face", face)] = _around(part.charts[0].jet(0.5, 0.5)[0])
    for line in edge_lines(lens):
        places[Feature("edge", line.edge)] = _around(line.points[len(line.points) // 2])
    upper = int(np.argmax(lens.vertex_points[:, 2]))
    places[Feature("vertex", upper)] = np.zeros(2)
    return places


def _around(point: Array) -> Array:
    return np.asarray(RING * point[:2] / np.linalg.norm(point[:2]))


def _arrow(
    axes: Axes, automaton: Automaton, places: dict[Feature, Array], transition: Transition
) -> None:
    """One arrow for one direction: two that join the same features bend away from each other."""
    # the lower vertex is the outer circle: that end of the arrow is there, next to the other end
    middles = [places.get(feature) for feature in (transition.source, transition.target)]
    start, end = (
        place if place is not None else OUTER / RING * np.asarray(other)
        for place, other in zip(middles, reversed(middles), strict=True)
    )
    along = (end - start) / np.linalg.norm(end - start)
    aside = np.array([along[1], -along[0]])
    if middles[0] is not None:
        start = start + NODE * along
    if middles[1] is not None:
        end = end - NODE * along
    taken = _instants(automaton, transition)
    look: dict[str, Any] = (
        {"color": style.BLUE, "linewidth": 2.2, "mutation_scale": 15, "zorder": 3}
        if taken
        else {"color": style.QUIET, "linewidth": 0.8, "mutation_scale": 9, "zorder": 1}
    )
    shift = 0.035 * aside
    draw_arrow(axes, tuple(start + shift), tuple(end + shift), **look)
    if taken:
        words = "\n".join(f"{number}: {time:.3f}" for number, time in taken)
        level = abs(aside[0]) < 0.3
        x, y = 0.5 * (start + end) + (0.15 if level else 0.09) * aside
        side = "center" if level else "left" if aside[0] > 0.0 else "right"
        axes.text(x, y, words, ha=side, va="center", zorder=4)


def _node(axes: Axes, automaton: Automaton, places: dict[Feature, Array], feature: Feature) -> None:
    spent = sum(visit.end - visit.start for visit in automaton.visits if visit.feature_a == feature)
    x, y = places.get(feature, np.array([0.0, -OUTER])).tolist()
    axes.text(
        x,
        y,
        f"{short(feature)}\n{spent:.2f} s" if spent else short(feature),
        ha="center",
        va="center",
        zorder=5,
        bbox={
            "boxstyle": {"face": "square", "edge": "round", "vertex": "circle"}[feature.kind]
            + ",pad=0.35",
            "facecolor": FILL if spent else "white",
            "edgecolor": style.BLUE if spent else style.QUIET,
            "linewidth": 1.8 if spent else 0.9,
        },
    )


def _ends(axes: Axes, automaton: Automaton, places: dict[Feature, Array]) -> None:
    """Mark where the run begins and where it ends."""
    for visit, words, turn in (
        (automaton.visits[0], "start", 1.0),
        (automaton.visits[-1], "end", -1.0),
    ):
        place = places[visit.feature_a]
        out = place / np.linalg.norm(place)
        side = turn * np.array([-out[1], out[0]])
        x, y = place + 0.26 * out + 0.2 * side
        axes.text(x, y, words, ha="center", va="center", fontweight="bold")
