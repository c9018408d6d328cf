"""Block diagrams of the two realisations: boxes, sums and arrows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.patches import Circle

from standoff_studies.paper import style
from standoff_studies.paper.drawing import Spot, draw_arrow, draw_box

HALF_HEIGHT = 0.32
"""Half a box's height, in the diagram's own unit."""

ROUND = 0.18
"""Radius of a sum."""

STRAIGHT, STATE = style.BLACK, style.BLUE
"""Colours of a plain box and of an integrator, whose output is a state."""


def draw_integrated(axes: Axes) -> None:
    """Fig. 3: Psi is a state, integrated from M w + b."""
    _prepare(axes)
    _draw_law(axes)
    box(axes, (5.3, 3.0), "M", 0.35)
    _sum(axes, (6.5, 3.0))
    box(axes, (7.9, 3.0), "∫ dt", 0.5, STATE)
    arrow(axes, [(4.15, 3.0), (4.95, 3.0)], "w")
    arrow(axes, [(5.65, 3.0), (6.32, 3.0)], "Mw")
    arrow(axes, [(6.68, 3.0), (7.4, 3.0)], "Ψ'")
    _loop(axes, 8.4)
    box(axes, (4.55, 1.6), "∫ dt", 0.5, STATE)
    arrow(axes, [(4.55, 3.0), (4.55, 1.92)])
    arrow(axes, [(4.55, 1.28), (4.55, 0.82)], "q", (0.18, 0.0))
    _draw_matrices(axes, 4.7)
    arrow(axes, [(5.3, 0.82), (5.3, 2.68)], "M", (0.17, -0.3), dashed=True)
    arrow(axes, [(6.5, 0.82), (6.5, 2.82)], "b", (0.15, -0.5), dashed=True)


def draw_evaluated(axes: Axes) -> None:
    """Fig. 4: Psi is evaluated from Eqs. (1)-(4) at the parameters and the poses."""
    _prepare(axes)
    _draw_law(axes)
    box(axes, (5.3, 3.0), "∫ dt", 0.5, STATE)
    box(axes, (7.5, 3.0), "Ψ(q, poses)\nEqs. (1)–(4)", 0.95, height=0.45)
    arrow(axes, [(4.15, 3.0), (4.8, 3.0)], "w")
    arrow(axes, [(5.8, 3.0), (6.55, 3.0)], "q")
    _loop(axes, 8.45)
    arrow(axes, [(6.1, 3.0), (6.1, 0.82)], "q", (0.18, 0.0))
    _draw_matrices(axes, 4.7)
    arrow(axes, [(7.9, 0.5), (7.9, 2.55)], "poses", (0.42, 0.0), motion=True)


def _draw_law(axes: Axes) -> None:
    """The common part: w = M⁻¹(-K Psi - b)."""
    box(axes, (1.0, 3.0), "−K", 0.4)
    _sum(axes, (2.3, 3.0))
    box(axes, (3.7, 3.0), "M⁻¹", 0.45)
    arrow(axes, [(1.4, 3.0), (2.12, 3.0)], "−KΨ")
    arrow(axes, [(2.48, 3.0), (3.25, 3.0)])


def _draw_matrices(axes: Axes, x: float) -> None:
    """The box that evaluates M and b, the motion that enters it, and where they go."""
    box(axes, (x, 0.5), "M(q, poses),  b(q, poses, twists)\nEqs. (9), (10)", 2.25, height=0.32)
    arrow(axes, [(8.8, 0.5), (x + 2.25, 0.5)], motion=True)
    axes.text(8.9, 0.5, "bodies'\nposes\nand\ntwists", ha="left", va="center", color=style.RED)
    arrow(axes, [(2.9, 0.82), (2.9, 1.5), (2.3, 1.5), (2.3, 2.82)], "−b", (-0.25, 0.0), True)
    arrow(axes, [(3.7, 0.82), (3.7, 2.68)], "M", (-0.18, 0.0), True)


def _loop(axes: Axes, x: float) -> None:
    """Psi, fed back from the right end of the row to its left end."""
    arrow(axes, [(x, 3.0), (9.2, 3.0), (9.2, 3.85), (0.2, 3.85), (0.2, 3.0), (0.6, 3.0)])
    axes.text(4.7, 3.98, "Ψ", ha="center", va="bottom")


def _prepare(axes: Axes) -> None:
    axes.set(xlim=(0.0, 10.0), ylim=(0.0, 4.4))
    axes.set_aspect("equal")
    axes.axis("off")


def box(
    axes: Axes,
    centre: Spot,
    text: str,
    half_width: float,
    colour: str = STRAIGHT,
    height: float = HALF_HEIGHT,
) -> None:
    """A box with its text; one that integrates has a thick rim."""
    thick = 2.2 if colour == STATE else 1.2
    look: dict[str, Any] = {"facecolor": "white", "edgecolor": colour, "linewidth": thick}
    draw_box(axes, centre, (half_width, height), 0.08, **look)
    axes.text(*centre, text, ha="center", va="center", zorder=4)


def _sum(axes: Axes, centre: Spot) -> None:
    axes.add_patch(Circle(centre, ROUND, facecolor="white", edgecolor=STRAIGHT, zorder=3))
    axes.text(*centre, "+", ha="center", va="center", zorder=4)


def arrow(
    axes: Axes,
    spots: Sequence[Spot],
    text: str = "",
    shift: Spot = (0.0, 0.17),
    dashed: bool = False,
    motion: bool = False,
) -> None:
    """A line through the spots with a head at its end, and a name at the middle of its last part.

    Dashed: matrices that come from the parameters; in another colour: the bodies' motion.
    """
    colour = style.RED if motion else STRAIGHT
    dashes = "--" if dashed else "-"
    xs, ys = zip(*spots, strict=True)
    look: dict[str, Any] = {"color": colour, "linestyle": dashes, "linewidth": 1.2}
    axes.plot(xs[:-1], ys[:-1], zorder=2, **look)
    draw_arrow(axes, *spots[-2:], **look)
    if text:
        x, y = (0.5 * (spots[-2][k] + spots[-1][k]) + shift[k] for k in (0, 1))
        axes.text(x, y, text, ha="center", va="center", color=colour, zorder=5)
