"""The Voronoi regions of a body's features, and its medial axis."""

from typing import TYPE_CHECKING

from standoff.on_demand import on_demand

if TYPE_CHECKING:
    from standoff.bodies.voronoi import (
        BranchEnd,
        MedialBranch,
        NormalCone,
        RegionBoundary,
        VoronoiRegions,
        voronoi_regions,
    )
    from standoff.errors import VoronoiError
else:
    __getattr__, __dir__ = on_demand(__name__)

__all__ = [
    "BranchEnd",
    "MedialBranch",
    "NormalCone",
    "RegionBoundary",
    "VoronoiError",
    "VoronoiRegions",
    "voronoi_regions",
]
