"""Proofs that two bodies overlap: a point that both have, found among boundary samples."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog

from standoff.bodies.body import Body
from standoff.kernels import layout as L

Array = NDArray[np.float64]


def sample_points(body: Body) -> Array:
    """The body's boundary samples, (n, 3), body frame."""
    n = int(body.ints[L.N_SAMPLES])
    start = int(body.ints[L.SAMPLE_REALS])
    rows = body.reals[start : start + L.SAMPLE_STRIDE * n].reshape(n, L.SAMPLE_STRIDE)
    return np.asarray(rows[:, :3])


def reaches_into(body: Body, rotation: Array, position: Array) -> bool:
    """Does a body come to z <= 0, a half-space's inside, when posed in the half-space's frame?

    A sample below, or within the swept radius of, the plane proves it.
    """
    heights = sample_points(body) @ rotation[2] + position[2]
    return bool(heights.min() <= body.radius)


def hulls_meet(a: Array, b: Array) -> bool:
    """Do the convex hulls of two sets of points, (n, 3) and (m, 3), share a point? By LP."""
    n, m = len(a), len(b)
    scale = max(np.abs(a).max(), np.abs(b).max(), 1e-300)
    rows = np.zeros((5, n + m))
    rows[:3, :n] = a.T / scale
    rows[:3, n:] = -b.T / scale
    rows[3, :n] = 1.0
    rows[4, n:] = 1.0
    answer = linprog(np.zeros(n + m), A_eq=rows, b_eq=np.array([0.0, 0, 0, 1, 1]), bounds=(0, None))
    return bool(answer.status == 0)
