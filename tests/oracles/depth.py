"""The penetration depth of two bodies and every local minimum of s(n), from support functions.

``s(n) = h_A(n) + h_B(-n)`` over unit n: the least value is the depth (minus the distance, for
separated bodies), and moving B by ``s(n) n`` parts the bodies for any n. Nothing of the library
takes part, and nothing is tracked: the sphere is cut into cells, each cell is bounded from below
by the support planes of its corners, and cells that cannot hold the least value are dropped. So
the least depth is proven, up to roundoff, however many local minima there are.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from standoff_studies.oracles import HalfSpace, Placed, unit

from .bounds import pair_size, separation
from .depth_inertia import Contact, contact, tangents
from .depth_polytopes import polytope_minima

Array = NDArray[Any]

TOLERANCE = 1e-12
"""Width, over the pair's size, of the proven bracket of a least value."""
LEVELS = 45
"""Halvings of a cell: angles from 0.1 down to 1e-14."""
CELLS = 4000
"""Cells kept of one level; the bounds of others count as they are."""
FINE = 4
"""Halvings of the icosahedron that is sampled for local minima: 2,562 directions."""
COARSE = 3
"""Halvings of the icosahedron that the proof begins with: 1,280 triangles."""
PATCHES = 80
"""Most local minima of the sample that are refined, the least first."""
RING = 1e-6
"""Angle within which a local minimum is compared with its surroundings."""
NOISE = 1e-14
"""Roundoff of s(n), over the pair's size."""
SAME = 1e-5
"""Angle below which two minima are one."""
SLOPE = 1e-5
"""Angle of the differences that give the second derivatives of a smooth s(n)."""
POLISHES = 6
STATIONARY = 2e-5
"""Error of the deepest points, over the pair's size, from which a direction is not a minimum."""
ROUNDS = 12
"""Times that a patch is laid anew around the lowest point of its rim."""
PATCH = 0.08
"""Radius of such a patch, radians: a cell of the sample."""


@dataclass(frozen=True)
class Depth:
    """The local minima of s(n), the least first, and a proven lower bound of the least.

    ``minima[0].depth`` is the penetration depth, within ``minima[0].depth - lower`` at most.
    """

    minima: list[Contact]
    lower: float

    @property
    def least(self) -> Contact:
        return self.minima[0]


class Difference:
    """The difference A - B, whose support function is s(n); measured from A's origin."""

    def __init__(self, a: Placed, b: Placed) -> None:
        self.a, self.b = a, b
        self.between: Array = b.position - a.position
        self.planar = a.shape.dimension == b.shape.dimension == 2
        self.size = pair_size(a, b)

    def points(self, normals: Array) -> Array:
        """Return the difference's support points (k, 3)."""
        return self.a.relative(normals)[1] - self.b.relative(-normals)[1] - self.between

    def support(self, normals: Array) -> Array:
        """Return s (k,) at unit directions (k, 3)."""
        return np.asarray((normals * self.points(normals)).sum(axis=1))


@lru_cache
def sphere(halvings: int) -> tuple[Array, Array]:
    """Return the vertices (k, 3) and triangles (m, 3) of a halved icosahedron."""
    g = (1 + 5**0.5) / 2
    rows = [(0, i, j * g) for i in (-1, 1) for j in (-1, 1)]
    vertices = unit(np.array([np.roll(row, k) for row in rows for k in range(3)], dtype=float))
    hull: Any = ConvexHull(vertices)
    cells = vertices[hull.simplices]
    for _ in range(halvings):
        cells = halve(cells)
    found, index = np.unique(np.round(cells.reshape(-1, 3), 12), axis=0, return_inverse=True)
    return unit(found), index.reshape(-1, 3)


@lru_cache
def circle(count: int) -> tuple[Array, Array]:
    """Return ``count`` directions of the plane and the arcs (count, 2) between them."""
    angle = 2 * np.pi * (np.arange(count) + 0.5) / count
    rows = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    return rows, np.stack([np.arange(count), np.roll(np.arange(count), -1)], axis=1)


def halve(cells: Array) -> Array:
    """Return the two halves of arcs (m, 2, 3), or the four quarters of triangles (m, 3, 3)."""
    if cells.shape[1] == 2:
        a, b = cells[:, 0], cells[:, 1]
        c = unit(a + b)
        return np.stack([np.stack([a, c], axis=1), np.stack([c, b], axis=1)], axis=1).reshape(
            -1, 2, 3
        )
    a, b, c = cells[:, 0], cells[:, 1], cells[:, 2]
    d, e, f = unit(b + c), unit(c + a), unit(a + b)
    quarters = [(a, f, e), (f, b, d), (e, d, c), (d, e, f)]
    return np.stack([np.stack(q, axis=1) for q in quarters], axis=1).reshape(-1, 3, 3)


def lower_bounds(cells: Array, points: Array) -> Array:
    """Return lower bounds (m,) of s on cells from the support points of their corners.

    On the flat cell, N = sum of shares times corners, ``h(N) >= w.N`` for every support point w,
    and for any mean of them; the least of a linear function is at a corner. The best mean of two
    support points has two corners equal: without it the valleys of edges are followed cell by
    cell. Then ``s = h(N)/|N|``, and |N| lies between the root of the corners' least cosine and 1.
    """
    planes = np.einsum("mki,mji->mkj", points, cells)
    value = planes.min(axis=2).max(axis=1)
    pairs = list(combinations(range(cells.shape[1]), 2))
    for one, other in pairs:
        first, second = planes[:, one], planes[:, other]
        for i, j in pairs:
            rise, fall = first[:, i] - first[:, j], second[:, i] - second[:, j]
            crossing = rise * fall < 0
            share = fall / np.where(crossing, fall - rise, 1)
            mean = second + np.clip(share, 0, 1)[:, None] * (first - second)
            value = np.where(crossing, np.maximum(value, mean.min(axis=1)), value)
    shortest = np.sqrt(np.einsum("mki,mji->mkj", cells, cells).min(axis=(1, 2)))
    return np.where(value > 0, value, value / shortest)


def least_values(pair: Difference, cells: Array, owners: Array) -> tuple[Array, Array, Array]:
    """Return for each owner of cells the best normal, its s, and a lower bound of all its s.

    Cells (m, 2 or 3, 3) belong to ``owners`` (m,), numbered from 0.
    """
    count = int(owners.max()) + 1
    best, lower = np.full(count, np.inf), np.full(count, np.inf)
    normals = np.zeros((count, 3))
    corners = cells.shape[1]
    for _ in range(LEVELS):
        rows = cells.reshape(-1, 3)
        points = pair.points(rows)
        values, whose = (rows * points).sum(axis=1), np.repeat(owners, corners)
        order = np.lexsort((values, whose))
        first = order[np.unique(whose[order], return_index=True)[1]]
        better = first[values[first] < best[whose[first]]]
        best[whose[better]], normals[whose[better]] = values[better], rows[better]
        bounds = lower_bounds(cells, points.reshape(cells.shape))
        goal = best[owners] - TOLERANCE * pair.size
        kept = np.flatnonzero(bounds < goal)
        kept = kept[np.argsort(bounds[kept], kind="stable")]
        np.minimum.at(lower, owners[kept[CELLS:]], bounds[kept[CELLS:]])
        kept = kept[:CELLS]
        left = np.full(count, np.inf)
        np.minimum.at(left, owners[kept], bounds[kept])
        if not len(kept):
            break
        cells = halve(cells[kept])
        owners = np.repeat(owners[kept], len(cells) // len(kept))
    proven = np.minimum(best - TOLERANCE * pair.size, np.minimum(lower, left))
    return normals, best, proven


def sampled_minima(pair: Difference) -> tuple[Array, Array]:
    """Return the cells around the local minima of a sample of s, and their numbers."""
    rows, cells = circle(4096) if pair.planar else sphere(FINE)
    values = pair.support(rows)
    rank = np.empty(len(values), dtype=int)
    rank[np.argsort(values, kind="stable")] = np.arange(len(values))
    lowest = np.ones(len(values), dtype=bool)
    for one in range(cells.shape[1]):
        for other in range(cells.shape[1]):
            lowest[cells[rank[cells[:, other]] < rank[cells[:, one]], one]] = False
    chosen = np.flatnonzero(lowest)
    chosen = chosen[np.argsort(rank[chosen])][:PATCHES]
    around, owners = [], []
    for number, vertex in enumerate(chosen):
        own = np.flatnonzero((cells == vertex).any(axis=1))
        around.append(rows[cells[own]])
        owners.append(np.full(len(own), number))
    return np.concatenate(around), np.concatenate(owners)


def patches(normals: Array, planar: bool) -> tuple[Array, Array]:
    """Return the cells of patches around directions (k, 3), hexagons or arcs, and their numbers."""
    count = 2 if planar else 6
    angle = 2 * np.pi * np.arange(count) / count
    cells = []
    for n in normals:
        first, second = tangents(n, planar)
        rim = unit(n + PATCH * (np.outer(np.cos(angle), first) + np.outer(np.sin(angle), second)))
        middle = np.broadcast_to(n, rim.shape)
        corners = [middle, rim] if planar else [middle, rim, np.roll(rim, -1, axis=0)]
        cells.append(np.stack(corners, axis=1))
    return np.concatenate(cells), np.repeat(np.arange(len(normals)), count)


def is_minimum(pair: Difference, normal: Array, value: float) -> bool:
    """Is s nowhere less on a small ring around a direction (in the plane: beside it)?"""
    first, second = tangents(normal, pair.planar)
    angle = 2 * np.pi * np.arange(2 if pair.planar else 24) / (2 if pair.planar else 24)
    ring = unit(normal + RING * (np.outer(np.cos(angle), first) + np.outer(np.sin(angle), second)))
    return bool(pair.support(ring).min() >= value - NOISE * pair.size)


def polish(pair: Difference, normal: Array) -> Array:
    """Newton's method on the slope of s; steps that do not lessen the slope are not taken."""
    frame = np.stack(tangents(normal, pair.planar)[: 1 if pair.planar else 2])
    n = normal
    value = pair.points(n[None])[0]
    for _ in range(POLISHES):
        slope = frame @ (value - (value @ n) * n)
        ends = pair.points(np.concatenate([n + SLOPE * frame, n - SLOPE * frame]))
        bend = (ends[: len(frame)] - ends[len(frame) :]) @ frame.T / (2 * SLOPE)
        bend = (bend + bend.T) / 2 - (value @ n) * np.eye(len(frame))
        step = np.linalg.lstsq(bend, -slope, rcond=None)[0] @ frame
        trial = unit((n + step)[None])[0]
        following = pair.points(trial[None])[0]
        rest = frame @ (following - (following @ trial) * trial)
        better = np.abs(rest).max() < np.abs(slope).max()
        if not (better and following @ trial <= value @ n + NOISE * pair.size):
            break
        n, value = trial, following
    return n


def _along_plane(a: Placed, b: Placed) -> Depth | None:
    """The answer where one body is a half-space: its own normal is the only direction."""
    if not (isinstance(a.shape, HalfSpace) or isinstance(b.shape, HalfSpace)):
        return None
    n = a.rotation[:, 2] if isinstance(a.shape, HalfSpace) else -b.rotation[:, 2]
    value = -separation(a, b, n)
    nowhere = np.full(3, np.nan)
    return Depth([Contact(n, value, nowhere, nowhere, "face", "vertex", 3, 0.0)], value)


def least_depth(a: Placed, b: Placed) -> tuple[Array, float, float]:
    """Return (normal, depth, lower): the least s(n), where, and what it is proven not to exceed.

    Negative where the bodies are apart: minus their distance.
    """
    known = _along_plane(a, b)
    if known is not None:
        return known.least.normal, known.least.depth, known.lower
    pair = Difference(a, b)
    rows, cells = circle(64) if pair.planar else sphere(COARSE)
    normals, _, lower = least_values(pair, rows[cells], np.zeros(len(cells), dtype=int))
    n = polish(pair, normals[0])
    return n, float(pair.support(n[None])[0]), float(lower[0])


def searched_minima(a: Placed, b: Placed) -> list[Contact]:
    """Return the local minima of s(n) that a sample of directions leads to.

    A patch whose lowest point is not stationary is laid anew around it: s falls beyond its rim.
    """
    pair = Difference(a, b)
    found: list[Contact] = []
    cells, owners = sampled_minima(pair)
    for _ in range(ROUNDS):
        normals, values, _ = least_values(pair, cells, owners)
        astray = []
        for n, s in zip(normals, values, strict=True):
            one = contact(a, b, polish(pair, n)) if is_minimum(pair, n, s) else None
            if one is None or one.error > STATIONARY * pair.size:
                astray.append(n)
            elif all(np.linalg.norm(one.normal - other.normal) > SAME for other in found):
                found.append(one)
        if not astray:
            break
        cells, owners = patches(np.array(astray), pair.planar)
    return found


def depth_minima(a: Placed, b: Placed) -> Depth:
    """Return the local minima of s(n) and the proven least.

    All of them where both bodies are polytopes whose cores overlap, by enumeration; else those
    that the sample resolves, its spacing being 0.07 rad: the least is among them in any case.
    """
    known = _along_plane(a, b)
    if known is not None:
        return known
    least, _, lower = least_depth(a, b)
    try:
        found = [contact(a, b, n) for n in polytope_minima(a, b)[1]]
    except (TypeError, ValueError):  # no two polytopes, or cores apart
        found = searched_minima(a, b)
    if all(np.linalg.norm(least - one.normal) > SAME for one in found):
        found.append(contact(a, b, least))
    return Depth(sorted(found, key=lambda minimum: minimum.depth), lower)
