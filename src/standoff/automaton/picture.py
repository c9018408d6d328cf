"""An automaton drawn: both bodies' features in rows, and the modes that a motion went through."""

from __future__ import annotations

from typing import BinaryIO

import numpy as np
import scipy

from standoff.automaton.body_panel import (
    QUIET_COLOUR,
    VISITED_COLOUR,
    VISITED_FILL,
    draw_body,
    rows_of,
)
from standoff.automaton.branches import ParallelBranches
from standoff.automaton.graph import Automaton
from standoff.automaton.lanes import draw_lanes
from standoff.automaton.lanes import rows_of as lanes_of
from standoff.automaton.text import MOST_DRAWN, Names, moves, product_switches
from standoff.bodies.features import Feature
from standoff.errors import of_extra
from standoff.wording import counted

with of_extra("matplotlib"):
    from matplotlib.axes import Axes
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.patches import FancyArrowPatch

NODE_WIDTH, APART = 0.62, 0.95
"""Inches that a feature takes in its row: room for its name and its time; and for an arc beside it,
where only those that were visited are shown."""

LEAST_WIDTH, MOST_WIDTH = 4.2, 40.0
"""Inches of one body's panel; a polytope of hundreds of features is scaled in the reader."""

ROW_HEIGHT = 0.3
"""Inches of a mode's row in the picture of the visits."""


def write_automaton(
    file: BinaryIO,
    ending: str,
    automaton: Automaton | ParallelBranches,
    names: Names = ("A", "B"),
    title: str = "",
) -> None:
    """Draw an automaton to a stream.

    Raises OSError if the file cannot be written.

    Parameters
    ----------
    file : binary stream
    ending : str
        The format: ``svg``, ``png`` or ``pdf``.
    automaton : Automaton or SolidAutomaton
    names : (str, str)
        What A and B are called.
    title : str
    """
    automaton_figure(automaton, names, title).savefig(file, format=ending)


def automaton_figure(
    automaton: Automaton | ParallelBranches, names: Names = ("A", "B"), title: str = ""
) -> Figure:
    """Draw an automaton: both bodies' features, and under them the modes over time, of solids a
    lane for each branch.

    Parameters
    ----------
    automaton : Automaton or SolidAutomaton
    names : (str, str)
        What A and B are called.
    title : str
    """
    most = MOST_DRAWN if isinstance(automaton, ParallelBranches) and automaton.visits else None
    rows = {letter: rows_of(automaton, letter, most) for letter in "AB"}
    node = NODE_WIDTH if most is None else APART
    widths = [
        min(max(LEAST_WIDTH, node * max(map(len, row.values()), default=0)), MOST_WIDTH)
        for row in rows.values()
    ]
    below = _height_below(automaton)
    figure = Figure(figsize=(sum(widths) + 0.6, 4.0 + below), dpi=150, layout="constrained")
    FigureCanvasAgg(figure)
    parts = ["A", "B"], ["pair", "pair"]
    axes = figure.subplot_mosaic(
        [list(row) for row in (parts if below else parts[:1])],
        width_ratios=widths,
        height_ratios=[3.2, below] if below else None,
    )
    for letter, name in zip("AB", names, strict=True):
        told = _body_title(automaton, letter, name, sum(map(len, rows[letter].values())))
        draw_body(axes[letter], automaton, letter, told, rows[letter])
    if isinstance(automaton, ParallelBranches):
        if automaton.visits:
            draw_lanes(axes["pair"], automaton)
    elif automaton.visits:
        _draw_visits(axes["pair"], automaton)
    elif below:
        _draw_product(axes["pair"], automaton)
    figure.suptitle(title or f"Modes of {names[0]} and {names[1]}")
    figure.supxlabel(
        "downwards: a step reaches the end of a feature; upwards: at rest, the slope of the "
        "distance falls below −ε; arcs: a smooth edge is passed"
        + (";\ntimes are summed over branches" if most is not None else ""),
        fontsize="small",
    )
    # The arrows end at the features' boxes, whose sizes are known once they were laid out.
    figure.draw_without_rendering()
    return figure


def _body_title(automaton: Automaton | ParallelBranches, letter: str, name: str, shown: int) -> str:
    body = automaton.a if letter == "A" else automaton.b
    every = len(automaton.features_a if letter == "A" else automaton.features_b)
    if body is None:
        return f"{letter} = {name}: what was visited"
    part = f": {shown} of {every} features" if shown < every else ""
    return f"{letter} = {name} ({body.name}){part}"


def _height_below(automaton: Automaton | ParallelBranches) -> float:
    """Inches of the lower panel; 0 where the product is too large, or one body's own automaton."""
    if isinstance(automaton, ParallelBranches):
        return 1.2 + ROW_HEIGHT * lanes_of(automaton)[1] if automaton.visits else 0.0
    if automaton.visits:
        return 1.0 + ROW_HEIGHT * len(automaton.visited)
    several = min(len(automaton.features_a), len(automaton.features_b)) > 1
    if several and automaton.modes <= MOST_DRAWN:
        return 0.8 + 0.45 * len(automaton.features_b)
    return 0.0


def _draw_visits(axes: Axes, automaton: Automaton) -> None:
    """A row for each visited mode, a bar for each stay, a line for each switch."""
    row = {mode: k for k, mode in enumerate(automaton.visited)}
    for mode, k in row.items():
        axes.broken_barh(
            [(visit.start, visit.end - visit.start) for visit in automaton.stays(mode)],
            (k - 0.3, 0.6),
            facecolor=VISITED_FILL,
            edgecolor=VISITED_COLOUR,
            linewidth=0.8,
        )
    for source, target, times in moves(automaton.visits):
        for time in times:
            restart = time in automaton.restarts
            axes.plot(
                [time, time],
                [row[source], row[target]],
                color="black" if restart else VISITED_COLOUR,
                linestyle=":" if restart else "-",
                linewidth=1.0,
            )
    axes.set_yticks(list(row.values()), [f"{a} – {b}" for a, b in row], fontsize="small")
    for mode, k in row.items():
        axes.annotate(
            f" {automaton.time_in(mode):.3g} s",
            (1.0, k),
            xycoords=("axes fraction", "data"),
            va="center",
            fontsize="small",
        )
    axes.set_ylim(len(row) - 0.4, -0.6)
    axes.set_xlim(automaton.visits[0].start, automaton.visits[-1].end)
    axes.set_xlabel("time (s)")
    axes.grid(axis="x", alpha=0.3)
    switches = counted(len(automaton.taken), "switch", "switches")
    restarts = counted(len(automaton.restarts), "restart")
    axes.set_title(
        f"visited: {len(row)} of {automaton.modes} modes (A – B), {switches}"
        + (f", {restarts} (dotted)" if automaton.restarts else ""),
        fontsize="medium",
        loc="left",
    )


def _side_by_side(automaton: Automaton, letter: str) -> dict[Feature, int]:
    """Places of one body's features along a line, neighbours near each other."""
    features = automaton.features_a if letter == "A" else automaton.features_b
    number = {feature: k for k, feature in enumerate(features)}
    pairs = np.array([(number[t.source], number[t.target]) for t in automaton.of(letter)])
    joins = np.ones(len(pairs)), pairs.reshape(-1, 2).T
    order = scipy.sparse.csgraph.reverse_cuthill_mckee(
        scipy.sparse.csr_array(joins, shape=(len(features),) * 2), symmetric_mode=True
    )
    return {features[int(k)]: place for place, k in enumerate(order)}


def _draw_product(axes: Axes, automaton: Automaton) -> None:
    """Modes in a grid, A's features along, B's down; each switch keeps a row or a column."""
    column = _side_by_side(automaton, "A")
    row = _side_by_side(automaton, "B")
    drawn = {frozenset(pair) for pair in product_switches(automaton)}
    for source, target in (tuple(pair) for pair in drawn if len(pair) == 2):
        start = (float(column[source[0]]), float(row[source[1]]))
        end = (float(column[target[0]]), float(row[target[1]]))
        near = abs(start[0] - end[0]) + abs(start[1] - end[1]) <= 1.0
        axes.add_patch(
            FancyArrowPatch(
                *sorted((start, end)),
                arrowstyle="-",
                connectionstyle="arc3" if near else "arc3,rad=0.15",
                shrinkA=0.0,
                shrinkB=0.0,
                color=QUIET_COLOUR,
                linewidth=0.7,
            )
        )
    axes.plot(
        [column[a] for a in column for _ in row],
        [row[b] for _ in column for b in row],
        "o",
        markersize=11,
        markerfacecolor="white",
        markeredgecolor="black",
        linestyle="none",
    )
    axes.set_xticks(
        list(column.values()), [f"A: {feature}" for feature in column], fontsize="small"
    )
    axes.set_yticks(list(row.values()), [f"B: {feature}" for feature in row], fontsize="small")
    axes.set_xlim(-0.6, len(column) - 0.4)
    axes.set_ylim(len(row) - 0.4, -0.6)
    for side in axes.spines.values():
        side.set_visible(False)
    axes.set_title(
        f"the pair: {automaton.modes} modes, each switch along a row or a column",
        fontsize="medium",
        loc="left",
    )
