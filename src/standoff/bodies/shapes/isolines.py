"""Trimming curves along which one of a patch's parameters is constant."""

from __future__ import annotations

import numpy as np

from standoff.geometry.pcurves import Pcurve
from standoff.kernels.body import layout as L


def along_u(v: float) -> Pcurve:
    """u = t at a fixed v."""
    return Pcurve(L.LINE, np.array([[1.0, 0.0, 0.0], [0.0, 0.0, v], [0.0, 0.0, 1.0]]))


def along_v(u: float) -> Pcurve:
    """v = t at a fixed u."""
    return Pcurve(L.LINE, np.array([[0.0, 0.0, u], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]))
