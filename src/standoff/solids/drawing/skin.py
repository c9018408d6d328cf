"""A solid in space as it is drawn: its shaded faces, and its edges by their kinds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.boundary import Boundary, EdgeKind
from standoff.bodies.drawing.body_view import NORMAL_COLOUR, SEAM_COLOUR
from standoff.bodies.drawing.solids import solid_of
from standoff.bodies.features import Feature
from standoff.bodies.tessellation import EdgeLine
from standoff.errors import of_extra
from standoff.solids.drawing.camera import Camera, Raster, brightness, rastered, visible
from standoff.typing import Array

with of_extra("matplotlib", "plot"):
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.colors import to_rgb
    from matplotlib.lines import Line2D

EDGE_LOOKS: dict[str, dict[str, Any]] = {
    EdgeKind.CONVEX: {"color": "black", "linewidth": 1.1},
    EdgeKind.REFLEX: {"color": NORMAL_COLOUR, "linewidth": 1.8},
    EdgeKind.MIXED: {"color": "#882255", "linewidth": 1.8, "linestyle": (0, (6, 2))},
    EdgeKind.SMOOTH: {"color": SEAM_COLOUR, "linewidth": 0.9, "linestyle": (0, (3, 2))},
}
"""By kind: colours that can be told apart with any colour vision, and by their dashes."""

EDGE_ORDER, ACTIVE_ORDER = 3.0, 3.5

AWAY = -0.3
"""Component towards the viewer of a mean of normals: below it a triangle faces away, even one that
an outline crosses."""

SPECK = 7.0
"""Pixels: a shorter run of an edge between hidden ones is not drawn."""

FINEST = 16
"""Points between two of an edge, so that it ends where it is hidden."""


@dataclass(frozen=True)
class Skin:
    """A solid's surface at a pose, world axes.

    Attributes
    ----------
    corners : (n, 3, 3) array
        Of its triangles.
    normals : (n, 3) array
    faces : (n,) array of int
        The face to which each triangle belongs.
    lines : sequence of EdgeLine
        Points along each edge, (m, 3).
    kinds : tuple of EdgeKind
        Of each edge.
    cloud : (k, 3) array
        Points that a picture must hold.
    """

    corners: Array
    normals: Array
    faces: NDArray[np.int64]
    lines: Sequence[EdgeLine]
    kinds: tuple[EdgeKind, ...]
    cloud: Array


def skin_of(boundary: Boundary, pose: Array) -> Skin:
    """The surface of a boundary at a pose (12,): R by rows, p."""
    R, p = pose[:9].reshape(3, 3), pose[9:]
    drawn: Any = solid_of(boundary)  # type: ignore[arg-type]
    points = drawn.points @ R.T + p
    normals = (drawn.normals @ R.T)[drawn.triangles].mean(axis=1)
    lines = [
        EdgeLine(line.edge, line.points @ R.T + p, line.normals @ R.T, line.smooth)
        for line in drawn.lines
    ]
    cloud = np.concatenate([points, *(line.points for line in lines)])
    kinds = boundary.edge_kinds
    return Skin(points[drawn.triangles], normals, drawn.faces, lines, kinds, cloud)


def painted(
    camera: Camera, skin: Skin, raster: Raster, colours: tuple[str, str], active: Feature | None
) -> Array:
    """The faces as a picture (rows, columns, 4), the active one in the second colour."""
    strong = np.zeros(len(skin.faces), dtype=bool)
    if active is not None and active.kind == "face":
        strong = skin.faces == active.index
    colour = np.where(strong[:, None], to_rgb(colours[1]), to_rgb(colours[0]))
    shades = brightness(camera, skin.normals)[:, None] * colour
    image = np.zeros((*raster.triangle.shape, 4))
    shown = raster.triangle >= 0
    image[shown, :3] = shades[raster.triangle[shown]]
    image[shown, 3] = 1.0
    return image


def draw_image(axes: Axes, camera: Camera, image: Array) -> None:
    """Put a picture under what is drawn."""
    (left, low), (right, high) = camera.low, camera.high
    axes.imshow(
        np.clip(image, 0.0, 1.0),
        extent=(left, right, low, high),
        origin="lower",
        interpolation="antialiased",
        zorder=1,
    )


def draw_edges(
    axes: Axes, camera: Camera, skin: Skin, raster: Raster, active: tuple[Feature | None, str]
) -> None:
    """Draw what is not hidden of all edges; the active one wide and in its colour."""
    feature, colour = active
    for line in skin.lines:
        look = EDGE_LOOKS[skin.kinds[line.edge]] | {"zorder": EDGE_ORDER}
        if feature == Feature("edge", line.edge):
            look = look | {"color": colour, "linewidth": 3.2, "zorder": ACTIVE_ORDER}
        points = _finer(line.points)
        flat = camera.flat(points)
        seen = _without_specks(visible(camera, raster, points), flat, camera.pixel)
        flat = np.where(seen[:, None], flat, np.nan)
        axes.plot(*flat.T, solid_capstyle="round", **look)


def _finer(points: Array) -> Array:
    steps = np.arange((len(points) - 1) * FINEST + 1) / FINEST
    at = np.arange(len(points))
    return np.column_stack([np.interp(steps, at, column) for column in points.T])


def _without_specks(seen: NDArray[np.bool_], flat: Array, pixel: float) -> NDArray[np.bool_]:
    """Without short runs of a hidden edge that show at the outlines of what hides it."""
    found = seen.copy()
    ends = np.flatnonzero(np.diff(np.concatenate([[0], seen.astype(int), [0]])))
    for first, end in zip(ends[::2], ends[1::2], strict=True):
        run = flat[first:end]
        if float(np.linalg.norm(np.diff(run, axis=0), axis=1).sum()) < SPECK * pixel:
            found[first:end] = False
    return found


def edges_legend(skins: Sequence[Skin]) -> list[Artist]:
    """An entry for each kind of edge that occurs."""
    handles: list[Artist] = []
    for kind, look in EDGE_LOOKS.items():
        if any(kind in skin.kinds for skin in skins):
            handles.append(Line2D([], [], label=f"{kind} edge", **look))
    return handles


def raster_of(camera: Camera, skins: Sequence[Skin]) -> Raster:
    """Of all triangles of some solids together; those that surely face away are not seen."""
    corners = np.concatenate([skin.corners for skin in skins])
    upright = np.concatenate([skin.normals for skin in skins]) @ camera.axes[2]
    front = np.flatnonzero(upright > AWAY)
    found = rastered(camera, corners[front])
    number = np.where(found.triangle >= 0, front[found.triangle], -1)
    return Raster(found.depth, number)
