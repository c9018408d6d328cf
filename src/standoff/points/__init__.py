"""Signed distance of a moving point to a planar or a spatial body, inside and outside."""

from typing import TYPE_CHECKING

from standoff.on_demand import on_demand

if TYPE_CHECKING:
    from standoff.points.answer import Minimum, PointCounts, PointEvent, PointProximity
    from standoff.points.recording import PointRecording, PointVisit, record_point
    from standoff.points.state import PointState
    from standoff.points.tracker import PointTracker
else:
    __getattr__, __dir__ = on_demand(__name__)

__all__ = [
    "Minimum",
    "PointCounts",
    "PointEvent",
    "PointProximity",
    "PointRecording",
    "PointState",
    "PointTracker",
    "PointVisit",
    "record_point",
]
