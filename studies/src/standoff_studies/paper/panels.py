"""Parts used by all figures of parameters against time: errors, names of stays, keys."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from standoff.automaton import Visit
from standoff_studies.paper import style
from standoff_studies.paper.pair_simulation import Simulation
from standoff_studies.paper.resets import draw_projection_errors


def draw_errors(axes: Axes, simulation: Simulation, *, least: float = 0.0, **look: Any) -> None:
    """Draw the errors of the witness points, the projection errors, and what resets imply.

    Parameters
    ----------
    axes : Axes
    simulation : Simulation
    least : float
        Errors below this are drawn at it [length].
    **look
        Options of ``Axes.semilogy``.
    """
    error = np.maximum(simulation.witness_error, least)
    axes.semilogy(simulation.paper.time, error, color=style.GREEN, **look)
    draw_projection_errors(axes, simulation.errors, simulation.resets)
    axes.legend(frameon=False, ncols=3, loc="upper right")


def tint(axes: Axes, stays: Iterable[tuple[Visit, str | None]]) -> None:
    """Tint the times of stays, each in its colour if it has one, instead of a grid."""
    axes.grid(visible=False)
    for stay, colour in stays:
        if colour:
            axes.axvspan(stay.start, stay.end, facecolor=colour, linewidth=0.0, zorder=0)


def name_above(axes: Axes, names: Iterable[tuple[Visit, str]]) -> None:
    """Write names over the middles of stays, just above the axes."""
    for stay, words in names:
        axes.annotate(
            words,
            (0.5 * (stay.start + stay.end), 1.0),
            xycoords=("data", "axes fraction"),
            xytext=(0.0, 4.0),
            textcoords="offset points",
            ha="center",
            va="bottom",
            fontsize=style.FONT,
        )


def unit_interval(axes: Axes, label: str) -> None:
    """Set axes for parameters in [0, 1]."""
    axes.set_ylim(-0.08, 1.08)
    axes.set_yticks([0.0, 0.5, 1.0])
    axes.set_ylabel(label)
