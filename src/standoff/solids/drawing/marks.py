"""What an answer marks in a picture: nearest points, ties, ends of a continuum, the common ball,
and pieces that stay open."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import scipy

from standoff.bodies.drawing.pair_picture import COLOURS, WITNESS_COLOUR
from standoff.bodies.plain_data import without_roundoff
from standoff.errors import of_extra
from standoff.solids.answer import SolidProximity
from standoff.solids.tolerances import FARTHER, FLAT_BOX
from standoff.tracking.status import Status
from standoff.typing import Array
from standoff.wording import counted

with of_extra("matplotlib", "plot"):
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.colors import to_rgb
    from matplotlib.lines import Line2D
    from matplotlib.patches import Circle, Patch, Polygon

Flat = Callable[[Array], Array]
"""From world points (n, 3) to the picture (n, 2)."""

END_COLOUR, BALL_COLOUR, OPEN_COLOUR = "#AA3377", "#117733", "#CC3311"

WITNESS_ORDER, END_ORDER, BALL_ORDER, OPEN_ORDER = 6.0, 7.0, 5.0, 4.0

OPEN_OPACITY = 0.12

SMALL = 0.008
"""Part of the picture: what is smaller gets a mark around it."""

WITNESS_LOOK = {"color": WITNESS_COLOUR, "marker": "o", "markersize": 4.5, "linewidth": 1.6}
TIE_LOOK = {"color": WITNESS_COLOUR, "marker": "o", "markersize": 2.5, "linewidth": 0.8}
END_LOOK = {"color": END_COLOUR, "marker": "D", "markersize": 5.0, "markerfacecolor": "white"}


def draw_marks(axes: Axes, answer: SolidProximity, flat: Flat, wide: float) -> None:
    """Draw all that an answer has; `wide`: of the picture, length."""
    for side, (_, strong) in enumerate(COLOURS):
        pieces = [(piece.corners_a, piece.corners_b)[side] for piece in answer.open]
        for corners in {piece.tobytes(): piece for piece in pieces}.values():
            _draw_piece(axes, flat(corners), strong, wide)
    if answer.overlap is not None:
        centre = flat(answer.overlap.common_point[None])[0]
        look: dict[str, Any] = {"facecolor": "none", "edgecolor": BALL_COLOUR, "linewidth": 1.6}
        axes.add_patch(Circle(tuple(centre), answer.overlap.radius, zorder=BALL_ORDER, **look))
        axes.plot(*centre, "+", color=BALL_COLOUR, zorder=BALL_ORDER)
    places = has_places(answer)
    for pair in answer.minima[1:]:
        ends = flat(np.array([pair.point_a, pair.point_b]))
        axes.plot(*ends.T, zorder=WITNESS_ORDER - 0.5, **TIE_LOOK)  # type: ignore[arg-type]
    if np.isfinite(answer.point_a).all() and (answer.overlap is None or places):
        ends = flat(np.array([answer.point_a, answer.point_b]))
        axes.plot(*ends.T, zorder=WITNESS_ORDER, **WITNESS_LOOK)  # type: ignore[arg-type]
    if answer.continuum is not None and answer.continuum.ends:
        ends = np.array(answer.continuum.ends)
        if answer.continuum.kind == "line":
            for side in (0, 1):
                axes.plot(*flat(ends[:, side]).T, color=END_COLOUR, lw=1.4, zorder=END_ORDER - 0.5)
        axes.plot(*flat(ends.reshape(-1, 3)).T, linestyle="", zorder=END_ORDER, **END_LOOK)  # type: ignore[arg-type]


def has_places(answer: SolidProximity) -> bool:
    """Is an overlap told place by place?"""
    return answer.overlap is not None and bool(answer.minima) and answer.minima[0].distance < 0.0


def _draw_piece(axes: Axes, corners: Array, colour: str, wide: float) -> None:
    """The outline of a box, with a ring around a small one."""
    hull = corners
    if np.linalg.matrix_rank(corners - corners[0], tol=FLAT_BOX * wide) == 2:
        hull = corners[scipy.spatial.ConvexHull(corners).vertices]
    look: dict[str, Any] = {"facecolor": (*to_rgb(colour), OPEN_OPACITY), "edgecolor": OPEN_COLOUR}
    axes.add_patch(Polygon(hull, linewidth=0.7, zorder=OPEN_ORDER, **look))
    if float(np.ptp(corners, axis=0).max()) < SMALL * wide:
        middle = corners.mean(axis=0)
        ring = {"markersize": 9.0, "markerfacecolor": "none", "color": OPEN_COLOUR}
        axes.plot(*middle, "s", zorder=OPEN_ORDER, **ring)  # type: ignore[arg-type]


def marks_legend(answer: SolidProximity, size: float, unit: str) -> list[Artist]:
    """Entries for what is drawn, with the distance; `size`: of the solids, length."""
    handles: list[Artist] = [_told(answer, size, unit)]
    others = len(answer.minima) - 1
    if others > 0:
        farther = answer.minima[-1].distance > answer.distance + FARTHER * size
        one, many = "nearest pair", "nearest pairs"
        if farther:
            one, many = "local minimum", "local minima"
        label = f"1 more {one}" if others == 1 else f"{others} more {many}"
        handles.append(Line2D([], [], label=label, **TIE_LOOK))  # type: ignore[arg-type]
    if answer.continuum is not None:
        kind, ends = answer.continuum.kind, len(answer.continuum.ends)
        name = "corners" if kind == "surface" else "ends"
        label = f"{name} of the continuum ({kind})" if ends else f"a closed {kind} of nearest pairs"
        handles.append(Line2D([], [], linestyle="", label=label, **END_LOOK))  # type: ignore[arg-type]
    if answer.overlap is not None:
        label = f"ball inside both, radius {answer.overlap.radius:.6g} {unit}".rstrip()
        handles.append(Line2D([], [], color=BALL_COLOUR, linewidth=1.6, label=label))
    if answer.open:
        shown, of_all = len(answer.open), max(len(answer.open), answer.counts.open)
        part = "{}" if of_all == shown else f"{shown} of {{}}"
        label = f"open: {counted(of_all, 'pair', write=part.format)} of pieces, in boxes"
        handles.append(Patch(facecolor="none", edgecolor=OPEN_COLOUR, label=label))
    return handles


def _told(answer: SolidProximity, size: float, unit: str) -> Artist:
    status = answer.status.name
    if not np.isfinite(answer.distance):
        return Line2D([], [], linestyle="", label=f"no distance, {status}")
    (distance,) = without_roundoff([answer.distance], size)
    name = "depth at least" if distance < 0.0 else "wall" if answer.inside else "distance"
    places = has_places(answer)
    if places:
        name = "depth of the deepest place"
    told = f"{name} {abs(distance):.6g} {unit}".rstrip()
    if answer.status in (Status.WITHIN, Status.DEADLINE):
        low = max(answer.lower_bound, 0.0) if np.isfinite(answer.lower_bound) else None
        told += ", no lower bound" if low is None else f", at least {low:.6g}"
    look: dict[str, Any] = WITNESS_LOOK
    if answer.overlap is not None and not places:
        look = {"linestyle": ""}
    return Line2D([], [], label=f"{told}, {status}", **look)
