"""Ellipsoids as NURBS of any degree."""

from __future__ import annotations

from collections.abc import Callable

import standoff as so
from standoff.geometry.ellipsoid_patches import ellipsoid_octants, ellipsoid_patches

Axes = tuple[float, float, float]


def elevated(degree: int) -> Callable[[Axes], so.Body]:
    """The six rational biquartic patches of an ellipsoid, or octants below degree 4."""

    def make(axes: Axes) -> so.Body:
        patches = ellipsoid_patches(*axes) if degree >= 4 else ellipsoid_octants(*axes)
        raised = [p.elevated(degree, degree) for p in patches]
        return so.Body.from_patches(raised)

    return make
