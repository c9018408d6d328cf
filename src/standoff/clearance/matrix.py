"""The clearances of all pairs as a matrix: names on both axes, colour by gap, verdicts marked."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from standoff.clearance.report import Report
from standoff.clearance.verdicts import Verdict
from standoff.errors import of_extra
from standoff.wording import at_least, short_name

with of_extra("matplotlib", "plot"):
    from matplotlib import colormaps
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch, Rectangle

MOST_BODIES = 60
"""Names that fit on an axis; of more bodies those of the worst pairs are drawn."""

MOST_WRITTEN = 16
"""Bodies up to which each cell has its number."""

CELL, WIDE = 0.52, 11.0
"""Of a cell in inches, and at most of all cells."""

LEFT, BESIDE, BELOW, ABOVE = 1.6, 3.2, 1.35, 0.6
"""Inches left of the cells, left and right of them together, below and above them."""

LEAST = 6
"""Cells that the figure has room for, however few bodies there are."""

OVERLAP_COLOUR, UNDECIDED_COLOUR, TOUCH_COLOUR = "#D55E00", "#CC79A7", "#E69F00"
FAR_COLOUR, FAR_HATCH = "#EDEDED", "////"
COLOURS = "YlGnBu_r"
"""Of the gaps: dark is near. Okabe and Ito's orange, vermilion and purple are not among them."""

WORDS = {Verdict.TOUCHING: "touch", Verdict.CONTAINED: "inside"}
"""Written in a cell in place of the gap."""

DARK = 0.45
"""Brightness of a cell below which its number is white."""


class Cell(NamedTuple):
    """What is drawn of a pair: what is known of it, whether it does not hold, or is allowed."""

    verdict: Verdict
    gap: float  # or the bound of a far pair
    far: bool
    fails: bool
    allowed: bool


def cells_of(report: Report) -> dict[tuple[str, str], Cell]:
    """Return the cell of each pair that counts."""
    cells = {
        row.names: Cell(
            row.verdict, row.answer.distance, False, bool(row.failure), row.fit is not None
        )
        for row in report.rows
    }
    for far in report.far:
        cells[far.names] = Cell(Verdict.APART, far.bound, True, bool(far.failure), False)
    return cells


def drawn_bodies(report: Report) -> list[str]:
    """Return the names on the axes, in the world's order; of many, those of the worst pairs."""
    names = list(report.world.bodies)
    if len(names) <= MOST_BODIES:
        return names
    worst = list(dict.fromkeys(name for row in report.rows for name in row.names))
    kept = set((worst + names)[:MOST_BODIES] if len(worst) < MOST_BODIES else worst[:MOST_BODIES])
    return [name for name in names if name in kept]


def side_of(report: Report) -> float:
    """Return the side of a report's matrix, inches."""
    return min(WIDE, CELL * max(len(drawn_bodies(report)), LEAST))


def matrix_figure(report: Report, title: str, unit: str) -> Figure:
    """Draw a report's matrix as a figure of its own.

    Parameters
    ----------
    report : Report
    title : str
        Of the scene.
    unit : str
        Label of lengths.
    """
    side = side_of(report)
    # Not through pyplot, which would ask for a display and keep the figure alive.
    figure = Figure(figsize=(side + BESIDE, side + BELOW + ABOVE), dpi=130)
    FigureCanvasAgg(figure)
    draw_matrix(figure, report, f"{title}: clearance of all pairs", unit)
    return figure


def draw_matrix(figure: Figure, report: Report, title: str, unit: str) -> None:
    """Draw a report's matrix at the lower left of a figure, with its title above it."""
    names, cells = drawn_bodies(report), cells_of(report)
    n, side = len(names), side_of(report)
    width, height = figure.get_size_inches().tolist()
    axes = figure.add_axes((LEFT / width, BELOW / height, side / width, side / height))
    known = [c.gap for c in cells.values() if not c.far and c.verdict is Verdict.APART]
    scale = Normalize(0.0, max([*known, 0.0]) or 1.0)
    for i in range(n):
        for j in range(i):
            cell = cells.get((names[i], names[j])) or cells.get((names[j], names[i]))
            _draw_cell(axes, (i, j), cell, scale, written=n <= MOST_WRITTEN)
    _dress(axes, names)
    more = "" if n == len(report.world.bodies) else f", the {n} bodies of the worst pairs"
    top = (BELOW + side + 0.6 * ABOVE) / height
    figure.text(0.15 / width, top, f"{title}{more}", fontsize="large", va="center")
    axes.legend(
        handles=_legend(cells.values(), len(report.world.bodies)),
        loc="upper right",
        frameon=False,
        fontsize="small",
    )
    if known:
        box = (LEFT + side + 0.15) / width, BELOW / height, 0.16 / width, 0.55 * side / height
        label = f"gap ({unit})" if unit else "gap"
        bar = figure.add_axes(box)
        figure.colorbar(ScalarMappable(scale, colormaps[COLOURS]), cax=bar, label=label)


def _draw_cell(
    axes: Axes, at: tuple[int, int], cell: Cell | None, scale: Normalize, *, written: bool
) -> None:
    i, j = at
    if cell is None:
        axes.plot(j, i, ".", color="0.8", markersize=3)
        return
    colour, dark = _colour(cell, scale)
    hatch = FAR_HATCH if cell.far else None
    axes.add_patch(
        Rectangle(
            (j - 0.5, i - 0.5),
            1.0,
            1.0,
            facecolor=colour,
            edgecolor="0.78" if cell.far else "white",
            hatch=hatch,
            linewidth=0.6,
        )
    )
    if cell.fails:
        axes.add_patch(
            Rectangle(
                (j - 0.44, i - 0.44), 0.88, 0.88, fill=False, edgecolor="black", linewidth=1.8
            )
        )
    if written:
        text = f"≥{at_least(cell.gap, 3)}" if cell.far else at_least(cell.gap, 3)
        if cell.verdict in WORDS:
            text = WORDS[cell.verdict]
        if cell.allowed and not cell.fails and cell.verdict is not Verdict.APART:
            text += "\nallowed"
        box = {"facecolor": FAR_COLOUR, "edgecolor": "none", "pad": 0.5} if cell.far else None
        axes.text(
            j,
            i,
            text,
            ha="center",
            va="center",
            fontsize=7,
            color="white" if dark else "black",
            bbox=box,
        )


def _colour(cell: Cell, scale: Normalize) -> tuple[object, bool]:
    """The colour of a cell, and whether it is dark."""
    if cell.far:
        return FAR_COLOUR, False
    if cell.verdict is Verdict.APART:
        colour = colormaps[COLOURS](scale(cell.gap))
        bright = 0.3 * colour[0] + 0.59 * colour[1] + 0.11 * colour[2]
        return colour, bright < DARK
    colours = {
        Verdict.OVERLAPPING: OVERLAP_COLOUR,
        Verdict.UNDECIDED: UNDECIDED_COLOUR,
        Verdict.TOUCHING: TOUCH_COLOUR,
        Verdict.CONTAINED: OVERLAP_COLOUR,
    }
    return colours[cell.verdict], False


def _dress(axes: Axes, names: Sequence[str]) -> None:
    n = len(names)
    shown = [short_name(name) for name in names]
    small = 9 if n <= 30 else 6
    axes.set_xlim(-0.5, n - 0.5)
    axes.set_ylim(n - 0.5, -0.5)
    # The last body has no column of its own, and the first no row.
    axes.set_xticks(
        range(n - 1), shown[:-1], rotation=45, ha="right", rotation_mode="anchor", fontsize=small
    )
    axes.set_yticks(range(1, n), shown[1:], fontsize=small)
    axes.tick_params(length=0)
    for spine in axes.spines.values():
        spine.set_visible(False)


def _legend(cells: Iterable[Cell], n: int) -> list[Artist]:
    found = list(cells)
    some = {cell.verdict for cell in found}
    entries: list[Artist] = []
    for verdict, colour, label in (
        (Verdict.OVERLAPPING, OVERLAP_COLOUR, "overlapping; minus the depth"),
        (Verdict.UNDECIDED, UNDECIDED_COLOUR, "undecided"),
        (Verdict.TOUCHING, TOUCH_COLOUR, "touching"),
        (Verdict.CONTAINED, OVERLAP_COLOUR, "one inside the other's material"),
    ):
        if verdict in some:
            entries.append(Patch(facecolor=colour, label=label))
    if any(cell.far for cell in found):
        entries.append(
            Patch(
                facecolor=FAR_COLOUR,
                edgecolor="0.78",
                hatch=FAR_HATCH,
                label="far: at least so far apart",
            )
        )
    if len(found) < n * (n - 1) // 2:
        entries.append(
            Line2D([], [], color="0.8", marker=".", linestyle="", label="does not count")
        )
    if any(cell.fails for cell in found):
        entries.append(Patch(fill=False, edgecolor="black", linewidth=1.8, label="does not hold"))
    return entries
