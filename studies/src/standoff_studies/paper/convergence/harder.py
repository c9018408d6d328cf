"""Faster bodies, sharper ones and rings that bend inwards: which starts arrive, what is proven."""

from __future__ import annotations

import json
from collections.abc import Iterable
from importlib.resources import files
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from standoff.control.lyapunov import lyapunov_level
from standoff.motion import Pose
from standoff_studies.paper import style
from standoff_studies.paper.control.parameter_errors import Errors, volumes
from standoff_studies.paper.convergence.cells import (
    HARDER_LAWS,
    LAWS,
    Cell,
    committed,
    harder_cells,
    law_of,
    summary,
    wilson,
)
from standoff_studies.paper.convergence.pairs import RATES, RATIOS, SHARP, TURNING, pair
from standoff_studies.paper.convergence.rings import HOLLOW, KINDS, RING_LAWS, Arrived, all_arrivals
from standoff_studies.paper.figure import Artwork, Statement, own_statement
from standoff_studies.paper.keys import key_below, key_fill, key_line
from standoff_studies.paper.many_starts import INDEFINITE

HARDER = "harder.json"

FACES = 9
"""Pairs of faces of two lenses, over whose unit squares the starts are spread."""

DIRECTIONS = 120
"""Curves that are followed for a level."""

SECTION = "Section VI"

DESCENDING = ("covariant, by principal directions", "gradient")
"""The laws on rings whose form is semidefinite on any body."""

LOOKS = {
    "printed": (style.RED, "s"),
    "covariant-hold": (style.GREEN, "^"),
    "newton": (style.PURPLE, "D"),
}
"""Colour and marker of each law."""


class Proven(NamedTuple):
    """What fraction of a pair's starts each function proves to arrive at rest as printed.

    Attributes
    ----------
    pair : str
    error, v, energy : float
        By |q − q*|², V and E − E*; 0 where the closest points are not on two faces: the level sets
        of an edge are lines, on which no start is drawn.
    """

    pair: str
    error: float
    v: float
    energy: float


def proven_of(name: str) -> Proven:
    """Compute what is proven for one pair at rest."""
    one = pair(name)
    made = Errors.of(one.a, one.b, one.path.pose(0.0))
    if len(made.optimum) < 4:
        return Proven(name, 0.0, 0.0, 0.0)
    levels = lyapunov_level(one.a, one.b, Pose.identity(), made.pose_b, DIRECTIONS)
    found = volumes(made, levels, made.shortest())
    return Proven(name, *(x / FACES for x in found[:3]))


def harder_summary(run: Iterable[tuple[Cell, list[dict[str, Any]]]]) -> str:
    """Return the text of the harder summary, what is proven computed anew: some minutes."""
    rows = [proven_of(name) for names in SHARP.values() for name in names]
    proven = ",\n  ".join(json.dumps(row._asdict()) for row in rows)
    return f'{summary(run, harder_cells).rstrip()[:-1]}, "proven": [\n  {proven}\n]}}\n'


def proven_as_committed() -> tuple[Proven, ...]:
    """Return what was proven when the summary was last written."""
    text = files("standoff_studies.paper.convergence").joinpath(HARDER).read_text("utf-8")
    return tuple(Proven(**row) for row in json.loads(text)["proven"])


def harder() -> Artwork:
    """Starts on harder pairs, as last run, and on rings, run now."""
    cells, rings = committed(HARDER), all_arrivals()
    return Artwork(
        caption=(
            "Fraction of random starts that arrive, without restarts. Above left: the second of "
            "two stretched lenses turns about its centre; right: two lenses at rest that are "
            "stretched until the curvatures of their ellipsoids have a ratio. A mark is "
            f"{len(TURNING[RATES[0]])} pairs of 100 starts each, with Wilson's 95 % interval; "
            "K h = 0.1, of Newton's method 1. Below: rings, which bend inwards, at rest. Solid: "
            "starts that come to the least distance, proven by a cold query of solids; hatched: to "
            "another local minimum; what is missing stands still elsewhere, or nowhere."
        ),
        text=(
            "Above two diagrams with one line at 1, the covariant law with held boundaries, and "
            "two between 0.1 and 0.5, the printed law and Newton's method, which do not depend "
            "much on the speed or on the ratio. Below five groups of bars: of rings the gradient "
            "and the covariant law by principal directions come to a local minimum, of two or more "
            "to the least in three fifths of the starts; the printed law in some per cent. In the "
            "hollow ring the covariant law misses one start in ten, those two none."
        ),
        draw=lambda: _draw(cells, rings),
        tables={
            "cells": _cells(cells),
            "proven": _proven(),
            "rings": _rings(rings),
        },
        statements=(*_of_lenses(cells), *_of_rings(rings)),
        shown=("proven", "rings"),
    )


def _pooled(cells: Iterable[Cell], law: str, names: Iterable[str], motion: str) -> tuple[int, int]:
    """Arrived and tried."""
    wanted = set(names)
    own = [c for c in cells if (c.law, c.motion) == (law, motion) and c.pair in wanted]
    return sum(c.arrived for c in own), sum(c.tried for c in own)


def _lines(cells: tuple[Cell, ...], law: str) -> tuple[list[tuple[int, int]], ...]:
    """Arrived and tried by rate, at rest first, and by ratio."""
    turning = [_pooled(cells, law, TURNING[RATES[0]], "rest")]
    turning += [_pooled(cells, law, names, "moving") for names in TURNING.values()]
    return turning, [_pooled(cells, law, names, "rest") for names in SHARP.values()]


def _cells(cells: tuple[Cell, ...]) -> dict[str, Any]:
    return {
        "pair": [cell.pair for cell in cells],
        "motion": [cell.motion for cell in cells],
        "law": [LAWS[cell.law].name for cell in cells],
        "K_per_s": [cell.gain for cell in cells],
        "tried": [cell.tried for cell in cells],
        "arrived": [cell.arrived for cell in cells],
        "causes": ["; ".join(f"{n} {cause}" for cause, n in cell.causes.items()) for cell in cells],
    }


def _proven() -> dict[str, Any]:
    """By ratio: arrived as printed, and what each function proves of it, mean of the pairs."""
    rows = {row.pair: row for row in proven_as_committed()}
    cells, table = committed(HARDER), {}
    table["ratio of curvatures"] = [f"{ratio:g}" for ratio in RATIOS]
    for law in ("printed", "covariant-hold"):
        table[f"arrived, {LAWS[law].name}"] = [
            "{} of {}".format(*_pooled(cells, law, names, "rest")) for names in SHARP.values()
        ]
    for name, words in (("error", "|q − q*|²"), ("v", "V"), ("energy", "E − E*")):
        means = [np.mean([getattr(rows[key], name) for key in names]) for names in SHARP.values()]
        table[f"proven by {words}, as printed"] = [f"{mean:.1e}" for mean in means]
    return table


def _rings(rings: dict[tuple[str, str], Arrived]) -> dict[str, Any]:
    return {
        "pair": [kind for kind, _ in rings],
        "law": [law for _, law in rings],
        "at the least distance": [f"{x.at_least} of {x.tried}" for x in rings.values()],
        "at another minimum": [str(x.at_other) for x in rings.values()],
        "elsewhere": [str(x.tried - x.at_least - x.at_other) for x in rings.values()],
        "more starts, nearer than the second minimum: at the least": [
            f"{x.below_arrived} of {x.below}" for x in rings.values()
        ],
    }


def _words(law: str) -> str:
    facts = law_of(law, HARDER_LAWS[law]).facts()
    shown = ("integrator", "gain", "saturation", "switching", "solve", "far_side", "restarts")
    return ", ".join(f"{key}={facts[key]}" for key in shown)


def _of_lenses(cells: tuple[Cell, ...]) -> tuple[Statement, ...]:
    def said(law: str) -> tuple[str, bool]:
        turning, sharp = _lines(cells, law)
        words = [", ".join(f"{a / n:.0%}" for a, n in line) for line in (turning, sharp)]
        all_arrive = all(a == n for line in (turning, sharp) for a, n in line)
        rates, ratios = _list([0.0, *RATES]), _list(RATIOS)
        return f"at {rates} rad/s {words[0]}; at ratios {ratios} {words[1]}", all_arrive

    printed, held, newton = (said(law) for law in LOOKS)
    low, high = wilson(*np.sum([*_lines(cells, "covariant-hold")[0]], axis=0).tolist())
    return (
        Statement(
            SECTION,
            "a large basin despite body motion and sharp curvature",
            f"as printed {printed[0]}",
            printed[1],
            INDEFINITE,
            _words("printed"),
        ),
        Statement(
            SECTION,
            "the same, with the covariant M and held boundaries",
            f"{held[0]}; with a 95 % interval of {low:.1%} to {high:.0%} while turning or at rest",
            held[1],
            by=_words("covariant-hold"),
        ),
        own_statement(SECTION, f"Newton's method {newton[0]}", by=_words("newton")),
    )


def _list(numbers: Iterable[float]) -> str:
    return ", ".join(f"{x:g}" for x in numbers)


def _of_rings(rings: dict[tuple[str, str], Arrived]) -> tuple[Statement, ...]:
    def of(law: str) -> Arrived:
        own = [x for (kind, one), x in rings.items() if one == law and kind != HOLLOW]
        return Arrived(*np.sum(own, axis=0).tolist())

    by = "on one patch without sides, K h = 0.1 by Heun, Newton's 1 by Euler; rings at rest"
    rows = {law: of(law) for law in RING_LAWS}
    best, gradient = (rows[law] for law in DESCENDING)
    return (
        Statement(
            SECTION,
            "a large basin of the closest points of bodies that are not convex",
            "; ".join(
                f"{law}: {x.at_least / x.tried:.0%} to the least distance, "
                f"{x.at_other / x.tried:.0%} to another minimum"
                for law, x in rows.items()
            ),
            all(x.at_least == x.tried for law, x in rows.items() if law == "as printed"),
            "where a body bends inwards its curvature, and so M, loses its sign; with several "
            "minima no law that descends comes to the least from everywhere",
            by,
        ),
        Statement(
            SECTION,
            "-",
            "with the positive part of each principal curvature "
            f"{best.at_least + best.at_other} of {best.tried} starts come to a local minimum, by "
            f"the gradient {gradient.at_least + gradient.at_other}; from starts nearer than the "
            f"second minimum {best.below_arrived} of {best.below} to the least; the distance rose "
            f"in {best.rises} frames of all these runs, by the gradient in {gradient.rises}",
            best.at_least + best.at_other == best.tried and best.below_arrived == best.below,
            by=by,
        ),
        Statement(
            SECTION,
            "-",
            "of a point in a hollow ring, whose wall bends inwards both ways on half of it, these "
            "starts come to the only minimum: "
            + "; ".join(
                f"{law} {rings[HOLLOW, law].at_least} of {rings[HOLLOW, law].tried}" for law in rows
            ),
            all(rings[HOLLOW, law].at_least == rings[HOLLOW, law].tried for law in DESCENDING),
            by=by,
        ),
        Statement(
            SECTION,
            "-",
            f"{sum(x.at_least + x.at_other for x in rings.values())} of all these starts come to a "
            "minimum that a cold query of solids tells; with H definite "
            f"{sum(x.unknown for x in rings.values())} end at another place",
            not any(x.unknown for x in rings.values()),
            by=by,
        ),
    )


def _draw(cells: tuple[Cell, ...], rings: dict[tuple[str, str], Arrived]) -> Figure:
    figure = style.new_figure(style.WIDTH, 7.6)
    halves: Any = figure.subfigures(2, 1, height_ratios=(1.0, 1.35))
    above, below = halves
    turning, sharp = above.subplots(1, 2, sharey=True)
    for law, (colour, marker) in LOOKS.items():
        for axes, line in zip((turning, sharp), _lines(cells, law), strict=True):
            parts = np.array([a / n for a, n in line])
            ends = np.array([wilson(*each) for each in line]).T
            axes.errorbar(
                range(len(line)),
                parts,
                np.abs(ends - parts),
                color=colour,
                marker=marker,
                markersize=5,
                capsize=3,
            )
    turning.set_xticks(range(len(RATES) + 1), ["0", *(f"{rate:g}" for rate in RATES)])
    sharp.set_xticks(range(len(RATIOS)), [f"{ratio:g}" for ratio in RATIOS])
    turning.set(xlabel="turning rate [rad/s]", ylabel="part that arrives [–]", ylim=(0.0, 1.05))
    sharp.set(xlabel="ratio of curvatures [–]")
    key_below(
        above,
        [
            key_line(LAWS[law].name, colour, marker=marker, markersize=5)
            for law, (colour, marker) in LOOKS.items()
        ],
        3,
    )
    panels = below.subplots(1, len(KINDS), sharey=True)
    for axes, kind in zip(panels, KINDS, strict=True):
        _draw_rings(axes, kind, rings)
    panels[0].set_yticks(range(len(RING_LAWS)), [law.replace(", by", ",\nby") for law in RING_LAWS])
    panels[0].invert_yaxis()
    key_below(
        below,
        [
            key_fill("at the least distance", style.BLUE),
            key_fill("at another local minimum", style.ORANGE, hatch="////"),
        ],
        2,
    )
    return figure


def _draw_rings(axes: Axes, kind: str, rings: dict[tuple[str, str], Arrived]) -> None:
    rows = [rings[kind, law] for law in RING_LAWS]
    least = [x.at_least / x.tried for x in rows]
    other = [x.at_other / x.tried for x in rows]
    axes.barh(range(len(rows)), least, 0.7, color=style.BLUE)
    axes.barh(
        range(len(rows)), other, 0.7, left=least, color=style.ORANGE, hatch="////", linewidth=0.0
    )
    axes.set_title(kind.replace(" and", "\nand"))
    axes.set(xlabel="part [–]", xlim=(0.0, 1.0), xticks=(0.0, 0.5, 1.0))
    axes.grid(visible=False, axis="y")
    axes.set_axisbelow(True)
