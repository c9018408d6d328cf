"""How far a body's core reaches: from the origin of its frame, about which sweeps turn it, and
along directions."""

from __future__ import annotations

import numpy as np

from standoff.bodies import shapes
from standoff.bodies.body import Body
from standoff.impact.moment import BodyBox
from standoff.kernels.body import layout as L
from standoff.tracking.many_distances import answered_rows
from standoff.typing import Array

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
    directions, cosine = directions_for(body, SIDE)
    corner, far = _reach(body)
    if far == 0.0:
        return 0.0
    return min(corner, max(0.0, float(supports(body, directions).max()) / cosine))


def directions_for(body: Body, side: int) -> tuple[Array, float]:
    """Return unit vectors all round, and the least cosine between any direction and the nearest of
    them.

    Parameters
    ----------
    body : Body
        Of a planar one they are in its plane.
    side : int
        Of spatial ones, how many along each side of a cube.
    """
    return _round() if body.dimension == 2 else _sphere(side)


def supports(body: Body, directions: Array) -> Array:
    """Return proven bounds on how far a bounded body's core reaches along unit vectors (n, 3)."""
    _, far = _reach(body)
    if far == 0.0:
        return np.zeros(len(directions))
    # No body is wider than the segment, so that stands for its whole line.
    planar = body.dimension == 2
    wall = shapes.segment([-far, 0, 0], [far, 0, 0]) if planar else shapes.halfspace()
    found = answered_rows(body, wall, np.eye(4), _facing(directions, far, planar))
    bounds: Array = far - found.lower_bound - float(body.reals[L.RADIUS])
    return bounds


def _reach(body: Body) -> tuple[float, float]:
    """The distance of the farthest corner of a body's box from the origin, and of walls that are
    off it; both 0 of a point there."""
    box = BodyBox(body)
    corner = float(np.linalg.norm(np.abs(box.middle) + box.half))
    return corner, 2.0 * (corner + box.radius)


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


def _sphere(side: int) -> tuple[Array, float]:
    """Unit vectors through the middles of squares on a cube's faces, and the least cosine between
    any direction and the nearest of them."""
    along = (2.0 * np.arange(side) + 1.0) / side - 1.0
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
    half_diagonal = np.sqrt(2.0) / side
    lengths = np.linalg.norm(directions, axis=1)[:, None]
    return directions / lengths, 1.0 - 0.5 * half_diagonal**2


def _round() -> tuple[Array, float]:
    angles = 2.0 * np.pi * np.arange(ROUND) / ROUND
    found = np.stack([np.cos(angles), np.sin(angles), np.zeros(ROUND)], axis=1)
    return found, float(np.cos(np.pi / ROUND))
