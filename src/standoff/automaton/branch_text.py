"""The automata of local minima as text: a listing for a terminal, and a Mermaid flowchart."""

from __future__ import annotations

from collections.abc import Sequence

from standoff.automaton.branches import BranchAutomaton, BranchEvent, ParallelBranches
from standoff.automaton.text import (
    LEGEND,
    MOST_LABELLED,
    Names,
    arrows,
    body_lines,
    by_transition,
    columns,
    counts_of,
    mode_node,
    moves,
    times_told,
)
from standoff.automaton.visits import Mode, Visit, mode_of
from standoff.tracking.branches import Birth, End
from standoff.wording import counted, printable

MOST_LISTED = 100
"""Most switches of one solid that are listed; of more only their number is told."""


def branches_text(automaton: ParallelBranches, names: Names = ("A", "B")) -> str:
    """Return what both solids allow, each branch with its visited modes and switches, and what
    happens between branches, line by line."""
    branches, switches = len(automaton.branches), len(automaton.taken)
    head = [
        f"{counted(branches, 'branch', 'branches')}, one per local minimum, in parallel: "
        f"{counted(len(automaton.visited), 'mode')} visited, "
        f"{counted(switches, 'switch', 'switches')}, "
        f"{counted(len(automaton.events), 'event')} between branches"
    ]
    if not branches:
        na, nb = len(automaton.features_a), len(automaton.features_b)
        head = [
            f"modes of each local minimum: {counted(na, 'feature')} of A × {nb} of B = "
            f"{automaton.modes}"
        ]
    parts = [[*head, LEGEND], *_solids(automaton, names)]
    parts += [_branch_lines(automaton, branch) for branch in automaton.branches]
    if automaton.events:
        rows = [(f"  {event.time:.6g} s", *event_told(event)) for event in automaton.events]
        parts.append(["between branches", *columns(rows)])
    return "\n\n".join("\n".join(lines) for lines in parts)


def _solids(automaton: ParallelBranches, names: Names) -> list[list[str]]:
    if automaton.a is None or automaton.b is None:
        what = f"{printable(names[0])} and {printable(names[1])}"
        return [[f"{what} are not in the recording: only what was visited and taken is listed."]]
    sides = (("A", automaton.a, automaton.features_a), ("B", automaton.b, automaton.features_b))
    found = []
    for (letter, body, features), name in zip(sides, names, strict=True):
        transitions = automaton.of(letter)
        if len(transitions) <= MOST_LISTED:
            found.append(body_lines(body, letter, name, features, transitions))
            continue
        told = counts_of(body, letter, name, features)
        found.append(
            [f"{told}, {counted(len(transitions), 'switch', 'switches')}, too many to list"]
        )
    return found


def _branch_lines(automaton: ParallelBranches, branch: BranchAutomaton) -> list[str]:
    spans = ", ".join(f"{start:.6g} s to {end:.6g} s" for start, end in branch.nearest)
    head = f"branch {branch.key}: " + (
        f"the nearest from {spans}" if spans else "never the nearest"
    )
    rows = [("  mode (A – B)", "visits", "time", "entered at")]
    for mode in branch.visited:
        stays = branch.stays(mode)
        starts = times_told(visit.start for visit in stays)
        told = f"  {mode[0]} – {mode[1]}"
        rows.append((told, str(len(stays)), f"{branch.time_in(mode):.6g} s", starts))
    switched = [("  switch", "kind", "times", "taken at")]
    for transition, times in by_transition(branch):
        told = f"  {transition.body}: {transition.source} → {transition.target}"
        kind = transition.kind or ("several" if automaton.listed else "not known")
        switched.append((told, kind, str(len(times)), times_told(times)))
    return [head, *columns(rows), *(columns(switched) if branch.taken else [])]


def event_told(event: BranchEvent) -> tuple[str, str]:
    """What happens between branches, and where it is, in a few words."""
    where = f"{event.mode[0]} – {event.mode[1]}, at {event.distance:.6g}"
    if isinstance(event.reason, Birth):
        return f"{event.key} begins, {event.reason.name}", where
    if isinstance(event.reason, End):
        into = f" into {event.other}" if event.reason is End.MERGED else ""
        return f"{event.key} ends, {event.reason.name}{into}", where
    return f"{event.other} hands the nearest over to {event.key}", where


def branches_mermaid(automaton: ParallelBranches, names: Names = ("A", "B")) -> str:
    """Return a Mermaid flowchart: a box of visited modes for each branch, their beginnings and
    ends, and dotted arrows where the nearest is handed over."""
    lines = ["flowchart LR"]
    if not automaton.branches:
        for letter, name in zip("AB", names, strict=True):
            lines += _solid(automaton, letter, name)
    for branch in automaton.branches:
        lines.append(f'  subgraph branch{branch.key}["branch {branch.key}"]')
        for mode in branch.visited:
            stays = branch.stays(mode)
            told = f"{mode[0]} – {mode[1]}<br/>{branch.time_in(mode):.4g} s<br/>first at "
            lines.append(f'    {_node(branch, mode)}["{told}{stays[0].start:.4g} s"]:::visited')
        for source, target, times in moves(branch.visits):
            many = f" and {len(times) - 1} more" if len(times) > 1 else ""
            arrow = f'-->|"{times[0]:.4g} s{many}"|'
            lines.append(f"    {_node(branch, source)} {arrow} {_node(branch, target)}")
        lines.append("  end")
    for k, event in enumerate(automaton.events):
        lines += _event_arrow(automaton, k, event)
    lines += [
        "  classDef visited fill:#cfe8ff,stroke:#0072B2,stroke-width:3px",
        "  classDef border fill:#ffffff,stroke:#444444",
    ]
    return "\n".join(lines)


def _solid(automaton: ParallelBranches, letter: str, name: str) -> list[str]:
    transitions = automaton.of(letter)
    if len(transitions) > MOST_LABELLED:
        return [f"  %% {letter} has {len(transitions)} switches: too many to draw"]
    features = automaton.features_a if letter == "A" else automaton.features_b
    plain = printable(name).replace('"', "'")
    nodes = [f'    {letter}_{f.kind}{f.index}["{f}"]' for f in features]
    return [
        f'  subgraph {letter}["{letter} = {plain}"]',
        *nodes,
        *arrows(letter, transitions),
        "  end",
    ]


def _event_arrow(automaton: ParallelBranches, k: int, event: BranchEvent) -> list[str]:
    branch = automaton.branch(event.key)
    here = _node_at(branch, event.time, before=event.kind == "end")
    if here is None:
        return []
    told = f"{event.time:.4g} s"
    if event.kind == "handover":
        there = _node_at(automaton.branch(event.other), event.time, before=True)
        return [] if there is None else [f'  {there} -.->|"nearest from {told}"| {here}']
    assert event.reason is not None  # of births and ends
    told += f" {event.reason.name}"
    if event.reason is End.MERGED:
        there = _node_at(automaton.branch(event.other), event.time, before=False)
        return [] if there is None else [f'  {here} ==>|"{told}"| {there}']
    border = [f"  border{k}((( ))):::border"] if event.kind == "end" else []
    if event.kind == "end":
        return [*border, f'  {here} -->|"{told}"| border{k}']
    return [f"  border{k}(( )):::border", f'  border{k} -->|"{told}"| {here}']


def _node_at(branch: BranchAutomaton, time: float, *, before: bool) -> str | None:
    """The node of the mode in which a branch is up to a time [s], or from it on."""
    found = visit_at(branch.visits, time, before=before)
    return None if found is None else _node(branch, mode_of(found))


def visit_at(visits: Sequence[Visit], time: float, *, before: bool) -> Visit | None:
    """The visit that lasts up to a time [s], or from it on; None if there is none."""
    for visit in visits:
        if visit.start < time <= visit.end if before else visit.start <= time < visit.end:
            return visit
    return None


def _node(branch: BranchAutomaton, mode: Mode) -> str:
    return mode_node(*mode, f"b{branch.key}")
