"""From boxes where a patch may bend inward to the length by which it may dent.

Along a path of the patch that starts in a tangent plane, the height above that plane has the
second derivative -kappa, at most k where the least curvature is at least -k. Crossing places of
total width w it gains the slope k w, and over the patch's size D the height k (w D - w^2 / 2).
Places of different k add up in layers.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from standoff.typing import Array

# Layers of curvature k, k/4, k/16 ... to below 1e-14 k: more would not help.
LAYERS = 24
LAYER_RATIO = 4.0


@dataclass(frozen=True, eq=False)
class Dent:
    """A box that is not proven convex, in units of the patch's size.

    Attributes
    ----------
    curvature : k >= 0, no curvature is below -k; inf if no bound was found.
    low, high : (3,) corners of a box that contains the surface there.
    turn : the greatest angle between two normals there, radians; used if k is inf.
    """

    curvature: float
    low: Array
    high: Array
    turn: float = 0.0


def dents_total(dents: Sequence[Dent]) -> tuple[float, float]:
    """(rise, tilt): above a tangent plane in units of the size, and in radians."""
    rise = tilt = 0.0
    bounded = sorted((d for d in dents if np.isfinite(d.curvature)), key=lambda d: -d.curvature)
    if bounded:
        rise, tilt = _layered(bounded)
    for dent in dents:
        if not np.isfinite(dent.curvature):
            rise += float(np.tan(min(dent.turn, 1.5)))
            tilt += dent.turn
    # nothing rises by more than the size of the patch
    return min(rise, 1.0), min(tilt, float(np.pi))


def _layered(dents: Sequence[Dent]) -> tuple[float, float]:
    k = np.array([d.curvature for d in dents])
    low = np.minimum.accumulate([d.low for d in dents])
    high = np.maximum.accumulate([d.high for d in dents])
    widths = np.minimum(np.linalg.norm(high - low, axis=1), 1.0)
    rise = tilt = 0.0
    level = float(k[0])
    for layer in range(LAYERS):
        below = level / LAYER_RATIO if layer < LAYERS - 1 else 0.0
        # all boxes whose curvature is above the bottom of the layer
        last = int(np.searchsorted(-k, -below, side="left")) - 1
        w = float(widths[max(last, 0)])
        rise += (level - below) * (w - 0.5 * w * w)
        tilt += (level - below) * w
        level = below
    return rise, tilt
