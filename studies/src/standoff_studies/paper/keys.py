"""Keys of figures: what lines and fills mean, made separately and written below the figure."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch


def key_line(
    label: str, colour: str, width: float | None = None, dashes: Any = "-", **look: Any
) -> Artist:
    """Return a line for a key, by default with the width of the settings."""
    return Line2D([], [], color=colour, linewidth=width, linestyle=dashes, label=label, **look)


def key_fill(label: str, colour: str, **look: Any) -> Artist:
    """Return a patch for a key."""
    return Patch(facecolor=colour, label=label, **look)


def key_below(figure: Figure, handles: Iterable[Artist], columns: int, **look: Any) -> None:
    """Write the key below a figure; `look` are further options of ``Figure.legend``."""
    where: dict[str, Any] = {"loc": "outside lower center", "ncols": columns, "frameon": False}
    figure.legend(handles=list(handles), **(where | look))
