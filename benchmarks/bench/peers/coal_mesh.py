"""Coal on ellipsoids cut into triangles: time, memory and error of a mesh fine enough."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.bench.contender import Array, Contender
from benchmarks.bench.motion import Frames, Pair
from benchmarks.bench.peers.coal import by_function
from standoff_studies.accuracy.peers.answer import require
from standoff_studies.accuracy.solids import Solid

FINENESS = (1e-3, 1e-4, 1e-5)
"""How far a triangle may lie within the surface, over the greatest diameter."""
SAG = 0.65
"""Depth of the widest triangle of an octahedron's face cut n times, times n**2, over the radius:
its corner-to-middle angle is 1.14 / n, and the depth half its square."""


def name_of(fineness: float) -> str:
    """What the table calls it."""
    return f"Coal, triangles of {fineness:.0e}"


def contenders(pair: Pair, frames: Frames, finest: float) -> list[Contender]:
    """Coal's tree of boxes over each mesh, down to the finest that is asked for."""
    require("coal")
    if "meshes" not in pair.more:
        return []
    found = []
    for fineness in FINENESS:
        if fineness >= finest:
            meshes = mesh(pair.a, fineness), mesh(pair.b, fineness)
            memory = sum(m.memUsage(False) for m in meshes)
            found.append(by_function(name_of(fineness), frames, meshes, memory=memory))
    return found


def mesh(solid: Solid, fineness: float) -> Any:
    """An ellipsoid's triangles as Coal's tree of oriented boxes."""
    coal = require("coal")
    axes = np.array(list(solid.values.values()))
    # a ball's triangles, scaled: what lies within by so much of the radius still does
    points, triangles = ball_triangles(int(np.ceil(np.sqrt(SAG / (2.0 * fineness)))))
    made = coal.BVHModelOBBRSS()
    made.beginModel(len(triangles), len(points))
    made.addVertices(points * axes)
    made.addTriangles(triangles)
    if made.endModel() != 0:  # Coal's BVH_OK
        raise RuntimeError("Coal could not build the mesh's tree")
    return made


def ball_triangles(cuts: int) -> tuple[Array, NDArray[np.int64]]:
    """The unit ball's octahedron with every edge cut in so many parts: points, triangles."""
    i, j = np.array([(i, j) for i in range(cuts + 1) for j in range(cuts + 1 - i)]).T
    number = np.full((cuts + 2, cuts + 2), -1)
    number[i, j] = np.arange(len(i))
    angles = np.column_stack([i, j, cuts - i - j]) * (np.pi / 2 / cuts)
    face = np.sin(angles)  # spaced evenly along the edges
    face /= np.linalg.norm(face, axis=1)[:, None]
    up = np.column_stack([number[i, j], number[i + 1, j], number[i, j + 1]])
    down = np.column_stack([number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]])
    corners = np.concatenate([up, down])
    corners = corners[(corners >= 0).all(axis=1)]
    points, triangles = [], []
    for sign in np.ndindex(2, 2, 2):
        flip = 1.0 - 2.0 * np.array(sign)
        triangles.append(corners[:, :: 1 if flip.prod() > 0 else -1] + sum(map(len, points)))
        points.append(face * flip)
    return np.concatenate(points), np.concatenate(triangles)
