"""Branches over time in a picture: a lane for each local minimum, and what passes between them."""

from __future__ import annotations

from collections.abc import Mapping

from standoff.automaton.body_panel import QUIET_COLOUR, VISITED_COLOUR, VISITED_FILL
from standoff.automaton.branch_text import visit_at
from standoff.automaton.branches import BranchAutomaton, BranchEvent, ParallelBranches
from standoff.automaton.text import moves
from standoff.automaton.visits import Mode, mode_of
from standoff.errors import of_extra
from standoff.tracking.branches import NONE

with of_extra("matplotlib"):
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

NEAREST_FILL = "#5AA9D6"
"""Between the fill of a visit and the colour of its border."""

HANDOVER_COLOUR = "#D55E00"
"""Okabe and Ito's vermilion, which eyes without red or green tell from blue."""

HEAD = 1.0
"""Rows above the modes of a branch, for its name."""

Rows = Mapping[tuple[int, Mode], float]


def rows_of(automaton: ParallelBranches) -> tuple[dict[tuple[int, Mode], float], float]:
    """The row of each mode of each branch, downwards, and how many rows there are in all."""
    rows, at = {}, 0.0
    for branch in automaton.branches:
        at += HEAD
        for mode in branch.visited:
            rows[branch.key, mode] = at
            at += 1.0
    return rows, at


def draw_lanes(axes: Axes, automaton: ParallelBranches) -> None:
    """Draw a row for each mode of each branch, bars where it is visited, darker while the branch
    is the nearest, and births, ends and handovers between them."""
    rows, total = rows_of(automaton)
    start = min(event.time for event in automaton.events)
    end = max(visit.end for visit in automaton.visits)
    axes.set_xlim(start, end)
    for branch in automaton.branches:
        _draw_branch(axes, branch, rows, start)
    for event in automaton.events:
        _draw_event(axes, automaton, event, rows)
    axes.set_yticks(list(rows.values()), [f"{a} – {b}" for _, (a, b) in rows], fontsize="small")
    for (key, mode), row in rows.items():
        axes.annotate(
            f" {automaton.branch(key).time_in(mode):.3g} s",
            (1.0, row),
            xycoords=("axes fraction", "data"),
            va="center",
            fontsize="small",
        )
    axes.set_ylim(total - 0.4, -0.3)
    axes.set_xlabel("time (s)")
    axes.grid(axis="x", alpha=0.3)
    axes.legend(handles=_legend(), loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=5,
                fontsize="small", frameon=False)  # fmt: skip


def _draw_branch(axes: Axes, branch: BranchAutomaton, rows: Rows, start: float) -> None:
    for visit in branch.visits:
        row = rows[branch.key, mode_of(visit)]
        span = (visit.start, visit.end - visit.start)
        axes.broken_barh([span], (row - 0.3, 0.6), facecolor=VISITED_FILL)
        for first, last in branch.nearest:
            both = max(first, visit.start), min(last, visit.end)
            if both[1] > both[0]:
                axes.broken_barh(
                    [(both[0], both[1] - both[0])], (row - 0.3, 0.6), facecolor=NEAREST_FILL
                )
        axes.broken_barh(
            [span], (row - 0.3, 0.6), facecolor="none", edgecolor=VISITED_COLOUR, linewidth=0.8
        )
    for source, target, times in moves(branch.visits):
        for time in times:
            ends = [rows[branch.key, source], rows[branch.key, target]]
            axes.plot([time, time], ends, color=VISITED_COLOUR, linewidth=1.0)
    top = min((rows[branch.key, mode] for mode in branch.visited), default=None)
    if top is not None:
        axes.axhline(top - HEAD - 0.3, color=QUIET_COLOUR, linewidth=0.5)
        axes.annotate(
            f"branch {branch.key}",
            (start, top - 0.72),
            (4, 0),
            textcoords="offset points",
            va="center",
            fontsize="small",
            fontweight="bold",
        )


def _draw_event(axes: Axes, automaton: ParallelBranches, event: BranchEvent, rows: Rows) -> None:
    here = _row_at(automaton, event.key, event.time, rows, before=event.kind == "end")
    if here is None:
        return
    there = None
    if event.other != NONE:
        before = event.kind == "handover"
        there = _row_at(automaton, event.other, event.time, rows, before=before)
    if event.kind == "handover":
        if there is not None:
            _arrow(axes, event.time, (there, here), HANDOVER_COLOUR, "--")
        return
    if there is not None:
        _arrow(axes, event.time, (here, there), "black", "-")
    born = event.kind == "birth"
    axes.plot(
        event.time, here, "o" if born else "X", mfc="white" if born else "black", mec="black",
        ms=6, zorder=4, clip_on=False,
    )  # fmt: skip
    assert event.reason is not None  # of births and ends
    told = event.reason.name + (f" into {event.other}" if event.other != NONE else "")
    # Beside what lives shortly there is room on either side.
    left = born and event.time > axes.get_xlim()[0]
    axes.annotate(
        told, (event.time, here), (-6 if left else 6, 0), textcoords="offset points",
        ha="right" if left else "left", va="center", fontsize="x-small", zorder=4,
    )  # fmt: skip


def _arrow(axes: Axes, time: float, rows: tuple[float, float], colour: str, line: str) -> None:
    """An arrow from one row to another at a time [s]."""
    axes.annotate(
        "", (time, rows[1]), (time, rows[0]), zorder=3,
        arrowprops={"arrowstyle": "-|>", "color": colour, "linestyle": line, "linewidth": 1.4,
                    "shrinkA": 0, "shrinkB": 0},
    )  # fmt: skip


def _row_at(
    automaton: ParallelBranches, key: int, time: float, rows: Rows, *, before: bool
) -> float | None:
    """The row of the mode in which a branch is up to a time [s], or from it on."""
    visit = visit_at(automaton.branch(key).visits, time, before=before)
    return None if visit is None else rows[key, mode_of(visit)]


def _legend() -> list[Patch | Line2D]:
    return [
        Patch(facecolor=NEAREST_FILL, edgecolor=VISITED_COLOUR, label="a mode, the nearest"),
        Patch(facecolor=VISITED_FILL, edgecolor=VISITED_COLOUR, label="not the nearest"),
        Line2D([], [], color=HANDOVER_COLOUR, linestyle="--", label="handover of the nearest"),
        Line2D([], [], marker="o", mfc="white", mec="black", linestyle="none", label="begins"),
        Line2D([], [], marker="X", mfc="black", mec="black", linestyle="none", label="ends"),
    ]
