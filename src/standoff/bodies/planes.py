"""The plane of a half-space, which may have any normal and offset in its body's frame."""

from __future__ import annotations

import numpy as np

from standoff.bodies.body import Body
from standoff.kernels.entries.queries import chart_normal, feature_jet
from standoff.typing import Array


def outer_plane(body: Body) -> tuple[Array, float]:
    """(outward unit normal (3,), offset along it, length) of a half-space without its radius."""
    normal = np.array(chart_normal(body.ints, body.reals, 0, 0.0, 0.0))
    point = np.array(feature_jet(body.ints, body.reals, 0, 0, 0.0, 0.0)[0])
    return normal, float(normal @ point)
