"""How far a body's core reaches from the origin of its frame, about which sweeps turn it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from standoff.bodies import shapes
from standoff.bodies.body import Body
from standoff.impact.moment import Box
from standoff.kernels.body import layout as L
from standoff.tracking.many_distances import answered_rows

Array = NDArray[np.float64]

SIDE = 20
"""Directions along each side of the cube whose faces they fill: 2400 queries once per body, and a
distance that is at most 0.3 % too large."""

ROUND = 720
"""Directions in the plane of planar bodies."""


def farthest(body: Body) -> float:
    """Return a proven bound on the distance of the core's points from the origin (length).

    The farthest point is seen at its full distance along its own direction. One of the directions
    asked is within an angle of it, along which the point is at most 1 / cosine farther than the
    core's proven support.
    """
    box = Box(body)
    corner = float(np.linalg.norm(np.abs(box.middle) + box.half))
    planar = body.dimension == 2
    directions, cosine = _round() if planar else _sphere()
    far = 2.0 * (corner + box.radius)
    if far == 0.0:
        return 0.0
    # No body is wider than the segment, so that stands for its whole line.
    wall = shapes.segment([-far, 0, 0], [far, 0, 0]) if planar else shapes.halfspace()
    found = answered_rows(body, wall, np.eye(4), _facing(directions, far, planar))
    supports = far - found.lower_bound - float(body.reals[L.RADIUS])
    return min(corner, max(0.0, float(supports.max()) / cosine))


def _facing(directions: Array, far: float, planar: bool) -> Array:
    """Poses (n, 4, 4) at which a wall stands square to each direction, `far` along it."""
    poses = np.tile(np.eye(4), (len(directions), 1, 1))
    if planar:  # the line is the x axis
        axis = np.broadcast_to([0.0, 0.0, 1.0], directions.shape)
        columns = (np.cross(directions, axis), directions, axis)
    else:  # what is below z = 0
        rough = np.eye(3)[np.argmin(np.abs(directions), axis=1)]
        second = np.cross(directions, rough)
        second /= np.linalg.norm(second, axis=1)[:, None]
        columns = (second, np.cross(-directions, second), -directions)
    poses[:, :3, :3] = np.stack(columns, axis=2)
    poses[:, :3, 3] = far * directions
    return poses


def _sphere() -> tuple[Array, float]:
    """Unit vectors through the middles of squares on a cube's faces, and the least cosine between
    any direction and the nearest of them."""
    along = (2.0 * np.arange(SIDE) + 1.0) / SIDE - 1.0
    u, v = (x.ravel() for x in np.meshgrid(along, along))
    found = np.zeros((6, len(u), 3))
    for axis in range(3):
        for far, sign in enumerate((-1.0, 1.0)):
            face = found[2 * axis + far]
            face[:, axis], face[:, axis - 2], face[:, axis - 1] = sign, u, v
    directions = found.reshape(-1, 3)
    # On the faces, at the distance 1 or more, no point of a square is farther from its middle than
    # half the diagonal h; of unit length they are not farther apart, and their product is at least
    # 1 - h^2 / 2.
    half_diagonal = np.sqrt(2.0) / SIDE
    lengths = np.linalg.norm(directions, axis=1)[:, None]
    return directions / lengths, 1.0 - 0.5 * half_diagonal**2


def _round() -> tuple[Array, float]:
    angles = 2.0 * np.pi * np.arange(ROUND) / ROUND
    found = np.stack([np.cos(angles), np.sin(angles), np.zeros(ROUND)], axis=1)
    return found, float(np.cos(np.pi / ROUND))
