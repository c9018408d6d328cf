"""Convex pieces of a mesh, by CoACD, and what they add and lose."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from standoff.bodies.body import Body, made_body
from standoff.bodies.hulls.build import hull
from standoff.bodies.hulls.qhull import hull_triangles
from standoff.bodies.meshes.columns import Fit, measured
from standoff.bodies.meshes.mesh import Mesh, read_mesh
from standoff.checks.numbers import positive, whole_number
from standoff.errors import BodyError, StandoffError, of_extra
from standoff.typing import Array


@dataclass(frozen=True, eq=False)
class Decomposition:
    """Convex pieces that are nearly a mesh.

    Attributes
    ----------
    pieces : mapping of str to Body
        "piece 0", "piece 1", ...: all in the mesh's frame. They may overlap each other.
    fit : Fit
        What they add to the mesh and lose of it, measured.
    notes : tuple of str
        What was merged, left out or turned when the mesh was read.
    """

    pieces: Mapping[str, Body]
    fit: Fit
    notes: tuple[str, ...]

    def __str__(self) -> str:
        return f"{len(self.pieces)} convex pieces of a mesh: their union {self.fit}"


def decomposition(
    mesh: Any,
    *,
    concavity: float = 0.05,
    most: int | None = None,
    seed: int = 0,
    tolerance: float | None = None,
) -> Decomposition:
    """Split a mesh that is not convex into convex pieces, by CoACD.

    The pieces are not the mesh: what they add and lose is in ``fit``. A distance of the pieces is
    no bound for the mesh's own where something is lost.

    Raises BodyError as ``Body.from_mesh``; a piece without volume. Raises ModuleNotFoundError:
    CoACD is not installed; the message names the extra. Raises ValueError: a concavity that is not
    from 0.01 to 1, or `most` below 1.

    Parameters
    ----------
    mesh : trimesh.Trimesh, path, or (vertices, triangles)
        Closed, length.
    concavity : float
        CoACD's threshold, from 0.01 (many pieces) to 1 (few), a ratio.
    most : int, optional
        Most pieces; without a limit by default.
    seed : int
        Of CoACD's search: the same seed gives the same pieces.
    tolerance : float, optional
        As for ``Body.from_points``, of every piece.

    Returns
    -------
    Decomposition

    References
    ----------
    X. Wei, M. Liu, Z. Ling, H. Su: Approximate convex decomposition for 3D meshes with
    collision-aware concavity and tree search, ACM Transactions on Graphics 41(4), 2022.
    """
    threshold = positive(concavity, "concavity")
    if not 0.01 <= threshold <= 1.0:
        raise StandoffError(
            f"concavity = {concavity}: give 0.01 (many pieces) to 1 (few).", "concavity", concavity
        )
    count = -1 if most is None else whole_number(most, "most", 1)
    seed = whole_number(seed, "seed", 0)
    given = read_mesh(mesh)
    corners = [points for points, _ in _split(given, threshold, count, seed)]
    word = "vertices of a piece"
    pieces = {f"piece {k}": _piece(k, points, tolerance, word) for k, points in enumerate(corners)}
    hulls = [(points, hull_triangles(points, word).corners) for points in corners]
    return Decomposition(MappingProxyType(pieces), measured(given, hulls), given.notes)


def _piece(number: int, points: Array, tolerance: float | None, word: str) -> Body:
    try:
        return made_body(f"piece {number}", 0.0, hull(points, 0.0, tolerance, word))
    except BodyError as error:
        raise BodyError(f"Piece {number} of the decomposition: {error}") from error


def _split(mesh: Mesh, threshold: float, most: int, seed: int) -> Any:
    with of_extra("CoACD", "meshes"):
        import coacd
    coacd.set_log_level("error")
    # CoACD's own numbers are 32 bits wide
    given = coacd.Mesh(mesh.points, mesh.triangles.astype(np.int32))
    return coacd.run_coacd(given, threshold=threshold, max_convex_hull=most, seed=seed)
