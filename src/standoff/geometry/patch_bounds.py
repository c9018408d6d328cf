"""Bounds of sub-patches: boxes, cones of normals and curvatures over rectangles of parameters.

Every bound is guaranteed, for the surface as its float64 numbers define it and including the
rounding of its own arithmetic. Boxes also contain the rounded points that the kernels compute.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.checks.arrays import finite
from standoff.errors import StandoffError
from standoff.geometry.boxes import Boxes
from standoff.geometry.interval_vectors import cross, length
from standoff.geometry.intervals import Interval, interval, sqrt
from standoff.geometry.tolerances import CONE_ROUNDING, VANISHED
from standoff.geometry.vectors import crosses
from standoff.kernels.entries.queries import centres
from standoff.typing import Array

UNKNOWN = float(np.pi)
UP = np.array([0.0, 0.0, 1.0])[:, None, None]


@dataclass(frozen=True, eq=False)
class PatchBounds:
    """What is guaranteed to enclose a surface over each of n rectangles of parameters.

    Attributes
    ----------
    low, high : (n, 3) arrays
        Corners of a box around the points, body frame, length.
    axis : (n, 3) array
        Axis of a cone around the normals x_u × x_v, unit vectors, body frame.
    angle : (n,) array
        Half angle of the cone, radians, below pi/2; pi if no cone is known to contain them.
    least, greatest : (n,) arrays
        Bounds of the normal curvature, 1/length, positive where the surface bends towards
        x_u × x_v (that of a sphere with x_u × x_v outward is -1/r); -inf and inf if none is known,
        as at a pole or an apex.
    """

    low: Array
    high: Array
    axis: Array
    angle: Array
    least: Array
    greatest: Array

    def __len__(self) -> int:
        return len(self.low)

    def __getitem__(self, which: Any) -> PatchBounds:
        return PatchBounds(*(getattr(self, name)[which] for name in self.__dataclass_fields__))

    @staticmethod
    def joined(parts: Sequence[PatchBounds]) -> PatchBounds:
        """Several bounds concatenated."""
        names = PatchBounds.__dataclass_fields__
        return PatchBounds(*(np.concatenate([getattr(p, n) for p in parts]) for n in names))

    def merged(self, owners: NDArray[np.int64], count: int) -> PatchBounds:
        """Bounds of `count` rectangles from those of their parts, which belong to `owners` (n,)."""
        low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
        np.minimum.at(low, owners, self.low)
        np.maximum.at(high, owners, self.high)
        least, greatest = np.full(count, np.inf), np.full(count, -np.inf)
        np.minimum.at(least, owners, self.least)
        np.maximum.at(greatest, owners, self.greatest)
        cones = merged_cones(self.axis, self.angle, owners, count)
        return PatchBounds(low, high, *cones, least, greatest)


def merged_cones(
    axes: Array, angles: Array, owners: NDArray[np.int64], count: int
) -> tuple[Array, Array]:
    """Cones around those of the parts of `count` rectangles, which belong to `owners` (n,)."""
    axis = np.zeros((count, 3))
    np.add.at(axis, owners, axes)
    alone = np.bincount(owners, minlength=count) == 1
    size = np.linalg.norm(axis, axis=1)
    axis = np.where(size[:, None] > 0.0, axis, [0.0, 0.0, 1.0])
    axis = np.where(alone[:, None], axis, axis / np.linalg.norm(axis, axis=1)[:, None])
    away = between(axis[owners].T, axes.T)
    reach = np.where(alone[owners], angles, angles + away + CONE_ROUNDING)
    angle = np.zeros(count)
    np.maximum.at(angle, owners, reach)
    return axis, _known(angle)


def between(a: Array, b: Array) -> Array:
    """Angles, radians, between vectors (3, ...), to an absolute roundoff of a few eps."""
    across = crosses(np.moveaxis(a, 0, -1), np.moveaxis(b, 0, -1))
    return np.asarray(np.arctan2(np.linalg.norm(across, axis=-1), (a * b).sum(axis=0)))


def _known(angle: Array) -> Array:
    return np.where(angle < 0.5 * np.pi, angle, UNKNOWN)


def cone_round(vectors: Interval) -> tuple[Array, Array]:
    """(axis (n, 3), angle (n,)) of cones around all positive combinations of vectors (3, k, n).

    A circular cone of less than a right angle is convex, so it contains what its generators span.
    """
    middle = vectors.middle
    with np.errstate(all="ignore"):
        off = np.linalg.norm(vectors.radius, axis=0)
        size = np.linalg.norm(middle, axis=0)
        units = middle / size
        lost = ~(size > off) | ~np.isfinite(units).all(axis=0)
    # a vector that is exactly zero adds nothing and is replaced by another one
    none = (size == 0.0) & (off <= VANISHED)
    lost &= ~none
    first = np.take_along_axis(units, (none | lost).argmin(axis=0)[None, None], axis=1)
    units = np.where(none | lost, np.where(np.isfinite(first), first, UP), units)
    axis = np.empty((units.shape[2], 3))
    centres(np.ascontiguousarray(np.moveaxis(units, 0, 2).swapaxes(0, 1)), axis)
    with np.errstate(all="ignore"):
        lean = np.where(lost | none, 0.0, off / size)
        turned = np.arcsin(np.minimum(lean, 1.0))
    reach = between(axis.T[:, None], units) + turned + CONE_ROUNDING
    return axis, _known(np.where(lost.any(axis=0), UNKNOWN, reach.max(axis=0)))


def normal_curvatures(
    first: Sequence[Interval], second: Sequence[Interval], area: Interval
) -> tuple[Array, Array]:
    """(least, greatest), (n,), of II / (|N| I) from bounds over boxes.

    Parameters
    ----------
    first : (E, F, G), of any two tangents.
    second : (x_uu . N, x_uv . N, x_vv . N), where N is the tangents' cross product.
    area : |N|.
    """
    e, f, g = first
    with np.errstate(all="ignore"):
        u, v = 1.0 / sqrt(e), 1.0 / sqrt(g)
        skew = f * u * v
        matrix = [c * a * b / area for c, a, b in zip(second, (u, u, v), (u, v, v), strict=True)]
        # in unit tangents: eigenvalues at the middle, then the width of the bounds
        uu, uv, vv = (c.middle for c in matrix)
        wide = [interval(c.radius) for c in matrix]
        off = length(*wide, wide[1]).hi
        mean, half = interval(uu) * 0.5 + interval(vv) * 0.5, _half_gap(uu, uv, vv)
        low, high = (mean - half - interval(off)).lo, (mean + half + interval(off)).hi
        # t . I t for a unit t lies between 1 - |skew| and 1 + |skew|
        lean = skew.magnitude
        unit = Interval((1.0 - interval(lean)).lo, (1.0 + interval(lean)).hi)
        least, greatest = interval(low) / unit, interval(high) / unit
    good = np.isfinite(least.lo) & np.isfinite(greatest.hi) & (lean < 1.0)
    return np.where(good, least.lo, -np.inf), np.where(good, greatest.hi, np.inf)


def framed(first: Sequence[Interval], second: Sequence[Interval]) -> list[list[Interval]]:
    """Both forms in tangents that are nearly orthonormal at the middle of the first form."""
    with np.errstate(all="ignore"):
        a, b, d = (interval(c) for c in orthonormal(*(c.middle for c in first)))
        return [
            [x * a**2, (x * b + y * d) * a, x * b**2 + y * (b * d * 2.0) + z * d**2]
            for x, y, z in (first, second)
        ]


def orthonormal(e: Array, f: Array, g: Array) -> tuple[Array, Array, Array]:
    """(a, b, d) with which a t_1 and b t_1 + d t_2 are orthonormal, from the tangents' products."""
    a = 1.0 / np.sqrt(e)
    along = f * a * a
    d = 1.0 / np.sqrt(g - along * f)
    return a, -along * d, d


def _half_gap(uu: Array, uv: Array, vv: Array) -> Interval:
    """Half of the difference between the eigenvalues of symmetric 2 x 2 matrices."""
    return length((interval(uu) - interval(vv)) * 0.5, interval(uv))


def area_of(tangents: tuple[Interval, Interval]) -> tuple[Interval, Interval]:
    """(N, |N|) for two tangents, each (3, n)."""
    normal = cross(*tangents)
    return normal, length(*(normal[k] for k in range(3)))


def checked_rectangles(rectangles: Any) -> Boxes:
    """(n, 4) rows (u0, u1, v0, v1) as boxes; one row is one box.

    Raises StandoffError: a wrong shape, a number that is not finite, u0 > u1 or v0 > v1.
    """
    rows = finite(np.atleast_2d(rectangles), "rectangles", (-1, 4))
    wrong = np.flatnonzero((rows[:, 0] > rows[:, 1]) | (rows[:, 2] > rows[:, 3]))
    if len(wrong):
        raise StandoffError(
            f"rectangles[{wrong[0]}] = {rows[wrong[0]]}: give u0 <= u1 and v0 <= v1.",
            "rectangles",
            rectangles,
        )
    return Boxes(rows[:, [0, 2]], rows[:, [1, 3]])


def cut(boxes: Boxes, breaks: Sequence[Array]) -> tuple[Boxes, NDArray[np.int64]]:
    """Boxes cut at parameters (us, vs), and the box to which each part belongs."""
    owners = np.arange(len(boxes))
    for axis, levels in enumerate(breaks):
        for level in levels:
            through = (boxes.low[:, axis] < level) & (level < boxes.high[:, axis])
            if through.any():
                low, high = boxes.low[through].copy(), boxes.high.copy()
                low[:, axis], high[through, axis] = level, level
                boxes = Boxes(
                    np.concatenate([boxes.low, low]),
                    np.concatenate([high, boxes.high[through]]),
                )
                owners = np.concatenate([owners, owners[through]])
    return boxes, owners
