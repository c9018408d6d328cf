"""Two bodies with their witness points, in space or in their plane, as one picture."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from standoff.bodies.drawing.body_view import Space, across, direction_to_viewer, frame
from standoff.bodies.drawing.solids import Look, PictureSurface, draw_solid
from standoff.bodies.features import Feature
from standoff.bodies.plain_data import without_roundoff
from standoff.errors import of_extra
from standoff.typing import Array
from standoff.wording import short_name

with of_extra("matplotlib", "plot"):
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

# Light and strong shades of Okabe and Ito's blue and vermilion, distinct with any colour vision.
COLOURS = (("#BBDFF5", "#4FA8DC"), ("#F8D2AE", "#EE8A3C"))
WITNESS_COLOUR = "black"

USUAL_VIEW = (25.0, -50.0)
"""Elevation and azimuth [degrees] from which a view across the normal is derived."""

LEVEL_ENOUGH = 0.35
"""Least length of the usual view's component perpendicular to the normal; if it is shorter, the
view a quarter turn further about z is used instead."""

MARGIN = 0.03
"""Margin around a planar picture, as a fraction of its extent."""

SURROUND = 0.12
"""Margin around a picture in space, as a fraction of its half width: for the axes and the scale."""

ACROSS = 0.15
"""Greatest component of the normal towards the viewer with which nothing hides the witness line."""

ABOVE_PLANE = 0.4
"""Tangent of the angle from which the plane of a half-space is seen."""

BETWEEN = 2.5
"""Drawing order of the witness line: after the body behind, before the one in front."""

THROUGH = 0.55
"""Opacity of bodies that overlap."""


class DrawnAnswer(NamedTuple):
    """An answer to be drawn: flat poses (12,), world vectors (3,), signed distance."""

    poses: tuple[Array, Array]
    points: tuple[Array, Array]
    normal: Array
    distance: float
    features: tuple[Feature, Feature]
    status: str


def new_figure() -> Figure:
    # Not through pyplot, which would need a display and keep the figure alive.
    figure = Figure(figsize=(6.4, 6.0), dpi=120)
    FigureCanvasAgg(figure)
    return figure


def axes_of(figure: Figure, planar: bool) -> Any:
    if planar:
        return figure.add_axes((0.12, 0.2, 0.84, 0.72))
    return figure.add_axes((0.0, 0.12, 1.0, 0.82), projection="3d", computed_zorder=False)


def view_across(normal: Array) -> tuple[float, float]:
    """Elevation and azimuth [degrees] from which the witness line is seen in its full length."""
    towards = direction_to_viewer(USUAL_VIEW)
    if not np.isfinite(normal).all():
        return USUAL_VIEW
    level = towards - (towards @ normal) * normal
    if np.linalg.norm(level) < LEVEL_ENOUGH:
        towards = direction_to_viewer((USUAL_VIEW[0], USUAL_VIEW[1] + 90.0))
        level = towards - (towards @ normal) * normal
    return angles_of(level)


def angles_of(towards: Array) -> tuple[float, float]:
    """Elevation and azimuth [degrees] of a direction to the viewer."""
    towards = towards / np.linalg.norm(towards)
    elevation = np.degrees(np.arcsin(np.clip(towards[2], -1.0, 1.0)))
    return float(elevation), float(np.degrees(np.arctan2(towards[1], towards[0])))


def cloud_of(solids: tuple[PictureSurface, PictureSurface], shown: DrawnAnswer) -> Array:
    """World points of both bodies, (n, 3); beside a half-space, of the other and both witnesses."""
    placed = [
        solid.points @ pose[:9].reshape(3, 3).T + pose[9:]
        for solid, pose in zip(solids, shown.poses, strict=True)
        if solid.body.bounded
    ]
    return np.concatenate([*placed, *([] if len(placed) == 2 else [shown.points])])


def seen_from(cloud: Array, towards: Array) -> Array:
    """Two points, (2, 3), whose ball, for the viewer, surrounds all points of a cloud, (n, 3)."""
    axes = np.stack([*across(towards), towards])
    seen = cloud @ axes.T
    middle = 0.5 * (seen.min(axis=0) + seen.max(axis=0))
    half = (1.0 + SURROUND) * float(np.ptp(seen[:, :2], axis=0).max()) / 2.0
    ends = middle + half * np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]])
    return np.asarray(ends @ axes)


def draw_pair(
    axes: Space,
    solids: tuple[PictureSurface, PictureSurface],
    shown: DrawnAnswer,
    view: tuple[float, float],
    cloud: Array,
    unit: str,
) -> None:
    """Draw two solids at their poses with the witness line, in equal scales around a cloud."""
    if solids[0].body.dimension == 2:
        _draw_planar(axes, solids, shown, cloud, unit)
        return
    axes.view_init(*view)
    axes.set_proj_type("ortho")
    towards = direction_to_viewer(view)
    # A plane separates the two bodies, so one of them is entirely in front of the other.
    b_in_front = not shown.normal @ towards < 0.0
    orders = (1, 3) if b_in_front else (3, 1)
    opacity = THROUGH if shown.distance < 0.0 else 1.0
    for k, solid in enumerate(solids):
        look = Look(*COLOURS[k], orders[k], opacity)
        draw_solid(axes, solid, shown.poses[k], towards, look, shown.features[k])
    _draw_witnesses(axes, shown, hidden=abs(float(shown.normal @ towards)) > ACROSS)
    frame(axes, seen_from(cloud, towards), 0.0, towards, unit)


def _draw_witnesses(axes: Space, shown: DrawnAnswer, *, hidden: bool) -> None:
    """Draw the witness line on top; the part that the body in front hides is dashed."""
    ends = np.array(shown.points).T
    look = {"color": WITNESS_COLOUR, "marker": "o", "markersize": 4.5}
    if not hidden or shown.distance < 0.0:
        axes.plot(*ends, linewidth=1.6, zorder=6, **look)
        return
    axes.plot(*ends, linewidth=1.6, zorder=BETWEEN, **look)
    thin = look | {"markersize": 2.5}
    axes.plot(*ends, linewidth=0.9, linestyle=(0, (2, 2)), zorder=6, **thin)


def _draw_planar(
    axes: Axes,
    solids: tuple[PictureSurface, PictureSurface],
    shown: DrawnAnswer,
    cloud: Array,
    unit: str,
) -> None:
    for k, (solid, pose) in enumerate(zip(solids, shown.poses, strict=True)):
        rotation, shift = pose[:9].reshape(3, 3), pose[9:]
        colour, strong = COLOURS[k]
        lines = [(line.edge, line.points @ rotation.T + shift) for line in solid.lines]
        if lines:
            axes.fill(*np.concatenate([p for _, p in lines])[:, :2].T, color=colour, alpha=THROUGH)
        for edge, points in lines:
            chosen = shown.features[k] == Feature("edge", edge)
            width = 2.6 if chosen else 1.0
            axes.plot(*points[:, :2].T, color=strong if chosen else "black", linewidth=width)
    ends = np.array(shown.points)[:, :2]
    axes.plot(*ends.T, "-o", color=WITNESS_COLOUR, linewidth=1.6, markersize=4.5)
    axes.set_aspect("equal", adjustable="box")
    low, high = cloud.min(axis=0), cloud.max(axis=0)
    margin = MARGIN * float((high - low).max())
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin, high[1] + margin)
    axes.set_xlabel(f"x ({unit})" if unit else "x")
    axes.set_ylabel(f"y ({unit})" if unit else "y")
    axes.grid(alpha=0.3)


def legend_of(
    solids: tuple[PictureSurface, PictureSurface], shown: DrawnAnswer, unit: str
) -> list[Artist]:
    """Entries that name the bodies, their active features, and the distance."""
    handles: list[Artist] = []
    for k, solid in enumerate(solids):
        feature = f", {shown.features[k]}" if shown.features[k].kind else ""
        label = f"{'AB'[k]}: {short_name(solid.body.name)}{feature}"
        handles.append(Patch(facecolor=COLOURS[k][1], edgecolor="none", label=label))
    if not np.isfinite(shown.distance):  # no witness line is drawn
        return [*handles, Line2D([], [], linestyle="", label=f"no distance, {shown.status}")]
    size = max([body.size for body in (s.body for s in solids) if body.bounded], default=0.0)
    (distance,) = without_roundoff([shown.distance], size)
    told = f"depth {-distance:.6g}" if distance < 0.0 else f"distance {distance:.6g}"
    line = Line2D([], [], color=WITNESS_COLOUR, marker="o", markersize=4.5, linewidth=1.6)
    line.set_label(f"{told} {unit}".rstrip() + f", {shown.status}")
    return [*handles, line]


def pair_figure(
    solids: tuple[PictureSurface, PictureSurface],
    shown: DrawnAnswer,
    view: tuple[float, float] | None,
    unit: str,
) -> Figure:
    """Return the picture of two bodies and an answer."""
    figure = new_figure()
    axes = axes_of(figure, solids[0].body.dimension == 2)
    chosen = _usual_view(solids, shown) if view is None else view
    draw_pair(axes, solids, shown, chosen, cloud_of(solids, shown), unit)
    add_legend(figure, solids, shown, unit)
    return figure


def _usual_view(
    solids: tuple[PictureSurface, PictureSurface], shown: DrawnAnswer
) -> tuple[float, float]:
    """Across the normal; of a half-space somewhat from above its plane, which is else a line."""
    view = view_across(shown.normal)
    towards = direction_to_viewer(view)
    for solid, sign in zip(solids, (1.0, -1.0), strict=True):
        if not solid.body.bounded and np.isfinite(shown.normal).all():
            towards = towards + sign * ABOVE_PLANE * shown.normal
    return angles_of(towards)


def add_legend(
    figure: Figure, solids: tuple[PictureSurface, PictureSurface], shown: DrawnAnswer, unit: str
) -> None:
    figure.legend(
        handles=legend_of(solids, shown, unit),
        loc="lower center",
        ncols=2,
        frameon=False,
        fontsize="small",
    )
