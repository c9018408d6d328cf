"""Which pairs of geometries MuJoCo's collision detection takes, and which a robot watches."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np

from standoff.errors import of_extra
from standoff.typing import Bools

with of_extra("MuJoCo", "mujoco"):
    import mujoco


HALF_SPACES = (int(mujoco.mjtGeom.mjGEOM_PLANE), int(mujoco.mjtGeom.mjGEOM_HFIELD))
"""Kinds of which MuJoCo takes no two together."""


WELDED = "welded together"
PARENT_AND_CHILD = "parent and child, joined by joints"
NOT_MEANT = "kept apart by contype and conaffinity"
EXCLUDED = "excluded by the model"
ENDLESS = "planes and height fields: MuJoCo takes no two"


def watched_pairs(model: Any) -> list[tuple[int, int]]:
    """Numbers i < j of the geometries of all pairs, by MuJoCo's own rules.

    Those found by its filters, and those that the model names (``<pair>``), which pass by them.
    """
    weld = model.body_weldid
    parent, moving = weld[model.body_parentid[weld]], weld != 0
    nested = (weld[:, None] == parent[None, :]) & np.outer(moving, moving)
    left_out = _left_out(model, nested | nested.T)
    n = model.ngeom
    return [(i, j) for i, j in combinations(range(n), 2) if not left_out[i, j]]


def pairs_left_out(model: Any) -> dict[tuple[int, int], str]:
    """Numbers i < j of the geometries of all pairs that a robot does not watch, and why.

    By MuJoCo's rules, but that bodies are parent and child if the model says so: MuJoCo takes what
    is welded to a parent, or to a child, for that one itself.
    """
    bodies = np.arange(model.nbody)
    weld, parents = model.body_weldid, model.body_parentid
    moving = weld != 0
    nested = (bodies[:, None] == parents[None, :]) & np.outer(moving, moving)
    found = _left_out(model, nested | nested.T)
    return {(i, j): str(found[i, j]) for i, j in combinations(range(model.ngeom), 2) if found[i, j]}


def _left_out(model: Any, nested: Bools) -> Any:
    """(ngeom, ngeom): why two geometries are left out, empty where they are not; ``nested``
    (nbody, nbody): which bodies are parent and child."""
    n, bodies = model.ngeom, model.geom_bodyid
    found = np.full((n, n), "", dtype=object)
    types, affinities = model.geom_contype, model.geom_conaffinity
    masks = (types[:, None] & affinities[None, :]) | (types[None, :] & affinities[:, None])
    weld = model.body_weldid
    excluded = np.zeros((model.nbody, model.nbody), dtype=bool)
    for signature in model.exclude_signature:
        i, j = int(signature) >> 16, int(signature) & 0xFFFF
        excluded[i, j] = excluded[j, i] = True
    if model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_FILTERPARENT):
        nested = np.zeros_like(nested)
    between = np.ix_(bodies, bodies)
    found[masks == 0] = NOT_MEANT
    found[excluded[between]] = EXCLUDED
    found[nested[between]] = PARENT_AND_CHILD
    found[(weld[:, None] == weld[None, :])[between]] = WELDED
    for i, j in zip(model.pair_geom1, model.pair_geom2, strict=True):
        found[i, j] = found[j, i] = ""
    endless = np.isin(model.geom_type, HALF_SPACES)
    found[np.outer(endless, endless)] = ENDLESS
    return found
