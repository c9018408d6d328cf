"""Solids that need not be convex: what they are, and the proven distance between two of them."""

from typing import TYPE_CHECKING

from standoff.on_demand import on_demand

if TYPE_CHECKING:
    from standoff.recording.local_minima import LocalMinima, MinimumEvent
    from standoff.solids.answer import (
        Continuum,
        NearestPair,
        OpenPair,
        Overlap,
        SolidCounts,
        SolidProximity,
    )
    from standoff.solids.boundary_file import open_boundary, save_boundary
    from standoff.solids.planar.drawing import Drawing
    from standoff.solids.planar.dxf import read_dxf
    from standoff.solids.planar.solid import PlanarSolid
    from standoff.solids.query import distance
    from standoff.solids.spatial.points import PointDistances
    from standoff.solids.spatial.self_intersections import SelfIntersection, SelfIntersections
    from standoff.solids.spatial.solid import Solid
    from standoff.solids.tracked.answers import SolidAnswers
    from standoff.solids.tracked.frame_buffer import SolidFrameBuffer
    from standoff.solids.tracked.state import SolidState
    from standoff.solids.tracked.tracker import SolidTracker
else:
    __getattr__, __dir__ = on_demand(__name__)

__all__ = [
    "Continuum",
    "Drawing",
    "LocalMinima",
    "MinimumEvent",
    "NearestPair",
    "OpenPair",
    "Overlap",
    "PlanarSolid",
    "PointDistances",
    "SelfIntersection",
    "SelfIntersections",
    "Solid",
    "SolidAnswers",
    "SolidCounts",
    "SolidFrameBuffer",
    "SolidProximity",
    "SolidState",
    "SolidTracker",
    "distance",
    "open_boundary",
    "read_dxf",
    "save_boundary",
]
