"""Drawing used by several figures: planar bodies with their features, and witness lines."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch

from standoff.bodies import Body
from standoff.motion import Pose
from standoff.tracking import Feature
from standoff.typing import Array
from standoff_studies.paper import style

Spot = tuple[float, float]
"""A place in a picture."""

CURVE_SAMPLES = 65
"""Points of a drawn curve: its chords differ from it by less than a line's width."""


def short_name(feature: Feature) -> str:
    """Return the name of a planar body's feature in pictures, such as C0 (curve) or V0 (vertex)."""
    return f"{'V' if feature.kind == 'vertex' else 'C'}{feature.index}"


def planar_features(body: Body) -> tuple[Feature, ...]:
    """Return the features of a loop in its order: vertex 0, curve 0, vertex 1, and so on.

    Raises
    ------
    ValueError
        If curve i of the body does not go from vertex i to the next.
    """
    for index, edge in enumerate(body.edge_parts):
        if (edge.first, edge.last) != (index, (index + 1) % body.n_edges):
            raise ValueError(f"{body.name}: edge {index} does not begin at vertex {index}.")
    kinds = ("vertex", "edge")
    return tuple(Feature(kind, index) for index in range(body.n_edges) for kind in kinds)


def curve_points(
    body: Body, edge: int, pose: Pose | None = None, count: int = CURVE_SAMPLES
) -> Array:
    """Return points along a curve of a planar body, world x and y [length], shape (count, 2)."""
    curve = body.edge_parts[edge].curve
    points = [curve.point(t) for t in np.linspace(curve.first, curve.last, count)]
    return placed(np.array(points), pose)


def outline(body: Body, pose: Pose | None = None) -> Array:
    """Return points around a planar body, world x and y [length], shape (n, 2)."""
    return np.vstack([curve_points(body, edge, pose) for edge in range(body.n_edges)])


def placed(points: Array, pose: Pose | None = None) -> Array:
    """Return body points (n, 3) as world x and y (n, 2)."""
    world = points if pose is None else points @ pose.rotation.T + pose.translation
    return np.asarray(world[:, :2])


def draw_planar_body(
    axes: Axes, body: Body, pose: Pose | None = None, *, colour: str, **line: Any
) -> None:
    """Draw a planar body: its outline, a light fill, a dot at each vertex; equal axes are set.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    body : Body
    pose : Pose, optional
        Its pose in the world; the identity by default.
    colour : str
    **line
        Options of matplotlib's ``Axes.plot`` for the outline.
    """
    around = outline(body, pose)
    axes.fill(around[:, 0], around[:, 1], color=colour, alpha=0.12, linewidth=0.0)
    axes.plot(around[:, 0], around[:, 1], color=colour, **line)
    corners = placed(np.asarray(body.vertex_points), pose)
    axes.plot(corners[:, 0], corners[:, 1], "o", color=colour, markersize=3.5)
    axes.set_aspect("equal")


def draw_feature(
    axes: Axes, body: Body, feature: Feature, pose: Pose | None = None, *, colour: str
) -> None:
    """Highlight an active feature: its curve as a thick line, or its vertex as a square."""
    if feature.kind == "vertex":
        corner = placed(np.asarray(body.vertex_points)[feature.index : feature.index + 1], pose)
        axes.plot(corner[:, 0], corner[:, 1], "s", color=colour, markersize=7.0, zorder=4)
        return
    points = curve_points(body, feature.index, pose)
    axes.plot(points[:, 0], points[:, 1], color=colour, linewidth=3.2, zorder=3)


def name_features(
    axes: Axes,
    body: Body,
    pose: Pose | None = None,
    *,
    inset: float,
    prefix: str = "",
    features: Sequence[Feature] | None = None,
    **text: Any,
) -> None:
    """Write the names of a planar body's features inside it, along their inward normals.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    body : Body
    pose : Pose, optional
    inset : float
        Distance from the feature to the middle of its name [length]; outside if negative.
    prefix : str
        Before each name, such as the body's letter.
    features : sequence of Feature, optional
        The features to name; all by default.
    **text
        Options of matplotlib's ``Axes.text``.
    """
    for feature in planar_features(body) if features is None else features:
        point, inward = _place(body, feature)
        x, y = placed(np.array([point + inset * inward]), pose)[0].tolist()
        axes.text(x, y, prefix + short_name(feature), ha="center", va="center", **text)


def draw_witness_line(axes: Axes, point_a: Array, point_b: Array, **line: Any) -> None:
    """Draw the segment between two witness points, each marked with a dot."""
    ends = np.array([point_a, point_b])
    look: dict[str, Any] = {"color": style.BLACK, "linewidth": 1.2, "markersize": 3.5, "zorder": 5}
    look |= line
    axes.plot(ends[:, 0], ends[:, 1], "o-", **look)


def show_plane(axes: Axes, half: float) -> None:
    """Show the square of this half width around the origin [length], without a grid."""
    axes.grid(visible=False)
    axes.set(xlim=(-half, half), ylim=(-half, half), xlabel="x [length]", ylabel="y [length]")


def draw_arrow(axes: Axes, start: Spot, end: Spot, **look: Any) -> None:
    """Draw an arrow; `look` are options of matplotlib's ``FancyArrowPatch``."""
    usual: dict[str, Any] = {"arrowstyle": "-|>", "shrinkA": 0.0, "shrinkB": 0.0}
    usual |= {"mutation_scale": 11.0, "zorder": 2}
    axes.add_patch(FancyArrowPatch(start, end, **(usual | look)))


def draw_box(
    axes: Axes, middle: Spot, half: tuple[float, float], rounding: float, **look: Any
) -> None:
    """Draw a box with round corners; `look` are options of matplotlib's ``FancyBboxPatch``."""
    (x, y), (width, height) = middle, half
    shape = f"round,pad=0,rounding_size={rounding:g}"
    axes.add_patch(
        FancyBboxPatch(
            (x - width, y - height), 2.0 * width, 2.0 * height, boxstyle=shape, zorder=3, **look
        )
    )


def _place(body: Body, feature: Feature) -> tuple[Array, Array]:
    """A point of a feature and the inward unit normal there; body frame."""
    if feature.kind == "edge":
        curve = body.edge_parts[feature.index].curve
        point, tangent, _ = curve.jet(0.5 * (curve.first + curve.last))
        return point, _unit(np.array([-tangent[1], tangent[0], 0.0]))
    after = body.edge_parts[feature.index].curve
    before = body.edge_parts[feature.index - 1].curve
    outwards = _unit(after.jet(after.first)[1]), -_unit(before.jet(before.last)[1])
    return np.asarray(body.vertex_points)[feature.index], _unit(outwards[0] + outwards[1])


def _unit(vector: Array) -> Array:
    return np.asarray(vector / np.linalg.norm(vector))
