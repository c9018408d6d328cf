"""Solids in space as one picture: alone from two sides, or two of them with an answer."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from standoff.bodies.boundary import Boundary, EdgeKind
from standoff.bodies.drawing.body_view import FACE_COLOURS, VIEWS, round_length
from standoff.bodies.drawing.pair_picture import COLOURS, USUAL_VIEW
from standoff.bodies.features import Feature
from standoff.errors import of_extra
from standoff.solids.answer import SolidProximity
from standoff.solids.drawing.camera import Camera, camera_on, visible
from standoff.solids.drawing.marks import draw_marks, has_places, marks_legend
from standoff.solids.drawing.skin import (
    Skin,
    draw_edges,
    draw_image,
    edges_legend,
    painted,
    raster_of,
    skin_of,
)
from standoff.typing import Array
from standoff.wording import short_name

with of_extra("matplotlib", "plot"):
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

STILL = np.array([1.0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0])

THROUGH = 0.5
"""Opacity of what hides nearest points, or is in an overlap."""

LOOKED_AT = 120
"""Pixels of a picture that is only made to see what is hidden."""

LONG_ENOUGH = 0.8
"""Fraction of its length at which a line between nearest points is seen well."""

WORTH_IT = 0.05
"""By how much a view must be better than one nearer to the usual."""

SHORT_AXIS = 0.45
"""An axis of which the viewer sees less than this fraction, or nearer to another one, is not
named."""

LEGEND_ROW = 0.035
"""Height of a row of the legend, as a fraction of the figure."""


def solid_figure(boundary: Boundary, name: str, unit: str) -> Figure:
    """A solid from two opposite sides."""
    skin = skin_of(boundary, STILL)
    figure = Figure(figsize=(12.0, 6.4), dpi=150)
    FigureCanvasAgg(figure)
    for k, view in enumerate(VIEWS):
        axes = figure.add_axes((0.5 * k, 0.09, 0.5, 0.8))
        camera = camera_on(skin.cloud, view)
        raster = raster_of(camera, [skin])
        image = painted(camera, skin, raster, (FACE_COLOURS[0], FACE_COLOURS[0]), None)
        draw_image(axes, camera, image)
        draw_edges(axes, camera, skin, raster, (None, ""))
        finish(axes, camera, unit)
        axes.set_title(f"seen from azimuth {view[1]:g}°, elevation {view[0]:g}°", fontsize="small")
    figure.suptitle(_title(boundary, name), y=0.97)
    handles = edges_legend([skin])
    figure.legend(handles=handles, loc="lower center", ncols=5, frameon=False, fontsize="small")
    return figure


def _title(boundary: Boundary, name: str) -> str:
    kinds = boundary.edge_kinds
    told = [f"{boundary.n_faces} faces", f"{boundary.n_edges} edges"]
    counts = [(kind, kinds.count(kind)) for kind in EdgeKind]
    if boundary.n_edges:
        told[1] += f" ({', '.join(f'{n} {kind}' for kind, n in counts if n)})"
    return f"{short_name(name)}: {', '.join(told)}, {boundary.n_vertices} vertices"


class Pictured(NamedTuple):
    """One solid of a picture.

    Attributes
    ----------
    boundary : Boundary
    name : str
    frame : (12,) array
        World pose of the boundary's frame: R by rows, p.
    part : Feature
        Of the boundary, that is marked.
    """

    boundary: Boundary
    name: str
    frame: Array
    part: Feature


def pair_figure(
    solids: tuple[Pictured, Pictured],
    answer: SolidProximity,
    view: tuple[float, float] | None,
    unit: str,
) -> Figure:
    """Two solids where an answer holds."""
    skins = [skin_of(solid.boundary, solid.frame) for solid in solids]
    chosen = _best_view(skins, answer) if view is None else view
    camera = camera_on(np.concatenate([skin.cloud for skin in skins]), chosen)
    names = solids[0].name, solids[1].name
    handles = [*_solids_legend(names, answer), *edges_legend(skins)]
    size = solids[0].boundary.size + solids[1].boundary.size
    handles += marks_legend(answer, size, unit)
    rows = -(-len(handles) // 2)
    figure = Figure(figsize=(6.4, 6.0 + 6.4 * LEGEND_ROW * rows), dpi=120)
    FigureCanvasAgg(figure)
    low = LEGEND_ROW * (rows + 0.6)
    axes = figure.add_axes((0.02, low, 0.96, 0.98 - low))
    _draw_skins(axes, camera, skins, answer, (solids[0].part, solids[1].part))
    draw_marks(axes, answer, camera.flat, camera.wide)
    finish(axes, camera, unit)
    figure.legend(handles=handles, loc="lower center", ncols=2, frameon=False, fontsize="small")
    return figure


def _best_view(skins: Sequence[Skin], answer: SolidProximity) -> tuple[float, float]:
    """Of some views around the solids the one that shows what is marked, and shows the nearest
    points side by side; the usual one if all are alike."""
    cloud = np.concatenate([skin.cloud for skin in skins])
    marks, best, chosen = _marked(answer), -np.inf, USUAL_VIEW
    for elevation in (USUAL_VIEW[0], -USUAL_VIEW[0], 2.0 * USUAL_VIEW[0]):
        for azimuth in np.arange(0.0, 360.0, 45.0):
            view = elevation, float(USUAL_VIEW[1] + azimuth)
            camera = camera_on(cloud, view, LOOKED_AT)
            worth = 0.0
            if len(marks):
                shown = visible(camera, raster_of(camera, skins), marks)
                worth = 2.0 * float(shown.mean())
            if np.isfinite(answer.normal).all():
                worth += min(float(np.linalg.norm(camera.flat(answer.normal))), LONG_ENOUGH)
            if worth > best + WORTH_IT:
                best, chosen = worth, view
    return chosen


def _draw_skins(
    axes: Axes,
    camera: Camera,
    skins: Sequence[Skin],
    answer: SolidProximity,
    features: tuple[Feature, Feature],
) -> None:
    """As one scene; or, where that would hide what is marked, each through the other."""
    alone = [raster_of(camera, [skin]) for skin in skins]
    images = [
        painted(camera, skin, raster, colours, feature)
        for skin, raster, colours, feature in zip(skins, alone, COLOURS, features, strict=True)
    ]
    both = raster_of(camera, skins)
    a_in_front = (alone[0].depth >= alone[1].depth)[..., None]
    front = np.where(a_in_front, images[0], images[1])
    behind = np.where(a_in_front, images[1], images[0])
    marks = _marked(answer)
    through = bool(len(marks)) and not visible(camera, both, marks).all()
    draw_image(axes, camera, _blended(front, behind) if through else front)
    for skin, own, feature, (_, strong) in zip(skins, alone, features, COLOURS, strict=True):
        draw_edges(axes, camera, skin, own if through else both, (feature, strong))


def _marked(answer: SolidProximity) -> Array:
    """Points (n, 3) that are to be seen."""
    found = [point for pair in answer.minima for point in (pair.point_a, pair.point_b)]
    if answer.continuum is not None:
        found += [point for ends in answer.continuum.ends for point in ends]
    if answer.overlap is not None:
        found = [*(found if has_places(answer) else ()), answer.overlap.common_point]
    return np.array(found).reshape(-1, 3)


def _blended(front: Array, behind: Array) -> Array:
    """A picture through which another one is seen."""
    white = np.ones(3)
    under = behind[..., 3:] * (THROUGH * behind[..., :3] + (1.0 - THROUGH) * white)
    under = under + (1.0 - behind[..., 3:]) * white
    seen = front[..., 3:]
    colour = seen * (THROUGH * front[..., :3] + (1.0 - THROUGH) * under) + (1.0 - seen) * under
    return np.concatenate([colour, np.maximum(front[..., 3:], behind[..., 3:])], axis=2)


def _solids_legend(names: tuple[str, str], answer: SolidProximity) -> list[Artist]:
    handles: list[Artist] = []
    for k, feature in enumerate((answer.feature_a, answer.feature_b)):
        told = f", {feature}" if feature.kind else ""
        label = f"{'AB'[k]}: {short_name(names[k])}{told}"
        handles.append(Patch(facecolor=COLOURS[k][1], edgecolor="none", label=label))
    return handles


def finish(axes: Axes, camera: Camera, unit: str) -> None:
    """Equal scales, no frame; the axes' directions and a scale in the corners."""
    axes.set_aspect("equal")
    axes.set_axis_off()
    wide = camera.wide
    arm, foot = 0.05 * wide, 0.05 * wide
    spot = camera.low - np.array([0.0, foot])
    look: dict[str, Any] = {"fontsize": "small", "ha": "center", "va": "center"}
    named: list[Array] = []
    for name, way in zip("xyz", camera.axes[:2].T, strict=True):
        axes.plot(*np.stack([spot, spot + arm * way]).T, color="black", linewidth=1.0)
        clear = all(np.linalg.norm(way - other) > SHORT_AXIS for other in named)
        if clear and np.linalg.norm(way) > SHORT_AXIS:
            named.append(way)
            x, y = spot + 1.4 * arm * way
            axes.text(x, y, name, **look)
    length = round_length(0.5 * wide)
    end = np.array([camera.high[0], camera.low[1] - foot])
    axes.plot([end[0] - length, end[0]], [end[1], end[1]], color="black", linewidth=2.0)
    scale = f"{length:g} {unit}".rstrip()
    axes.text(end[0] - 0.5 * length, end[1] + 0.02 * wide, scale, fontsize="small", ha="center")
    axes.set_xlim(camera.low[0] - 2.0 * arm, camera.high[0] + 0.5 * arm)
    axes.set_ylim(camera.low[1] - foot - 1.5 * arm, camera.high[1])
