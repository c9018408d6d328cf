"""Nearest points and features by brute force: enumeration, and Kuhn-Tucker systems."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain, combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from standoff_studies.oracles import Placed, Polytope, Swept

from .bounds import maximise_separation, pair_size
from .closed_forms import segments
from .features import Feature, feature_in_world
from .surfaces import Quadrics, placed_quadrics, sweep_of

Array = NDArray[Any]

NEAR = 1e-5
"""Distance to a surface, over the pair's size, at which the bracket's points may lie on it."""
FEASIBLE = 1e-10
"""Violation of an inequality, over the pair's size, that a nearest point may have."""
STATIONARY = 1e-9
"""Residual of the multipliers, over the distance, that a nearest point may have."""
NEWTON_STEPS = 30


@dataclass(frozen=True)
class Nearest:
    """Nearest points of two bodies.

    ``point_a``, ``point_b`` (3,), ``normal`` (3,) from A to B, all in world; ``feature_a`` and
    ``feature_b`` by geometry; ``active_a`` and ``active_b`` the surfaces with a multiplier.
    """

    distance: float
    point_a: Array
    point_b: Array
    normal: Array
    feature_a: Feature
    feature_b: Feature
    active_a: tuple[int, ...] = ()
    active_b: tuple[int, ...] = ()


def _finish(
    a: Placed,
    b: Placed,
    cores: tuple[Array, Array],
    active: tuple[tuple[int, ...], tuple[int, ...]] = ((), ()),
) -> Nearest:
    """Return the answer for the nearest points of the cores: add the swept radii."""
    x, y = cores
    apart = float(np.linalg.norm(y - x))
    normal = (y - x) / apart
    first, second = sweep_of(a.shape), sweep_of(b.shape)
    point_a, point_b = x + first * normal, y - second * normal
    return Nearest(
        apart - first - second,
        point_a,
        point_b,
        normal,
        feature_in_world(a, point_a),
        feature_in_world(b, point_b),
        *active,
    )


def _polytope(body: Placed) -> Polytope:
    shape = body.shape.core if isinstance(body.shape, Swept) else body.shape
    if not isinstance(shape, Polytope):
        raise TypeError(f"{type(body.shape).__name__} is not a polytope or box")
    return shape


def _vertices_on_faces(
    vertices: Array, shape: Polytope, body: Placed
) -> tuple[float, Array, Array]:
    """Return the least distance of world vertices to the insides of a polytope's faces."""
    local = (vertices - body.position) @ body.rotation
    facets = shape.facets
    height = local @ facets.normals.T - facets.offsets
    feet = local[:, None] - height[:, :, None] * facets.normals
    slack = FEASIBLE * shape.bounding_radius
    inside = ((feet @ facets.normals.T - facets.offsets) <= slack).all(axis=2)
    height = np.where(inside & (height > 0), height, np.inf)
    vertex, face = np.unravel_index(height.argmin(), height.shape)
    foot = feet[vertex, face] @ body.rotation.T + body.position
    return float(height[vertex, face]), vertices[vertex], foot


def nearest_polytopes(a: Placed, b: Placed) -> Nearest:
    """Return the nearest points of two separated polytopes or boxes (rounding allowed).

    Every vertex against every face, and every edge against every edge: nothing else can be
    nearest. A box that is not separated from the other gives a meaningless answer.
    """
    first, second = _polytope(a), _polytope(b)
    world_a = first.vertices @ a.rotation.T + a.position
    world_b = second.vertices @ b.rotation.T + b.position
    on_b = _vertices_on_faces(world_a, second, b)
    on_a = _vertices_on_faces(world_b, first, a)
    pairs = np.indices((len(first.facets.edges), len(second.facets.edges))).reshape(2, -1)
    start_a, end_a = world_a[first.facets.edges[pairs[0]].T]
    start_b, end_b = world_b[second.facets.edges[pairs[1]].T]
    distance, x, y = segments(start_a, end_a, start_b, end_b)
    best = int(distance.argmin())
    candidates = [
        (float(distance[best]), x[best], y[best]),
        on_b,
        (on_a[0], on_a[2], on_a[1]),
    ]
    _, point_a, point_b = min(candidates, key=lambda row: row[0])
    return _finish(a, b, (point_a, point_b))


def _multipliers(gradients: Array, equality: Array, target: Array) -> tuple[Array, float]:
    """Return multipliers with ``gradients.T m = target`` (free sign on equalities)."""
    columns = np.vstack([gradients, -gradients[equality]])
    if not len(columns):
        return np.zeros(0), float(np.linalg.norm(target))
    weights, residual = nnls(columns.T, target)
    result = weights[: len(gradients)].copy()
    result[equality] -= weights[len(gradients) :]
    return result, float(residual)


def _select(system: Quadrics, active: tuple[int, ...]) -> Quadrics:
    rows = list(active)
    return Quadrics(
        tuple(system.names[i] for i in rows),
        system.hessians[rows],
        system.slopes[rows],
        system.constants[rows],
        system.equality[rows],
    )


def _newton(first: Quadrics, second: Quadrics, x: Array, y: Array, size: float) -> Array:
    """Return the stationary (x, y) of |x - y| on the given surfaces, by Newton's method."""
    m, k = len(first.names), len(second.names)
    mu = np.concatenate(
        [
            _multipliers(first.gradients(x), first.equality, y - x)[0],
            _multipliers(second.gradients(y), second.equality, x - y)[0],
        ]
    )
    z = np.concatenate([x, y])
    for _ in range(NEWTON_STEPS):
        x, y = z[:3], z[3:]
        slopes_a, slopes_b = first.gradients(x), second.gradients(y)
        matrix = np.zeros((6 + m + k, 6 + m + k))
        matrix[:3, :3] = np.eye(3) + np.tensordot(mu[:m], first.hessians, 1)
        matrix[3:6, 3:6] = np.eye(3) + np.tensordot(mu[m:], second.hessians, 1)
        matrix[:3, 3:6] = matrix[3:6, :3] = -np.eye(3)
        matrix[6 : 6 + m, :3], matrix[6 + m :, 3:6] = slopes_a, slopes_b
        matrix[:6, 6:] = matrix[6:, :6].T
        residual = np.concatenate(
            [
                x - y + mu[:m] @ slopes_a,
                y - x + mu[m:] @ slopes_b,
                first.values(x),
                second.values(y),
            ]
        )
        step = np.linalg.lstsq(matrix, -residual, rcond=1e-13)[0]
        z, mu = z + step[:6], mu + step[6:]
        if np.abs(step[:6]).max() <= 1e-16 * size:
            break
    return z


def _proves(first: Quadrics, second: Quadrics, z: Array, size: float) -> bool:
    """Return whether z = (x, y) is feasible and has multipliers: then it is the minimum."""
    x, y = z[:3], z[3:]
    if not np.isfinite(z).all():
        return False
    for system, point, target in ((first, x, y - x), (second, y, x - y)):
        off = system.distances(point)
        off[system.equality] = np.abs(off[system.equality])
        if off.max(initial=0.0) > FEASIBLE * size:
            return False
        near = np.abs(off) <= 10 * FEASIBLE * size
        _, residual = _multipliers(system.gradients(point)[near], system.equality[near], target)
        if residual > STATIONARY * float(np.linalg.norm(target)):
            return False
    return True


def _active_sets(system: Quadrics, point: Array, target: Array, size: float) -> list[Any]:
    """Return likely sets of active surfaces, the likeliest first, then all the subsets."""
    near = np.flatnonzero((np.abs(system.distances(point)) <= NEAR * size) | system.equality)
    gradients = system.gradients(point)[near]
    weights, _ = _multipliers(gradients, system.equality[near], target)
    force = np.abs(weights) * np.linalg.norm(gradients, axis=1)
    chosen = near[(force > 1e-5 * force.max(initial=0.0)) | system.equality[near]]
    fixed = tuple(np.flatnonzero(system.equality))
    free = [i for i in near if i not in fixed]
    subsets = chain.from_iterable(combinations(free, r) for r in range(1, min(len(free), 3) + 1))
    listed = [tuple(chosen), *(fixed + subset for subset in subsets), fixed]
    return list(dict.fromkeys(tuple(sorted(int(i) for i in row)) for row in listed))


def _candidates(
    a: Placed, b: Placed, systems: tuple[Quadrics, Quadrics], warm: Nearest | None, size: float
) -> Iterator[tuple[Any, Any, Array, Array]]:
    """Yield active sets and first guesses: last frame's, then those of the bracket."""
    if warm is not None:
        x, y = warm.point_a - a.position, warm.point_b - a.position
        yield warm.active_a, warm.active_b, x, y
    found = maximise_separation(a, b, None if warm is None else warm.normal)
    x = found.point_a - a.position - sweep_of(a.shape) * found.normal
    y = found.point_b - a.position + sweep_of(b.shape) * found.normal
    if not np.isfinite(x).all():
        raise ValueError(f"the bodies overlap: greatest separation {found.value:.3g}")
    for set_a in _active_sets(systems[0], x, y - x, size):
        for set_b in _active_sets(systems[1], y, x - y, size):
            yield set_a, set_b, x, y


def nearest_points(a: Placed, b: Placed, warm: Nearest | None = None) -> Nearest:
    """Return the nearest points of two separated bodies made of quadratic inequalities.

    Newton's method on the Kuhn-Tucker system of a set of active surfaces, first that of
    ``warm`` (the answer of a frame before) then those near the bracket of
    ``maximise_separation``. An answer is accepted only if it is feasible and has multipliers
    of the right sign, which proves it for convex bodies.

    Raises
    ------
    TypeError
        A shape is not made of quadratic inequalities (cone, planar loop).
    ValueError
        The bodies overlap.
    RuntimeError
        No set of surfaces was proven.
    """
    size = pair_size(a, b)
    systems = (placed_quadrics(a, a.position), placed_quadrics(b, a.position))
    for set_a, set_b, x, y in _candidates(a, b, systems, warm, size):
        chosen = (_select(systems[0], set_a), _select(systems[1], set_b))
        z = _newton(*chosen, x, y, size)
        if _proves(*systems, z, size):
            cores = (z[:3] + a.position, z[3:] + a.position)
            return _finish(a, b, cores, (set_a, set_b))
    raise RuntimeError("no set of active surfaces satisfies the Kuhn-Tucker conditions")
