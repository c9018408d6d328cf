"""What convex pieces add to a mesh and lose of it, measured along columns.

Columns parallel to z stand on a grid. Along each, the lengths that are in the mesh, in a piece, or
in only one of the two, are exact; their sums over the columns are volumes by the midpoint rule. The
ends and middles of what is in only one of them are points whose distance from the other is taken.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from standoff.bodies.meshes.mesh import Mesh
from standoff.bodies.tolerances import JOIN_TOLERANCE
from standoff.typing import Array, Ints

# Columns along the longer side of the box, and points of a surface, about.
COLUMNS = 128
SURFACE_POINTS = 40_000
# Where in its cell a column stands: off the middle, where meshes made by rule have their corners.
OFF_MIDDLE = (0.5 + 0.5 / np.pi**3, 0.5 - 0.5 / np.e**3)


@dataclass(frozen=True)
class Fit:
    """How well convex pieces are a mesh.

    Attributes
    ----------
    volume : of the mesh, length cubed.
    added, lost : volumes in a piece and not in the mesh, and the other way round, length cubed.
    added_distance, lost_distance : the greatest distance, length, of what is added from the mesh,
        and of what is lost from the pieces, that was found.
    spacing : of the columns and points on which it was measured, length: the distances are good to
        about as much, and what is narrower may be missed.
    volume_error : by how much the mesh's own volume is missed by the same columns, length cubed.
    """

    volume: float
    added: float
    lost: float
    added_distance: float
    lost_distance: float
    spacing: float
    volume_error: float

    def __str__(self) -> str:
        def part(volume: float) -> str:
            return f"{volume:.3g} ({100.0 * volume / self.volume:.3g} % of the mesh)"

        return (
            f"adds a volume of {part(self.added)}, up to {self.added_distance:.3g} away from it, "
            f"and loses {part(self.lost)}, up to {self.lost_distance:.3g} away; measured on "
            f"columns {self.spacing:.3g} apart"
        )


def measured(mesh: Mesh, pieces: Sequence[tuple[Array, Ints]]) -> Fit:
    """Compare a mesh with convex pieces, each (points, triangles facing outward)."""
    corners = np.concatenate([mesh.points, *(points for points, _ in pieces)])
    low, high = corners.min(axis=0), corners.max(axis=0)
    step = float((high - low)[:2].max()) / COLUMNS
    counts = np.maximum(np.ceil((high - low)[:2] / step), 1.0).astype(int)
    grid = (low[:2], step, counts)
    crossings = [_crossings(mesh.points, mesh.triangles, grid, 0)]
    crossings += [_crossings(points, triangles, grid, 1) for points, triangles in pieces]
    column, z, which, sense = (np.concatenate(part) for part in zip(*crossings, strict=True))
    order = np.lexsort((z, column))
    column, z, which, sense = (x[order] for x in (column, z, which, sense))
    # how deep in the mesh, and in how many pieces, from one crossing to the next
    inside = [np.cumsum(np.where(which == k, sense, 0)) > 0 for k in range(2)]
    length = np.where(np.diff(column, append=-1) == 0, np.diff(z, append=0.0), 0.0)
    cell = step * step
    own = cell * float(length[inside[0]].sum())
    long = length > JOIN_TOLERANCE * float(np.linalg.norm(high - low))
    only = [inside[1] & ~inside[0] & long, inside[0] & ~inside[1] & long]
    spots = [_spots(column[o], z[o], length[o], grid) for o in only]
    surfaces = [_spread(mesh.points, mesh.triangles)]
    surfaces.append(np.concatenate([_spread(*piece) for piece in pieces]))
    added, lost = (cell * float(length[o].sum()) for o in only)
    away, off = (_farthest(spots[k], surfaces[k]) for k in range(2))
    return Fit(mesh.volume, added, lost, away, off, step, abs(own - mesh.volume))


def _crossings(
    points: Array, triangles: Ints, grid: tuple[Array, float, Array], which: int
) -> tuple[Ints, Array, Ints, Ints]:
    """(column, z, which, sense) where columns cross triangles; sense +1 where they enter."""
    low, step, counts = grid
    flat = (points[:, :2] - low) / step - OFF_MIDDLE
    corner = flat[triangles]
    # columns with i, j in these ranges are within a triangle's rectangle
    first = np.maximum(np.ceil(corner.min(axis=1)).astype(int), 0)
    last = np.minimum(np.floor(corner.max(axis=1)).astype(int), counts - 1)
    width = np.maximum(last - first + 1, 0)
    many = width[:, 0] * width[:, 1]
    owner = np.repeat(np.arange(len(triangles)), many)
    place = np.arange(len(owner)) - np.repeat(np.cumsum(many) - many, many)
    at = first[owner] + np.column_stack([place // width[owner, 1], place % width[owner, 1]])
    a, b, c = (corner[owner, k] - at for k in range(3))
    parts = [_cross(b, c), _cross(c, a), _cross(a, b)]
    whole = _cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])[owner]
    # half-open, so that a column through an edge crosses one of its two triangles
    up = whole > 0.0
    hit = np.where(up, np.minimum.reduce(parts) >= 0.0, np.maximum.reduce(parts) < 0.0)
    hit &= whole != 0.0
    owner, at = owner[hit], at[hit]
    heights = points[triangles[owner], 2]
    total = whole[hit]
    z = sum(p[hit] * heights[:, k] for k, p in enumerate(parts)) / total
    sense = np.where(total > 0.0, -1, 1)
    return at[:, 0] * int(counts[1]) + at[:, 1], np.asarray(z), np.full(len(at), which), sense


def _cross(a: Array, b: Array) -> Array:
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def _spots(column: Ints, z: Array, length: Array, grid: tuple[Array, float, Array]) -> Array:
    """Ends and middles of stretches of columns, (n, 3)."""
    low, step, counts = grid
    place = np.column_stack([column // int(counts[1]), column % int(counts[1])])
    xy = low + step * (place + OFF_MIDDLE)
    return np.concatenate([np.column_stack([xy, z + share * length]) for share in (0.0, 0.5, 1.0)])


def _farthest(spots: Array, surface: Array) -> float:
    if not len(spots):
        return 0.0
    return float(scipy.spatial.cKDTree(surface).query(spots)[0].max())


def _spread(points: Array, triangles: Ints) -> Array:
    """Points all over triangles, as dense everywhere, their corners among them."""
    corners = points[triangles]
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    areas = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    spacing = np.sqrt(float(areas.sum()) / SURFACE_POINTS)
    found = []
    cuts = np.clip(np.ceil(sides / spacing), 1, SURFACE_POINTS**0.5).astype(int)
    for count in np.unique(cuts).tolist():
        i, j = (x.ravel() for x in np.meshgrid(*[np.arange(count + 1)] * 2, indexing="ij"))
        shares = np.column_stack([i, j, count - i - j])[i + j <= count] / count
        found.append((shares @ corners[cuts == count]).reshape(-1, 3))
    return np.concatenate(found)
