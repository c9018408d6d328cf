"""Planar solids in their plane: alone, or two of them with an answer."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np

from standoff.bodies.drawing.body_view import FACE_COLOURS, NORMAL_COLOUR, SEAM_COLOUR
from standoff.bodies.drawing.pair_picture import COLOURS, MARGIN
from standoff.bodies.features import Feature
from standoff.errors import of_extra
from standoff.solids.answer import SolidProximity
from standoff.solids.drawing.marks import draw_marks, marks_legend
from standoff.solids.planar.loops import Loop, points_along
from standoff.typing import Array
from standoff.wording import short_name

with of_extra("matplotlib", "plot"):
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch, PathPatch
    from matplotlib.path import Path


class PlanarDrawing(Protocol):
    """What is drawn of a planar solid."""

    @property
    def loops(self) -> Sequence[Loop]: ...

    @property
    def kinds(self) -> Sequence[str]: ...

    @property
    def n_edges(self) -> int: ...

    @property
    def size(self) -> float: ...


THROUGH = 0.55
"""Opacity: solids may overlap."""

STILL = np.array([1.0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0])

MOST_MARKED = 120
"""Vertices of a solid that are marked: more would hide its outline."""

VERTEX_LOOKS: dict[str, dict[str, Any]] = {
    "convex": {"color": "black", "marker": "o", "markersize": 3.5},
    "reflex": {"color": NORMAL_COLOUR, "marker": "v", "markersize": 5.5},
    "smooth": {"color": SEAM_COLOUR, "marker": "o", "markersize": 4.0, "markerfacecolor": "white"},
}
"""By kind."""


def solid_figure(solid: PlanarDrawing, name: str, unit: str) -> Figure:
    """A planar solid with its vertices by kind."""
    figure = Figure(figsize=(7.5, 7.0), dpi=150)
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0.12, 0.14, 0.84, 0.78))
    cloud = _draw_solid(axes, solid, STILL, (FACE_COLOURS[0], "black"), None)
    _finish(axes, cloud, unit)
    edges = "edge" if solid.n_edges == 1 else "edges"
    loops = "loop" if len(solid.loops) == 1 else "loops"
    told = f"{len(solid.loops)} {loops}, {solid.n_edges} {edges}"
    figure.suptitle(f"{short_name(name)}: {told}", y=0.97)
    figure.legend(
        handles=_vertices_legend(solid),
        loc="lower center",
        ncols=4,
        frameon=False,
        fontsize="small",
    )
    return figure


def pair_figure(
    solids: tuple[PlanarDrawing, PlanarDrawing],
    names: tuple[str, str],
    answer: SolidProximity,
    unit: str,
) -> Figure:
    """Two planar solids where an answer holds."""
    figure = Figure(figsize=(6.4, 6.6), dpi=120)
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0.12, 0.24, 0.84, 0.72))
    features = answer.feature_a, answer.feature_b
    clouds = [
        _draw_solid(axes, solid, pose, colours, feature)
        for solid, pose, colours, feature in zip(
            solids, answer.poses, COLOURS, features, strict=True
        )
    ]
    cloud = np.concatenate(clouds)
    draw_marks(axes, answer, lambda points: points[..., :2], float(np.ptp(cloud, axis=0).max()))
    _finish(axes, cloud, unit)
    handles: list[Artist] = []
    for k, feature in enumerate(features):
        told = f", {feature}" if feature.kind else ""
        label = f"{'AB'[k]}: {short_name(names[k])}{told}"
        handles.append(Patch(facecolor=COLOURS[k][1], edgecolor="none", label=label))
    handles += _vertices_legend(*solids)
    handles += marks_legend(answer, max(solid.size for solid in solids), unit)
    figure.legend(handles=handles, loc="lower center", ncols=2, frameon=False, fontsize="small")
    return figure


def _draw_solid(
    axes: Axes,
    solid: PlanarDrawing,
    pose: Array,
    colours: tuple[str, str],
    active: Feature | None,
) -> Array:
    """Its material, edges and vertices; the points (n, 2) of its outline."""
    R, p = pose[:9].reshape(3, 3)[:2, :2], pose[9:11]
    corners: list[Array] = []
    codes: list[int] = []
    edge = 0
    for loop in solid.loops:
        points = []
        for flat in points_along(loop):
            line = flat[:, :2] @ R.T + p
            chosen = active == Feature("edge", edge)
            width, colour = (2.8, colours[1]) if chosen else (1.1, "black")
            axes.plot(*line.T, color=colour, linewidth=width, zorder=3.5 if chosen else 3.0)
            points.append(line)
            edge += 1
        whole = np.concatenate(points)
        corners += [whole, whole[:1]]
        codes += [int(Path.MOVETO), *[int(Path.LINETO)] * (len(whole) - 1), int(Path.CLOSEPOLY)]
    outline = np.concatenate(corners)
    # holes run the other way round, so they stay empty
    look: dict[str, Any] = {"facecolor": colours[0], "edgecolor": "none", "alpha": THROUGH}
    axes.add_patch(PathPatch(Path(outline, codes), zorder=1.0, **look))
    if solid.n_edges <= MOST_MARKED:
        for spot, kind in zip(_vertices(solid) @ R.T + p, solid.kinds, strict=True):
            axes.plot(*spot, linestyle="", zorder=4.0, **VERTEX_LOOKS[kind])
    return outline


def _vertices(solid: PlanarDrawing) -> Array:
    """(n, 2): vertex k is where edge k begins."""
    return np.array(
        [
            curve.point(curve.last if backward else curve.first)[:2]
            for loop in solid.loops
            for curve, backward in zip(loop.curves, loop.backward, strict=True)
        ]
    )


def _vertices_legend(*solids: PlanarDrawing) -> list[Artist]:
    kinds = {kind for s in solids if s.n_edges <= MOST_MARKED for kind in s.kinds}
    return [
        Line2D([], [], linestyle="", label=f"{kind} vertex", **look)
        for kind, look in VERTEX_LOOKS.items()
        if kind in kinds
    ]


def _finish(axes: Axes, cloud: Array, unit: str) -> None:
    low, high = cloud.min(axis=0), cloud.max(axis=0)
    margin = MARGIN * float((high - low).max())
    axes.set_aspect("equal", adjustable="box")
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin, high[1] + margin)
    axes.set_xlabel(f"x ({unit})" if unit else "x")
    axes.set_ylabel(f"y ({unit})" if unit else "y")
    axes.grid(alpha=0.3)
