"""The least distance of a world over time, with the nearest pair named, above the matrix of all."""

from __future__ import annotations

from itertools import groupby

import numpy as np

from standoff.clearance.matrix import ABOVE, BELOW, BESIDE, draw_matrix, side_of
from standoff.clearance.over_time import Walked
from standoff.clearance.report import Report
from standoff.errors import of_extra
from standoff.wording import short_name

with of_extra("matplotlib", "plot"):
    from matplotlib.axes import Axes
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

HEIGHT, TOP, GAP = 2.6, 0.5, 0.75
"""Inches: of the curve's panel, above it, and below it for its axis."""

LEAST_WIDTH = 9.5
"""Inches of the figure: the legend of pairs stands to the right of the curve."""

LEGEND = 3.1
"""Inches of this legend."""

COLOURS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#F0E442")
"""Of the pairs that are nearest longest, which the legend names: Okabe and Ito's, told apart by any
eye. The others are grey."""

OTHERS = "0.75"


def course_figure(walked: Walked, report: Report, title: str, unit: str) -> Figure:
    """Draw a walk.

    Parameters
    ----------
    walked : Walked
    report : Report
        Over all its frames.
    title : str
        Of the scene.
    unit : str
        Label of lengths.
    """
    side = side_of(report)
    width = max(LEAST_WIDTH, side + BESIDE)
    height = BELOW + side + ABOVE + GAP + HEIGHT + TOP
    # Not through pyplot, which would ask for a display and keep the figure alive.
    figure = Figure(figsize=(width, height), dpi=130)
    FigureCanvasAgg(figure)
    bottom = (height - TOP - HEIGHT) / height
    axes = figure.add_axes((0.9 / width, bottom, (width - 0.9 - LEGEND) / width, HEIGHT / height))
    axes.set_title(f"{title}: the nearest pair of each frame", loc="left")
    _draw_course(axes, walked, unit)
    draw_matrix(figure, report, "The least of each pair over these frames", unit)
    return figure


def _draw_course(axes: Axes, walked: Walked, unit: str) -> None:
    times = walked.times
    stays = [
        (names, [k for k, _ in part])
        for names, part in groupby(enumerate(walked.closest), key=lambda each: each[1])
    ]
    long = {names: 0 for names, _ in stays if names is not None}
    for names, frames in stays:
        if names is not None:
            long[names] += len(frames)
    named = sorted(long, key=lambda names: -long[names])[: len(COLOURS)]
    colours = dict(zip(named, COLOURS, strict=False))
    told: set[object] = set()
    for names, frames in stays:
        if names is None:
            continue
        # A stay reaches to the next frame, so that the curve has no gaps.
        shown = [*frames, *([frames[-1] + 1] if frames[-1] + 1 < len(times) else [])]
        label = " - ".join(short_name(name) for name in names) if names in colours else "others"
        axes.plot(
            times[shown],
            np.where(np.isfinite(walked.distance), walked.distance, np.nan)[shown],
            color=colours.get(names, OTHERS),
            linewidth=2.6,
            label="_" if label in told else label,
        )
        told.add(label)
    finite = np.where(np.isfinite(walked.clearance), walked.clearance, np.nan)
    axes.plot(
        times, finite, color="black", linewidth=0.9, dashes=(4, 4), label="proven for all pairs"
    )
    axes.axhline(0.0, color="0.4", linewidth=0.8)
    axes.set_xlim(times[0], times[-1])
    axes.set_xlabel("time (s)")
    axes.set_ylabel(f"distance ({unit})" if unit else "distance")
    axes.grid(alpha=0.3)
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False, fontsize="small")
