"""What a world's bodies and a compound's pieces may be: convex bodies, and solids that need not be.

A solid is known by its `cold_query`, so that worlds without one load nothing of solids.
"""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np

from standoff.bodies.body import Body
from standoff.bodies.boundary import Boundary
from standoff.kernels.body import layout as L
from standoff.tracking.cold_query import AnswersItself
from standoff.typing import Array

Shape: TypeAlias = Any
"""A `Body`, `Solid` or `PlanarSolid`: what a world asks of one depends on which it is."""


def as_shape(given: Any) -> Shape | None:
    """A body or a solid as it is, a boundary as a solid, the same one each time; None of
    anything else."""
    if isinstance(given, Body):
        return given
    if isinstance(given, Boundary):
        from standoff.solids.spatial.solid import solid_of

        return solid_of(given)
    # a compound can be asked too, but is made of pieces
    return given if isinstance(given, AnswersItself) and not hasattr(given, "pieces") else None


def is_solid(shape: Shape) -> bool:
    """Is it a solid, which need not be convex?"""
    return not isinstance(shape, Body)


def dimension_of_shape(shape: Shape) -> int:
    """2 of a planar one, 3 of a spatial one."""
    return int(shape.dimension)


def is_flat(shape: Shape) -> bool:
    """May it be in a planar world?"""
    return bool(getattr(shape, "flat", dimension_of_shape(shape) == 2))


def boundary_of(shape: Shape) -> Any:
    """What has the packed arrays of a spatial shape: of a solid its boundary."""
    return getattr(shape, "boundary", shape)


def is_bounded(shape: Shape) -> bool:
    """Is it no half-space?"""
    return bool(shape.bounded)


def box_of(shape: Shape) -> tuple[Array, Array, float]:
    """Centre (3,) and half sides (3,) of the box of a bounded shape's core, own frame, and what its
    radius and its slack add to it; lengths."""
    outline = getattr(shape, "outline", None)
    if outline is not None:
        low, high = np.zeros((2, 3))
        low[:2], high[:2] = outline.low, outline.high
        return 0.5 * (low + high), 0.5 * (high - low), float(shape.slack)
    reals = boundary_of(shape).reals
    centre, half = (reals[at : at + 3] for at in (L.BOX_CENTRE, L.BOX_HALF))
    return centre, half, float(reals[L.RADIUS] + reals[L.SLACK])


def slack_of(shape: Shape) -> float:
    """How far its boundary may be from what it stands for, length."""
    if is_solid(shape):
        return float(shape.slack)
    return float(boundary_of(shape).reals[L.SLACK])
