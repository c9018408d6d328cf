"""Drawing of Voronoi regions: a planar body's lines inside and outside, surfaces in space."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from standoff.bodies.voronoi import VoronoiRegions
from standoff.motion import Pose
from standoff.typing import Array
from standoff_studies.paper import style
from standoff_studies.paper.drawing import placed
from standoff_studies.paper.drawing_3d import View, posed

PIECES = 8
"""Pieces of a surface along its rays, sorted with what is in front and behind when painted."""


def draw_planar_regions(
    axes: Axes,
    regions: VoronoiRegions,
    pose: Pose | None = None,
    *,
    reach: float | None = None,
    colour: str = style.QUIET,
    inside: bool = True,
    label: str = "",
    **line: Any,
) -> None:
    """Draw what separates a planar body's regions: dashed rays outside, dash-dotted lines inside.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    regions : VoronoiRegions
        Of a planar body.
    pose : Pose, optional
        Pose of the body in the world; the identity by default.
    reach : float, optional
        Length of the rays; the regions' own by default.
    colour : str
    inside : bool
        Draw the medial axis too?
    label : str
        Before "external lines" and "medial axis" in a legend; no legend if empty.
    **line
        Options of matplotlib's ``Axes.plot``, for both.
    """
    look: dict[str, Any] = {"color": colour, "linewidth": 1.1, "zorder": 1.9} | line
    length = regions.reach if reach is None else reach
    rays = [placed(ray.grid(length)[0], pose) for ray in regions.external]
    branches = [placed(branch.points, pose) for branch in regions.medial_axis] if inside else []
    for lines, dashes, name in ((rays, "--", "external lines"), (branches, "-.", "medial axis")):
        words = f"{label} {name}".strip() if label else "_"
        for k, points in enumerate(lines):
            marker = {"marker": "."} if len(points) == 1 else {}
            axes.plot(
                points[:, 0],
                points[:, 1],
                linestyle=dashes,
                label=words if k == 0 else "_",
                **(look | marker),
            )
    axes.set_aspect("equal")


def draw_space_regions(
    view: View,
    regions: VoronoiRegions,
    pose: Pose | None = None,
    *,
    reach: float | None = None,
    colours: tuple[str, str] = (style.ORANGE, style.BLUE),
    opacity: float = 0.35,
) -> None:
    """Add the surfaces between a spatial body's regions, translucent, with a line around each.

    Parameters
    ----------
    view : View
    regions : VoronoiRegions
        Of a spatial body.
    pose : Pose, optional
        The identity by default.
    reach : float, optional
        Length of the rays; the regions' own by default.
    colours : (str, str)
        Of surfaces along edges, and of sectors and fans at vertices.
    opacity : float
    """
    sheets = region_sheets(regions, regions.reach if reach is None else reach)
    for boundary, sheet in zip(regions.external, sheets, strict=True):
        points = posed(sheet, pose)
        at_vertex = boundary.features[1].kind == "vertex"
        colour = colours[1] if at_vertex else colours[0]
        view.surface(points, colour, opacity=opacity, shaded=False)
        rim = [points[:, -1]] if at_vertex else [points[:, -1], points[0], points[-1]]
        for line in rim:
            view.line(line, colour, 1.0)


def region_sheets(regions: VoronoiRegions, reach: float) -> list[Array]:
    """Return points (n, m, 3), body frame, on each of the surfaces between external regions."""
    shares = np.linspace(0.0, 1.0, PIECES + 1)[:, None]
    grids = [boundary.grid(reach) for boundary in regions.external]
    return [grid[:, None, 0] + shares * (grid[:, None, 1] - grid[:, None, 0]) for grid in grids]
