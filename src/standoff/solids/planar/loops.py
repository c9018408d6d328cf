"""Loops of curves: read, joined end to end, turned so that the solid lies on their left."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.topology import extent_of, parts_of
from standoff.checks.real_numbers import shown
from standoff.errors import BodyError, StandoffTypeError
from standoff.geometry.curves import Curve
from standoff.kernels.solids import planar_layout as P
from standoff.solids.planar.leaves import FEWEST_LEAVES, Leaves, leaves_of
from standoff.solids.planar.tolerances import IN_PLANE, JOINED
from standoff.typing import Array

DRAWN = 65  # points of a curve in pictures


class Loop(NamedTuple):
    """Curves in the order and direction in which they are run through.

    Attributes
    ----------
    curves : tuple of Curve
    backward : tuple of bool
        Is the curve run through against its parameter?
    gap : float
        The most by which two ends miss each other, length.
    """

    curves: tuple[Curve, ...]
    backward: tuple[bool, ...]
    gap: float

    def reversed(self) -> Loop:
        """The same points, run through in the other direction."""
        return Loop(self.curves[::-1], tuple(not b for b in self.backward[::-1]), self.gap)


def ends_of(curve: Curve) -> tuple[Array, Array]:
    """Both ends (2,) of a curve, in the direction of its parameter."""
    return curve.point(curve.first)[:2], curve.point(curve.last)[:2]


def points_along(loop: Loop) -> list[Array]:
    """Points (n, 3) along each curve of a loop, in its direction: for pictures."""
    return [
        np.array([c.point(t) for t in np.linspace(c.first, c.last, DRAWN)[:: -1 if back else 1]])
        for c, back in zip(loop.curves, loop.backward, strict=True)
    ]


def size_of(curves: Sequence[Curve], what: str = "the loops") -> float:
    """The diagonal of the box around some points of each curve, length, as long as it may be."""
    at = np.array(
        [c.point(t) for c in curves for t in np.linspace(c.first, c.last, 9)], dtype=np.float64
    )
    return extent_of(at, what)


def read_loop(curves: Any, where: str, join: float | None = None) -> Loop:
    """A closed loop of curves that follow each other, each in either direction.

    Raises BodyError: no curves, one out of z = 0 or of no length, too small a loop, ends that do
    not meet. Raises TypeError: not a sequence of curves.
    """
    found = parts_of(curves, where)
    for k, curve in enumerate(found):
        if not isinstance(curve, Curve):
            raise StandoffTypeError(f"Curve {k} of {where} is {shown(curve)}: give a Curve.")
    if not found:
        raise BodyError(f"{where} has no curves: give at least one.", "loops", curves)
    size = size_of(found, where)
    for k, curve in enumerate(found):
        _check_flat(curve, f"Curve {k} of {where}", size)
    return joined(tuple(found), where, JOINED * size if join is None else join)


def _check_flat(curve: Curve, what: str, size: float) -> None:
    points = np.array([curve.point(t) for t in np.linspace(curve.first, curve.last, 17)])
    if np.abs(points[:, 2]).max() > IN_PLANE * max(size, float(np.abs(points).max())):
        raise BodyError(f"{what} leaves the plane z = 0, at {points[0]}: give curves in it.")
    if np.linalg.norm(np.ptp(points, axis=0)) <= JOINED * size:
        raise BodyError(
            f"{what} has no length, at {points[0, :2]}: it is shorter than {JOINED:g} of the "
            "loop; leave it out and let its neighbours meet."
        )


def joined(curves: tuple[Curve, ...], where: str, tolerance: float) -> Loop:
    """The loop, with the direction of each curve found from where its ends meet the next.

    Raises BodyError: ends that are farther apart than the tolerance, with the place.
    """
    n = len(curves)
    ends = [ends_of(c) for c in curves]
    best: tuple[float, tuple[bool, ...], int, Array] | None = None
    for start in (False, True):
        backward, gap, worst, at = [start], 0.0, 0, ends[0][0]
        tip = ends[0][0 if start else 1]
        for k in range(1, n + 1):
            here = ends[k % n]
            if k == n:
                turned = backward[0]
            else:
                turned = bool(np.linalg.norm(here[1] - tip) < np.linalg.norm(here[0] - tip))
                backward.append(turned)
            miss = float(np.linalg.norm(here[1 if turned else 0] - tip))
            if miss > gap:
                gap, worst, at = miss, k, tip
            tip = here[0 if turned else 1]
        if best is None or gap < best[0]:
            best = gap, tuple(backward), worst, at
    assert best is not None
    gap, signs, worst, at = best
    if gap > tolerance:
        raise BodyError(
            f"{where} is open: curve {worst % n} does not begin where curve {(worst - 1) % n} "
            f"ends, at {at}, but {gap:.6g} from it; close it there."
        )
    return Loop(curves, signs, gap)


class PackedLoop(NamedTuple):
    """The leaves of a loop, joined: their ends are the starts of the next."""

    reals: Array
    ints: NDArray[np.int64]


def packed_loop(
    loop: Loop, first_curve: int, offsets: Sequence[int], first_leaf: int
) -> PackedLoop:
    """The leaves of a loop whose curves have numbers from `first_curve` on, and their data at
    `offsets`."""
    at_least = -(-FEWEST_LEAVES // len(loop.curves))
    parts: list[Leaves] = [
        leaves_of(curve, backward, at_least if len(loop.curves) < FEWEST_LEAVES else 1)
        for curve, backward in zip(loop.curves, loop.backward, strict=True)
    ]
    for k, part in enumerate(parts):
        part.ints[:, P.DATA], part.ints[:, P.CURVE] = offsets[k], first_curve + k
        part.ints[:, P.VERTEX] = -1
        part.ints[0, P.VERTEX] = first_curve + k
    reals = np.concatenate([p.reals for p in parts])
    ints = np.concatenate([p.ints for p in parts])
    starts = np.concatenate([p.starts for p in parts])
    n = len(reals)
    reals[:, P.START : P.START + 2] = starts
    reals[:, P.END : P.END + 2] = np.roll(starts, -1, axis=0)
    reals[:, P.PAD] += loop.gap
    numbers = np.arange(n)
    ints[:, P.BEFORE] = first_leaf + (numbers - 1) % n
    ints[:, P.AFTER] = first_leaf + (numbers + 1) % n
    return PackedLoop(reals, ints)
