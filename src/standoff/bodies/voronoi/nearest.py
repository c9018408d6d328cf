"""The feature nearest to a point, by a search over the whole boundary."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from standoff.bodies.body import Body
from standoff.bodies.features import Feature
from standoff.bodies.voronoi.discs import edge_distances
from standoff.bodies.voronoi.outline import Outline, outline_of
from standoff.bodies.voronoi.search import Boundary
from standoff.checks.arrays import finite
from standoff.checks.real_numbers import shape_of
from standoff.errors import StandoffError
from standoff.typing import Array

# Number of bodies whose sampled boundaries are cached.
KEPT = 16


def nearest_feature(body: Body, point: ArrayLike) -> Feature:
    """The feature with the boundary point nearest to a point, (2,) or (3,), body frame."""
    if shape_of(point) == (2,):
        point = np.append(finite(point, "point", (2,)), 0.0)
    x = finite(point, "point", (3,))
    if body.dimension == 3:
        return _boundary(body).nearest(x)
    if x[2] != 0.0:
        raise StandoffError(f"point = {x} lies off the plane z = 0 of {body!r}.", "point", point)
    return _nearest_in_plane(body, x[:2])


@lru_cache(maxsize=KEPT)
def _outline(body: Body) -> Outline:
    return outline_of(body)


@lru_cache(maxsize=KEPT)
def _boundary(body: Body) -> Boundary:
    return Boundary(body)


def _nearest_in_plane(body: Body, x: Array) -> Feature:
    outline = _outline(body)
    found = edge_distances(outline, x)
    edge, (_, (n, u)) = min(found.items(), key=lambda item: item[1][0])
    arc = outline.arc(n)
    for end, joint in ((arc.lo, n), (arc.hi, n + 1)):
        vertex = outline.joints[joint % len(outline.arcs)]
        if u == end and vertex >= 0:
            return Feature("vertex", vertex)
    return Feature("edge", edge)
