"""What a file of two solids holds."""

from __future__ import annotations

import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.features import Feature
from standoff.kernels.entries import solid_blocks as B
from standoff.solids.spatial.pair import references_of
from standoff.solids.spatial.points import POINT
from standoff.solids.spatial.sides import vertex_normals_of
from standoff.solids.spatial.solid_model import SolidModel
from standoff.solids.spatial.stationary import fans_of
from standoff.solids.tracked.tracker import SolidTracker

Array = NDArray[Any]
KINDS = ("face", "edge", "vertex")
MAGIC = b"STANDOFS"


def arrays_of(tracker: SolidTracker) -> list[Array]:
    """All arrays, in the order of ``kernels.entries.solid_blocks``."""
    solids = tracker.a, tracker.b
    made: list[Array] = []
    for solid in solids:
        made += [*solid.packed, *fans_of(solid), vertex_normals_of(solid), references_of(solid)]
    made += [*POINT, tracker.asks.numbers, *(_leaves(solid) for solid in solids)]
    return [np.ravel(each) for each in made]


def header_of(tracker: SolidTracker, lengths: list[int]) -> bytes:
    """What stands before the arrays."""
    return struct.pack(f"<{B.N_TABLED}qd", *lengths, tracker.dt)


def _leaves(solid: SolidModel) -> Array:
    """Of each leaf its feature's kind and number, and how many parameters it has; -1: they are not
    those of the body, which is rounded."""
    told = np.empty((len(solid.leaves), 3), dtype=np.int64)
    for k, leaf in enumerate(solid.leaves):
        feature: Feature = solid.feature_of(k)
        told[k] = KINDS.index(feature.kind), feature.index, -1 if solid.is_rounded else leaf.dim
    return told
