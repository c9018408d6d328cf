"""Answers made from known witness points, so that what is asked of an answer is tested alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

import standoff as so
from oracles.exact_pairs import random_rotation
from standoff.kernels.state import arrays as K

Array = NDArray[np.float64]


def made_answer(
    a: so.Body, b: so.Body, x: ArrayLike, normal: ArrayLike, distance: float
) -> so.Proximity:
    """Return the answer with the witness points x and x + distance * normal, world."""
    out = np.zeros(K.N_OUT)
    n = np.asarray(normal, dtype=float)
    out[K.DISTANCE] = out[K.LOWER_BOUND] = distance
    out[K.POINT_A : K.POINT_A + 3] = x
    out[K.POINT_B : K.POINT_B + 3] = np.asarray(x, dtype=float) + distance * n
    out[K.NORMAL : K.NORMAL + 3] = n
    return so.Proximity(a, b, out)


def random_pose(rng: np.random.Generator, reach: float, planar: bool = False) -> so.Pose:
    """Return a random rotation and a position of some length."""
    p = reach * rng.normal(size=3)
    if planar:
        p[2] = 0.0
    return so.Pose(random_rotation(rng, planar), p)


def same_points(found: Array, expected: Array, tolerance: float) -> bool:
    """Whether two sets of points are the same, in any order."""
    apart = np.linalg.norm(found[:, None] - expected[None], axis=2)
    return bool(apart.min(axis=0).max() <= tolerance and apart.min(axis=1).max() <= tolerance)


def convex_mix(points: Array, rng: np.random.Generator) -> Array:
    """Return a random point of a convex hull."""
    return np.asarray(rng.dirichlet(np.ones(len(points))) @ points)
