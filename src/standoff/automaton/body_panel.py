"""One body's features in a picture of an automaton: rows of faces, edges and vertices, and what
leads from one to another."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Protocol

from standoff.automaton.transitions import Transition
from standoff.automaton.visits import Visit, mode_of
from standoff.bodies.features import Feature
from standoff.errors import of_extra

with of_extra("matplotlib"):
    from matplotlib.axes import Axes
    from matplotlib.patches import FancyArrowPatch, Patch

Place = tuple[float, float]

# Okabe and Ito's blue, which eyes without red or green tell from black, on grey for the rest.
VISITED_COLOUR = "#0072B2"
VISITED_FILL = "#D6E9F5"
QUIET_COLOUR = "#9A9A9A"

LEVELS = {"face": 2.0, "edge": 1.0, "vertex": 0.0}
"""Heights of the rows: a step reaches downwards, a release goes upwards."""

SHAPES = {"face": "square,pad=0.35", "edge": "round,pad=0.35", "vertex": "circle,pad=0.25"}

MOST_NAMED = 8
"""Most features in a row that are named in full; more get a letter and their number."""

SWEEPS = 8
"""Times that the rows are sorted by their neighbours' middles, which unravels most crossings."""


class Drawn(Protocol):
    """What is drawn of an automaton, be it of convex bodies or of solids."""

    @property
    def features_a(self) -> tuple[Feature, ...]: ...
    @property
    def features_b(self) -> tuple[Feature, ...]: ...
    @property
    def visits(self) -> tuple[Visit, ...]: ...
    @property
    def taken(self) -> tuple[tuple[float, Transition], ...]: ...
    def of(self, body: str) -> tuple[Transition, ...]: ...


def rows_of(automaton: Drawn, letter: str, most: int | None = None) -> dict[str, list[Feature]]:
    """Faces, edges and vertices, each row in an order with few crossings; of more than `most`
    features only those that were visited."""
    features = automaton.features_a if letter == "A" else automaton.features_b
    if most is not None and len(features) > most:
        features = tuple(_times_on(automaton, letter))
    rows = {kind: [f for f in features if f.kind == kind] for kind in LEVELS}
    neighbours: dict[Feature, list[Feature]] = {feature: [] for feature in features}
    for t in _among(automaton, letter, neighbours):
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


def _among(automaton: Drawn, letter: str, shown: Collection[Feature]) -> list[Transition]:
    """The transitions of one body between features that are shown."""
    return [t for t in automaton.of(letter) if t.source in shown and t.target in shown]


def _middle(ranks: Sequence[float], usual: float) -> float:
    return sum(ranks) / len(ranks) if ranks else usual


def draw_body(
    axes: Axes,
    automaton: Drawn,
    letter: str,
    title: str,
    rows: Mapping[str, Sequence[Feature]],
) -> None:
    """Draw the rows of one body's features, and what leads from one to another."""
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
    transitions = _among(automaton, letter, places)
    for pair, kinds in _both_ways(transitions).items():
        _arrow(axes, places, boxes, pair, kinds, taken)
    arcs = any(t.source.kind == t.target.kind for t in transitions)
    heights = [LEVELS[kind] for kind in rows] or [0.0]
    axes.set_ylim(min(heights) - 0.5, max(heights) + (1.3 if arcs else 0.5))
    axes.set_title(title, fontsize="medium")
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


def _times_on(automaton: Drawn, letter: str) -> dict[Feature, float]:
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
