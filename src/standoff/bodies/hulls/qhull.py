"""The hull of points as triangles that face outward, by Qhull."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from standoff.checks.numbers import LEAST
from standoff.errors import BodyError
from standoff.typing import Array, Ints


class Triangles(NamedTuple):
    """Facets of a hull.

    Attributes
    ----------
    corners : (n, 3) numbers of points, counterclockwise seen from outside.
    neighbours : (n, 3) the triangle beyond the side from corner k to corner k + 1.
    normals : (n, 3) outward unit normals; those of one plane are the same to roundoff.
    """

    corners: Ints
    neighbours: Ints
    normals: Array


def unit_of(points: Array, word: str) -> float:
    """The power of two next to the points' extent: Qhull's and linprog's tolerances are absolute.

    Division by it changes no digit.
    """
    extent = float(np.ptp(points, axis=0).max()) if len(points) else 0.0
    if 0.0 < extent < LEAST:
        raise BodyError(
            f"The {len(points)} {word} extend over {extent:.3g}, below {LEAST:g}; choose a "
            "smaller unit."
        )
    return 2.0 ** round(np.log2(extent)) if extent > 0.0 else 1.0


def hull_triangles(points: Array, word: str) -> Triangles:
    """The facets of the hull of points, (n, 3).

    Raises BodyError: the points span no volume, or extend over too little; `word` is what the
    message calls them.
    """
    unit = unit_of(points, word)
    try:
        hull = scipy.spatial.ConvexHull(points / unit)
    except (scipy.spatial.QhullError, ValueError) as error:
        raise BodyError(
            f"The {len(points)} {word} span no volume (flat polytope): give at least four "
            "points that are not in one plane."
        ) from error
    corners = hull.simplices.astype(np.int64)
    # Qhull's neighbour k is the one opposite corner k: beyond the side from corner k + 1
    neighbours = np.roll(hull.neighbors.astype(np.int64), 1, axis=1)
    normals = np.ascontiguousarray(hull.equations[:, :3])
    a, b, c = (points[corners[:, k]] for k in range(3))
    around = np.cross(b - a, c - a)
    inward = np.einsum("ij,ij->i", around, normals) < 0.0
    if not _joined(_turned(corners, inward)):
        # of a sliver the points themselves do not tell; its neighbours do
        inward = _inward_by_neighbours(corners, neighbours, inward, around)
    corners, neighbours = _turned(corners, inward), _sides_turned(neighbours, inward)
    return Triangles(corners, neighbours, normals)


def _turned(corners: Ints, inward: NDArray[np.bool_]) -> Ints:
    return np.where(inward[:, None], corners[:, [0, 2, 1]], corners)


def _sides_turned(neighbours: Ints, inward: NDArray[np.bool_]) -> Ints:
    """Sides 0-1, 1-2, 2-0 of corners (a, b, c) are sides 2-0, 1-2, 0-1 of corners (a, c, b)."""
    return np.where(inward[:, None], neighbours[:, [2, 1, 0]], neighbours)


def _joined(corners: Ints) -> bool:
    """Is every side passed once in each direction: a closed surface, all of it facing one way?"""
    start, stop = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
    count = int(corners.max()) + 1
    one, other = np.sort(start * count + stop), np.sort(stop * count + start)
    return bool(np.array_equal(one, other) and (np.diff(one) > 0).all())


def _inward_by_neighbours(
    corners: Ints, neighbours: Ints, inward: NDArray[np.bool_], around: Array
) -> NDArray[np.bool_]:
    """Which triangles are to be turned, from the greatest one on to its neighbours."""
    first = int(np.einsum("ij,ij->i", around, around).argmax())
    found = {first: bool(inward[first])}
    waiting = [first]
    while waiting:
        t = waiting.pop()
        mine = _directed(corners[t], found[t])
        for m in neighbours[t].tolist():
            if m not in found:
                # a triangle faces as its neighbour does if it passes their side the other way
                found[m] = bool(mine & _directed(corners[m], False))
                waiting.append(m)
    turned = np.array([found[t] for t in range(len(corners))])
    if not _joined(_turned(corners, turned)):
        raise BodyError("Qhull's facets do not close: the points are too near to one plane.")
    return turned


def _directed(triangle: Ints, turned: bool) -> set[tuple[int, int]]:
    a, b, c = triangle.tolist()
    return {(a, c), (c, b), (b, a)} if turned else {(a, b), (b, c), (c, a)}
