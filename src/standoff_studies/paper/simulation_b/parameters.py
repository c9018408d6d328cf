"""Fig. 11: the three curves' parameters against time, the active one heavy."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from standoff_studies.paper import style
from standoff_studies.paper.drawing import short_name
from standoff_studies.paper.figure import Artwork, Statement
from standoff_studies.paper.simulation_b.automaton import FILLS, KINDS
from standoff_studies.paper.simulation_b.run import CONVERGED, DURATION, Run, run

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

VERTEX_FILL = "#E9A63A"
"""Behind the time at a vertex."""
LEAST_NAMED = 0.12
"""Stays shorter than this [s] are not named in the strip: their names would overlap."""


def figure_11() -> Artwork:
    """Make Fig. 11."""
    simulation = run()
    return Artwork(
        caption=(
            "Parameters of the three curves against time [s], as their trackers run in parallel; "
            "heavy where the curve is the nearest, thin where it is not. They begin at the wrong "
            "start. At 0 and 1 they are held at the curve's ends; thin lines break where another "
            "minimum of the distance to that curve becomes its nearest, and run wild where one has "
            "just vanished, until the law has come to another. The strip above tells the "
            "mode, inside and outside; orange is a vertex. Vertical lines are the switches, as in "
            "Fig. 9: dashed jumps, dotted through the boundary, solid Voronoi."
        ),
        text=(
            "Three panels of one curve's parameter each over 4 s, saw-toothed, with heavy "
            "stretches that follow each other from curve to curve."
        ),
        draw=lambda: _draw(simulation),
        tables={"frames": _frames(simulation)},
        statements=_statements(simulation),
    )


def _frames(simulation: Run) -> dict[str, ArrayLike]:
    paper, exact = simulation.paper, simulation.exact
    table: dict[str, ArrayLike] = {
        "time_s": paper.time,
        "inside": paper.inside,
        "feature": [short_name(feature) for feature in paper.feature],
        "active_parameter": paper.parameter,
        "distance_length": paper.distance,
    }
    for curve in range(simulation.body.n_edges):
        table[f"parameter_c{curve}"] = paper.curve_parameter[:, curve]
        table[f"exact_parameter_c{curve}"] = exact.curve_parameter[:, curve]
        table[f"distance_c{curve}_length"] = paper.curve_distance[:, curve]
    return table


def heavy(simulation: Run, curve: int) -> Array:
    """Return a curve's parameter where it is the active one, else nan, shape (n,)."""
    paper = simulation.paper
    own = [f.kind == "edge" and f.index == curve for f in paper.feature]
    return np.where(own, paper.parameter, np.nan)


def held(simulation: Run) -> tuple[int, float]:
    """Return how many frames at vertices there are, and how far the witness leaves them."""
    exact, body = simulation.exact, simulation.body
    at = [k for k, feature in enumerate(exact.feature) if feature.kind == "vertex"]
    corners = np.array([body.vertex_points[exact.feature[k].index] for k in at])
    return len(at), float(np.abs(exact.witness[at] - corners).max())


def _statements(simulation: Run) -> tuple[Statement, ...]:
    paper, exact = simulation.paper, simulation.exact
    settled = paper.time > CONVERGED
    same = np.array([a == b for a, b in zip(paper.feature, exact.feature, strict=True)])
    frames, slip = held(simulation)
    on_curve = np.isfinite(paper.parameter) & np.isfinite(exact.parameter) & settled & same
    lag = np.abs(paper.parameter - exact.parameter)[on_curve]
    return (
        Statement(
            "Fig. 11",
            "parameters of the curves against time; inside all three at once",
            f"three trackers in each of {len(paper)} frames; the active one is the nearest in all",
            bool(
                (
                    np.abs(paper.distance[paper.inside])
                    <= _least(paper.curve_distance[paper.inside])
                ).all()
            ),
        ),
        Statement(
            "Fig. 11",
            "curve to vertex: the witness point is anchored",
            f"{frames} frames at vertices, the witness point leaves them by {slip:.0e} length",
            slip == 0.0,
        ),
        Statement(
            "Fig. 11",
            "-",
            f"active parameter of the paper's law against the certified one after {CONVERGED} s: "
            f"median {np.median(lag):.0e}, at most {lag.max():.2g}; the same feature in "
            f"{np.mean(same[settled]):.2%} of the frames",
            None,
            "The greatest lag is where a curve takes over soon after its parameter left its bound.",
        ),
    )


def _least(distances: Array) -> Array:
    return np.asarray(distances.min(axis=1) * (1.0 + 1e-14))


def _draw(simulation: Run) -> Figure:
    with style.settings():
        figure = style.new_figure(style.WIDTH, 7.6)
        panels = figure.subplots(4, 1, sharex=True, height_ratios=(0.42, 1.0, 1.0, 1.0))
        _draw_strip(panels[0], simulation)
        for curve in range(3):
            _draw_curve(panels[curve + 1], simulation, curve)
        panels[-1].set_xlabel("time [s]")
        panels[-1].set_xlim(0.0, DURATION)
        for name, dashes, colour in KINDS.values():
            panels[-1].plot([], [], linestyle=dashes, color=colour, linewidth=1.3, label=name)
        figure.legend(loc="outside lower center", ncols=3, frameon=False, handlelength=3.0)
    return figure


def _draw_strip(axes: Axes, simulation: Run) -> None:
    """The modes in order of time."""
    for visit in simulation.paper.modes():
        vertex = visit.feature.kind == "vertex"
        axes.axvspan(
            visit.start,
            visit.end,
            facecolor=VERTEX_FILL if vertex else FILLS[visit.inside],
            edgecolor=style.BLACK,
            linewidth=0.6,
        )
        if visit.end - visit.start >= LEAST_NAMED:
            middle = 0.5 * (visit.start + visit.end)
            side = "in" if visit.inside else "out"
            label = f"{short_name(visit.feature)}\n{side}"
            axes.text(middle, 0.5, label, ha="center", va="center", fontsize=style.FONT - 1.0)
    axes.set_ylim(0.0, 1.0)
    axes.set_yticks([])
    axes.set_ylabel("mode")
    axes.grid(visible=False)


def _draw_curve(axes: Axes, simulation: Run, curve: int) -> None:
    paper, colour = simulation.paper, style.COLOURS[curve]
    for event in paper.events:
        _, dashes, line = KINDS[event.kind]
        axes.axvline(event.time, linestyle=dashes, color=line, linewidth=0.9, alpha=0.75, zorder=1)
    parameter = paper.curve_parameter[:, curve].copy()
    jumps = np.flatnonzero(np.abs(np.diff(parameter)) > 0.3)
    thin = np.insert(parameter, jumps + 1, np.nan)
    axes.plot(np.insert(paper.time, jumps + 1, np.nan), thin, color=colour, linewidth=1.0, zorder=3)
    axes.plot(paper.time, heavy(simulation, curve), color=colour, linewidth=3.4, zorder=4)
    axes.set_ylim(-0.07, 1.07)
    axes.set_yticks([0.0, 0.5, 1.0])
    axes.set_ylabel(f"u of C{curve}")
    axes.grid(visible=False)
