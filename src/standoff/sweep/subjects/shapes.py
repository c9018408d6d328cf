"""Bodies, solids and compounds as plain data: what results depend on."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.boundary import Boundary
from standoff.world.pieces import PieceUnion


def digest_of_shape(shape: Any) -> Any:
    """Return the SHA-256 of a body or solid; of a compound those of its pieces, with their poses
    in its frame."""
    if isinstance(shape, PieceUnion):
        return {
            name: {"sha256": digest_of_shape(piece.body), "pose": piece.pose.matrix.tolist()}
            for name, piece in shape.pieces.items()
        }
    if isinstance(shape, Boundary):
        return shape.digest
    # Of a solid, that of the boundary which it encloses.
    return shape.given.digest


def digest_of_arrays(arrays: Iterable[NDArray[Any]]) -> str:
    """Return the SHA-256 of some arrays and their shapes."""
    found = hashlib.sha256()
    for array in arrays:
        found.update(repr(array.shape).encode())
        found.update(np.ascontiguousarray(array, dtype="<f8").tobytes())
    return found.hexdigest()
