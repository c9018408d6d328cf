"""A body as one picture: faces, edges, vertices, smooth seams and outward normals."""

from __future__ import annotations

import numpy as np

from standoff.bodies.drawing.body_view import (
    FACE_COLOURS,
    NORMAL_COLOUR,
    NORMAL_LENGTH,
    SEAM_COLOUR,
    SKIN_COLOUR,
    VIEWS,
    Parts,
    Space,
    direction_to_viewer,
    draw_view,
    shows,
)
from standoff.bodies.packed_parts import PackedParts
from standoff.bodies.report import BodyReport, BoundaryReport
from standoff.bodies.tessellation import edge_lines, face_meshes
from standoff.errors import of_extra

with of_extra("matplotlib", "plot"):
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch


def draw_body(
    body: PackedParts, report: BodyReport | BoundaryReport, name: str, unit: str
) -> Figure:
    """Draw a body from two opposite sides, or in its plane.

    Parameters
    ----------
    body : Body or Boundary
    report : BodyReport or BoundaryReport
        What its construction found.
    name : str
        The name by which it is known in the title.
    unit : str
        Unit of length for labels; empty for none.
    """
    parts = Parts(body, face_meshes(body), edge_lines(body))
    planar = body.dimension == 2
    # Not through pyplot, which would need a display and keep the figure alive.
    views = [] if planar else [view for view in VIEWS if shows(parts, direction_to_viewer(view))]
    figure = Figure(figsize=(7.5, 7.0) if planar else (6.0 * len(views), 6.4), dpi=150)
    FigureCanvasAgg(figure)
    if planar:
        _draw_planar(figure.add_axes((0.12, 0.14, 0.84, 0.78)), parts, unit)
    for k, view in enumerate(views):
        box = (k / len(views), 0.07, 1.0 / len(views), 0.86)
        axes: Space = figure.add_axes(box, projection="3d", computed_zorder=False)
        draw_view(axes, parts, view, unit)
    figure.suptitle(_title(body, report, name), y=0.97)
    figure.legend(
        handles=_legend(parts),
        loc="lower center",
        ncols=6,
        frameon=False,
        fontsize="small",
    )
    return figure


def _title(body: PackedParts, report: BodyReport | BoundaryReport, name: str) -> str:
    counts = [(report.faces, "face", "faces"), (report.edges, "edge", "edges")]
    counts += [(report.vertices, "vertex", "vertices")]
    told = [f"{n} {one if n == 1 else many}" for n, one, many in counts if n]
    smooth = report.smooth_edges if isinstance(report, BodyReport) else 0
    if smooth:
        told[1] += f" ({smooth} smooth)"
    known = name if name == body.name else f"{name}: {body.name}"
    part = "" if body.bounded else "; unbounded, only a part is shown"
    return f"{known}, {', '.join(told)}{part}"


def _legend(parts: Parts) -> list[Artist]:
    handles: list[Artist] = []
    if parts.meshes:
        handles.append(Patch(facecolor=FACE_COLOURS[0], edgecolor="none", label="face"))
    if any(not line.smooth for line in parts.lines):
        handles.append(Line2D([], [], color="black", linewidth=1.6, label="edge"))
    if any(line.smooth for line in parts.lines):
        seam = Line2D([], [], color=SEAM_COLOUR, linewidth=1.4, dashes=(3, 2), label="smooth seam")
        handles.append(seam)
    if parts.body.n_vertices:
        dot = Line2D([], [], color="black", marker="o", linestyle="none", label="vertex")
        handles.append(dot)
    if parts.meshes or parts.body.dimension == 2:
        arrow = Line2D([], [], color=NORMAL_COLOUR, linewidth=1.2, label="outward normal")
        handles.append(arrow)
    if parts.body.radius:
        label = f"skin at radius {parts.body.radius:.4g}"
        handles.append(Patch(facecolor=SKIN_COLOUR, alpha=0.25, label=label))
    return handles


def _draw_planar(axes: Axes, parts: Parts, unit: str) -> None:
    """A planar body in its plane."""
    outline = np.concatenate([line.points[:, :2] for line in parts.lines])
    axes.fill(*outline.T, color=FACE_COLOURS[0], alpha=0.5)
    length = NORMAL_LENGTH * parts.size
    for line in parts.lines:
        axes.plot(*line.points[:, :2].T, color="black", linewidth=1.6)
        points, normals = line.points[6:-1:12, :2], line.normals[0, 6:-1:12, :2]
        axes.update_datalim(points + length * normals)
        axes.quiver(
            *points.T,
            *(length * normals).T,
            color=NORMAL_COLOUR,
            angles="xy",
            scale_units="xy",
            scale=1.0,
            width=0.003,
        )
        middle = len(line.points) // 2
        spot = line.points[middle, :2] - 0.5 * length * line.normals[0, middle, :2]
        axes.annotate(
            f"edge {line.edge}", (spot[0], spot[1]), ha="center", va="center", fontsize="small"
        )
    for number, point in enumerate(parts.body.vertex_points):
        axes.plot(*point[:2], "o", color="black", markersize=5.0)
        inward = outline.mean(axis=0) - point[:2]
        spot = point[:2] + 0.6 * length * inward / np.linalg.norm(inward)
        axes.annotate(
            f"vertex {number}", (spot[0], spot[1]), ha="center", va="center", fontsize="small"
        )
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.06)
    axes.autoscale_view()
    axes.set_xlabel(f"x ({unit})" if unit else "x")
    axes.set_ylabel(f"y ({unit})" if unit else "y")
    axes.grid(alpha=0.3)
