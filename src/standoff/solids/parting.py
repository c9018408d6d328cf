"""Touching is proven by parting: B is moved a few tolerances off A, along all contact normals."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy

from standoff.solids.tolerances import MOVED_MORE, NO_WAY_OUT, PARTED_BY, WAY_GAIN
from standoff.typing import Array

Gap = tuple[float, Array]
"""How far two solids are proven to be apart, and the normal there."""
MOST_DRAWN = 8
"""Queries by which a way is drawn in."""
MOST_STARTS = 3
OTHER_WAY = 0.9
"""Cosine of the angle of two ways below which both are tried."""


def way_out(normals: Array) -> Array | None:
    """The unit vector whose least component along unit normals (n, 3) is the greatest; None where
    there is none along all of them.

    It is along the point of the normals' hull that is nearest to the origin.
    """
    if not len(normals):
        return None
    # least |normals' weighted mean|, the weights at least 0; their sum, nearly 1, cancels out
    system = np.vstack([normals.T, np.ones(len(normals))])
    weights, _ = scipy.optimize.nnls(system, np.array([0.0, 0.0, 0.0, 1.0]))
    mean = normals.T @ weights
    size = float(np.linalg.norm(mean))
    if size <= NO_WAY_OUT or float((normals @ mean).min()) <= NO_WAY_OUT * size:
        return None
    return np.asarray(mean / size)


def least_way_out(normals: Array, depths: Array) -> Array | None:
    """The shortest vector whose components along unit normals (n, 3) are at least `depths` (n,),
    all above 0; None where there is none.

    A problem of least distance, by its dual (Lawson and Hanson, Solving Least Squares Problems,
    chapter 23).
    """
    if not len(normals):
        return None
    scale = float(depths.max())
    system = np.vstack([normals.T, depths / scale])
    weights, _ = scipy.optimize.nnls(system, np.array([0.0, 0.0, 0.0, 1.0]))
    rest = np.array([0.0, 0.0, 0.0, 1.0]) - system @ weights
    if float(np.linalg.norm(rest)) <= NO_WAY_OUT:
        return None
    return np.asarray(-scale * rest[:3] / rest[3])


def shortest(
    ways: Array, lengths: Array, gap_of: Callable[[Array], Gap | None], known: Array | None = None
) -> Array:
    """A short vector by which B is proven to be parted from A.

    Parameters
    ----------
    ways, lengths : (n, 3) and (n,) arrays
        Unit vectors, and how far B is to be moved along each until a plane is known to be between.
    gap_of : callable
        How far the solids are apart with B moved by a vector; None where it is not proven.
    known : (3,) array, optional
        One that parts them.
    """
    best = lengths.min() * ways[lengths.argmin()] if known is None else known
    tried: list[Array] = []
    for k in np.argsort(lengths, kind="stable"):
        if len(tried) < MOST_STARTS and all(ways[k] @ other < OTHER_WAY for other in tried):
            tried.append(ways[k])
            way = _drawn_in((1.0 + MOVED_MORE) * lengths[k] * ways[k], gap_of)
            if way is not None and np.linalg.norm(way) < np.linalg.norm(best):
                best = way
    return np.asarray(best)


def _drawn_in(way: Array, gap_of: Callable[[Array], Gap | None]) -> Array | None:
    """A vector by which B is proven to be parted from A, drawn in from one that is longer; None
    where that one is not proven to part them.

    If the gap after a move is d, B parts as well by what is d shorter, as nothing is met on the
    way. From there the nearest point of the plane of contact is tried; where that does not part
    them B is drawn in further, and then what is half way is tried.
    """
    best, is_new = way, False
    for k in range(MOST_DRAWN):
        told = gap_of(way)
        if told is None:
            if k == 0:
                return None
            way, is_new = (best if is_new else 0.5 * (way + best)), False
            continue
        gap, normal = told
        length, before = float(np.linalg.norm(way)), float(np.linalg.norm(best))
        drawn = max(0.0, 1.0 - (1.0 - MOVED_MORE) * gap / length) * way
        if np.linalg.norm(drawn) < before:
            best, is_new = drawn, True
        if k and np.linalg.norm(best) > (1.0 - WAY_GAIN) * before:
            break
        foot = (1.0 + WAY_GAIN) * (drawn @ normal) * normal
        way = foot if np.linalg.norm(foot) < (1.0 - WAY_GAIN) * np.linalg.norm(best) else best
    return best


def parted(normals: Array, tolerance: float, apart: Callable[[Array], bool]) -> float:
    """A length by which moving B is proven to part two solids; inf where that is not proven.

    Parameters
    ----------
    normals : (n, 3) array
        Unit vectors from A to B at the places where they touch.
    tolerance : float
        Each place is opened by `PARTED_BY` times this length.
    apart : callable
        Whether the solids are proven to be apart with B moved by a vector (3,).
    """
    way = way_out(normals)
    if way is None:
        return float(np.inf)
    length = PARTED_BY * tolerance / float((normals @ way).min())
    return length if apart(length * way) else float(np.inf)
