"""The least depth of two overlapping bodies, from support points alone.

The depth is the least value of s(n) = h_A(n) + h_B(-n), the support function of the difference
A - B, which contains the origin. It is computed in two independent ways: s over a fixed set of
directions, and an inner polytope of A - B that is grown at the faces nearest to the origin. The
least distance of a face is a lower bound, and the least s along the faces' normals an upper bound.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from standoff_studies.accuracy.solids import DIRECTIONS, Solid
from standoff_studies.accuracy.truth import Truth, difference_points, support_sum
from standoff_studies.oracles import Array

RINGS = (1e-4, 1e-3, 1e-2, 0.05, 0.1, 0.2)
"""Angles (rad) from a normal at which s is evaluated: the sampled directions are 0.08 apart."""
SPOKES = 24
RIVAL = 0.05
"""Margin, over the size, within which a sampled direction may be near another minimum that is below
the constructed one: the slope of s (at most the size) times half the spacing."""
ROUNDS = 40
"""Rounds of growing the polytope, each by the points of the nearest faces."""
GROWN = 24
"""Faces per round."""
SETTLED = 1e-8
"""Gap between the bounds, over the size, at which growing ends."""


def sampled(a: Solid, b: Solid, truth: Truth) -> tuple[Array, Array]:
    """Return world directions (k, 3), fixed in A's frame, and s(n) (k,) along them."""
    turn, p_a = truth.pose_a
    normals = DIRECTIONS @ turn.T
    height_b = b.support.heights(-normals @ truth.pose_b[0])
    return normals, a.sampled + height_b - normals @ (truth.pose_b[1] - p_a)


def ring_least(a: Solid, b: Solid, truth: Truth) -> float:
    """Return the least s(n) over rings of directions around the true normal."""
    n = truth.normal
    first = np.cross(n, np.eye(3)[np.abs(n).argmin()])
    first /= np.linalg.norm(first)
    second = np.cross(n, first)
    angle = 2 * np.pi * np.arange(SPOKES) / SPOKES
    around = np.cos(angle)[:, None] * first + np.sin(angle)[:, None] * second
    rings = [np.cos(r) * n + np.sin(r) * around for r in RINGS]
    return float(support_sum(a, b, truth, np.concatenate(rings)).min())


def least_bounds(
    a: Solid, b: Solid, truth: Truth, size: float, slack: float
) -> tuple[float, float]:
    """Return bounds (length) of the least depth: the constructed one twice if none is smaller.

    With a half-space only one direction is possible. Otherwise the polytope is grown if a direction
    is shallower by more than ``slack``, or if one far from the normal is nearly as shallow.
    """
    depth = -truth.distance
    if not (a.bounded and b.bounded):
        return depth, depth
    normals, heights = sampled(a, b, truth)
    far = normals @ truth.normal < np.cos(RINGS[-1])
    least = min(float(heights.min()), ring_least(a, b, truth))
    rival = float(heights[far].min())
    if least >= depth - slack and rival >= depth + RIVAL * size:
        return depth, depth
    lower, upper = least_depth(a, b, truth, size)
    return (lower, upper) if upper < depth - slack else (depth, depth)


def least_depth(a: Solid, b: Solid, truth: Truth, size: float) -> tuple[float, float]:
    """Return a lower and an upper bound (length) of the least depth."""
    points = difference_points(a, b, truth, DIRECTIONS)
    upper = float(support_sum(a, b, truth, DIRECTIONS).min())
    lower = -np.inf
    try:
        hull = ConvexHull(points, incremental=True)
        for _ in range(ROUNDS):
            depths = -hull.equations[:, 3]
            nearest = np.unique(hull.equations[depths.argsort()[:GROWN]], axis=0)
            lower = float(depths.min())
            normals = nearest[:, :3]
            upper = min(upper, float(support_sum(a, b, truth, normals).min()))
            if upper - lower <= SETTLED * size:
                break
            hull.add_points(difference_points(a, b, truth, normals))
    except QhullError:
        # a difference without volume, or points too close together: return what is known so far
        pass
    return lower, upper
