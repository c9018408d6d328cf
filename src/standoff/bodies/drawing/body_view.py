"""A body in space, seen from one side: only what faces the viewer, as nothing else is visible."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
import scipy
from numpy.typing import NDArray

from standoff.bodies.packed_parts import PackedParts
from standoff.bodies.tessellation import EdgeLine, FaceMesh
from standoff.bodies.tolerances import FLAT_CLOUD
from standoff.errors import of_extra
from standoff.typing import Array

with of_extra("matplotlib", "plot"):
    from matplotlib.colors import to_rgb
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

Space: TypeAlias = Any  # Axes3D, whose type stubs are incomplete

# Okabe and Ito's colours, lightened: adjacent faces can be distinguished with any colour vision,
# and black lines and names stand out on all of them.
FACE_COLOURS = (
    "#9FD3F2",
    "#F7D08A",
    "#7FD1B9",
    "#F4B8A0",
    "#E3B7D0",
    "#8FB8DE",
    "#F6EE9C",
    "#C9C9C9",
)
NORMAL_COLOUR = "#D55E00"
SEAM_COLOUR = "#0072B2"
SKIN_COLOUR = "#7A7A7A"

VIEWS = ((25.0, -50.0), (-25.0, 130.0))
"""Elevation and azimuth [degrees] from which the body is seen: opposite, so nothing is missed."""

LIGHT = np.array([-0.35, 0.8, 0.5]) / np.linalg.norm([-0.35, 0.8, 0.5])
"""Where the light comes from, in the viewer's axes: right, towards the viewer, up."""

DARKEST = 0.7
"""Brightness of a face seen against the light, as a fraction of its colour."""

NORMAL_LENGTH = 0.09
"""Length of a drawn normal, as a fraction of the body's size."""

NORMAL_SPACING = 0.11
"""Least distance between two drawn normals, as a fraction of the body's size: more of them would
hide the body."""

MOST_NAMED = {"face": 40, "edge": 18, "vertex": 18}
"""The greatest number of features of a kind that are named; more names would cover each other."""

LEAST_NAMED = 0.015
"""Least fraction of the visible area that a face must have to be named, so that the name fits."""

ZOOM = 1.5
"""Of a 3-D panel: with it, a body's bounding ball fills the panel."""

SHORT_AXIS = 0.6
"""An axis of which the viewer sees less than this fraction is not named: its name would cover
another."""

NAME_LIFT = 0.035
"""Offset of a feature's name towards the viewer, as a fraction of the body's size."""

SKIN_POINTS = 400
"""Directions of the ball that is swept over the core to draw its outer surface."""


@dataclass
class Parts:
    """The parts of a body that are drawn."""

    body: PackedParts
    meshes: list[FaceMesh]
    lines: list[EdgeLine]

    @cached_property
    def cloud(self) -> Array:
        """All points of the core that are drawn, (n, 3)."""
        spots = [self.body.vertex_points, *(line.points for line in self.lines)]
        return np.concatenate([*spots, *(mesh.points for mesh in self.meshes)])

    @cached_property
    def size(self) -> float:
        """Diagonal of the box around all that is drawn [length]."""
        return float(np.linalg.norm(np.ptp(self.cloud, axis=0))) + 2.0 * self.body.radius or 2.0


def direction_to_viewer(view: tuple[float, float]) -> Array:
    """Unit vector from the body to the viewer."""
    elevation, azimuth = np.radians(view)
    level = np.cos(elevation)
    return np.array([level * np.cos(azimuth), level * np.sin(azimuth), np.sin(elevation)])


def shows(parts: Parts, towards: Array) -> bool:
    """Does a view show anything? A half-space seen from below does not."""
    faces = [mesh.normals @ towards for mesh in parts.meshes]
    return not faces or bool(np.concatenate(faces).max() > 0.0)


def draw_view(axes: Space, parts: Parts, view: tuple[float, float], unit: str) -> None:
    towards = direction_to_viewer(view)
    axes.view_init(*view)
    axes.set_proj_type("ortho")
    for mesh in parts.meshes:
        _draw_face(axes, mesh, towards)
    _draw_edges(axes, parts, towards)
    _draw_vertices(axes, parts, towards)
    _draw_normals(axes, parts, towards)
    if parts.body.radius:
        _draw_skin(axes, parts, towards)
    _name_features(axes, parts, towards)
    margin = parts.body.radius + 0.3 * NORMAL_LENGTH * parts.size
    frame(axes, parts.cloud, margin, towards, unit)
    where = f"seen from azimuth {view[1]:g}°, elevation {view[0]:g}°"
    axes.text2D(0.5, 0.98, where, transform=axes.transAxes, fontsize="small", ha="center")


def _draw_face(axes: Space, mesh: FaceMesh, towards: Array) -> None:
    """Draw the triangles that face the viewer: for a convex body these are the visible ones."""
    normals = mesh.normals[mesh.triangles].mean(axis=1)
    seen = normals @ towards > 0.0
    if not seen.any():
        return
    colour = np.array(to_rgb(FACE_COLOURS[mesh.face % len(FACE_COLOURS)]))
    right, up = across(towards)
    lamp = LIGHT @ np.array([right, towards, up])
    bright = DARKEST + (1.0 - DARKEST) * np.clip(normals[seen] @ lamp, 0.0, 1.0)
    shaded = bright[:, None] * colour
    axes.add_collection3d(
        Poly3DCollection(
            mesh.points[mesh.triangles[seen]],
            facecolors=shaded,
            edgecolors=shaded,  # without them, hairlines show between the triangles
            linewidths=0.3,
            zorder=1,
        )
    )


def across(towards: Array) -> tuple[Array, Array]:
    """The viewer's right and up directions."""
    right = np.cross([0.0, 0.0, 1.0], towards)
    right /= np.linalg.norm(right)
    return right, np.cross(towards, right)


def seen_points(normals: Array, towards: Array) -> NDArray[np.bool_]:
    """For each point, whether any of its faces faces the viewer; (k, n, 3) to (n,)."""
    if not len(normals):
        return np.ones(normals.shape[1], dtype=bool)
    return np.asarray((np.nan_to_num(normals) @ towards > 0.0).any(axis=0))


def _draw_edges(axes: Space, parts: Parts, towards: Array) -> None:
    for line in parts.lines:
        seen = seen_points(line.normals, towards)
        axes.plot(
            *np.where(seen[:, None], line.points, np.nan).T,
            color=SEAM_COLOUR if line.smooth else "black",
            linewidth=1.2 if line.smooth else 1.6,
            linestyle=(0, (3, 2)) if line.smooth else "-",
            zorder=2,
        )


def vertex_normals(parts: Parts) -> list[Array]:
    """Normals of the faces around each vertex, each (k, 3), from the ends of its edges."""
    found: list[list[Array]] = [[] for _ in range(parts.body.n_vertices)]
    for line, edge in zip(parts.lines, parts.body.edge_parts, strict=True):
        for vertex, end in ((edge.first, 0), (edge.last, -1)):
            if vertex is not None:
                found[vertex] += list(line.normals[:, end])
    for number, face in enumerate(parts.body.face_parts):
        for apex in face.apexes:
            meshes = [mesh for mesh in parts.meshes if mesh.face == number]
            found[apex.vertex] += [normal for mesh in meshes for normal in mesh.normals]
    return [np.array(normals).reshape(-1, 3) for normals in found]


def _draw_vertices(axes: Space, parts: Parts, towards: Array) -> None:
    seen = [not len(n) or bool(seen_points(n[:, None], towards)[0]) for n in vertex_normals(parts)]
    points = parts.body.vertex_points[np.array(seen, dtype=bool)]
    if len(points):
        axes.plot(*points.T, "o", color="black", markersize=4.5, zorder=3)


def _draw_normals(axes: Space, parts: Parts, towards: Array) -> None:
    starts, arrows = [], []
    for mesh in parts.meshes:
        inner = mesh.inner[np.linalg.norm(mesh.normals[mesh.inner], axis=1) > 0.0]
        starts.append(mesh.points[inner])
        arrows.append(mesh.normals[inner])
    if not starts:
        return
    roots, normals = np.concatenate(starts), np.concatenate(arrows)
    seen = np.flatnonzero(normals @ towards > 0.0)
    seen = seen[_apart(roots[seen], NORMAL_SPACING * parts.size)]
    length = NORMAL_LENGTH * parts.size
    axes.quiver(
        *roots[seen].T,
        *(length * normals[seen]).T,
        color=NORMAL_COLOUR,
        linewidth=0.9,
        arrow_length_ratio=0.3,
        zorder=4,
    )


def _apart(points: Array, spacing: float) -> list[int]:
    """Indices of points no two of which are nearer to each other than a spacing."""
    kept: list[int] = []
    for k in np.random.default_rng(0).permutation(len(points)).tolist():
        if not kept or np.linalg.norm(points[kept] - points[k], axis=1).min() >= spacing:
            kept.append(k)
    return kept


def _draw_skin(axes: Space, parts: Parts, towards: Array) -> None:
    """Draw the core swept by its ball: the hull of balls at points of the core."""
    body = parts.body
    spots = parts.cloud
    if len(spots) > 4 and np.linalg.matrix_rank(spots - spots[0], tol=FLAT_CLOUD * parts.size) == 3:
        spots = spots[scipy.spatial.ConvexHull(spots).vertices]
    points = (spots[:, None] + body.radius * _ball()).reshape(-1, 3)
    try:
        hull = scipy.spatial.ConvexHull(points)
    except scipy.spatial.QhullError:  # a radius that is roundoff of the core shows no skin
        return
    seen = hull.equations[:, :3] @ towards > 0.0
    axes.add_collection3d(
        Poly3DCollection(
            points[hull.simplices[seen]],
            facecolor=SKIN_COLOUR,
            edgecolor="none",
            alpha=0.18,
            zorder=5,
        )
    )


def _ball() -> Array:
    """Unit vectors, evenly distributed (a Fibonacci lattice), (n, 3)."""
    k = np.arange(SKIN_POINTS) + 0.5
    height, turn = 1.0 - 2.0 * k / SKIN_POINTS, np.pi * (1.0 + np.sqrt(5.0)) * k
    across = np.sqrt(1.0 - height**2)
    return np.column_stack([across * np.cos(turn), across * np.sin(turn), height])


def _name_features(axes: Space, parts: Parts, towards: Array) -> None:
    lift = NAME_LIFT * parts.size
    body = parts.body
    if body.n_faces <= MOST_NAMED["face"]:
        for face in range(body.n_faces):
            spot = _middle_of_face(parts.meshes, face, towards)
            if spot is not None:
                _name(axes, spot + lift * towards, f"face {face}", framed=True)
    if body.n_edges <= MOST_NAMED["edge"]:
        for line in parts.lines:
            seen = np.flatnonzero(seen_points(line.normals, towards))
            if len(seen) > 2:
                middle = line.points[seen[len(seen) // 2]]
                _name(axes, middle + lift * towards, f"e{line.edge}", framed=False)
    if body.n_vertices <= MOST_NAMED["vertex"]:
        for number, normals in enumerate(vertex_normals(parts)):
            if not len(normals) or seen_points(normals[:, None], towards)[0]:
                outward = normals.mean(axis=0) if len(normals) else np.array([0.0, 0.0, 1.0])
                spot = body.vertex_points[number] + 1.2 * lift * outward
                _name(axes, spot + lift * towards, f"v{number}", framed=False)


def _middle_of_face(meshes: Sequence[FaceMesh], face: int, towards: Array) -> Array | None:
    """A central point of the visible part of a face; None if that is too small to be named."""
    areas = dict.fromkeys((mesh.face for mesh in meshes), 0.0)
    middles = []
    for mesh in meshes:
        corners = mesh.points[mesh.triangles]
        sides = corners[:, 1:] - corners[:, :1]
        across = 0.5 * np.abs(np.cross(sides[:, 0], sides[:, 1]) @ towards)
        seen = mesh.normals[mesh.triangles].mean(axis=1) @ towards > 0.0
        areas[mesh.face] += float(across[seen].sum())
        if mesh.face == face:
            middles.append(corners[seen].mean(axis=1))
    if areas[face] <= LEAST_NAMED * sum(areas.values()):
        return None
    spots = np.concatenate(middles)
    return np.asarray(spots[np.linalg.norm(spots - spots.mean(axis=0), axis=1).argmin()])


def _name(axes: Space, spot: Array, text: str, *, framed: bool) -> None:
    box = {"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 1.0}
    axes.text(
        *spot,
        text,
        fontsize="small" if framed else "x-small",
        ha="center",
        va="center",
        zorder=6,
        bbox=box,
    )


def frame(axes: Space, cloud: Array, margin: float, towards: Array, unit: str) -> None:
    """Set equal scales around points, (n, 3), with a margin; draw axes and a scale in a corner."""
    middle = 0.5 * (cloud.min(axis=0) + cloud.max(axis=0))
    half = (float(np.linalg.norm(cloud - middle, axis=1).max()) + margin) or 1.0
    for k, axis in enumerate("xyz"):
        getattr(axes, f"set_{axis}lim")(middle[k] - half, middle[k] + half)
    axes.set_box_aspect((1.0, 1.0, 1.0), zoom=ZOOM)
    axes.set_axis_off()
    right, up = across(towards)
    corner = middle - 0.98 * half * right - 0.86 * half * up + half * towards
    for axis, direction in zip("xyz", np.eye(3), strict=True):
        axes.plot(*np.stack([corner, corner + 0.13 * half * direction]).T, color="black", zorder=7)
        if np.linalg.norm([direction @ right, direction @ up]) < SHORT_AXIS:
            continue
        axes.text(
            *(corner + 0.18 * half * direction), axis, fontsize="small", ha="center", va="center"
        )
    length = round_length(half)
    end = middle + 0.98 * half * right - 0.98 * half * up + half * towards
    axes.plot(*np.stack([end - length * right, end]).T, color="black", linewidth=2.0, zorder=7)
    label = end - 0.5 * length * right + 0.04 * half * up
    scale = f"{length:g} {unit}".rstrip()
    axes.text(*label, scale, fontsize="small", ha="center", va="bottom")


def round_length(half: float) -> float:
    """1, 2 or 5 times a power of ten, about a third of the given length."""
    power = 10.0 ** np.floor(np.log10(half / 3.0))
    return float(max(m * power for m in (1.0, 2.0, 5.0) if m * power <= half / 3.0))
