"""Touching is proven by parting: B is moved a few tolerances off A, along all contact normals."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy
from numpy.typing import NDArray

from standoff.solids.tolerances import NO_WAY_OUT, PARTED_BY

Array = NDArray[np.float64]
Gap = tuple[float, Array]
"""How far two solids are proven to be apart, and the normal there."""
MOST_DRAWN = 8
"""Queries by which a way is drawn in."""
NEARLY = 0.999
"""Of a gap: how much of it B is moved back."""
GAINED = 5e-3
"""Of a way's length: what is to be gained, at least, to go on."""


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


def drawn_in(way: Array, gap_of: Callable[[Array], Gap | None]) -> Array | None:
    """A vector by which B is proven to be parted from A, drawn in from one that is longer; None
    where that one is not proven to part them.

    If the gap after a move is d, B parts as well by what is d shorter, as nothing is met on the
    way. From there the nearest point of the plane of contact is tried, and where that does not part
    them, what is half way to it.
    """
    best: Array | None = None
    for _ in range(MOST_DRAWN):
        told = gap_of(way)
        if told is None:
            if best is None:
                return None
            way = 0.5 * (way + best)
            continue
        gap, normal = told
        length = float(np.linalg.norm(way))
        drawn = max(0.0, 1.0 - NEARLY * gap / length) * way
        gained = best is None or np.linalg.norm(drawn) < (1.0 - GAINED) * np.linalg.norm(best)
        best = drawn if best is None or np.linalg.norm(drawn) < np.linalg.norm(best) else best
        foot = (drawn @ normal) * normal * (1.0 + GAINED)
        if not gained or np.linalg.norm(foot) > (1.0 - GAINED) * np.linalg.norm(best):
            break
        way = foot
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
