"""Fig. 20: the face parameters of both witness points against time, over two edges."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from standoff.paper import style
from standoff.paper.figure import Artwork, Statement
from standoff.paper.held_features import CONTINUOUS, greatest_growth, growth
from standoff.paper.simulation_d.runs import short
from standoff.paper.simulation_e.runs import (
    PATH_A,
    PATH_B,
    Runs,
    face_parameters,
    features_of,
    rises,
    run,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

SHADES = ("#FFFFFF", "#ECECEC")
"""Behind the modes, in turn."""


def figure_20() -> Artwork:
    """Draw the parameters of both witness points."""
    runs = run()
    return Artwork(
        caption=(
            "Simulation E: the parameters u (solid) and v (dashed) of the patch that each witness "
            "point is on, with the paper's law at 1 kHz. The modes are shaded in turn and named on "
            "top, A's feature first; thin lines mark the switching instants. On an edge (bar) "
            "the point keeps the parameters of the patch that it came from, and u stays at 1; when "
            "it leaves to the next patch they jump to that one's. Below: the distance, in the "
            "radius of A's faces."
        ),
        text=(
            "Two panels of parameters between 0 and 1, one a body. In each, u rises to 1, stays "
            "there while the point is on an edge, then jumps to 0 on the next patch and rises "
            "again. The third panel shows the distance, a smooth curve through all switches."
        ),
        draw=_draw,
        tables={"parameters": _parameter_table(runs), "switches": _switch_table(runs)},
        statements=_statements(runs),
    )


def passes_an_edge(features: tuple[str, ...]) -> bool:
    """Does a witness point go from a face into an edge and out to another face?"""
    kinds = "".join(name[0] for name in features)
    at = kinds.find("FEF")
    return at >= 0 and features[at] != features[at + 2]


def _statements(runs: Runs) -> tuple[Statement, ...]:
    paths = {body: features_of(runs.paper, body) for body in "AB"}
    offsets = edge_offsets(runs)
    grows = greatest_growth(runs.exact, (PATH_A, PATH_B))
    late = switch_differences(runs)
    slopes = [abs(event.slope) for event in runs.exact.events]
    return (
        Statement(
            "Fig. 20",
            "a witness point enters an edge and leaves it to the next face",
            "; ".join(f"{body}: {' → '.join(path)}" for body, path in paths.items()),
            all(passes_an_edge(path) for path in paths.values()),
        ),
        Statement(
            "Fig. 20",
            "-",
            f"in {len(offsets)} frames on an edge u is off 1 by {offsets.max():.0e}",
            None,
        ),
        Statement(
            "Section on the hybrid system",
            "the distance between features never grows at a switch",
            f"at each of {len(runs.exact.events)} instants the features after the switch are at "
            f"most {grows:.0e} of the radius farther apart than those before it",
            grows <= CONTINUOUS,
            "Old and new feature share the point at which they switch.",
        ),
        Statement(
            "Section on the hybrid system",
            "-",
            "in the paper's law at 1 kHz the frame that enters an edge ends up to "
            f"{rises(runs).max():.0e} of the radius farther apart than the same step without the "
            "switch",
            None,
            "the step ends at the boundary and what is left of it is lost for both witness points; "
            "Heun's method with K h = 1 then halves the error each frame",
        ),
        Statement(
            "Fig. 20",
            "-",
            f"the default law locates all {len(runs.exact.events)} switches, whose functions "
            f"cross 0 at {min(slopes):.1f} to {max(slopes):.1f} per second; the paper's law "
            f"switches at most {1e6 * np.abs(late).max():.1f} µs off",
            None,
        ),
    )


def edge_offsets(runs: Runs) -> Array:
    """Return |u - 1| in the frames in which a witness point is on an edge, for both bodies."""
    found = []
    for body in "AB":
        places = face_parameters(runs.paper, body)
        found.append(np.abs(places.u[places.on_edge] - 1.0))
    return np.concatenate(found)


def switch_differences(runs: Runs) -> Array:
    """Return how much later the paper's law switches than the default law [s], by switch."""
    pairs = zip(runs.paper.events, runs.exact.events, strict=True)
    return np.array([one.time - other.time for one, other in pairs])


def _parameter_table(runs: Runs) -> dict[str, Array | list[str]]:
    table: dict[str, Array | list[str]] = {"time_s": runs.paper.time}
    for body in "AB":
        places = face_parameters(runs.paper, body)
        table |= {f"u_{body.lower()}": places.u, f"v_{body.lower()}": places.v}
        table[f"face_{body.lower()}"] = places.face.astype(float)
    table["feature_a"] = [short(feature) for feature in runs.paper.feature_a]
    table["feature_b"] = [short(feature) for feature in runs.paper.feature_b]
    table["distance"] = runs.paper.distance
    return table


def _switch_table(runs: Runs) -> dict[str, Array | list[str]]:
    events = runs.exact.events
    return {
        "body": [event.body for event in events],
        "source": [short(event.source) for event in events],
        "target": [short(event.target) for event in events],
        "time_s": np.array([event.time for event in events]),
        "time_paper_law_s": np.array([event.time for event in runs.paper.events]),
        "slope_per_s": np.array([event.slope for event in events]),
        "distance_growth": np.array(
            [growth(runs.exact, (PATH_A, PATH_B), event) for event in events]
        ),
    }


def _draw() -> Figure:
    runs = run()
    with style.settings():
        figure = style.new_figure(style.WIDTH, 6.6)
        panels = figure.subplots(3, 1, sharex=True)
        for axes, body in zip(panels, "AB", strict=False):
            _shade(axes, runs)
            _draw_parameters(axes, runs, body)
        _shade(panels[2], runs)
        panels[2].plot(runs.paper.time, runs.paper.distance, color=style.BLACK)
        panels[2].set(xlabel="time [s]", ylabel="distance [radius]")
        panels[2].set_xlim(0.0, runs.paper.time[-1])
        _name_modes(panels[0], runs)
        handles, names = panels[0].get_legend_handles_labels()
        figure.legend(handles, names, loc="outside lower center", ncols=3, frameon=False)
        figure.align_ylabels()
    return figure


def _draw_parameters(axes: Axes, runs: Runs, body: str) -> None:
    places = face_parameters(runs.paper, body)
    time = runs.paper.time
    for piece in places.pieces:
        first = piece.start == 0
        label = ("u", "v") if first else (None, None)
        axes.plot(time[piece], places.u[piece], color=style.BLUE, label=label[0])
        axes.plot(time[piece], places.v[piece], color=style.RED, linestyle="--", label=label[1])
        where: dict[str, Any] = {"ha": "left", "va": "center", "color": "#303030"}
        axes.text(time[piece.start] + 0.02, 0.27, f"{body} F{places.face[piece.start]}", **where)
    on = np.flatnonzero(places.on_edge)
    axes.axvspan(
        time[on[0]], time[on[-1]], ymin=0.0, ymax=0.07, color=style.ORANGE, label="on an edge"
    )
    axes.set_ylim(-0.08, 1.08)
    axes.set_yticks([0.0, 0.5, 1.0])
    axes.set_ylabel(f"{body}: u, v [–]")


def _shade(axes: Axes, runs: Runs) -> None:
    axes.grid(visible=False)
    for k, stay in enumerate(runs.exact.modes()):
        axes.axvspan(stay.start, stay.end, color=SHADES[k % 2], linewidth=0.0, zorder=0)
        if k:
            axes.axvline(stay.start, color=style.QUIET, linewidth=0.8, zorder=1)


def _name_modes(axes: Axes, runs: Runs) -> None:
    for stay in runs.exact.modes():
        axes.annotate(
            f"{short(stay.feature_a)}–{short(stay.feature_b)}",
            (0.5 * (stay.start + stay.end), 1.0),
            (0.0, 4.0),
            xycoords=("data", "axes fraction"),
            textcoords="offset points",
            ha="center",
        )
