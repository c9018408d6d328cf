"""An automaton as text: a listing for a terminal, and a Mermaid flowchart for a page."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

from standoff.automaton.graph import Automaton, is_smooth
from standoff.automaton.transitions import Transition
from standoff.automaton.visits import Course, Mode, mode_of
from standoff.bodies.boundary import Boundary
from standoff.bodies.features import Feature
from standoff.wording import counted, printable

if TYPE_CHECKING:
    from standoff.automaton.visits import Visit

MOST_DRAWN = 24
"""Most modes of a product that is drawn in full; beyond it only visited modes are."""

MOST_LABELLED = 40
"""Most arrows of one body that carry a label in Mermaid; more cannot be read."""

LEGEND = (
    "n: unit vector from A to B. A step that reaches the end of a feature continues on what it "
    "meets there; at rest, the steepest slope of the distance below −ε releases into a larger "
    "feature. The resets keep the witness point."
)

Names = tuple[str, str]


def automaton_text(automaton: Automaton, names: Names = ("A", "B")) -> str:
    """Return modes, switching functions and resets, and the visited modes, line by line."""
    na, nb = len(automaton.features_a), len(automaton.features_b)
    modes = [f"modes: {counted(na, 'feature')} of A × {nb} of B = {automaton.modes}", LEGEND]
    bodies = [
        body_lines(automaton.a, "A", names[0], automaton.features_a, automaton.of("A")),
        body_lines(automaton.b, "B", names[1], automaton.features_b, automaton.of("B")),
    ]
    visited = _visited_lines(automaton) if automaton.visits else []
    return "\n\n".join("\n".join(lines) for lines in (modes, *bodies, visited) if lines)


def body_lines(
    body: Boundary,
    letter: str,
    name: str,
    features: Sequence[Feature],
    transitions: Sequence[Transition],
) -> list[str]:
    """Return what one body has, and its switches."""
    told = f"{counts_of(body, letter, name, features)}, "
    if not transitions:
        return [f"{told}no switches"]
    rows = [(f"  {t.source} → {t.target}", t.switching, t.reset) for t in transitions]
    return [f"{told}{counted(len(transitions), 'switch', 'switches')}", *columns(rows)]


def counts_of(body: Boundary, letter: str, name: str, features: Sequence[Feature]) -> str:
    """Return how many faces, edges and vertices a body has."""
    kinds = Counter(feature.kind for feature in features)
    plural = {"face": "faces", "edge": "edges", "vertex": "vertices"}
    counts = [f"{n} {kind if n == 1 else plural[kind]}" for kind, n in kinds.items()]
    smooth = sum(is_smooth(body, feature) for feature in features)
    passed = f" ({smooth} smooth: passed from face to face)" if smooth else ""
    return f"{letter} = {printable(name)} ({printable(body.name)}): {', '.join(counts)}{passed}"


def _visited_lines(automaton: Automaton) -> list[str]:
    visits = automaton.visits
    restarts = f", {counted(len(automaton.restarts), 'restart')}" if automaton.restarts else ""
    first, last = visits[0].start, visits[-1].end
    head = (
        f"visited from {first:.6g} s to {last:.6g} s: {len(automaton.visited)} of "
        f"{counted(automaton.modes, 'mode')}, {counted(len(automaton.taken), 'switch', 'switches')}"
        f"{restarts}"
    )
    rows = [("  mode (A – B)", "visits", "time", "entered at")]
    for mode in automaton.visited:
        stays = automaton.stays(mode)
        rows.append(
            (
                f"  {mode[0]} – {mode[1]}",
                str(len(stays)),
                f"{automaton.time_in(mode):.6g} s",
                times_told(visit.start for visit in stays),
            )
        )
    switched = [("  switch", "times", "", "taken at")]
    for transition, times in by_transition(automaton):
        told = f"  {transition.body}: {transition.source} → {transition.target}"
        switched.append((told, str(len(times)), "", times_told(times)))
    return [head, *columns(rows), *(columns(switched) if automaton.taken else [])]


def by_transition(automaton: Course) -> list[tuple[Transition, list[float]]]:
    """Return the switches that were taken, each once, with all its times [s]."""
    times: dict[Transition, list[float]] = {}
    for time, transition in automaton.taken:
        times.setdefault(transition, []).append(time)
    return list(times.items())


def times_told(times: Iterable[float], most: int = 4) -> str:
    """Return the first few of some times [s]."""
    told = [f"{time:.6g}" for time in times]
    rest = f", … {len(told) - most} more" if len(told) > most else ""
    return ", ".join(told[:most]) + rest + " s"


def columns(rows: Sequence[tuple[str, ...]]) -> list[str]:
    """Return rows with their columns aligned."""
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    return [
        "  ".join(f"{cell:<{width}}" for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]


def automaton_mermaid(automaton: Automaton, names: Names = ("A", "B")) -> str:
    """Return a Mermaid flowchart: both bodies' automata, and as much of their product as can be
    read.

    That is the visited modes with their times, or the whole product if it is small.
    """
    lines = ["flowchart LR"]
    visited = {("A", mode[0]) for mode in automaton.visited}
    visited |= {("B", mode[1]) for mode in automaton.visited}
    sides = (
        ("A", automaton.a, names[0], automaton.features_a),
        ("B", automaton.b, names[1], automaton.features_b),
    )
    for letter, body, name, features in sides:
        lines.append(f'  subgraph {letter}["{letter} = {_plain(name)} ({_plain(body.name)})"]')
        for feature in features:
            mark = "visited" if (letter, feature) in visited else feature.kind
            lines.append(f"    {_node(letter, feature)}:::{mark}")
        lines += arrows(letter, automaton.of(letter))
        lines.append("  end")
    lines += _product(automaton)
    lines += [
        "  classDef face fill:#ffffff,stroke:#444444",
        "  classDef edge fill:#eeeeee,stroke:#444444",
        "  classDef vertex fill:#dddddd,stroke:#444444",
        "  classDef visited fill:#cfe8ff,stroke:#0072B2,stroke-width:3px",
    ]
    return "\n".join(lines)


def _plain(text: str) -> str:
    return printable(text).replace('"', "'")


def _identity(letter: str, feature: Feature) -> str:
    return f"{letter}_{feature.kind}{feature.index}"


def _node(letter: str, feature: Feature) -> str:
    opening, closing = {"face": ("[", "]"), "edge": ("(", ")"), "vertex": ("((", "))")}[
        feature.kind
    ]
    return f'{_identity(letter, feature)}{opening}"{feature}"{closing}'


def arrows(letter: str, transitions: Sequence[Transition]) -> list[str]:
    """Return one body's switches as Mermaid's arrows between its features."""
    labelled = len(transitions) <= MOST_LABELLED
    drawn = []
    for t in transitions:
        label = f'|"{_label(t)}"|' if labelled else ""
        arrow = "-.->" if t.kind == "release" else "==>" if t.kind == "smooth" else "-->"
        drawn.append(
            f"    {_identity(letter, t.source)} {arrow}{label} {_identity(letter, t.target)}"
        )
    return drawn


def _label(transition: Transition) -> str:
    """The switching function in a few characters."""
    if transition.kind == "release":
        return "slope < −ε"
    return "t at its end" if transition.source.kind == "edge" else "(u, v) at its boundary"


def _product(automaton: Automaton) -> list[str]:
    if automaton.visits:
        return _visited_product(automaton)
    if automaton.modes > MOST_DRAWN:
        return [f"  %% the product has {counted(automaton.modes, 'mode')}: too many to draw"]
    lines = ['  subgraph pair["the pair: A – B"]']
    lines += [
        f'    {mode_node(a, b)}["{a} – {b}"]'
        for a in automaton.features_a
        for b in automaton.features_b
    ]
    joined = dict.fromkeys(
        _undirected(source, target) for source, target in product_switches(automaton)
    )
    lines += [f"    {mode_node(*source)} <--> {mode_node(*target)}" for source, target in joined]
    return [*lines, "  end"]


def _undirected(source: Mode, target: Mode) -> tuple[Mode, Mode]:
    return (source, target) if source <= target else (target, source)


def product_switches(automaton: Automaton) -> list[tuple[Mode, Mode]]:
    """Return all switches of the product: one of a body's, with the other's feature kept."""
    a = [((t.source, b), (t.target, b)) for t in automaton.of("A") for b in automaton.features_b]
    b = [((a, t.source), (a, t.target)) for t in automaton.of("B") for a in automaton.features_a]
    return list(dict.fromkeys([*a, *b]))


def _visited_product(automaton: Automaton) -> list[str]:
    lines = ['  subgraph pair["the pair: visited modes A – B"]']
    for mode in automaton.visited:
        stays = automaton.stays(mode)
        told = (
            f"{mode[0]} – {mode[1]}<br/>{automaton.time_in(mode):.4g} s in {len(stays)} "
            f"{'visit' if len(stays) == 1 else 'visits'}<br/>first at {stays[0].start:.4g} s"
        )
        lines.append(f'    {mode_node(*mode)}["{told}"]:::visited')
    for source, target, times in moves(automaton.visits):
        many = f" and {len(times) - 1} more" if len(times) > 1 else ""
        lines.append(f'    {mode_node(*source)} -->|"{times[0]:.4g} s{many}"| {mode_node(*target)}')
    return [*lines, "  end"]


def moves(visits: Sequence[Visit]) -> list[tuple[Mode, Mode, list[float]]]:
    """Return which mode followed which, and when [s]; modes separated by an overlap did not
    follow."""
    found: dict[tuple[Mode, Mode], list[float]] = {}
    for before, after in pairwise(visits):
        if before.end == after.start:
            found.setdefault((mode_of(before), mode_of(after)), []).append(after.start)
    return [(source, target, times) for (source, target), times in found.items()]


def mode_node(a: Feature, b: Feature, group: str = "m") -> str:
    """Return the name of a mode's node."""
    return f"{group}_{a.kind}{a.index}_{b.kind}{b.index}"
