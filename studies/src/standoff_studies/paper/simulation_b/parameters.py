"""Fig. 11: the three curves' parameters against time, the active one heavy."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from standoff.typing import Array
from standoff_studies.paper import style
from standoff_studies.paper.drawing import short_name
from standoff_studies.paper.figure import Artwork, Statement, measured_by, own_statement
from standoff_studies.paper.pair_simulation import REST
from standoff_studies.paper.resets import (
    Errors,
    Reset,
    draw_projection_errors,
    reset_statement,
    reset_table,
    resets_of,
)
from standoff_studies.paper.simulation_b.automaton import FILLS, KINDS
from standoff_studies.paper.simulation_b.run import (
    CONVERGED,
    DURATION,
    GAIN,
    Run,
    psi,
    run,
)

VERTEX_FILL = "#E9A63A"
"""Background of the time at a vertex."""
LEAST_NAMED = 0.12
"""Stays shorter than this [s] are not named in the strip: their names would overlap."""


def figure_11() -> Artwork:
    """Make Fig. 11."""
    simulation = run()
    return Artwork(
        caption=(
            f"Parameters of the three curves against time [s], by the printed system at K = "
            f"{GAIN:g}/s from a wrong start. Inside, their trackers run in parallel: heavy where "
            "the medial axis names the curve, thin where it does not. Outside there is the active "
            "one alone. Black, thin: the library's own law on the active curve. "
            "At 0 and 1 a parameter is held at the curve's ends; a thin line that jumps or shakes "
            "is a tracker whose minimum has vanished. The strip above tells the "
            "mode, inside and outside; orange is a vertex. Vertical lines are the switches, as in "
            "Fig. 9: dashed jumps, dotted through the boundary, solid Voronoi. Last: the "
            "projection error of the active curve; rings are what each reset "
            "outside makes of it. At a vertex there is none."
        ),
        text=(
            "Three panels of one curve's parameter each over 4 s, saw-toothed, with heavy "
            "stretches that follow each other from curve to curve. A fourth panel of the error, "
            "which falls from the start, jumps at switches and falls again."
        ),
        draw=lambda: _draw(simulation),
        tables={
            "frames": _frames(simulation),
            "resets": reset_table(resets(simulation)),
        },
        statements=measured_by(simulation.paper.by, _statements(simulation)),
    )


def _frames(simulation: Run) -> dict[str, ArrayLike]:
    """Return the table of the frames.

    `exact_parameter_c0` and so on are those of the library's own law: a local minimum of the
    distance to that curve, the nearest one that the law follows. It is the curve's nearest point on
    the active curve; on another one, a nearer minimum may not be followed.
    """
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


def heavy(simulation: Run, curve: int, *, exact: bool = False) -> Array:
    """Return a curve's parameter where it is the active one, else nan, shape (n,)."""
    recording = simulation.exact if exact else simulation.paper
    own = [f.kind == "edge" and f.index == curve for f in recording.feature]
    held = simulation.exact.parameters[:, 0] if exact else simulation.paper.parameter
    return np.where(own, held, np.nan)


def resets(simulation: Run) -> list[Reset]:
    """Return the Voronoi switches outside beside what their resets imply."""
    return resets_of(simulation.paper.outside, (REST, simulation.path), GAIN)


def active_error(simulation: Run) -> Array:
    """Return the size of the active curve's error by frame [length²], nan at a vertex."""
    paper, found = simulation.paper, np.full(len(simulation.paper), np.nan)
    for curve in range(simulation.body.n_edges):
        own = np.array([f.kind == "edge" and f.index == curve for f in paper.feature])
        found[own] = np.abs(psi(paper, curve))[own]
    return found


def not_nearest(simulation: Run) -> NDArray[np.int64]:
    """Return the frames inside, once converged, whose active tracker is not the nearest."""
    paper = simulation.paper
    frames = np.flatnonzero(paper.inside & (paper.time > CONVERGED))
    active = [feature.index for feature in paper.feature[frames]]
    return np.asarray(frames[paper.curve_distance[frames].argmin(axis=1) != active])


def held(simulation: Run) -> tuple[int, float]:
    """Return how many frames at vertices there are, and how far the witness leaves them.

    nan where there are none.
    """
    paper, body = simulation.paper, simulation.body
    at = [k for k, feature in enumerate(paper.feature) if feature.kind == "vertex"]
    corners = np.array([body.vertex_points[paper.feature[k].index] for k in at])
    return len(at), float(np.abs(paper.witness[at] - corners).max()) if at else math.nan


def _statements(simulation: Run) -> tuple[Statement, ...]:
    paper, exact = simulation.paper, simulation.exact
    settled = paper.time > CONVERGED
    same = np.array([a == b for a, b in zip(paper.feature, exact.feature, strict=True)])
    frames, slip = held(simulation)
    late_inside = paper.inside & settled
    others = not_nearest(simulation)
    jumps = np.array([event.time for event in paper.events if event.kind == "medial"])
    since = max((float(t - jumps[jumps < t].max()) for t in paper.time[others]), default=0.0)
    due = exact.parameters[:, 0]
    on_curve = np.isfinite(paper.parameter) & np.isfinite(due) & settled & same
    lag = np.abs(paper.parameter - due)[on_curve]
    return (
        Statement(
            "Fig. 11",
            "parameters of the curves against time; inside all three at once",
            f"three trackers in each of {int(late_inside.sum())} frames inside after {CONVERGED:g} "
            f"s; in {int(late_inside.sum()) - len(others)} the one that the medial axis names is "
            f"the nearest of the three, in the others at most {1e3 * since:.0f} ms have gone since "
            f"the jump to it (1/K is {1e3 / GAIN:g} ms)",
            since < 1.0 / GAIN,
        ),
        Statement(
            "Fig. 11",
            "curve to vertex: the witness point is anchored",
            f"{frames} frames at vertices, the witness point leaves them by {slip:.0e} length",
            slip == 0.0,
            "a vertex has no parameter that could move",
            constructed=True,
        ),
        reset_statement(resets(simulation), paper.by),
        own_statement(
            "Fig. 11",
            f"active parameter of the paper's law against the certified one after {CONVERGED} s: "
            f"median {np.median(lag):.0e}, at most {lag.max():.2g}; the same feature in "
            f"{np.mean(same[settled]):.2%} of the frames",
            "The greatest lag is where a curve takes over soon after its parameter left its bound.",
        ),
    )


def _draw(simulation: Run) -> Figure:
    figure = style.new_figure(style.WIDTH, 9.2)
    panels = figure.subplots(5, 1, sharex=True, height_ratios=(0.42, 1.0, 1.0, 1.0, 1.3))
    _draw_strip(panels[0], simulation)
    for curve in range(3):
        _draw_curve(panels[curve + 1], simulation, curve)
    _draw_errors(panels[-1], simulation)
    panels[-1].set_xlabel("time [s]")
    panels[-1].set_xlim(0.0, DURATION)
    for name, dashes, colour in KINDS.values():
        panels[1].plot([], [], linestyle=dashes, color=colour, linewidth=1.3, label=name)
    panels[1].plot([], [], color=style.BLACK, linewidth=0.7, label="library's own law")
    figure.legend(loc="outside lower center", ncols=3, frameon=False, handlelength=3.0)
    return figure


def _draw_errors(axes: Axes, simulation: Run) -> None:
    errors = Errors(simulation.paper.time, active_error(simulation))
    draw_projection_errors(axes, errors, resets(simulation))
    axes.set_ylabel("|Ψ| [length²]")


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
    own = heavy(simulation, curve, exact=True)
    axes.plot(paper.time, own, color=style.BLACK, linewidth=0.7, zorder=5)
    axes.set_ylim(-0.07, 1.07)
    axes.set_yticks([0.0, 0.5, 1.0])
    axes.set_ylabel(f"u of C{curve}")
    axes.grid(visible=False)
