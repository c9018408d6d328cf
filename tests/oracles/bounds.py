"""Independent lower bounds of the distance, and the distance itself by cutting planes.

For any unit ``n`` two convex bodies are at least ``separation(n) = -(s_A(n) + s_B(-n))`` apart,
and the greatest separation is their distance. It needs only the support functions.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import minimize, nnls

from standoff_studies.oracles import HalfSpace, Placed, directions, unit

Array = NDArray[Any]

PLANE_ALIGNMENT = 1e-6
"""Greatest |n - plane normal| at which the plane's own normal replaces ``n`` (half-spaces)."""
BRACKET = 1e-13
"""Width, over the pair's size, at which the bracket of the distance is closed."""
ITERATIONS = 300
"""Cutting planes before giving up; smooth pairs need about 10 to 40."""
STARTS = 400
"""Directions that start the search for the greatest separation of an overlapping pair."""


@dataclass(frozen=True)
class Separation:
    """Greatest separation of two bodies.

    Attributes
    ----------
    value : float
        The greatest separation found: the distance, or minus a penetration depth.
    upper : float
        An upper bound of the distance (0 if they overlap); the truth lies in [value, upper].
    normal : (3,)
        World unit direction from A to B that attains ``value``.
    point_a, point_b : (3,)
        Points of the bodies that attain ``upper`` (NaN if they overlap).
    """

    value: float
    upper: float
    normal: Array
    point_a: Array
    point_b: Array


def pair_size(a: Placed, b: Placed) -> float:
    """Return the greater finite diameter of the two bodies (1 if there is none)."""
    sizes = [2 * body.shape.bounding_radius for body in (a, b)]
    finite = [size for size in sizes if np.isfinite(size) and size > 0]
    return max(finite, default=1.0)


def _plane_normal(a: Placed, b: Placed) -> Array | None:
    """Return the direction A to B that a half-space dictates, or None."""
    if isinstance(b.shape, HalfSpace):
        return -b.rotation[:, 2]
    if isinstance(a.shape, HalfSpace):
        return a.rotation[:, 2]
    return None


def _along_plane(a: Placed, b: Placed, normal: Array) -> float:
    """Separation along a half-space's own normal, its support set to 0 exactly."""
    support_a = 0.0 if isinstance(a.shape, HalfSpace) else a.relative(normal)[0][0]
    support_b = 0.0 if isinstance(b.shape, HalfSpace) else b.relative(-normal)[0][0]
    return float(normal @ (b.position - a.position) - support_a - support_b)


def separation_many(a: Placed, b: Placed, normals: ArrayLike) -> Array:
    """Return the separations (k,) along world directions (k, 3), normalised first."""
    rows = unit(directions(normals))
    plane = _plane_normal(a, b)
    if plane is not None:
        if isinstance(a.shape, HalfSpace) and isinstance(b.shape, HalfSpace):
            both = np.linalg.norm(a.rotation[:, 2] + b.rotation[:, 2]) <= PLANE_ALIGNMENT
            value = _along_plane(a, b, plane) if both else -np.inf
        else:
            value = _along_plane(a, b, plane)
        aligned = np.linalg.norm(rows - plane, axis=1) <= PLANE_ALIGNMENT
        return np.where(aligned, value, -np.inf)
    support_a = a.relative(rows)[0]
    support_b = b.relative(-rows)[0]
    return rows @ (b.position - a.position) - support_a - support_b


def separation(a: Placed, b: Placed, normal: ArrayLike) -> float:
    """Return the separation along one world direction from A to B (made a unit vector).

    It is a lower bound of the signed distance. With a half-space, directions other than its
    normal give -inf; within ``PLANE_ALIGNMENT`` of it its own normal is taken.
    """
    return float(separation_many(a, b, normal)[0])


def gap(distance: float, a: Placed, b: Placed, normal: ArrayLike) -> float:
    """Return ``distance`` minus the separation along ``normal``: 0 proves the distance."""
    return float(distance) - separation(a, b, normal)


def _difference(a: Placed, b: Placed, normal: Array) -> tuple[Array, Array]:
    """Return support points of A along ``normal`` and B against it, from A's origin."""
    return a.relative(normal)[1][0], b.relative(-normal)[1][0] + (b.position - a.position)


def _nearest_direction(columns: Array) -> tuple[Array | None, Array]:
    """Return n of least norm with ``n.w >= 1`` for the rows of ``columns``, and weights.

    Lawson and Hanson's least-distance programming: 1/|n| is the distance from the origin to
    the convex hull of the rows; None if the origin lies in it.
    """
    matrix = np.vstack([columns.T, np.ones(len(columns))])
    weights, _ = nnls(matrix, np.array([0.0, 0.0, 0.0, 1.0]), maxiter=50 * len(columns) + 200)
    residual = matrix @ weights - np.array([0.0, 0.0, 0.0, 1.0])
    if -residual[3] <= 0:
        return None, weights
    return -residual[:3] / residual[3], weights


def cut(a: Placed, b: Placed, start: Array) -> Separation | None:
    """Bracket the distance of two separated bodies; None once they are shown to overlap."""
    size = pair_size(a, b) + float(np.linalg.norm(b.position - a.position))
    normal = unit(start[None])[0]
    firsts: list[Array] = []
    seconds: list[Array] = []
    best = Separation(-np.inf, np.inf, normal, np.full(3, np.nan), np.full(3, np.nan))
    for _ in range(ITERATIONS):
        x, y = _difference(a, b, normal)
        value = float(normal @ (y - x))
        firsts.append(x)
        seconds.append(y)
        if value > best.value:
            best = Separation(value, best.upper, normal, best.point_a, best.point_b)
        rows = np.stack(seconds) - np.stack(firsts)
        scale = float(np.linalg.norm(rows, axis=1).min())
        found, weights = _nearest_direction(rows / scale) if scale > 0 else (None, rows[:, 0])
        if found is None or not np.isfinite(found).all() or scale / size <= BRACKET:
            return None
        shares = weights / weights.sum()
        point_a, point_b = shares @ np.stack(firsts), shares @ np.stack(seconds)
        upper = float(np.linalg.norm(point_b - point_a))
        if upper < best.upper:
            best = Separation(
                best.value, upper, best.normal, point_a + a.position, point_b + a.position
            )
        if best.upper <= BRACKET * size:
            return None
        following = unit(found[None])[0]
        if best.upper - best.value <= BRACKET * size or (following == normal).all():
            return best
        normal = following
    return best


def _deepest(a: Placed, b: Placed, start: Array) -> Separation:
    """Search the greatest separation of an overlapping pair: minus its penetration depth."""
    planar = a.shape.dimension == b.shape.dimension == 2
    rng = np.random.default_rng(0)
    tries = np.vstack([start, rng.normal(size=(STARTS, 3))])
    if planar:
        tries[:, 2] = 0.0
    values = separation_many(a, b, tries)
    best_value, best_normal = float(values.max()), unit(tries)[values.argmax()]
    for index in np.argsort(values)[-6:]:
        result = minimize(
            lambda n: -separation(a, b, n * np.array([1, 1, 0]) if planar else n),
            unit(tries)[index],
            method="Nelder-Mead",
            options={"xatol": 1e-10, "fatol": 1e-14, "maxfev": 2000},
        )
        if -result.fun > best_value:
            best_value, best_normal = -float(result.fun), unit(result.x[None])[0]
    if planar:
        best_normal = unit((best_normal * np.array([1, 1, 0]))[None])[0]
    nowhere = np.full(3, np.nan)
    return Separation(best_value, 0.0, best_normal, nowhere, nowhere)


def maximise_separation(a: Placed, b: Placed, n0: ArrayLike | None = None) -> Separation:
    """Return the greatest separation over unit directions, without any help from the library.

    Separated bodies: cutting planes on the Minkowski difference, every iterate a lower and an
    upper bound of the distance; the bracket usually closes to ``BRACKET``. Overlapping ones: a
    search from several directions, so ``value`` may be a local maximum. ``n0`` is the first
    direction (default: from A's position to B's).
    """
    plane = _plane_normal(a, b)
    if plane is not None:
        value = separation(a, b, plane)
        nowhere = np.full(3, np.nan)
        return Separation(value, max(value, 0.0), plane, nowhere, nowhere)
    start = b.position - a.position if n0 is None else np.asarray(n0, dtype=float)
    if not np.linalg.norm(start) > 0:
        start = np.array([1.0, 0.0, 0.0])
    return cut(a, b, start) or _deepest(a, b, start)


def overlap(a: Placed, b: Placed) -> bool:
    """Return whether the bodies overlap or touch: no direction separates them.

    Touching is meant within ``BRACKET`` of the pair's size.
    """
    if _plane_normal(a, b) is not None:
        return maximise_separation(a, b).value <= 0
    start = b.position - a.position
    found = cut(a, b, start if np.linalg.norm(start) > 0 else np.array([1.0, 0.0, 0.0]))
    return found is None or found.value <= 0
