"""An automaton drawn: both bodies' features in rows, and the modes that a motion went through."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import BinaryIO

import numpy as np
import scipy

from standoff.automaton.graph import Automaton, Transition
from standoff.automaton.text import MOST_DRAWN, Names, moves, product_switches
from standoff.automaton.visits import mode_of
from standoff.bodies.body import Body
from standoff.bodies.features import Feature
from standoff.errors import not_installed

try:
    from matplotlib.axes import Axes
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.patches import FancyArrowPatch, Patch
except ModuleNotFoundError as error:
    raise ModuleNotFoundError(not_installed("matplotlib"), name="matplotlib") from error

Place = tuple[float, float]

# Okabe and Ito's blue, which eyes without red or green tell from black, on grey for the rest.
VISITED_COLOUR = "#0072B2"
VISITED_FILL = "#D6E9F5"
QUIET_COLOUR = "#9A9A9A"

LEVELS = {"face": 2.0, "edge": 1.0, "vertex": 0.0}
"""Heights of the rows: a step reaches downwards, a release goes upwards."""

SHAPES = {"face": "square,pad=0.35", "edge": "round,pad=0.35", "vertex": "circle,pad=0.25"}

NODE_WIDTH = 0.62
"""Inches that a feature takes in its row: room for its name and its time."""

LEAST_WIDTH, MOST_WIDTH = 4.2, 40.0
"""Inches of one body's panel; a polytope of hundreds of features is scaled in the reader."""

MOST_NAMED = 8
"""Most features in a row that are named in full; more get a letter and their number."""

ROW_HEIGHT = 0.3
"""Inches of a mode's row in the picture of the visits."""

SWEEPS = 8
"""Times that the rows are sorted by their neighbours' middles, which unravels most crossings."""


def write_automaton(
    file: BinaryIO, ending: str, automaton: Automaton, names: Names = ("A", "B"), title: str = ""
) -> None:
    """Draw an automaton to a stream.

    Parameters
    ----------
    file : binary stream
    ending : str
        The format: ``svg``, ``png`` or ``pdf``.
    automaton : Automaton
    names : (str, str)
        What A and B are called.
    title : str

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    sides = (("A", automaton.a, names[0]), ("B", automaton.b, names[1]))
    rows = {letter: _rows(automaton, letter) for letter, _, _ in sides}
    widths = [
        min(max(LEAST_WIDTH, NODE_WIDTH * max(map(len, rows[letter].values()))), MOST_WIDTH)
        for letter, _, _ in sides
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
    for letter, body, name in sides:
        _draw_body(axes[letter], automaton, letter, body, name, rows[letter])
    if automaton.visits:
        _draw_visits(axes["pair"], automaton)
    elif below:
        _draw_product(axes["pair"], automaton)
    figure.suptitle(title or f"Modes of {names[0]} and {names[1]}")
    figure.supxlabel(
        "downwards: a step reaches the end of a feature; upwards: at rest, the slope of the "
        "distance falls below −ε; arcs: a smooth edge is passed",
        fontsize="small",
    )
    # The arrows end at the features' boxes, whose sizes are known once they were laid out.
    figure.draw_without_rendering()
    figure.savefig(file, format=ending)


def _height_below(automaton: Automaton) -> float:
    """Inches of the lower panel; 0 where the product is too large, or one body's own automaton."""
    if automaton.visits:
        return 1.0 + ROW_HEIGHT * len(automaton.visited)
    several = min(len(automaton.features_a), len(automaton.features_b)) > 1
    if several and automaton.modes <= MOST_DRAWN:
        return 0.8 + 0.45 * len(automaton.features_b)
    return 0.0


def _rows(automaton: Automaton, letter: str) -> dict[str, list[Feature]]:
    """Faces, edges and vertices, each row in an order with few crossings."""
    features = automaton.features_a if letter == "A" else automaton.features_b
    rows = {kind: [f for f in features if f.kind == kind] for kind in LEVELS}
    neighbours: dict[Feature, list[Feature]] = {feature: [] for feature in features}
    for t in automaton.of(letter):
        neighbours[t.source].append(t.target)
        neighbours[t.target].append(t.source)
    for sweep in range(SWEEPS):
        for kind in ("edge", "vertex") if sweep % 2 == 0 else ("edge", "face"):
            other = {"edge": ("face", "vertex")[sweep % 2], "vertex": "edge", "face": "edge"}[kind]
            rank = {f: k / max(1, len(rows[other])) for k, f in enumerate(rows[other])}
            own = {f: k / max(1, len(rows[kind])) for k, f in enumerate(rows[kind])}
            rows[kind].sort(
                key=lambda f: _middle([rank[g] for g in neighbours[f] if g in rank], own[f])
            )
    return {kind: row for kind, row in rows.items() if row}


def _middle(ranks: Sequence[float], usual: float) -> float:
    return sum(ranks) / len(ranks) if ranks else usual


def _draw_body(
    axes: Axes,
    automaton: Automaton,
    letter: str,
    body: Body,
    name: str,
    rows: Mapping[str, Sequence[Feature]],
) -> None:
    places = {
        feature: ((k + 0.5) / len(row), LEVELS[feature.kind])
        for row in rows.values()
        for k, feature in enumerate(row)
    }
    times = _times_on(automaton, letter)
    taken = {t for _, t in automaton.taken if t.body == letter}
    boxes = {
        feature: _node(axes, feature, place, len(rows[feature.kind]), times.get(feature))
        for feature, place in places.items()
    }
    for pair, kinds in _both_ways(automaton.of(letter)).items():
        _arrow(axes, places, boxes, pair, kinds, taken)
    arcs = any(t.kind == "smooth" for t in automaton.of(letter))
    axes.set_ylim(-0.5, 3.3 if arcs else 2.5)
    axes.set_title(f"{letter} = {name} ({body.name})", fontsize="medium")
    axes.set_xlim(0.0, 1.0)
    axes.set_axis_off()


def _node(axes: Axes, feature: Feature, place: Place, crowd: int, time: float | None) -> Patch:
    """Name a feature at its place, with the time spent on it [s]; returns the box around it."""
    label = str(feature) if crowd <= MOST_NAMED else f"{feature.kind[0]}{feature.index}"
    node = axes.annotate(
        label if time is None else f"{label}\n{time:.3g} s",
        place,
        ha="center",
        va="center",
        fontsize="small",
        zorder=3,
        bbox={
            "boxstyle": SHAPES[feature.kind],
            "facecolor": "white" if time is None else VISITED_FILL,
            "edgecolor": QUIET_COLOUR if time is None else VISITED_COLOUR,
            "linewidth": 0.8 if time is None else 1.6,
        },
    )
    box = node.get_bbox_patch()
    assert box is not None  # asked for above
    return box


def _times_on(automaton: Automaton, letter: str) -> dict[Feature, float]:
    """Time spent on each visited feature of one body [s]."""
    times: dict[Feature, float] = {}
    for visit in automaton.visits:
        feature = mode_of(visit)["AB".index(letter)]
        times[feature] = times.get(feature, 0.0) + visit.end - visit.start
    return times


def _both_ways(
    transitions: Sequence[Transition],
) -> dict[tuple[Feature, Feature], list[Transition]]:
    """Transitions by what they join, whichever way they go."""
    found: dict[tuple[Feature, Feature], list[Transition]] = {}
    for t in transitions:
        upper, lower = sorted((t.source, t.target), key=lambda f: (-LEVELS[f.kind], f.index))
        found.setdefault((upper, lower), []).append(t)
    return found


def _arrow(
    axes: Axes,
    places: Mapping[Feature, Place],
    boxes: Mapping[Feature, Patch],
    pair: tuple[Feature, Feature],
    transitions: Sequence[Transition],
    taken: set[Transition],
) -> None:
    """One line between two features, with a head at each end that can be reached."""
    upper, lower = pair
    # The bend of an arc falls with its reach, so that long ones stay within the panel.
    reach = abs(places[upper][0] - places[lower][0])
    bend = -0.45 / (1.0 + 1.3 * reach) if upper.kind == lower.kind else 0.0
    heads = {t.target for t in transitions}
    style = f"{'<|' if upper in heads else ''}-{'|>' if lower in heads else ''}"
    visited = any(t in taken for t in transitions)
    axes.add_patch(
        FancyArrowPatch(
            places[upper],
            places[lower],
            arrowstyle=style,
            connectionstyle=f"arc3,rad={bend:.4f}",
            patchA=boxes[upper],
            patchB=boxes[lower],
            shrinkA=1.0,
            shrinkB=1.0,
            mutation_scale=8.0,
            color=VISITED_COLOUR if visited else QUIET_COLOUR,
            linewidth=1.8 if visited else 0.7,
            zorder=2 if visited else 1,
        )
    )


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
    axes.set_title(
        f"visited: {len(row)} of {automaton.modes} modes (A – B), "
        f"{len(automaton.taken)} switches"
        + (f", {len(automaton.restarts)} restarts (dotted)" if automaton.restarts else ""),
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
