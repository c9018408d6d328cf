"""Which curve is nearest to a point inside, determined only by the medial axis."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from standoff.bodies import Body
from standoff.bodies.voronoi import MedialBranch, VoronoiRegions
from standoff.typing import Array
from standoff_studies.paper.drawing import curve_points

PIECES = 2000
"""Chords of a branch's spline: they differ from it by less than the spline from the axis, 1e-7."""

ALONG = 400
"""Chords of a curve, which only close a region: a point inside is rarely beyond them."""

HALVINGS = 60
"""Of the step in which a crossing lies: then times are equal to a rounding."""


class Offset(NamedTuple):
    """A point relative to a branch of the axis: its signed distance [length] and its rate."""

    value: float
    slope: float


class MedialRegions:
    """The curves' inner Voronoi regions, bounded by the medial axis; made before the run.

    Parameters
    ----------
    body : Body
        Planar, of curves; curve i goes from vertex i to the next.
    regions : VoronoiRegions
        With one branch from each vertex to one junction.
    """

    def __init__(self, body: Body, regions: VoronoiRegions) -> None:
        self.curves = body.n_edges
        self._branches = {_corner(branch): _to_corner(branch) for branch in regions.medial_axis}
        self._polygons = [self._around(body, curve) for curve in range(self.curves)]

    def _around(self, body: Body, curve: int) -> tuple[Array, Array]:
        """The polygon of a curve's region: first and second ends of its sides, (n, 2) each."""
        boundary = curve_points(body, curve, count=ALONG + 1)
        out, back = self._branches[curve], self._branches[(curve + 1) % self.curves]
        loop = np.vstack([out, boundary, back[::-1]])
        return loop, np.roll(loop, -1, axis=0)

    def nearest_curve(self, x: Array) -> int:
        """Return the curve in whose region a point inside the body, (2,), lies."""
        for curve in range(self.curves):
            if self._within(curve, x):
                return curve
        # Beyond a chord of the boundary, or on a branch: the nearest region's.
        away = [np.linalg.norm(first - x, axis=1).min() for first, _ in self._polygons]
        return int(np.argmin(away))

    def _within(self, curve: int, x: Array) -> bool:
        """Does a ray along +x from the point cross the polygon an odd number of times?"""
        first, last = self._polygons[curve]
        over = (first[:, 1] > x[1]) != (last[:, 1] > x[1])
        a, b = first[over], last[over]
        at = a[:, 0] + (x[1] - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
        return bool(np.count_nonzero(at > x[0]) % 2)

    def offset(self, source: int, target: int, x: Array, v: Array) -> Offset:
        """Return signed distance and rate of a moving point, (2,), to the branch of two curves.

        Positive on the source's side.
        """
        vertex = target if target == (source + 1) % self.curves else source
        points = self._branches[vertex]
        a, b = points[:-1], points[1:]
        along = b - a
        part = np.einsum("ij,ij->i", x - a, along) / np.einsum("ij,ij->i", along, along)
        foot = a + np.clip(part, 0.0, 1.0)[:, None] * along
        k = int(np.linalg.norm(foot - x, axis=1).argmin())
        # Left of the branch from the junction to vertex i is curve i, right of it curve i − 1.
        normal = np.array([-along[k, 1], along[k, 0]]) / np.linalg.norm(along[k])
        sign = 1.0 if source == vertex else -1.0
        return Offset(sign * float(normal @ (x - foot[k])), sign * float(normal @ v))


def first_change(verdict: Callable[[float], int], low: float, high: float) -> float:
    """Return the time between two [s] from which on a verdict is that at the second."""
    after = verdict(high)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        if verdict(middle) == after:
            high = middle
        else:
            low = middle
    return high


def _corner(branch: MedialBranch) -> int:
    """The vertex at which a branch ends."""
    return next(int(end.features[0].index) for end in branch.ends if end.kind == "corner")


def _to_corner(branch: MedialBranch) -> Array:
    """A branch from the junction to its corner, its points joined by a smooth line, (n, 2)."""
    points = branch.points[:, :2]
    if branch.ends[0].kind == "corner":
        points = points[::-1]
    way = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1)))
    return np.asarray(CubicSpline(way, points)(np.linspace(0.0, way[-1], PIECES + 1)))
