"""A proof along a path as a picture: the proven clearance over time, its steps below."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from standoff.robots.proof import How, PathProof, Steps, Verdict

ROWS = 24
"""Pairs whose steps are drawn, if not given."""

SAMPLES = 1000
"""Times at which the proven clearance is drawn, besides the ends of the steps."""

COLOURS = {How.FAR: "#b9cfe4", How.REACH: "#e0a458", How.CHORD: "#3b6ea5"}
UNDECIDED = "#cc79a7"
TOLD = {
    How.FAR: "by bounding boxes",
    How.REACH: "from the middle",
    How.CHORD: "from both ends",
}


WIDE = 6.0
"""Width from which the legend stands in one line, inches; a narrower picture is lower, too."""


def proof_figure(
    proof: PathProof, title: str = "", *, width: float = 9.0, most: int = ROWS
) -> Figure:
    """Draw a proof: above what is proven for all pairs, below the steps of the nearest pairs.

    Parameters
    ----------
    proof : PathProof
    title : str
    width : float
        Inches.
    most : int
        Pairs whose steps are drawn: those of the least proven bounds.
    """
    steps = proof.steps
    least = np.full(len(steps.names), np.inf)
    np.minimum.at(least, steps.pair, steps.bound)
    seen = np.flatnonzero(np.isfinite(least))
    if proof.witness is not None and proof.witness.names in steps.names:
        seen = np.union1d(seen, [steps.names.index(proof.witness.names)])
        least[steps.names.index(proof.witness.names)] = -np.inf
    rows = seen[np.argsort(least[seen], kind="stable")][:most]
    high, bars_high = (3.0 if width >= WIDE else 1.8), 0.4 + 0.2 * max(1, len(rows))
    figure = Figure(figsize=(width, high + bars_high), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[high, bars_high])
    _draw_clearance(above, proof)
    above.set_title(f"{title}: {proof.verdict.name}" if title else proof.verdict.name, fontsize=10)
    for row, pair in enumerate(rows.tolist()):
        _draw_bars(below, steps, row, pair)
    if proof.verdict is not Verdict.PROVEN:
        at = proof.time if np.isnan(proof.latest) else proof.latest
        for axes in (above, below):
            axes.axvline(at, color="#b3261e", lw=1.0)
            for span in proof.undecided:
                axes.axvspan(span.start, span.end, color=UNDECIDED, lw=1.0, alpha=0.4)
    below.set_yticks(
        range(len(rows)), [" - ".join(steps.names[pair]) for pair in rows.tolist()], fontsize=7
    )
    below.set_ylim(max(1, len(rows)) - 0.4, -0.6)
    below.set_xlim(proof.start, proof.end)
    below.set_xlabel("time (s)")
    handles = [
        PolyCollection([], facecolor=colour, label=f"proven {TOLD[how]}")
        for how, colour in COLOURS.items()
    ]
    if proof.undecided:
        handles.append(PolyCollection([], facecolor=UNDECIDED, alpha=0.4, label="undecided"))
    ncols = len(handles) if width >= WIDE else 1
    figure.legend(
        handles=handles, loc="outside lower center", ncols=ncols, fontsize=8, frameon=False
    )
    return figure


def _draw_clearance(above: Axes, proof: PathProof) -> None:
    """What is proven for all pairs, over time, and what was asked for."""
    steps = proof.steps
    ends = np.concatenate([steps.start, steps.end, np.linspace(proof.start, proof.end, SAMPLES)])
    times = np.unique(np.clip(ends, proof.start, proof.end))
    above.step(times, steps.clearance(times), where="mid", color="#3b6ea5", lw=1.2)
    above.axhline(proof.clearance, color="#b3261e", lw=1.0, ls="--")
    above.annotate(
        f"asked for: {proof.clearance:g}",
        (0.995, proof.clearance),
        xycoords=("axes fraction", "data"),
        xytext=(0, 3),
        textcoords="offset points",
        ha="right",
        color="#b3261e",
        fontsize=8,
    )
    above.set_ylabel("proven for all pairs")
    known = steps.clearance(times)
    top = max(proof.clearance, float(np.nanmax(known, initial=0.0)))
    above.set_ylim(0.0, 1.25 * top or 1.0)


def _draw_bars(axes: Axes, steps: Steps, row: int, pair: int) -> None:
    """The steps of a pair in a row of the picture."""
    for how, colour in COLOURS.items():
        mine = np.flatnonzero((steps.pair == pair) & (steps.how == how.value))
        bars = [
            [(a, row - 0.38), (b, row - 0.38), (b, row + 0.38), (a, row + 0.38)]
            for a, b in zip(steps.start[mine].tolist(), steps.end[mine].tolist(), strict=True)
        ]
        axes.add_collection(
            PolyCollection(bars, facecolor=colour, edgecolor="white", linewidth=0.4)
        )
