"""Coal 3: GJK and EPA on support functions (``coal.DistanceRequest``)."""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff_studies.accuracy.peers.answer import (
    SAME_LENGTHS,
    Peer,
    PeerAnswer,
    Pose,
    Query,
    once_a_solid,
    require,
)
from standoff_studies.accuracy.solids import Solid
from standoff_studies.oracles import Polytope, Swept

TIGHTEST = 1e-12
"""Relative GJK tolerance (no unit) of the tight query. Measured on exact ellipsoid pairs, axes
ratios to 10: a tighter one leaves the worst witness errors as they are and makes the worst
distances less accurate; a looser one makes the witnesses less accurate."""
ITERATIONS = 10_000
"""GJK iterations of the tight query, so that the tolerance decides. EPA, which only penetration
uses, keeps its defaults: tightened alike, it fails on two spheres and reports -1.8e308."""


def coal_request(tight: bool = False) -> Any:
    """Return Coal's distance request: its defaults, or the tightest that pays."""
    request = require("coal").DistanceRequest()
    if tight:
        request.gjk_tolerance = TIGHTEST
        request.gjk_max_iterations = ITERATIONS
    return request


@once_a_solid
def coal_shape(solid: Solid) -> Any:
    """Return Coal's shape; None where it has none. A point is a ball without radius."""
    coal = require("coal")
    lengths, support = solid.lengths, solid.support
    if solid.kind.name in SAME_LENGTHS:
        return getattr(coal, SAME_LENGTHS[solid.kind.name])(*lengths)
    match solid.kind.name:
        case "point":
            return coal.Sphere(0.0)
        case "segment":
            return coal.Capsule(0.0, *lengths)
        case "halfspace":
            return coal.Halfspace(np.array([0.0, 0.0, 1.0]), 0.0)
        case "rounded box":
            *sides, rounding = lengths
            core = coal.Box(*(side - 2 * rounding for side in sides))
            core.setSweptSphereRadius(rounding)
            return core
        case "polytope":
            assert isinstance(support, Polytope)
            return _hull(support)
        case "rounded polytope":
            assert isinstance(support, Swept)
            assert isinstance(support.core, Polytope)
            shape = _hull(support.core)
            shape.setSweptSphereRadius(support.sweep)
            return shape
    return None


def _hull(hull: Polytope) -> Any:
    coal = require("coal")
    points = coal.StdVec_Vec3s()
    for vertex in hull.vertices:
        points.append(vertex)
    return coal.Convex.convexHull(points, False, None)


class Coal(Peer):
    """Coal at its defaults (1e-6), or at the tightest tolerance that pays."""

    package = "coal"

    def __init__(self, tight: bool = False) -> None:
        self.name = "Coal, tight" if tight else "Coal, default"
        self.tight = tight

    def query(self, a: Solid, b: Solid) -> Query | None:
        """The normal is the one that Coal reports."""
        coal = require("coal")
        shape_a, shape_b = coal_shape(a), coal_shape(b)
        if shape_a is None or shape_b is None:
            return None
        request, result = coal_request(self.tight), coal.DistanceResult()

        def query(pose_a: Pose, pose_b: Pose) -> PeerAnswer:
            result.clear()
            place_a, place_b = coal.Transform3s(*pose_a), coal.Transform3s(*pose_b)
            distance = coal.distance(shape_a, place_a, shape_b, place_b, request, result)
            return PeerAnswer(
                float(distance),
                np.array(result.getNearestPoint1()),
                np.array(result.getNearestPoint2()),
                np.array(result.normal),
            )

        return query
