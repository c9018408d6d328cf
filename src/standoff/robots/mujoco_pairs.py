"""Which pairs of geometries MuJoCo's collision detection takes."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.errors import not_installed

try:
    import mujoco
except ModuleNotFoundError as error:
    raise ModuleNotFoundError(not_installed("MuJoCo", "mujoco"), name=error.name) from error

Ints = NDArray[np.int64]
Mask = NDArray[np.bool_]

HALF_SPACES = (int(mujoco.mjtGeom.mjGEOM_PLANE), int(mujoco.mjtGeom.mjGEOM_HFIELD))
"""Kinds of which MuJoCo takes no two together."""


def watched_pairs(model: Any) -> list[tuple[int, int]]:
    """Numbers i < j of the geometries of all pairs, by MuJoCo's own rules.

    Those found by its filters, and those that the model names (``<pair>``), which pass by them.
    """
    n = model.ngeom
    types, affinities = model.geom_contype, model.geom_conaffinity
    masks = (types[:, None] & affinities[None, :]) | (types[None, :] & affinities[:, None])
    bodies = model.geom_bodyid
    found = (masks != 0) & ~_filtered_bodies(model)[np.ix_(bodies, bodies)]
    for i, j in zip(model.pair_geom1, model.pair_geom2, strict=True):
        found[i, j] = found[j, i] = True
    endless = np.isin(model.geom_type, HALF_SPACES)
    found &= ~np.outer(endless, endless)
    return [(int(i), int(j)) for i, j in np.argwhere(np.triu(found, 1))] if n else []


def _filtered_bodies(model: Any) -> Mask:
    """(nbody, nbody): are two bodies left out, whatever their geometries are?"""
    weld = model.body_weldid
    found: Mask = weld[:, None] == weld[None, :]
    if not model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_FILTERPARENT):
        parent = weld[model.body_parentid[weld]]
        nested = weld[:, None] == parent[None, :]
        moving = weld != 0
        found |= (nested | nested.T) & np.outer(moving, moving)
    for signature in model.exclude_signature:
        i, j = int(signature) >> 16, int(signature) & 0xFFFF
        found[i, j] = found[j, i] = True
    return found
