"""Boxes around rational Bezier curves and patches, made tight by subdivision.

A rational Bezier curve or patch with positive weights lies in the hull of its control points, and
halving it (de Casteljau) brings the points nearer, by a factor of 4 each time. Only the pieces that
may still contain an outermost point are halved.
"""

from __future__ import annotations

import numpy as np

from standoff.geometry.bernstein import halves
from standoff.geometry.tolerances import BOX_MARGIN, TIGHT_BOX
from standoff.typing import Array

# Greatest number of halvings, and of pieces at a time.
MOST_HALVINGS = 24
MOST_PIECES = 512


def tight_box(h: Array) -> tuple[Array, Array]:
    """(low, high), each (d,), of a box guaranteed to contain rational Bezier patches or curves.

    Parameters
    ----------
    h : (n, d + 1, p + 1, q + 1) homogeneous points (w x, ..., w) of n patches; curves have q = 0.

    Notes
    -----
    The box is that of the control points after subdivision, enlarged by a few units of roundoff if
    there was any. No side is farther from the surface than ``TIGHT_BOX`` of the diagonal, unless
    there are too many pieces.
    """
    d = h.shape[1] - 1
    points = (h[:, :d] / h[:, d:]).reshape(len(h), d, -1)
    margin = BOX_MARGIN * float(np.abs(points).max())
    # points of the surface: corners of every patch
    inner_low, inner_high = _corners(h)
    low, high = points.min(axis=2), points.max(axis=2)
    outer_low, outer_high = low.min(axis=0), high.max(axis=0)
    limit = TIGHT_BOX * float(np.linalg.norm(outer_high - outer_low))
    settled_low, settled_high = inner_low.copy(), inner_high.copy()
    halved = False
    for _ in range(MOST_HALVINGS):
        # pieces that extend beyond the known points by more than the limit, on any side
        open_ = (low < inner_low - limit).any(axis=1) | (high > inner_high + limit).any(axis=1)
        settled_low = np.minimum(settled_low, low[~open_].min(axis=0, initial=np.inf))
        settled_high = np.maximum(settled_high, high[~open_].max(axis=0, initial=-np.inf))
        h, low, high = h[open_], low[open_], high[open_]
        if not len(h) or len(h) > MOST_PIECES:
            break
        h = _halved(h)
        halved = True
        found_low, found_high = _corners(h)
        inner_low, inner_high = np.minimum(inner_low, found_low), np.maximum(inner_high, found_high)
        points = (h[:, :d] / h[:, d:]).reshape(len(h), d, -1)
        low, high = points.min(axis=2), points.max(axis=2)
    low = np.minimum(settled_low, low.min(axis=0, initial=np.inf))
    high = np.maximum(settled_high, high.max(axis=0, initial=-np.inf))
    if not halved:
        return low, high
    # halving may not improve a side, and then its rounding must not make it worse
    return np.maximum(low - margin, outer_low), np.minimum(high + margin, outer_high)


def _corners(h: Array) -> tuple[Array, Array]:
    """The box of the patches' corners, which are points of the surface."""
    c = h[:, :, [0, 0, -1, -1], [0, -1, 0, -1]]
    x = c[:, :-1] / c[:, -1:]
    return x.min(axis=(0, 2)), x.max(axis=(0, 2))


def _halved(h: Array) -> Array:
    """Every patch halved, along the parameter in which its points bend more."""
    p, q = h.shape[-2] - 1, h.shape[-1] - 1
    if q == 0:
        return np.concatenate([m @ h for m in halves(p)])
    bends = [
        degree**2 * np.abs(np.diff(h, 2, axis=axis)).max(axis=(1, 2, 3), initial=0.0)
        for degree, axis in ((p, -2), (q, -1))
    ]
    along_u = bends[0] >= bends[1]
    parts = [m @ h[along_u] for m in halves(p)] + [h[~along_u] @ m.T for m in halves(q)]
    return np.concatenate(parts)
