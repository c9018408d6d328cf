"""Pairs of ellipsoids whose distance, witness points and normal are known by construction."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from oracles.exact_pairs import ExactPair, exact_pair
from standoff_studies.oracles import Ellipsoid, Placed

Array = NDArray[np.float64]

RATIOS = (2.0, 10.0, 30.0, 100.0)
"""Greatest ratio of each ellipsoid's axes: the longest is 1, one shortest 1/ratio."""
GAPS = (1e-3, 1.0)
"""Range of the gaps, over the pair's size."""
PER_PAIR = 50
"""Poses of one pair of ellipsoids."""
SIZE = 2.0
"""The pair's size, the greater diameter: the longest semi-axes are 1."""


@dataclass(frozen=True)
class EllipsoidPair:
    """Semi-axes (3,) of two ellipsoids and their poses."""

    axes_a: Array
    axes_b: Array
    poses: list[ExactPair]


def _axes(ratio: float, rng: np.random.Generator) -> Array:
    axes = np.exp(rng.uniform(-np.log(ratio), 0.0, 3))
    first, second = rng.permutation(3)[:2]
    axes[first], axes[second] = 1.0, 1.0 / ratio
    return axes


def draw_pairs(ratio: float, count: int, rng: np.random.Generator) -> Iterator[EllipsoidPair]:
    """Yield pairs of ellipsoids with together ``count`` poses, rounded up to whole pairs."""
    low, high = np.log(GAPS)
    for _ in range(-(-count // PER_PAIR)):
        first, second = _axes(ratio, rng), _axes(ratio, rng)
        a, b = Ellipsoid(*first), Ellipsoid(*second)
        gaps = SIZE * np.exp(rng.uniform(low, high, PER_PAIR))
        poses = [exact_pair(a, b, gap, rng, position_a=rng.normal(size=3)) for gap in gaps]
        yield EllipsoidPair(first, second, poses)


def _shape_operator(body: Placed, point: Array, tangents: Array) -> Array:
    """Return an ellipsoid's (2, 2) shape operator at a world point, in unit tangents (3, 2)."""
    axes = body.shape.axes
    quadric = body.rotation @ np.diag(axes**-2.0) @ body.rotation.T
    gradient = quadric @ (point - body.position)
    return np.asarray(tangents.T @ quadric @ tangents / np.linalg.norm(gradient))


def condition(pair: ExactPair) -> float:
    """Return the condition number of the Hessian of E = |dR|^2/2 in the metric of the tangents.

    In unit tangents T of the common tangent planes the Hessian at the optimum is
    ``[[1 + d S_A, -1], [-1, 1 + d S_B]]`` with the shape operators S: no parametrisation and
    no unit enters. Errors of the witness points, over the size, are a few eps times this.
    """
    tangents = np.linalg.svd(pair.normal[None])[2][1:].T
    first = _shape_operator(pair.a, pair.point_a, tangents)
    second = _shape_operator(pair.b, pair.point_b, tangents)
    one, d = np.eye(2), pair.distance
    hessian = np.block([[one + d * first, -one], [-one, one + d * second]])
    values = np.linalg.eigvalsh(hessian)
    return float(values[-1] / values[0])
