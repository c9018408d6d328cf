"""A point beside a solid."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.motion.pose import Pose
from standoff.solids.spatial.leaves import vertex_leaf
from standoff.solids.spatial.points import POINT
from standoff.solids.spatial.solid_model import SolidModel
from standoff.typing import Array


class BarePoint(SolidModel):
    """A body of one vertex without a radius: searched as the origin of a frame that is at it."""

    def __init__(self, body: Body) -> None:
        self._given = self.boundary = body
        self._origins = {}
        self.own, self.numbers = POINT[2:]
        self.leaves = [vertex_leaf(body, 0)]
        self.edges_sampled = ()
        self.vertex_normals = None
        self.vertex_fans = None
        self.references = np.zeros((1, 3))

    @property
    def packed(self) -> tuple[NDArray[np.int64], Array, NDArray[np.int64], Array]:
        """That of the origin."""
        return POINT

    def placed(self, pose: Pose) -> tuple[Array, Array]:
        """(rotation, the point) in the world."""
        turn = np.asarray(pose.rotation)
        point = np.asarray(self.boundary.vertex_points[0])
        return turn, turn @ point + np.asarray(pose.translation)

    def may_hold(self, point: Array) -> bool:
        """It has no inside."""
        return False
