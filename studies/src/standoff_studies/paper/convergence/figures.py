"""Which starts arrive, by pair, parametrisation and law: the picture, tables and statements."""

from __future__ import annotations

import tempfile
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from standoff_studies.paper import style
from standoff_studies.paper.convergence.cells import (
    GAINS,
    LAWS,
    MOTIONS,
    Cell,
    committed,
    law_of,
    read,
    study,
    wilson,
)
from standoff_studies.paper.convergence.pairs import DRAWN_PAIRS, GRIDS, LENSES
from standoff_studies.paper.convergence.starts import ARRIVED, CAUSES, LEAST_FRAMES, PATIENCE
from standoff_studies.paper.figure import HYBRID, Artwork, Statement, own_statement
from standoff_studies.paper.keys import key_below, key_line
from standoff_studies.paper.many_starts import INDEFINITE

GROUPS = {
    "D, patches": ("D patches",),
    "D, gnomonic": ("D gnomonic",),
    "D, stereographic": ("D stereographic",),
    "E, patches": ("E patches",),
    "E, gnomonic": ("E gnomonic",),
    "E, stereographic": ("E stereographic",),
    "A: vault, point": ("A point",),
    "two vaults": ("A vaults",),
    "B, outside": ("B",),
    "C": ("C",),
    "ten drawn pairs": DRAWN_PAIRS,
}
"""The rows of the picture, and the pairs that each shows."""

DRAWN_LAWS = ("printed", "covariant", "covariant-hold")
"""The laws that are drawn."""

LOOKS = {
    "printed": (style.RED, "s", 0.22),
    "covariant": (style.BLUE, "o", 0.0),
    "covariant-hold": (style.GREEN, "^", -0.22),
}
"""Colour, marker and shift in height of each law that is drawn."""

REVIEWED = {
    ("D patches, grid", "printed"): "34 of 75",
    ("D gnomonic, grid", "printed"): "16 of 75",
    ("D patches, grid", "covariant"): "75 of 75",
    ("E patches", "printed"): "13 to 19 %",
    ("E gnomonic", "printed"): "7 %",
    ("E patches", "covariant"): "200 of 200, 1000 of 1000",
}
"""The counts of an independent program in plain NumPy (E: 200 to 1000 starts)."""


def as_committed() -> Artwork:
    """The study as last run and stored."""
    return _artwork(committed())


def anew() -> Artwork:
    """The study rerun: two hours of processor time."""
    with tempfile.TemporaryDirectory() as folder:
        kept = Path(folder) / "cells.jsonl"
        study(kept)
        return _artwork(tuple(cell for cell, _ in read(kept.read_text("utf-8").splitlines())))


def _artwork(cells: tuple[Cell, ...]) -> Artwork:
    return Artwork(
        caption=(
            f"Part of random starts that has come to the true distance, within {ARRIVED:g} length, "
            f"{PATIENCE:g}/K and {LEAST_FRAMES} frames after the start, without restarts. A mark "
            f"is a gain K: {', '.join(f'{gain:g}' for gain in GAINS)} 1/s; a line joins the gains. "
            "D and E are the lens with a point and with a stretched lens, the same bodies and the "
            "same starts in three parametrisations; the drawn pairs are stretched lenses of "
            "patches. A mark stands for 1000 starts of a pair with the covariant M, in some cells "
            "for 200 or 300, and for 300 as printed, 100 on a drawn pair."
        ),
        text=(
            "Two diagrams, bodies at rest and moving, with a row for each pair. As printed the "
            "part of the starts that arrive is between a few per cent and all, by pair and "
            "parametrisation. With the covariant M and held boundaries all arrive."
        ),
        draw=lambda: _draw(cells),
        tables={
            "shares": _shares(cells),
            "reviewed": _reviewed(cells),
            "causes": _causes(cells),
            "cells": _table(cells),
        },
        statements=_statements(cells),
        shown=("shares", "reviewed", "causes"),
    )


def _of(
    cells: Iterable[Cell], law: str, pairs: Iterable[str] | None = None, motion: str | None = None
) -> list[Cell]:
    wanted = None if pairs is None else set(pairs)
    return [
        cell
        for cell in cells
        if cell.law == law
        and (cell.pair in wanted if wanted is not None else cell.pair not in GRIDS)
        and motion in (None, cell.motion)
    ]


def _pooled(cells: Iterable[Cell]) -> str:
    """Arrived of tried, and Wilson's interval."""
    found = list(cells)
    tried = sum(cell.tried for cell in found)
    if not tried:
        return "–"
    arrived = sum(cell.arrived for cell in found)
    low, high = wilson(arrived, tried)
    return f"{arrived} of {tried} ({low:.1%} to {high:.1%})"


def _range(cells: Iterable[Cell]) -> str:
    parts = [cell.part for cell in cells]
    return f"{min(parts):.1%} to {max(parts):.1%}"


def _shares(cells: tuple[Cell, ...]) -> dict[str, Any]:
    """By pair: arrived of tried over all gains and both motions."""
    laws = ("printed", "printed-left", "covariant", "covariant-hold")
    return {
        "pair": list(GROUPS),
        **{
            LAWS[law].name: [_pooled(_of(cells, law, GROUPS[row])) for row in GROUPS]
            for law in laws
        },
    }


def _reviewed(cells: tuple[Cell, ...]) -> dict[str, Any]:
    """D from its grid and E, at rest at K = 25, compared with an independent program."""
    rows = [*GRIDS, *(name for name in LENSES if name.startswith("E"))]
    low = [cell for cell in cells if cell.motion == "rest" and cell.gain == GAINS[0]]
    found: dict[str, Any] = {"bodies": rows}
    for law in ("printed", "covariant"):
        found[LAWS[law].name] = [_pooled(_of(low, law, (row,))) for row in rows]
        found[f"{LAWS[law].name}, plain NumPy"] = [REVIEWED.get((row, law), "–") for row in rows]
    return found


def _causes(cells: tuple[Cell, ...]) -> dict[str, Any]:
    """How many starts have not arrived, by cause."""
    columns: dict[str, Any] = {"cause": [], **{LAWS[law].name: [] for law in DRAWN_LAWS}}
    counts = {law: Counter[str]() for law in DRAWN_LAWS}
    for law in DRAWN_LAWS:
        for cell in _of(cells, law):
            counts[law].update(cell.causes)
    for cause, words in CAUSES.items():
        for key, where in ((cause, "right features"), (f"{cause}, elsewhere", "other features")):
            if any(counts[law][key] for law in DRAWN_LAWS):
                columns["cause"].append(f"{words}; on {where}")
                for law in DRAWN_LAWS:
                    columns[LAWS[law].name].append(str(counts[law][key]))
    columns["cause"].append("all starts")
    for law in DRAWN_LAWS:
        columns[LAWS[law].name].append(str(sum(cell.tried for cell in _of(cells, law))))
    return columns


def _table(cells: tuple[Cell, ...]) -> dict[str, Any]:
    intervals = [cell.interval for cell in cells]
    return {
        "pair": [cell.pair for cell in cells],
        "law": [LAWS[cell.law].name for cell in cells],
        "motion": [MOTIONS[cell.motion] for cell in cells],
        "K [1/s]": [f"{cell.gain:g}" for cell in cells],
        "arrived": [f"{cell.arrived} of {cell.tried}" for cell in cells],
        "95 % interval": [f"{low:.4f} to {high:.4f}" for low, high in intervals],
        "middle time · K": [_times(cell, cell.median) for cell in cells],
        "99 % time · K": [_times(cell, cell.slowest) for cell in cells],
        "causes": ["; ".join(f"{n} {cause}" for cause, n in cell.causes.items()) for cell in cells],
    }


def _times(cell: Cell, time: float | None) -> str:
    return "–" if time is None else f"{time * cell.gain:.1f}"


def _words(law: str) -> str:
    """The law with which a statement was measured."""
    facts = {key: value for key, value in law_of(law, 1.0).facts().items() if key in SHOWN}
    return ", ".join(f"{key}={value}" for key, value in facts.items())


SHOWN = ("saturation", "switching", "solve", "reset", "far_side", "restarts")


SPATIAL = (*LENSES, "A point", "A vaults", *DRAWN_PAIRS)

MOST = 0.99
"""Fraction of the starts above which a statement about all of them counts as right."""


def _part(cells: Iterable[Cell], name: str) -> str:
    """A count as a fraction of the starts tried."""
    found = list(cells)
    return f"{_sum(found, name) / _sum(found, 'tried'):.1%}"


def _sum(cells: Iterable[Cell], name: str) -> int:
    return sum(getattr(cell, name) for cell in cells)


def _statements(cells: tuple[Cell, ...]) -> tuple[Statement, ...]:
    held, grid = _of(cells, "covariant-hold"), _of(cells, "printed", GRIDS)
    gains = f"K = {GAINS[0]:g} to {GAINS[-1]:g} 1/s"
    return (
        _switching(cells),
        _definite(cells),
        _anywhere(cells, f"{_words('printed')}; {gains}"),
        own_statement(
            HYBRID,
            f"on D's grid {_sum(grid, 'right')} of {_sum(grid, 'tried')} starts are on the closest "
            f"features after one frame, M is definite at {_sum(grid, 'definite')} of them, and "
            f"{_sum(grid, 'definite_arrived')} of these and {_sum(grid, 'arrived')} in all arrive",
            by=f"{_words('printed')}; K = {GAINS[0]:g} 1/s",
        ),
        own_statement(
            HYBRID,
            f"covariant M, boundaries held: {_pooled(held)} arrive, in the worst cell "
            f"{min(cell.part for cell in held):.1%}",
            by=f"{_words('covariant-hold')}; {gains}",
        ),
        own_statement(
            HYBRID,
            "covariant M, zeroed as printed: lenses of D and E "
            f"{_pooled(_of(cells, 'covariant', LENSES))}; drawn pairs "
            f"{_pooled(_of(cells, 'covariant', DRAWN_PAIRS))}, in the worst cell "
            f"{min(cell.part for cell in _of(cells, 'covariant')):.1%}",
            by=f"{_words('covariant')}; {gains}",
        ),
    )


def _switching(cells: tuple[Cell, ...]) -> Statement:
    left, kept = _of(cells, "printed-left"), _of(cells, "printed", SPATIAL)
    lenses = _of(left, "printed-left", LENSES)
    return Statement(
        HYBRID,
        "the discrete switching finds the closest features",
        f"far side left: {_part(lenses, 'settled')} of the starts on the lenses of D and E end on "
        f"them, of all spatial pairs {_part(left, 'settled')}; far side kept: "
        f"{_part(_of(kept, 'printed', LENSES), 'settled')} and {_part(kept, 'settled')}",
        _sum(lenses, "settled") >= MOST * _sum(lenses, "tried"),
        "a face of the far side that is kept holds its witness point; and on bodies whose witness "
        "points the law has pinned the features next to those are the closest",
        f"{_words('printed-left')}, and far_side=kept",
    )


def _definite(cells: tuple[Cell, ...]) -> Statement:
    spatial = _of(cells, "printed", SPATIAL)
    by_gain = [[cell for cell in spatial if cell.gain == gain] for gain in GAINS]
    parts = [_sum(own, "definite_arrived") / _sum(own, "definite") for own in by_gain]
    words = ", ".join(f"{part:.1%}" for part in parts)
    return Statement(
        HYBRID,
        "any start where M is positive definite converges",
        f"of the starts on the closest features after one frame with M definite there: {words} at "
        f"K = {', '.join(f'{gain:g}' for gain in GAINS)} 1/s",
        parts[0] >= MOST,
        "with a long step, K h = 0.4 and 1, the law leaves the region in which M is definite",
        f"{_words('printed')}; judged at K = {GAINS[0]:g} 1/s",
    )


def _anywhere(cells: tuple[Cell, ...], by: str) -> Statement:
    printed = _of(cells, "printed")

    def of(*pairs: str) -> str:
        return _range(_of(printed, "printed", pairs))

    return Statement(
        HYBRID,
        "from a start anywhere on tiled convex bodies the errors converge",
        f"in the plane {of('B', 'C')} arrive; in space it depends on the parametrisation: lenses "
        f"of patches {of('D patches', 'E patches')}, gnomonic {of('D gnomonic', 'E gnomonic')}, "
        f"stereographic {of('D stereographic', 'E stereographic')}; vaults "
        f"{of('A point', 'A vaults')}; drawn pairs {of(*DRAWN_PAIRS)}",
        all(cell.arrived == cell.tried for cell in printed),
        INDEFINITE,
        by,
    )


def _draw(cells: tuple[Cell, ...]) -> Figure:
    figure = style.new_figure(style.WIDTH, 5.4)
    panels = figure.subplots(1, 2, sharey=True)
    for axes, motion in zip(panels, MOTIONS, strict=True):
        for law in DRAWN_LAWS:
            _draw_law(axes, [cell for cell in cells if cell.motion == motion], law)
        axes.set_title(MOTIONS[motion])
        axes.set_xlabel("part that arrives [–]")
        axes.set_xlim(-0.03, 1.03)
        for k in range(1, len(GROUPS)):
            axes.axhline(-k + 0.5, color=style.QUIET, linewidth=0.4)
        axes.grid(visible=False, axis="y")
    panels[0].set_yticks([-k for k in range(len(GROUPS))], list(GROUPS))
    panels[0].set_ylim(-len(GROUPS) + 0.5, 0.5)
    _legend(figure)
    return figure


def _draw_law(axes: Axes, cells: list[Cell], law: str) -> None:
    colour, marker, shift = LOOKS[law]
    for k, pairs in enumerate(GROUPS.values()):
        own = _of(cells, law, pairs)
        parts = []
        for gain in GAINS:
            same = [cell for cell in own if cell.gain == gain]
            if same:
                parts.append(_sum(same, "arrived") / _sum(same, "tried"))
        look: dict[str, Any] = {"color": colour, "marker": marker, "markersize": 4.0}
        axes.plot(parts, [shift - k] * len(parts), linewidth=1.2, **look)


def _legend(figure: Figure) -> None:
    handles = [
        key_line(LAWS[law].name, colour, marker=marker, markersize=4.0)
        for law, (colour, marker, _) in LOOKS.items()
    ]
    key_below(figure, handles, 3)
