"""Solids in space: their leaves and tree, and the proven distance of two of them."""

from typing import TYPE_CHECKING

from standoff.on_demand import on_demand

if TYPE_CHECKING:
    from standoff.solids.spatial.distance import spatial_distance
    from standoff.solids.spatial.points import PointDistances
    from standoff.solids.spatial.solid import Solid
else:
    __getattr__, __dir__ = on_demand(
        __name__,
        {
            "standoff.solids.spatial.distance": ("spatial_distance",),
            "standoff.solids.spatial.points": ("PointDistances",),
            "standoff.solids.spatial.solid": ("Solid",),
        },
    )

__all__ = ["PointDistances", "Solid", "spatial_distance"]
