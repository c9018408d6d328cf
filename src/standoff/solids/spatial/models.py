"""What the search reads of whatever may be beside a solid."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

from standoff.bodies.body import Body
from standoff.bodies.boundary import Boundary
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError
from standoff.solids.spatial.bare_point import BarePoint
from standoff.solids.spatial.half_space import HalfSpace
from standoff.solids.spatial.solid_model import SolidModel, known_model


def as_model(given: Any) -> SolidModel:
    """A `Solid` as it is, a `Boundary` or `Body` as a solid, a half-space or a point too."""
    if isinstance(given, SolidModel):
        return given
    if isinstance(given, Boundary | Body):
        return _made_once(given)
    raise StandoffError(f"{shown(given)} is no Solid, Boundary or Body.", "solid", given)


@lru_cache(maxsize=64)
def _made_once(boundary: Boundary) -> SolidModel:
    """A body is asked again and again, and its leaves take a second."""
    found = known_model(boundary)
    if found is not None:
        return found
    if not isinstance(boundary, Body) or (boundary.face_parts and boundary.bounded):
        return SolidModel(boundary)
    if not boundary.bounded:
        return HalfSpace(boundary)
    if not (boundary.edge_parts or boundary.radius):
        return BarePoint(boundary)
    return SolidModel(boundary)
