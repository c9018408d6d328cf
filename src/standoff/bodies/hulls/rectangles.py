"""Rectangles of parameters on plane faces with straight sides, in which a frame need not ask for
the boundary (see ``bodies.sampling``, which finds those of any face)."""

from __future__ import annotations

import numpy as np

from standoff.bodies.hulls.polyhedron import Polyhedron
from standoff.bodies.tolerances import INNER_SHARE
from standoff.kernels.body import layout as L
from standoff.typing import Array


def inner_rectangles(solid: Polyhedron, pcurves: Array) -> Array:
    """(f, 4) rows u0, u1, v0, v1 about the middles of faces, as large as their sides let them be
    in the proportions of the corners' box; NO_INNER where the middle is not inside all sides."""
    begins, owners = solid.starts[:-1], solid.owners
    spots = np.where((solid.senses > 0)[:, None], pcurves[:, :, 2], pcurves.sum(axis=2))
    steps = pcurves[:, :, 0] * solid.senses[:, None]
    # the face is on the left of every step: the middle, u = v = 0, by this much
    inside = spots[:, 0] * steps[:, 1] - spots[:, 1] * steps[:, 0]
    half = np.minimum(np.maximum.reduceat(spots, begins), -np.minimum.reduceat(spots, begins))
    reach = np.abs(steps[:, 1]) * half[owners, 0] + np.abs(steps[:, 0]) * half[owners, 1]
    share = np.minimum.reduceat(inside / np.where(reach > 0.0, reach, 1.0), begins)
    kept = INNER_SHARE * np.clip(share, 0.0, 1.0)[:, None] * half
    found = np.column_stack([-kept[:, 0], kept[:, 0], -kept[:, 1], kept[:, 1]])
    found[(share <= 0.0) | (half <= 0.0).any(axis=1)] = L.NO_INNER
    return found
