"""FCL through python-fcl: ``fcl.distance`` with signed distance and nearest points.

Its tolerances can't be set from Python. Its distance to a half-space ends the process with a
segmentation fault (0.7.0), so half-spaces are left out.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial import ConvexHull

from standoff_studies.accuracy.peers.answer import (
    SAME_LENGTHS,
    Peer,
    PeerAnswer,
    Pose,
    Query,
    by_points,
    once_a_solid,
    require,
)
from standoff_studies.accuracy.solids import Solid
from standoff_studies.oracles import Array


@once_a_solid
def fcl_shape(solid: Solid) -> Any:
    """Return FCL's shape; None where it has none."""
    fcl = require("fcl")
    if solid.kind.name in SAME_LENGTHS:
        return getattr(fcl, SAME_LENGTHS[solid.kind.name])(*solid.lengths)
    if solid.kind.name != "polytope":
        return None
    vertices = np.asarray(solid.values["vertices"])
    triangles = _outward_triangles(vertices)
    rows = np.column_stack([np.full(len(triangles), 3), triangles])
    return fcl.Convex(vertices, len(triangles), rows.ravel())


def _outward_triangles(vertices: Array) -> Array:
    """Return the hull's triangles (m, 3), counterclockwise seen from outside."""
    hull = ConvexHull(vertices)
    a, b, c = (vertices[hull.simplices[:, i]] for i in range(3))
    outward = (np.cross(b - a, c - a) * hull.equations[:, :3]).sum(axis=1) > 0
    return np.asarray(np.where(outward[:, None], hull.simplices, hull.simplices[:, ::-1]))


class Fcl(Peer):
    """python-fcl at its defaults."""

    name = "python-fcl"
    package = "python-fcl"

    def query(self, a: Solid, b: Solid) -> Query | None:
        """It reports no normal: that is the direction between its points."""
        fcl = require("fcl")
        shape_a, shape_b = fcl_shape(a), fcl_shape(b)
        if shape_a is None or shape_b is None:
            return None
        request = fcl.DistanceRequest(enable_nearest_points=True, enable_signed_distance=True)

        def query(pose_a: Pose, pose_b: Pose) -> PeerAnswer:
            objects = [
                fcl.CollisionObject(shape, fcl.Transform(*pose))
                for shape, pose in ((shape_a, pose_a), (shape_b, pose_b))
            ]
            result = fcl.DistanceResult()
            distance = fcl.distance(*objects, request, result)
            point_a, point_b = (np.array(point) for point in result.nearest_points)
            return by_points(float(distance), point_a, point_b)

        return query
