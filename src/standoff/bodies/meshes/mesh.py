"""A closed mesh of triangles, from what a user gives."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import scipy

from standoff.bodies.tolerances import MESH_CORNER
from standoff.checks.arrays import finite_rows, numbers
from standoff.checks.real_numbers import shown
from standoff.errors import BodyError, StandoffError, StandoffTypeError, not_installed, of_extra
from standoff.typing import Array, Ints

# Open edges that one message names.
MOST_NAMED = 3


class Mesh(NamedTuple):
    """Triangles that close one surface or several and face outward.

    Attributes
    ----------
    points : (v, 3)
    triangles : (t, 3) numbers of points, counterclockwise seen from outside.
    beyond : (t, 3) the triangle beyond the side from corner k to corner k + 1.
    notes : what was merged, left out or turned.
    """

    points: Array
    triangles: Ints
    beyond: Ints
    notes: tuple[str, ...]

    @property
    def volume(self) -> float:
        """Enclosed, length cubed."""
        return volume_of(self.points, self.triangles)


def volume_of(points: Array, triangles: Ints) -> float:
    """Signed, of closed triangles, length cubed."""
    a, b, c = (points[triangles[:, k]] - points.mean(axis=0) for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6.0


def read_mesh(mesh: Any) -> Mesh:
    """A closed mesh from a trimesh object, a file's path, or a pair (vertices, triangles).

    Points that are equal but for roundoff are made one, and triangles without area left out. A mesh
    that faces inward is turned, which its notes tell.

    Raises
    ------
    BodyError
        Open edges (holes), an edge of more than two triangles, neighbours that face different ways,
        no volume; the message names the place.
    ModuleNotFoundError
        A path is given, and trimesh is not installed; the message names the extra.
    OSError
        The file cannot be read.
    TypeError
        No mesh.
    ValueError
        NaN, infinite or wrongly shaped numbers, or numbers of points that do not exist.
    """
    points, triangles = _arrays(mesh)
    notes = []
    points, triangles, merged = _merged(points, triangles)
    if merged:
        notes.append(f"{merged} points within {MESH_CORNER:g} of others are one with them")
    a, b, c = triangles.T
    flat = (a == b) | (b == c) | (c == a)
    if flat.any():
        notes.append(f"{int(flat.sum())} triangles with two equal corners left out")
        triangles = triangles[~flat]
    if not len(triangles):
        raise BodyError("The mesh has no triangles.", "mesh", mesh)
    beyond = _neighbours(points, triangles)
    volume = volume_of(points, triangles)
    if volume < 0.0:
        triangles, beyond = triangles[:, [0, 2, 1]], beyond[:, [2, 1, 0]]
        notes.append("all triangles face inward: turned outward")
    if volume == 0.0:
        raise BodyError("The mesh encloses no volume.", "mesh", mesh)
    return Mesh(points, triangles, beyond, tuple(notes))


def _merged(points: Array, triangles: Ints) -> tuple[Array, Ints, int]:
    """With one point, the first, for all that are equal but for roundoff; how many are left out."""
    # of equal points the first; 0.0 makes one zero of the two
    _, first, number = np.unique(points + 0.0, axis=0, return_index=True, return_inverse=True)
    own = first[number.ravel()]
    near = MESH_CORNER * float(np.abs(points).max(initial=0.0))
    pairs = scipy.spatial.cKDTree(points[first]).query_pairs(near, output_type="ndarray")
    if len(pairs):
        shape = (len(first), len(first))
        graph = scipy.sparse.coo_array((np.ones(len(pairs)), pairs.T), shape)
        groups = scipy.sparse.csgraph.connected_components(graph, directed=False)[1]
        least = np.full(int(groups.max()) + 1, len(points))
        np.minimum.at(least, groups, first)
        own = least[groups][number.ravel()]
    kept, numbers_of = np.unique(own, return_inverse=True)
    return points[kept], numbers_of.ravel()[triangles], len(points) - len(kept)


def _arrays(mesh: Any) -> tuple[Array, Ints]:
    if isinstance(mesh, str | Path):
        mesh = mesh_scene(Path(mesh)).to_mesh()
    if isinstance(mesh, tuple | list) and len(mesh) == 2:
        vertices, faces = mesh
    elif hasattr(mesh, "vertices") and hasattr(mesh, "faces"):
        vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces)
    else:
        raise StandoffTypeError(
            f"mesh = {shown(mesh)}: give a trimesh.Trimesh, the path of a file, or a pair of "
            "vertices (n, 3) and triangles (m, 3).",
            "mesh",
            mesh,
        )
    points = finite_rows(vertices, "mesh vertices", 3)
    given = numbers(faces, "mesh triangles", (-1, 3))
    wrong = ~((given >= 0) & (given < len(points)) & (given == np.floor(given)))
    if wrong.any():
        row = int(np.flatnonzero(wrong.any(axis=1))[0])
        raise StandoffError(
            f"Triangle {row} of the mesh has the corners {given[row]}: give whole numbers from 0 "
            f"to {len(points) - 1}, those of its {len(points)} vertices.",
            "mesh",
            mesh,
        )
    return points, given.astype(np.int64)


def mesh_scene(path: Path) -> Any:
    """The meshes of a file with their places, a ``trimesh.Scene``, as the file has them.

    Raises ModuleNotFoundError: trimesh, or what it needs for this kind of file, is not installed.
    Raises FileNotFoundError. Raises StandoffError: a file that it can't read.
    """
    with of_extra("trimesh", "meshes"):
        import trimesh
    if not os.path.isfile(path):
        raise FileNotFoundError(f"There is no mesh file {shown(str(path))}.")
    # else trimesh makes one of all objects of a file
    apart: dict[str, Any] = {"split_objects": True} if path.suffix.lower() == ".obj" else {}
    try:
        return trimesh.load_scene(path, process=False, **apart)
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(
            not_installed(str(error.name), "meshes"), name=error.name
        ) from error
    except Exception as error:  # each of its many readers raises its own
        raise StandoffError(f"{path} was not read as a mesh: {error}", "mesh", path) from error


def _neighbours(points: Array, triangles: Ints) -> Ints:
    """(t, 3) triangles beyond the sides. Raises BodyError where sides are not in opposite pairs."""
    start, stop = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    keys, reverse = start * len(points) + stop, stop * len(points) + start
    order = np.argsort(keys, kind="stable")
    at = np.searchsorted(keys[order], reverse)
    at = order[np.minimum(at, len(order) - 1)]
    twice = np.flatnonzero(np.diff(keys[order]) == 0)
    if len(twice):
        one, other = sorted(order[twice[0] : twice[0] + 2].tolist())
        raise BodyError(
            f"Triangles {one // 3} and {other // 3} of the mesh both pass the edge from "
            f"{points[start[one]]} to {points[stop[one]]} in this direction: they face different "
            "ways, or more than two triangles meet there.",
            part=("face", one // 3),
        )
    open_ = np.flatnonzero(keys[at] != reverse)
    if len(open_):
        named = ", ".join(f"{points[start[k]]} to {points[stop[k]]}" for k in open_[:MOST_NAMED])
        more = ", ..." if len(open_) > MOST_NAMED else ""
        raise BodyError(
            f"The mesh has holes: {len(open_)} edges have a triangle on one side only ({named}"
            f"{more}). Close it, or give its vertices to so.Body.from_points for their hull.",
            part=("face", int(open_[0]) // 3),
        )
    return np.asarray((at // 3).reshape(-1, 3), dtype=np.int64)
