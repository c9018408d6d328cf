"""A key and its lock: a bitted outline, extruded, and a plate with a keyway that is wider by a
play."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

import standoff as so
from standoff.geometry import Line
from standoff.solids import Solid
from standoff_studies.machines.prisms import extruded

Array = NDArray[np.float64]

BITTED = (
    *((-4.0, -1.5), (-1.2, -1.5), (-0.8, -0.6), (0.2, -0.6), (0.6, -1.5), (4.0, -1.5)),
    *((4.0, 1.5), (3.2, 1.5), (2.4, 0.6), (1.8, 0.6), (1.0, 1.5), (0.4, 1.5), (-0.4, 0.2)),
    *((-1.0, 0.2), (-1.9, 1.2), (-2.6, 1.2), (-3.2, 0.8), (-4.0, 0.8)),
)
"""Corners of a blade's section, millimetres, counterclockwise: three cuts above, a ward below."""


def outline(apart: float = 0.0) -> Array:
    """(n, 2) corners of the section, metres, its sides moved outwards by a length."""
    corners = 1e-3 * np.array(BITTED)
    along = np.roll(corners, -1, axis=0) - corners
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    out = np.stack([along[:, 1], -along[:, 0]], axis=1)
    before = np.roll(out, 1, axis=0)
    # A corner goes along the bisector, so that it is as far from both of its sides.
    shift: Array = (before + out) / (1.0 + np.sum(before * out, axis=1, keepdims=True))
    return corners + apart * shift


def key(length: float) -> Solid:
    """The blade, from z = 0 upwards."""
    return extruded(so.PlanarSolid.from_loops(_polygon(outline()), name="key"), 0.0, length)


def lock(play: float, side: float, depth: float) -> Solid:
    """A square plate of a side, from z = -depth to 0, with a keyway that is wider than the blade by
    a play, on all of its sides."""
    half = 0.5 * side
    plate = [(-half, -half), (half, -half), (half, half), (-half, half)]
    around = so.PlanarSolid.from_loops(_polygon(plate), [_polygon(outline(play))], name="lock")
    return extruded(around, -depth, 0.0)


def _polygon(corners: ArrayLike) -> list[Line]:
    flat = np.asarray(corners, dtype=float)
    spots = np.column_stack([flat, np.zeros(len(flat))])
    return [Line(p, q) for p, q in zip(spots, np.roll(spots, -1, axis=0), strict=True)]
