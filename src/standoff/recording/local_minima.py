"""Local minima of the distance over many frames, and what becomes of them."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.features import Feature
from standoff.tracking.branches import NONE, Birth, End
from standoff.typing import Array

Kind = Literal["birth", "end", "switch", "handover"]


class LocalMinima(NamedTuple):
    """All local minima of many frames, a row each, frame after frame, the nearest first.

    Attributes
    ----------
    frame, key : (m,) arrays of int
        The key is that of `NearestPair`.
    distance, lower_bound : (m,) arrays
    point_a, point_b : (m, 3) arrays
        World axes.
    feature_a, feature_b : (m,) arrays of Feature
    """

    frame: NDArray[np.int64]
    key: NDArray[np.int64]
    distance: Array
    lower_bound: Array
    point_a: Array
    point_b: Array
    feature_a: NDArray[np.object_]
    feature_b: NDArray[np.object_]


class MinimumEvent(NamedTuple):
    """What becomes of a local minimum from one frame to the next.

    Attributes
    ----------
    frame : int
        The first in which it is so.
    kind : "birth", "end", "switch", "handover"
        It begins, or ends; it goes to another face, edge or vertex; it is the nearest from now on.
    key : int
    distance : float
        In that frame; of one that ends in the frame before.
    features : (Feature, Feature)
        The same.
    reason : Birth or End, optional
        Of a birth or an end.
    other : int
        Of one that has MERGED the key of the one that it has come to; of a handover that of the
        one that was the nearest; else -1.
    """

    frame: int
    kind: Kind
    key: int
    distance: float
    features: tuple[Feature, Feature]
    reason: Birth | End | None = None
    other: int = NONE
