"""Which starts arrive on two tiled bodies: the picture, table and statements of the study."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from standoff_studies.paper import style
from standoff_studies.paper.convergence.cells import (
    ARRIVED,
    GAINS,
    LEAST_FRAMES,
    MOTIONS,
    PATIENCE,
    SOLVES,
    STARTS,
    SWITCHINGS,
    Cell,
    committed,
    study,
)
from standoff_studies.paper.figure import Artwork, Statement
from standoff_studies.paper.many_starts import INDEFINITE
from standoff_studies.paper.simulation_e.runs import STEP

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LOOKS = {
    (switching, solve): (style.COLOURS[k], style.DASHES[k], style.MARKERS[k])
    for k, (switching, solve) in enumerate((a, b) for a in SWITCHINGS for b in SOLVES)
}
"""Colour, dashes and marker of each switching and solve."""


def as_committed() -> Artwork:
    """The study as it was last run and written down."""
    return _artwork(committed())


def anew() -> Artwork:
    """The study run again: minutes."""
    return _artwork(study())


def _artwork(cells: tuple[Cell, ...]) -> Artwork:
    return Artwork(
        caption=(
            "Two lenses of three patches each (simulation E's), started anywhere on both: "
            f"{STARTS} random starts at each gain. Above: the part of them that has come to the "
            f"true distance within {ARRIVED:g} length after {PATIENCE:g}/K and {LEAST_FRAMES} "
            "frames, with 95 % intervals (Wilson's); left with both bodies at rest, right with B "
            "moving. Voronoi tests with M as it is are the system as printed. Below: time that the "
            "middle one and the hundredth slowest of those that arrive take, in units of 1/K."
        ),
        text=(
            "Four diagrams over the gain. With the rank rule nearly all starts arrive at every "
            "gain, with M as it is one in ten to one in five do. The times are a few 1/K at low "
            "gains, more at the highest."
        ),
        draw=lambda: _draw(cells),
        tables={"cells": _table(cells)},
        statements=_statements(cells),
        shown=("cells",),
    )


def named(switching: str, solve: str) -> str:
    """Return what a law of the study is called."""
    return f"{SWITCHINGS[switching]}, {SOLVES[solve]}"


def _table(cells: tuple[Cell, ...]) -> dict[str, Any]:
    intervals = [cell.interval for cell in cells]
    return {
        "law": [named(cell.switching, cell.solve) for cell in cells],
        "motion": [MOTIONS[cell.motion] for cell in cells],
        "K [1/s]": [f"{cell.gain:g}" for cell in cells],
        "arrived": [f"{cell.arrived} of {cell.tried}" for cell in cells],
        "95 % interval": [f"{low:.3f} to {high:.3f}" for low, high in intervals],
        "middle time · K": [f"{cell.median * cell.gain:.1f}" for cell in cells],
        "99 % time · K": [f"{cell.slowest * cell.gain:.1f}" for cell in cells],
    }


def _of(cells: tuple[Cell, ...], switching: str, solve: str) -> list[Cell]:
    return [cell for cell in cells if (cell.switching, cell.solve) == (switching, solve)]


def _range(cells: list[Cell]) -> str:
    parts = [cell.part for cell in cells]
    return f"{min(parts):.1%} to {max(parts):.1%}"


def _statements(cells: tuple[Cell, ...]) -> tuple[Statement, ...]:
    printed = _of(cells, "voronoi", "plain")
    others = {key: _of(cells, *key) for key in LOOKS if key != ("voronoi", "plain")}
    starts = f"{STARTS} random starts a cell, without restarts"
    return (
        Statement(
            "Section on the hybrid system",
            "from a start anywhere on tiled convex bodies the errors converge",
            f"{_range(printed)} of the starts arrive, by gain ({GAINS[0]:g} to {GAINS[-1]:g} 1/s) "
            "and motion",
            all(cell.arrived == cell.tried for cell in printed),
            INDEFINITE,
            f"PaperLaw.as_printed: Voronoi tests, M as it is; {starts}",
        ),
        *(
            Statement(
                "Section on the hybrid system",
                "-",
                f"{named(*key)}: {_range(found)} of the starts arrive",
                None,
                by=f"PaperLaw of that switching and solve; {starts}",
            )
            for key, found in others.items()
        ),
    )


def _draw(cells: tuple[Cell, ...]) -> Figure:
    with style.settings():
        figure = style.new_figure(style.WIDTH, 6.4)
        panels = figure.subplots(2, 2, sharex=True, sharey="row")
        for column, motion in enumerate(MOTIONS):
            for key in LOOKS:
                own = [cell for cell in _of(cells, *key) if cell.motion == motion]
                _draw_parts(panels[0, column], own, key)
                _draw_times(panels[1, column], own, key)
            panels[0, column].set_title(MOTIONS[motion])
            panels[1, column].set_xlabel("K [1/s]")
        panels[0, 0].set_ylabel("part that arrives [–]")
        panels[0, 0].set_ylim(-0.03, 1.05)
        panels[1, 0].set_ylabel("time to arrive · K [–]")
        panels[1, 0].set_ylim(0.0, PATIENCE + GAINS[-1] * LEAST_FRAMES * STEP + 1.0)
        panels[0, 0].set_xscale("log")
        panels[0, 0].set_xticks(GAINS, [f"{gain:g}" for gain in GAINS])
        panels[0, 0].minorticks_off()
        _legend(figure)
    return figure


def _draw_parts(axes: Axes, own: list[Cell], key: tuple[str, str]) -> None:
    colour, dashes, marker = LOOKS[key]
    parts = np.array([cell.part for cell in own])
    low, high = np.array([cell.interval for cell in own]).T
    axes.errorbar(
        [cell.gain for cell in own],
        parts,
        [parts - low, high - parts],
        color=colour,
        linestyle=dashes,
        marker=marker,
        markersize=5.0,
        capsize=3.0,
    )


def _draw_times(axes: Axes, own: list[Cell], key: tuple[str, str]) -> None:
    colour, dashes, marker = LOOKS[key]
    gains = np.array([cell.gain for cell in own])
    look: dict[str, Any] = {"color": colour, "linestyle": dashes, "marker": marker}
    axes.plot(gains, gains * [cell.median for cell in own], markersize=5.0, **look)
    slowest = gains * [cell.slowest for cell in own]
    axes.plot(gains, slowest, markersize=5.0, markerfacecolor="white", linewidth=0.8, **look)


def _legend(figure: Figure) -> None:
    from matplotlib.lines import Line2D

    handles = []
    for key, (colour, dashes, marker) in LOOKS.items():
        look: dict[str, Any] = {"color": colour, "linestyle": dashes, "marker": marker}
        handles.append(Line2D([], [], label=named(*key), **look))
    look = {"color": style.BLACK, "marker": "o", "linestyle": ""}
    handles.append(Line2D([], [], label="middle time", **look))
    handles.append(Line2D([], [], label="99 of 100", markerfacecolor="white", **look))
    figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False)
