"""A proof by linear programs that two bodies overlap: the hulls of some of their points do."""

from __future__ import annotations

import numpy as np
import scipy
from numpy.typing import NDArray

from standoff_studies.oracles import Placed

Array = NDArray[np.float64]

SHRINK = 1e-8
"""The hulls are shrunk by this part of their size before they are compared, and the linear program
is solved to a tenth of it: what it calls overlap is overlap."""

ROUNDS = 60
"""Rounds of the search: each adds the support points along the last separating direction. Smooth
bodies 1e-6 of their size deep took 20 at most."""

SEEDS = 26
"""Support points that the search begins with, of each body."""


def separating_direction(a: Array, b: Array) -> Array | None:
    """A direction along which points a, (n, 3), lie below points b, (m, 3); None if their hulls
    meet. A linear program: the greatest t with w.a + t <= c <= w.b - t, |w| <= 1 by components.
    """
    centre = 0.5 * (a.mean(axis=0) + b.mean(axis=0))
    size = max(np.abs(a - centre).max(), np.abs(b - centre).max(), 1e-300)
    a, b = ((x - centre) / size for x in (a, b))
    a, b = (x + SHRINK * (x.mean(axis=0) - x) for x in (a, b))
    spatial = 1.0 if np.ptp(np.vstack([a, b])[:, 2]) > 0.0 else 0.0
    rows = np.vstack(
        [
            np.column_stack([a, -np.ones(len(a)), np.ones(len(a))]),
            np.column_stack([-b, np.ones(len(b)), np.ones(len(b))]),
        ]
    )
    answer = scipy.optimize.linprog(
        [0.0, 0.0, 0.0, 0.0, -1.0],
        A_ub=rows,
        b_ub=np.zeros(len(rows)),
        bounds=[(-1, 1), (-1, 1), (-spatial, spatial), (None, None), (0, 4)],
        options={
            "primal_feasibility_tolerance": 0.1 * SHRINK,
            "dual_feasibility_tolerance": 0.1 * SHRINK,
        },
    )
    if answer.status != 0 or answer.x[4] <= 0.1 * SHRINK:
        return None if answer.status == 0 else np.full(3, np.nan)
    return np.asarray(answer.x[:3] / np.linalg.norm(answer.x[:3]))


def hulls_meet(first: Placed, second: Placed) -> bool:
    """Do two bounded convex bodies share a point?

    While the hulls of some of their points are apart, the support points along the direction that
    parts them join; where these are apart too, so are the bodies.
    """
    planar = first.shape.dimension == second.shape.dimension == 2
    ways = np.random.default_rng(0).normal(size=(SEEDS, 3)) * ([1.0, 1.0, 0.0] if planar else 1.0)
    a, b = first.support_many(ways)[1], second.support_many(ways)[1]
    for _ in range(ROUNDS):
        w = separating_direction(a, b)
        if w is None:
            return True
        if not np.isfinite(w).all():
            return False
        top, low = first.support(w)[1], second.support(-w)[1]
        if w @ top < w @ low:
            return False
        a, b = np.vstack([a, top]), np.vstack([b, low])
    return False
