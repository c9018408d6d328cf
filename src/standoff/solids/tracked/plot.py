"""Frames of two solids as a picture: how far each local minimum is apart, while it lives."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from standoff.errors import of_extra
from standoff.recording.local_minima import LocalMinima

with of_extra("matplotlib"):
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Okabe and Ito's colours, told apart by eyes without red or green.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
NEAREST = "#d9d9d9"
MOST_NAMED = 12
"""Keys that are written beside their lines; of more only the lines are drawn."""


def minima_figure(told: LocalMinima, distance: NDArray[np.float64]) -> Figure:
    """Draw how far each local minimum is apart over the frames, a ring where it begins and a cross
    where it ends; and below them the `distance` of each frame, of the nearest one."""
    figure = Figure(figsize=(8.0, 3.6), layout="constrained")
    axes = figure.subplots()
    n = len(distance)
    axes.plot(
        np.arange(n), np.where(distance > 0.0, distance, np.nan),
        color=NEAREST, lw=7.0, solid_capstyle="round", label="the nearest", zorder=1,
    )  # fmt: skip
    keys = [int(key) for key in np.unique(told.key) if key >= 0]
    for place, key in enumerate(keys):
        colour = COLOURS[place % len(COLOURS)]
        for rows in _lives(told, key):
            axes.plot(told.frame[rows], told.distance[rows], color=colour, lw=1.6, zorder=2)
        rows = np.flatnonzero(told.key == key)
        _mark_ends(axes, told, rows, (colour, n))
        if len(keys) <= MOST_NAMED:
            middle = rows[len(rows) // 2]
            axes.annotate(
                str(key), (told.frame[middle], told.distance[middle]), (0, 6),
                textcoords="offset points", color=colour, fontsize=9, ha="center",
            )  # fmt: skip
    axes.plot([], [], "o", mfc="white", mec="black", label="begins")
    axes.plot([], [], "x", color="black", label="ends")
    axes.set_xlabel("frame")
    axes.set_ylabel("distance of each local minimum")
    axes.set_xlim(0, max(n - 1, 1))
    axes.margins(y=0.12)
    axes.grid(color="#eeeeee")
    axes.legend(fontsize=8, frameon=False, loc="best")
    return figure


def _lives(told: LocalMinima, key: int) -> Iterator[NDArray[np.intp]]:
    """The rows of a minimum, in pieces of frames that follow each other."""
    rows = np.flatnonzero(told.key == key)
    cuts = np.flatnonzero(np.diff(told.frame[rows]) > 1) + 1
    for first, last in pairwise([0, *cuts.tolist(), len(rows)]):
        yield rows[first:last]


def _mark_ends(
    axes: Axes, told: LocalMinima, rows: NDArray[np.intp], drawn: tuple[str, int]
) -> None:
    """Where a minimum begins and ends within the frames."""
    colour, n = drawn
    first, last = rows[0], rows[-1]
    if told.frame[first] > 0:
        axes.plot(told.frame[first], told.distance[first], "o", mfc="white", mec=colour, zorder=3)
    if told.frame[last] < n - 1:
        axes.plot(told.frame[last], told.distance[last], "x", color=colour, mew=1.8, zorder=3)
