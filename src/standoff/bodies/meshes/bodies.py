"""Meshes as bodies: convex ones as they are, others as their hull where it is asked for."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from standoff.bodies.finishing import PackedBoundary
from standoff.bodies.hulls.build import hull
from standoff.bodies.hulls.qhull import hull_triangles
from standoff.bodies.meshes.columns import measured
from standoff.bodies.meshes.mesh import Mesh, read_mesh, volume_of
from standoff.bodies.tolerances import CONVEXITY_TOLERANCE
from standoff.checks.numbers import magnitude, magnitude_or_zero, yes_or_no
from standoff.errors import BodyError

WORD = "vertices of the mesh"


def mesh_body(
    mesh: Any, as_hull: bool, tolerance: float | None, rounding: float
) -> tuple[float, PackedBoundary]:
    """(radius, packed hull) of ``Body.from_mesh``."""
    radius = magnitude_or_zero(rounding, "rounding")
    tolerance = None if tolerance is None else magnitude(tolerance, "tolerance")
    as_hull = yes_or_no(as_hull, "hull")
    given = read_mesh(mesh)
    packed = hull(given.points, radius, tolerance, WORD)
    size = packed.report.size - 2.0 * radius
    allowed = max(CONVEXITY_TOLERANCE * size, tolerance or 0.0)
    notes = [*given.notes, *packed.report.notes]
    dent = _dent(given, allowed)
    if dent is not None:
        notes.append(_of_its_hull(given, dent, as_hull))
    return radius, replace(packed, report=replace(packed.report, notes=tuple(notes)))


def _dent(mesh: Mesh, allowed: float) -> tuple[str, int] | None:
    """Why a mesh is not convex, and a triangle there; None where it is, to `allowed`, length.

    It is where it is so along every edge and is one sheet: then it encloses what its hull does.
    """
    corners = mesh.points[mesh.triangles]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sizes = np.linalg.norm(areas, axis=1)
    normals = areas / np.where(sizes > 0.0, sizes, 1.0)[:, None]
    # how far the corners beyond a side are above the triangle's plane
    theirs = corners[mesh.beyond]
    rises = np.einsum("tknj,tj->tkn", theirs - corners[:, None, :1], normals).max(axis=2)
    # a sliver's normal is roundoff: its neighbour sees the same edge from a firm plane
    firm = sizes >= sizes[mesh.beyond].max(axis=1)
    seen = np.where((sizes[:, None] >= sizes[mesh.beyond]) | firm[:, None], rises, 0.0)
    k, side = (int(x) for x in np.unravel_index(int(seen.argmax()), seen.shape))
    if seen[k, side] > allowed:
        a, b = corners[k, side], corners[k, (side + 1) % 3]
        return (
            f"the edge from {a} to {b}, between triangles {k} and {mesh.beyond[k, side]}, is "
            f"concave: the one beyond rises by {seen[k, side]:.3g}",
            k,
        )
    faces = hull_triangles(mesh.points, WORD)
    added = volume_of(mesh.points, faces.corners) - mesh.volume
    if abs(added) > allowed * float(sizes.sum()):
        return f"it is several surfaces, or crosses itself: its hull has {added:.3g} more volume", 0
    return None


def _of_its_hull(mesh: Mesh, dent: tuple[str, int], as_hull: bool) -> str:
    """What the hull of a mesh that is not convex adds to it; raises where it is not asked for."""
    why, triangle = dent
    faces = hull_triangles(mesh.points, WORD)
    added = volume_of(mesh.points, faces.corners) - mesh.volume
    if not as_hull:
        raise BodyError(
            f"The mesh is not convex: {why}. Give hull=True for its hull, which adds "
            f"{100.0 * added / mesh.volume:.3g} % to its volume, or take "
            "so.bodies.decomposition for convex pieces.",
            "mesh",
            part=("face", triangle),
        )
    found = replace(
        measured(mesh, [(mesh.points, faces.corners)]), added=added, lost=0.0, lost_distance=0.0
    )
    return f"the hull of a mesh that is not convex ({why}): it {found}"
