"""Simulation A's setting: a vault whose roof is one bicubic patch, a point on a helix above it."""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from standoff.bodies import Body, shapes
from standoff.geometry.nurbs import BezierPatch
from standoff.motion import Helix
from standoff.tracking import Feature
from standoff.typing import Array

STEP = 1e-3
"""Step of the simulation [s]: the paper's 1 kHz."""

ARCH_U = ((-1.0, -0.50), (-0.75, 0.22), (0.3, 0.30), (1.0, -0.55))
"""Control points (x, z) of the arch along u [length]: its speed varies threefold."""

ARCH_V = ((-1.1, -0.45), (-0.4, 0.22), (0.6, 0.22), (1.1, -0.35))
"""Control points (y, z) of the arch along v [length]."""

LIFT = ((0.42, 0.37), (0.38, 0.43))
"""Heights added to the four inner control points, 0.4 to the outer ones [length]. They differ, so
that the patch is not a plain sum of two arches: its f_uv does not vanish."""

FLOOR = -1.0
"""z of the floor [length]."""

FACE, VERTEX = Feature("face", 0), Feature("vertex", 0)
"""The patch, and the point."""

START = (0.08, 0.9)
"""Parameters (u, v) at which the run begins, far from the closest point's (0.68, 0.48)."""


PATH = Helix(radius=0.55, pitch=0.08 * math.pi, rate=2.0, centre=(0.0, 0.0, 1.3))
"""The point's path: 1.1 [length/s] around, 0.25 [length] higher after each turn of pi seconds."""


def control_points() -> Array:
    """Return the patch's control points [length], shape (4, 4, 3): the sum of two arches."""
    along, across = np.array(ARCH_U), np.array(ARCH_V)
    points = np.empty((4, 4, 3))
    points[..., 0] = along[:, None, 0]
    points[..., 1] = across[None, :, 0]
    lift = np.full((4, 4), 0.4)
    lift[1:3, 1:3] = LIFT
    points[..., 2] = along[:, None, 1] + across[None, :, 1] + lift
    return points


@cache
def vault() -> Body:
    """The convex body: the patch (face 0) as a roof, four plane walls and a floor."""
    roof = control_points()
    rims = (roof[0], roof[-1], roof[:, 0], roof[:, -1])
    corners = roof[np.ix_([0, -1], [0, -1])].copy()
    corners[..., 2] = FLOOR
    patches = [BezierPatch(roof), *(_wall(rim) for rim in rims), BezierPatch(corners)]
    return Body.from_patches(patches, name="vault")


@cache
def point() -> Body:
    """The other body: a point."""
    return shapes.point()


def _wall(rim: Array) -> BezierPatch:
    """The plane wall under a rim of the roof, ruled down to a straight line on the floor."""
    along = np.linspace(0.0, 1.0, len(rim))[:, None]
    foot = (1.0 - along) * rim[0] + along * rim[-1]
    foot[:, 2] = FLOOR
    return BezierPatch(np.stack([rim, foot], axis=1))
