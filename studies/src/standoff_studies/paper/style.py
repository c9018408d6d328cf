"""The style of the paper's figures: one size, and lines that differ in grey and for any eye."""

from __future__ import annotations

from contextlib import AbstractContextManager
from typing import Any

from matplotlib import rc_context
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

# Okabe and Ito's colours. In grey they differ little, so lines also differ by dashes or marker:
# colour n goes with DASHES[n] and MARKERS[n].
BLUE, ORANGE, GREEN, PURPLE, RED, SKY, BLACK = (
    "#0072B2",
    "#E69F00",
    "#009E73",
    "#CC79A7",
    "#D55E00",
    "#56B4E9",
    "#000000",
)
COLOURS = (BLUE, RED, GREEN, PURPLE, ORANGE, SKY, BLACK)
DASHES = ("-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)), (0, (8, 2)), (0, (1, 1)))
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
QUIET = "#8A8A8A"
"""Grey for the background: meshes, Voronoi lines."""

WIDTH = 7.0
"""Width of a figure in inches, that of a page; on a phone, FONT points are still readable."""
FONT = 10.0
"""Size of labels and legends in points."""
DPI = 160

SETTINGS: dict[Any, Any] = {
    "font.size": FONT,
    "axes.titlesize": FONT,
    "axes.labelsize": FONT,
    "legend.fontsize": FONT - 1.0,
    "xtick.labelsize": FONT - 1.0,
    "ytick.labelsize": FONT - 1.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#E3E3E3",
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.6,
    "svg.hashsalt": "standoff",
    "figure.dpi": DPI,
}


def line(k: int, **look: Any) -> dict[str, Any]:
    """Return colour and dashes of line k of several, with any other options given."""
    return {"color": COLOURS[k], "linestyle": DASHES[k], **look}


def marked(k: int, size: float, **look: Any) -> dict[str, Any]:
    """Return the same with the line's marker and its size in points."""
    return line(k, marker=MARKERS[k], markersize=size, **look)


def new_figure(width: float = WIDTH, height: float = 4.2) -> Figure:
    """Return an empty figure [inches] with its canvas, with a layout in which nothing overlaps.

    Axes use the settings at the time they are made: draw within ``with settings():``.
    """
    figure = Figure(figsize=(width, height), dpi=DPI, layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def settings() -> AbstractContextManager[None]:
    """Return the context in which every figure is drawn and written."""
    return rc_context(SETTINGS)
