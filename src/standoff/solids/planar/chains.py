"""Curves in any order made into loops: which end meets which."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from standoff.errors import BodyError
from standoff.geometry.curves import Curve
from standoff.solids.planar.loops import ends_of
from standoff.typing import Array
from standoff.wording import counted


class Chains(NamedTuple):
    """Loops of curves, and what was joined that did not quite meet.

    Attributes
    ----------
    loops : list of lists of Curve
    joined : int
        Number of pairs of ends that miss each other by more than the first limit.
    gap : float
        The most by which any two miss each other, length.
    place : (2,) array
        Where that is.
    """

    loops: list[list[Curve]]
    joined: int
    gap: float
    place: Array


def chained(curves: list[Curve], limits: tuple[float, float]) -> Chains:
    """Loops of curves that meet end to end, in any order.

    Ends within the first limit meet. Of those that are left, which would make the outline open,
    ends within the second meet: so details that are smaller than this stay what they are.

    Raises BodyError: an end at which no other curve ends, or more than one, with the place.

    Parameters
    ----------
    curves : list of Curve
    limits : (float, float)
        By how much ends may miss each other, lengths.
    """
    ends = np.array([end for curve in curves for end in ends_of(curve)])
    partners = _partners(ends, limits)
    loops: list[list[Curve]] = []
    left = set(range(len(curves)))
    while left:
        at = first = min(left)
        end, loop = 1, []
        while at in left:
            left.discard(at)
            loop.append(curves[at])
            at, other = divmod(int(partners[2 * at + end]), 2)
            end = 1 - other
        assert at == first
        loops.append(loop)
    gaps = np.linalg.norm(ends - ends[partners], axis=1)
    worst = int(gaps.argmax())
    joined = int((gaps > limits[0]).sum()) // 2
    return Chains(loops, joined, float(gaps[worst]), ends[worst])


def _partners(ends: Array, limits: tuple[float, float]) -> NDArray[np.int64]:
    """For each end 2 k (first) or 2 k + 1 (last) of curve k the end that it meets."""
    partners = np.full(len(ends), -1)
    # a curve whose own ends meet is a loop, whatever else ends there
    own = np.linalg.norm(ends[::2] - ends[1::2], axis=1) <= limits[0]
    closed = 2 * np.flatnonzero(own)
    partners[closed], partners[closed + 1] = closed + 1, closed
    for limit in limits:
        left = np.flatnonzero(partners < 0)
        if not len(left):
            break
        near = cKDTree(ends[left]).query_ball_point(ends[left], limit)
        for k, found in zip(left, near, strict=True):
            if len(found) > 2:
                raise BodyError(
                    f"{len(found)} curves end at {ends[k]}, where two are to meet: remove doubled "
                    "lines and branches there."
                )
            if len(found) == 2:
                partners[k] = left[found[0]] if left[found[0]] != k else left[found[1]]
    _refuse_open(ends, np.flatnonzero(partners < 0), limits[1])
    return partners


def _refuse_open(ends: Array, left: NDArray[np.int64], limit: float) -> None:
    """Raise BodyError if ends are left, with the one that is farthest from all others."""
    if not len(left):
        return
    away = cKDTree(ends).query(ends[left], 2)[0][:, 1]
    worst = int(away.argmax())
    several = f", the farthest of {counted(len(left), 'open end')}" if len(left) > 1 else ""
    raise BodyError(
        f"A curve ends at {ends[left[worst]]}, and no other one begins there (the nearest end is "
        f"{away[worst]:.6g} away{several}; up to {limit:.3g} is joined): close the outline, or "
        "give `join`."
    )
