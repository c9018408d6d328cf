"""A ball that is proven to be inside a solid, from a point of its boundary."""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff.motion import Pose
from standoff.solids.answer import Overlap
from standoff.typing import Array

INWARD_STEPS = 20
"""Steps inward that are tried: the size, and its halves."""


def ball_inside(solid: Any, pose: Pose, point: Array, normal: Array) -> Overlap:
    """The largest of the balls about some points on the normal through a point of the boundary.

    Parameters
    ----------
    solid : SolidModel or PlanarSolid
    pose : Pose
        World pose of its frame.
    point, normal : (3,) arrays
        World axes; the normal to either side.

    Returns
    -------
    Overlap
        Its radius is 0, and its centre the point, where none was found.
    """
    steps = solid.size * 0.5 ** np.arange(1.0, INWARD_STEPS + 1.0)
    centres = point + np.concatenate([steps, -steps])[:, None] * normal
    radii = _radii(solid, np.asarray((centres - pose.translation) @ pose.rotation))
    k = int(np.argmax(radii))
    if radii[k] > 0.0:
        return Overlap(centres[k], float(radii[k]), 2.0 * float(radii[k]))
    return Overlap(np.array(point), 0.0, 0.0)


def _radii(solid: Any, points: Array) -> Array:
    """Of points in the solid's frame: how deep they are inside, at least."""
    if getattr(solid, "outline", None) is not None:
        from standoff.solids.planar.tolerances import PROVEN_TO

        return np.asarray(-solid.signed_distance(points) - PROVEN_TO * solid.size)
    from standoff.solids.spatial.points import signed_distances

    return np.asarray(-signed_distances(solid, points).upper_bound)
