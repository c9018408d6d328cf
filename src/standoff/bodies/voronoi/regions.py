"""Voronoi regions of a body's features, given by what separates them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from standoff.bodies.body import Body
from standoff.bodies.features import Feature
from standoff.bodies.voronoi.discs import edge_distances
from standoff.bodies.voronoi.outline import ArcOutline, outline_of
from standoff.bodies.voronoi.search import SampledBoundary
from standoff.checks.arrays import finite
from standoff.checks.real_numbers import shape_of
from standoff.errors import StandoffError
from standoff.read_only import KeepsReadOnly
from standoff.typing import Array


class RegionBoundary(NamedTuple):
    """What separates the regions of two features outside the body: rays along outward normals.

    Attributes
    ----------
    features : (Feature, Feature)
        In a planar body, an edge and a vertex, or two edges that meet smoothly. In a spatial one, a
        face and an edge, an edge and a vertex, or a face and the vertex to which one of its sides
        is collapsed.
    origins : (n, 3) array
        Where the rays start on the body's core, body frame. For a planar body n = 1. For a spatial
        one they are n points along the edge in the first case, and n times the vertex in the
        others.
    directions : (n, 3) array
        Their unit directions, body frame.
    """

    features: tuple[Feature, Feature]
    origins: Array
    directions: Array

    def grid(self, reach: float) -> Array:
        """(n, 2, 3) points, body frame: the rays' starts and their ends at a length `reach`."""
        return np.stack([self.origins, self.origins + reach * self.directions], axis=1)


class NormalCone(NamedTuple):
    """The outward normals at a vertex: its region is the vertex plus their cone.

    Attributes
    ----------
    vertex : Feature
    point : (3,) array, body frame.
    normals : (k, 3) array
        Unit vectors that span the cone, in order around it: normals of the adjacent faces (samples
        along a collapsed side), or of the two edges in a planar body.
    """

    vertex: Feature
    point: Array
    normals: Array


class BranchEnd(NamedTuple):
    """An end of a branch of the medial axis.

    Attributes
    ----------
    kind : str
        "corner": a convex vertex, where the depth is 0. "junction": a disc touches three edges,
        or two and a circular arc. "focal": the centre of curvature at a maximum of an edge's
        curvature, where both touching points meet. "passage": a touching point passes from one edge
        to the next where they meet smoothly, and another branch continues.
    features : tuple of Feature
        The vertex of a corner, the vertices of a passage; the edges that a disc touches at a
        junction; the edge or edges of a focal point.
    """

    kind: str
    features: tuple[Feature, ...]


class MedialBranch(NamedTuple):
    """Points inside a planar body that have two nearest boundary points.

    Attributes
    ----------
    features : (Feature, Feature)
        The edges on which these two lie; the same one twice if an edge is nearest at two places.
    ends : (BranchEnd, BranchEnd)
        At the first and the last point.
    points : (n, 3) array
        A polyline, body frame, z = 0. One point for a disc's centre.
    depth : (n,) array
        Distance to the core's boundary, length: the radius of the disc inside that touches both.
    parameters : (n, 2) array
        Where it touches: the curves' own parameters on the two edges. At a focal point that belongs
        to a whole circular arc, the ends of that arc.
    """

    features: tuple[Feature, Feature]
    ends: tuple[BranchEnd, BranchEnd]
    points: Array
    depth: Array
    parameters: Array


@dataclass(frozen=True, eq=False)
class VoronoiRegions(KeepsReadOnly):
    """What separates the Voronoi regions of a body's features. Made by ``so.voronoi_regions``.

    A feature's region is the set of points whose nearest point of the boundary is on it; if the
    body has a swept radius, of the boundary of its core.

    Attributes
    ----------
    body : Body
    reach : float
        How far to draw the external boundaries, length.
    external : tuple of RegionBoundary
        Outside the body.
    medial_axis : tuple of MedialBranch
        Inside a planar body; empty for a spatial one.
    cones : tuple of NormalCone
        One for every vertex.
    """

    body: Body
    reach: float
    external: tuple[RegionBoundary, ...]
    medial_axis: tuple[MedialBranch, ...]
    cones: tuple[NormalCone, ...]

    def feature_at(self, point: ArrayLike) -> Feature:
        """The feature in whose region a point lies, found without any tracker.

        Raises ValueError: not a point, a point off a planar body's plane, or inside a spatial body.

        Parameters
        ----------
        point : (2,) or (3,) array_like, body frame
            Inside or outside a planar body (z = 0), outside a spatial one.

        Returns
        -------
        Feature
            On a boundary between regions, any of those that meet there.
        """
        return nearest_feature(self.body, point)


# The feature nearest to a point, by a search over the whole boundary.

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
def _outline(body: Body) -> ArcOutline:
    return outline_of(body)


@lru_cache(maxsize=KEPT)
def _boundary(body: Body) -> SampledBoundary:
    return SampledBoundary(body)


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
