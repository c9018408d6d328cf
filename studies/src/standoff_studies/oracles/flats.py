"""Flat faces and straight lines of a body's boundary, where a support set is more than a point.

Along the normal of a flat face the support set is the face; along any normal of a sharp edge, or
of a straight ruling of a curved face, it is a segment. A random normal never hits these, so the
exact pairs choose some of their normals from here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
At = Callable[[Any], tuple[Array, Array]]
"""From a parameter to unit normal (3,) and the ends (m, 3) of the support set, body frame."""


@dataclass(frozen=True)
class Flat:
    """A face, or a one-parameter family of straight lines with their normals.

    Attributes
    ----------
    at : function
        From the parameter t (rad) to the normal and the ends of the support set, extended
        precision.
    start : float
        The parameter that was drawn.
    turns : bool
        Does the normal turn with t, as at an edge or a ruling? A face has one normal.
    """

    at: At
    start: float
    turns: bool

    def moved_out(self, distance: float) -> Flat:
        """The same flat of the body swept by a ball."""

        def at(t: Any) -> tuple[Array, Array]:
            normal, ends = self.at(t)
            return normal, ends + distance * normal

        return replace(self, at=at)


def face_flat(normal: Array, corners: Array) -> Flat:
    """A flat face."""
    return Flat(lambda t: (normal, corners), 0.0, False)


def arc_flat(first: Array, second: Array, ends: Array, start: float) -> Flat:
    """A straight edge: normals cos(t) first + sin(t) second, both unit and perpendicular to it."""
    return Flat(lambda t: (np.cos(t) * first + np.sin(t) * second, ends), start, True)


def family_flat(at: At, start: float) -> Flat:
    """The rulings of a curved face."""
    return Flat(at, start, True)
