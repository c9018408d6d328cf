"""A picture of parts that need not be convex, with the closest points of the worst pairs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from standoff.bodies.drawing.body_view import LIGHT, across, direction_to_viewer, frame
from standoff.bodies.drawing.pair_picture import USUAL_VIEW, seen_from
from standoff.bodies.drawing.solids import DARKEST
from standoff.clearance.picture import (
    FAINT,
    HALO,
    NUMBER,
    ON_TOP,
    OTHERS,
    THROUGH,
    PicturedPart,
    bodies_legend,
    colour_of,
    numbered_rows,
    pairs_legend,
    parts_of,
)
from standoff.clearance.report import PairRow, Report
from standoff.clearance.verdicts import Verdict
from standoff.errors import of_extra
from standoff.motion import Pose
from standoff.typing import Array

with of_extra("matplotlib", "plot"):
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.colors import to_rgb
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

EDGE = "0.25"
"""Colour of the parts' edges."""


def assembly_figure(
    report: Report,
    poses: Mapping[str, Pose],
    unit: str,
    colours: Mapping[str, tuple[float, float, float]],
) -> Figure:
    """Draw the bodies of a world that has solids: those of its first pairs in colour, in their own
    where they have one, the others faint.

    All triangles are sorted together from back to front, as parts may be around one another.
    """
    rows = numbered_rows(report)
    coloured = list(dict.fromkeys(name for row in rows for name in row.names))
    figure = Figure(figsize=(9.0, 7.6), dpi=130)
    FigureCanvasAgg(figure)
    axes: Any = figure.add_axes((0.0, 0.12, 1.0, 0.88), projection="3d", computed_zorder=False)
    towards = direction_to_viewer(USUAL_VIEW)
    axes.view_init(*USUAL_VIEW)
    axes.set_proj_type("ortho")
    parts = parts_of(report.world, poses, coloured)
    shown: dict[str, Any] = {name: colour_of(name, coloured) for name in coloured} | dict(colours)
    _draw_parts(axes, parts, rows, coloured, shown, towards)
    ends = _draw_pairs(axes, rows)
    clouds = [np.asarray(part.pose.apply(part.solid.points)) for part in parts]
    frame(axes, seen_from(np.concatenate([*clouds, *ends]), towards), 0.0, towards, unit)
    look: Any = {"frameon": False, "fontsize": "small", "borderaxespad": 0.6}
    figure.legend(handles=bodies_legend(coloured, shown), loc="lower left", ncols=2, **look)
    figure.legend(handles=pairs_legend(rows, unit), loc="lower right", **look)
    return figure


def _draw_parts(
    axes: Any,
    parts: Sequence[PicturedPart],
    rows: Sequence[PairRow],
    coloured: Sequence[str],
    colours: Mapping[str, Any],
    towards: Array,
) -> None:
    met = (Verdict.OVERLAPPING, Verdict.CONTAINED)
    deep = {name for row in rows if row.verdict in met for name in row.names}
    corners, shades, lines = [], [], []
    right, up = across(towards)
    lamp = LIGHT @ np.array([right, towards, up])
    for name, solid, pose in parts:
        points = np.asarray(pose.apply(solid.points))
        upright = (solid.normals @ pose.rotation.T)[solid.triangles].mean(axis=1)
        seen = upright @ towards > 0.0
        lengths = np.maximum(np.linalg.norm(upright[seen], axis=1), np.finfo(float).tiny)
        bright = DARKEST + (1.0 - DARKEST) * np.clip(upright[seen] @ lamp / lengths, 0.0, 1.0)
        colour = colours.get(name, OTHERS)
        opacity = FAINT if name not in coloured else THROUGH if name in deep else 1.0
        shade = bright[:, None] * np.array(to_rgb(colour))
        corners.append(points[solid.triangles][seen])
        shades.append(np.column_stack([shade, np.full(len(shade), opacity)]))
        lines += [np.asarray(pose.apply(line.points)) for line in solid.lines if not line.smooth]
    every = np.concatenate(shades)
    edges = np.where(every[:, 3:] == 1.0, every, 0.0)
    axes.add_collection3d(
        Poly3DCollection(
            np.concatenate(corners), facecolors=every, edgecolors=edges, linewidths=0.3
        )
    )
    axes.add_collection3d(Line3DCollection(lines, colors=EDGE, linewidths=0.35, alpha=0.5))


def _draw_pairs(axes: Any, rows: Sequence[PairRow]) -> list[Array]:
    found = []
    for number, row in enumerate(rows, 1):
        ends = np.array([row.answer.point_a, row.answer.point_b])
        found.append(ends)
        axes.plot(*ends.T, "-o", color="black", linewidth=1.5, markersize=3.5, zorder=ON_TOP)
        spot = axes.text(*ends.mean(axis=0), f" {number}", va="bottom", zorder=ON_TOP + 1, **NUMBER)
        spot.set_path_effects(HALO)
    return found
