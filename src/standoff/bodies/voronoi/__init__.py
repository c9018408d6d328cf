"""Voronoi regions: which feature of a body is nearest where, computed before any motion."""

from standoff.bodies.voronoi.compute import voronoi_regions
from standoff.bodies.voronoi.regions import (
    BranchEnd,
    MedialBranch,
    NormalCone,
    RegionBoundary,
    VoronoiRegions,
)
from standoff.errors import VoronoiError

__all__ = [
    "BranchEnd",
    "MedialBranch",
    "NormalCone",
    "RegionBoundary",
    "VoronoiError",
    "VoronoiRegions",
    "voronoi_regions",
]
