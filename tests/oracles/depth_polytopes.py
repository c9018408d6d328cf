"""The local minima of s(n) of two overlapping polytopes, by trying every face of A - B.

Its faces are the faces of A, those of -B, and the parallelograms of an edge of A and one of B
whose arcs of normals cross. A face holds a local minimum exactly where the foot of the origin on
its plane lies in it.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff_studies.oracles import Placed, Polytope, Swept, unit

Array = NDArray[Any]

INSIDE = 1e-11
"""How far outside the difference, over its size, the foot of a minimum may lie: roundoff."""


def _core(body: Placed) -> Polytope:
    core = body.shape.core if isinstance(body.shape, Swept) else body.shape
    if not isinstance(core, Polytope):
        raise TypeError(f"{type(body.shape).__name__} is not a polytope or box")
    return core


def _crossing_arcs(first: tuple[Array, Array], second: tuple[Array, Array]) -> Array:
    """Return the directions (m, 3) in which arcs of normals (k, 3), (l, 3) cross on the sphere."""
    a, b = (rows[:, None] for rows in first)
    c, d = (rows[None] for rows in second)
    across_a, across_b = np.cross(a, b), np.cross(c, d)
    sides = [
        (across_b * a).sum(axis=2) * (across_b * b).sum(axis=2) < 0,
        (across_a * c).sum(axis=2) * (across_a * d).sum(axis=2) < 0,
    ]
    where = np.cross(across_a, across_b)
    where = where * np.sign((where * (a + b)).sum(axis=2))[:, :, None]
    same_half = ((where * (a + b)).sum(axis=2) > 0) & ((where * (c + d)).sum(axis=2) > 0)
    return unit(where[sides[0] & sides[1] & same_half])


def difference_faces(a: Placed, b: Placed) -> tuple[Array, Array]:
    """Return normals (m, 3) and distances (m,) from the origin of the planes of A - B (cores)."""
    first, second = _core(a), _core(b)
    turned = [normals @ a.rotation.T for normals in first.facets.edge_normals]
    against = [-normals @ b.rotation.T for normals in second.facets.edge_normals]
    normals = np.concatenate(
        [
            first.facets.normals @ a.rotation.T,
            -second.facets.normals @ b.rotation.T,
            _crossing_arcs((turned[0], turned[1]), (against[0], against[1])),
        ]
    )
    high = (normals @ (first.vertices @ a.rotation.T).T).max(axis=1)
    low = (normals @ (second.vertices @ b.rotation.T).T).min(axis=1)
    return normals, high - low - normals @ (b.position - a.position)


def polytope_minima(a: Placed, b: Placed) -> tuple[Array, Array]:
    """Return the depths (m,), the least first, and normals (m, 3) of all local minima.

    Swept polytopes, rounded boxes, too: their cores must overlap.

    Raises
    ------
    ValueError
        The cores are apart.
    """
    normals, heights = difference_faces(a, b)
    if heights.min() <= 0:
        raise ValueError(f"the cores are {-heights.min():.3g} apart along one direction")
    feet = heights[:, None] * normals
    slack = INSIDE * np.abs(heights).max()
    inside = (feet @ normals.T <= heights + slack).all(axis=1)
    order = np.flatnonzero(inside)[np.argsort(heights[inside])]
    return heights[order] + a.shape.sweep + b.shape.sweep, normals[order]
