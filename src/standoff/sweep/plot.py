"""The histogram of a sweep as a picture."""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff.errors import StandoffError, of_extra
from standoff.sweep.report import Report
from standoff.wording import counted, printable

with of_extra("matplotlib", "plot"):
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

NEAR, FAR, OUTSIDE = "#D55E00", "#56B4E9", "#BBBBBB"
"""Okabe and Ito's vermilion and blue, and grey for what the bins leave out."""

FEW = 100
"""Bins up to which there is a gap between bars."""

ROOM = 3.0
"""Times the greatest count that the axis reaches above it, for what is written there."""


def histogram_figure(report: Report) -> Figure:
    """Draw how many rows there are in each bin, on a logarithmic axis: the few worst count.

    Raises StandoffError if the job keeps no histogram.
    """
    job, found = report.job, report.found
    if job.keep.bins is None:
        raise StandoffError(
            "a picture needs a histogram; add to [keep] a line such as: "
            "histogram = { from = 0.0, to = 1.0, bins = 50 }",
            "histogram",
        )
    figure = Figure(figsize=(7.2, 4.2), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    edges, counts = job.keep.bins.edges, found.bins
    under, over, _ = found.outside.tolist()
    limit = -np.inf if job.keep.below is None else job.keep.below
    colours = [NEAR if end <= limit else FAR for end in edges[1:].tolist()]
    width = 0.8 if len(counts) <= FEW else 0.0
    look: dict[str, Any] = {"align": "edge", "edgecolor": "white", "linewidth": width}
    axes.bar(edges[:-1], counts, np.diff(edges), color=colours, **look)
    # What is outside of the bins stands beside them, as wide as one.
    wide = float(edges[1] - edges[0])
    outside = (
        (edges[0] - 2.0 * wide, under, f"below {edges[0]:g}", edges[0] <= limit),
        (edges[-1] + wide, over, f"{edges[-1]:g} and more", False),
    )
    for at, count, told, near in outside:
        if count:
            axes.bar(at, count, wide, color=NEAR if near else OUTSIDE, **look)
            where = (at + 0.5 * wide, count)
            axes.annotate(told, where, (0, 3), textcoords="offset points", ha="center", fontsize=8)
    unit = _plain(job.subject.length_unit)
    if job.keep.below is not None:
        axes.axvline(limit, color=NEAR, lw=1.2, ls="--")
        told = f"{counted(found.below.count, 'row')} not proven to be {limit:g} {unit}".rstrip()
        axes.set_title(f"{told} apart (dashed)", fontsize=9, color=NEAR, loc="right")
    axes.set_yscale("log")
    axes.set_ylim(0.7, ROOM * max(1, int(counts.max(initial=1)), under, over))
    axes.set_ylabel("rows")
    axes.set_xlabel(f"distance ({unit})" if unit else "distance")
    figure.suptitle(_plain(job.title), fontsize=11)
    axes.spines[["top", "right"]].set_visible(False)
    return figure


def _plain(text: str) -> str:
    """Another's text, in which matplotlib is to see no formulas."""
    return printable(text).replace("$", r"\$")
