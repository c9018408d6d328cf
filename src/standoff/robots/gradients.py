"""Rows of derivatives by a robot's velocity, of many pairs at once."""

from __future__ import annotations

import numpy as np

from standoff.robots.kinematics import Motion
from standoff.typing import Array


def rows_by_velocity(
    normal: Array, points: tuple[Array, Array], signs: Array, motion: Motion, fold: Array | None
) -> Array:
    """(k, nv): the rate of each pair's distance by a unit of each velocity.

    It is the normal times the velocity of the point on B less that of the point on A. What moves
    both bodies alike drops out exactly, by its sign.

    Parameters
    ----------
    normal : (k, 3) array
        From A to B, world axes.
    points : pair of (k, 3) arrays
        Witness points on A and on B.
    signs : (k, ns) array
        1 where a screw moves B alone, -1 where it moves A alone, else 0.
    motion : Motion
    fold : (ns, nv) array or None
    """
    # the moment of the normal about the origin is the same at both points
    moment = np.cross(0.5 * (points[0] + points[1]), normal)
    rows: Array = (np.concatenate([normal, moment], axis=1) @ motion.screws) * signs
    return rows if fold is None else rows @ fold
