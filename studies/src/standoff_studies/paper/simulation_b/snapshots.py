"""Fig. 10: a hundred witness lines from a wrong start; and the motion itself."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from standoff.typing import Array
from standoff_studies.paper import style
from standoff_studies.paper.drawing import (
    draw_feature,
    draw_planar_body,
    draw_witness_line,
    short_name,
    show_plane,
)
from standoff_studies.paper.figure import Animation, Artwork, Statement, measured_by, own_statement
from standoff_studies.paper.simulation_b.regions import EXTENT
from standoff_studies.paper.simulation_b.run import (
    CONVERGED,
    FRAME,
    GAIN,
    SNAPSHOTS,
    WRONG_START,
    Run,
    decay,
    run,
)
from standoff_studies.paper.voronoi_drawing import draw_planar_regions

OFF = 0.01
"""Snapshots whose witness point has a greater error [length], before `CONVERGED`, still come from
the wrong start: on paper it is half a millimetre."""
SWEEP = ((0.62, 0.9), (1.9, 2.2), (3.42, 3.72))
"""Times between which arrows show in which direction the point moves [s]."""
WINDOW = (0.02, 0.2)
"""Times between which the decay is measured [s]."""
SECONDS = 0.08
"""A frame of the animation on the screen [s]."""
LOOKS = {
    "start": ("from the wrong start", style.BLACK, "-", 2.0),
    "inside": ("inside", style.RED, "--", 1.0),
    "curve": ("outside, on a curve", style.BLUE, "-", 1.0),
    "vertex": ("outside, anchored at a vertex", style.GREEN, "-.", 1.8),
}
"""Names, colours, dashes and widths of the kinds of witness lines."""


def figure_10() -> Artwork:
    """Make Fig. 10."""
    simulation = run()
    return Artwork(
        caption=(
            "A hundred snapshots, one every 40 ms: the point (dots) and its witness line, by the "
            f"printed system at K = {GAIN:g}/s; thin and grey, the library's own law. The first "
            f"ones (thick, black, off by more than {OFF:g}) still come from the deliberately wrong "
            "start; then the lines are normal to the curve. Arrows show which way the point goes. "
            "Inside (vermilion, dashed) they jump over the medial axis; outside they end on a "
            "curve (blue), or are anchored at a vertex (green, dash-dotted). The animation also "
            "shows, inside, the two curves that are not nearest."
        ),
        text=(
            "A planar body with witness lines like spokes from a spiral; they jump between curves "
            "inside, and fan out from the three vertices outside."
        ),
        draw=lambda: _draw(simulation),
        tables={"snapshots": _table(simulation)},
        statements=measured_by(simulation.paper.by, _statements(simulation)),
        animation=Animation(
            SNAPSHOTS,
            lambda figure, k: _draw_moment(figure, simulation, k),
            SECONDS,
            (5.6, 5.6),
            "The point spirals outwards; the nearest witness line is heavy, the other curves' "
            "are thin.",
        ),
    )


def kind_of(simulation: Run, snapshot: int) -> str:
    """Return which of `LOOKS` a snapshot's witness line has."""
    frame = int(simulation.snapshots[snapshot])
    if paper_error(simulation, frame) > OFF and simulation.paper.time[frame] < CONVERGED:
        return "start"
    if simulation.paper.inside[frame]:
        return "inside"
    return "vertex" if simulation.paper.feature[frame].kind == "vertex" else "curve"


def paper_error(simulation: Run, frame: int) -> float:
    """Return the error of the printed system's witness point in one frame [length]."""
    own, exact = simulation.paper.witness[frame], simulation.exact.witness[frame]
    return float(np.linalg.norm(own - exact))


def _table(simulation: Run) -> dict[str, ArrayLike]:
    paper, frames = simulation.paper, simulation.snapshots
    table: dict[str, ArrayLike] = {
        "time_s": paper.time[frames],
        "inside": paper.inside[frames],
        "feature": [short_name(feature) for feature in paper.feature[frames]],
        "distance_length": paper.distance[frames],
        "exact_distance_length": simulation.exact.distance[frames],
    }
    for name, points in (("point", paper.point), ("witness", paper.witness)):
        for k, axis in enumerate("xy"):
            table[f"{name}_{axis}_length"] = points[frames, k]
    return table


def distance_error(simulation: Run) -> Array:
    """Return the error of the distance by the paper's law, by frame [length], shape (n,)."""
    return np.asarray(np.abs(simulation.paper.distance - simulation.exact.distance))


def _statements(simulation: Run) -> tuple[Statement, ...]:
    exact, error = simulation.exact, distance_error(simulation)
    rates = [decay(simulation.paper, curve, *WINDOW) for curve in range(3)]
    crossing = next(event for event in exact.events if event.kind == "crossing")
    jump = np.abs(np.diff(exact.distance)).max()
    speed = np.linalg.norm(np.diff(exact.point, axis=0), axis=1).max()
    certified = np.mean([answer.certified for answer in exact.answers])
    k = int(np.searchsorted(exact.time, crossing.time))
    turn = float(np.arccos(min(1.0, exact.normal[k - 1] @ exact.normal[k])))
    return (
        Statement(
            "Eq. (14)",
            "the projection errors decay as exp(−K t) from a deliberately wrong start",
            f"started at {WRONG_START}, the distance off by {error[0]:.3f} length; the three "
            f"curves' errors fall at {min(rates):.2f} to {max(rates):.2f} per s with "
            f"K = {GAIN:g} per s",
            max(abs(rate - GAIN) for rate in rates) < 0.02 * GAIN,
        ),
        own_statement(
            "Fig. 10",
            f"distance off by {error[round(CONVERGED / FRAME)]:.0e} length at {CONVERGED} s; later "
            f"by {np.median(error[exact.time > CONVERGED]):.0e} in the middle, "
            f"{error[exact.time > CONVERGED].max():.1e} at most",
            "The greatest errors come after a parameter has left its bound, from which the law "
            "sets off early, by its rate over K.",
        ),
        Statement(
            "Fig. 10",
            "-",
            f"signed distance through the boundary at {crossing.time:.6f} s: from frame to frame "
            f"it changes by at most {jump:.2e} length, the point's way by {speed:.2e}; the normal "
            f"turns by {turn:.1e} rad in the crossing's frame",
            bool(jump <= speed * (1.0 + 1e-12)),
            by=simulation.own,
        ),
        Statement(
            "Fig. 10",
            "-",
            f"certified in {certified:.0%} of {len(exact)} frames, bounds at most "
            f"{np.max(exact.upper_bound - exact.lower_bound):.1e} length apart",
            bool(certified == 1.0),
            by=simulation.own,
        ),
    )


def _draw(simulation: Run) -> Figure:
    figure = style.new_figure(style.WIDTH, 7.5)
    axes = figure.subplots()
    draw_planar_regions(axes, simulation.regions, reach=3.0, linewidth=0.8)
    draw_planar_body(axes, simulation.body, colour=style.BLACK, linewidth=1.6)
    paper = simulation.paper
    for k, frame in enumerate(simulation.snapshots.tolist()):
        _, colour, dashes, width = LOOKS[kind_of(simulation, k)]
        exact = np.array([paper.point[frame], simulation.exact.witness[frame]])
        axes.plot(exact[:, 0], exact[:, 1], color=style.QUIET, linewidth=0.6, zorder=1)
        ends = np.array([paper.point[frame], paper.witness[frame]])
        axes.plot(ends[:, 0], ends[:, 1], color=colour, linestyle=dashes, linewidth=width)
        axes.plot(*ends[0, :2], "o", color=colour, markersize=2.8, zorder=5)
    for name, colour, dashes, width in LOOKS.values():
        axes.plot([], [], color=colour, linestyle=dashes, linewidth=width + 0.4, label=name)
    axes.plot([], [], color=style.QUIET, linewidth=0.8, label="library's own law")
    for span in SWEEP:
        _draw_sweep(axes, simulation, *span)
    show_plane(axes, EXTENT)
    figure.legend(loc="outside lower center", ncols=2, frameon=False, handlelength=3.5)
    return figure


def _draw_sweep(axes: Axes, simulation: Run, first: float, last: float) -> None:
    """An arrow next to a part of the point's path, just outside it."""
    low, high = (int(np.searchsorted(simulation.paper.time, t)) for t in (first, last))
    way = 1.0 * simulation.paper.point[low:high, :2]
    way *= 1.0 + 0.07 / np.linalg.norm(way, axis=1)[:, None]
    axes.plot(way[:, 0], way[:, 1], color=style.BLACK, linewidth=1.3, zorder=6)
    head = {"arrowstyle": "-|>", "color": style.BLACK, "mutation_scale": 13.0, "shrinkA": 0.0}
    axes.annotate("", tuple(way[-1]), tuple(way[-12]), arrowprops=head, zorder=6)


def _draw_moment(figure: Figure, simulation: Run, k: int) -> None:
    """Draw one picture of the animation."""
    paper, frame = simulation.paper, int(simulation.snapshots[k])
    axes = figure.subplots()
    trail = paper.point[: frame + 1 : 10]
    draw_planar_regions(axes, simulation.regions, reach=3.0, linewidth=0.8)
    axes.plot(trail[:, 0], trail[:, 1], color=style.QUIET, linewidth=1.0)
    draw_planar_body(axes, simulation.body, colour=style.BLUE, linewidth=1.4)
    draw_feature(axes, simulation.body, paper.feature[frame], colour=style.BLUE)
    if paper.inside[frame]:
        for part, u in zip(simulation.body.edge_parts, paper.curve_parameter[frame], strict=True):
            ends = np.array([paper.point[frame], part.curve.point(float(u))])
            axes.plot(ends[:, 0], ends[:, 1], "--", color=style.RED, linewidth=1.1)
    draw_witness_line(axes, paper.point[frame], paper.witness[frame], linewidth=2.2)
    show_plane(axes, EXTENT)
    side = "inside" if paper.inside[frame] else "outside"
    axes.set_title(
        f"{paper.time[frame]:4.2f} s   {short_name(paper.feature[frame])} {side}   "
        f"d = {paper.distance[frame]:+.3f}"
    )
